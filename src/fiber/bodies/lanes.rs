//! The planes of a body, eight at a time, with the bits of one after another.

use super::chord::{Chord, OneByOne, Slabs};
use super::{Bodies, Body};
use crate::fiber::convex::Plane;
use crate::math::lanes::{LANES, Row, Set, Vectors, Wide, run_with};
use glam::DVec3;
use std::ops::Range;

/// Bodies of fewer planes are cut by one after another.
const FEWEST: usize = 4;

/// Planes by eights, in the order of the bodies.
#[derive(Clone, Debug)]
pub(super) struct Eights {
    set: Option<Set>,
    /// Normals and offsets.
    rows: Vec<[Row; 4]>,
}

impl Eights {
    pub(super) fn new() -> Self {
        Self {
            set: Set::detect(),
            rows: Vec::new(),
        }
    }

    /// Adds the planes of a body; where they are.
    pub(super) fn add(&mut self, planes: &[Plane]) -> Range<u32> {
        let begin = self.rows.len() as u32;
        if planes.len() >= FEWEST {
            for eight in planes.chunks(LANES) {
                // What is no plane holds all space.
                let mut rows = [Row::default(); 4];
                rows[3] = Row([f64::INFINITY; LANES]);
                for (lane, plane) in eight.iter().enumerate() {
                    let [x, y, z] = plane.normal.to_array();
                    for (row, number) in rows.iter_mut().zip([x, y, z, plane.offset]) {
                        row.0[lane] = number;
                    }
                }
                self.rows.push(rows);
            }
        }
        begin..self.rows.len() as u32
    }

    /// The set to work with, if any body has enough planes.
    #[inline]
    pub(super) fn set(&self) -> Option<Set> {
        self.set.filter(|_| !self.rows.is_empty())
    }
}

impl Bodies {
    /// See [`Bodies::enter`].
    pub(super) fn enter_in_lanes(
        &self,
        set: Set,
        ray: (DVec3, DVec3),
        part: (f64, f64),
        from: Option<u32>,
    ) -> Option<(f64, u32)> {
        run_with!(set, |simd| self.enter_by(ByEight(simd), ray, part, from))
    }

    /// See [`Bodies::leave`].
    pub(super) fn leave_in_lanes(
        &self,
        set: Set,
        origin: DVec3,
        dir: DVec3,
        from: Option<u32>,
    ) -> Option<(f64, u32)> {
        run_with!(set, |simd| self.leave_by(ByEight(simd), origin, dir, from))
    }
}

/// Eight planes at a time.
#[derive(Clone, Copy)]
struct ByEight<W>(W);

impl<W: Wide> Slabs for ByEight<W> {
    #[inline(always)]
    fn cut(
        self,
        bodies: &Bodies,
        body: &Body,
        (o, dir): (DVec3, DVec3),
        on: Option<u32>,
        chord: &mut Chord,
    ) -> Option<()> {
        if body.eights.is_empty() {
            return OneByOne.cut(bodies, body, (o, dir), on, chord);
        }
        let simd = self.0;
        let (zero, endless) = (simd.all(0.0), simd.all(f64::INFINITY));
        let (from, by) = (spread(simd, o), spread(simd, dir));
        let rows = &bodies.eights.rows[body.eights.start as usize..body.eights.end as usize];
        let mut face = body.planes.start;
        for [x, y, z, offset] in rows {
            let normal = Vectors::new(simd.load(x), simd.load(y), simd.load(z));
            let rate = normal.dot(by);
            let mut gap = simd.load(offset) - normal.dot(from);
            if let Some(on) = on
                && on.wrapping_sub(face) < LANES as u32
            {
                gap = zero.or(simd.lanes(1 << (on - face)), gap);
            }
            let (coming, going) = (rate.lt(zero), rate.gt(zero));
            if (gap.lt(zero) & !(coming | going)).any() {
                return None;
            }
            let t = gap / rate;
            let ways = t.row();
            if coming.any() {
                let lane = (-t).or(coming, endless).least().1;
                chord.cut(ways.0[lane], f64::INFINITY, face + lane as u32);
            }
            if going.any() {
                let lane = t.or(going, endless).least().1;
                chord.cut(f64::NEG_INFINITY, ways.0[lane], face + lane as u32);
            }
            face += LANES as u32;
        }
        Some(())
    }
}

/// The same in all lanes.
#[inline(always)]
fn spread<W: Wide>(simd: W, v: DVec3) -> Vectors<W> {
    Vectors::new(simd.all(v.x), simd.all(v.y), simd.all(v.z))
}

#[cfg(test)]
mod tests;
