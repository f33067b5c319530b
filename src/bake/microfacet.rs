//! Rough boundaries by a random walk on a GGX microsurface.
//!
//! The walk of Heitz, Hanika, d'Eon and Dachsbacher 2016 ("Multiple-scattering microfacet BSDFs with
//! the Smith model"): no energy is lost at any roughness, and the result is reciprocal, which a
//! single reflection with shadowing is not. Visible normals by spherical caps (Dupuy and Benyoub
//! 2023).

use crate::math::fresnel;
use crate::math::turn::unit_vector_of;
use crate::sampling::Rng;
use glam::DVec3;

/// Where a photon goes at a boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    /// New unit direction of travel.
    pub dir: DVec3,
    /// Whether it went through.
    pub transmitted: bool,
}

/// The indices on both sides of a boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ratio {
    /// Far index over near index.
    pub eta: f64,
    /// Near index over far index.
    pub inverse: f64,
}

impl Ratio {
    /// The boundary seen from the side `n` points to (`above`) or from the other one.
    #[inline]
    pub(super) fn on_side(self, above: bool) -> Self {
        if above {
            return self;
        }
        Self {
            eta: self.inverse,
            inverse: self.eta,
        }
    }
}

/// Smooth boundary: Fresnel decides by one random number.
///
/// * `n`: unit normal against the ray.
#[inline(always)]
pub(super) fn smooth(dir: DVec3, n: DVec3, ratio: Ratio, rng: &mut Rng) -> Turn {
    let Ratio { eta, inverse } = ratio;
    let cos_i = (-dir.dot(n)).clamp(0.0, 1.0);
    let (reflected, cos_t) = fresnel::reflects(cos_i, eta, inverse, rng.uniform());
    let turned = if reflected {
        fresnel::renormalize(fresnel::reflect(dir, n))
    } else {
        fresnel::refract_by(dir, n, inverse, cos_t)
    };
    Turn {
        dir: turned,
        transmitted: !reflected,
    }
}

/// Rough dielectric boundary with GGX roughness `alpha` > 0. See [`walk`].
pub(super) fn rough(dir: DVec3, n: DVec3, ratio: Ratio, alpha: f64, rng: &mut Rng) -> Option<Turn> {
    walk(dir, n, alpha, rng, |dir, m, above, rng| {
        smooth(dir, m, ratio.on_side(above), rng)
    })
}

/// Walks on a microsurface of roughness `alpha` > 0 until it is left. `None` if the walk does not
/// end (not seen; the caller counts it as lost).
///
/// * `facet`: what happens at one facet, from the direction of travel, the facet's unit normal
///   against it and whether the ray is above the surface.
pub(super) fn walk(
    dir: DVec3,
    n: DVec3,
    alpha: f64,
    rng: &mut Rng,
    mut facet: impl FnMut(DVec3, DVec3, bool, &mut Rng) -> Turn,
) -> Option<Turn> {
    let (tangent, bitangent) = n.any_orthonormal_pair();
    let mut d = DVec3::new(dir.dot(tangent), dir.dot(bitangent), dir.dot(n));
    let mut above = true;
    let mut depth = Depth::from_share(TOP);
    for _ in 0..MAX_STEPS {
        // Below the surface the same walk runs upside down.
        let up = if above { d } else { -d };
        let Some(met) = depth.free(up, alpha, rng.uniform()) else {
            return Some(Turn {
                dir: d.x * tangent + d.y * bitangent + d.z * n,
                transmitted: !above,
            });
        };
        depth = met;
        let side = if above { 1.0 } else { -1.0 };
        let m = side * visible_normal(-side * d, alpha, rng);
        let turn = facet(d, m, above, rng);
        d = turn.dir;
        if turn.transmitted {
            above = !above;
            depth = depth.turned();
        }
    }
    None
}

/// Heights are uniform; the walk starts where this share of the surface lies below.
pub(super) const TOP: f64 = 0.999;

/// A walk of this length does not happen: each step escapes with a probability near a half.
pub(super) const MAX_STEPS: usize = 256;

/// How deep in the microsurface a walk is: the share of the surface that lies below (behind, once
/// it is upside down), `top * base^exponent` or one minus that, where the exponent is `-1 / Lambda` of
/// the ray that came down. Nearly all walks are decided by bounds of powers (Bernoulli's inequality)
/// and of Lambda; roots and powers are computed only for the others.
#[derive(Clone, Copy)]
pub(super) struct Depth {
    pub(super) top: f64,
    pub(super) base: f64,
    pub(super) slope: Slope,
    pub(super) flipped: bool,
}

/// Square of the tangent of a ray's angle to the normal times that of the roughness, as a fraction.
#[derive(Clone, Copy)]
pub(super) struct Slope {
    pub(super) across: f64,
    pub(super) along: f64,
}

impl Slope {
    #[inline]
    fn new(d: DVec3, alpha: f64) -> Self {
        Self {
            across: alpha * alpha * (d.x * d.x + d.y * d.y),
            along: d.z * d.z,
        }
    }

    /// Smith's Lambda of GGX for a ray that goes up; for one that goes down it is `-1 - lambda`.
    #[cold]
    fn lambda(self) -> f64 {
        0.5 * ((1.0 + self.across / self.along).sqrt() - 1.0)
    }
}

impl Depth {
    #[inline]
    fn from_share(share: f64) -> Self {
        Self {
            top: share,
            base: 1.0,
            slope: Slope {
                across: 0.0,
                along: 1.0,
            },
            flipped: false,
        }
    }

    /// The same place seen from the other side of the surface.
    #[inline]
    fn turned(self) -> Self {
        Self {
            flipped: !self.flipped,
            ..self
        }
    }

    /// The share below.
    #[cold]
    fn share(self) -> f64 {
        let share = self.top * self.base.powf(1.0 / (1.0 + self.slope.lambda()));
        if self.flipped { 1.0 - share } else { share }
    }

    /// Whether a ray that goes up surely gets away: by bounds of both powers.
    ///
    /// It does if `1 - u < share^lambda`, which is at least `1 - lambda (1 / share - 1)`.
    #[inline(always)]
    fn lets_go(self, slope: Slope, u: f64) -> bool {
        // Lambda is at most a quarter of the slope.
        let gain = 4.0 * slope.along * u + slope.across;
        if !self.flipped {
            return self.top * self.base * gain > slope.across;
        }
        let Slope { across, along } = self.slope;
        let whole = 4.0 * along + across;
        let least = whole - self.top * (whole - 4.0 * along * (1.0 - self.base));
        least * gain > slope.across * whole
    }

    /// Where a ray on the microsurface meets it next; `None` if it gets away. `u`: uniform in 0..1.
    #[inline(always)]
    fn free(self, d: DVec3, alpha: f64, u: f64) -> Option<Self> {
        self.free_along(d.z, Slope::new(d, alpha), u)
    }

    /// [`Depth::free`] of a ray with the cosine `z` to the normal.
    #[inline(always)]
    pub(super) fn free_along(self, z: f64, slope: Slope, u: f64) -> Option<Self> {
        if z >= FLAT {
            return match self.lets_go(slope, u) {
                true => None,
                false => self.free_by_power(slope, u),
            };
        }
        if z > -FLAT {
            return Some(self);
        }
        let top = self.whole_share();
        if z < -STEEP {
            return Some(Self::from_share(u * top));
        }
        // Downward -1 / Lambda is an exponent between 0 and 1.
        Some(Self {
            top,
            base: 1.0 - u,
            slope,
            flipped: false,
        })
    }

    /// The share below, which is a plain number where a walk starts.
    #[inline]
    fn whole_share(self) -> f64 {
        if self.base == 1.0 && !self.flipped {
            self.top
        } else {
            self.share()
        }
    }

    /// [`Depth::free`] upward where bounds do not decide.
    #[cold]
    fn free_by_power(self, slope: Slope, u: f64) -> Option<Self> {
        if slope.along > STEEP * STEEP {
            return None;
        }
        let (share, lambda) = (self.share(), slope.lambda());
        if 1.0 - u < share.powf(lambda) {
            return None;
        }
        Some(Self::from_share(
            (share / (1.0 - u).powf(1.0 / lambda)).min(1.0),
        ))
    }
}

/// A ray this steep leaves or meets the surface without regard to its slope, and one this flat stays
/// at its depth; cosines.
pub(super) const STEEP: f64 = 0.9999;
pub(super) const FLAT: f64 = 1e-4;

/// A microfacet normal visible from `w` (which may point below the horizon).
#[inline(always)]
fn visible_normal(w: DVec3, alpha: f64, rng: &mut Rng) -> DVec3 {
    let v = DVec3::new(alpha * w.x, alpha * w.y, w.z).normalize();
    let around = unit_vector_of(rng.bits());
    let z = (1.0 - rng.uniform()) * (1.0 + v.z) - v.z;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let h = DVec3::new(r * around.x, r * around.y, z) + v;
    DVec3::new(alpha * h.x, alpha * h.y, h.z.max(1e-9)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn from_angle(theta: f64) -> DVec3 {
        DVec3::new(theta.sin(), 0.0, -theta.cos())
    }

    fn ratio(eta: f64) -> Ratio {
        Ratio {
            eta,
            inverse: 1.0 / eta,
        }
    }

    #[test]
    fn every_photon_leaves_on_the_side_it_says() {
        let mut rng = Rng::new(1, 0);
        for alpha in [0.05, 0.3, 1.0] {
            for eta in [1.55, 1.0 / 1.55] {
                for i in 0..20_000 {
                    let dir = from_angle(1.57 * f64::from(i) / 20_000.0);
                    let turn = rough(dir, DVec3::Z, ratio(eta), alpha, &mut rng).unwrap();
                    assert_eq!(turn.dir.z < 0.0, turn.transmitted);
                    assert!((turn.dir.length() - 1.0).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn nearly_smooth_is_smooth() {
        let mut rng = Rng::new(2, 0);
        let (reflectance, _) = fresnel::dielectric(0.5f64, 1.55);
        let dir = from_angle(1.047_197_551_196_597_6);
        let n = 200_000;
        let (mut reflected, mut astray) = (0, 0);
        for _ in 0..n {
            let turn = rough(dir, DVec3::Z, ratio(1.55), 0.001, &mut rng).unwrap();
            if !turn.transmitted {
                reflected += 1;
                let mirror = fresnel::reflect(dir, DVec3::Z);
                astray += i32::from((turn.dir - mirror).length() > 0.1);
            }
        }
        // GGX has long tails, but only (alpha / 0.05)^2 of its normals tilt by more than 0.05.
        assert!(astray < reflected / 500, "{astray} of {reflected}");
        let sigma = (reflectance * (1.0 - reflectance) / f64::from(n)).sqrt();
        assert!((f64::from(reflected) / f64::from(n) - reflectance).abs() < 4.0 * sigma);
    }

    /// Detailed balance of the rough boundary: the flux from a beam at angle a into a cone about b
    /// equals the flux from b into a cone about a, times the cosines.
    #[test]
    fn reflection_is_reciprocal() {
        let alpha = 0.5;
        let cone = |from: f64, to: f64, stream: u64| {
            let mut rng = Rng::new(3, stream);
            let target = DVec3::new(-to.sin(), 0.0, to.cos());
            let n = 400_000;
            let hits = (0..n)
                .filter(|_| {
                    let turn = rough(from_angle(-from), DVec3::Z, ratio(1.55), alpha, &mut rng);
                    turn.is_some_and(|t| !t.transmitted && t.dir.dot(target) > 0.97)
                })
                .count();
            hits as f64 / f64::from(n)
        };
        let (a, b) = (0.3f64, 1.0f64);
        let (forward, back) = (cone(a, b, 0), cone(b, a, 1));
        let sigma = (1.0 / (forward * 4e5) + 1.0 / (back * 4e5)).sqrt();
        let ratio = forward * a.cos() / (back * b.cos());
        // The cones have a width, over which the cosine varies: two percent beside the noise.
        assert!((ratio - 1.0).abs() < 4.0 * sigma + 0.02, "{ratio} {sigma}");
    }
}
