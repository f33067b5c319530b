//! Environments that need no file.

use super::{Environment, texel_direction};
use crate::color::Rgb;
use glam::Vec3;
use rayon::prelude::*;

/// A lamp with soft edges in a studio.
struct Panel {
    /// Azimuth from the camera (+Z) toward +X, and elevation, degrees.
    toward: [f32; 2],
    /// Half width and half height, degrees.
    half: [f32; 2],
    /// Share of the half size over which the edge falls off.
    softness: f32,
    radiance: Rgb,
}

/// A photographer's set for fur: one large key light up to the left of the camera for form, two
/// narrow strips behind the subject whose light passes through the tips and draws the rim, and a
/// weak large fill that keeps shadows open.
const STUDIO: [Panel; 4] = [
    Panel {
        toward: [-42.0, 42.0],
        half: [26.0, 20.0],
        softness: 0.5,
        radiance: Rgb::new(7.6, 7.3, 6.9),
    },
    Panel {
        toward: [152.0, 28.0],
        half: [7.0, 30.0],
        softness: 0.35,
        radiance: Rgb::new(26.0, 26.5, 28.0),
    },
    Panel {
        toward: [-140.0, 38.0],
        half: [8.0, 22.0],
        softness: 0.35,
        radiance: Rgb::new(15.0, 15.3, 16.0),
    },
    Panel {
        toward: [68.0, 8.0],
        half: [28.0, 30.0],
        softness: 0.9,
        radiance: Rgb::new(0.62, 0.66, 0.72),
    },
];

impl Environment {
    /// Names of those that need no file.
    pub const BUILT_IN: [&str; 4] = ["studio", "sky", "white", "black"];

    /// Radiance 1 from everywhere: in it a lossless subject cannot be seen.
    pub fn white() -> Self {
        Self::from_texels(1, 1, vec![Rgb::ONE])
    }

    /// No light at all, to be lit by lamps.
    pub fn black() -> Self {
        Self::from_texels(1, 1, vec![Rgb::ZERO])
    }

    /// A photo studio seen from a camera on the +Z side; turn it along with the camera.
    pub fn studio() -> Self {
        raster(1024, 512, studio_radiance)
    }
}

/// An environment of a function of direction, averaged over 3 x 3 points in each texel.
pub(super) fn raster(
    width: usize,
    height: usize,
    radiance: impl Fn(Vec3) -> Rgb + Sync,
) -> Environment {
    const GRID: usize = 3;
    let texels = (0..width * height)
        .into_par_iter()
        .map(|i| {
            let mut sum = Rgb::ZERO;
            for k in 0..GRID * GRID {
                let (dx, dy) = (k % GRID, k / GRID);
                let x = ((i % width) * GRID + dx) as f64 + 0.5;
                let y = ((i / width) * GRID + dy) as f64 + 0.5;
                let d = texel_direction(x / (width * GRID) as f64, y / (height * GRID) as f64);
                sum += radiance(d);
            }
            sum / (GRID * GRID) as f32
        })
        .collect();
    Environment::from_texels(width, height, texels)
}

fn studio_radiance(dir: Vec3) -> Rgb {
    // Walls: a dim gray room, lighter above than below.
    let wall = Rgb::new(0.16, 0.165, 0.175).lerp(Rgb::splat(0.05), 0.5 - 0.5 * dir.y);
    STUDIO.iter().fold(wall, |sum, panel| {
        sum + panel.radiance * panel_coverage(panel, dir)
    })
}

/// 1 inside a panel, 0 outside, smooth between.
fn panel_coverage(panel: &Panel, dir: Vec3) -> f32 {
    let [azimuth, elevation] = panel.toward.map(f32::to_radians);
    let center = Vec3::new(
        azimuth.sin() * elevation.cos(),
        elevation.sin(),
        azimuth.cos() * elevation.cos(),
    );
    let right = Vec3::Y.cross(center).normalize_or(Vec3::X);
    let up = center.cross(right);
    let depth = dir.dot(center);
    if depth <= 0.0 {
        return 0.0;
    }
    let falloff = |across: f32, half: f32| {
        let x = (across.atan2(depth).abs() / half.to_radians() - 1.0) / panel.softness;
        let t = (0.5 - x).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    };
    falloff(dir.dot(right), panel.half[0]) * falloff(dir.dot(up), panel.half[1])
}
