//! The unicube map: a cube map whose strips are exactly equal in solid angle (Ho et al. 2011).
//!
//! Faces are ordered +X -X +Y -Y +Z -Z. On a face the two other axes, in alphabetical order, are
//! the coordinates `u` (column) and `v` (row), each divided by the face's own component: +X and -X
//! use (y, z), the Y faces (x, z), the Z faces (x, y). No axis is flipped, so mirroring y maps
//! texels onto texels. A plane coordinate x in `[-1, 1]` becomes the texture coordinate
//! `s = (6/pi) atan(x / sqrt(x^2 + 2))`.
//!
//! Strips are equal in area, texels are not: at 64 x 64 the largest is 1.303 times the smallest,
//! so every density divides by [`Unicube::solid_angle`].

use glam::DVec3;
use std::f64::consts::{FRAC_PI_6, PI};

/// Texture coordinate in `[-1, 1]` of a tangent-plane coordinate in `[-1, 1]`.
pub fn warp(x: f64) -> f64 {
    (6.0 / PI) * (x / (x * x + 2.0).sqrt()).atan()
}

/// Inverse of [`warp`].
pub fn unwarp(s: f64) -> f64 {
    let a = FRAC_PI_6 * s;
    std::f64::consts::SQRT_2 * a.sin() / (2.0 * a).cos().sqrt()
}

/// Solid angle per unit of texture area at plane coordinates `(x, y)`.
pub fn solid_angle_density(x: f64, y: f64) -> f64 {
    let (x2, y2) = (x * x, y * y);
    let r2 = 1.0 + x2 + y2;
    FRAC_PI_6 * FRAC_PI_6 * (1.0 + x2) * (1.0 + y2) * ((2.0 + x2) * (2.0 + y2)).sqrt()
        / (r2 * r2.sqrt())
}

/// The face of a direction and its plane coordinates in `[-1, 1]`. Ties go to X, then Y.
#[inline]
pub fn face_of(w: DVec3) -> (usize, f64, f64) {
    // Faces come at random: by numbers rather than branches, which could not be predicted.
    const COLUMN: [usize; 3] = [1, 0, 0];
    const ROW: [usize; 3] = [2, 2, 1];
    let a = w.abs();
    let not_x = usize::from(a.x < a.y) | usize::from(a.x < a.z);
    let axis = not_x * (1 + usize::from(a.y < a.z));
    let w = w.to_array();
    let along = w[axis].abs();
    let face = 2 * axis + usize::from(w[axis] < 0.0);
    (face, w[COLUMN[axis]] / along, w[ROW[axis]] / along)
}

/// Unit direction of plane coordinates on a face.
pub fn direction_on(face: usize, x: f64, y: f64) -> DVec3 {
    let one = if face.is_multiple_of(2) { 1.0 } else { -1.0 };
    match face / 2 {
        0 => DVec3::new(one, x, y),
        1 => DVec3::new(x, one, y),
        _ => DVec3::new(x, y, one),
    }
    .normalize()
}

/// Coefficients of x, x^3, ... of a fit of [`warp`].
const WARP: [f64; 5] = [
    1.350_193_732_6,
    -0.556_598_899_9,
    0.324_073_961_9,
    -0.155_768_177_2,
    0.038_117_819_3,
];

/// A unicube of `res` x `res` texels a face, with exact texel boundaries and solid angles.
///
/// Texel index = `(face * res + v) * res + u`.
#[derive(Clone, Debug)]
pub struct Unicube {
    res: usize,
    edges: Vec<f64>,
    /// Where each strip ends; the last one never does.
    ends: Vec<f64>,
    solid_angle: Vec<f64>,
}

impl Unicube {
    /// * `res`: texels along a face edge, 1..=1024.
    pub fn new(res: usize) -> Self {
        debug_assert!((1..=1024).contains(&res));
        let edges: Vec<f64> = (0..=res)
            .map(|i| unwarp(2.0 * i as f64 / res as f64 - 1.0).clamp(-1.0, 1.0))
            .collect();
        // Corner sums of atan2(x y, sqrt(1 + x^2 + y^2)) give the angle a plane rectangle subtends.
        let corner = |x: f64, y: f64| (x * y).atan2((1.0 + x * x + y * y).sqrt());
        let mut solid_angle = Vec::with_capacity(res * res);
        for v in 0..res {
            for u in 0..res {
                let (x0, x1, y0, y1) = (edges[u], edges[u + 1], edges[v], edges[v + 1]);
                solid_angle.push(corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0));
            }
        }
        let mut ends = edges[1..].to_vec();
        ends[res - 1] = f64::INFINITY;
        Self {
            res,
            edges,
            ends,
            solid_angle,
        }
    }

    /// Texels along a face edge.
    pub fn res(&self) -> usize {
        self.res
    }

    /// Texels of the whole map, `6 * res^2`.
    pub fn texels(&self) -> usize {
        6 * self.res * self.res
    }

    /// Solid angle of a texel in steradians; all texels sum to 4 pi.
    pub fn solid_angle(&self, texel: usize) -> f64 {
        self.solid_angle[texel % (self.res * self.res)]
    }

    /// The texel that holds unit direction `w`. Exact: a guess of the warp, then a compare with the
    /// stored boundary, so that it agrees with [`Unicube::direction`] to the last bit.
    #[inline]
    pub fn texel(&self, w: DVec3) -> usize {
        let (face, x, y) = face_of(w);
        (face * self.res + self.column(y)) * self.res + self.column(x)
    }

    #[inline]
    fn column(&self, x: f64) -> usize {
        // Odd polynomial fit of `warp`, off by less than 2.5e-5: less than a sixteenth of a texel, so that
        // what is guessed is the texel or the one before.
        let x2 = x * x;
        let [c0, c1, c2, c3, c4] = WARP;
        let s = x * ((c0 + c1 * x2) + (c2 + c3 * x2 + c4 * (x2 * x2)) * (x2 * x2));
        let guess = 0.5 * (s + 1.0) * self.res as f64 - (0.5 + 0.0625);
        // Adding 2^52 rounds, and leaves the whole number in the last bits.
        let bits = (guess.max(0.0) + (1u64 << 52) as f64).to_bits();
        let i = (bits as u32 as usize).min(self.res - 1);
        i + usize::from(x >= self.ends[i])
    }

    /// The direction at fraction `(a, b)` in `[0, 1)^2` of a texel and the texture-area Jacobian
    /// `d omega / (da db)` there. The Jacobian averages to the solid angle over the texel.
    pub fn direction(&self, texel: usize, a: f64, b: f64) -> (DVec3, f64) {
        let n = self.res;
        let (face, v, u) = (texel / (n * n), texel / n % n, texel % n);
        let step = 2.0 / n as f64;
        let x = unwarp((u as f64 + a) * step - 1.0).clamp(self.edges[u], self.edges[u + 1]);
        let y = unwarp((v as f64 + b) * step - 1.0).clamp(self.edges[v], self.edges[v + 1]);
        (
            direction_on(face, x, y),
            solid_angle_density(x, y) * step * step,
        )
    }

    /// The Jacobian `d omega / (da db)` of [`Unicube::direction`] at a given direction.
    pub fn jacobian(&self, w: DVec3) -> f64 {
        let (_, x, y) = face_of(w);
        let step = 2.0 / self.res as f64;
        solid_angle_density(x, y) * step * step
    }

    /// The texel of the mirror image y -> -y (azimuth phi -> -phi).
    pub fn mirrored(&self, texel: usize) -> usize {
        let n = self.res;
        let (face, v, u) = (texel / (n * n), texel / n % n, texel % n);
        let (face, v, u) = match face {
            0 | 1 => (face, v, n - 1 - u),
            2 | 3 => (5 - face, v, u),
            _ => (face, n - 1 - v, u),
        };
        (face * n + v) * n + u
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;

    #[test]
    fn solid_angles_sum_to_the_sphere_and_differ_by_a_third() {
        for res in [1, 2, 16, 64] {
            let map = Unicube::new(res);
            let sum: f64 = (0..map.texels()).map(|t| map.solid_angle(t)).sum();
            assert!((sum / (4.0 * PI) - 1.0).abs() < 1e-13, "res {res}: {sum}");
        }
        let map = Unicube::new(64);
        let all: Vec<f64> = (0..64 * 64).map(|t| map.solid_angle(t)).collect();
        let (lo, hi) = all
            .iter()
            .fold((f64::MAX, 0.0f64), |(l, h), &w| (l.min(w), h.max(w)));
        // The published-in-docs figure: texels are not equal.
        assert!((hi / lo - 1.303_19).abs() < 1e-4, "{}", hi / lo);
    }

    #[test]
    fn warp_round_trips_and_strips_are_equal() {
        for i in -100..=100 {
            let s = f64::from(i) / 100.0;
            assert!((warp(unwarp(s)) - s).abs() < 1e-14);
        }
        let map = Unicube::new(8);
        for u in 0..8 {
            let strip: f64 = (0..8).map(|v| map.solid_angle(v * 8 + u)).sum();
            assert!((strip - PI / 12.0).abs() < 1e-13);
        }
    }

    #[test]
    fn texels_hold_their_own_directions() {
        let maps = [1, 2, 64, 512, 1024].map(Unicube::new);
        let mut rng = Rng::new(7, 0);
        for i in 0..200_000 {
            let map = &maps[i % maps.len()];
            let texel = (rng.uniform() * map.texels() as f64) as usize;
            let (w, jacobian) = map.direction(texel, rng.uniform(), rng.uniform());
            assert!((map.jacobian(w) / jacobian - 1.0).abs() < 1e-9);
            let back = map.texel(w);
            let mirror = map.texel(DVec3::new(w.x, -w.y, w.z));
            assert_eq!(back, texel);
            assert_eq!(mirror, map.mirrored(texel));
        }
    }

    #[test]
    fn jacobian_averages_to_the_solid_angle() {
        let map = Unicube::new(4);
        for texel in 0..16 {
            let k = 64;
            let mut sum = 0.0;
            for i in 0..k * k {
                let (a, b) = ((i % k) as f64 + 0.5, (i / k) as f64 + 0.5);
                sum += map.direction(texel, a / k as f64, b / k as f64).1;
            }
            let mean = sum / (k * k) as f64;
            assert!((mean / map.solid_angle(texel) - 1.0).abs() < 1e-4);
        }
    }
}
