//! A fiber of which parts are cut away.

use crate::fiber::{Fiber, HitState, Region};
use glam::DVec3;

/// A half-space `normal . p > offset`.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfSpace {
    pub(super) normal: DVec3,
    pub(super) offset: f64,
}

/// A fiber without some pieces.
pub(super) struct Specimen<'a> {
    pub(super) fiber: &'a Fiber,
    /// Pieces cut away: each is what its half-spaces have in common.
    removed: Vec<Vec<HalfSpace>>,
}

/// What a ray sees.
pub(super) struct Seen {
    pub(super) point: DVec3,
    /// Toward the ray's origin.
    pub(super) normal: DVec3,
    pub(super) what: What,
    /// The surface and region to go on from; no region in a part cut away.
    region: Option<Region>,
    from: Option<HitState>,
}

/// Kinds of surface.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum What {
    Face,
    Riser,
    VoidWall,
    Cut(Region),
}

/// The way of a ray through a removed piece, and the normal of the cut where it ends.
#[derive(Clone, Copy)]
struct Gap {
    begin: f64,
    end: f64,
    normal: DVec3,
}

/// Sections crossed before a ray gives up; a straight line crosses some ten.
const MAX_STEPS: usize = 200;
/// A ray that has come to a cut goes on this far behind it, micrometers.
const BEHIND: f64 = 1e-7;

impl<'a> Specimen<'a> {
    /// All of the fiber.
    pub(super) fn whole(fiber: &'a Fiber) -> Self {
        Self::without(fiber, Vec::new())
    }

    /// The fiber without some pieces, each what its half-spaces have in common.
    pub(super) fn without(fiber: &'a Fiber, removed: Vec<Vec<HalfSpace>>) -> Self {
        Self { fiber, removed }
    }

    /// What a ray from outside the fiber sees first; `None` past it.
    pub(super) fn look(&self, origin: DVec3, dir: DVec3) -> Option<Seen> {
        let cut_away = |piece: &Vec<HalfSpace>| {
            let mut inside = piece.iter().map(|h| h.normal.dot(origin) > h.offset);
            inside.all(|inside| inside)
        };
        let region = (!self.removed.iter().any(cut_away)).then_some(Region::Outside);
        self.first(origin, dir, region, None)
    }

    /// What a ray from a point seen sees first.
    pub(super) fn look_on(&self, seen: &Seen, dir: DVec3) -> Option<Seen> {
        self.first(seen.point, dir, seen.region, seen.from)
    }

    fn gaps(&self, p: DVec3, dir: DVec3) -> impl Iterator<Item = Gap> {
        self.removed
            .iter()
            .filter_map(move |piece| gap(piece, p, dir))
    }

    /// Where a ray that is in parts cut away comes to their end.
    fn end_of_gaps(&self, p: DVec3, dir: DVec3) -> Option<(f64, DVec3)> {
        let mut end = None;
        loop {
            let t = end.map_or(0.0, |(t, _)| t);
            let furthest = self
                .gaps(p, dir)
                .filter(|gap| gap.begin <= t + BEHIND && gap.end > t + BEHIND)
                .max_by(|a, b| a.end.total_cmp(&b.end));
            match furthest {
                Some(gap) if gap.end == f64::INFINITY => return None,
                Some(gap) => end = Some((gap.end, gap.normal)),
                None => return end,
            }
        }
    }

    fn first(
        &self,
        mut p: DVec3,
        dir: DVec3,
        mut region: Option<Region>,
        mut from: Option<HitState>,
    ) -> Option<Seen> {
        for _ in 0..MAX_STEPS {
            let Some(now) = region else {
                let (t, normal) = self.end_of_gaps(p, dir)?;
                p += t * dir;
                let behind = self.fiber.region_at(p + BEHIND * dir);
                if !matches!(behind, Region::Outside | Region::Void) {
                    return Some(Seen {
                        point: p,
                        normal,
                        what: What::Cut(behind),
                        region: None,
                        from: None,
                    });
                }
                (region, from) = (Some(behind), None);
                p += BEHIND * dir;
                continue;
            };
            let hit = self.fiber.next_hit(p, dir, now, from);
            let enter = self
                .gaps(p, dir)
                .map(|gap| gap.begin)
                .filter(|&begin| begin > 10.0 * BEHIND)
                .fold(f64::INFINITY, f64::min);
            let t = hit.map_or(f64::INFINITY, |h| h.t);
            if enter < t {
                p += enter * dir;
                (region, from) = (None, None);
                continue;
            }
            let hit = hit?;
            let riser = self.fiber.is_riser(hit.state);
            return Some(Seen {
                point: p + hit.t * dir,
                normal: hit.normal,
                what: match (now, riser) {
                    (Region::Void, _) => What::VoidWall,
                    (_, true) => What::Riser,
                    (_, false) => What::Face,
                },
                region,
                from: Some(hit.state),
            });
        }
        None
    }
}

/// Where a ray is in a piece.
fn gap(piece: &[HalfSpace], p: DVec3, dir: DVec3) -> Option<Gap> {
    let mut gap = Gap {
        begin: f64::NEG_INFINITY,
        end: f64::INFINITY,
        normal: DVec3::ZERO,
    };
    for h in piece {
        let (rate, rest) = (h.normal.dot(dir), h.offset - h.normal.dot(p));
        if rate == 0.0 {
            if rest >= 0.0 {
                return None;
            }
        } else if rate > 0.0 {
            gap.begin = gap.begin.max(rest / rate);
        } else if rest / rate < gap.end {
            (gap.end, gap.normal) = (rest / rate, h.normal);
        }
    }
    (gap.begin < gap.end && gap.end > 0.0).then_some(gap)
}
