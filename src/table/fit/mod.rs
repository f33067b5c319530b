//! Hair models fitted to tables: how well can a shader in closed form stand for a baked fiber?
//!
//! The error that is made least is the same relative L2 distance of S as in [`super::compare()`], over
//! bins of 2 by 5 degrees, of all channels together; index, roughness and tilt are common to all channels.
//! Absorption is each channel's own and not free: it is what makes the model scatter as much of even
//! light as the table does. A coat's color is that share many times over, and the least error of S alone
//! trades it for the height of a lobe: red fox would come out gray.

mod data;
mod least_squares;
mod lobes;
mod model;
#[cfg(test)]
mod tests;

pub use model::Model;

use super::{TableError, TableRef};
use data::{COLUMNS, Data};
use lobes::Lobe;
use rayon::prelude::*;

/// A model with the parameters that come closest to a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Which one.
    pub model: Model,
    /// Name and value of the parameters that all channels share.
    pub shared: Vec<(&'static str, f64)>,
    /// Absorption of each channel per radius of the fiber.
    pub absorption: Vec<f64>,
    /// Relative L2 distance of S, per channel.
    pub error: Vec<f64>,
    /// Per lobe of [`Model::lobes`].
    pub lobes: Vec<LobeFit>,
}

/// How well one lobe is met. Each direction's light and error are shared among the lobes as the model
/// shares its light there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeFit {
    /// Share of the scattered light of the table that falls to it.
    pub table: f64,
    /// Share of the scattered light of the model.
    pub model: f64,
    /// Relative L2 distance of S among the light that falls to it.
    pub error: f64,
}

impl Fit {
    /// A shared parameter by its name.
    pub fn parameter(&self, name: &str) -> Option<f64> {
        self.shared
            .iter()
            .find(|(n, _)| *n == name)
            .map(|(_, v)| *v)
    }
}

impl Model {
    /// Fits the model to some channels (absorption levels or colors) of a table.
    ///
    /// * Errors: no channel, or one that the table does not have; several azimuths.
    pub fn fit<'a>(
        self,
        table: impl Into<TableRef<'a>>,
        channels: &[usize],
    ) -> Result<Fit, TableError> {
        let table = table.into();
        if channels.is_empty() || channels.iter().any(|&c| c >= table.channels()) {
            return Err(TableError::Request(format!(
                "channels {channels:?} were asked for; the table has {}",
                table.channels()
            )));
        }
        table.nodes().only_averaged()?;
        let data = Data::new(table, channels);
        if data.queries.is_empty() {
            return Err(TableError::Request(
                "the table has no node below 73 degrees".to_owned(),
            ));
        }
        let shared = self.shared();
        let ranges: Vec<[f64; 2]> = shared.iter().map(|s| s.range).collect();
        let queries = data.queries.iter().copied().zip(data.seen.iter().copied());
        let queries: Vec<(f64, f64)> = queries.collect();
        let absorption = |p: &[f64]| self.absorption(&queries, p, &data.albedo);
        let residuals = |p: &[f64]| self.residuals(&data, p, &absorption(p));
        let mut best: Option<(Vec<f64>, f64)> = None;
        // Narrow and wide lobes have their own valleys.
        for roughness in [0.2, 0.5] {
            let mut start: Vec<f64> = shared.iter().map(|s| s.start).collect();
            (start[1], start[2]) = (roughness, roughness);
            let found = least_squares::minimize(&start, &ranges, residuals);
            if best.as_ref().is_none_or(|(_, least)| found.1 < *least) {
                best = Some(found);
            }
        }
        let p = best.map(|(p, _)| p).unwrap_or_default();
        Ok(self.report(&data, &p, &absorption(&p)))
    }

    /// Weighted differences in shares of each channel's norm.
    fn residuals(self, data: &Data, shared: &[f64], absorption: &[f64]) -> Vec<f64> {
        let rows = data.rows();
        let queries: Vec<Vec<f64>> = data
            .queries
            .par_iter()
            .enumerate()
            .map(|(query, &theta)| {
                let lobes = self.evaluate(theta, &data.edges, shared, absorption);
                let mut all = Vec::with_capacity(rows * COLUMNS * absorption.len());
                for channel in 0..absorption.len() {
                    for row in 0..rows {
                        let weight = data.weight[query * rows + row] / data.square[channel];
                        let at = (query * rows + row) * COLUMNS;
                        let found = &data.density[channel][at..at + COLUMNS];
                        let model = sum_of(&lobes, channel, row);
                        let pairs = found.iter().zip(&model);
                        all.extend(pairs.map(|(d, m)| (m - d) * weight.sqrt()));
                    }
                }
                all
            })
            .collect();
        queries.concat()
    }

    fn report(self, data: &Data, shared: &[f64], absorption: &[f64]) -> Fit {
        let rows = data.rows();
        let count = self.lobes().len();
        let mut error = vec![0.0; absorption.len()];
        // Per lobe: light of table and model, squared error, square.
        let mut sums = vec![[0.0f64; 4]; count];
        for (query, &theta) in data.queries.iter().enumerate() {
            let lobes = self.evaluate(theta, &data.edges, shared, absorption);
            for (channel, error) in error.iter_mut().enumerate() {
                for row in 0..rows {
                    let at = (query * rows + row) * COLUMNS;
                    let found = &data.density[channel][at..at + COLUMNS];
                    let model = sum_of(&lobes, channel, row);
                    let weight = data.weight[query * rows + row] / data.square[channel];
                    let cosine = (0.5 * (data.edges[row] + data.edges[row + 1])).cos();
                    for (column, (d, m)) in found.iter().zip(&model).enumerate() {
                        let off = weight * (d - m).powi(2);
                        *error += off;
                        for (lobe, sums) in lobes.iter().zip(&mut sums) {
                            let own = lobe.along[row] * lobe.around[channel][column];
                            let share = own / m.max(f64::MIN_POSITIVE);
                            sums[0] += share * d * weight * cosine * cosine;
                            sums[1] += own * weight * cosine * cosine;
                            sums[2] += share * off;
                            sums[3] += share * weight * d * d;
                        }
                    }
                }
            }
        }
        let total = |k: usize| {
            sums.iter()
                .map(|s| s[k])
                .sum::<f64>()
                .max(f64::MIN_POSITIVE)
        };
        let (table, model) = (total(0), total(1));
        let names = self.shared().iter().map(|s| s.name);
        Fit {
            model: self,
            shared: names.zip(shared.iter().copied()).collect(),
            absorption: absorption.to_vec(),
            error: error.into_iter().map(f64::sqrt).collect(),
            lobes: sums
                .iter()
                .map(|s| LobeFit {
                    table: s[0] / table,
                    model: s[1] / model,
                    error: (s[2] / s[3].max(f64::MIN_POSITIVE)).sqrt(),
                })
                .collect(),
        }
    }
}

#[cfg(test)]
impl Model {
    /// The model as it is fitted, for what is to agree with it.
    ///
    /// * `theta_q`: inclination of the query, radians. * `edges`: of the rows of inclinations.
    /// * `shared`: the parameters in the order of a fit. * `absorption`: of one channel per radius.
    /// * Returns means of `S cos(theta_i)` over each row and columns of 5 degrees from azimuth 0, both signs together.
    pub(crate) fn far_field(
        self,
        theta_q: f64,
        edges: &[f64],
        shared: &[f64],
        absorption: f64,
    ) -> Vec<[f64; COLUMNS]> {
        let lobes = self.evaluate(theta_q, edges, shared, &[absorption]);
        let rows = 0..edges.len() - 1;
        rows.map(|row| sum_of(&lobes, 0, row)).collect()
    }
}

/// One row of one channel.
fn sum_of(lobes: &[Lobe], channel: usize, row: usize) -> [f64; COLUMNS] {
    let mut sum = [0.0; COLUMNS];
    for lobe in lobes {
        let along = lobe.along[row];
        let around = &lobe.around[channel];
        sum.iter_mut()
            .zip(around)
            .for_each(|(s, a)| *s += along * a);
    }
    sum
}
