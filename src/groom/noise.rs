//! Fractal noise in space.

use glam::Vec3;
use noise::{NoiseFn, OpenSimplex};

/// Octaves of a noise.
const OCTAVES: usize = 4;

/// Noise of several octaves, about -1..1.
pub(super) struct Fractal {
    noise: OpenSimplex,
    size: f32,
    rough: f64,
}

impl Fractal {
    /// * `size`: of its largest features, meters.
    /// * `rough`: how much finer features add, 0..1.
    pub(super) fn new(seed: u64, size: f32, rough: f64) -> Self {
        Self {
            noise: OpenSimplex::new(seed as u32),
            size,
            rough,
        }
    }

    /// The noise at a place.
    pub(super) fn at(&self, p: Vec3) -> f32 {
        let p = p.as_dvec3() / f64::from(self.size);
        let (mut sum, mut all, mut weight, mut scale) = (0.0, 0.0, 1.0, 1.0);
        for octave in 0..OCTAVES {
            let at = p * scale + octave as f64 * 17.0;
            sum += weight * self.noise.get(at.to_array());
            all += weight;
            weight *= self.rough;
            scale *= 2.0;
        }
        (1.6 * sum / all) as f32
    }
}
