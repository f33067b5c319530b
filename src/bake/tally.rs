//! Integer sums of one node: order-free and exact.

use crate::math::unicube::Unicube;
use crate::table::{Ledger, PHOTON};

/// Most absorption levels a tally holds.
pub(super) const MAX_LEVELS: usize = 24;

/// A part of a photon at the end of its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rest {
    /// How much of a photon set out, in units of 2^-32; at most one photon.
    pub(super) part: u64,
    /// What is left of it, pigment aside.
    pub(super) share: f64,
    /// Its way through pigment in radii.
    pub(super) path: f64,
}

/// Where the photons of one node went, per absorption level, in units of 2^-32 photon.
///
/// What was absorbed is summed photon by photon and what escaped is the sum of the texels: that
/// they add up to what was emitted is a check, not a definition.
#[derive(Clone, Debug)]
pub(super) struct Tally {
    levels: usize,
    /// `texels[texel * levels + level]`, what met pigment: a photon touches one contiguous run.
    texels: Vec<u64>,
    /// Per texel, the sum of the squares of that at the clear level: its variance, as photons are
    /// independent.
    squares: Vec<u64>,
    /// Per texel, what met no pigment, mostly reflections of the surface: the same at every level.
    bare: Vec<u64>,
    /// The sum of the squares of that.
    bare_squares: Vec<u64>,
    photons: u64,
    absorbed: [u64; MAX_LEVELS],
    truncated: [u64; MAX_LEVELS],
    lost: [u64; MAX_LEVELS],
}

impl Tally {
    pub(super) fn new(texels: usize, levels: usize) -> Self {
        debug_assert!((1..=MAX_LEVELS).contains(&levels));
        let zero = [0; MAX_LEVELS];
        Self {
            levels,
            squares: vec![0; texels],
            bare: vec![0; texels],
            bare_squares: vec![0; texels],
            texels: vec![0; texels * levels],
            photons: 0,
            absorbed: zero,
            truncated: zero,
            lost: zero,
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.photons == 0
    }

    /// Photons that hit the fiber.
    pub(super) fn photons(&self) -> u64 {
        self.photons
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        for sums in self.arrays_mut() {
            sums.fill(0);
        }
    }

    /// Number of arrays in files.
    pub(super) const ARRAYS: usize = 8;

    /// Names and shapes of the arrays in files. A change of names or meaning wants a new version of
    /// the file format.
    ///
    /// * `res`: texels along a face edge.
    pub(super) fn shapes(res: usize, levels: usize) -> [(&'static str, Vec<usize>); Self::ARRAYS] {
        [
            ("photons", vec![]),
            ("absorbed", vec![levels]),
            ("truncated", vec![levels]),
            ("lost", vec![levels]),
            ("texels", vec![6, res, res, levels]),
            ("squares", vec![6, res, res]),
            ("bare", vec![6, res, res]),
            ("bare_squares", vec![6, res, res]),
        ]
    }

    /// All sums in the order of [`Tally::shapes`].
    pub(super) fn arrays(&self) -> [&[u64]; Self::ARRAYS] {
        [
            std::slice::from_ref(&self.photons),
            &self.absorbed[..self.levels],
            &self.truncated[..self.levels],
            &self.lost[..self.levels],
            &self.texels,
            &self.squares,
            &self.bare,
            &self.bare_squares,
        ]
    }

    /// [`Tally::arrays`] to be filled.
    pub(super) fn arrays_mut(&mut self) -> [&mut [u64]; Self::ARRAYS] {
        [
            std::slice::from_mut(&mut self.photons),
            &mut self.absorbed[..self.levels],
            &mut self.truncated[..self.levels],
            &mut self.lost[..self.levels],
            &mut self.texels,
            &mut self.squares,
            &mut self.bare,
            &mut self.bare_squares,
        ]
    }

    /// Texels of the map.
    pub(super) fn texels(&self) -> usize {
        self.bare.len()
    }

    /// Absorption levels.
    pub(super) fn levels(&self) -> usize {
        self.levels
    }

    /// What left through a texel without having met pigment, the same at all levels, and the sum of
    /// its squares.
    pub(super) fn bare(&self, texel: usize) -> (u64, u64) {
        (self.bare[texel], self.bare_squares[texel])
    }

    /// What left through a texel and had met pigment, at the clear level, and the sum of its squares.
    pub(super) fn colored(&self, texel: usize) -> (u64, u64) {
        (self.texels[texel * self.levels], self.squares[texel])
    }

    /// What left through a texel and had met pigment, at every level.
    pub(super) fn run(&self, texel: usize) -> &[u64] {
        &self.texels[texel * self.levels..(texel + 1) * self.levels]
    }

    /// What left at a level.
    pub(super) fn escaped(&self, level: usize) -> u64 {
        let colored = self.texels.iter().skip(level).step_by(self.levels);
        self.bare.iter().sum::<u64>() + colored.sum::<u64>()
    }

    /// What left through a texel at the clear level and the variance of that, in photons.
    pub(super) fn at_clear(&self, texel: usize) -> (f64, f64) {
        let photons = |sum: u64| sum as f64 / PHOTON as f64;
        (
            photons(self.bare[texel] + self.texels[texel * self.levels]),
            photons(self.bare_squares[texel] + self.squares[texel]),
        )
    }

    /// A photon was sent out. Its parts follow.
    pub(super) fn emit(&mut self) {
        self.photons += 1;
    }

    /// A photon never met the fiber: it does not count.
    pub(super) fn miss(&mut self) {
        self.photons -= 1;
    }

    /// Part of a photon left through `texel`.
    pub(super) fn escape(&mut self, texel: usize, rest: Rest, levels: &[f64]) {
        let weights = self.arrive(rest, levels);
        if rest.path == 0.0 {
            self.bare[texel] += weights[0];
            self.bare_squares[texel] += square(weights[0]);
            return;
        }
        let run = &mut self.texels[texel * self.levels..(texel + 1) * self.levels];
        for (sum, weight) in run.iter_mut().zip(weights) {
            *sum += weight;
        }
        self.squares[texel] += square(weights[0]);
    }

    /// Part of a photon was given up.
    pub(super) fn truncate(&mut self, rest: Rest, levels: &[f64]) {
        let weights = self.arrive(rest, levels);
        add(&mut self.truncated, &weights);
    }

    /// Part of a photon found no boundary.
    pub(super) fn lose(&mut self, rest: Rest, levels: &[f64]) {
        let weights = self.arrive(rest, levels);
        add(&mut self.lost, &weights);
    }

    /// Nothing was left of a part of a photon.
    pub(super) fn absorb(&mut self, rest: Rest, levels: &[f64]) {
        self.arrive(Rest { share: 0.0, ..rest }, levels);
    }

    /// Books what was taken of a part on its way; returns what is left at each level.
    fn arrive(&mut self, rest: Rest, levels: &[f64]) -> [u64; MAX_LEVELS] {
        let weights = weights(rest, levels);
        for (absorbed, weight) in self.absorbed.iter_mut().zip(&weights).take(levels.len()) {
            *absorbed += rest.part - weight;
        }
        weights
    }

    pub(super) fn add(&mut self, other: &Self) {
        for (a, b) in self.texels.iter_mut().zip(&other.texels) {
            *a += b;
        }
        for (sums, others) in [
            (&mut self.squares, &other.squares),
            (&mut self.bare, &other.bare),
            (&mut self.bare_squares, &other.bare_squares),
        ] {
            for (a, b) in sums.iter_mut().zip(others) {
                *a += b;
            }
        }
        self.photons += other.photons;
        add(&mut self.absorbed, &other.absorbed);
        add(&mut self.truncated, &other.truncated);
        add(&mut self.lost, &other.lost);
    }

    /// The books, per level.
    pub(super) fn ledger(&self) -> Vec<Ledger> {
        (0..self.levels)
            .map(|k| Ledger {
                emitted: self.photons * PHOTON,
                escaped: self.escaped(k),
                absorbed: self.absorbed[k],
                truncated: self.truncated[k],
                lost: self.lost[k],
            })
            .collect()
    }

    /// Averages the map with its mirror image phi -> -phi. The sum stays exact: an odd unit goes to
    /// the texel with the lower number.
    pub(super) fn fold(&mut self, cube: &Unicube) {
        for texel in 0..cube.texels() {
            let mirror = cube.mirrored(texel);
            if texel < mirror {
                let halve = |sums: &mut [u64], a: usize, b: usize| {
                    let sum = sums[a] + sums[b];
                    (sums[a], sums[b]) = (sum - sum / 2, sum / 2);
                };
                halve(&mut self.bare, texel, mirror);
                for k in 0..self.levels {
                    let run = |texel| texel * self.levels + k;
                    halve(&mut self.texels, run(texel), run(mirror));
                }
                // The variance of half a sum of two that are independent.
                for squares in [&mut self.squares, &mut self.bare_squares] {
                    let quarter = (squares[texel] + squares[mirror]) / 4;
                    (squares[texel], squares[mirror]) = (quarter, quarter);
                }
            }
        }
    }

    /// Flux fractions, level by level.
    pub(super) fn flux(&self) -> Vec<f32> {
        let mut flux = Vec::with_capacity(self.texels.len());
        let scale = 1.0 / (self.photons as f64 * PHOTON as f64);
        for k in 0..self.levels {
            flux.extend(
                self.texels
                    .iter()
                    .skip(k)
                    .step_by(self.levels)
                    .zip(&self.bare)
                    .map(|(&colored, &bare)| ((colored + bare) as f64 * scale) as f32),
            );
        }
        flux
    }

    /// Relative standard error of the clear level; infinite where nothing arrived.
    pub(super) fn error(&self) -> Vec<f32> {
        (0..self.texels())
            .map(|texel| match self.at_clear(texel) {
                (0.0, _) => f32::INFINITY,
                (sum, squares) => (squares.sqrt() / sum) as f32,
            })
            .collect()
    }
}

/// The square of a weight of at most one photon, in units of 2^-32.
fn square(weight: u64) -> u64 {
    // Half of one factor first, or one photon squared would not fit.
    (weight * (weight >> 1)) / (PHOTON >> 1)
}

fn add(a: &mut [u64; MAX_LEVELS], b: &[u64; MAX_LEVELS]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a += b;
    }
}

/// The fixed-point weight `part * share * exp(-level * path)` of every level. Levels from the second on are a
/// geometric series of ratio 2, so each weight is the square of the one before.
#[inline]
fn weights(rest: Rest, levels: &[f64]) -> [u64; MAX_LEVELS] {
    let mut weights = [0; MAX_LEVELS];
    let clear = rest.share * rest.part as f64;
    weights[0] = clear as u64;
    let mut left = levels
        .get(1)
        .map_or(0.0, |first| (-first * rest.path).exp());
    for weight in weights.iter_mut().take(levels.len()).skip(1) {
        *weight = (left * clear) as u64;
        left *= left;
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::absorption_levels;

    #[test]
    fn ledger_is_exact_and_weights_follow_beer() {
        let levels = absorption_levels(12);
        let cube = Unicube::new(4);
        let mut tally = Tally::new(cube.texels(), levels.len());
        let mut emitted = 0;
        for i in 0..1000u32 {
            let rest = Rest {
                part: PHOTON / u64::from(1 + i % 3),
                share: 1.0 / f64::from(1 + i % 7),
                path: f64::from(i % 37) * 0.31,
            };
            emitted += rest.part;
            match i % 10 {
                0 => tally.truncate(rest, &levels),
                1 => tally.lose(rest, &levels),
                2 => tally.absorb(rest, &levels),
                _ => tally.escape(i as usize % cube.texels(), rest, &levels),
            }
        }
        tally.fold(&cube);
        for l in tally.ledger() {
            assert_eq!(emitted, l.escaped + l.absorbed + l.truncated + l.lost);
            assert!(l.truncated > 0 && l.lost > 0);
        }
        let rest = Rest {
            part: PHOTON,
            share: 0.3,
            path: 0.7,
        };
        let weights = weights(rest, &levels);
        for (level, weight) in levels.iter().zip(weights) {
            let exact = 0.3 * (-level * 0.7).exp();
            assert!((weight as f64 / PHOTON as f64 - exact).abs() < 1e-9);
        }
    }
}
