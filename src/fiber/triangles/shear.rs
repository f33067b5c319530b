//! The watertight test of Woop, Benthin and Wald (2013) in double precision: a shear makes the ray a
//! coordinate axis, so that two triangles decide about their common edge from the same numbers, and
//! which side a triangle shows from those numbers too.

use glam::DVec3;

/// A ray made an axis.
#[derive(Clone, Debug)]
pub(super) struct Shear {
    pub(super) origin: DVec3,
    pub(super) dir: DVec3,
    /// Two axes across the ray and the one along it.
    pub(super) axes: [usize; 3],
    /// How far the ray goes across for each radius along the third axis, and along itself.
    pub(super) shear: [f64; 3],
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy)]
pub(super) struct Meeting {
    pub(super) t: f64,
    /// Against the outward normal, from outside to inside.
    pub(super) enters: bool,
}

impl Shear {
    #[inline(always)]
    pub(super) fn new(origin: DVec3, dir: DVec3) -> Self {
        let a = dir.abs();
        // Directions are random: no branch would be guessed.
        let of_two = if a.y >= a.z { 1 } else { 2 };
        let z = if a.x >= a.y.max(a.z) { 0 } else { of_two };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        // Exchanging two axes keeps the winding for rays along negative ones.
        let (x, y) = if dir[z] < 0.0 { (y, x) } else { (x, y) };
        Self {
            origin,
            dir,
            axes: [x, y, z],
            shear: [dir[x] / dir[z], dir[y] / dir[z], 1.0 / dir[z]],
        }
    }

    /// The meeting with a triangle's plane within its edges, wherever on the line it is.
    #[inline(always)]
    pub(super) fn meet(&self, corners: &[DVec3; 3]) -> Option<Meeting> {
        let [x, y, z] = self.axes;
        let [sx, sy, sz] = self.shear;
        // Plain arrays: vectors take a branch to look an axis up.
        let o: &[f64; 3] = self.origin.as_ref();
        let p = [&corners[0], &corners[1], &corners[2]].map(|c| {
            let c: &[f64; 3] = c.as_ref();
            [c[x] - o[x], c[y] - o[y], c[z] - o[z]]
        });
        let flat = p.map(|p| (p[0] - sx * p[2], p[1] - sy * p[2]));
        let cross = |(ax, ay): (f64, f64), (bx, by): (f64, f64)| ax * by - ay * bx;
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
        let depth = u * p[0][2] + v * p[1][2] + w * p[2][2];
        Some(Meeting {
            t: sz * depth / sum,
            // Seen along +z of a right-handed frame, counterclockwise corners run clockwise.
            enters: sum < 0.0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;

    fn unit(rng: &mut Rng) -> DVec3 {
        let z = 2.0 * rng.uniform() - 1.0;
        let (sin, cos) = (std::f64::consts::TAU * rng.uniform()).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cos, r * sin, z)
    }

    #[test]
    fn distance_and_side_are_those_of_the_plane() {
        let mut met = 0;
        for k in 0..20_000 {
            let mut rng = Rng::new(1, k);
            let corners: [DVec3; 3] = std::array::from_fn(|_| unit(&mut rng));
            let (origin, dir) = (0.5 * unit(&mut rng), unit(&mut rng));
            let Some(meeting) = Shear::new(origin, dir).meet(&corners) else {
                continue;
            };
            met += 1;
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let t = (corners[0] - origin).dot(normal) / dir.dot(normal);
            assert!((meeting.t - t).abs() < 1e-9 * (1.0 + t.abs()) / dir.dot(normal).abs());
            assert_eq!(meeting.enters, dir.dot(normal) < 0.0);
        }
        assert!(met > 1000, "{met}");
    }

    /// Rays aimed at the vertices and edges of a closed octahedron from within always leave it.
    #[test]
    fn edges_and_corners_do_not_leak() {
        let axes = [DVec3::X, DVec3::Y, -DVec3::X, -DVec3::Y];
        let mut faces = Vec::new();
        for k in 0..4 {
            faces.push([axes[k], axes[(k + 1) % 4], DVec3::Z]);
            faces.push([axes[(k + 1) % 4], axes[k], -DVec3::Z]);
        }
        for k in 0..100_000 {
            let mut rng = Rng::new(2, k);
            let origin = 0.4 * unit(&mut rng);
            let face = faces[(rng.bits() % 8) as usize];
            let share = match k % 3 {
                0 => 0.0,
                1 => rng.uniform(),
                _ => 0.5,
            };
            let aim = face[0].lerp(face[1], share);
            let shear = Shear::new(origin, (aim - origin).normalize());
            let left = faces.iter().any(|f| {
                let meeting = shear.meet(f);
                meeting.is_some_and(|m| m.t > 0.0 && !m.enters)
            });
            assert!(left, "{k}");
        }
    }
}
