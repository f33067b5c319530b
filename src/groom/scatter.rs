//! Points on the skin with a blue-noise spectrum, in an order of which every prefix is blue noise too.
//!
//! Dart throwing with a radius that shrinks as points accumulate (McCool and Fiume 1992,
//! "Hierarchical Poisson disk sampling distributions"). Darts are thrown in passes: the test
//! against earlier passes runs in parallel and, because neighboring darts come one after another, in few
//! places of memory; the test within the pass goes in random order. So the result does not depend on
//! threads. Nothing depends on how many points are wanted: fewer points are the first of more.

use super::GroomError;
use super::follicle::{Follicle, Surface};
use super::near::Near;
use crate::progress::{Cancel, Progress};
use crate::sampling::{Rng, hash64};
use crate::skin::Skin;
use rayon::prelude::*;

/// Least distance of two points over that of a hexagonal packing of as many. Random darts fill up
/// at 0.78; the closer to that, the more darts miss (12 for a hit at 0.68, more than 100 at 0.76).
const PACKING: f64 = 0.68;

/// Below this share of the distance that they should have, points are crowded.
const CROWDED: f64 = 0.75;

/// The radius follows the number of points in steps of this share; small steps keep prefixes even.
const STEP: usize = 8;

/// Darts of a pass: so many for a point that is missing, and no fewer than some.
const DARTS: usize = 12;
const LEAST_DARTS: usize = 1024;

/// Darts that share a stream of random numbers.
const STREAM: usize = 1024;

/// The density factor below which spacing grows no further, relative to the largest factor. Lower
/// makes the search around a dart wide, higher lets sparse hairs clump.
const SPARSEST: f32 = 0.05;

/// A dart that hit no earlier point.
struct Survivor {
    follicle: Follicle,
    /// How far other points have to be.
    radius: f32,
    /// Of all survivors of a pass those of lowest rank come first.
    rank: u32,
}

impl Surface<'_> {
    /// The first `count` follicles under `seed`.
    pub(super) fn scatter(
        &self,
        seed: u64,
        count: usize,
        progress: &dyn Progress,
        cancel: &Cancel,
    ) -> Result<Scattered, GroomError> {
        let mut taken: Vec<Follicle> = Vec::with_capacity(count.min(1 << 20));
        let (mut earlier, mut fresh) = (Near::new(self.corner), Near::new(self.corner));
        let mut slack = 1.0;
        let mut crowded = None;
        for pass in 0.. {
            if taken.len() >= count {
                break;
            }
            if cancel.is_cancelled() {
                return Err(GroomError::Cancelled);
            }
            let goal = (taken.len() + taken.len() / STEP).max(64);
            let hexagonal = (2.0 / 3f64.sqrt() * self.weighted_area() / goal as f64).sqrt();
            let unit_radius = (PACKING * slack * hexagonal) as f32;
            let radius = |density: f32| unit_radius / density.max(SPARSEST * self.densest).sqrt();
            let usual = radius(self.mean);
            earlier.prepare(goal, usual);
            let darts = (DARTS * (goal - taken.len())).max(LEAST_DARTS);
            let survivors = self.survivors(hash64(seed ^ hash64(pass)), darts, &earlier, &radius);

            let before = taken.len();
            fresh.clear(goal - before, usual);
            let mut order: Vec<(u32, u32)> = (survivors.iter().zip(0..))
                .map(|(survivor, i)| (survivor.rank, i))
                .collect();
            order.par_sort_unstable();
            let mut kept = vec![false; survivors.len()];
            for (_, i) in order {
                let survivor = &survivors[i as usize];
                let position = survivor.follicle.position;
                if taken.len() < goal && fresh.is_free(position, survivor.radius) {
                    fresh.insert(position);
                    taken.push(survivor.follicle);
                    kept[i as usize] = true;
                }
            }
            for (survivor, _) in survivors.iter().zip(kept).filter(|(_, kept)| *kept) {
                earlier.insert(survivor.follicle.position);
            }
            let hits = taken.len() - before;
            // Thin or folded skin can be full before its area says so.
            if hits * 100 < darts && taken.len() < goal {
                slack *= 0.95;
                if slack < CROWDED {
                    crowded.get_or_insert(taken.len());
                }
            }
            progress.advance(hits.min(count.saturating_sub(before)) as u64);
        }
        taken.truncate(count);
        Ok(Scattered {
            crowded: count.saturating_sub(crowded.unwrap_or(count)),
            follicles: taken,
        })
    }

    /// Throws darts and keeps those that are far enough from all earlier points, in the order of the skin's
    /// triangles.
    fn survivors(
        &self,
        seed: u64,
        darts: usize,
        earlier: &Near,
        radius: &(impl Fn(f32) -> f32 + Sync),
    ) -> Vec<Survivor> {
        let streams: Vec<Vec<Survivor>> = (0..darts.div_ceil(STREAM))
            .into_par_iter()
            .map(|stream| {
                let mut rng = Rng::new(seed, stream as u64);
                let mut found = Vec::new();
                let range = stream * STREAM..((stream + 1) * STREAM).min(darts);
                self.darts(&mut rng, range, darts, |rng, follicle, density| {
                    let radius = radius(density);
                    if earlier.is_free(follicle.position, radius) {
                        found.push(Survivor {
                            follicle,
                            radius,
                            rank: rng.bits(),
                        });
                    }
                });
                found
            })
            .collect();
        streams.into_iter().flatten().collect()
    }
}

/// Points on the skin.
pub(super) struct Scattered {
    /// In their order: of these any first ones are evenly spread too.
    pub(super) follicles: Vec<Follicle>,
    /// How many of them, the last ones, had no room at the distance that they should have.
    pub(super) crowded: usize,
}

impl Scattered {
    /// What is to be said of follicles that stand closer than they should.
    pub(super) fn crowding(&self, class: &str, skin: &Skin) -> Option<String> {
        (self.crowded > 0).then(|| {
            format!(
                "{} of {} strands of `{class}` had no room and stand closer than evenly: skin `{}` lies \
                 folded on itself or in several layers",
                self.crowded,
                self.follicles.len(),
                skin.name
            )
        })
    }
}
