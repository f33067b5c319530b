//! Rays from cell to cell.

use super::faces::{Fours, Tester, lane_of};
use super::{Cells, Kind, MOST_CELLS, NOTHING, OUTLINE};
use glam::DVec3;

/// Chords shorter than this are none, micrometers: single precision cannot tell them from a miss.
const LEAST_UM: f32 = 1e-5;
/// What double precision may add to the way that single precision found, micrometers: more than it
/// errs by, but for faces so nearly along the ray that all of the way is as near to them.
const SLACK_UM: f64 = 1e-3;

impl Cells {
    /// First void that a ray in keratin enters in `t0..t1`, by the face.
    ///
    /// * `from`: the face that the ray starts on.
    pub(in crate::fiber) fn enter(
        &self,
        origin: DVec3,
        dir: DVec3,
        t0: f64,
        t1: f64,
        from: Option<u32>,
    ) -> Option<(f64, u32)> {
        self.enter_by(Fours, (origin, dir), t0, t1, from)
    }

    /// Where a ray in a void leaves it, and the face.
    ///
    /// * `from`: the face that the ray starts on.
    pub(in crate::fiber) fn leave(
        &self,
        origin: DVec3,
        dir: DVec3,
        from: Option<u32>,
    ) -> Option<(f64, u32)> {
        self.leave_by(Fours, origin, dir, from)
    }

    /// [`Cells::enter`] by a way to test faces.
    #[inline(always)]
    pub(in crate::fiber) fn enter_by(
        &self,
        faces: impl Tester,
        (origin, dir): (DVec3, DVec3),
        t0: f64,
        t1: f64,
        from: Option<u32>,
    ) -> Option<(f64, u32)> {
        let (mut t, mut limit) = (0.0, None);
        // A void that has just been left is not met again; nor is the outline.
        let (mut place, mut left) = match from {
            Some(face) if face & OUTLINE != 0 => return None,
            Some(face) => (self.beside(faces, face, origin, false), true),
            None => {
                let (begin, end) = self.outline(origin, dir)?;
                (t, limit) = (t0.max(begin), Some(t1.min(end)));
                if t >= t1.min(end) {
                    return None;
                }
                (self.find_by(faces, origin + t * dir), false)
            }
        };
        let away = dir.as_vec3();
        for _ in 0..MOST_CELLS {
            let room = &self.rooms[place.cell as usize];
            if room.rim && limit.is_none() {
                limit = Some(t1.min(self.outline(origin, dir)?.1));
            }
            let limit = limit.unwrap_or(t1);
            if room.air && !std::mem::take(&mut left) {
                match faces.void(self, room, place.at.as_vec3(), away, LEAST_UM) {
                    // Past the outline a ray is in a void unless a wall is between: that a face
                    // without one is still ahead is single precision's error.
                    Some((reach, slot)) if reach <= 0.0 || !self.walled(slot) => {
                        return Some((t, OUTLINE | place.cell));
                    }
                    Some(met) => {
                        let t = t + self.reach(met, false, place.at, dir);
                        return (t < limit).then_some((t, met.1 as u32));
                    }
                    None => {}
                }
            }
            let met = faces.way_out(self, room, place.at.as_vec3(), away, true);
            let way = self.reach(met, true, place.at, dir);
            t += way;
            if t >= limit {
                return None;
            }
            place.at += way * dir;
            let link = self.behind(faces, place, &self.links[met.1], None);
            match link.kind {
                Kind::Bare => return Some((t, met.1 as u32)),
                _ if link.next == NOTHING => return None,
                _ => place = place.through(link),
            }
        }
        None
    }

    /// [`Cells::leave`] by a way to test faces.
    #[inline(always)]
    pub(in crate::fiber) fn leave_by(
        &self,
        faces: impl Tester,
        origin: DVec3,
        dir: DVec3,
        from: Option<u32>,
    ) -> Option<(f64, u32)> {
        let mut place = match from {
            Some(face) if face & OUTLINE != 0 => self.place(face & !OUTLINE, origin),
            Some(face) => self.beside(faces, face, origin, true),
            None => self.find_by(faces, origin),
        };
        let (mut t, mut limit, away) = (0.0, None, dir.as_vec3());
        for _ in 0..MOST_CELLS {
            let room = &self.rooms[place.cell as usize];
            if room.rim && limit.is_none() {
                let end = self.outline(origin, dir).map_or(0.0, |(_, end)| end);
                limit = Some(end.max(0.0));
            }
            let met = faces.way_out(self, room, place.at.as_vec3(), away, false);
            let way = self.reach(met, false, place.at, dir);
            if let Some(limit) = limit
                && limit <= t + way
            {
                return Some((limit, OUTLINE | place.cell));
            }
            t += way;
            place.at += way * dir;
            let link = self.behind(faces, place, &self.links[met.1], None);
            if link.kind != Kind::Open {
                return t.is_finite().then_some((t, met.1 as u32));
            }
            place = place.through(link);
        }
        None
    }

    /// Whether keratin is between the void of a cell and a face of it.
    #[inline]
    fn walled(&self, slot: usize) -> bool {
        let (block, lane) = (&self.blocks[slot / 4], slot % 4);
        block.void[lane] < block.cell[lane]
    }

    /// How far it is to the face of a cell, or of the void in it, that single precision found.
    #[inline]
    fn reach(&self, (about, slot): (f32, usize), cell: bool, at: DVec3, dir: DVec3) -> f64 {
        if about == f32::INFINITY {
            return f64::INFINITY;
        }
        let (block, lane) = (&self.blocks[slot / 4], slot % 4);
        let normal = block.normal(lane);
        let offset = lane_of(if cell { &block.cell } else { &block.void }, lane);
        let way = (offset - normal.dot(at)) / normal.dot(dir);
        way.min(f64::from(about) + SLACK_UM).max(0.0)
    }
}
