//! The outline of a medulla in a section that is no ellipse: the section's own shape in the small.

use crate::fiber::pattern::Pattern;
use crate::fiber::scales::Scales;
use crate::fiber::section::{Line, Section, UnitRay};
use crate::fiber::surface::{Inward, OuterState, Surface};
use glam::DVec3;

/// A cylinder over the outline, in the unit-circle frame.
#[derive(Clone, Debug)]
pub(in crate::fiber) struct Rim {
    surface: Surface,
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
            surface: Surface::Scales(Box::new(Scales::new(&bare, &lines))),
        }
    }

    /// Radius of a circle that holds it.
    pub(super) fn reach(&self) -> f64 {
        self.surface.rho_max()
    }

    /// Whether a point is inside.
    pub(in crate::fiber) fn holds(&self, unit: DVec3) -> bool {
        self.surface.contains(unit)
    }

    /// Where a ray outside enters it.
    ///
    /// * `from`: what of it the ray starts on.
    pub(in crate::fiber) fn enter(
        &self,
        ray: &UnitRay,
        from: Option<OuterState>,
    ) -> Option<(f64, OuterState)> {
        let hit = self.surface.enter(ray, from)?;
        Some((hit.t, hit.state))
    }

    /// Where a ray inside leaves it.
    pub(in crate::fiber) fn leave(
        &self,
        ray: &UnitRay,
        from: Option<OuterState>,
    ) -> Option<(f64, OuterState)> {
        match self.surface.leave(ray, from, |_, _| None::<()>) {
            Inward::Outer(hit) => Some((hit.t, hit.state)),
            Inward::Core(()) | Inward::Lost => None,
        }
    }

    /// Outward normal at a point on it, in the unit-circle frame, of any length.
    pub(in crate::fiber) fn gradient(&self, p: DVec3) -> DVec3 {
        match &self.surface {
            Surface::Smooth => p.with_z(0.0),
            Surface::Scales(scales) => scales.face_gradient(scales.locate(p), p),
        }
    }
}
