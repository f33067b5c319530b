//! From absorption levels to color.
//!
//! Per texel, flux as a function of absorption is the Laplace transform of the path lengths of the
//! light that left there, `S(tau) = integral of p(l) exp(-tau l) dl`, known at the levels of the
//! bake. [`rule`] says how it follows from them at any depth, [`power`] makes that fast.

mod power;
mod rule;

use super::{Provenance, ScatterMaps, StructureTable, TableError};
use rayon::prelude::*;
use rule::{Doubled, Rule};

/// Texels that are dyed together: few enough that what is known of them stays in the first cache.
const RUN: usize = 256;

/// Runs a task; enough to hide the cost of a task, few enough to balance 16 nodes on any machine.
const RUNS: usize = 16;

impl StructureTable {
    /// The table dyed with a pigment.
    ///
    /// * `absorption_per_um`: absorption coefficient of the cortex per micrometer for linear
    ///   R, G, B, finite and >= 0.
    /// * Errors: absorption out of range, or nonzero in a table that holds only the clear level.
    pub fn dye(&self, absorption_per_um: [f64; 3]) -> Result<ScatterMaps, TableError> {
        let (rgb, error) = dye_channels([self; 3], absorption_per_um)?;
        let ledger = (0..self.nodes.len()).map(|n| *self.ledger(n, 0));
        Ok(ScatterMaps {
            nodes: self.nodes.clone(),
            res: self.res,
            rgb,
            error,
            absorption_per_um,
            radius_um: self.radius_um,
            ledger: ledger.collect(),
            provenance: self.provenance.clone(),
        })
    }
}

impl ScatterMaps {
    /// Tables of one fiber as light of R, G and B meets it, each dyed for its channel.
    ///
    /// * Errors: as for [`StructureTable::dye`], or tables of different sizes.
    pub(super) fn of_channels(
        tables: &[StructureTable; 3],
        absorption_per_um: [f64; 3],
    ) -> Result<Self, TableError> {
        let [red, green, blue] = tables;
        let alike = |t: &StructureTable| t.nodes == red.nodes && t.res == red.res;
        if !tables.iter().all(alike) {
            return Err(TableError::Request(
                "the tables of R, G and B have different nodes or sizes".to_owned(),
            ));
        }
        let (rgb, error) = dye_channels([red, green, blue], absorption_per_um)?;
        let nodes = 0..red.nodes.len();
        let ledger = nodes.flat_map(|n| tables.iter().map(move |t| *t.ledger(n, 0)));
        Ok(Self {
            nodes: red.nodes.clone(),
            res: red.res,
            rgb,
            error,
            absorption_per_um,
            radius_um: red.radius_um,
            ledger: ledger.collect(),
            provenance: Provenance {
                content: tables
                    .each_ref()
                    .map(|t| t.provenance.content.as_str())
                    .join(" "),
                ..red.provenance.clone()
            },
        })
    }
}

/// Maps of R, G and B, each from its own table, and their relative standard errors.
type Dyed = (Vec<[f32; 3]>, Vec<[f32; 3]>);

fn dye_channels(
    tables: [&StructureTable; 3],
    absorption_per_um: [f64; 3],
) -> Result<Dyed, TableError> {
    if !absorption_per_um.iter().all(|a| a.is_finite() && *a >= 0.0) {
        return Err(TableError::Request(format!(
            "absorption must be finite and not negative, not {absorption_per_um:?} per um"
        )));
    }
    if tables.iter().any(|t| t.levels.len() < 2) && absorption_per_um != [0.0; 3] {
        return Err(TableError::Request(
            "the table holds only the clear level and cannot be dyed".to_owned(),
        ));
    }
    let channels: [Channel<'_>; 3] =
        std::array::from_fn(|c| Channel::new(tables[c], absorption_per_um[c]));
    let texels = tables[0].texels();
    let size = tables[0].nodes.len() * texels;
    let (mut rgb, mut error) = (vec![[0.0; 3]; size], vec![[0.0; 3]; size]);
    let nodes = rgb.chunks_mut(texels).zip(error.chunks_mut(texels));
    for (node, (rgb, error)) in nodes.enumerate() {
        let tasks = rgb
            .par_chunks_mut(RUN * RUNS)
            .zip(error.par_chunks_mut(RUN * RUNS));
        tasks.enumerate().for_each(|(task, (rgb, error))| {
            let runs = rgb.chunks_mut(RUN).zip(error.chunks_mut(RUN));
            for (run, (rgb, error)) in runs.enumerate() {
                let first = (task * RUNS + run) * RUN;
                for (c, channel) in channels.iter().enumerate() {
                    channel.dye(node, first, c, rgb, error);
                }
            }
        });
    }
    Ok((rgb, error))
}

/// One color of a table and how it is dyed.
struct Channel<'a> {
    table: &'a StructureTable,
    rule: Rule,
    doubled: Doubled,
}

impl<'a> Channel<'a> {
    fn new(table: &'a StructureTable, absorption_per_um: f64) -> Self {
        let tau = absorption_per_um * table.radius_um;
        Self {
            table,
            rule: Rule::new(&table.levels, tau),
            doubled: Doubled::new(&table.levels, tau),
        }
    }

    /// Dyes the texels of a run, from `first` on, and writes them to channel `c`.
    fn dye(
        &self,
        node: usize,
        first: usize,
        c: usize,
        rgb: &mut [[f32; 3]],
        error: &mut [[f32; 3]],
    ) {
        let count = rgb.len();
        let at = |level: usize| &self.table.map(node, level)[first..first + count];
        let (mut flux, mut relative) = ([0.0; RUN], [0.0; RUN]);
        let (flux, relative) = (&mut flux[..count], &mut relative[..count]);
        self.rule.apply(at, flux);
        let start = node * self.table.texels() + first;
        relative.copy_from_slice(&self.table.error[start..start + count]);
        self.doubled.grow(at, flux, relative);
        for (rgb, flux) in rgb.iter_mut().zip(flux) {
            rgb[c] = *flux;
        }
        for (error, relative) in error.iter_mut().zip(relative) {
            error[c] = *relative;
        }
    }
}

#[cfg(test)]
mod tests;
