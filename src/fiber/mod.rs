//! The micro-structure of one period of a hair as closed geometry that rays can be traced through.
//!
//! Fiber frame: +Z is the tangent, root to tip; micrometers. The geometry repeats along z with
//! [`Fiber::period_um`]; rays may start and end at any z.

use crate::species::Structure;
use glam::DVec3;

/// What fills the space between boundaries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// Air around the fiber.
    Outside,
    /// Cuticle and cortex: pigmented keratin.
    Cortex,
    /// Medulla: a homogeneous scattering medium with the cortex's index.
    Medulla,
    /// A void of the medulla.
    Void,
}

/// Optical properties of a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Refractive index.
    pub ior: f64,
    /// Pigment relative to the cortex: scales the absorbing path length.
    pub pigment: f64,
    /// Scattering coefficient per micrometer, 0 for clear media.
    pub scattering_per_um: f64,
    /// Henyey-Greenstein asymmetry of the scattering.
    pub asymmetry: f64,
}

/// A boundary met by a ray.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Distance along the ray, micrometers.
    pub t: f64,
    /// Unit geometric normal, against the ray (`dir . normal < 0`).
    pub normal: DVec3,
    /// The region on the far side.
    pub to: Region,
    /// GGX roughness (alpha) of the boundary, 0 smooth.
    pub roughness: f64,
    /// Opaque continuation state: which boundary element was hit, so that the next ray starts on it
    /// without finding it again.
    pub state: HitState,
}

/// See [`Hit::state`].
#[derive(Clone, Copy, Debug, Default)]
pub struct HitState {
    /// Which boundary and element; meaning private to `fiber`.
    pub element: u32,
}

/// One period of a fiber.
#[derive(Clone, Debug)]
pub struct Fiber {
    structure: Structure,
}

/// A structure that cannot be built.
#[derive(Debug, thiserror::Error)]
pub enum FiberError {
    /// The scales are higher than the fiber is wide, or similar.
    #[error("the structure cannot be built: {0}")]
    Impossible(String),
}

impl Fiber {
    /// Builds the geometry of a structure. `seed` places scales and voids.
    pub fn build(structure: &Structure, seed: u64) -> Result<Self, FiberError> {
        let _ = seed;
        Ok(Self {
            structure: structure.clone(),
        })
    }

    /// The structure it was built from.
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// Length of one period along z, micrometers; any length for a smooth cylinder.
    pub fn period_um(&self) -> f64 {
        100.0
    }

    /// Radius of the smallest cylinder about z that holds the fiber, micrometers.
    pub fn bounding_radius_um(&self) -> f64 {
        0.5 * self.structure.diameter_um * self.structure.aspect.sqrt()
    }

    /// Whether mirroring phi -> -phi gives the same statistics, so that tables may be folded.
    pub fn is_mirror_symmetric(&self) -> bool {
        true
    }

    /// Properties of a region.
    pub fn medium(&self, region: Region) -> Medium {
        let ior = if region == Region::Outside {
            1.0
        } else {
            self.structure.ior
        };
        Medium {
            ior,
            pigment: 1.0,
            scattering_per_um: 0.0,
            asymmetry: 0.0,
        }
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
        let _ = from;
        let radius = 0.5 * self.structure.diameter_um;
        let a = dir.x * dir.x + dir.y * dir.y;
        let b = origin.x * dir.x + origin.y * dir.y;
        let c = origin.x * origin.x + origin.y * origin.y - radius * radius;
        let root = (b * b - a * c).max(0.0).sqrt();
        let t = if region == Region::Outside {
            (-b - root) / a
        } else {
            (-b + root) / a
        };
        if region == Region::Outside && (b * b < a * c || t <= 1e-9 * radius) {
            return None;
        }
        let p = origin + t * dir;
        let n = DVec3::new(p.x, p.y, 0.0).normalize();
        let (normal, to) = match region {
            Region::Outside => (n, Region::Cortex),
            _ => (-n, Region::Outside),
        };
        Some(Hit {
            t,
            normal,
            to,
            roughness: 0.0,
            state: HitState::default(),
        })
    }
}
