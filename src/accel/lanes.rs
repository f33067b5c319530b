//! Eight and sixteen numbers of single precision at a time, for trees of one's own.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod plain;
mod task;

pub(crate) use plain::Plain;
pub(crate) use task::{Task, on_this_processor};
#[cfg(all(test, target_arch = "x86_64"))]
pub(crate) use task::{on_avx2, on_avx512};

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
pub(crate) struct Siblings {
    /// What is added to a child's place.
    pub(crate) first: [u32; 2],
    /// How many are of the first kind.
    pub(crate) split: u32,
}

impl Siblings {
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
    fn row(chosen: u32, begins: &[f32; 8], children: &Siblings, row: &mut [Aside; 8]) -> usize {
        let mut count = 0;
        for k in (0..8).filter(|k| chosen >> k & 1 != 0) {
            insert(
                Aside::new(begins[k as usize], children.number(k)),
                row,
                count,
            );
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
        insert(Aside::new(begins[k], children.number(k as u32)), row, count);
        count += 1;
    }
    count
}

/// Puts another into a row of some, the nearest last.
#[inline(always)]
fn insert<const N: usize>(other: Aside, row: &mut [Aside; N], count: usize) {
    let mut at = count;
    while at > 0 && row[at - 1] < other {
        row[at] = row[at - 1];
        at -= 1;
    }
    row[at] = other;
}

/// Room for a row from a place on.
#[inline(always)]
pub(crate) fn room_for<const N: usize>(all: &mut [Aside], from: usize) -> &mut [Aside; N] {
    all[from..]
        .first_chunk_mut()
        .expect("room for a row beyond the last")
}

#[inline(always)]
fn both(x: [[f32; 8]; 2]) -> [f32; CHILDREN] {
    let mut all = [0.0; CHILDREN];
    all[..8].copy_from_slice(&x[0]);
    all[8..].copy_from_slice(&x[1]);
    all
}
