//! Parts of photons on their way into the sums.

use wide::{f64x2, u64x2};

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

/// A part of a photon that has left.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deposit {
    /// Where.
    pub(super) texel: u32,
    /// What is left of it.
    pub(super) rest: Rest,
}

/// Parts of photons that have left and are to be added to the sums. Many at a time: the sums do not
/// fit into the nearest cache, and the processor fetches those of the next parts while it adds one.
#[derive(Debug, Default)]
pub(super) struct Deposits {
    /// What met no pigment.
    pub(super) bare: Vec<Deposit>,
    /// What did.
    pub(super) colored: Vec<Deposit>,
}

impl Deposits {
    /// How many there are.
    #[inline]
    pub(super) fn count(&self) -> usize {
        self.bare.len() + self.colored.len()
    }

    #[inline]
    pub(super) fn push(&mut self, texel: usize, rest: Rest) {
        let kind = match rest.path == 0.0 {
            true => &mut self.bare,
            false => &mut self.colored,
        };
        let texel = texel as u32;
        kind.push(Deposit { texel, rest });
    }
}

impl Rest {
    /// What is left at the clear level, in units of 2^-32 photon.
    #[inline]
    pub(super) fn clear(self) -> f64 {
        // Signed numbers are converted in one step.
        self.share * self.part as i64 as f64
    }
}

/// The nearest whole number of one from 0 to 2^51, exactly.
#[inline]
pub(super) fn whole(x: f64) -> u64 {
    (x + SHIFT).to_bits() & BELOW_SHIFT
}

/// 2^52: added to a number it leaves no place for a fraction. Unlike a conversion this can be done side by
/// side on any x86-64.
const SHIFT: f64 = (1u64 << 52) as f64;
const BELOW_SHIFT: u64 = (1 << 52) - 1;

/// The fixed-point weight `part * share * exp(-level * path)` of every level, in pairs. Levels from the second
/// on are a geometric series of ratio 2, so each weight is the square of the one before.
///
/// * `left`: what the second level leaves.
#[inline]
pub(super) fn weights<const PAIRS: usize>(rest: Rest, left: f64) -> [u64x2; PAIRS] {
    let clear = f64x2::splat(rest.clear());
    let mut weights = [u64x2::ZERO; PAIRS];
    let mut pair = f64x2::new([1.0, left]);
    for (k, weight) in weights.iter_mut().enumerate() {
        if k == 1 {
            let square = left * left;
            pair = f64x2::new([square, square * square]);
        } else if k > 1 {
            pair *= pair;
            pair *= pair;
        }
        let shifted = pair * clear + f64x2::splat(SHIFT);
        let bits = u64x2::new(shifted.to_array().map(f64::to_bits));
        *weight = bits & u64x2::splat(BELOW_SHIFT);
    }
    weights
}
