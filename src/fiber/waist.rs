//! Leaving a fiber whose section is no ellipse: what is inside may lie beyond the largest circle in
//! it, in the bulges of a dumb-bell, and a straight way to it may lead through the air.

use super::march::{March, Side, StartOn};
use super::scales::{Cell, Scales};
use super::section::UnitRay;
use super::surface::{Inward, OuterHit, OuterState, outer_hit};

impl Scales {
    /// As [`super::surface::Surface::leave`], with `core` asked for all of the ray within the fiber.
    pub(super) fn leave_around<T>(
        &self,
        ray: &UnitRay,
        from: Option<OuterState>,
        mut core: impl FnMut(f64, f64) -> Option<(f64, T)>,
    ) -> Inward<(f64, T)> {
        let end = self.end(ray);
        // What is inside is near, as a rule; a ray along the axis is not followed for all of its way.
        let near = end.min(self.period);
        let first = core(0.0, near);
        // Beyond the first thing inside nothing counts.
        let limit = first.as_ref().map_or(end, |(t, _)| *t);
        let leaves = self.leave_before(ray, from, limit);
        match (leaves, first) {
            (Leaves::Outer(hit), first) if hit.t <= near || first.is_some() => Inward::Outer(hit),
            (Leaves::Outer(hit), _) => match core(near, hit.t) {
                Some(core) => Inward::Core(core),
                None => Inward::Outer(hit),
            },
            (Leaves::Not, Some(first)) => Inward::Core(first),
            (Leaves::Never, first) => first
                .or_else(|| core(near, f64::INFINITY))
                .map_or(Inward::Lost, Inward::Core),
            (Leaves::Not | Leaves::Lost, _) => Inward::Lost,
        }
    }

    /// Beyond which nothing of the surface is met.
    pub(super) fn end(&self, ray: &UnitRay) -> f64 {
        let circle = ray.inside_circle(self.rho_max);
        circle.map_or(0.0, |(_, t1)| t1.max(0.0))
    }

    /// Where a ray inside leaves the fiber up to `limit`, which is no farther than its end: a march along a sector needs one.
    pub(super) fn leave_before(
        &self,
        ray: &UnitRay,
        from: Option<OuterState>,
        limit: f64,
    ) -> Leaves {
        let inner = ray.inside_circle(self.rho_min).filter(|&(_, t1)| t1 > 0.0);
        match (&self.clearance, from) {
            (Some(clearance), None) => {
                let begin = clearance.until(ray, Side::Inside, 0.0, limit);
                if begin > limit {
                    return Leaves::Not;
                }
                // The cells' half planes tell no side beyond the axis.
                if begin < f64::INFINITY && inner.is_none_or(|(_, t1)| t1 <= begin) {
                    let start = (self.locate(ray.at(begin)), StartOn::Nothing);
                    return self.leave_within(ray, begin, start, limit);
                }
            }
            (Some(clearance), Some(_)) => {
                if let Some(stop) = clearance.dive(ray, Side::Inside, limit) {
                    let start = self.start(ray, 0.0, from, Side::Inside);
                    return self.leave_within(ray, 0.0, start, stop);
                }
            }
            (None, _) => {}
        }
        if ray.c >= self.rho_min * self.rho_min || inner.is_none() {
            let start = self.start(ray, 0.0, from, Side::Inside);
            let stop = inner.map_or(limit, |(t0, _)| t0.max(0.0).min(limit));
            match self.leave_within(ray, 0.0, start, stop) {
                Leaves::Not => {}
                leaves => return leaves,
            }
        }
        // The circle inside lies within all scales.
        let far = match inner {
            Some((_, f64::INFINITY)) => return Leaves::Never,
            Some((_, t1)) if t1 < limit => t1,
            _ => return Leaves::Not,
        };
        let start = (self.locate(ray.at(far)), StartOn::Nothing);
        self.leave_within(ray, far, start, limit)
    }

    /// A march inside from `begin` up to `limit`.
    fn leave_within(
        &self,
        ray: &UnitRay,
        begin: f64,
        (cell, on): (Cell, StartOn),
        limit: f64,
    ) -> Leaves {
        match self.march(ray, begin, cell, Side::Inside, on, limit) {
            March::Through => Leaves::Not,
            march => outer_hit(march).map_or(Leaves::Lost, Leaves::Outer),
        }
    }
}

/// What becomes of a ray on its way out.
pub(super) enum Leaves {
    Outer(OuterHit),
    /// Not up to the limit.
    Not,
    /// It runs along the axis.
    Never,
    Lost,
}
