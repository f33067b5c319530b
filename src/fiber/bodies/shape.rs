//! The shape of one body, for export.

use super::chord::OneByOne;
use super::{Bodies, holds};
use glam::DVec3;

/// A convex body seen from a point inside.
#[derive(Clone, Copy, Debug)]
pub(in crate::fiber) struct Shape<'a> {
    bodies: &'a Bodies,
    index: u32,
    middle: DVec3,
    /// Ways from the middle to the surface along the axes, the mean of both directions.
    pub(in crate::fiber) half: DVec3,
    /// Whether it is solid and lies in a void.
    pub(in crate::fiber) island: bool,
}

/// Points tried for one inside; the slimmest bodies take some hundredth of the ball about them.
const TRIES: u32 = 20_000;
/// So many inside are enough for a point well in the middle.
const ENOUGH: u32 = 64;

impl Bodies {
    /// The shape of a body; `None` if none of many points is inside.
    pub(in crate::fiber) fn shape(&self, index: u32) -> Option<Shape<'_>> {
        let body = &self.bodies[index as usize];
        let radius = body.reach2.sqrt();
        let (mut sum, mut count) = (DVec3::ZERO, 0);
        for i in 0..TRIES {
            let i = f64::from(i) + 0.5;
            // Steps of a rank-1 lattice (Roberts 2018).
            let at = DVec3::new(0.819_172_513, 0.671_043_607, 0.549_700_478) * i;
            let p = radius * (2.0 * at.fract() - 1.0);
            if holds(p, self.planes_of(body), self.quadrics_of(body)) {
                sum += p;
                count += 1;
                if count == ENOUGH {
                    break;
                }
            }
        }
        let mut shape = Shape {
            bodies: self,
            index,
            middle: body.center + (count > 0).then(|| sum / f64::from(count))?,
            half: DVec3::ONE,
            island: body.island,
        };
        let mean = |axis: DVec3| {
            let ways = [axis, -axis].map(|dir| shape.surface(dir).0.distance(shape.middle));
            0.5 * (ways[0] + ways[1])
        };
        shape.half = DVec3::new(mean(DVec3::X), mean(DVec3::Y), mean(DVec3::Z));
        Some(shape)
    }
}

impl Shape<'_> {
    /// The point that it is seen from.
    pub(in crate::fiber) fn middle(&self) -> DVec3 {
        self.middle
    }

    /// Where a ray from the middle leaves the body, and through which face.
    pub(in crate::fiber) fn surface(&self, dir: DVec3) -> (DVec3, u32) {
        let chord =
            (self.bodies).chord(OneByOne, self.index, self.middle, dir, self.middle.z, None);
        chord.map_or((self.middle, 0), |chord| {
            (self.middle + chord.leave.max(0.0) * dir, chord.leave_face)
        })
    }
}
