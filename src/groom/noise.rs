//! Fractal noise in space.

use crate::skin::{Mirror, Skin};
use glam::Vec3;
use noise::{NoiseFn, OpenSimplex};

/// Octaves of a noise.
const OCTAVES: usize = 4;

/// How alike both sides of a body are.
#[derive(Clone, Copy)]
pub(super) struct Symmetry<'a> {
    pub(super) mirror: Option<&'a Mirror>,
    /// 0 each its own .. 1 mirror images.
    pub(super) amount: f32,
}

impl Symmetry<'_> {
    /// That it has no effect, if so.
    pub(super) fn idle(&self, skin: &Skin) -> Option<String> {
        let is_idle = self.amount > 0.0 && self.mirror.is_none();
        is_idle.then(|| {
            format!(
                "`symmetry` has no effect: skin `{}` has no two sides",
                skin.name
            )
        })
    }

    /// As [`Mirror::fold`]; `None` too where sides are their own.
    pub(super) fn fold(&self, place: Vec3, normal: Vec3) -> Option<(Vec3, Vec3)> {
        let mirror = self.mirror.filter(|_| self.amount > 0.0)?;
        mirror.fold(place, normal)
    }
}

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

    /// The noise at a place of a body whose sides are alike.
    pub(super) fn both(&self, p: Vec3, symmetry: Symmetry<'_>) -> f32 {
        let own = self.at(p);
        match symmetry.fold(p, Vec3::ZERO) {
            Some((image, _)) => own + symmetry.amount * (self.at(image) - own),
            None => own,
        }
    }

    /// The noise at a place.
    fn at(&self, p: Vec3) -> f32 {
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
