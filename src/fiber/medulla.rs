//! The core of the fiber: nothing, a homogeneous medium, or voids in a matrix of keratin.

mod channel;
mod cloisonne;
mod columns;
mod detail;
mod edge;
mod globules;
mod lattice;
mod pieces;
mod rim;
mod trace;

pub(super) use detail::Homogeneous;
#[cfg(test)]
pub(super) use detail::equivalent;
pub(super) use edge::{Edge, Part};
pub(super) use pieces::Pieces;
pub(super) use rim::Rim;

use super::bodies::Bodies;
use super::cells::Cells;
use super::convex::Convex;
use super::froth::Froth;
use super::ladder::{self, Ladder};
use super::packing::Recipe;
use super::section::{Section, UnitRay};
use super::surface::Surface;
use super::{FiberError, Region};
use crate::species::{MedullaKind, Structure};
use glam::{DVec2, DVec3};

/// What fills the medulla.
#[derive(Clone, Debug)]
pub(super) enum Voids {
    /// Nothing but, perhaps, a homogeneous medium.
    None,
    Ladder(Ladder),
    Froth(Froth),
    /// Voids of any shape, or pieces of a homogeneous medium.
    Bodies(Box<Bodies>),
}

/// The medulla of a fiber.
#[derive(Clone, Debug)]
pub(super) struct Medulla {
    /// Radius in units of the section's; 0 for none.
    pub(super) ratio: f64,
    /// Its outline in a section that is no ellipse; without one the circle of that radius in the
    /// unit-circle frame.
    pub(super) rim: Option<Box<Rim>>,
    /// Radius of a circle in the unit-circle frame that holds it.
    reach: f64,
    pub(super) voids: Voids,
    /// The medium, where there is one instead of voids.
    pub(super) medium: Option<Homogeneous>,
    /// Where along the hair it is; `None` for everywhere.
    pub(super) pieces: Option<Pieces>,
}

/// The room that voids may take in one period.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room<'a> {
    /// Semi-axes of the ellipse across, the largest there is in a section of another shape,
    /// micrometers.
    semi: DVec2,
    /// How far voids may reach in such a section.
    edge: Option<&'a Edge>,
    period: f64,
    seed: u64,
}

/// Least cortex between voids and cuticle, micrometers; lattices come nearer.
const LEAST_CORTEX_UM: f64 = 1.0;
const LEAST_CORTEX_OF_LATTICE_UM: f64 = 0.5;
/// Length of a period in pitches or cells, and least length without scales in micrometers. Fewer
/// repeat visibly.
const RUNGS: f64 = 10.0;
const LEAST_PERIOD_UM: f64 = 100.0;
/// Least length of a period with scales, in pitches or cells: bodies must be shorter than half of it.
const LEAST_RUNGS: f64 = 4.0;
/// Median radius of bubbles that have no size of their own: deviation of its logarithm.
const AMORPHOUS_SIGMA: f64 = 0.35;
/// Depth of the dents in the wall of a froth, as a share of the radius.
const FROTH_WOBBLE: f64 = 0.1;

/// Distance along the hair after which the voids are others, micrometers.
fn unit_um(structure: &Structure) -> f64 {
    match structure.medulla.kind {
        MedullaKind::Ladder { pitch_um, .. }
        | MedullaKind::Multiserial { pitch_um, .. }
        | MedullaKind::SChannel { pitch_um }
        | MedullaKind::Cloisonne { pitch_um, .. }
        | MedullaKind::TireTread { pitch_um, .. } => pitch_um,
        MedullaKind::Lattice { cell_um, .. } => 1.2 * cell_um,
        MedullaKind::Globules { spacing, .. } => {
            spacing * structure.medulla.ratio * structure.diameter_um
        }
        MedullaKind::Froth { radius_um, .. } | MedullaKind::Amorphous { radius_um, .. } => {
            1.2 * radius_um
        }
        MedullaKind::None | MedullaKind::Medium { .. } => 0.0,
    }
}

impl Medulla {
    /// No medulla.
    pub(super) fn none() -> Self {
        Self {
            ratio: 0.0,
            rim: None,
            reach: 0.0,
            voids: Voids::None,
            medium: None,
            pieces: None,
        }
    }

    /// Length of a period: that of the scales as often as the medulla needs, or what suits the medulla
    /// where there are no scales.
    pub(super) fn period_um(structure: &Structure, scales_um: Option<f64>) -> f64 {
        if structure.medulla.ratio <= 0.0 {
            return scales_um.unwrap_or(LEAST_PERIOD_UM);
        }
        let unit = unit_um(structure);
        let pieces = pieces::least_period_um(structure.medulla.continuity);
        match scales_um {
            Some(scales) => scales * (pieces.max(LEAST_RUNGS * unit) / scales).ceil().max(1.0),
            None => {
                let whole = match structure.medulla.kind {
                    MedullaKind::Ladder { .. } => RUNGS * unit,
                    _ => (RUNGS * unit).max(LEAST_PERIOD_UM),
                };
                whole * (pieces / whole).ceil().max(1.0)
            }
        }
    }

    /// * `surface`: the cuticle.
    pub(super) fn new(
        structure: &Structure,
        section: &Section,
        surface: &Surface,
        period: f64,
        seed: u64,
    ) -> Result<Self, FiberError> {
        let medulla = &structure.medulla;
        let ratio = medulla.ratio;
        if ratio <= 0.0 || medulla.kind == MedullaKind::None {
            return Ok(Self::none());
        }
        // At the waist a cuticle is as far away as the section is thin there.
        let rho_min = surface.rho_min() / section.rho_min();
        let least_radius = rho_min * section.b;
        if ratio * section.b >= least_radius - 0.02 {
            return Err(FiberError::MedullaTooWide {
                medulla_um: ratio * section.b,
                cuticle_um: least_radius,
            });
        }
        let cortex = match medulla.kind {
            MedullaKind::Lattice { .. } => LEAST_CORTEX_OF_LATTICE_UM,
            _ => LEAST_CORTEX_UM,
        };
        let axes = DVec2::new(section.a, section.b);
        let edge = match surface {
            Surface::Scales(scales) if !section.is_ellipse() => {
                let width = match medulla.kind {
                    MedullaKind::Ladder { .. } => ladder::WIDTH,
                    MedullaKind::SChannel { .. } => channel::WIDTH,
                    _ => 1.0,
                };
                Some(Edge::new(section, scales, width * ratio, cortex))
            }
            _ => None,
        };
        let semi = match &edge {
            Some(edge) => edge.inscribed(axes) * axes,
            None => ratio.min(rho_min - cortex / section.b).max(0.0) * axes,
        };
        let room = Room {
            semi,
            edge: edge.as_ref(),
            period,
            seed,
        };
        let rim = edge.as_ref().map(|_| Box::new(Rim::new(section, ratio)));
        let pieces = Pieces::new(medulla.continuity, period, seed);
        let radius = ratio * (section.a * section.b).sqrt();
        let medium = detail::medium(medulla, radius, period);
        let mut core = Self {
            ratio,
            reach: rim.as_ref().map_or(ratio, |rim| rim.reach()),
            rim,
            voids: Voids::None,
            medium,
            pieces,
        };
        if medium.is_none() {
            core.voids = core.build(structure, section, &room)?;
        } else if let Some(pieces) = &core.pieces {
            let rods = match &edge {
                Some(edge) => pieces.rods_within(edge),
                None => pieces.rods(ratio * axes),
            };
            let half = (core.reach * axes).to_array();
            core.voids = Voids::Bodies(Box::new(Bodies::new(rods, period, half, true)));
        }
        Ok(core)
    }

    /// The voids of a kind that has some.
    fn build(
        &self,
        structure: &Structure,
        section: &Section,
        room: &Room<'_>,
    ) -> Result<Voids, FiberError> {
        let (period, seed) = (room.period, room.seed);
        let filling = |all: Vec<Convex>, unions, cells: Option<Cells>| {
            let kept = self.within_pieces(all, |c| c.center.z);
            let half = (self.reach * DVec2::new(section.a, section.b)).to_array();
            let bodies = Bodies::new(kept, period, half, unions);
            // Cells fill the medulla as a whole, not in pieces.
            let cells = cells.filter(|_| self.pieces.is_none());
            Voids::Bodies(Box::new(bodies.with_cells(cells)))
        };
        let bodies = |all: Vec<Convex>, unions| filling(all, unions, None);
        Ok(match structure.medulla.kind {
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
                let radii = (self.ratio, room.semi.y / section.b);
                let mut ladder = Ladder::new(radii, period, count as usize, septum_um, seed);
                if let Some(pieces) = &self.pieces {
                    ladder.keep(|z| pieces.holds(z));
                }
                match room.edge {
                    Some(edge) => bodies(ladder.within(&edge.parts()), true),
                    None => Voids::Ladder(ladder),
                }
            }
            MedullaKind::Multiserial {
                cell_um,
                pitch_um,
                septum_um,
            } => bodies(
                columns::multiserial(cell_um, pitch_um, septum_um).build(room)?,
                false,
            ),
            MedullaKind::TireTread {
                pitch_um,
                cell_um,
                septum_um,
            } => bodies(
                columns::tire_tread(cell_um, pitch_um, septum_um).build(room)?,
                false,
            ),
            MedullaKind::Lattice { cell_um, wall_um } => {
                let lattice = lattice::build(room, cell_um, wall_um)?;
                filling(lattice.voids, false, lattice.cells)
            }
            MedullaKind::SChannel { pitch_um } => {
                let channel = channel::build(room, pitch_um);
                filling(channel.voids, true, channel.cells)
            }
            MedullaKind::Cloisonne {
                columns,
                pitch_um,
                height_um,
            } => {
                let ovals = cloisonne::Ovals {
                    columns,
                    pitch_um,
                    height_um,
                };
                bodies(ovals.build(room)?, true)
            }
            MedullaKind::Globules { spacing, film_um } => {
                bodies(globules::build(room, spacing, film_um)?, false)
            }
            MedullaKind::Amorphous {
                radius_um,
                air_fraction,
            } => self.froth(section, room, [radius_um, AMORPHOUS_SIGMA, air_fraction])?,
            MedullaKind::Froth {
                radius_um,
                radius_sigma,
                air_fraction,
            } => self.froth(section, room, [radius_um, radius_sigma, air_fraction])?,
            MedullaKind::None | MedullaKind::Medium { .. } => Voids::None,
        })
    }

    fn froth(
        &self,
        section: &Section,
        room: &Room<'_>,
        [radius_um, radius_sigma, air_fraction]: [f64; 3],
    ) -> Result<Voids, FiberError> {
        let whole = [[0.0, room.period]];
        let recipe = Recipe {
            radius_um,
            radius_sigma,
            air_fraction,
            area: std::f64::consts::PI * self.ratio * self.ratio * section.a * section.b,
            semi: room.semi,
            edge: room.edge,
            axes: DVec2::new(section.a, section.b),
            wobble: FROTH_WOBBLE,
            period: room.period,
            spans: self.pieces.as_ref().map_or(&whole, Pieces::spans),
        };
        let spheres = recipe
            .pack(room.seed)
            .map_err(|reached| FiberError::FrothTooDense {
                asked: air_fraction,
                reached,
            })?;
        let half = [self.reach * section.a, self.reach * section.b];
        Ok(Voids::Froth(Froth::new(spheres, room.period, half)))
    }

    /// Those voids that lie in a piece of the medulla: pieces end at whole voids.
    fn within_pieces<T>(&self, mut all: Vec<T>, z: impl Fn(&T) -> f64) -> Vec<T> {
        if let Some(pieces) = &self.pieces {
            all.retain(|item| pieces.holds(z(item)));
        }
        all
    }

    /// Whether the outline is the boundary of a medium that runs through.
    #[inline]
    pub(super) fn outlined(&self) -> bool {
        self.medium.is_some() && self.pieces.is_none()
    }

    /// What lies in the bodies: air, or a homogeneous medium that comes in pieces.
    #[inline]
    pub(super) fn fill(&self) -> Region {
        if self.medium.is_some() {
            Region::Medulla
        } else {
            Region::Void
        }
    }

    /// Share of the medulla's volume that is voids.
    pub(super) fn air_fraction(&self, section: &Section, period: f64) -> f64 {
        match &self.voids {
            _ if self.medium.is_some() => 0.0,
            Voids::None => 0.0,
            Voids::Ladder(ladder) => ladder.air_fraction(self.ratio),
            Voids::Froth(froth) => {
                let across = std::f64::consts::PI * self.ratio * self.ratio;
                froth.volume() / (across * section.a * section.b * period)
            }
            Voids::Bodies(bodies) => {
                let axes = DVec2::new(section.a, section.b);
                let area = std::f64::consts::PI * self.ratio * self.ratio * axes.element_product();
                detail::measured_air(bodies, self.reach * axes, area, period)
            }
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
