//! The micro-structure of one period of a hair as closed geometry that rays can be traced through.
//!
//! Fiber frame: +Z is the tangent, root to tip; micrometers. The geometry repeats along z with
//! [`Fiber::period_um`]; rays may start and end at any z.

mod bodies;
mod cells;
mod clearance;
mod convex;
mod cortex;
mod crossing;
mod error;
mod froth;
mod fusi;
mod grid;
mod ladder;
mod march;
mod medulla;
mod mesh;
mod optics;
mod outline;
#[cfg(target_arch = "x86_64")]
mod packet;
mod packing;
mod pattern;
mod scales;
mod section;
mod surface;
mod trace;
mod triangles;
mod voronoi;
mod waist;

#[cfg(test)]
mod tests;

pub use error::FiberError;
pub use mesh::MeshPart;
pub use optics::{Medium, Optics, Part, Region};
#[cfg(target_arch = "x86_64")]
pub(crate) use packet::{Hits, PacketShell, Rays};
pub(crate) use trace::Ray;
pub use triangles::{MeshError, Places};
pub(crate) use triangles::{SEARCHES, Turns};

use crate::math::symmetry::Symmetry;
use crate::species::{self, CuticlePattern, FiberMesh, MedullaKind, Structure};
use bodies::Bodies;
use cortex::Pigment;
use glam::DVec3;
use medulla::{Homogeneous, Medulla, Voids};
use optics::OpticalParts;
use pattern::Pattern;
use scales::Scales;
use section::Section;
use std::f64::consts::TAU;
use surface::{OuterState, Surface};
use triangles::{Maker, Triangles, turned, twisted};

/// A boundary met by a ray.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Distance along the ray, micrometers.
    pub t: f64,
    /// Unit geometric normal, against the ray (`dir . normal < 0`).
    pub normal: DVec3,
    /// The way to the hit times the pigment along it, relative to the cortex, micrometers. The
    /// walls between voids hold more or less pigment than the cortex but have no boundary with it.
    pub pigment_um: f64,
    /// The region on the far side.
    pub to: Region,
    /// The part whose outside was hit: says what the boundary does to light.
    pub part: Part,
    /// Opaque continuation state: which boundary element was hit, so that the next ray starts on it
    /// without finding it again.
    pub state: HitState,
}

/// Which boundary element a ray starts on. See [`Hit::state`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HitState {
    element: Element,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Element {
    Outer(OuterState),
    /// The outline of a medulla without voids.
    Outline,
    /// As much in a section that is no ellipse.
    Rim(OuterState),
    Void(u32),
    /// A face of a cortical fusus.
    Fusus(u32),
    /// Triangle of a designer's mesh.
    Triangle {
        source: u32,
        part: Part,
    },
}

/// One period of a fiber.
#[derive(Clone, Debug)]
pub struct Fiber {
    structure: Structure,
    section: Section,
    surface: Surface,
    medulla: Medulla,
    fusi: Option<Box<Bodies>>,
    pigment: Pigment,
    /// Stands in for all of these where the fiber is a designer's mesh, and is what they look like
    /// where it is twisted.
    triangles: Option<Box<Triangles>>,
    /// Radians per micrometer by which the section turns about the axis, counterclockwise seen from
    /// the tip.
    twist: f64,
    period_um: f64,
    bounding_radius_um: f64,
    optics: OpticalParts,
}

impl Fiber {
    /// Builds the geometry of a structure. `seed` places scales and voids.
    ///
    /// # Errors
    /// When the parts do not fit into each other: a section that folds over itself, scales higher than a third of the radius, a
    /// medulla that reaches the cuticle, septa thicker than the rungs' distance, cells wider than the
    /// medulla, films thicker than globules, a froth denser than spheres can be packed, fusi in a
    /// cortex thinner than they are.
    pub fn build(structure: &Structure, seed: u64) -> Result<Self, FiberError> {
        if let Some(mesh) = &structure.mesh {
            return Self::from_mesh(mesh, structure);
        }
        let mut fiber = Self::straight(structure, seed)?;
        fiber.twist = twist_of(structure);
        if fiber.twist != 0.0 {
            // No ray is straight in a frame that turns with the section: triangles are traced.
            let mesh = twisted(&fiber.mesh(), fiber.period_um, fiber.twist);
            let is_medium = fiber.medulla.medium.is_some();
            let own = Maker::Own {
                overlap: matches!(fiber.medulla.voids, Voids::Bodies(_)) || fiber.fusi.is_some(),
            };
            let triangles = Triangles::new(&mesh, is_medium, fiber.twist, own)?;
            fiber.triangles = Some(Box::new(triangles));
        }
        Ok(fiber)
    }

    /// The fiber without its twist.
    fn straight(structure: &Structure, seed: u64) -> Result<Self, FiberError> {
        let section = Section::of(structure)?;
        let cuticle = &structure.cuticle;
        if cuticle.pattern != CuticlePattern::Smooth && cuticle.height_um > section.b / 3.0 {
            return Err(FiberError::ScalesTooHigh {
                height_um: cuticle.height_um,
                radius_um: section.b,
            });
        }
        let flat = cuticle.height_um <= 0.0 || cuticle.pattern == CuticlePattern::Smooth;
        let lines = section.lines(section.line_count(flat));
        let mut pattern = if flat {
            None
        } else {
            Pattern::new(cuticle, &lines, section.circumference(), seed)
        };
        let period_um = Medulla::period_um(structure, pattern.as_ref().map(|p| p.period_um));
        if pattern.is_none() && !section.is_ellipse() {
            pattern = Some(Pattern::bare(&lines, period_um));
        }
        let surface = pattern.map_or(Surface::Smooth, |pattern| {
            let scales = Scales::new(&pattern, &lines);
            Surface::Scales(Box::new(match section.is_ellipse() {
                true => scales,
                false => scales.with_clearance(),
            }))
        });
        let bounding_radius_um = match &surface {
            Surface::Scales(scales) if !section.is_ellipse() => {
                scales.bounding_um([section.a, section.b])
            }
            _ => section.a * surface.rho_max(),
        };
        let medulla = Medulla::new(structure, &section, &surface, period_um, seed)?;
        let cortex = (medulla.ratio, surface.rho_min() / section.rho_min());
        let fusi = fusi::build(
            structure.cortex.fusi_per_mm,
            &section,
            cortex,
            period_um,
            seed,
        )?;
        let semi = [section.a, section.b];
        let pigment = Pigment::new(
            structure,
            (semi, &section.radii()),
            medulla.ratio,
            period_um,
            seed,
        );
        let optics = OpticalParts::new(structure, medulla.medium.as_ref());
        Ok(Self {
            structure: structure.clone(),
            section,
            surface,
            medulla,
            fusi: fusi.map(Box::new),
            pigment,
            triangles: None,
            twist: 0.0,
            period_um,
            bounding_radius_um,
            optics,
        })
    }

    fn from_mesh(mesh: &FiberMesh, structure: &Structure) -> Result<Self, FiberError> {
        let is_medium = matches!(structure.medulla.kind, MedullaKind::Medium { .. });
        let twist = twist_of(structure);
        let triangles = Triangles::new(mesh, is_medium, twist, Maker::Designer)?;
        let section = Section::of(structure)?;
        let medium = medium_of_mesh(structure);
        let period_um = triangles.period_um();
        Ok(Self {
            structure: structure.clone(),
            surface: Surface::Smooth,
            medulla: Medulla::none(),
            fusi: None,
            pigment: Pigment::new(
                structure,
                ([section.a, section.b], &[1.0]),
                0.0,
                period_um,
                0,
            ),
            section,
            bounding_radius_um: triangles.radius_um,
            triangles: Some(Box::new(triangles)),
            twist,
            period_um,
            optics: OpticalParts::new(structure, medium.as_ref()),
        })
    }

    /// The designer's mesh that it is, if it is one.
    fn modeled(&self) -> Option<&Triangles> {
        let triangles = self.triangles.as_deref();
        triangles.filter(|_| self.structure.mesh.is_some())
    }

    /// A point or direction at height `z` as it is without the twist.
    fn untwisted(&self, v: DVec3, z: f64) -> DVec3 {
        if self.twist == 0.0 {
            v
        } else {
            turned(v, -self.twist * z)
        }
    }

    /// What was mended in a designer's mesh or is odd about it, one sentence each.
    pub fn warnings(&self) -> &[String] {
        self.triangles.as_ref().map_or(&[], |t| &t.warnings)
    }

    /// The same fiber as light of one color sees it; itself where no material differs by color. In air.
    ///
    /// * `channel`: 0 red, 1 green, 2 blue.
    #[must_use]
    pub fn in_channel(mut self, channel: usize) -> Self {
        let structure = self.structure.channel(channel);
        let of_mesh = self.modeled().and_then(|_| medium_of_mesh(&structure));
        self.optics = OpticalParts::new(
            &structure,
            self.medulla.medium.as_ref().or(of_mesh.as_ref()),
        );
        self
    }

    /// The same fiber in another medium than air: the resin under a cover slip, water.
    ///
    /// * `ior`: refractive index of the medium, 1 or more.
    #[must_use]
    pub fn mounted_in(mut self, ior: f64) -> Self {
        self.optics.mount(ior);
        self
    }

    /// The structure it was built from.
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// Length of one period along z, micrometers; any length for a smooth cylinder.
    pub fn period_um(&self) -> f64 {
        self.period_um
    }

    /// Radius of a cylinder about z that holds the fiber closely, micrometers.
    pub fn bounding_radius_um(&self) -> f64 {
        self.bounding_radius_um
    }

    /// Half the extent of the mean section along x and y, micrometers: its semi-axes.
    pub fn semi_axes_um(&self) -> [f64; 2] {
        match self.modeled() {
            Some(triangles) => triangles.semi_axes_um,
            None => self.section.half_extents(),
        }
    }

    /// Whether a point is within the outline of the medulla.
    pub fn is_in_medulla(&self, point: DVec3) -> bool {
        if let Some(triangles) = self.modeled() {
            return matches!(triangles.region_at(point), Region::Medulla | Region::Void);
        }
        let point = self.untwisted(point, point.z);
        self.medulla.holds(self.section.unit_point(point))
    }

    /// Whether a hit was on the riser of a scale rather than on its face.
    pub fn is_riser(&self, state: HitState) -> bool {
        matches!(
            state.element,
            Element::Outer(OuterState::Riser { .. })
                | Element::Triangle {
                    part: Part::Riser,
                    ..
                }
        )
    }

    /// Whether mirroring phi -> -phi gives the same statistics, so that tables may be folded. Holds
    /// for every pattern here: none of them winds round the shaft. A twisted section does, and a
    /// designer's mesh may.
    pub fn is_mirror_symmetric(&self) -> bool {
        self.triangles.is_none()
    }

    /// The symmetry of the section, in statistics: scales, pieces of the medulla and streaks of pigment
    /// lie at random, and a mirror image is another hair of the same kind.
    pub fn symmetry(&self) -> Symmetry {
        if !self.is_mirror_symmetric() {
            return Symmetry::None;
        }
        match self.structure.section {
            species::Section::ConcavoConvex { .. } | species::Section::Bean { .. } => {
                Symmetry::MinorAxis
            }
            species::Section::Ellipse
            | species::Section::Superellipse { .. }
            | species::Section::DumbBell => Symmetry::BothAxes,
        }
    }

    /// Properties of a region.
    #[inline]
    pub fn medium(&self, region: Region) -> &Medium {
        &self.optics.media[region as usize]
    }

    /// What the boundary of a part does to light.
    #[inline]
    pub fn optics(&self, part: Part) -> &Optics {
        &self.optics.boundaries[part as usize]
    }

    /// Refractive index of `to` over that of `from`; 1 exactly where they are the same.
    #[inline]
    pub fn eta(&self, from: Region, to: Region) -> f64 {
        self.optics.eta[from as usize][to as usize]
    }

    /// The region that holds a point, found from the shapes alone, without any ray.
    pub fn region_at(&self, point: DVec3) -> Region {
        if let Some(triangles) = &self.triangles {
            return triangles.region_at(point);
        }
        let unit = self.section.unit_point(point);
        if !self.surface.contains(unit) {
            Region::Outside
        } else if self.fusi.as_ref().is_some_and(|f| f.at(point).is_some()) {
            Region::Void
        } else {
            self.medulla.region_at(&self.section, point)
        }
    }

    /// The refractive index, over that of the medium around it, of a fiber that is a smooth circular cylinder
    /// of evenly pigmented keratin and nothing else, denser than what is around it; `None` for all others.
    pub fn bare_cylinder(&self) -> Option<f64> {
        let eta = self.eta(Region::Outside, Region::Cortex);
        let cortex = self.medium(Region::Cortex);
        let is_bare = self.triangles.is_none()
            && matches!(self.surface, Surface::Smooth)
            && self.section.is_circle()
            && self.medulla.ratio <= 0.0
            && self.fusi.is_none()
            && self.pigment.is_even()
            && *self.optics(Part::Scale) == (Optics::Dielectric { roughness: 0.0 })
            && (cortex.absorption_per_um, cortex.scattering_per_um) == (0.0, 0.0)
            && eta > 1.0;
        is_bare.then_some(eta)
    }

    /// Share of the medulla's volume that is voids, gaps between its pieces counted; 0 without voids.
    pub fn air_fraction(&self) -> f64 {
        if let Some(triangles) = self.modeled() {
            return triangles.air_fraction;
        }
        self.medulla.air_fraction(&self.section, self.period_um)
    }
}

/// What a mesh's outline of a medulla holds if that is a medium.
fn medium_of_mesh(structure: &Structure) -> Option<Homogeneous> {
    match structure.medulla.kind {
        MedullaKind::Medium {
            scattering_per_um,
            asymmetry,
        } => Some(Homogeneous {
            scattering_per_um,
            asymmetry,
            pigment: structure.medulla.pigment,
        }),
        _ => None,
    }
}

/// Radians per micrometer.
fn twist_of(structure: &Structure) -> f64 {
    TAU * structure.twist_turns_per_cm * 1e-4
}
