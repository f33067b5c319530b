//! Numbers of a groom that vary over the skin.

use super::noise::{Fractal, Symmetry};
use crate::sampling::hash64;
use crate::species::{ClassGroom, Vary, VaryBy, VaryWhat};
use glam::{Vec2, Vec3};
use std::ops::Index;

/// Noise times this, or it would seldom come near its ends; beyond them it is cut.
const CONTRAST: f32 = 1.5;

/// What varies at one root: a factor for each number, but for [`VaryWhat::Turn`] an angle in radians.
#[derive(Clone, Copy, Debug)]
pub(super) struct Varied([f32; VaryWhat::ALL.len()]);

impl Varied {
    /// Nothing varies.
    pub(super) const NONE: Self = {
        let mut all = [1.0; VaryWhat::ALL.len()];
        all[VaryWhat::Turn as usize] = 0.0;
        Self(all)
    };

    fn join(&mut self, vary: &Vary, share: f64) {
        let value = (vary.from + (vary.to - vary.from) * share) as f32;
        let joined = &mut self.0[vary.what as usize];
        match vary.what {
            VaryWhat::Turn => *joined += value.to_radians(),
            _ => *joined *= value,
        }
    }
}

impl Index<VaryWhat> for Varied {
    type Output = f32;

    fn index(&self, what: VaryWhat) -> &f32 {
        &self.0[what as usize]
    }
}

/// All that varies of one class of hair.
pub(super) struct Variation<'a> {
    list: Vec<(&'a Vary, Option<Fractal>)>,
    symmetry: Symmetry<'a>,
    seed: u64,
}

impl<'a> Variation<'a> {
    /// * `seed`: of everything random.
    pub(super) fn new(list: &'a [Vary], symmetry: Symmetry<'a>, seed: u64) -> Self {
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
            symmetry,
            seed,
        }
    }

    /// What varies at a root.
    pub(super) fn at(&self, position: Vec3, uv: Vec2) -> Varied {
        let mut all = Varied::NONE;
        for (vary, noise) in &self.list {
            let share = match (&vary.by, noise) {
                (VaryBy::Map { picture }, _) => picture.at(uv),
                (_, Some(noise)) => 0.5 + CONTRAST * noise.both(position, self.symmetry),
                _ => 1.0,
            };
            all.join(vary, f64::from(share.clamp(0.0, 1.0)));
        }
        all
    }

    /// The least and the most of each number anywhere.
    pub(super) fn ends(&self) -> [Varied; 2] {
        let mut ends = [Varied::NONE; 2];
        for (vary, _) in &self.list {
            let least = if vary.from <= vary.to { 0.0 } else { 1.0 };
            ends[0].join(vary, least);
            ends[1].join(vary, 1.0 - least);
        }
        ends
    }

    /// Entries without effect, one sentence each.
    ///
    /// * `name`: of the class. * `combed`: whether anything combs its hair.
    pub(super) fn idle<'s>(
        &'s self,
        name: &'s str,
        class: &ClassGroom,
        combed: bool,
    ) -> impl Iterator<Item = String> + 's {
        let whats = VaryWhat::ALL.into_iter();
        let listed = whats.filter(|what| self.list.iter().any(|(vary, _)| vary.what == *what));
        let idle: Vec<_> = listed
            .filter_map(|what| Some((what, missing(what, class, combed)?)))
            .collect();
        idle.into_iter().map(move |(what, missing)| {
            let what = what.name();
            format!("`vary` of `{what}` changes nothing of `{name}`: {missing}")
        })
    }

    /// Whether a hair is among those that grow where a share of all does: the same hairs for any number of
    /// strands.
    pub(super) fn grows(&self, id: u32, density: f32) -> bool {
        let luck = hash64(self.seed ^ hash64(u64::from(id) + 1)) >> 40;
        (luck as f32) < density * (1u32 << 24) as f32
    }
}

/// Why a factor on something has no effect, if so.
fn missing(what: VaryWhat, class: &ClassGroom, combed: bool) -> Option<&'static str> {
    let (absent, why) = match what {
        VaryWhat::LengthSpread => (class.length_sigma == 0.0, "its `length_sigma` is 0"),
        VaryWhat::WidthSpread => (class.diameter_sigma == 0.0, "its `diameter_sigma` is 0"),
        VaryWhat::Bend => (class.bend_deg == 0.0, "its `bend_deg` is 0"),
        VaryWhat::Gravity => (class.gravity == 0.0, "its `gravity` is 0"),
        VaryWhat::Stray => (class.stray_deg == 0.0, "its `stray_deg` is 0"),
        VaryWhat::Roll => (class.roll_deg == 0.0, "its `roll_deg` is 0"),
        VaryWhat::Crimp | VaryWhat::CrimpWavelength => {
            (class.crimp_mm == 0.0, "its `crimp_mm` is 0")
        }
        VaryWhat::Curl | VaryWhat::CurlPitch => (class.curl_mm == 0.0, "its `curl_mm` is 0"),
        VaryWhat::Frizz => (class.frizz_mm == 0.0, "its `frizz_mm` is 0"),
        VaryWhat::Trim => (class.trim_mm.is_infinite(), "it has no `trim_mm`"),
        VaryWhat::Wet => (class.wet == 0.0, "its `wet` is 0"),
        VaryWhat::Clump => (class.clump == 0.0, "its `clump` is 0"),
        VaryWhat::Comb => (!combed, "there are no combing curves or whorls"),
        _ => return None,
    };
    absent.then_some(why)
}
