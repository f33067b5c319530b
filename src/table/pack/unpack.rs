//! Back to tables.

use super::{Code, Kind, PackedTable};
use crate::math::unicube::Unicube;
use crate::table::lowrank::{Factors, Grid};
use crate::table::{ScatterMaps, StructureTable, TableError, TableFile};
use rayon::prelude::*;

impl PackedTable {
    /// The table that it stands for. Its relative errors are 0: not known.
    ///
    /// * Errors: counts that contradict each other.
    pub fn unpack(&self) -> Result<TableFile, TableError> {
        let channels = self.kind.channels();
        let res = self.code.layout.res;
        let cube = Unicube::new(res);
        let maps = self.maps(&cube)?;
        let texels = cube.texels();
        let table = match &self.kind {
            Kind::Structure { levels } => TableFile::Structure(StructureTable {
                nodes: self.nodes.clone(),
                res,
                levels: levels.clone(),
                radius_um: self.radius_um,
                flux: maps.concat(),
                error: vec![0.0; self.nodes.len() * texels],
                ledger: self.ledger.clone(),
                provenance: self.provenance.clone(),
            }),
            Kind::Scatter { absorption_per_um } => TableFile::Scatter(ScatterMaps {
                nodes: self.nodes.clone(),
                res,
                rgb: (0..self.nodes.len() * texels)
                    .map(|i| [0, 1, 2].map(|c| maps[i / texels * channels + c][i % texels]))
                    .collect(),
                error: vec![[0.0; 3]; self.nodes.len() * texels],
                absorption_per_um: *absorption_per_um,
                radius_um: self.radius_um,
                ledger: self.ledger.clone(),
                provenance: self.provenance.clone(),
            }),
        };
        match &table {
            TableFile::Structure(table) => table.check()?,
            TableFile::Scatter(maps) => maps.check()?,
        }
        Ok(table)
    }

    /// Flux fractions of all maps, not negative and summing to the albedo.
    fn maps(&self, cube: &Unicube) -> Result<Vec<Vec<f32>>, TableError> {
        let code = &self.code;
        let (nodes, channels) = (self.nodes.len(), self.kind.channels());
        let wrong = |what: &str| TableError::Inconsistent(what.to_owned());
        let rows = if code.aligned {
            nodes * channels
        } else {
            channels
        };
        if code.images == 0 || code.mix.len() != rows * code.images {
            return Err(wrong("the weights of the images are too many or too few"));
        }
        if self.albedo.len() != nodes * channels {
            return Err(wrong("the albedo has too many or too few values"));
        }
        let (tiles, side) = code.tiles(nodes);
        let values = code
            .trees
            .expand(tiles, side)
            .ok_or_else(|| wrong("its trees and values do not fit each other"))?;
        let densities = if code.aligned {
            let factors = Factors {
                grid: Grid::new(code.layout),
                images: values
                    .chunks(tiles / code.images * side * side)
                    .map(<[f32]>::to_vec)
                    .collect(),
                weights: code.mix.clone(),
            };
            factors.maps(code.layout, &self.nodes.centers)
        } else {
            (0..nodes * channels)
                .into_par_iter()
                .map(|row| mixed(code, &values, row / channels, row % channels))
                .collect()
        };
        let maps = densities.par_iter().zip(&self.albedo);
        Ok(maps
            .map(|(density, &albedo)| flux(code, cube, density, albedo))
            .collect())
    }
}

/// The density of one channel from the images of its node.
fn mixed(code: &Code, values: &[f32], node: usize, channel: usize) -> Vec<f32> {
    let length = code.layout.len();
    let mut sum = vec![0.0f32; length];
    for image in 0..code.images {
        let weight = code.mix[channel * code.images + image];
        let start = (node * code.images + image) * length;
        let image = &values[start..start + length];
        sum.iter_mut()
            .zip(image)
            .for_each(|(s, v)| *s += weight * v);
    }
    sum
}

/// Flux of a whole map from the densities of its layout.
fn flux(code: &Code, cube: &Unicube, density: &[f32], albedo: f32) -> Vec<f32> {
    let mut flux = vec![0.0f64; cube.texels()];
    for (i, &d) in density.iter().enumerate() {
        let texel = code.layout.texel(i);
        let f = f64::from(d.max(0.0)) * cube.solid_angle(texel);
        flux[texel] = f;
        if code.layout.folded {
            flux[cube.mirrored(texel)] = f;
        }
    }
    let sum: f64 = flux.iter().sum();
    if sum > 0.0 {
        let scale = f64::from(albedo) / sum;
        return flux.into_iter().map(|f| (f * scale) as f32).collect();
    }
    // Nothing is known but how much: evenly.
    let even = f64::from(albedo) / (4.0 * std::f64::consts::PI);
    (0..cube.texels())
        .map(|t| (even * cube.solid_angle(t)) as f32)
        .collect()
}
