//! What the parts of a fiber are made of, where that is not plain keratin and air.
//!
//! A part has an outside ([`Boundary`]) and an inside ([`Filling`]). Values that may differ by color
//! are linear R, G, B; a structure in which any do is baked once a channel.

use super::Structure;
use serde::Serialize;

/// A value for each of linear R, G and B.
pub type Rgb = [f64; 3];

/// Materials of the parts of a fiber. The default is keratin as the rest of the [`Structure`]
/// describes it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Materials {
    /// The scale faces, and what lies under them down to the cortex (meshes only: the cortex of a
    /// procedural fiber reaches to its surface).
    pub cuticle: Material,
    /// The risers at the free edges of scales; as the faces if `None`.
    pub riser: Option<Boundary>,
    /// Between cuticle and medulla, and between the voids of the medulla. Its boundary only exists
    /// in meshes.
    pub cortex: Material,
    /// A medulla without voids.
    pub medulla: Material,
    /// The voids of the medulla: their walls and what fills them.
    pub void: Material,
}

/// Outside and inside of one part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Material {
    /// Its outside.
    pub boundary: Boundary,
    /// GGX roughness (alpha) of the boundary, 0 smooth .. 1. `None`: what the [`super::Cuticle`] says of
    /// faces and risers, 0 elsewhere.
    pub roughness: Option<f64>,
    /// Its inside.
    pub filling: Filling,
}

/// What happens to light at a boundary, from either side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Boundary {
    /// Fresnel reflection and Snell refraction between the media of both sides.
    #[default]
    Dielectric,
    /// A layered cuticle: a stack of thin slabs that reflects more than one interface does. What
    /// passes is refracted into the medium behind, and goes straight where that is the same.
    Slab {
        /// How many slabs, 0.1..20; fractions as the fits of Yan et al. 2015 give them.
        layers: f64,
        /// Index of the slabs where both sides are the same medium.
        index: Rgb,
    },
    /// An opaque Lambertian reflector.
    Diffuse {
        /// Share reflected, 0..1.
        albedo: Rgb,
    },
    /// An opaque conductor.
    Metal {
        /// Real part n of the index.
        index: Rgb,
        /// Imaginary part k of the index.
        extinction: Rgb,
    },
}

/// What fills a part. `None`: as the rest of the structure says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Filling {
    /// Refractive index.
    pub index: Option<Rgb>,
    /// Absorption coefficient beside that of the pigment, per micrometer.
    pub absorption_per_um: Rgb,
    /// Scattering coefficient, per micrometer.
    pub scattering_per_um: Option<Rgb>,
    /// Henyey-Greenstein asymmetry of the scattering.
    pub asymmetry: Option<f64>,
}

impl Materials {
    /// Whether any value differs by color.
    pub fn is_colored(&self) -> bool {
        self.map(gray) != *self
    }

    /// Every color replaced.
    fn map(&self, f: impl Fn(Rgb) -> Rgb + Copy) -> Self {
        Self {
            cuticle: self.cuticle.map(f),
            riser: self.riser.map(|boundary| boundary.map(f)),
            cortex: self.cortex.map(f),
            medulla: self.medulla.map(f),
            void: self.void.map(f),
        }
    }
}

impl Material {
    fn map(&self, f: impl Fn(Rgb) -> Rgb + Copy) -> Self {
        Self {
            boundary: self.boundary.map(f),
            roughness: self.roughness,
            filling: Filling {
                index: self.filling.index.map(f),
                absorption_per_um: f(self.filling.absorption_per_um),
                scattering_per_um: self.filling.scattering_per_um.map(f),
                asymmetry: self.filling.asymmetry,
            },
        }
    }
}

impl Boundary {
    fn map(&self, f: impl Fn(Rgb) -> Rgb) -> Self {
        match *self {
            Self::Dielectric => Self::Dielectric,
            Self::Slab { layers, index } => Self::Slab {
                layers,
                index: f(index),
            },
            Self::Diffuse { albedo } => Self::Diffuse { albedo: f(albedo) },
            Self::Metal { index, extinction } => Self::Metal {
                index: f(index),
                extinction: f(extinction),
            },
        }
    }
}

impl Structure {
    /// Whether materials differ by color, so that each channel needs its own bake.
    pub fn is_colored(&self) -> bool {
        self.materials.is_colored()
    }

    /// The structure as light of one color sees it, with gray materials.
    ///
    /// * `channel`: 0 red, 1 green, 2 blue.
    pub fn channel(&self, channel: usize) -> Self {
        Self {
            materials: self.materials.map(|rgb| [rgb[channel.min(2)]; 3]),
            ..self.clone()
        }
    }
}

/// The red value for all: a gray value stays what it is, to the bit.
fn gray(rgb: Rgb) -> Rgb {
    [rgb[0]; 3]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn color_anywhere_is_found_and_channels_are_gray() {
        let gold = Boundary::Metal {
            index: [0.2, 0.4, 1.4],
            extinction: [3.2, 2.4, 1.9],
        };
        let cases = [
            Materials {
                riser: Some(gold),
                ..Materials::default()
            },
            Materials {
                void: Material {
                    filling: Filling {
                        scattering_per_um: Some([0.1, 0.1, 0.2]),
                        ..Filling::default()
                    },
                    ..Material::default()
                },
                ..Materials::default()
            },
            Materials {
                cortex: Material {
                    filling: Filling {
                        absorption_per_um: [0.0, 0.0, 1e-4],
                        ..Filling::default()
                    },
                    ..Material::default()
                },
                ..Materials::default()
            },
        ];
        assert!(!Materials::default().is_colored());
        for materials in cases {
            let structure = Structure {
                materials,
                ..Structure::default()
            };
            assert!(structure.is_colored());
            for c in 0..3 {
                assert!(!structure.channel(c).is_colored());
                assert_ne!(structure.channel(c), structure);
            }
            assert_ne!(structure.channel(0), structure.channel(2));
        }
    }
}
