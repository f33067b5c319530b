//! Eight photons at rough or smooth dielectric boundaries: [`super::super::microfacet`] lane by lane, with the same
//! bits.

use super::super::microfacet::{Depth, FLAT, MAX_STEPS, STEEP, Slope, TOP};
use crate::math::lanes::{Avx512, F64x8, Mask, Row, Vectors};
use crate::math::turn::unit_vectors_of;
use crate::sampling::RngLanes;

/// Boundaries that eight photons meet.
#[derive(Clone, Copy)]
pub(super) struct Boundaries {
    /// GGX roughness, more than 0.
    pub(super) alpha: F64x8,
    /// Far index over near index, and the inverse.
    pub(super) eta: F64x8,
    pub(super) inverse: F64x8,
}

/// Where they go.
pub(super) struct Turns {
    pub(super) dir: Vectors,
    pub(super) transmitted: Mask,
    /// Those whose walk does not end.
    pub(super) lost: Mask,
}

/// Fresnel decides.
#[inline(always)]
pub(super) fn smooth(
    simd: Avx512,
    lanes: Mask,
    dir: Vectors,
    n: Vectors,
    (eta, inverse): (F64x8, F64x8),
    rng: &mut RngLanes,
) -> (Vectors, Mask) {
    let (zero, one) = (simd.all(0.0), simd.all(1.0));
    let along = dir.dot(n);
    let cos_i = (-along).max(zero).min(one);
    let u = rng.uniform(simd, lanes);
    let sin2_t = (1.0 - cos_i * cos_i).max(zero) * (inverse * inverse);
    let total = sin2_t.ge(one);
    let cos_t = (1.0 - sin2_t).max(zero).sqrt();
    let (p, s) = (eta * cos_i + cos_t, cos_i + eta * cos_t);
    let parallel = (eta * cos_i - cos_t) * s;
    let perpendicular = (cos_i - eta * cos_t) * p;
    let all = p * s;
    let chosen = (2.0 * u * (all * all)).lt(parallel * parallel + perpendicular * perpendicular);
    let reflected = total | chosen;
    let mirrored = dir.minus(n.times(2.0 * along));
    let refracted = dir.times(inverse).plus(n.times(inverse * -along - cos_t));
    let turned = mirrored.or(reflected, refracted);
    // See [`crate::math::fresnel::renormalize`].
    let turned = turned.times(1.5 - 0.5 * turned.dot(turned));
    (turned, !reflected)
}

/// Walks on the microsurfaces. See [`super::super::microfacet::walk`].
#[inline(always)]
pub(super) fn rough(
    simd: Avx512,
    lanes: Mask,
    dir: Vectors,
    n: Vectors,
    boundaries: &Boundaries,
    rng: &mut RngLanes,
) -> Turns {
    let (zero, one) = (simd.all(0.0), simd.all(1.0));
    let &Boundaries {
        alpha,
        eta,
        inverse,
    } = boundaries;
    // The pair of DVec3::any_orthonormal_pair.
    let sign = one.with_sign_of(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    let tangent = Vectors::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    let bitangent = Vectors::new(b, sign + n.y * n.y * a, -n.y);

    let mut d = Vectors::new(dir.dot(tangent), dir.dot(bitangent), dir.dot(n));
    let mut above = Mask::ALL;
    let mut depth = Depths {
        top: simd.all(TOP),
        base: one,
        across: zero,
        along: one,
        flipped: Mask::NONE,
    };
    let mut walking = lanes;
    for _ in 0..MAX_STEPS {
        let u = rng.uniform(simd, walking);
        let up = d.or(above, d.times(simd.all(-1.0)));
        walking = depth.free(simd, walking, up, alpha, u);
        if !walking.any() {
            break;
        }
        let side = one.or(above, -one);
        let w = d.times(-side);
        let v = Vectors::new(alpha * w.x, alpha * w.y, w.z).normalized();
        let around = unit_vectors_of(simd, rng.bits(simd, walking));
        let z = (1.0 - rng.uniform(simd, walking)) * (1.0 + v.z) - v.z;
        let r = (1.0 - z * z).max(zero).sqrt();
        let h = Vectors::new(r * around[0], r * around[1], z).plus(v);
        let m = Vectors::new(alpha * h.x, alpha * h.y, h.z.max(simd.all(1e-9))).normalized();
        let ratio = (eta.or(above, inverse), inverse.or(above, eta));
        let (turned, transmitted) = smooth(simd, walking, d, m.times(side), ratio, rng);
        d = turned.or(walking, d);
        let through = transmitted & walking;
        above = above ^ through;
        depth.flipped = depth.flipped ^ through;
    }
    let dir = tangent
        .times(d.x)
        .plus(bitangent.times(d.y))
        .plus(n.times(d.z));
    Turns {
        dir,
        transmitted: !above,
        lost: walking,
    }
}

/// Eight [`Depth`]s.
struct Depths {
    top: F64x8,
    base: F64x8,
    across: F64x8,
    along: F64x8,
    flipped: Mask,
}

impl Depths {
    /// The rays that meet the microsurface again, at the depth that is then theirs; the others got
    /// away. See [`Depth::free`].
    #[inline(always)]
    fn free(&mut self, simd: Avx512, lanes: Mask, d: Vectors, alpha: F64x8, u: F64x8) -> Mask {
        let (zero, one) = (simd.all(0.0), simd.all(1.0));
        let across = alpha * alpha * (d.x * d.x + d.y * d.y);
        let along = d.z * d.z;
        let upward = d.z.ge(simd.all(FLAT));
        let gain = 4.0 * along * u + across;
        let plain = (self.top * self.base * gain).gt(across);
        let whole = 4.0 * self.along + self.across;
        let least = whole - self.top * (whole - 4.0 * self.along * (1.0 - self.base));
        let turned = (least * gain).gt(across * whole);
        let gone = upward & ((self.flipped & turned) | (!self.flipped & plain));
        let mut walking = lanes & !gone;
        let downward = walking & d.z.le(simd.all(-FLAT));
        // What takes powers: shares below a place that is not the start, and rays up that no bound decides.
        let start = self.base.is(one) & !self.flipped;
        let slow = walking & (upward | (downward & !start));
        let quick = downward & start;
        let steep = d.z.lt(simd.all(-STEEP));
        let old = [self.top, self.base, self.across, self.along];
        self.top = (u * self.top).or(quick & steep, self.top);
        self.base = (1.0 - u).or(quick & !steep, self.base);
        self.across = zero.or(quick & steep, across.or(quick, self.across));
        self.along = one.or(quick & steep, along.or(quick, self.along));
        if slow.any() {
            let old = [old[0].row(), old[1].row(), old[2].row(), old[3].row()];
            let rays = [d.z.row(), across.row(), along.row(), u.row()];
            let gone = self.by_power(simd, slow, &old, &rays);
            walking = walking & !gone;
        }
        walking
    }

    /// What takes powers, one ray after another; those that get away.
    ///
    /// * `old`: depths before. * `rays`: cosine, slope and random number of each.
    #[inline(always)]
    fn by_power(&mut self, simd: Avx512, slow: Mask, old: &[Row; 4], rays: &[Row; 4]) -> Mask {
        let mut gone = Mask::NONE;
        let mut new = [
            self.top.row(),
            self.base.row(),
            self.across.row(),
            self.along.row(),
        ];
        for lane in slow.lanes() {
            let [top, base, across, along] = old.map(|row| row.0[lane]);
            let depth = Depth {
                top,
                base,
                slope: Slope { across, along },
                flipped: self.flipped.has(lane),
            };
            let [z, across, along, u] = rays.map(|row| row.0[lane]);
            let here = Mask(1 << lane);
            match depth.free_along(z, Slope { across, along }, u) {
                Some(depth) => {
                    let Slope { across, along } = depth.slope;
                    let parts = [depth.top, depth.base, across, along];
                    for (row, part) in new.iter_mut().zip(parts) {
                        row.0[lane] = part;
                    }
                    self.flipped = if depth.flipped {
                        self.flipped | here
                    } else {
                        self.flipped & !here
                    };
                }
                None => gone = gone | here,
            }
        }
        self.top = simd.load(&new[0]);
        self.base = simd.load(&new[1]);
        self.across = simd.load(&new[2]);
        self.along = simd.load(&new[3]);
        gone
    }
}
