//! Eight photons at rough or smooth dielectric boundaries: [`super::super::microfacet`] lane by lane, with the same
//! bits.

use super::super::microfacet::{Depth, FLAT, MAX_STEPS, STEEP, Slope, TOP};
use crate::math::lanes::{Avx512, F64x8, LANES, Mask, Row, U64x8, Vectors};
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
    let turned = renormalized(mirrored.or(reflected, refracted));
    (turned, !reflected)
}

/// See [`crate::math::fresnel::renormalize`].
#[inline(always)]
fn renormalized(dir: Vectors) -> Vectors {
    dir.times(1.5 - 0.5 * dir.dot(dir))
}

/// Eight walks on microsurfaces, each at a facet. See [`super::super::microfacet::walk`].
#[derive(Clone)]
pub(super) struct Walks {
    /// Directions of travel, seen from the surface.
    d: Vectors,
    /// Those above the surface.
    above: Mask,
    depth: Depths,
    /// How many facets each has met before.
    steps: U64x8,
}

/// Axes of surfaces.
pub(super) struct Frames {
    tangent: Vectors,
    bitangent: Vectors,
    normal: Vectors,
}

impl Frames {
    /// The pair of `DVec3::any_orthonormal_pair` to a normal.
    #[inline(always)]
    pub(super) fn new(simd: Avx512, n: Vectors) -> Self {
        let sign = simd.all(1.0).with_sign_of(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            tangent: Vectors::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            bitangent: Vectors::new(b, sign + n.y * n.y * a, -n.y),
            normal: n,
        }
    }
}

/// Bits of a walk's last number: above the surface, upside down, and from [`STEPS`] on the facets met.
const ABOVE: u64 = 1;
const FLIPPED: u64 = 2;
const STEPS: u32 = 2;

impl Walks {
    /// Of rays that come from above, and which of them meet a facet.
    #[inline(always)]
    pub(super) fn begin(
        simd: Avx512,
        lanes: Mask,
        dir: Vectors,
        frames: &Frames,
        alpha: F64x8,
        rng: &mut RngLanes,
    ) -> (Self, Mask) {
        let (zero, one) = (simd.all(0.0), simd.all(1.0));
        let &Frames {
            tangent,
            bitangent,
            normal,
        } = frames;
        let mut walks = Self {
            d: Vectors::new(dir.dot(tangent), dir.dot(bitangent), dir.dot(normal)),
            above: Mask::ALL,
            depth: Depths {
                top: simd.all(TOP),
                base: one,
                across: zero,
                along: one,
                flipped: Mask::NONE,
            },
            steps: simd.all_bits(0),
        };
        let walking = walks.free(simd, lanes, alpha, rng);
        (walks, walking)
    }

    /// Walks that were set aside.
    #[inline(always)]
    pub(super) fn resume(simd: Avx512, columns: [F64x8; LANES]) -> Self {
        let [x, y, z, top, base, across, along, last] = columns;
        let last = last.bits();
        let none = simd.all_bits(0);
        Self {
            d: Vectors::new(x, y, z),
            above: !last.and(simd.all_bits(ABOVE)).is(none),
            depth: Depths {
                top,
                base,
                across,
                along,
                flipped: !last.and(simd.all_bits(FLIPPED)).is(none),
            },
            steps: last.right::<STEPS>(),
        }
    }

    /// To be set aside: what [`Walks::resume`] takes.
    #[inline(always)]
    pub(super) fn columns(&self, simd: Avx512) -> [F64x8; LANES] {
        let none = simd.all_bits(0);
        let above = simd.all_bits(ABOVE).or(self.above, none);
        let flipped = simd.all_bits(FLIPPED).or(self.depth.flipped, none);
        let last = self.steps.left::<STEPS>().plus(above).plus(flipped);
        let (d, depth) = (self.d, &self.depth);
        [
            d.x,
            d.y,
            d.z,
            depth.top,
            depth.base,
            depth.across,
            depth.along,
            last.numbers(),
        ]
    }

    /// What the facets do and which walks meet another. Those that have met the most there may be are lost.
    #[inline(always)]
    pub(super) fn step(
        &mut self,
        simd: Avx512,
        walking: Mask,
        boundaries: &Boundaries,
        rng: &mut RngLanes,
    ) -> (Mask, Mask) {
        let &Boundaries {
            alpha,
            eta,
            inverse,
        } = boundaries;
        let (d, above) = (self.d, self.above);
        let m = self.normals(simd, walking, alpha, rng);
        let ratio = (eta.or(above, inverse), inverse.or(above, eta));
        let (turned, transmitted) = smooth(simd, walking, d, m, ratio, rng);
        self.turn(simd, walking, turned, transmitted & walking);
        let lost = walking & !self.steps.lt(simd.all_bits(MAX_STEPS as u64));
        (self.free(simd, walking & !lost, alpha, rng), lost)
    }

    /// Normals of the facets, against the walks. See `bake::microfacet`.
    #[inline(always)]
    fn normals(&self, simd: Avx512, walking: Mask, alpha: F64x8, rng: &mut RngLanes) -> Vectors {
        let (zero, one) = (simd.all(0.0), simd.all(1.0));
        let side = one.or(self.above, -one);
        let w = self.d.times(-side);
        let v = Vectors::new(alpha * w.x, alpha * w.y, w.z).normalized();
        let around = unit_vectors_of(simd, rng.bits(simd, walking));
        let z = (1.0 - rng.uniform(simd, walking)) * (1.0 + v.z) - v.z;
        let r = (1.0 - z * z).max(zero).sqrt();
        let h = Vectors::new(r * around[0], r * around[1], z).plus(v);
        let m = Vectors::new(alpha * h.x, alpha * h.y, h.z.max(simd.all(1e-9))).normalized();
        m.times(side)
    }

    /// Goes on as a facet has decided.
    #[inline(always)]
    fn turn(&mut self, simd: Avx512, walking: Mask, d: Vectors, through: Mask) {
        self.d = d.or(walking, self.d);
        self.above = self.above ^ through;
        self.depth.flipped = self.depth.flipped ^ through;
        self.steps = self.steps.plus(simd.all_bits(1));
    }

    /// Both ways at the first facet, the reflected one first, and the share of that; see
    /// [`super::super::fork::fork`].
    #[inline(always)]
    pub(super) fn fork(
        &self,
        simd: Avx512,
        walking: Mask,
        boundaries: &Boundaries,
        rng: &mut RngLanes,
    ) -> ([Self; 2], F64x8) {
        let (zero, one) = (simd.all(0.0), simd.all(1.0));
        let &Boundaries {
            alpha,
            eta,
            inverse,
        } = boundaries;
        let d = self.d;
        let m = self.normals(simd, walking, alpha, rng);
        let along = d.dot(m);
        let cos_i = (-along).max(zero).min(one);
        // See [`crate::math::fresnel::dielectric`].
        let sin2_t = (1.0 - cos_i * cos_i).max(zero) / (eta * eta);
        let total = sin2_t.ge(one);
        let cos_t = (1.0 - sin2_t).max(zero).sqrt();
        let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
        let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
        let share = 0.5 * (parallel * parallel + perpendicular * perpendicular);
        let share = one.or(total, share);
        let through = walking & share.lt(one);
        let mirrored = renormalized(d.minus(m.times(2.0 * along)));
        let refracted = d.times(inverse).plus(m.times(inverse * -along - cos_t));
        let (mut back, mut on) = (self.clone(), self.clone());
        back.turn(simd, walking, mirrored, Mask::NONE);
        on.turn(
            simd,
            walking,
            renormalized(refracted).or(through, mirrored),
            through,
        );
        ([back, on], share)
    }

    /// Walks on from where a facet has decided until all have left; those that never do.
    #[inline(always)]
    pub(super) fn finish(
        &mut self,
        simd: Avx512,
        lanes: Mask,
        boundaries: &Boundaries,
        rng: &mut RngLanes,
    ) -> Mask {
        let mut all_lost = Mask::NONE;
        let mut walking = self.free(simd, lanes, boundaries.alpha, rng);
        while walking.any() {
            let lost;
            (walking, lost) = self.step(simd, walking, boundaries, rng);
            all_lost = all_lost | lost;
        }
        all_lost
    }

    #[inline(always)]
    fn free(&mut self, simd: Avx512, walking: Mask, alpha: F64x8, rng: &mut RngLanes) -> Mask {
        let u = rng.uniform(simd, walking);
        let up = self.d.or(self.above, self.d.times(simd.all(-1.0)));
        self.depth.free(simd, walking, up, alpha, u)
    }

    /// Where the walks go, and which went through.
    #[inline(always)]
    pub(super) fn leave(&self, frames: &Frames) -> (Vectors, Mask) {
        let d = self.d;
        let dir = frames
            .tangent
            .times(d.x)
            .plus(frames.bitangent.times(d.y))
            .plus(frames.normal.times(d.z));
        (dir, !self.above)
    }
}

/// Eight [`Depth`]s.
#[derive(Clone)]
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
