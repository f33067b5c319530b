//! The outer boundary: a bare elliptical cylinder or one with scales.

use super::march::{March, Side, StartOn};
use super::scales::{Cell, Scales, at};
use super::section::{UnitRay, nearest_period, smaller};
use glam::DVec3;

/// The outer boundary in the unit-circle frame.
#[derive(Clone, Debug)]
pub(super) enum Surface {
    Smooth,
    Scales(Box<Scales>),
}

/// What of the outer boundary a ray starts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OuterState {
    Smooth,
    Face {
        sector: u16,
        strip: u16,
    },
    /// The riser above a strip.
    Riser {
        sector: u16,
        strip: u16,
        solid_below: bool,
    },
}

/// A hit of the outer boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct OuterHit {
    pub(super) t: f64,
    /// In the unit-circle frame, not normalized, of either sign.
    pub(super) gradient: DVec3,
    pub(super) state: OuterState,
}

/// What a ray inside the fiber comes to.
pub(super) enum Inward<T> {
    Outer(OuterHit),
    Core(T),
    Lost,
}

impl Surface {
    /// Largest radius in units of the semi-axes.
    pub(super) fn rho_max(&self) -> f64 {
        match self {
            Self::Smooth => 1.0,
            Self::Scales(s) => s.rho_max,
        }
    }

    /// Smallest radius.
    pub(super) fn rho_min(&self) -> f64 {
        match self {
            Self::Smooth => 1.0,
            Self::Scales(s) => s.rho_min,
        }
    }

    /// Whether a point is inside.
    pub(super) fn contains(&self, p: DVec3) -> bool {
        match self {
            Self::Smooth => p.x * p.x + p.y * p.y < 1.0,
            Self::Scales(s) => s.contains(p),
        }
    }

    /// Where a ray outside enters the fiber.
    pub(super) fn enter(&self, ray: &UnitRay, from: Option<OuterState>) -> Option<OuterHit> {
        match self {
            Self::Smooth => {
                let (t, _) = ray.inside_circle(1.0)?;
                // The section is convex: a ray that starts on it and leaves is gone.
                (from.is_none() && t >= 0.0).then(|| smooth_hit(ray, t))
            }
            Self::Scales(scales) => scales.enter(ray, from, f64::INFINITY),
        }
    }

    /// Where a ray inside goes: through `core`, asked for the part of the ray within all scales, or out.
    pub(super) fn leave<T>(
        &self,
        ray: &UnitRay,
        from: Option<OuterState>,
        core: impl FnOnce(f64, f64) -> Option<T>,
    ) -> Inward<T> {
        match self {
            Self::Smooth => leave_smooth(ray, from, core),
            Self::Scales(scales) => scales.leave(ray, from, core),
        }
    }
}

fn smooth_hit(ray: &UnitRay, t: f64) -> OuterHit {
    let p = ray.at(t);
    OuterHit {
        t,
        gradient: DVec3::new(p.x, p.y, 0.0),
        state: OuterState::Smooth,
    }
}

fn leave_smooth<T>(
    ray: &UnitRay,
    from: Option<OuterState>,
    core: impl FnOnce(f64, f64) -> Option<T>,
) -> Inward<T> {
    let UnitRay { a, b, c, .. } = *ray;
    if a < 1e-30 {
        return core(0.0, f64::INFINITY).map_or(Inward::Lost, Inward::Core);
    }
    let t = if from.is_some() {
        // The root at the start is known; the other follows without loss of digits.
        -2.0 * b / a
    } else {
        (-b + (b * b - a * (c - 1.0)).max(0.0).sqrt()) / a
    };
    let t = t.max(0.0);
    match core(0.0, t) {
        Some(hit) => Inward::Core(hit),
        None => Inward::Outer(smooth_hit(ray, t)),
    }
}

impl Scales {
    /// The cell in which a ray starts on `side`, and what of it the start lies on.
    pub(super) fn start(
        &self,
        ray: &UnitRay,
        t: f64,
        from: Option<OuterState>,
        side: Side,
    ) -> (Cell, StartOn) {
        match from {
            Some(OuterState::Face { sector, strip }) => {
                let cell = self.image_near(sector, strip, ray.at(t), true);
                (cell, StartOn::Face)
            }
            Some(OuterState::Riser {
                sector,
                strip,
                solid_below,
            }) => {
                let below = self.image_near(sector, strip, ray.at(t), false);
                if solid_below == (side == Side::Inside) {
                    (below, StartOn::Upper)
                } else {
                    (self.above(below), StartOn::Lower)
                }
            }
            Some(OuterState::Smooth) | None => (self.locate(ray.at(t)), StartOn::Nothing),
        }
    }

    /// Where a ray outside enters the surface up to `limit`.
    pub(super) fn enter(
        &self,
        ray: &UnitRay,
        from: Option<OuterState>,
        limit: f64,
    ) -> Option<OuterHit> {
        let (t0, t1) = ray.inside_circle(self.rho_max)?;
        if t1 <= 0.0 {
            return None;
        }
        let mut begin = t0.max(0.0);
        // The cells' half planes tell no side beyond the axis: end within all scales, where
        // the ray has entered for certain.
        let mut end = match ray.inside_circle(self.rho_min) {
            Some((inner, _)) if inner > begin => inner,
            _ => t1,
        };
        end = smaller(end, limit);
        match (&self.clearance, from) {
            (Some(clearance), None) => {
                begin = clearance.until(ray, Side::Outside, begin, end);
                if begin > end {
                    return None;
                }
            }
            (Some(clearance), Some(_)) => {
                end = clearance.dive(ray, Side::Outside, end).unwrap_or(end);
            }
            (None, _) => {}
        }
        let (cell, on) = self.start(ray, begin, from, Side::Outside);
        outer_hit(self.march(ray, begin, cell, Side::Outside, on, end))
    }

    /// The periodic image of a strip that a point on its face or its upper end belongs to.
    fn image_near(&self, sector: u16, strip: u16, p: DVec3, face: bool) -> Cell {
        let (sector, strip) = (usize::from(sector), usize::from(strip));
        let mut cell = Cell {
            sector,
            strip,
            shift: 0.0,
        };
        let u = self.across(sector, p.x, p.y);
        let s = self.strip(cell);
        let mut z = at(s.end, u);
        if face {
            z = 0.5 * (z + at(s.begin, u));
        }
        cell.shift = nearest_period(p.z - z, self.period);
        cell
    }

    fn leave<T>(
        &self,
        ray: &UnitRay,
        from: Option<OuterState>,
        core: impl FnOnce(f64, f64) -> Option<T>,
    ) -> Inward<T> {
        let inner = ray.inside_circle(self.rho_min).filter(|&(_, t1)| t1 > 0.0);
        // In the shell first, unless the ray starts within all scales.
        if ray.c >= self.rho_min * self.rho_min || inner.is_none() {
            let (cell, on) = self.start(ray, 0.0, from, Side::Inside);
            let limit = inner.map_or_else(|| self.end(ray), |(t0, _)| t0.max(0.0));
            match self.march(ray, 0.0, cell, Side::Inside, on, limit) {
                March::Through => {}
                march => return outer_hit(march).map_or(Inward::Lost, Inward::Outer),
            }
        }
        let Some((t0, t1)) = inner else {
            return Inward::Lost;
        };
        if let Some(hit) = core(t0.max(0.0), t1) {
            return Inward::Core(hit);
        }
        if t1 == f64::INFINITY {
            return Inward::Lost;
        }
        let cell = self.locate(ray.at(t1));
        let march = self.march(
            ray,
            t1,
            cell,
            Side::Inside,
            StartOn::Nothing,
            self.end(ray).max(t1),
        );
        outer_hit(march).map_or(Inward::Lost, Inward::Outer)
    }
}

pub(super) fn outer_hit(march: March) -> Option<OuterHit> {
    match march {
        March::Through | March::Lost => None,
        March::Face { t, cell, gradient } => Some(OuterHit {
            t,
            gradient,
            state: OuterState::Face {
                sector: cell.sector as u16,
                strip: cell.strip as u16,
            },
        }),
        March::Riser {
            t,
            cell,
            solid_below,
            gradient,
        } => Some(OuterHit {
            t,
            gradient,
            state: OuterState::Riser {
                sector: cell.sector as u16,
                strip: cell.strip as u16,
                solid_below,
            },
        }),
    }
}
