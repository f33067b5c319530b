//! A table of either kind as channels of flux with their variance.

use crate::math::unicube::Unicube;
use crate::table::{Ledger, Nodes, ScatterMaps, StructureTable, TableFile};

/// A table to compare, of either kind.
#[derive(Clone, Copy, Debug)]
pub enum TableRef<'a> {
    /// Absorption levels.
    Structure(&'a StructureTable),
    /// R, G and B.
    Scatter(&'a ScatterMaps),
}

impl<'a> From<&'a StructureTable> for TableRef<'a> {
    fn from(table: &'a StructureTable) -> Self {
        Self::Structure(table)
    }
}

impl<'a> From<&'a ScatterMaps> for TableRef<'a> {
    fn from(maps: &'a ScatterMaps) -> Self {
        Self::Scatter(maps)
    }
}

impl<'a> From<&'a TableFile> for TableRef<'a> {
    fn from(file: &'a TableFile) -> Self {
        match file {
            TableFile::Structure(table) => Self::Structure(table),
            TableFile::Scatter(maps) => Self::Scatter(maps),
        }
    }
}

impl TableRef<'_> {
    pub(in crate::table) fn nodes(&self) -> &Nodes {
        match self {
            Self::Structure(table) => &table.nodes,
            Self::Scatter(maps) => &maps.nodes,
        }
    }

    pub(in crate::table) fn res(&self) -> usize {
        match self {
            Self::Structure(table) => table.res,
            Self::Scatter(maps) => maps.res,
        }
    }

    /// How many channels there are.
    pub(in crate::table) fn channels(&self) -> usize {
        match self {
            Self::Structure(table) => table.levels.len(),
            Self::Scatter(_) => 3,
        }
    }

    /// The maps of one channel, node after node; `None` if there is no such channel.
    pub(in crate::table) fn channel(&self, channel: usize) -> Option<Vec<f32>> {
        if channel >= self.channels() {
            return None;
        }
        Some(match self {
            Self::Structure(table) => (0..table.nodes.len())
                .flat_map(|node| table.map(node, channel).iter().copied())
                .collect(),
            Self::Scatter(maps) => maps.rgb.iter().map(|texel| texel[channel]).collect(),
        })
    }

    /// Photons over all nodes.
    pub fn photons(&self) -> f64 {
        match self {
            Self::Structure(table) => {
                let ledgers = table.ledger.iter().step_by(table.levels.len().max(1));
                ledgers.map(Ledger::photons).sum()
            }
            Self::Scatter(maps) => maps.photons(),
        }
    }

    pub(in crate::table) fn albedo(&self, node: usize, channel: usize) -> f64 {
        match self {
            Self::Structure(table) => table.albedo(node, channel),
            Self::Scatter(maps) => maps.albedo(node)[channel],
        }
    }
}

/// A table with the channels that take part.
pub(in crate::table) struct Side<'a> {
    pub(in crate::table) table: TableRef<'a>,
    pub(in crate::table) cube: Unicube,
    /// The table's own number of each channel.
    pub(in crate::table) channels: Vec<usize>,
    /// Per channel of a structure table, how the flux at twice its optical depth follows from two
    /// levels: the lower one, the other one, and the share of the other in the logarithm.
    doubled: Vec<(usize, usize, f32)>,
}

impl<'a> Side<'a> {
    pub(in crate::table) fn new(table: TableRef<'a>, channels: Vec<usize>) -> Self {
        let doubled = match table {
            TableRef::Structure(t) => channels.iter().map(|&c| double(&t.levels, c)).collect(),
            TableRef::Scatter(_) => Vec::new(),
        };
        Self {
            cube: Unicube::new(table.res()),
            table,
            channels,
            doubled,
        }
    }

    /// Flux fraction and the variance of its estimate. Channel: place in `channels`.
    ///
    /// The file tells the relative error of the clear level only. A photon that counts `w` at
    /// optical depth `tau` counts `w^2` at `2 tau`, so the variance at `tau` is that of the clear
    /// level times the transmittance at `2 tau`. A dyed table's file tells the errors of its
    /// colors.
    pub(in crate::table) fn flux(&self, channel: usize, node: usize, texel: usize) -> (f64, f64) {
        match self.table {
            TableRef::Structure(t) => {
                let texels = self.cube.texels();
                let levels = t.levels.len();
                let at = |level: usize| t.flux[(node * levels + level) * texels + texel];
                let error = t.error[node * texels + texel];
                let flux = f64::from(at(self.channels[channel]));
                if !error.is_finite() {
                    return (flux, 0.0);
                }
                let (low, high, share) = self.doubled[channel];
                let (a, b) = (at(low), at(high));
                let twice = if a > 0.0 && b > 0.0 {
                    (a * (b / a).powf(share)).min(at(0))
                } else {
                    a
                };
                let error = f64::from(error);
                (flux, error * error * f64::from(at(0)) * f64::from(twice))
            }
            TableRef::Scatter(maps) => {
                let i = node * self.cube.texels() + texel;
                let flux = f64::from(maps.rgb[i][self.channels[channel]]);
                let error = f64::from(maps.error[i][self.channels[channel]]);
                let deviation = if error.is_finite() { error * flux } else { 0.0 };
                (flux, deviation * deviation)
            }
        }
    }
}

fn double(levels: &[f64], channel: usize) -> (usize, usize, f32) {
    let twice = 2.0 * levels[channel];
    if levels.len() < 2 || twice == 0.0 {
        return (channel, channel, 0.0);
    }
    let low = levels
        .partition_point(|&l| l <= twice)
        .clamp(1, levels.len() - 1)
        - 1;
    let share = (twice - levels[low]) / (levels[low + 1] - levels[low]);
    (low, low + 1, share as f32)
}
