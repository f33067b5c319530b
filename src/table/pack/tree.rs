//! Square tiles as quadtrees: fine where it pays, one value for many texels where it does not.
//!
//! A tile is written depth first. Each square larger than a texel has a bit: 1 if it is split into its
//! four quarters (upper left, upper right, lower left, lower right, rows downward), 0 if one value
//! stands for all of it; a texel has no bit. The cheapest tree for a price per bit is found from the
//! texels upward (Breiman, Friedman, Olshen, Stone 1984, "Classification and regression trees",
//! pruning): a square is split if that lowers `error + price * bits`.
//!
//! The error of a merged square is that against the truth as far as it is known: merging averages
//! noise away, and the table's own variances tell how much (Stein's unbiased estimate). So a noisy
//! table is not stored noise and all, and a price of zero gives the least error rather than the input.

/// Bits that a value is taken to need after entropy coding.
const VALUE_BITS: f64 = 9.0;

/// Values and what is known of them; all of the same length, tile after tile.
#[derive(Clone, Copy)]
pub(super) struct Tiles<'a> {
    /// Edge of a tile, a power of two.
    pub(super) side: usize,
    pub(super) values: &'a [f32],
    /// What the mean of a square weighs its values with: solid angle.
    pub(super) measure: &'a [f32],
    /// What squared errors count.
    pub(super) cost: &'a [f32],
    /// Variance of each value's noise.
    pub(super) variance: &'a [f32],
}

/// Trees of many tiles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::table) struct Trees {
    pub(in crate::table) bits: Vec<bool>,
    pub(in crate::table) leaves: Vec<f32>,
}

/// Sums over a square.
#[derive(Clone, Copy, Default)]
struct Square {
    measure: f64,
    mean: f64,
    cost: f64,
    first: f64,
    second: f64,
    noise: f64,
    kept_noise: f64,
    /// Best price of it.
    price: f64,
    /// The error's part in that.
    error: f64,
}

impl Trees {
    /// Appends the cheapest trees of `tiles` at a price per bit. Returns the estimate of the squared
    /// error that they leave.
    pub(super) fn prune(&mut self, tiles: &Tiles<'_>, price: f64) -> f64 {
        let area = tiles.side * tiles.side;
        (0..tiles.values.len() / area)
            .map(|tile| self.square(tiles, price, tile * area, tiles.side).error)
            .sum()
    }

    /// * `at`: first value of the square.
    fn square(&mut self, tiles: &Tiles<'_>, price: f64, at: usize, side: usize) -> Square {
        if side == 1 {
            self.leaves.push(tiles.values[at]);
            let value = f64::from(tiles.values[at]);
            let (measure, cost) = (f64::from(tiles.measure[at]), f64::from(tiles.cost[at]));
            let noise = cost * f64::from(tiles.variance[at]);
            return Square {
                measure,
                mean: measure * value,
                cost,
                first: cost * value,
                second: cost * value * value,
                noise,
                kept_noise: measure * noise,
                price: noise + price * VALUE_BITS,
                error: noise,
            };
        }
        let (bit, leaf) = (self.bits.len(), self.leaves.len());
        self.bits.push(true);
        let half = side / 2;
        let mut all = Square::default();
        for quarter in 0..4 {
            let at = at + half * (quarter / 2 * tiles.side + quarter % 2);
            all = all.plus(self.square(tiles, price, at, half));
        }
        all.price += price;
        let mean = if all.measure > 0.0 {
            all.mean / all.measure
        } else {
            0.0
        };
        let distance = all.second - 2.0 * mean * all.first + mean * mean * all.cost;
        let kept = 2.0 * all.kept_noise / all.measure.max(f64::MIN_POSITIVE);
        let error = distance - all.noise + kept;
        let merged = error + price * (1.0 + VALUE_BITS);
        if merged <= all.price {
            self.bits.truncate(bit);
            self.bits.push(false);
            self.leaves.truncate(leaf);
            self.leaves.push(mean as f32);
            all.price = merged;
            all.error = error;
        }
        all
    }

    /// The values of `tiles` tiles, if the trees hold exactly so many.
    pub(in crate::table) fn expand(&self, tiles: usize, side: usize) -> Option<Vec<f32>> {
        let mut values = vec![0.0; tiles * side * side];
        let mut reader = Reader {
            bits: self.bits.iter(),
            leaves: self.leaves.iter(),
        };
        for tile in values.chunks_mut(side * side) {
            reader.square(tile, side, 0, side)?;
        }
        let over = reader.bits.next().is_none() && reader.leaves.next().is_none();
        over.then_some(values)
    }
}

impl Square {
    fn plus(self, other: Self) -> Self {
        Self {
            measure: self.measure + other.measure,
            mean: self.mean + other.mean,
            cost: self.cost + other.cost,
            first: self.first + other.first,
            second: self.second + other.second,
            noise: self.noise + other.noise,
            kept_noise: self.kept_noise + other.kept_noise,
            price: self.price + other.price,
            error: self.error + other.error,
        }
    }
}

struct Reader<'a> {
    bits: std::slice::Iter<'a, bool>,
    leaves: std::slice::Iter<'a, f32>,
}

impl Reader<'_> {
    fn square(&mut self, tile: &mut [f32], width: usize, at: usize, side: usize) -> Option<()> {
        if side > 1 && *self.bits.next()? {
            let half = side / 2;
            for quarter in 0..4 {
                let at = at + half * (quarter / 2 * width + quarter % 2);
                self.square(tile, width, at, half)?;
            }
            return Some(());
        }
        let value = *self.leaves.next()?;
        for row in 0..side {
            tile[at + row * width..at + row * width + side].fill(value);
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;

    fn pruned(values: &[f32], variance: f32, price: f64) -> (Trees, f64) {
        let ones = vec![1.0; values.len()];
        let variance = vec![variance; values.len()];
        let mut trees = Trees::default();
        let tiles = Tiles {
            side: 8,
            values,
            measure: &ones,
            cost: &ones,
            variance: &variance,
        };
        let error = trees.prune(&tiles, price);
        (trees, error)
    }

    #[test]
    fn exact_at_no_price_and_coarse_at_a_high_one() {
        let mut rng = Rng::new(2, 2);
        let mut values: Vec<f32> = (0..128).map(|_| rng.uniform_f32()).collect();
        values[64..96].fill(0.5);
        let (trees, error) = pruned(&values, 0.0, 0.0);
        assert_eq!(trees.expand(2, 8).unwrap(), values);
        assert!(error.abs() < 1e-6 && trees.leaves.len() < 64 + 40);
        let (trees, _) = pruned(&values, 0.0, 100.0);
        assert_eq!(trees.bits, [false, false]);
        let mean = values[..64].iter().sum::<f32>() / 64.0;
        assert!((trees.leaves[0] - mean).abs() < 1e-6);
        let (trees, error) = pruned(&values, 0.0, 1e-3);
        let back = trees.expand(2, 8).unwrap();
        let pairs = values.iter().zip(&back);
        let found: f64 = pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum();
        assert!((found - error).abs() < 1e-5, "{found} {error}");
        assert_eq!(trees.expand(1, 8), None);
        assert_eq!(trees.expand(3, 8), None);
    }

    #[test]
    fn noise_is_averaged_and_edges_stay() {
        let mut rng = Rng::new(3, 2);
        // A step of height 1 under uniform noise of variance 0.01.
        let truth: Vec<f32> = (0..64).map(|i| if i % 8 < 4 { 0.0 } else { 1.0 }).collect();
        let width = (12.0f32 * 0.01).sqrt();
        let noisy: Vec<f32> = truth
            .iter()
            .map(|t| t + width * (rng.uniform_f32() - 0.5))
            .collect();
        let (trees, _) = pruned(&noisy, 0.01, 1e-3);
        assert_eq!(trees.leaves.len(), 4);
        let back = trees.expand(1, 8).unwrap();
        let worst = back.iter().zip(&truth).map(|(a, b)| (a - b).abs());
        assert!(worst.fold(0.0, f32::max) < 0.1);
    }
}
