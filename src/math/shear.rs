//! Where a straight line meets a triangle, watertight.

use glam::Vec3;

/// The test of Woop, Benthin and Wald (2013): a shear makes the ray a coordinate axis, so that
/// neighbors decide about their common edge from the same numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shear {
    axes: [usize; 3],
    shear: [f32; 3],
}

impl Shear {
    /// * `dir`: direction of the line, not zero.
    pub(crate) fn new(dir: Vec3) -> Self {
        let a = dir.abs();
        let z = if a.x >= a.y && a.x >= a.z {
            0
        } else if a.y >= a.z {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        Self {
            axes: [x, y, z],
            shear: [dir[x] / dir[z], dir[y] / dir[z], 1.0 / dir[z]],
        }
    }

    /// Distance in lengths of the direction and barycentric coordinates; both sides count.
    #[inline(always)]
    pub(crate) fn intersect(&self, origin: Vec3, corners: &[Vec3; 3]) -> Option<(f32, [f32; 3])> {
        let [x, y, z] = self.axes;
        let [sx, sy, sz] = self.shear;
        let p = corners.map(|c| c - origin);
        let flat = p.map(|p| (p[x] - sx * p[z], p[y] - sy * p[z]));
        // Products of two single-precision numbers are exact in double precision.
        let cross = |(ax, ay): (f32, f32), (bx, by): (f32, f32)| {
            f64::from(ax) * f64::from(by) - f64::from(ay) * f64::from(bx)
        };
        let u = cross(flat[1], flat[2]);
        let v = cross(flat[2], flat[0]);
        let w = cross(flat[0], flat[1]);
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let sum = u + v + w;
        if sum == 0.0 {
            return None;
        }
        let weights = [u / sum, v / sum, w / sum].map(|b| b as f32);
        let depth = weights[0] * p[0][z] + weights[1] * p[1][z] + weights[2] * p[2][z];
        Some((sz * depth, weights))
    }
}
