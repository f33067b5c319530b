//! What an instruction set does to eight numbers.

use super::{F32x16, F64x8, LANES, Mask, Row, Singles, U64x8};

/// An instruction set that works on eight numbers at a time. Its one value is the proof that the processor has it, and
/// nothing of it can be had without.
///
/// Every operation gives in each lane what a plain number gives, to the bit.
pub(crate) trait Wide: Copy {
    /// Eight numbers.
    type Reals: Copy;
    /// Eight whole numbers.
    type Wholes: Copy;
    /// Sixteen numbers of single precision.
    type Shorts: Copy;
    /// Some of eight lanes.
    type Mask: Copy;

    /// Runs a calculation in which the compiler may use the set. What is to profit must be inlined.
    fn run<R>(self, f: impl FnOnce() -> R) -> R;

    fn splat(self, x: f64) -> Self::Reals;
    fn read(self, row: &Row) -> Self::Reals;
    fn write(self, x: Self::Reals) -> Row;
    /// Number `k` of each row.
    fn read_columns(self, rows: [&Row; LANES]) -> [Self::Reals; LANES];
    /// Lane `i` of result `k` is lane `k` of `rows[i]`.
    fn transpose(self, rows: [Self::Reals; LANES]) -> [Self::Reals; LANES];
    /// The same numbers in double precision.
    fn widen(self, singles: &[f32; LANES]) -> Self::Reals;
    /// Both numbers of entries of a table.
    ///
    /// # Panics
    /// If one is not in it.
    fn read_pairs(self, table: &[[f64; 2]], index: Self::Wholes) -> [Self::Reals; 2];
    /// Lane `i` is lane `index[i]` modulo 8 of `x`.
    fn pick(self, x: Self::Reals, index: Self::Wholes) -> Self::Reals;
    fn choose(self, lanes: Self::Mask, x: Self::Reals, other: Self::Reals) -> Self::Reals;
    fn add(self, a: Self::Reals, b: Self::Reals) -> Self::Reals;
    fn sub(self, a: Self::Reals, b: Self::Reals) -> Self::Reals;
    fn mul(self, a: Self::Reals, b: Self::Reals) -> Self::Reals;
    fn div(self, a: Self::Reals, b: Self::Reals) -> Self::Reals;
    /// The second where the two cannot be compared, or are alike.
    fn min(self, a: Self::Reals, b: Self::Reals) -> Self::Reals;
    fn max(self, a: Self::Reals, b: Self::Reals) -> Self::Reals;
    fn neg(self, a: Self::Reals) -> Self::Reals;
    fn abs(self, a: Self::Reals) -> Self::Reals;
    fn with_sign_of(self, a: Self::Reals, b: Self::Reals) -> Self::Reals;
    fn sqrt(self, a: Self::Reals) -> Self::Reals;
    fn floor(self, a: Self::Reals) -> Self::Reals;
    fn less(self, a: Self::Reals, b: Self::Reals) -> Self::Mask;
    fn at_most(self, a: Self::Reals, b: Self::Reals) -> Self::Mask;
    fn equal(self, a: Self::Reals, b: Self::Reals) -> Self::Mask;

    /// See [`F64x8::least`].
    fn least_of_reals(self, a: Self::Reals) -> (f64, usize);

    fn bits_of(self, a: Self::Reals) -> Self::Wholes;
    fn of_bits(self, a: Self::Wholes) -> Self::Reals;
    /// See [`F64x8::whole`].
    fn whole(self, a: Self::Reals) -> Self::Wholes;
    /// See [`U64x8::to_f64`].
    fn real(self, a: Self::Wholes) -> Self::Reals;
    /// See [`U64x8::signed_to_f64`].
    fn signed_real(self, a: Self::Wholes) -> Self::Reals;

    fn splat_whole(self, x: u64) -> Self::Wholes;
    fn choose_wholes(self, lanes: Self::Mask, x: Self::Wholes, other: Self::Wholes)
    -> Self::Wholes;
    fn right<const BY: u32>(self, a: Self::Wholes) -> Self::Wholes;
    fn left<const BY: u32>(self, a: Self::Wholes) -> Self::Wholes;
    /// See [`U64x8::low_turned_right`].
    fn low_turned_right(self, a: Self::Wholes, by: Self::Wholes) -> Self::Wholes;
    fn times(self, a: Self::Wholes, b: Self::Wholes) -> Self::Wholes;
    fn plus(self, a: Self::Wholes, b: Self::Wholes) -> Self::Wholes;
    fn minus(self, a: Self::Wholes, b: Self::Wholes) -> Self::Wholes;
    fn and(self, a: Self::Wholes, b: Self::Wholes) -> Self::Wholes;
    fn xor(self, a: Self::Wholes, b: Self::Wholes) -> Self::Wholes;
    fn less_wholes(self, a: Self::Wholes, b: Self::Wholes) -> Self::Mask;
    fn equal_wholes(self, a: Self::Wholes, b: Self::Wholes) -> Self::Mask;

    fn splat_short(self, x: f32) -> Self::Shorts;
    fn read_shorts(self, row: &Singles) -> Self::Shorts;
    fn add_shorts(self, a: Self::Shorts, b: Self::Shorts) -> Self::Shorts;
    fn sub_shorts(self, a: Self::Shorts, b: Self::Shorts) -> Self::Shorts;
    fn mul_shorts(self, a: Self::Shorts, b: Self::Shorts) -> Self::Shorts;
    fn div_shorts(self, a: Self::Shorts, b: Self::Shorts) -> Self::Shorts;
    /// `x` where the first of a pair is less, `other` elsewhere.
    fn choose_less(
        self,
        pair: [Self::Shorts; 2],
        x: Self::Shorts,
        other: Self::Shorts,
    ) -> Self::Shorts;
    /// See [`F32x16::least`].
    fn least(self, a: Self::Shorts) -> (f32, usize);

    /// The first lane is the lowest bit.
    fn mask(self, bits: u8) -> Self::Mask;
    fn bits_of_mask(self, a: Self::Mask) -> u8;
    fn any(self, a: Self::Mask) -> bool;
    fn both(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn either(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn one_of(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn others(self, a: Self::Mask) -> Self::Mask;

    /// The same number in all lanes.
    #[inline(always)]
    fn all(self, x: f64) -> F64x8<Self> {
        F64x8(self, self.splat(x))
    }

    /// Different numbers.
    #[inline(always)]
    fn load(self, row: &Row) -> F64x8<Self> {
        F64x8(self, self.read(row))
    }

    /// The same numbers in double precision.
    #[inline(always)]
    fn widened(self, singles: &[f32; LANES]) -> F64x8<Self> {
        F64x8(self, self.widen(singles))
    }

    /// Row `k` of the result holds number `k` of each of these: one row a lane.
    #[inline(always)]
    fn columns(self, rows: [&Row; LANES]) -> [F64x8<Self>; LANES] {
        eight(self, self.read_columns(rows))
    }

    /// Lane `i` of result `k` is lane `k` of `rows[i]`.
    #[inline(always)]
    fn transposed(self, rows: [F64x8<Self>; LANES]) -> [F64x8<Self>; LANES] {
        let [a, b, c, d, e, f, g, h] = rows;
        eight(
            self,
            self.transpose([a.1, b.1, c.1, d.1, e.1, f.1, g.1, h.1]),
        )
    }

    /// Both numbers of entries of a table.
    ///
    /// # Panics
    /// If one is not in it.
    #[inline(always)]
    fn pairs(self, table: &[[f64; 2]], index: U64x8<Self>) -> [F64x8<Self>; 2] {
        let [x, y] = self.read_pairs(table, index.1);
        [F64x8(self, x), F64x8(self, y)]
    }

    /// The same whole number in all lanes.
    #[inline(always)]
    fn all_bits(self, x: u64) -> U64x8<Self> {
        U64x8(self, self.splat_whole(x))
    }

    /// The same number in all lanes.
    #[inline(always)]
    fn all_single(self, x: f32) -> F32x16<Self> {
        F32x16(self, self.splat_short(x))
    }

    /// Different numbers.
    #[inline(always)]
    fn load_singles(self, row: &Singles) -> F32x16<Self> {
        F32x16(self, self.read_shorts(row))
    }

    /// The lanes of bits, the first in the lowest.
    #[inline(always)]
    fn lanes(self, bits: u8) -> Mask<Self> {
        Mask(self, self.mask(bits))
    }

    /// The first `count` lanes, up to 8.
    #[inline(always)]
    fn first(self, count: usize) -> Mask<Self> {
        self.lanes(((1u32 << count) - 1) as u8)
    }

    /// No lane.
    #[inline(always)]
    fn none(self) -> Mask<Self> {
        self.lanes(0)
    }

    /// All lanes.
    #[inline(always)]
    fn every(self) -> Mask<Self> {
        self.lanes(u8::MAX)
    }
}

#[inline(always)]
fn eight<W: Wide>(simd: W, of: [W::Reals; LANES]) -> [F64x8<W>; LANES] {
    let [a, b, c, d, e, f, g, h] = of;
    [
        F64x8(simd, a),
        F64x8(simd, b),
        F64x8(simd, c),
        F64x8(simd, d),
        F64x8(simd, e),
        F64x8(simd, f),
        F64x8(simd, g),
        F64x8(simd, h),
    ]
}
