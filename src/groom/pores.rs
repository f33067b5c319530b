//! Compound follicles: hairs that leave the skin together, the undercoat behind its guard hair.
//!
//! Pores are points with a blue-noise spectrum, as single follicles are. Hairs are dealt to them in rounds,
//! one a pore, in the order of the pores: so the first hairs of a class are spread as evenly as the first
//! pores, a thinner groom is a part of a fuller one, and at full density every pore has as many as the
//! densities of the classes say. How many pores there are is a matter of the skin alone.

use super::GroomError;
use super::comb::Comb;
use super::follicle::{Follicle, Surface, class_seed};
use super::plan::ClassPlan;
use super::scatter::Scattered;
use super::walk::Ground;
use crate::progress::{Cancel, Progress};
use crate::sampling::{Rng, hash64};
use crate::skin::Skin;
use crate::species::{Arrangement, Pores, Species};
use rayon::prelude::*;
use std::f32::consts::PI;

/// Steps of the plane's most even additive sequence (Roberts 2018, "The unreasonable effectiveness of
/// quasirandom sequences"): powers of the inverse of the plastic number.
const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
/// Hairs of a row stand so far behind the guard hair, and so unevenly, in shares of the largest distance.
const BEHIND: f32 = 0.4;
const RAGGED: f32 = 0.15;
/// Half length of a row, so that its ends are no farther from the guard hair than others may be.
const ACROSS: f32 = 0.88;

/// What hairs are dealt to pores.
pub(super) struct Dealt<'a> {
    pub(super) recipe: &'a Pores,
    pub(super) species: &'a Species,
    pub(super) plan: &'a [ClassPlan],
    pub(super) comb: Option<&'a Comb>,
    pub(super) seed: u64,
}

impl Dealt<'_> {
    /// The follicles of all classes.
    ///
    /// # Errors
    /// [`GroomError::Cancelled`].
    pub(super) fn scatter(
        &self,
        surface: &Surface<'_>,
        skin: &Skin,
        progress: &dyn Progress,
        cancel: &Cancel,
    ) -> Result<Vec<Scattered>, GroomError> {
        let first = self.species.classes[0].groom.density_per_cm2;
        let density = self.recipe.density_per_cm2.unwrap_or(first);
        let all = (density * 1e4 * surface.weighted_area()).round().max(1.0) as usize;
        let most = self.plan.iter().map(|class| class.strands).max();
        // Pairs of pores share their hairs: both are there.
        let needed = most.unwrap_or(0).next_multiple_of(2).min(all);
        let scattered = surface.scatter(class_seed(self.seed, 0), needed, progress, cancel)?;
        let dealer = Dealer {
            pores: self.recipe,
            all,
            classes: self.plan.len(),
            seed: hash64(self.seed ^ 0x706f_7265),
            places: &scattered.follicles,
            ground: Ground::new(skin),
            surface,
            comb: self.comb,
        };
        let of_class = |(class, plan): (usize, &ClassPlan)| Scattered {
            follicles: (0..plan.strands)
                .into_par_iter()
                .with_min_len(1024)
                .map(|rank| dealer.place(class, rank))
                .collect(),
            crowded: if class == 0 { scattered.crowded } else { 0 },
        };
        Ok(self.plan.iter().enumerate().map(of_class).collect())
    }
}

/// Deals hairs to pores.
struct Dealer<'a> {
    pores: &'a Pores,
    /// Pores of the whole skin, of which `places` are the first.
    all: usize,
    classes: usize,
    seed: u64,
    places: &'a [Follicle],
    ground: Ground<'a>,
    surface: &'a Surface<'a>,
    comb: Option<&'a Comb>,
}

impl Dealer<'_> {
    /// The follicle of a hair.
    fn place(&self, class: usize, rank: usize) -> Follicle {
        let (round, slot) = (rank / self.all, rank % self.all);
        if class == 0 && round == 0 {
            return self.places[slot];
        }
        let pore = self.pore(class, round, slot);
        // Which hair of its pore it is; those of a partner's slot come between.
        let turn = (round * self.classes + class) * 2 + usize::from(pore != slot);
        let mut rng = Rng::new(self.seed, pore as u64);
        let [u, v] = STEPS.map(|step| (rng.uniform() + step * turn as f64).fract() as f32);
        let (back, across) = match self.pores.arrangement {
            Arrangement::Cluster => {
                let (sin, cos) = (PI * (u - 0.5)).sin_cos();
                (v.sqrt() * cos, v.sqrt() * sin)
            }
            Arrangement::Row => (BEHIND + RAGGED * (v - 0.5), ACROSS * (2.0 * u - 1.0)),
        };
        let from = &self.places[pore];
        let root = self.surface.root(from);
        let lay = match self.comb {
            Some(comb) => comb.lay(root.position, root.normal, root.lay, 1.0),
            None => root.lay,
        };
        let way = lay * back + root.normal.cross(lay) * across;
        let distance = way.length() * self.pores.spread_mm as f32 * 1e-3;
        self.ground.go(from, way.normalize_or(lay), distance)
    }

    /// The pore that a hair goes to: that of its slot, or now and then its neighbor in the order, so that
    /// some pores have more hairs and some have fewer.
    fn pore(&self, class: usize, round: usize, slot: usize) -> usize {
        let partner = slot ^ 1;
        if partner >= self.all || self.pores.uneven == 0.0 {
            return slot;
        }
        let pair = (slot / 2) as u64;
        let even = slot & !1;
        // The share of the pair's hairs that its first pore has.
        let share =
            0.5 + 0.5 * self.pores.uneven * (2.0 * Rng::new(self.seed ^ 1, pair).uniform() - 1.0);
        let hair = (round * self.classes + class) as u64 * 2 + (slot & 1) as u64;
        let luck = Rng::new(hash64(self.seed ^ pair), hair).uniform();
        if luck < share { even } else { even + 1 }
    }
}
