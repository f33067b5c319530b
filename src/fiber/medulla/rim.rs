//! The outline of a medulla in a section that is no ellipse: the section's own shape in the small.

use crate::fiber::pattern::Pattern;
use crate::fiber::scales::Scales;
use crate::fiber::section::{Line, Section, UnitRay};
use crate::fiber::surface::OuterState;
use crate::fiber::waist::Leaves;
use glam::DVec3;

/// A cylinder over the outline, in the unit-circle frame.
#[derive(Clone, Debug)]
pub(in crate::fiber) struct Rim {
    scales: Scales,
}

impl Rim {
    /// * `ratio`: radius of the medulla over the section's.
    pub(super) fn new(section: &Section, ratio: f64) -> Self {
        let lines: Vec<Line> = (section.lines(section.line_count(true)).into_iter())
            .map(|line| Line {
                rho: ratio * line.rho,
                ..line
            })
            .collect();
        let bare = Pattern::bare(&lines, 1.0);
        Self {
            scales: Scales::new(&bare, &lines).with_clearance(),
        }
    }

    #[cfg(test)]
    pub(in crate::fiber) fn march_all_the_way(&mut self) {
        self.scales.clearance = None;
    }

    /// Radius of a circle that holds it.
    pub(super) fn reach(&self) -> f64 {
        self.scales.rho_max
    }

    /// Whether a point is inside.
    pub(in crate::fiber) fn holds(&self, unit: DVec3) -> bool {
        self.scales.contains(unit)
    }

    /// Beyond which a ray does not meet it.
    pub(in crate::fiber) fn end(&self, ray: &UnitRay) -> f64 {
        self.scales.end(ray)
    }

    /// Where a ray outside enters it up to `limit`.
    ///
    /// * `from`: what of it the ray starts on.
    pub(in crate::fiber) fn enter(
        &self,
        ray: &UnitRay,
        from: Option<OuterState>,
        limit: f64,
    ) -> Option<(f64, OuterState)> {
        let hit = self.scales.enter(ray, from, limit)?;
        Some((hit.t, hit.state))
    }

    /// Where a ray inside leaves it up to `limit`, no farther than its end.
    pub(in crate::fiber) fn leave(
        &self,
        ray: &UnitRay,
        from: Option<OuterState>,
        limit: f64,
    ) -> Option<(f64, OuterState)> {
        match self.scales.leave_before(ray, from, limit) {
            Leaves::Outer(hit) => Some((hit.t, hit.state)),
            Leaves::Not | Leaves::Never | Leaves::Lost => None,
        }
    }

    /// Outward normal at a point on it, in the unit-circle frame, of any length.
    pub(in crate::fiber) fn gradient(&self, p: DVec3) -> DVec3 {
        self.scales.face_gradient(self.scales.locate(p), p)
    }
}
