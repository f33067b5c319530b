//! The micro-structure of one period of a hair as closed geometry that rays can be traced through.
//!
//! Fiber frame: +Z is the tangent, root to tip; micrometers. The geometry repeats along z with
//! [`Fiber::period_um`]; rays may start and end at any z.

mod bodies;
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
mod packing;
mod pattern;
mod scales;
mod section;
mod surface;
mod triangles;
mod voronoi;

#[cfg(test)]
mod tests;

pub use error::FiberError;
pub use mesh::MeshPart;
pub use optics::{Medium, Optics, Part, Region};
pub use triangles::{MeshError, Places};

use crate::species::{CuticlePattern, FiberMesh, MedullaKind, Structure};
use bodies::Bodies;
use cortex::Pigment;
use glam::DVec3;
use medulla::{Homogeneous, Medulla, Rays};
use optics::OpticalParts;
use pattern::Pattern;
use scales::Scales;
use section::{Section, UnitRay};
use surface::{Inward, OuterHit, OuterState, Surface};
use triangles::Triangles;

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
    /// Stands in for all of these where the fiber is a designer's mesh.
    triangles: Option<Box<Triangles>>,
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
            Surface::Scales(Box::new(Scales::new(&pattern, &lines)))
        });
        let bounding_radius_um = match &surface {
            Surface::Scales(scales) if !section.is_ellipse() => {
                scales.bounding_um([section.a, section.b])
            }
            _ => section.a * surface.rho_max(),
        };
        let medulla = Medulla::new(structure, &section, surface.rho_min(), period_um, seed)?;
        let cortex = (medulla.ratio, surface.rho_min());
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
            period_um,
            bounding_radius_um,
            optics,
        })
    }

    fn from_mesh(mesh: &FiberMesh, structure: &Structure) -> Result<Self, FiberError> {
        let triangles = Triangles::new(mesh, &structure.medulla)?;
        let section = Section::of(structure)?;
        let medium = match structure.medulla.kind {
            MedullaKind::Medium {
                scattering_per_um,
                asymmetry,
            } => Some(Homogeneous {
                scattering_per_um,
                asymmetry,
                pigment: structure.medulla.pigment,
            }),
            _ => None,
        };
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
            period_um,
            optics: OpticalParts::new(structure, medium.as_ref()),
        })
    }

    /// What was mended in a designer's mesh or is odd about it, one sentence each.
    pub fn warnings(&self) -> &[String] {
        self.triangles.as_ref().map_or(&[], |t| &t.warnings)
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
        if let Some(triangles) = &self.triangles {
            return triangles.semi_axes_um;
        }
        self.section.half_extents()
    }

    /// Whether a point is within the outline of the medulla.
    pub fn is_in_medulla(&self, point: DVec3) -> bool {
        if let Some(triangles) = &self.triangles {
            return matches!(triangles.region_at(point), Region::Medulla | Region::Void);
        }
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
    /// for every pattern here: none of them winds round the shaft. A designer's mesh may.
    pub fn is_mirror_symmetric(&self) -> bool {
        self.triangles.is_none()
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

    /// Share of the medulla's volume that is voids, gaps between its pieces counted; 0 without voids.
    pub fn air_fraction(&self) -> f64 {
        if let Some(triangles) = &self.triangles {
            return triangles.air_fraction;
        }
        self.medulla.air_fraction(&self.section, self.period_um)
    }

    /// The next boundary of a ray that travels in `region` from `origin` along unit `dir`.
    ///
    /// * `from`: the state of the hit the ray starts from; `None` for a ray that comes from far away
    ///   or starts inside a medium.
    /// * `None`: the ray leaves to infinity (in `Outside`), or, in any other region, a boundary was
    ///   missed: the photon is lost.
    pub fn next_hit(
        &self,
        origin: DVec3,
        dir: DVec3,
        region: Region,
        from: Option<HitState>,
    ) -> Option<Hit> {
        if let Some(triangles) = &self.triangles {
            let mut hit = triangles.next_hit(origin, dir, region, from)?;
            hit.pigment_um = hit.t * self.medium(region).pigment;
            return Some(hit);
        }
        let rays = Rays {
            origin,
            dir,
            unit: self.section.unit_ray(origin, dir),
        };
        let element = from.map(|f| f.element);
        let outer = match element {
            Some(Element::Outer(state)) => Some(state),
            _ => None,
        };
        let mut hit = match region {
            Region::Outside if from.is_none() => {
                // Far origins cost digits: start beside the axis, on the way in.
                let UnitRay { a, b, .. } = rays.unit;
                let ahead = if a > 0.0 { (-b / a).max(0.0) } else { 0.0 };
                let ahead = (ahead - 2.0 * self.surface.rho_max() / a.sqrt()).max(0.0);
                let mut hit = self.enter(origin + ahead * dir, dir, None)?;
                hit.t += ahead;
                hit
            }
            Region::Outside => self.enter(origin, dir, outer)?,
            Region::Cortex => {
                let core = |t0, t1| self.core_hit(&rays, t0, t1, element);
                match self.surface.leave(&rays.unit, outer, core) {
                    Inward::Outer(hit) => self.outer_hit(&rays, hit, Region::Outside),
                    Inward::Core((t, Element::Outline)) => {
                        self.outline_hit(&rays, t, Region::Medulla)
                    }
                    Inward::Core((t, element @ Element::Fusus(_))) => {
                        self.void_hit(&rays, t, element, Region::Void)
                    }
                    Inward::Core((t, element)) => {
                        self.void_hit(&rays, t, element, self.medulla.fill())
                    }
                    Inward::Lost => return None,
                }
            }
            // Only meshes have a cuticle of its own.
            Region::Cuticle => return None,
            Region::Medulla if self.medulla.outlined() => {
                self.outline_from_inside(&rays, element)?
            }
            Region::Medulla | Region::Void => {
                let (t, element) = self.leave_void(&rays, region, element)?;
                self.void_hit(&rays, t, element, Region::Cortex)
            }
        };
        hit.pigment_um = self.pigment_on(&rays, region, hit.t);
        Some(hit)
    }

    /// The way of a ray that ends within `region`, at a scattering, times the pigment along it,
    /// relative to the cortex, micrometers. See [`Hit::pigment_um`].
    ///
    /// * `t`: length of the way, micrometers, no longer than to the next boundary.
    pub fn pigment_um(&self, origin: DVec3, dir: DVec3, region: Region, t: f64) -> f64 {
        let rays = Rays {
            origin,
            dir,
            unit: self.section.unit_ray(origin, dir),
        };
        self.pigment_on(&rays, region, t)
    }

    #[inline]
    fn pigment_on(&self, rays: &Rays, region: Region, t: f64) -> f64 {
        if self.triangles.is_some() {
            return t * self.medium(region).pigment;
        }
        match region {
            Region::Outside | Region::Cuticle | Region::Void => 0.0,
            Region::Medulla => t * self.medium(region).pigment,
            Region::Cortex => {
                let pieces = self.medulla.pieces.as_ref();
                self.pigment.along(&rays.unit, t, pieces)
            }
        }
    }

    /// Where a ray outside enters the fiber.
    fn enter(&self, origin: DVec3, dir: DVec3, from: Option<OuterState>) -> Option<Hit> {
        let unit = self.section.unit_ray(origin, dir);
        let hit = self.surface.enter(&unit, from)?;
        Some(self.outer_hit(&Rays { origin, dir, unit }, hit, Region::Cortex))
    }

    /// What inside the fiber a ray in the cortex meets in `t0..t1`: the outline of a homogeneous medulla,
    /// a void of another, a fusus.
    fn core_hit(
        &self,
        rays: &Rays,
        t0: f64,
        t1: f64,
        from: Option<Element>,
    ) -> Option<(f64, Element)> {
        let core = self.medulla_hit(rays, t0, t1, from);
        let Some(fusi) = &self.fusi else {
            return core;
        };
        let from = match from {
            Some(Element::Fusus(face)) => Some(face),
            _ => None,
        };
        let t1 = core.map_or(t1, |(t, _)| t);
        let fusus = fusi.enter(rays.origin, rays.dir, t0, t1, from);
        fusus.map(|(t, face)| (t, Element::Fusus(face))).or(core)
    }

    fn medulla_hit(
        &self,
        rays: &Rays,
        t0: f64,
        t1: f64,
        from: Option<Element>,
    ) -> Option<(f64, Element)> {
        if self.medulla.ratio <= 0.0 {
            return None;
        }
        if self.medulla.outlined() {
            // The outline is convex: a ray that has just left it does not come back.
            if from == Some(Element::Outline) {
                return None;
            }
            let (t, _) = rays.unit.inside_circle(self.medulla.ratio)?;
            return (t >= t0 && t < t1).then_some((t, Element::Outline));
        }
        let from = match from {
            Some(Element::Void(index)) => Some(index),
            _ => None,
        };
        let (t, index) = self.medulla.enter_void(rays, t0, t1, from)?;
        Some((t, Element::Void(index)))
    }

    /// Where a ray in a void, or in a piece of a homogeneous medulla, leaves it.
    fn leave_void(
        &self,
        rays: &Rays,
        region: Region,
        from: Option<Element>,
    ) -> Option<(f64, Element)> {
        let void = match from {
            Some(Element::Fusus(face)) => {
                let hit = self.fusi.as_ref()?.leave(rays.origin, rays.dir, Some(face));
                return hit.map(|(t, face)| (t, Element::Fusus(face)));
            }
            Some(Element::Void(index)) => Some(index),
            _ => None,
        };
        if region == self.medulla.fill()
            && let Some((t, index)) = self.medulla.leave_void(rays, void)
        {
            return Some((t, Element::Void(index)));
        }
        let (t, face) = self.fusi.as_ref()?.leave(rays.origin, rays.dir, None)?;
        Some((t, Element::Fusus(face)))
    }

    /// Where a ray inside a homogeneous medulla leaves it.
    fn outline_from_inside(&self, rays: &Rays, from: Option<Element>) -> Option<Hit> {
        let UnitRay { a, b, c, .. } = rays.unit;
        let t = if from == Some(Element::Outline) {
            -2.0 * b / a
        } else {
            let c = c - self.medulla.ratio * self.medulla.ratio;
            (-b + (b * b - a * c).max(0.0).sqrt()) / a
        };
        // An axial ray stays inside for ever.
        t.is_finite()
            .then(|| self.outline_hit(rays, t.max(0.0), Region::Cortex))
    }

    fn outer_hit(&self, rays: &Rays, hit: OuterHit, to: Region) -> Hit {
        let part = match hit.state {
            OuterState::Riser { .. } => Part::Riser,
            OuterState::Smooth | OuterState::Face { .. } => Part::Scale,
        };
        let element = Element::Outer(hit.state);
        self.hit(rays, hit.t, hit.gradient, to, part, element)
    }

    fn outline_hit(&self, rays: &Rays, t: f64, to: Region) -> Hit {
        let p = rays.unit.at(t);
        let gradient = DVec3::new(p.x, p.y, 0.0);
        self.hit(rays, t, gradient, to, Part::Medulla, Element::Outline)
    }

    fn void_hit(&self, rays: &Rays, t: f64, element: Element, to: Region) -> Hit {
        let point = rays.origin + t * rays.dir;
        let gradient = match (element, &self.fusi) {
            (Element::Fusus(face), Some(fusi)) => {
                self.section.unit_gradient(fusi.gradient(face, point))
            }
            (Element::Void(index), _) => self.medulla.void_gradient(&self.section, point, index),
            _ => DVec3::Z,
        };
        let part = match element {
            Element::Void(_) if self.medulla.fill() == Region::Medulla => Part::Medulla,
            _ => Part::Void,
        };
        self.hit(rays, t, gradient, to, part, element)
    }

    /// `gradient`: normal of the boundary in the unit-circle frame, of any length and sign.
    fn hit(
        &self,
        rays: &Rays,
        t: f64,
        gradient: DVec3,
        to: Region,
        part: Part,
        element: Element,
    ) -> Hit {
        Hit {
            t,
            pigment_um: t,
            normal: self.section.normal_against(gradient, rays.dir),
            to,
            part,
            state: HitState { element },
        }
    }
}
