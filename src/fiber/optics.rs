//! What regions and boundaries do to light of one color.

use super::medulla::Homogeneous;
use crate::species::{Boundary, Filling, Rgb, Structure};

/// What fills the space between boundaries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// Around the fiber: air, or what it is mounted in.
    Outside,
    /// A layer between the outer surface and the cortex; only meshes have one.
    Cuticle,
    /// Pigmented keratin: cuticle, cortex, and the medulla's walls between its voids.
    Cortex,
    /// A medulla without voids: a homogeneous scattering medium.
    Medulla,
    /// A void of the medulla.
    Void,
}

impl Region {
    /// How many there are.
    pub const COUNT: usize = 5;
}

/// The part whose outside a boundary is: says what it is made of. See [`super::Fiber::optics`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The outer surface: a bare one, or the faces of scales.
    Scale,
    /// The riser at the free edge of a scale.
    Riser,
    /// The cortex under a cuticle of its own (meshes).
    Cortex,
    /// The outline of a medulla without voids.
    Medulla,
    /// The wall of a void.
    Void,
}

impl Part {
    /// How many there are.
    pub const COUNT: usize = 5;
}

/// Optical properties of a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Refractive index.
    pub ior: f64,
    /// Pigment relative to the cortex: scales the absorbing path length.
    pub pigment: f64,
    /// Absorption coefficient beside the pigment's, per micrometer.
    pub absorption_per_um: f64,
    /// Scattering coefficient per micrometer, 0 for clear media.
    pub scattering_per_um: f64,
    /// Henyey-Greenstein asymmetry of the scattering.
    pub asymmetry: f64,
}

/// What a boundary does to light. The media on both sides say which indices meet there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Optics {
    /// Reflects and refracts.
    Dielectric {
        /// GGX roughness (alpha), 0 smooth.
        roughness: f64,
    },
    /// Thin layers: reflects, or lets through to the medium behind.
    Slab {
        /// How many, fractions allowed.
        layers: f64,
        /// Their index where both sides are the same medium.
        ior: f64,
        /// GGX roughness (alpha), 0 smooth.
        roughness: f64,
    },
    /// Opaque, reflects by Lambert's law.
    Diffuse {
        /// Share reflected, 0..1.
        albedo: f64,
    },
    /// Opaque, reflects as a conductor.
    Metal {
        /// Real part of the index.
        ior: f64,
        /// Imaginary part of the index.
        extinction: f64,
        /// GGX roughness (alpha), 0 smooth.
        roughness: f64,
    },
}

/// Channel of colored materials that a fiber is built with if not told otherwise: green.
const GREEN: usize = 1;

/// Media and boundaries of a fiber, indexed by [`Region`] and [`Part`].
#[derive(Clone, Copy, Debug)]
pub(super) struct OpticalParts {
    pub(super) media: [Medium; Region::COUNT],
    /// Index of the second region over that of the first.
    pub(super) eta: [[f64; Region::COUNT]; Region::COUNT],
    pub(super) boundaries: [Optics; Part::COUNT],
}

impl OpticalParts {
    /// Those of a structure; of its green channel where materials differ by color.
    ///
    /// * `medium`: what the medulla is made of where it has no voids.
    pub(super) fn new(structure: &Structure, medium: Option<&Homogeneous>) -> Self {
        let media = media(structure, medium);
        Self {
            media,
            eta: indices_between(&media),
            boundaries: boundaries(structure),
        }
    }

    /// Another medium than air around the fiber.
    pub(super) fn mount(&mut self, ior: f64) {
        self.media[Region::Outside as usize].ior = ior;
        self.eta = indices_between(&self.media);
    }
}

fn indices_between(media: &[Medium; Region::COUNT]) -> [[f64; Region::COUNT]; Region::COUNT] {
    media.map(|near| media.map(|far| far.ior / near.ior))
}

fn media(structure: &Structure, medium: Option<&Homogeneous>) -> [Medium; Region::COUNT] {
    let (materials, medulla) = (&structure.materials, &structure.medulla);
    let clear = |ior, pigment| Medium {
        ior,
        pigment,
        absorption_per_um: 0.0,
        scattering_per_um: 0.0,
        asymmetry: 0.0,
    };
    let keratin = fill(clear(structure.ior, 1.0), &materials.cortex.filling);
    let core = medium.map_or(clear(keratin.ior, 1.0), |m| Medium {
        pigment: m.pigment,
        scattering_per_um: m.scattering_per_um,
        asymmetry: m.asymmetry,
        ..clear(keratin.ior, 0.0)
    });
    [
        clear(1.0, 0.0),
        fill(clear(structure.ior, 0.0), &materials.cuticle.filling),
        keratin,
        fill(core, &materials.medulla.filling),
        fill(clear(medulla.void_ior, 0.0), &materials.void.filling),
    ]
}

/// What a filling changes in a medium.
fn fill(base: Medium, filling: &Filling) -> Medium {
    let green = |rgb: Rgb| rgb[GREEN];
    Medium {
        ior: filling.index.map_or(base.ior, green),
        pigment: base.pigment,
        absorption_per_um: green(filling.absorption_per_um),
        scattering_per_um: filling
            .scattering_per_um
            .map_or(base.scattering_per_um, green),
        asymmetry: filling.asymmetry.unwrap_or(base.asymmetry),
    }
}

fn boundaries(structure: &Structure) -> [Optics; Part::COUNT] {
    let (materials, cuticle) = (&structure.materials, &structure.cuticle);
    let scales = &materials.cuticle;
    // A coat of the scales covers their risers.
    let riser = materials.riser.unwrap_or(scales.boundary);
    let of =
        |part: &crate::species::Material| optics(&part.boundary, part.roughness.unwrap_or(0.0));
    [
        optics(
            &scales.boundary,
            scales.roughness.unwrap_or(cuticle.roughness),
        ),
        optics(&riser, cuticle.riser_roughness),
        of(&materials.cortex),
        of(&materials.medulla),
        of(&materials.void),
    ]
}

fn optics(boundary: &Boundary, roughness: f64) -> Optics {
    match *boundary {
        Boundary::Dielectric => Optics::Dielectric { roughness },
        Boundary::Slab { layers, index } => Optics::Slab {
            layers,
            ior: index[GREEN],
            roughness,
        },
        Boundary::Diffuse { albedo } => Optics::Diffuse {
            albedo: albedo[GREEN],
        },
        Boundary::Metal { index, extinction } => Optics::Metal {
            ior: index[GREEN],
            extinction: extinction[GREEN],
            roughness,
        },
    }
}
