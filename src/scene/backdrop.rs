//! What is behind the subject.

use super::Environment;
use crate::color::Rgb;
use glam::Vec3;

/// What the camera sees where there is no subject. It gives no light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Backdrop {
    /// The environment itself.
    Environment,
    /// One color.
    Plain(Rgb),
    /// Studio paper with a pool of light behind the subject: from one color in the middle of the
    /// picture to another at its corners.
    Glow {
        /// Radiance in the middle.
        center: Rgb,
        /// Radiance at the corners.
        edge: Rgb,
    },
}

impl Default for Backdrop {
    fn default() -> Self {
        Self::Glow {
            center: Rgb::new(0.42, 0.43, 0.45),
            edge: Rgb::new(0.10, 0.105, 0.115),
        }
    }
}

impl Backdrop {
    /// Radiance seen through a point of the picture.
    ///
    /// * `at`: 0..1 from the left and from the top.
    pub fn radiance(&self, environment: &Environment, dir: Vec3, at: [f32; 2]) -> Rgb {
        match self {
            Self::Environment => environment.smooth(dir),
            Self::Plain(color) => *color,
            Self::Glow { center, edge } => {
                let (x, y) = (2.0 * at[0] - 1.0, 2.0 * at[1] - 0.9);
                let far = (0.5 * (x * x + y * y)).clamp(0.0, 1.0);
                center.lerp(*edge, far * (2.0 - far))
            }
        }
    }
}
