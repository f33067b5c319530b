//! Eight and sixteen numbers of single precision at a time, for trees of one's own.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod task;

#[cfg(all(test, target_arch = "x86_64"))]
pub(crate) use task::on_avx2;
pub(crate) use task::{Task, on_this_processor};
#[cfg(target_arch = "x86_64")]
pub(crate) use {avx2::Avx2, avx512::Avx512};

use glam::Vec4;

/// Children of a node at most.
pub(crate) const CHILDREN: usize = 16;

/// Children of one kind: their numbers are those of the first and their places together.
#[derive(Clone, Copy)]
pub(crate) struct Children<'a> {
    pub(crate) first: u32,
    pub(crate) places: &'a [u8; CHILDREN],
}

impl Children<'_> {
    /// Number of a child.
    #[inline(always)]
    pub(crate) fn number(&self, k: u32) -> u32 {
        self.first
            .wrapping_add(u32::from(self.places[k as usize % CHILDREN]))
    }
}

/// Up to eight children of two kinds: those of the first kind come first, and the numbers of each kind follow one another.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Eight {
    /// What is added to a child's place.
    pub(crate) first: [u32; 2],
    /// How many are of the first kind.
    pub(crate) split: u32,
}

impl Eight {
    /// The bit of a number that says that it is of the second kind.
    pub(crate) const SECOND: u32 = 1 << 31;

    /// Number of a child, without a branch.
    #[inline(always)]
    pub(crate) fn number(&self, k: u32) -> u32 {
        let second = u32::from(k >= self.split);
        self.first[second as usize].wrapping_add(k) | second << 31
    }
}

/// Numbers in single precision, side by side. Every operation rounds as it does on one number, so that results are the
/// same to the bit whatever does it.
pub(crate) trait Numbers: Copy {
    /// How many.
    const COUNT: u32;
    fn splat(x: f32) -> Self;
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    /// `self * b + c`, rounded once or twice: the exception, for what need not be the same to the bit.
    fn mul_add(self, b: Self, c: Self) -> Self;
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    /// Where `self <= other`, a bit each.
    fn le(self, other: Self) -> u32;
}

/// What a processor does with them.
pub(crate) trait Lanes {
    type Eight: Numbers;
    type Sixteen: Numbers;
    fn bytes(x: &[u8; CHILDREN]) -> Self::Sixteen;
    fn words(x: &[u16; 16]) -> Self::Sixteen;
    fn whole(x: &[i32; 8]) -> Self::Eight;
    /// The lanes of eight in another order: lane `k` is the one whose number the lower three of the four bits from `4 k`
    /// on say.
    fn pick(x: Self::Eight, order: u32) -> Self::Eight;
    fn short(x: &[u16; 8]) -> Self::Eight;
    /// Which of eight boxes around normals have some that a direction runs against, and some that it runs along, a bit each.
    ///
    /// * `least`, `most`: corners of the boxes, 128 more than they are, the fourth number of no meaning.
    fn facing(least: &[[u8; 4]; 8], most: &[[u8; 4]; 8], way: &Way) -> [u32; 2];
    /// Puts the chosen of eight children in a row, the nearest last, and says how many; what is behind them in the row
    /// has no meaning.
    ///
    /// * `begins`: where a ray enters their boxes, not negative; may be rounded down by some parts in a million.
    #[inline(always)]
    fn row(chosen: u32, begins: &[f32; 8], children: &Eight, row: &mut [Aside; 8]) -> usize {
        let mut count = 0;
        for k in (0..8).filter(|k| chosen >> k & 1 != 0) {
            let other = Aside::new(begins[k as usize], children.number(k));
            let mut at = count;
            while at > 0 && row[at - 1] < other {
                row[at] = row[at - 1];
                at -= 1;
            }
            row[at] = other;
            count += 1;
        }
        count
    }

    /// Eight from the first, the fifth and the ninth on.
    fn head(x: Self::Sixteen) -> Self::Eight;
    fn middle(x: Self::Sixteen) -> Self::Eight;
    fn tail(x: Self::Sixteen) -> Self::Eight;
    fn eight(x: Self::Eight) -> [f32; 8];
    fn sixteen(x: Self::Sixteen) -> [f32; CHILDREN];

    /// `columns` times `v`, rounded as [`Numbers::mul_add`] is.
    #[inline(always)]
    fn turn(columns: &[Vec4; 3], v: Vec4) -> Vec4 {
        columns[0] * v.x + columns[1] * v.y + columns[2] * v.z
    }

    /// Puts the chosen of a node's children in a row, the nearest last, and says how many.
    ///
    /// * `begins`: where the ray enters their boxes, not negative.
    #[inline(always)]
    fn line_up(
        chosen: u16,
        begins: Self::Sixteen,
        children: Children<'_>,
        row: &mut [Aside; CHILDREN],
    ) -> usize {
        line_up(chosen, &Self::sixteen(begins), children, row)
    }
}

/// A direction for [`Lanes::facing`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    /// In parts of 63, the fourth 0.
    by: [i8; 4],
    /// Of all bits where that is negative.
    down: [u8; 4],
    /// Products up to which, and from which on.
    against: i32,
    along: i32,
}

impl Way {
    /// * `room`: how much a product may be on the other side of zero, in parts of 127 times 63.
    #[inline(always)]
    pub(crate) fn new(dir: [f32; 3], room: i32) -> Self {
        // To the nearest: above zero, conversions round down.
        let by = dir.map(|d| (63.0 * d + 64.5) as i32 - 64);
        let all = 128 * (by[0] + by[1] + by[2]);
        Self {
            by: [by[0] as i8, by[1] as i8, by[2] as i8, 0],
            down: [by[0], by[1], by[2], 0].map(|d| (d >> 31) as u8),
            against: all + room,
            along: all - room,
        }
    }
}

/// Something to look at later: how far away it is, as bits, which order as the distances do, and what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(transparent)]
pub(crate) struct Aside(u64);

impl Aside {
    pub(crate) const NONE: Self = Self(0);

    #[inline(always)]
    pub(crate) fn new(distance: f32, number: u32) -> Self {
        Self(u64::from(distance.to_bits()) << 32 | u64::from(number))
    }

    #[inline(always)]
    pub(crate) fn distance(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    #[inline(always)]
    pub(crate) fn number(self) -> usize {
        self.0 as u32 as usize
    }
}

/// [`Lanes::line_up`] for any number of children on any processor.
fn line_up(
    mut chosen: u16,
    begins: &[f32; CHILDREN],
    children: Children<'_>,
    row: &mut [Aside; CHILDREN],
) -> usize {
    let mut count = 0;
    while chosen != 0 {
        let k = chosen.trailing_zeros() as usize;
        chosen &= chosen - 1;
        let other = Aside::new(begins[k], children.number(k as u32));
        let mut at = count;
        while at > 0 && row[at - 1] < other {
            row[at] = row[at - 1];
            at -= 1;
        }
        row[at] = other;
        count += 1;
    }
    count
}

/// For every processor.
pub(crate) struct Plain;

impl Numbers for Vec4 {
    const COUNT: u32 = 4;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self::splat(x)
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self + other
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self - other
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self * other
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self / other
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::min(self, other)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::max(self, other)
    }

    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        self.cmple(other).bitmask()
    }
}

/// Twice as many.
impl<N: Numbers> Numbers for [N; 2] {
    const COUNT: u32 = 2 * N::COUNT;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        [N::splat(x); 2]
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        [self[0].add(other[0]), self[1].add(other[1])]
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        [self[0].sub(other[0]), self[1].sub(other[1])]
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        [self[0].mul(other[0]), self[1].mul(other[1])]
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        [self[0].div(other[0]), self[1].div(other[1])]
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        [self[0].mul_add(b[0], c[0]), self[1].mul_add(b[1], c[1])]
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        [self[0].min(other[0]), self[1].min(other[1])]
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        [self[0].max(other[0]), self[1].max(other[1])]
    }

    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        self[0].le(other[0]) | self[1].le(other[1]) << N::COUNT
    }
}

impl Lanes for Plain {
    type Eight = [Vec4; 2];
    type Sixteen = [[Vec4; 2]; 2];

    #[inline(always)]
    fn bytes(x: &[u8; CHILDREN]) -> Self::Sixteen {
        let four = |k: usize| Vec4::from_array(std::array::from_fn(|i| f32::from(x[k + i])));
        [[four(0), four(4)], [four(8), four(12)]]
    }

    #[inline(always)]
    fn words(x: &[u16; 16]) -> Self::Sixteen {
        let four = |k: usize| Vec4::from_array(std::array::from_fn(|i| f32::from(x[k + i])));
        [[four(0), four(4)], [four(8), four(12)]]
    }

    #[inline(always)]
    fn whole(x: &[i32; 8]) -> Self::Eight {
        let four = |k: usize| Vec4::from_array(std::array::from_fn(|i| x[k + i] as f32));
        [four(0), four(4)]
    }

    #[inline(always)]
    fn pick(x: Self::Eight, order: u32) -> Self::Eight {
        let x = Self::eight(x);
        let one = |k: usize| x[(order >> (4 * k) & 7) as usize];
        let four = |k: usize| Vec4::from_array(std::array::from_fn(|i| one(k + i)));
        [four(0), four(4)]
    }

    #[inline(always)]
    fn short(x: &[u16; 8]) -> Self::Eight {
        let four = |k: usize| Vec4::from_array(std::array::from_fn(|i| f32::from(x[k + i])));
        [four(0), four(4)]
    }

    #[inline(always)]
    fn facing(least: &[[u8; 4]; 8], most: &[[u8; 4]; 8], way: &Way) -> [u32; 2] {
        let mut sides = [0; 2];
        for k in 0..8 {
            let dot = |near: &[u8; 4], far: &[u8; 4]| -> i32 {
                let corner = |axis: usize| match way.down[axis] {
                    0 => near[axis],
                    _ => far[axis],
                };
                (0..3)
                    .map(|axis| i32::from(corner(axis)) * i32::from(way.by[axis]))
                    .sum()
            };
            sides[0] |= u32::from(dot(&least[k], &most[k]) <= way.against) << k;
            sides[1] |= u32::from(dot(&most[k], &least[k]) >= way.along) << k;
        }
        sides
    }

    #[inline(always)]
    fn head(x: Self::Sixteen) -> Self::Eight {
        x[0]
    }

    #[inline(always)]
    fn middle(x: Self::Sixteen) -> Self::Eight {
        [x[0][1], x[1][0]]
    }

    #[inline(always)]
    fn tail(x: Self::Sixteen) -> Self::Eight {
        x[1]
    }

    #[inline(always)]
    fn eight(x: Self::Eight) -> [f32; 8] {
        let [[a, b, c, d], [e, f, g, h]] = x.map(|four| four.to_array());
        [a, b, c, d, e, f, g, h]
    }

    #[inline(always)]
    fn sixteen(x: Self::Sixteen) -> [f32; CHILDREN] {
        both(x.map(Self::eight))
    }
}

/// Whether the processor has what [`Avx2`] needs, and BMI1, POPCNT and LZCNT.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(crate) fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("fma")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("popcnt")
        && is_x86_feature_detected!("lzcnt")
}

/// Whether it has what [`Avx512`] needs besides.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(crate) fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}

#[inline(always)]
fn both(x: [[f32; 8]; 2]) -> [f32; CHILDREN] {
    let mut all = [0.0; CHILDREN];
    all[..8].copy_from_slice(&x[0]);
    all[8..].copy_from_slice(&x[1]);
    all
}
