//! The micro-structure of one period of a hair as closed geometry that rays can be traced through.
//!
//! Fiber frame: +Z is the tangent, root to tip; micrometers. The geometry repeats along z with
//! [`Fiber::period_um`]; rays may start and end at any z.

mod bodies;
mod build;
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
use crate::species::{self, Structure};
use bodies::Bodies;
use build::medium_of_mesh;
use cortex::Pigment;
use glam::DVec3;
use medulla::Medulla;
use optics::OpticalParts;
use section::Section;
use surface::{OuterState, Surface};
use triangles::{Triangles, turned};

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
