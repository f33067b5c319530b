//! Eight photons at rough or smooth dielectric boundaries: [`super::super::microfacet`] lane by lane, with the same
//! bits.

use super::super::microfacet::{MAX_STEPS, TOP};
use super::depths::Depths;
use crate::math::lanes::{F64x8, LANES, Mask, U64x8, Vectors, Wide};
use crate::math::turn::unit_vectors_of;
use crate::sampling::RngLanes;

/// Boundaries that eight photons meet.
#[derive(Clone, Copy)]
pub(super) struct Boundaries<W: Wide> {
    /// GGX roughness, more than 0.
    pub(super) alpha: F64x8<W>,
    /// Far index over near index, and the inverse.
    pub(super) eta: F64x8<W>,
    pub(super) inverse: F64x8<W>,
}

/// Fresnel decides.
#[inline(always)]
pub(super) fn smooth<W: Wide>(
    simd: W,
    lanes: Mask<W>,
    dir: Vectors<W>,
    n: Vectors<W>,
    (eta, inverse): (F64x8<W>, F64x8<W>),
    rng: &mut RngLanes<W>,
) -> (Vectors<W>, Mask<W>) {
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
fn renormalized<W: Wide>(dir: Vectors<W>) -> Vectors<W> {
    dir.times(1.5 - 0.5 * dir.dot(dir))
}

/// Eight walks on microsurfaces, each at a facet. See [`super::super::microfacet::walk`].
#[derive(Clone)]
pub(super) struct Walks<W: Wide> {
    /// Directions of travel, seen from the surface.
    d: Vectors<W>,
    /// Those above the surface.
    above: Mask<W>,
    depth: Depths<W>,
    /// How many facets each has met before.
    steps: U64x8<W>,
}

/// Axes of surfaces.
pub(super) struct Frames<W: Wide> {
    tangent: Vectors<W>,
    bitangent: Vectors<W>,
    normal: Vectors<W>,
}

impl<W: Wide> Frames<W> {
    /// The pair of `DVec3::any_orthonormal_pair` to a normal.
    #[inline(always)]
    pub(super) fn new(simd: W, n: Vectors<W>) -> Self {
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

impl<W: Wide> Walks<W> {
    /// Of rays that come from above, and which of them meet a facet.
    #[inline(always)]
    pub(super) fn begin(
        simd: W,
        lanes: Mask<W>,
        dir: Vectors<W>,
        frames: &Frames<W>,
        alpha: F64x8<W>,
        rng: &mut RngLanes<W>,
    ) -> (Self, Mask<W>) {
        let (zero, one) = (simd.all(0.0), simd.all(1.0));
        let &Frames {
            tangent,
            bitangent,
            normal,
        } = frames;
        let mut walks = Self {
            d: Vectors::new(dir.dot(tangent), dir.dot(bitangent), dir.dot(normal)),
            above: simd.every(),
            depth: Depths {
                top: simd.all(TOP),
                base: one,
                across: zero,
                along: one,
                flipped: simd.none(),
            },
            steps: simd.all_bits(0),
        };
        let walking = walks.free(simd, lanes, alpha, rng);
        (walks, walking)
    }

    /// Walks that were set aside.
    #[inline(always)]
    pub(super) fn resume(simd: W, columns: [F64x8<W>; LANES]) -> Self {
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
    pub(super) fn columns(&self, simd: W) -> [F64x8<W>; LANES] {
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
        simd: W,
        walking: Mask<W>,
        boundaries: &Boundaries<W>,
        rng: &mut RngLanes<W>,
    ) -> (Mask<W>, Mask<W>) {
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
    fn normals(
        &self,
        simd: W,
        walking: Mask<W>,
        alpha: F64x8<W>,
        rng: &mut RngLanes<W>,
    ) -> Vectors<W> {
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
    fn turn(&mut self, simd: W, walking: Mask<W>, d: Vectors<W>, through: Mask<W>) {
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
        simd: W,
        walking: Mask<W>,
        boundaries: &Boundaries<W>,
        rng: &mut RngLanes<W>,
    ) -> ([Self; 2], F64x8<W>) {
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
        back.turn(simd, walking, mirrored, simd.none());
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
        simd: W,
        lanes: Mask<W>,
        boundaries: &Boundaries<W>,
        rng: &mut RngLanes<W>,
    ) -> Mask<W> {
        let mut all_lost = simd.none();
        let mut walking = self.free(simd, lanes, boundaries.alpha, rng);
        while walking.any() {
            let lost;
            (walking, lost) = self.step(simd, walking, boundaries, rng);
            all_lost = all_lost | lost;
        }
        all_lost
    }

    #[inline(always)]
    fn free(
        &mut self,
        simd: W,
        walking: Mask<W>,
        alpha: F64x8<W>,
        rng: &mut RngLanes<W>,
    ) -> Mask<W> {
        let u = rng.uniform(simd, walking);
        let up = self.d.or(self.above, self.d.times(simd.all(-1.0)));
        self.depth.free(simd, walking, up, alpha, u)
    }

    /// Where the walks go, and which went through.
    #[inline(always)]
    pub(super) fn leave(&self, frames: &Frames<W>) -> (Vectors<W>, Mask<W>) {
        let d = self.d;
        let dir = frames
            .tangent
            .times(d.x)
            .plus(frames.bitangent.times(d.y))
            .plus(frames.normal.times(d.z));
        (dir, !self.above)
    }
}
