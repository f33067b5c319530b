//! For every processor: four numbers at a time as `glam` has them.

use super::{CHILDREN, Lanes, Numbers, Way, both};
use glam::Vec4;

/// See the file.
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
        [eight(&x[..8]), eight(&x[8..])]
    }

    #[inline(always)]
    fn words(x: &[u16; 16]) -> Self::Sixteen {
        [eight(&x[..8]), eight(&x[8..])]
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
        eight(x)
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

/// The first eight of some whole numbers.
#[inline(always)]
fn eight<T: Copy + Into<f32>>(x: &[T]) -> [Vec4; 2] {
    let four = |k: usize| Vec4::from_array(std::array::from_fn(|i| x[k + i].into()));
    [four(0), four(4)]
}
