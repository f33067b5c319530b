//! A ray from boundary to boundary of a fiber.

use super::medulla::Rays;
use super::section::UnitRay;
use super::surface::{Inward, OuterHit, OuterState, Surface};
use super::triangles::Turns;
use super::{Element, Fiber, Hit, HitState, Part, Region};
use glam::DVec3;

/// What [`Fiber::next_hit`] is asked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub(crate) origin: DVec3,
    pub(crate) dir: DVec3,
    pub(crate) region: Region,
    pub(crate) from: Option<HitState>,
}

impl Ray {
    /// The triangle of a mesh that it starts on.
    pub(super) fn triangle(&self) -> Option<(u32, Part)> {
        match self.from?.element {
            Element::Triangle { source, part } => Some((source, part)),
            _ => None,
        }
    }
}

impl Fiber {
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
            let ray = Ray {
                origin,
                dir,
                region,
                from,
            };
            return Some(self.with_pigment(&ray, triangles.next_hit(&ray)?));
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
                // Voids lie within all scales: what else a ray from one meets there comes first.
                let deep = self.section.is_ellipse() && matches!(element, Some(Element::Void(_)));
                let found = deep
                    .then(|| self.core_hit(&rays, 0.0, f64::INFINITY, element))
                    .flatten();
                let core = |t0, t1| match deep {
                    true => None,
                    false => self.core_hit(&rays, t0, t1, element),
                };
                let inward = match (found, &self.surface) {
                    (Some(hit), _) => Inward::Core(hit),
                    (None, Surface::Scales(scales)) if !self.section.is_ellipse() => {
                        scales.leave_around(&rays.unit, outer, core)
                    }
                    (None, surface) => surface.leave(&rays.unit, outer, core),
                };
                match inward {
                    Inward::Outer(hit) => self.outer_hit(&rays, hit, Region::Outside),
                    Inward::Core((t, element @ (Element::Outline | Element::Rim(_)))) => {
                        self.outline_hit(&rays, t, element, Region::Medulla)
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

    /// A triangle that a ray has met, with the pigment on the way.
    #[inline]
    pub(super) fn with_pigment(&self, ray: &Ray, hit: Hit) -> Hit {
        let pigment_um = self.pigment_um(ray.origin, ray.dir, ray.region, hit.t);
        Hit { pigment_um, ..hit }
    }

    /// Searches of several rays by turns, where that is faster than one after the other.
    pub(crate) fn turns(&self) -> Option<Turns<'_>> {
        let triangles = self.triangles.as_ref()?;
        Some(Turns::new(self, triangles))
    }

    /// The way of a ray that ends within `region`, at a scattering, times the pigment along it,
    /// relative to the cortex, micrometers. See [`Hit::pigment_um`].
    ///
    /// * `t`: length of the way, micrometers, no longer than to the next boundary.
    pub fn pigment_um(&self, origin: DVec3, dir: DVec3, region: Region, t: f64) -> f64 {
        if self.modeled().is_some() {
            return t * self.medium(region).pigment;
        }
        // Streaks and walls turn with the section, by a few degrees at most along one way: as in the
        // middle of it all along.
        let middle = origin.z + 0.5 * t * dir.z;
        let (origin, dir) = (self.untwisted(origin, middle), self.untwisted(dir, middle));
        let rays = Rays {
            origin,
            dir,
            unit: self.section.unit_ray(origin, dir),
        };
        self.pigment_on(&rays, region, t)
    }

    /// Pigment at a point of `region`, relative to the cortex as a whole: over a way finer than any
    /// streak, outward.
    ///
    /// * `point`: micrometers, in the fiber's frame.
    pub fn pigment_at(&self, point: DVec3, region: Region) -> f64 {
        const STEP_UM: f64 = 0.2;
        if region != Region::Cortex {
            return self.medium(region).pigment;
        }
        let dir = DVec3::new(point.x, point.y, 0.0).normalize_or(DVec3::X);
        let from = point - 0.5 * STEP_UM * dir;
        self.pigment_um(from, dir, region, STEP_UM) / STEP_UM
    }

    #[inline]
    fn pigment_on(&self, rays: &Rays, region: Region, t: f64) -> f64 {
        match region {
            Region::Outside | Region::Cuticle | Region::Void => 0.0,
            Region::Medulla => t * self.medium(region).pigment,
            Region::Cortex => {
                let pieces = self.medulla.pieces.as_ref();
                match &self.medulla.rim {
                    Some(rim) => self.pigment.along_shaped(&rays.unit, t, pieces, rim),
                    None => self.pigment.along(&rays.unit, t, pieces),
                }
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
        if let Some(rim) = &self.medulla.rim
            && self.medulla.outlined()
        {
            let from = match from {
                Some(Element::Rim(state)) => Some(state),
                _ => None,
            };
            let (t, state) = rim.enter(&rays.unit, from, f64::INFINITY)?;
            return (t >= t0 && t < t1).then_some((t, Element::Rim(state)));
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
        if let Some(rim) = &self.medulla.rim {
            let from = match from {
                Some(Element::Rim(state)) => Some(state),
                _ => None,
            };
            let (t, state) = rim.leave(&rays.unit, from, rim.end(&rays.unit))?;
            return Some(self.outline_hit(rays, t, Element::Rim(state), Region::Cortex));
        }
        let UnitRay { a, b, c, .. } = rays.unit;
        let t = if from == Some(Element::Outline) {
            -2.0 * b / a
        } else {
            let c = c - self.medulla.ratio * self.medulla.ratio;
            (-b + (b * b - a * c).max(0.0).sqrt()) / a
        };
        // An axial ray stays inside for ever.
        t.is_finite()
            .then(|| self.outline_hit(rays, t.max(0.0), Element::Outline, Region::Cortex))
    }

    fn outer_hit(&self, rays: &Rays, hit: OuterHit, to: Region) -> Hit {
        let part = match hit.state {
            OuterState::Riser { .. } => Part::Riser,
            OuterState::Smooth | OuterState::Face { .. } => Part::Scale,
        };
        let element = Element::Outer(hit.state);
        self.hit(rays, hit.t, hit.gradient, to, part, element)
    }

    fn outline_hit(&self, rays: &Rays, t: f64, element: Element, to: Region) -> Hit {
        let p = rays.unit.at(t);
        let gradient = match &self.medulla.rim {
            Some(rim) => rim.gradient(p),
            None => DVec3::new(p.x, p.y, 0.0),
        };
        self.hit(rays, t, gradient, to, Part::Medulla, element)
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
