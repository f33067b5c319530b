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
