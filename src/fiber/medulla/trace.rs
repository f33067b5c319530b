//! A medulla seen by a ray, and by a point.

use super::{Medulla, Rays, Voids};
use crate::fiber::Region;
#[cfg(target_arch = "x86_64")]
use crate::fiber::cells::Cells;
use crate::fiber::section::Section;
use glam::DVec3;

impl Medulla {
    /// The cells that fill it, if they do.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(in crate::fiber) fn cells(&self) -> Option<&Cells> {
        match &self.voids {
            Voids::Bodies(bodies) => bodies.cells(),
            _ => None,
        }
    }

    /// First void that a ray in the matrix enters in `t0..t1`.
    #[inline]
    pub(in crate::fiber) fn enter_void(
        &self,
        rays: &Rays,
        t0: f64,
        t1: f64,
        from: Option<u32>,
    ) -> Option<(f64, u32)> {
        match &self.voids {
            Voids::None => None,
            Voids::Ladder(ladder) => ladder.enter(&rays.unit, t0, t1, from),
            Voids::Froth(froth) => {
                // Cells cover the medulla only.
                let (a, b) = rays.unit.inside_circle(self.reach)?;
                let (t0, t1) = (t0.max(a), t1.min(b));
                (t0 < t1)
                    .then(|| froth.enter(rays.origin, rays.dir, t0, t1, from))
                    .flatten()
            }
            // Cells know their outline, and a ray from one where it is.
            Voids::Bodies(bodies) if bodies.fill() => {
                bodies.enter(rays.origin, rays.dir, t0, t1, from)
            }
            Voids::Bodies(bodies) => {
                let (a, b) = rays.unit.inside_circle(self.reach)?;
                let (t0, t1) = (t0.max(a), t1.min(b));
                (t0 < t1)
                    .then(|| bodies.enter(rays.origin, rays.dir, t0, t1, from))
                    .flatten()
            }
        }
    }

    /// Where a ray in a void leaves it, and the void. `from` is the void whose boundary it starts on.
    #[inline]
    pub(in crate::fiber) fn leave_void(
        &self,
        rays: &Rays,
        from: Option<u32>,
    ) -> Option<(f64, u32)> {
        match &self.voids {
            Voids::None => None,
            Voids::Ladder(ladder) => {
                let index = from.or_else(|| ladder.at(rays.unit.at(0.0)))?;
                Some((ladder.leave(&rays.unit, index), index))
            }
            Voids::Froth(froth) => {
                let index = from.or_else(|| froth.at(rays.origin))?;
                let t = froth.leave(rays.origin, rays.dir, index, from.is_some());
                Some((t, index))
            }
            Voids::Bodies(bodies) => bodies.leave(rays.origin, rays.dir, from),
        }
    }

    /// Outward gradient of a void's boundary in the unit-circle frame at a point.
    #[inline]
    pub(in crate::fiber) fn void_gradient(
        &self,
        section: &Section,
        point: DVec3,
        index: u32,
    ) -> DVec3 {
        match &self.voids {
            Voids::None => DVec3::Z,
            Voids::Ladder(ladder) => {
                let unit = section.unit_point(point);
                ladder
                    .puck(index)
                    .gradient(unit, ladder.center_near(index, point.z))
            }
            Voids::Froth(froth) => section.unit_gradient(point - froth.center_near(index, point.z)),
            Voids::Bodies(bodies) => section.unit_gradient(bodies.gradient(index, point)),
        }
    }

    /// Whether a point is within the outline of the medulla and of one of its pieces.
    pub(in crate::fiber) fn holds(&self, unit: DVec3) -> bool {
        let inside = match &self.rim {
            Some(rim) => rim.holds(unit),
            None => unit.x * unit.x + unit.y * unit.y < self.ratio * self.ratio,
        };
        inside && self.pieces.as_ref().is_none_or(|p| p.holds(unit.z))
    }

    /// The region of a point inside the cuticle.
    pub(in crate::fiber) fn region_at(&self, section: &Section, point: DVec3) -> Region {
        let unit = section.unit_point(point);
        let inside = match &self.voids {
            Voids::None => self.outlined() && self.holds(unit),
            Voids::Ladder(ladder) => ladder.at(unit).is_some(),
            Voids::Froth(froth) => froth.at(point).is_some(),
            Voids::Bodies(bodies) => bodies.at(point).is_some(),
        };
        if inside { self.fill() } else { Region::Cortex }
    }
}
