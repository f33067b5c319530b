//! How noisy a table is: relative L2 error of S, estimated from its own sums.

use super::reconstruct::Reconstruction;
use super::tally::Tally;
use crate::math::unicube::Unicube;
use crate::table::Nodes;
use rayon::prelude::*;

/// Inclinations beyond this are left out of the estimate, of queries and of exits: toward the axis S
/// divides by a vanishing cosine, and a handful of photons there would outweigh all others.
const LIMIT_DEG: f64 = 73.0;

/// The weights of an L2 norm of S on one unicube.
pub(super) struct Norm {
    /// Per texel: what `S^2` integrates to for a flux fraction of 1, 0 beyond the limit.
    weights: Vec<f64>,
    /// Whether maps are averaged with their mirror images.
    folded: bool,
}

/// Squared noise and squared signal of S, in common units; sums over nodes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Noise {
    /// Squared error.
    pub(super) noise: f64,
    /// Signal and noise together, as the sums show it.
    pub(super) power: f64,
}

impl Norm {
    pub(super) fn new(cube: &Unicube, folded: bool) -> Self {
        let least_cos2 = LIMIT_DEG.to_radians().cos().powi(2);
        let weights = (0..cube.texels())
            .map(|texel| {
                let sin = cube.direction(texel, 0.5, 0.5).0.z;
                let cos2 = 1.0 - sin * sin;
                // S = F / (Omega cos), and a texel integrates its square over Omega.
                match cos2 >= least_cos2 {
                    true => 1.0 / (cube.solid_angle(texel) * cos2),
                    false => 0.0,
                }
            })
            .collect();
        Self { weights, folded }
    }

    /// What the square of a flux fraction of a texel adds to the squared norm of S.
    pub(super) fn weight(&self, texel: usize) -> f64 {
        self.weights[texel]
    }

    /// Noise of the nodes of one channel at the clear level.
    ///
    /// * `filter`: what takes noise off the maps, if anything does.
    pub(super) fn of_nodes(
        &self,
        cube: &Unicube,
        nodes: &Nodes,
        tallies: &[Tally],
        filter: Option<&Reconstruction>,
    ) -> Vec<Noise> {
        let limit = LIMIT_DEG.to_radians();
        let last = nodes.azimuths.count - 1;
        let counts: Vec<bool> = (0..nodes.len())
            .map(|node| {
                // Of several azimuths the first and the last: edge and flat side differ most.
                let bin = nodes.azimuth_bin(node);
                nodes.theta(node).abs() <= limit && (bin == 0 || bin == last)
            })
            .collect();
        let mut noise = match filter {
            _ if tallies.iter().any(Tally::is_empty) => vec![Noise::default(); nodes.len()],
            Some(filter) => filter.noise(tallies, self, &counts),
            None => {
                let tallies = tallies.par_iter();
                tallies.map(|tally| self.of_sums(cube, tally)).collect()
            }
        };
        for (noise, counts) in noise.iter_mut().zip(counts) {
            if !counts {
                *noise = Noise::default();
            }
        }
        noise
    }

    /// Noise of the plain means of one node.
    fn of_sums(&self, cube: &Unicube, tally: &Tally) -> Noise {
        let mut sum = Noise::default();
        for (texel, &weight) in self.weights.iter().enumerate() {
            if weight == 0.0 {
                continue;
            }
            let (flux, variance) = tally.at_clear(texel);
            if self.folded {
                let mirror = cube.mirrored(texel);
                if texel > mirror {
                    continue;
                }
                let (other, also) = tally.at_clear(mirror);
                let mean = 0.5 * (flux + other);
                sum.noise += 2.0 * weight * 0.25 * (variance + also);
                sum.power += 2.0 * weight * mean * mean;
            } else {
                sum.noise += weight * variance;
                sum.power += weight * flux * flux;
            }
        }
        let photons = tally.photons() as f64;
        Noise {
            noise: sum.noise / (photons * photons),
            power: sum.power / (photons * photons),
        }
    }
}

impl Noise {
    /// Relative error of the worst channel.
    pub(super) fn of_channels(parts: &[Self], nodes: usize) -> f64 {
        let errors = parts.chunks(nodes).map(|channel| {
            let noise = channel.iter().map(|part| part.noise).sum();
            let power = channel.iter().map(|part| part.power).sum();
            Self { noise, power }.relative()
        });
        errors.fold(0.0, f64::max)
    }

    /// Relative L2 error. What is seen is signal plus noise, so the noise is taken off what it is
    /// related to; infinite while nothing stands out of it.
    fn relative(self) -> f64 {
        let signal = self.power - self.noise;
        match signal > 0.0 {
            true => (self.noise / signal).sqrt(),
            false => f64::INFINITY,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::{Bake, Goal, Settings};
    use crate::fiber::Fiber;
    use crate::progress::{Cancel, Silent};
    use crate::table::{StructureTable, Undyed};

    /// The error of two bakes with nothing in common is half of what lies between them.
    #[test]
    fn the_estimate_is_the_error() {
        let species = crate::species::load("human", &[]).unwrap();
        let structure = &species.classes[0].stations[0].structure;
        let fiber = Fiber::build(structure, 0).unwrap();
        for fold in [false, true] {
            let bake = |photon_seed| {
                let settings = Settings {
                    photons: 100_000,
                    photon_seed,
                    fold,
                    reconstruct: false,
                    ..Settings::cone()
                };
                let bake = Bake::of_fiber(&fiber, &settings).unwrap();
                bake.run(&Goal::default(), &Silent, &Cancel::default());
                match bake.snapshot().unwrap() {
                    Undyed::Gray(table) => (bake.error(), table),
                    Undyed::Colored(_) => unreachable!("one fiber"),
                }
            };
            let ((estimate, a), (_, b)) = (bake(1), bake(2));
            let (apart, power) = distance(&a, &b);
            let real = (0.5 * apart / (power - 0.5 * apart)).sqrt();
            assert!(
                (estimate / real - 1.0).abs() < 0.05,
                "fold {fold}: estimated {estimate}, is {real}"
            );
        }
    }

    /// Squared distance of two tables and their mean squared norm, written out once more.
    fn distance(a: &StructureTable, b: &StructureTable) -> (f64, f64) {
        let cube = Unicube::new(a.res);
        let limit = LIMIT_DEG.to_radians();
        let (mut apart, mut power) = (0.0, 0.0);
        for node in (0..a.nodes.len()).filter(|n| a.nodes.centers[*n].abs() < limit) {
            for (texel, (x, y)) in a.map(node, 0).iter().zip(b.map(node, 0)).enumerate() {
                let (w, _) = cube.direction(texel, 0.5, 0.5);
                let theta = w.z.asin();
                if theta.abs() < limit {
                    let omega = cube.solid_angle(texel);
                    let s = |flux: &f32| f64::from(*flux) / omega / theta.cos();
                    apart += omega * (s(x) - s(y)).powi(2);
                    power += 0.5 * omega * (s(x).powi(2) + s(y).powi(2));
                }
            }
        }
        (apart, power)
    }
}
