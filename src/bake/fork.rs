//! Both ways light can go where it first meets a fiber.
//!
//! The surface reflects 4 to 10 percent, and in dark hair that is nearly all there is to see. By
//! chance one photon in fifteen would show it; with both ways followed every photon does, for the
//! price of one boundary search. (Splitting, Arvo and Kirk 1990; here once, so that the number of
//! branches stays two.)

use super::microfacet::{Ratio, Turn, walk};
use crate::math::fresnel;
use crate::sampling::Rng;
use crate::table::PHOTON;
use glam::DVec3;

/// The two ways at a dielectric boundary and the share of the light that goes each, summing to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fork {
    /// Share that the first facet reflects.
    pub reflectance: f64,
    /// Where light goes that the first facet reflected: nearly always back, but on a rough boundary
    /// it may meet further facets.
    pub reflected: Turn,
    /// Where light goes that passed the first facet.
    pub transmitted: Turn,
}

impl Fork {
    /// The part of a photon that the first facet reflects, in units of 2^-32.
    pub(super) fn part(&self) -> u64 {
        ((self.reflectance * PHOTON as f64) as u64).min(PHOTON)
    }
}

/// Forks at a dielectric boundary. `None` if a walk on a rough one does not end.
///
/// * `dir`: unit direction of travel; `n`: unit normal against it; `roughness`: GGX alpha, 0 smooth.
pub(super) fn fork(
    dir: DVec3,
    n: DVec3,
    ratio: Ratio,
    roughness: f64,
    rng: &mut Rng,
) -> Option<Fork> {
    if roughness <= 0.0 {
        let (reflectance, reflected) = first_facet(dir, n, ratio, true);
        let (_, transmitted) = first_facet(dir, n, ratio, false);
        return Some(Fork {
            reflectance,
            reflected,
            transmitted,
        });
    }
    // Both walks draw the same numbers up to their first facet, so they meet the same one.
    let mut again = rng.clone();
    let (reflectance, reflected) = forced_walk(dir, n, ratio, roughness, true, &mut again)?;
    let (_, transmitted) = forced_walk(dir, n, ratio, roughness, false, rng)?;
    Some(Fork {
        reflectance,
        reflected,
        transmitted,
    })
}

/// A walk of which the first facet reflects or lets through as told; the reflectance of that facet.
fn forced_walk(
    dir: DVec3,
    n: DVec3,
    ratio: Ratio,
    roughness: f64,
    reflect: bool,
    rng: &mut Rng,
) -> Option<(f64, Turn)> {
    let mut reflectance = None;
    let facet = |d: DVec3, m: DVec3, above: bool, rng: &mut Rng| {
        let ratio = ratio.on_side(above);
        if reflectance.is_some() {
            return super::microfacet::smooth(d, m, ratio, rng);
        }
        let (share, turn) = first_facet(d, m, ratio, reflect);
        reflectance = Some(share);
        turn
    };
    let turn = walk(dir, n, roughness, rng, facet)?;
    // Light comes from above, so a facet is met.
    Some((reflectance?, turn))
}

fn first_facet(dir: DVec3, m: DVec3, ratio: Ratio, reflect: bool) -> (f64, Turn) {
    let cos_i = (-dir.dot(m)).clamp(0.0, 1.0);
    let (reflectance, cos_t) = fresnel::dielectric(cos_i, ratio.eta);
    let dir = if reflect || reflectance >= 1.0 {
        fresnel::renormalize(fresnel::reflect(dir, m))
    } else {
        fresnel::refract_by(dir, m, ratio.inverse, cos_t)
    };
    let transmitted = !reflect && reflectance < 1.0;
    (reflectance, Turn { dir, transmitted })
}

#[cfg(test)]
mod tests {
    use super::super::microfacet;
    use super::*;

    /// Means of direction and of the share let through, forked and by chance.
    #[test]
    fn a_fork_is_what_chance_does_in_the_mean() {
        let ratio = Ratio {
            eta: 1.55,
            inverse: 1.0 / 1.55,
        };
        let n = 200_000;
        for (theta, roughness) in [(0.3f64, 0.0), (0.3, 0.4), (1.45, 0.0), (1.45, 0.4)] {
            let dir = DVec3::new(theta.sin(), 0.0, -theta.cos());
            let mut sums = [[0.0; 5]; 2];
            let mut book = |which: usize, share: f64, turn: Turn| {
                let transmitted = f64::from(turn.transmitted);
                let seen = [
                    transmitted,
                    turn.dir.x,
                    turn.dir.y,
                    turn.dir.z,
                    transmitted * turn.dir.x,
                ];
                for (sum, value) in sums[which].iter_mut().zip(seen) {
                    *sum += share * value / f64::from(n);
                }
            };
            for i in 0..n {
                let mut rng = Rng::new(2, i as u64);
                let forked = fork(dir, DVec3::Z, ratio, roughness, &mut rng).unwrap();
                book(0, forked.reflectance, forked.reflected);
                book(0, 1.0 - forked.reflectance, forked.transmitted);
                let mut rng = Rng::new(3, i as u64);
                let turn = if roughness > 0.0 {
                    microfacet::rough(dir, DVec3::Z, ratio, roughness, &mut rng).unwrap()
                } else {
                    microfacet::smooth(dir, DVec3::Z, ratio, &mut rng)
                };
                book(1, 1.0, turn);
            }
            for (a, b) in sums[0].iter().zip(sums[1]) {
                // Standard deviations are below 1 and half that.
                assert!((a - b).abs() < 0.006, "{theta} {roughness}: {sums:?}");
            }
        }
    }
}
