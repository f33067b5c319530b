//! Triangles with common corners.

use super::KINDS;
use super::node::{ANY, Normals, normals};
use super::ray::Line;
use crate::accel::lanes::{Lanes, Numbers};
use glam::DVec3;

/// Triangles of a leaf at most, and corners of all of them.
pub(super) const SIZE: usize = 8;

/// Height of a triangle, in radii, below which its normal is not relied on: a million roundings of double precision.
const SLIVER: f64 = 1e-9;

/// Up to eight triangles over up to eight points, in two lines of a cache. Points are counted in steps that are the
/// same for the whole tree, so that they are exact.
#[derive(Clone, Debug)]
#[repr(C, align(128))]
pub(super) struct Leaf {
    points: [[i32; SIZE]; 3],
    /// For each of the three corners the point that it is, four bits a triangle.
    corners: [u32; 3],
    /// For each kind the triangles that are of it if entered, and if left, a bit each.
    pub(super) holds: [[u8; 2]; KINDS],
    /// How many triangles there are.
    count: u8,
}

const _: () = assert!(size_of::<Leaf>() == 128);

/// A point in steps.
pub(super) type Steps = [i32; 3];

impl Leaf {
    /// * `triangles`: one to eight, of at most eight different points.
    pub(super) fn new(triangles: &[[Steps; 3]]) -> Self {
        let mut points: Vec<Steps> = Vec::with_capacity(SIZE);
        let mut corners = [0; 3];
        for (k, triangle) in triangles.iter().enumerate() {
            for (corner, point) in corners.iter_mut().zip(triangle) {
                let known = points.iter().position(|p| p == point);
                let at = known.unwrap_or(points.len());
                if known.is_none() {
                    points.push(*point);
                }
                *corner |= (at as u32) << (4 * k);
            }
        }
        debug_assert!(points.len() <= SIZE && triangles.len() <= SIZE);
        let used = ((1u32 << triangles.len()) - 1) as u8;
        Self {
            // Points beyond the last are as far away as another, so that no number is large.
            points: [0, 1, 2]
                .map(|axis| std::array::from_fn(|k| points[k.min(points.len() - 1)][axis])),
            corners,
            holds: [[used; 2]; KINDS],
            count: triangles.len() as u8,
        }
    }

    /// How many triangles there are.
    pub(super) fn count(&self) -> usize {
        self.count.into()
    }

    /// Corners of a triangle, in radii, to the bit as they were given.
    ///
    /// * `step`: in radii.
    #[inline(always)]
    pub(super) fn corners(&self, k: usize, step: f64) -> [DVec3; 3] {
        let [x, y, z] = &self.points;
        self.corners.map(|corner| {
            let p = (corner >> (4 * k) & 7) as usize;
            step * DVec3::new(f64::from(x[p]), f64::from(y[p]), f64::from(z[p]))
        })
    }

    /// What the normals of all triangles are between.
    ///
    /// * `step`: in radii.
    pub(super) fn normals(&self, step: f64) -> Normals {
        let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for k in 0..self.count() {
            let [a, b, c] = self.corners(k, step);
            let normal = (b - a).cross(c - a);
            let longest = (b - a).length().max((c - a).length());
            // Which side of a sliver is seen is decided by rounding.
            if normal.length() < SLIVER * longest {
                return ANY;
            }
            let normal = normal.normalize();
            (lo, hi) = (lo.min(normal), hi.max(normal));
        }
        normals(lo, hi)
    }

    /// Turns a triangle inside out.
    pub(super) fn turn(&mut self, k: usize) {
        let [_, b, c] = self.corners.map(|corner| corner >> (4 * k) & 7);
        let change = (b ^ c) << (4 * k);
        self.corners[1] ^= change;
        self.corners[2] ^= change;
    }

    /// Which of the triangles of a kind the line of a ray may meet from the side that is asked for, a bit each: the test
    /// of [`Shear`](super::super::shear::Shear) with room for rounding.
    #[inline(always)]
    pub(super) fn meets<L: Lanes>(&self, line: &Line, kind: usize) -> u32 {
        type Row<L> = <L as Lanes>::Eight;
        let step = Row::<L>::splat(line.step);
        let zero = Row::<L>::splat(0.0);
        let x = self.axis::<L>(line.axes[0], step, line.from[0]);
        let y = self.axis::<L>(line.axes[1], step, line.from[1]);
        let z = self.axis::<L>(line.axes[2], step, line.from[2]);
        let x = x.sub(z.mul(Row::<L>::splat(line.slope[0])));
        let y = y.sub(z.mul(Row::<L>::splat(line.slope[1])));
        // How far points are off the ray.
        let off = x.max(zero.sub(x)).add(y.max(zero.sub(y)));

        let [a, b, c] = self.corners;
        let (ax, ay) = (L::pick(x, a), L::pick(y, a));
        let (bx, by) = (L::pick(x, b), L::pick(y, b));
        let (cx, cy) = (L::pick(x, c), L::pick(y, c));
        let u = bx.mul(cy).sub(by.mul(cx));
        let v = cx.mul(ay).sub(cy.mul(ax));
        let w = ax.mul(by).sub(ay.mul(bx));
        let off = L::pick(off, a).add(L::pick(off, b)).add(L::pick(off, c));
        // Each of the three is off by as much as a point may be, times how far the other points are off.
        let room = off
            .add(Row::<L>::splat(line.room))
            .mul(Row::<L>::splat(2.0 * line.room));
        let left = zero.sub(room).le(u.min(v).min(w));
        let entered = u.max(v).max(w).le(room);
        let [may_enter, may_leave] = self.holds[kind % KINDS].map(u32::from);
        entered & may_enter | left & may_leave
    }

    #[inline(always)]
    fn axis<L: Lanes>(&self, axis: usize, step: L::Eight, from: f32) -> L::Eight {
        L::whole(&self.points[axis])
            .mul(step)
            .sub(L::Eight::splat(from))
    }
}
