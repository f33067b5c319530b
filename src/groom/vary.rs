//! Numbers of a groom that vary over the skin.

use super::noise::Fractal;
use crate::sampling::hash64;
use crate::species::{Vary, VaryBy, VaryWhat};
use glam::{Vec2, Vec3};

/// Noise times this, or it would seldom come near its ends; beyond them it is cut.
const CONTRAST: f32 = 1.5;

/// What varies at one root.
#[derive(Clone, Copy, Debug)]
pub(super) struct Varied {
    /// Factor on the length.
    pub(super) length: f32,
    /// Factor on the diameter.
    pub(super) width: f32,
    /// Share of the hairs that grow.
    pub(super) density: f32,
    /// Factor on the radius of curls.
    pub(super) curl: f32,
    /// Factor on the pull of clumps.
    pub(super) clump: f32,
    /// Factor on the wandering of single hairs.
    pub(super) frizz: f32,
    /// Factor on the emergence angle.
    pub(super) tilt: f32,
    /// Factor on the strength of combing curves.
    pub(super) comb: f32,
    /// Turn of the lay about the normal, radians.
    pub(super) turn: f32,
}

impl Varied {
    /// Nothing varies.
    pub(super) const NONE: Self = Self {
        length: 1.0,
        width: 1.0,
        density: 1.0,
        curl: 1.0,
        clump: 1.0,
        frizz: 1.0,
        tilt: 1.0,
        comb: 1.0,
        turn: 0.0,
    };
}

/// All that varies of one class of hair.
pub(super) struct Variation<'a> {
    list: Vec<(&'a Vary, Option<Fractal>)>,
    seed: u64,
}

impl<'a> Variation<'a> {
    /// * `seed`: of everything random.
    pub(super) fn new(list: &'a [Vary], seed: u64) -> Self {
        let seed = hash64(seed ^ 0x7661_7279);
        let noise = |vary: &Vary| match &vary.by {
            VaryBy::Noise {
                size_mm,
                rough,
                seed: own,
            } => Some(Fractal::new(
                hash64(seed ^ own),
                *size_mm as f32 * 1e-3,
                *rough,
            )),
            VaryBy::Map { .. } => None,
        };
        Self {
            list: list.iter().map(|vary| (vary, noise(vary))).collect(),
            seed,
        }
    }

    /// What varies at a root.
    pub(super) fn at(&self, position: Vec3, uv: Vec2) -> Varied {
        let mut all = Varied::NONE;
        for (vary, noise) in &self.list {
            let share = match (&vary.by, noise) {
                (VaryBy::Map { picture }, _) => picture.at(uv),
                (_, Some(noise)) => 0.5 + CONTRAST * noise.at(position),
                _ => 1.0,
            };
            let share = f64::from(share.clamp(0.0, 1.0));
            let value = (vary.from + (vary.to - vary.from) * share) as f32;
            match vary.what {
                VaryWhat::Length => all.length *= value,
                VaryWhat::Width => all.width *= value,
                VaryWhat::Density => all.density *= value,
                VaryWhat::Curl => all.curl *= value,
                VaryWhat::Clump => all.clump *= value,
                VaryWhat::Frizz => all.frizz *= value,
                VaryWhat::Tilt => all.tilt *= value,
                VaryWhat::Comb => all.comb *= value,
                VaryWhat::Turn => all.turn += value.to_radians(),
            }
        }
        all
    }

    /// Whether a hair is among those that grow where a share of all does: the same hairs for any number of
    /// strands.
    pub(super) fn grows(&self, id: u32, density: f32) -> bool {
        let luck = hash64(self.seed ^ hash64(u64::from(id) + 1)) >> 40;
        (luck as f32) < density * (1u32 << 24) as f32
    }
}
