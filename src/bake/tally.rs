//! Integer sums of one node: order-free and exact.

use super::deposit::{Deposit, Deposits, Rest, weights, whole};
use super::touched::Touched;
use crate::math::decay::decay;
use crate::math::unicube::Unicube;
use crate::table::{Ledger, PHOTON};
use wide::u64x2;

/// Most absorption levels a tally holds.
pub(super) const MAX_LEVELS: usize = 24;

/// Exponentials that are computed side by side.
const SIDE_BY_SIDE: usize = 64;

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
    /// Texels with sums that are not 0: a pass of a few photons costs what these cost.
    touched: Touched,
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
            touched: Touched::new(texels),
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
        let levels = self.levels;
        for texel in self.touched.iter() {
            self.texels[texel * levels..(texel + 1) * levels].fill(0);
            self.squares[texel] = 0;
            self.bare[texel] = 0;
            self.bare_squares[texel] = 0;
        }
        self.touched.clear();
        self.photons = 0;
        for sums in [&mut self.absorbed, &mut self.truncated, &mut self.lost] {
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
        self.touched.insert_all();
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

    /// Whether anything left through a texel.
    pub(super) fn has(&self, texel: usize) -> bool {
        self.touched.has(texel)
    }

    /// What left through a texel without having met pigment, the same at all levels, and the sum of
    /// its squares.
    #[inline]
    pub(super) fn bare(&self, texel: usize) -> (u64, u64) {
        if !self.touched.has(texel) {
            return (0, 0);
        }
        (self.bare[texel], self.bare_squares[texel])
    }

    /// What left through a texel and had met pigment, at the clear level, and the sum of its squares.
    #[inline]
    pub(super) fn colored(&self, texel: usize) -> (u64, u64) {
        if !self.touched.has(texel) {
            return (0, 0);
        }
        (self.texels[texel * self.levels], self.squares[texel])
    }

    /// What left through a texel and had met pigment, at every level.
    pub(super) fn run(&self, texel: usize) -> &[u64] {
        &self.texels[texel * self.levels..(texel + 1) * self.levels]
    }

    /// What left, per level.
    pub(super) fn escaped(&self) -> Vec<u64> {
        let (mut bare, mut escaped) = (0, vec![0; self.levels]);
        for texel in self.touched.iter() {
            bare += self.bare[texel];
            add(&mut escaped, self.run(texel));
        }
        escaped.iter_mut().for_each(|sum| *sum += bare);
        escaped
    }

    /// What left through a texel at the clear level and the variance of that, in photons.
    pub(super) fn at_clear(&self, texel: usize) -> (f64, f64) {
        let photons = |sum: u64| sum as f64 / PHOTON as f64;
        let ((a, a2), (b, b2)) = (self.bare(texel), self.colored(texel));
        (photons(a + b), photons(a2 + b2))
    }

    /// So many photons were sent out and met the fiber.
    pub(super) fn emit(&mut self, photons: u64) {
        self.photons += photons;
    }

    /// Parts of photons left. What was collected is empty then.
    pub(super) fn escape(&mut self, deposits: &mut Deposits, levels: &[f64]) {
        let mut absorbed = 0;
        for Deposit { texel, rest } in deposits.bare.drain(..) {
            let texel = texel as usize;
            let weight = whole(rest.clear());
            self.touched.insert(texel);
            self.bare[texel] += weight;
            self.bare_squares[texel] += square(weight);
            absorbed += rest.part - weight;
        }
        for sum in &mut self.absorbed[..self.levels] {
            *sum += absorbed;
        }
        for deposits in deposits.colored.chunks(SIDE_BY_SIDE) {
            match self.levels {
                // The usual number, unrolled.
                12 => self.escape_colored::<6>(deposits, levels),
                _ => self.escape_colored::<{ MAX_LEVELS / 2 }>(deposits, levels),
            }
        }
        deposits.colored.clear();
    }

    /// Parts that met pigment left, of which `PAIRS` pairs of levels are computed.
    fn escape_colored<const PAIRS: usize>(&mut self, deposits: &[Deposit], levels: &[f64]) {
        let first = levels.get(1).copied().unwrap_or(0.0);
        let mut left = [0.0; SIDE_BY_SIDE];
        for (left, deposit) in left.iter_mut().zip(deposits) {
            *left = decay(first * deposit.rest.path);
        }
        let (mut parts, mut sums) = (0, [u64x2::ZERO; PAIRS]);
        for (&Deposit { texel, rest }, left) in deposits.iter().zip(left) {
            let texel = texel as usize;
            self.touched.insert(texel);
            let weights = weights::<PAIRS>(rest, left);
            let run = &mut self.texels[texel * self.levels..(texel + 1) * self.levels];
            let (pairs, last) = run.as_chunks_mut::<2>();
            for (k, weights) in weights.iter().enumerate() {
                sums[k] += *weights;
                if let Some(pair) = pairs.get_mut(k) {
                    *pair = (u64x2::new(*pair) + *weights).to_array();
                }
            }
            if let [last] = last {
                *last += weights[pairs.len()].to_array()[0];
            }
            self.squares[texel] += square(weights[0].to_array()[0]);
            parts += rest.part;
        }
        let sums = sums.iter().flat_map(|pair| pair.to_array());
        for (sum, left) in self.absorbed[..self.levels].iter_mut().zip(sums) {
            *sum += parts - left;
        }
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
        let first = levels.get(1).copied().unwrap_or(0.0);
        let pairs = weights::<{ MAX_LEVELS / 2 }>(rest, decay(first * rest.path));
        let mut weights = [0; MAX_LEVELS];
        let all = pairs.iter().flat_map(|pair| pair.to_array());
        for (k, (weight, found)) in weights.iter_mut().zip(all).take(self.levels).enumerate() {
            *weight = found;
            self.absorbed[k] += rest.part - found;
        }
        weights
    }

    pub(super) fn add(&mut self, other: &Self) {
        let levels = self.levels;
        for texel in other.touched.iter() {
            let run = texel * levels..(texel + 1) * levels;
            add(&mut self.texels[run.clone()], &other.texels[run]);
            self.squares[texel] += other.squares[texel];
            self.bare[texel] += other.bare[texel];
            self.bare_squares[texel] += other.bare_squares[texel];
        }
        self.touched.insert_those(&other.touched);
        self.photons += other.photons;
        add(&mut self.absorbed, &other.absorbed);
        add(&mut self.truncated, &other.truncated);
        add(&mut self.lost, &other.lost);
    }

    /// The books, per level.
    pub(super) fn ledger(&self) -> Vec<Ledger> {
        let escaped = self.escaped();
        (0..self.levels)
            .map(|k| Ledger {
                emitted: self.photons * PHOTON,
                escaped: escaped[k],
                absorbed: self.absorbed[k],
                truncated: self.truncated[k],
                lost: self.lost[k],
            })
            .collect()
    }

    /// Averages the map with its mirror image phi -> -phi. The sum stays exact: an odd unit goes to
    /// the texel with the lower number.
    pub(super) fn fold(&mut self, cube: &Unicube) {
        self.touched.insert_all();
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

fn add(a: &mut [u64], b: &[u64]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a += b;
    }
}

#[cfg(test)]
mod tests;
