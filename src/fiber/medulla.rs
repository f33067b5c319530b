//! The core of the fiber: nothing, a homogeneous medium, or voids in a matrix of keratin.

use super::froth::Froth;
use super::ladder::Ladder;
use super::packing::Recipe;
use super::section::{Section, UnitRay};
use super::{FiberError, Region};
use crate::species::{MedullaKind, Structure};
use glam::DVec3;

/// What fills the medulla.
#[derive(Clone, Debug)]
pub(super) enum Voids {
    /// A homogeneous medium.
    None,
    Ladder(Ladder),
    Froth(Froth),
}

/// The medulla of a fiber.
#[derive(Clone, Debug)]
pub(super) struct Medulla {
    /// Radius in units of the semi-axes; 0 for none.
    pub(super) ratio: f64,
    /// Pigment of the walls between voids above that of the cortex, -1 for clear walls.
    excess_pigment: f64,
    pub(super) voids: Voids,
}

/// Least cortex between voids and cuticle, micrometers (voids nearer are only known of lattices).
const LEAST_CORTEX_UM: f64 = 1.0;
/// Length of a period without scales, in pitches of a ladder, and least length in micrometers.
const RUNGS: f64 = 10.0;
const LEAST_PERIOD_UM: f64 = 100.0;

impl Medulla {
    /// Length of a period that suits the medulla alone.
    pub(super) fn period_um(structure: &Structure) -> f64 {
        match structure.medulla.kind {
            MedullaKind::Ladder { pitch_um, .. } => RUNGS * pitch_um,
            MedullaKind::Froth { radius_um, .. } => (12.0 * radius_um).max(LEAST_PERIOD_UM),
            _ => LEAST_PERIOD_UM,
        }
    }

    /// * `rho_min`: least radius of the cuticle in units of the semi-axes.
    pub(super) fn new(
        structure: &Structure,
        section: &Section,
        rho_min: f64,
        period: f64,
        seed: u64,
    ) -> Result<Self, FiberError> {
        let medulla = &structure.medulla;
        let ratio = medulla.ratio;
        if ratio <= 0.0 || medulla.kind == MedullaKind::None {
            return Ok(Self {
                ratio: 0.0,
                excess_pigment: 0.0,
                voids: Voids::None,
            });
        }
        let least_radius = rho_min * section.b;
        if ratio * section.b >= least_radius - 0.02 {
            return Err(FiberError::MedullaTooWide {
                medulla_um: ratio * section.b,
                cuticle_um: least_radius,
            });
        }
        let voids = match medulla.kind {
            MedullaKind::Ladder {
                pitch_um,
                septum_um,
            } => {
                let count = (period / pitch_um).round().max(2.0);
                if septum_um >= 0.9 * period / count {
                    return Err(FiberError::SeptumTooThick {
                        septum_um,
                        pitch_um: period / count,
                    });
                }
                Voids::Ladder(Ladder::new(ratio, period, count as usize, septum_um, seed))
            }
            MedullaKind::Froth {
                radius_um,
                radius_sigma,
                air_fraction,
            } => {
                let reach = ratio.min(rho_min - LEAST_CORTEX_UM / section.b);
                let recipe = Recipe {
                    radius_um,
                    radius_sigma,
                    air_fraction,
                    ratio,
                    reach: reach.max(0.0),
                    period,
                };
                let packing =
                    recipe
                        .pack(section, seed)
                        .map_err(|reached| FiberError::FrothTooDense {
                            asked: air_fraction,
                            reached,
                        })?;
                Voids::Froth(Froth::new(packing, section, ratio))
            }
            _ => Voids::None,
        };
        Ok(Self {
            ratio,
            excess_pigment: medulla.pigment - 1.0,
            voids,
        })
    }

    /// Whether it is one medium with an outline of its own. The walls between voids are cortex.
    #[inline]
    pub(super) fn homogeneous(&self) -> bool {
        matches!(self.voids, Voids::None)
    }

    /// What the walls between voids add to the pigment along a ray through keratin from 0 to `t`.
    #[inline]
    pub(super) fn extra_pigment(&self, ray: &UnitRay, t: f64) -> f64 {
        if self.excess_pigment == 0.0 || self.homogeneous() {
            return 0.0;
        }
        // The medulla is convex: from one place in it to another all of the way is.
        let end = ray.c + t * (2.0 * ray.b + t * ray.a);
        if ray.c.max(end) <= self.ratio * self.ratio {
            return self.excess_pigment * t;
        }
        ray.inside_circle(self.ratio).map_or(0.0, |(a, b)| {
            self.excess_pigment * (b.min(t) - a.max(0.0)).max(0.0)
        })
    }

    /// Share of the medulla's volume that is voids.
    pub(super) fn air_fraction(&self, section: &Section, period: f64) -> f64 {
        match &self.voids {
            Voids::None => 0.0,
            Voids::Ladder(ladder) => ladder.air_fraction(self.ratio),
            Voids::Froth(froth) => {
                let across = std::f64::consts::PI * self.ratio * self.ratio;
                froth.volume() / (across * section.a * section.b * period)
            }
        }
    }

    /// First void that a ray in the matrix enters in `t0..t1`.
    #[inline]
    pub(super) fn enter_void(
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
                let (a, b) = rays.unit.inside_circle(self.ratio)?;
                let (t0, t1) = (t0.max(a), t1.min(b));
                (t0 < t1)
                    .then(|| froth.enter(rays.origin, rays.dir, t0, t1, from))
                    .flatten()
            }
        }
    }

    /// Where a ray in a void leaves it, and the void. `from` is the void whose boundary it starts on.
    #[inline]
    pub(super) fn leave_void(&self, rays: &Rays, from: Option<u32>) -> Option<(f64, u32)> {
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
        }
    }

    /// Outward gradient of a void's boundary in the unit-circle frame at a point.
    #[inline]
    pub(super) fn void_gradient(&self, section: &Section, point: DVec3, index: u32) -> DVec3 {
        match &self.voids {
            Voids::None => DVec3::Z,
            Voids::Ladder(ladder) => {
                let unit = section.unit_point(point);
                ladder
                    .puck(index)
                    .gradient(unit, ladder.center_near(index, point.z))
            }
            Voids::Froth(froth) => {
                let n = point - froth.center_near(index, point.z);
                DVec3::new(n.x * section.a, n.y * section.b, n.z)
            }
        }
    }

    /// The region of a point inside the cuticle.
    pub(super) fn region_at(&self, section: &Section, point: DVec3) -> Region {
        let unit = section.unit_point(point);
        let void = match &self.voids {
            Voids::None => None,
            Voids::Ladder(ladder) => ladder.at(unit),
            Voids::Froth(froth) => froth.at(point),
        };
        if void.is_some() {
            Region::Void
        } else if self.homogeneous() && unit.x * unit.x + unit.y * unit.y < self.ratio * self.ratio
        {
            Region::Medulla
        } else {
            Region::Cortex
        }
    }
}

/// A ray in both frames.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rays {
    pub(super) origin: DVec3,
    pub(super) dir: DVec3,
    pub(super) unit: UnitRay,
}
