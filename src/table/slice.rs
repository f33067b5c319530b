//! One azimuth of a table that has several, and their mean: tables without azimuths.

use super::{Azimuths, Ledger, Nodes, ScatterMaps, StructureTable, TableError, TableFile};
use crate::math::symmetry::Symmetry;
use crate::math::unicube::Unicube;
use std::ops::Range;

impl Nodes {
    /// The nodes of one bin of azimuth.
    pub(super) fn of_azimuth(&self, bin: usize) -> Range<usize> {
        let count = self.inclinations();
        bin * count..(bin + 1) * count
    }

    fn averaged(&self) -> Self {
        self.clone().at_azimuths(Azimuths::AVERAGED)
    }

    /// Refuses several azimuths where one map an inclination is expected.
    pub(super) fn only_averaged(&self) -> Result<(), TableError> {
        match self.azimuths.count {
            1 => Ok(()),
            count => Err(TableError::Request(format!(
                "the table tells {count} azimuths apart; here one of them is needed, their mean, or a bake \
                 without --azimuths"
            ))),
        }
    }
}

impl StructureTable {
    /// The table of one bin of azimuth. Of a table that averages over azimuths that is the table.
    ///
    /// * `bin`: below `nodes.azimuths.count`.
    pub fn at_azimuth(&self, bin: usize) -> Self {
        let nodes = self.nodes.of_azimuth(bin);
        let (levels, texels) = (self.levels.len(), self.texels());
        Self {
            nodes: self.nodes.averaged(),
            levels: self.levels.clone(),
            flux: of_nodes(&self.flux, &nodes, levels * texels),
            error: of_nodes(&self.error, &nodes, texels),
            ledger: of_nodes(&self.ledger, &nodes, levels),
            provenance: self.provenance.clone(),
            ..*self
        }
    }

    /// The mean over all azimuths: what a bake without azimuths estimates, from the same photons.
    ///
    /// # Errors
    /// More photons than the sum of all ledgers can count, 4.29e9 for an inclination.
    pub fn averaged(&self) -> Result<Self, TableError> {
        let levels = self.levels.len();
        let mean = Mean::new(&self.nodes, self.res, |node| self.ledger(node, 0).emitted);
        let maps = (0..levels)
            .map(|level| mean.maps(|node, texel| [self.map(node, level)[texel]]))
            .collect::<Vec<_>>();
        let texels = self.texels();
        let errors = mean.errors(|node, texel| {
            let error = self.error[node * texels + texel];
            ([self.map(node, 0)[texel]], [error])
        });
        let flux = (0..self.nodes.inclinations())
            .flat_map(|bin| {
                maps.iter()
                    .map(move |map| &map[bin * texels..(bin + 1) * texels])
            })
            .flatten()
            .map(|[flux]| *flux);
        Ok(Self {
            nodes: self.nodes.averaged(),
            levels: self.levels.clone(),
            flux: flux.collect(),
            error: errors.into_flattened(),
            ledger: sum_ledgers(&self.ledger, &self.nodes, levels)?,
            provenance: self.provenance.clone(),
            ..*self
        })
    }
}

impl ScatterMaps {
    /// The maps of one bin of azimuth. Of maps that average over azimuths those are the maps.
    ///
    /// * `bin`: below `nodes.azimuths.count`.
    pub fn at_azimuth(&self, bin: usize) -> Self {
        let nodes = self.nodes.of_azimuth(bin);
        let texels = self.texels();
        Self {
            nodes: self.nodes.averaged(),
            rgb: of_nodes(&self.rgb, &nodes, texels),
            error: of_nodes(&self.error, &nodes, texels),
            ledger: of_nodes(&self.ledger, &nodes, self.bakes()),
            provenance: self.provenance.clone(),
            ..*self
        }
    }

    /// The mean over all azimuths.
    ///
    /// # Errors
    /// As for [`StructureTable::averaged`].
    pub fn averaged(&self) -> Result<Self, TableError> {
        let bakes = self.bakes();
        let mean = Mean::new(&self.nodes, self.res, |node| {
            self.ledger[node * bakes].emitted
        });
        Ok(Self {
            nodes: self.nodes.averaged(),
            rgb: mean.maps(|node, texel| self.map(node)[texel]),
            error: mean.errors(|node, texel| {
                let error = self.error[node * self.texels() + texel];
                (self.map(node)[texel], error)
            }),
            ledger: sum_ledgers(&self.ledger, &self.nodes, bakes)?,
            provenance: self.provenance.clone(),
            ..*self
        })
    }
}

fn of_nodes<T: Clone>(all: &[T], nodes: &Range<usize>, each: usize) -> Vec<T> {
    all[nodes.start * each..nodes.end * each].to_vec()
}

impl TableFile {
    /// The azimuths that the table tells apart.
    pub fn azimuths(&self) -> Azimuths {
        match self {
            Self::Structure(table) => table.nodes.azimuths,
            Self::Scatter(maps) => maps.nodes.azimuths,
        }
    }

    /// [`StructureTable::at_azimuth`] or [`ScatterMaps::at_azimuth`].
    #[must_use]
    pub fn at_azimuth(&self, bin: usize) -> Self {
        match self {
            Self::Structure(table) => Self::Structure(table.at_azimuth(bin)),
            Self::Scatter(maps) => Self::Scatter(maps.at_azimuth(bin)),
        }
    }

    /// The mean over all azimuths.
    ///
    /// # Errors
    /// As for [`StructureTable::averaged`].
    pub fn averaged(self) -> Result<Self, TableError> {
        if self.azimuths().is_averaged() {
            return Ok(self);
        }
        Ok(match &self {
            Self::Structure(table) => Self::Structure(table.averaged()?),
            Self::Scatter(maps) => Self::Scatter(maps.averaged()?),
        })
    }
}

/// Averages maps over azimuths, weighted by their photons.
struct Mean<'a> {
    nodes: &'a Nodes,
    cube: Unicube,
    /// Per node; those of one inclination sum to 1.
    weights: Vec<f64>,
}

impl<'a> Mean<'a> {
    fn new(nodes: &'a Nodes, res: usize, emitted: impl Fn(usize) -> u64) -> Self {
        let same =
            |node: usize| (node % nodes.inclinations()..nodes.len()).step_by(nodes.inclinations());
        let weights = (0..nodes.len()).map(|node| {
            let all: f64 = same(node).map(|n| emitted(n) as f64).sum();
            match all > 0.0 {
                true => emitted(node) as f64 / all,
                false => 1.0 / nodes.azimuths.count as f64,
            }
        });
        Self {
            weights: weights.collect(),
            cube: Unicube::new(res),
            nodes,
        }
    }

    /// The texels whose mean a texel becomes: its mirror image too if maps stand for mirrored ones.
    fn pair(&self, texel: usize) -> [usize; 2] {
        match self.nodes.azimuths.symmetry {
            Symmetry::None => [texel, texel],
            _ => [texel, self.cube.mirrored(texel)],
        }
    }

    /// Inclination by inclination, texel by texel.
    fn each<T>(&self, mut of: impl FnMut(usize, [usize; 2]) -> T) -> Vec<T> {
        let texels = self.cube.texels();
        let places =
            (0..self.nodes.inclinations()).flat_map(|bin| (0..texels).map(move |t| (bin, t)));
        places
            .map(|(bin, texel)| of(bin, self.pair(texel)))
            .collect()
    }

    fn of_bin(&self, bin: usize) -> impl Iterator<Item = (usize, f64)> {
        let nodes = (bin..self.nodes.len()).step_by(self.nodes.inclinations());
        nodes.map(|node| (node, self.weights[node]))
    }

    fn maps<const N: usize>(&self, flux: impl Fn(usize, usize) -> [f32; N]) -> Vec<[f32; N]> {
        self.each(|bin, pair| {
            let mut sum = [0.0; N];
            for (node, weight) in self.of_bin(bin) {
                for texel in pair {
                    for (sum, f) in sum.iter_mut().zip(flux(node, texel)) {
                        *sum += 0.5 * weight * f64::from(f);
                    }
                }
            }
            sum.map(|v| v as f32)
        })
    }

    /// Relative errors of the mean, channel by channel.
    ///
    /// * `part`: flux and relative error of a node's texel.
    fn errors<const N: usize>(
        &self,
        part: impl Fn(usize, usize) -> ([f32; N], [f32; N]),
    ) -> Vec<[f32; N]> {
        self.each(|bin, pair| {
            let (mut mean, mut variance) = ([0.0; N], [0.0; N]);
            // A texel and itself are not independent, a texel and its mirror image are.
            let (count, share) = if pair[0] == pair[1] {
                (1, 1.0)
            } else {
                (2, 0.5)
            };
            for (node, weight) in self.of_bin(bin) {
                for &texel in &pair[..count] {
                    let (flux, error) = part(node, texel);
                    for c in 0..N {
                        let part = share * weight * f64::from(flux[c]);
                        mean[c] += part;
                        if error[c].is_finite() {
                            variance[c] += (f64::from(error[c]) * part).powi(2);
                        }
                    }
                }
            }
            std::array::from_fn(|c| match mean[c] > 0.0 {
                true => (variance[c].sqrt() / mean[c]) as f32,
                false => f32::INFINITY,
            })
        })
    }
}

/// Sums over azimuths.
///
/// * `each`: ledgers a node.
fn sum_ledgers(all: &[Ledger], nodes: &Nodes, each: usize) -> Result<Vec<Ledger>, TableError> {
    let stride = nodes.inclinations() * each;
    (0..stride)
        .map(|i| {
            let parts = || all[i..].iter().step_by(stride);
            let sum = |of: fn(&Ledger) -> u64| {
                let sum = parts().map(of).try_fold(0u64, u64::checked_add);
                sum.ok_or_else(|| {
                    TableError::Request(
                        "the table has too many photons for a ledger of all its azimuths"
                            .to_owned(),
                    )
                })
            };
            Ok(Ledger {
                emitted: sum(|l| l.emitted)?,
                escaped: sum(|l| l.escaped)?,
                absorbed: sum(|l| l.absorbed)?,
                truncated: sum(|l| l.truncated)?,
                lost: sum(|l| l.lost)?,
            })
        })
        .collect()
}
