//! Photons through a bare circular cylinder, in closed form.
//!
//! Inside a smooth circular cylinder all chords of a path are alike: equally long, met at equal angles, each
//! turned by the same azimuth against the one before (Marschner et al. 2003). So a photon is two
//! refractions and a count of chords, which falls off geometrically, and it leaves along the cone that it
//! came from. The same light in the mean as that of photons followed from boundary to boundary, and
//! as much of it in every part; what is drawn is the count.

use super::Settings;
use super::deposit::whole;
use crate::fiber::Fiber;
use crate::sampling::hash64;
use crate::table::PHOTON;
use glam::DVec2;

/// A bare circular cylinder of clear or evenly pigmented keratin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cylinder {
    /// Refractive index over that of the medium around it.
    eta: f64,
    inverse2: f64,
    fork: bool,
    /// Chords after which a photon is given up: each ends in an event, and so does the way to the cylinder.
    most_chords: u32,
}

/// All ways that a photon may take.
#[derive(Clone, Copy, Debug)]
struct Paths {
    /// Share that is reflected where the photon comes in, and at every end of a chord.
    reflectance: f64,
    /// Length of a chord in radii.
    chord: f64,
    /// Cosine and sine of the azimuth, from the query direction, of what never goes in.
    reflected: DVec2,
    /// By what azimuth a chord turns that.
    step: DVec2,
}

/// Where a photon goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ways {
    /// How much the surface reflects, in units of 2^-32 photon; the rest goes in.
    pub(super) part: u64,
    /// Cosine and sine of the azimuth, from the query direction, of what is reflected.
    pub(super) reflected: DVec2,
    /// Length of the other way through the cylinder in radii.
    pub(super) path: f64,
    /// Where it leaves; `None` if it was given up inside.
    pub(super) transmitted: Option<DVec2>,
}

impl Cylinder {
    /// The fiber if it is such a cylinder.
    pub(super) fn of(fiber: &Fiber, settings: &Settings) -> Option<Self> {
        let eta = fiber.bare_cylinder()?;
        Some(Self {
            eta,
            inverse2: 1.0 / (eta * eta),
            fork: settings.fork,
            most_chords: settings.max_events.saturating_sub(1),
        })
    }

    /// * `sin`: sine of the inclination of the query direction. * `h`: offset of the photon from the
    ///   axis in radii, -1 to 1.
    #[inline]
    fn paths(&self, sin: f64, h: f64) -> Paths {
        let Self { eta, inverse2, .. } = *self;
        let (sin2, h2) = (sin * sin, h * h);
        let cos2 = (1.0 - sin2).max(0.0);
        let (cos, cos_h) = (cos2.sqrt(), (1.0 - h2).max(0.0).sqrt());
        // Fresnel's equations without an angle of total reflection: the cylinder is the denser medium.
        let cos_i = cos * cos_h;
        let cos_t = (1.0 - (1.0 - cos_i * cos_i) * inverse2).sqrt();
        let (p, s) = (eta * cos_i + cos_t, cos_i + eta * cos_t);
        let (parallel, perpendicular) = ((eta * cos_i - cos_t) * s, (cos_i - eta * cos_t) * p);
        let all = p * s;
        // Over the square of the cosine of the inclination inside, times the square of eta.
        let inside2 = 1.0 / (eta * eta - sin2);
        Paths {
            reflectance: 0.5 * (parallel * parallel + perpendicular * perpendicular) / (all * all),
            chord: 2.0 * cos_t * eta * eta * inside2,
            // Twice the angle of incidence in the section, and pi less twice that of refraction.
            reflected: DVec2::new(1.0 - 2.0 * h2, 2.0 * h * cos_h),
            step: DVec2::new(
                2.0 * h2 * cos2 * inside2 - 1.0,
                2.0 * h * cos * cos_t * eta * inside2,
            ),
        }
    }

    /// Where a photon goes.
    ///
    /// * `sin`, `h`: as for [`Cylinder::paths`]. * `random`: 64 uniform bits.
    #[inline]
    pub(super) fn ways(&self, sin: f64, h: f64, random: u64) -> Ways {
        let Paths {
            reflectance,
            chord,
            reflected,
            step,
        } = self.paths(sin, h);
        let mut u = (random >> 11) as i64 as f64 * (1.0 / (1u64 << 53) as f64);
        let mut part = whole(reflectance * PHOTON as f64);
        if !self.fork {
            // By chance; what is left of the random number serves for what goes in.
            part = if u < reflectance { PHOTON } else { 0 };
            u = (u - reflectance) / (1.0 - reflectance);
        }
        let (mut azimuth, mut chords, mut left) = (step.rotate(reflected), 1, reflectance);
        while u < left && chords <= self.most_chords {
            azimuth = step.rotate(azimuth);
            chords += 1;
            left *= reflectance;
        }
        Ways {
            part,
            reflected,
            path: f64::from(chords.min(self.most_chords)) * chord,
            transmitted: (chords <= self.most_chords).then_some(azimuth),
        }
    }
}

/// The random numbers of a node's photons.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chance {
    key: u64,
}

impl Chance {
    /// 2^64 over the golden ratio.
    const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

    pub(super) fn new(seed: u64, node: u64) -> Self {
        // Not 0 for the first photon of seed 0, which the hash would leave at 0.
        let seed = hash64(seed.wrapping_add(Self::STEP));
        Self {
            key: hash64(seed.wrapping_add(node)),
        }
    }

    /// 64 uniform bits for a photon (SplitMix64, Steele et al. 2014).
    #[inline]
    pub(super) fn at(self, index: u64) -> u64 {
        hash64(self.key.wrapping_add(index.wrapping_mul(Self::STEP)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::entry::{NODE_BITS, Stratified};
    use crate::bake::{End, Photon, Sides, fly_forked};
    use crate::species::Structure;
    use glam::DVec3;

    fn glass(max_events: u32) -> (Fiber, Cylinder) {
        let species = crate::species::load("glass-cylinder", &[]).unwrap();
        let structure: &Structure = &species.classes[0].stations[0].structure;
        let fiber = Fiber::build(structure, 0).unwrap();
        let settings = Settings {
            max_events,
            ..Settings::cone()
        };
        let cylinder = Cylinder::of(&fiber, &settings).unwrap();
        (fiber, cylinder)
    }

    /// Photon by photon, along whatever path chance leads the followed one.
    #[test]
    fn closed_form_and_followed_photons_go_the_same_ways() {
        let (fiber, cylinder) = glass(1000);
        let (seed, node, sin_range) = (4, 2, (-0.98, 0.6));
        let radius = 0.5 * fiber.structure().diameter_um;
        let mut chords_seen = [0; 4];
        for index in 0..3000 {
            let (along, across) = Stratified::new(seed, node).at(index);
            let sin = sin_range.0 + (sin_range.1 - sin_range.0) * along;
            let paths = cylinder.paths(sin, 2.0 * across - 1.0);
            let photon = Photon {
                seed,
                stream: node << NODE_BITS | index,
                sin_range,
                sides: Sides::ALL,
            };
            fly_forked(&fiber, &photon, 1000, |part, flight| {
                let chords = flight.events - 1;
                let is_reflected = chords == 0;
                chords_seen[chords.min(3) as usize] += 1;
                let share = part as f64 / PHOTON as f64;
                let expected = match is_reflected {
                    true => paths.reflectance,
                    false => 1.0 - paths.reflectance,
                };
                assert!(
                    (share - expected).abs() < 1e-8,
                    "{index}: {share} {expected}"
                );
                let path = f64::from(chords) * paths.chord;
                assert!((flight.path_um / radius - path).abs() < 1e-6 * (1.0 + path));
                let azimuth =
                    (0..chords).fold(paths.reflected, |azimuth, _| paths.step.rotate(azimuth));
                let cos = (1.0 - sin * sin).sqrt();
                let w = DVec3::new(cos * azimuth.x, cos * azimuth.y, -sin);
                let End::Escaped(found) = flight.end else {
                    panic!("{index}: {:?}", flight.end);
                };
                assert!((found - w).length() < 1e-6, "{index}: {found} {w}");
            });
        }
        assert!(chords_seen.iter().all(|n| *n > 20), "{chords_seen:?}");
    }

    #[test]
    fn chords_fall_off_geometrically_up_to_the_cap() {
        let (_, cylinder) = glass(3);
        let (sin, h) = (0.2, 0.97);
        let paths = cylinder.paths(sin, h);
        let (n, chance) = (200_000, Chance::new(1, 1));
        let mut counts = [0u32; 3];
        for i in 0..n {
            let ways = cylinder.ways(sin, h, chance.at(i));
            assert_eq!(ways.part, whole(paths.reflectance * PHOTON as f64));
            let chords = (ways.path / paths.chord).round() as usize;
            assert!(chords == 1 || chords == 2);
            counts[if ways.transmitted.is_some() {
                chords - 1
            } else {
                2
            }] += 1;
        }
        let r = paths.reflectance;
        for (count, share) in counts.iter().zip([1.0 - r, r * (1.0 - r), r * r]) {
            let sigma = (share * (1.0 - share) / n as f64).sqrt();
            let found = f64::from(*count) / n as f64;
            assert!((found - share).abs() < 4.0 * sigma, "{found} {share}");
        }
    }

    #[test]
    fn chance_has_no_special_photons() {
        for node in 0..16 {
            let first = Chance::new(0, node).at(0);
            assert!((16..48).contains(&first.count_ones()), "{node}: {first:x}");
        }
    }

    #[test]
    fn other_fibers_are_followed() {
        let of = |set: &str| {
            let species = crate::species::load("glass-cylinder", &[set.to_owned()]).unwrap();
            let structure = &species.classes[0].stations[0].structure;
            Fiber::build(structure, 0).unwrap().bare_cylinder()
        };
        assert_eq!(of("structure.ior=1.6"), Some(1.6));
        assert_eq!(of("structure.aspect=1.2"), None);
        assert_eq!(of("structure.cuticle.roughness=0.1"), None);
        assert_eq!(of("structure.cortex.streaks=0.3"), None);
    }
}
