//! Boundaries other than dielectrics: thin layers, Lambert reflectors, conductors.

use super::microfacet::{Ratio, Turn, smooth, walk};
use crate::fiber::Optics;
use crate::math::fresnel;
use crate::sampling::Rng;
use glam::DVec3;
use std::f64::consts::TAU;

/// Where light goes at a boundary and which share of it. `None` if a walk on a rough one does not
/// end.
///
/// * `dir`: unit direction of travel; `n`: unit normal against it.
/// * `ratio`, `near`: the indices of both sides, and that of the side the light comes from.
pub(super) fn meet(
    optics: &Optics,
    dir: DVec3,
    n: DVec3,
    ratio: Ratio,
    near: f64,
    rng: &mut Rng,
) -> Option<(Turn, f64)> {
    match *optics {
        Optics::Dielectric { roughness } => {
            let facet = |dir, m, above, rng: &mut Rng| smooth(dir, m, ratio.on_side(above), rng);
            on_facets(dir, n, roughness, rng, facet).map(|turn| (turn, 1.0))
        }
        Optics::Slab {
            layers,
            ior,
            roughness,
        } => {
            // Without a step of the index between both sides the layers are what reflects.
            let film = if ratio.eta == 1.0 {
                Some(ior / near)
            } else {
                None
            };
            let facet = |dir, m, above, rng: &mut Rng| {
                slab(dir, m, ratio.on_side(above), film, layers, rng)
            };
            on_facets(dir, n, roughness, rng, facet).map(|turn| (turn, 1.0))
        }
        Optics::Diffuse { albedo } => {
            let (u, v) = (rng.uniform(), TAU * rng.uniform());
            let (a, b) = n.any_orthonormal_pair();
            let (r, up) = (u.sqrt(), (1.0 - u).sqrt());
            let dir = fresnel::renormalize(r * v.cos() * a + r * v.sin() * b + up * n);
            Some((reflected(dir), albedo))
        }
        Optics::Metal {
            ior,
            extinction,
            roughness,
        } => {
            let (ior, extinction) = (ior / near, extinction / near);
            let mut share = 1.0;
            let facet = |dir: DVec3, m: DVec3, _, _: &mut Rng| {
                let cos_i = (-dir.dot(m)).clamp(0.0, 1.0);
                share *= fresnel::conductor(cos_i, ior, extinction);
                reflected(fresnel::renormalize(fresnel::reflect(dir, m)))
            };
            on_facets(dir, n, roughness, rng, facet).map(|turn| (turn, share))
        }
    }
}

/// One facet if smooth, else a walk over many.
fn on_facets(
    dir: DVec3,
    n: DVec3,
    roughness: f64,
    rng: &mut Rng,
    mut facet: impl FnMut(DVec3, DVec3, bool, &mut Rng) -> Turn,
) -> Option<Turn> {
    if roughness > 0.0 {
        walk(dir, n, roughness, rng, facet)
    } else {
        Some(facet(dir, n, true, rng))
    }
}

/// * `film`: index of the layers over that of both sides, where those are the same.
fn slab(dir: DVec3, n: DVec3, ratio: Ratio, film: Option<f64>, layers: f64, rng: &mut Rng) -> Turn {
    let cos_i = (-dir.dot(n)).clamp(0.0, 1.0);
    let (reflectance, cos_t) = fresnel::layered(cos_i, film.unwrap_or(ratio.eta), layers);
    if rng.uniform() < reflectance {
        return reflected(fresnel::renormalize(fresnel::reflect(dir, n)));
    }
    Turn {
        dir: match film {
            Some(_) => dir,
            None => fresnel::refract_by(dir, n, ratio.inverse, cos_t),
        },
        transmitted: true,
    }
}

fn reflected(dir: DVec3) -> Turn {
    Turn {
        dir,
        transmitted: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAME: Ratio = Ratio {
        eta: 1.0,
        inverse: 1.0,
    };

    fn from_angle(theta: f64) -> DVec3 {
        DVec3::new(theta.sin(), 0.0, -theta.cos())
    }

    #[test]
    fn a_perfect_mirror_of_any_roughness_passes_the_white_furnace() {
        let mut rng = Rng::new(1, 0);
        for roughness in [0.05, 0.3, 1.0] {
            let mirror = Optics::Metal {
                ior: 1.0,
                extinction: 1e7,
                roughness,
            };
            for theta in [0.0, 0.7, 1.3, 1.55] {
                let n = 20_000;
                let mut sum = 0.0;
                for _ in 0..n {
                    let dir = from_angle(theta);
                    let (turn, share) = meet(&mirror, dir, DVec3::Z, SAME, 1.0, &mut rng).unwrap();
                    assert!(!turn.transmitted && turn.dir.z > 0.0);
                    sum += share;
                }
                let kept = sum / f64::from(n);
                assert!((kept - 1.0).abs() < 1e-4, "{roughness} {theta}: {kept}");
            }
        }
    }

    /// Detailed balance of what a rough conductor reflects, losses of every bounce included.
    #[test]
    fn a_rough_conductor_is_reciprocal() {
        let copper = Optics::Metal {
            ior: 1.2,
            extinction: 2.5,
            roughness: 0.6,
        };
        let n = 400_000;
        let cone = |from: f64, to: f64, stream: u64| {
            let mut rng = Rng::new(3, stream);
            let target = DVec3::new(-to.sin(), 0.0, to.cos());
            let mut sum = 0.0;
            for _ in 0..n {
                let met = meet(&copper, from_angle(-from), DVec3::Z, SAME, 1.0, &mut rng);
                let (turn, share) = met.unwrap();
                if turn.dir.dot(target) > 0.97 {
                    sum += share;
                }
            }
            sum / f64::from(n)
        };
        let (a, b) = (0.3f64, 1.0f64);
        let (forward, back) = (cone(a, b, 0), cone(b, a, 1));
        let sigma = (1.0 / (forward * 4e5) + 1.0 / (back * 4e5)).sqrt();
        let ratio = forward * a.cos() / (back * b.cos());
        // The cones have a width, over which the cosine varies: two percent beside the noise.
        assert!((ratio - 1.0).abs() < 4.0 * sigma + 0.02, "{ratio} {sigma}");
    }

    #[test]
    fn every_facet_of_a_conductor_takes_its_share() {
        let (n, k, roughness) = (1.2, 2.5, 0.8);
        let copper = Optics::Metal {
            ior: n,
            extinction: k,
            roughness,
        };
        let mut several = 0;
        for stream in 0..5000 {
            let dir = from_angle(1.2);
            let (mut product, mut facets) = (1.0, 0);
            let facet = |d: DVec3, m: DVec3, _, _: &mut Rng| {
                product *= fresnel::conductor(-d.dot(m), n, k);
                facets += 1;
                reflected(fresnel::renormalize(fresnel::reflect(d, m)))
            };
            walk(dir, DVec3::Z, roughness, &mut Rng::new(8, stream), facet).unwrap();
            let mut rng = Rng::new(8, stream);
            let (_, share) = meet(&copper, dir, DVec3::Z, SAME, 1.0, &mut rng).unwrap();
            assert!((share - product).abs() < 1e-12, "{share} {product}");
            several += i32::from(facets > 1);
        }
        assert!(several > 500, "{several} walks met more than one facet");
    }

    #[test]
    fn layers_reflect_by_their_formula_and_pass_straight() {
        let slab = Optics::Slab {
            layers: 1.0,
            ior: 1.55,
            roughness: 0.0,
        };
        let mut rng = Rng::new(4, 0);
        for theta in [0.0f64, 0.9, 1.4] {
            let r = |s: bool| {
                let (c, sin_t) = (theta.cos(), theta.sin() / 1.55);
                let t = (1.0 - sin_t * sin_t).sqrt();
                let amplitude = if s {
                    (c - 1.55 * t) / (c + 1.55 * t)
                } else {
                    (1.55 * c - t) / (1.55 * c + t)
                };
                let r = amplitude * amplitude;
                r + (1.0 - r).powi(2) * r / (1.0 - r * r)
            };
            let expected = 0.5 * (r(true) + r(false));
            let n = 100_000;
            let mut reflected = 0;
            for _ in 0..n {
                let dir = from_angle(theta);
                let (turn, share) = meet(&slab, dir, DVec3::Z, SAME, 1.0, &mut rng).unwrap();
                assert_eq!(share, 1.0);
                if turn.transmitted {
                    assert_eq!(turn.dir, dir);
                } else {
                    reflected += 1;
                }
            }
            let sigma = (expected * (1.0 - expected) / f64::from(n)).sqrt();
            let found = f64::from(reflected) / f64::from(n);
            assert!((found - expected).abs() < 4.0 * sigma, "{theta}: {found}");
        }
    }
}
