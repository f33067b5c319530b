//! Environments that need no file.

use super::Environment;
use crate::color::Rgb;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

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
        raster(1024, 512, studio_radiance())
    }
}

/// An environment of a function of direction, averaged over 3 x 3 points in each texel.
pub(super) fn raster(
    width: usize,
    height: usize,
    radiance: impl Fn(Vec3) -> Rgb + Sync,
) -> Environment {
    const GRID: usize = 3;
    let turns = |count: usize, whole: f64, from: f64| -> Vec<(f64, f64)> {
        let at = |i: usize| ((i as f64 + 0.5) / count as f64 + from) * whole;
        (0..count).map(|i| at(i).sin_cos()).collect()
    };
    let across = turns(width * GRID, TAU, -0.5);
    let down = turns(height * GRID, PI, 0.0);
    let texels = (0..width * height)
        .into_par_iter()
        .map(|i| {
            let mut sum = Rgb::ZERO;
            for (sin_t, cos_t) in &down[i / width * GRID..][..GRID] {
                for (sin_p, cos_p) in &across[i % width * GRID..][..GRID] {
                    sum += radiance(DVec3::new(sin_t * sin_p, *cos_t, -sin_t * cos_p).as_vec3());
                }
            }
            sum / (GRID * GRID) as f32
        })
        .collect();
    Environment::from_texels(width, height, texels)
}

/// Light from a direction in the studio.
fn studio_radiance() -> impl Fn(Vec3) -> Rgb + Sync {
    let panels = STUDIO.map(|panel| Hung::new(&panel));
    move |dir| {
        // Walls: a dim gray room, lighter above than below.
        let wall = Rgb::new(0.16, 0.165, 0.175).lerp(Rgb::splat(0.05), 0.5 - 0.5 * dir.y);
        panels.iter().fold(wall, |sum, panel| {
            sum + panel.radiance * panel.coverage(dir)
        })
    }
}

/// A panel with the axes that it is seen along: toward it, to its right and up.
struct Hung {
    axes: [Vec3; 3],
    /// Half width and half height, radians.
    half: [f32; 2],
    softness: f32,
    radiance: Rgb,
}

impl Hung {
    fn new(panel: &Panel) -> Self {
        let [azimuth, elevation] = panel.toward.map(f32::to_radians);
        let center = Vec3::new(
            azimuth.sin() * elevation.cos(),
            elevation.sin(),
            azimuth.cos() * elevation.cos(),
        );
        let right = Vec3::Y.cross(center).normalize_or(Vec3::X);
        Self {
            axes: [center, right, center.cross(right)],
            half: panel.half.map(f32::to_radians),
            softness: panel.softness,
            radiance: panel.radiance,
        }
    }

    /// 1 inside the panel, 0 outside, smooth between.
    fn coverage(&self, dir: Vec3) -> f32 {
        let [center, right, up] = self.axes;
        let depth = dir.dot(center);
        if depth <= 0.0 {
            return 0.0;
        }
        let falloff = |across: f32, half: f32| {
            let x = (across.atan2(depth).abs() / half - 1.0) / self.softness;
            let t = (0.5 - x).clamp(0.0, 1.0);
            t * t * (3.0 - 2.0 * t)
        };
        let wide = falloff(dir.dot(right), self.half[0]);
        // Most of the sphere is beside it.
        if wide == 0.0 {
            return 0.0;
        }
        wide * falloff(dir.dot(up), self.half[1])
    }
}
