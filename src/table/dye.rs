//! From absorption levels to color.
//!
//! Per texel, flux as a function of absorption is the Laplace transform of the path lengths of the
//! light that left there, `S(tau) = integral of p(l) exp(-tau l) dl`, known at the levels of the
//! bake. Two facts about such functions make the interpolation safe:
//!
//! * It is linear in `p`. So there are weights, the same for all texels, with which the flux at
//!   `tau` is a sum of the fluxes at nearby levels; they are fitted so that every single path
//!   length comes out right, and then every mixture does.
//! * Its logarithm is convex. So the chord through the two levels around `tau` bounds it from
//!   above, and the chords of the neighboring intervals, prolonged, bound it from below. Clamped
//!   between them the result is positive, does not exceed the level before or fall below the one
//!   behind, and is exact where all light has gone the same way.
//!
//! At a level the level itself is returned; beyond the last one the last logarithmic slope goes on.

use super::{Provenance, ScatterMaps, StructureTable, TableError};
use rayon::prelude::*;

/// Levels that take part in one sum. Six leave twice the error, ten gain nothing more.
const SUPPORT: usize = 8;

/// Longest path length, in radii, for which the weights are fitted. Light through a plain fiber
/// travels 2 to 8 radii, scattered light some 10; longer paths are rare, and a wider fit would pay
/// for them with accuracy at the short ones.
const LONGEST_PATH: f64 = 60.0;

/// Errors of the fit count relative to `sqrt(transmittance) + FLOOR`: smaller favors dark texels,
/// larger favors bright ones. At 0.1 the error stays below half a percent of the clear flux.
const FLOOR: f64 = 0.1;

/// Texels a task; enough to hide the cost of a task, few enough to balance 16 nodes on any machine.
const CHUNK: usize = 4096;

impl StructureTable {
    /// The table dyed with a pigment.
    ///
    /// * `absorption_per_um`: absorption coefficient of the cortex per micrometer for linear
    ///   R, G, B, finite and >= 0.
    /// * Errors: absorption out of range, or nonzero in a table that holds only the clear level.
    pub fn dye(&self, absorption_per_um: [f64; 3]) -> Result<ScatterMaps, TableError> {
        let rgb = dye_channels([self; 3], absorption_per_um)?;
        let ledger = (0..self.nodes.len()).map(|n| *self.ledger(n, 0));
        Ok(ScatterMaps {
            nodes: self.nodes.clone(),
            res: self.res,
            rgb,
            error: self.error.clone(),
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
        let rgb = dye_channels([red, green, blue], absorption_per_um)?;
        let nodes = 0..red.nodes.len();
        let ledger = nodes.flat_map(|n| tables.iter().map(move |t| *t.ledger(n, 0)));
        let error = red.error.iter().zip(&green.error).zip(&blue.error);
        Ok(Self {
            nodes: red.nodes.clone(),
            res: red.res,
            rgb,
            error: error.map(|((r, g), b)| r.max(*g).max(*b)).collect(),
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

/// Maps of R, G and B, each from its own table.
fn dye_channels(
    tables: [&StructureTable; 3],
    absorption_per_um: [f64; 3],
) -> Result<Vec<[f32; 3]>, TableError> {
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
    let rules: [Rule; 3] = std::array::from_fn(|c| {
        Rule::new(
            &tables[c].levels,
            absorption_per_um[c] * tables[c].radius_um,
        )
    });
    let texels = tables[0].texels();
    let mut rgb = vec![[0.0; 3]; tables[0].nodes.len() * texels];
    for (node, out) in rgb.chunks_mut(texels).enumerate() {
        let flux = tables.map(|table| {
            let levels = table.levels.len();
            &table.flux[node * levels * texels..(node + 1) * levels * texels]
        });
        out.par_chunks_mut(CHUNK).enumerate().for_each(|(i, out)| {
            for (j, rgb) in out.iter_mut().enumerate() {
                let texel = i * CHUNK + j;
                *rgb = [0, 1, 2].map(|c| {
                    let at = |level: usize| flux[c][level * texels + texel];
                    if at(0) > 0.0 { rules[c].apply(at) } else { 0.0 }
                });
            }
        });
    }
    Ok(rgb)
}

/// How the flux at one optical depth follows from the levels; the same for every texel.
#[derive(Clone, Debug)]
enum Rule {
    /// The depth of a level.
    Level(usize),
    /// Between two levels.
    Between(Between),
    /// Beyond the last level: how many times the last interval.
    Beyond { last: usize, steps: f32 },
}

#[derive(Clone, Debug)]
struct Between {
    /// The level before; the next one lies behind the depth.
    before: usize,
    /// The first level of the sum.
    first: usize,
    weights: Vec<f32>,
    /// Place of the depth in its interval, 0..1.
    chord: f32,
    /// The same in units of the interval before (> 1), if there is one: a lower bound.
    from_below: Option<f32>,
    /// The same in units of the interval behind (< 0), if there is one: a lower bound.
    from_above: Option<f32>,
}

impl Rule {
    fn new(levels: &[f64], tau: f64) -> Self {
        let before = levels.partition_point(|&l| l <= tau) - 1;
        if levels[before] == tau {
            return Self::Level(before);
        }
        let place = |i: usize| (tau - levels[i]) / (levels[i + 1] - levels[i]);
        let last = levels.len() - 1;
        if before == last {
            let steps = place(last - 1) - 1.0;
            return Self::Beyond {
                last,
                steps: steps as f32,
            };
        }
        // A sum of two or three exponentials fits nothing; then the chord has to do.
        let count = match levels.len() {
            0..4 => 0,
            n => n.min(SUPPORT),
        };
        let first = (before + 1)
            .saturating_sub(count / 2)
            .min(levels.len() - count);
        let weights = fit_weights(&levels[first..first + count], tau);
        Self::Between(Between {
            before,
            first,
            weights: weights.iter().map(|&w| w as f32).collect(),
            chord: place(before) as f32,
            from_below: (before > 0).then(|| place(before - 1) as f32),
            from_above: (before + 2 <= last).then(|| place(before + 1) as f32),
        })
    }

    /// The flux of a texel from its fluxes at the levels.
    fn apply(&self, at: impl Fn(usize) -> f32) -> f32 {
        match self {
            Self::Level(level) => at(*level),
            Self::Beyond { last, steps } => {
                let (a, b) = (at(last - 1), at(*last));
                if b > 0.0 && a > b {
                    b * (b / a).powf(*steps)
                } else {
                    b
                }
            }
            Self::Between(rule) => rule.apply(at),
        }
    }
}

impl Between {
    fn apply(&self, at: impl Fn(usize) -> f32) -> f32 {
        let (a, b) = (at(self.before), at(self.before + 1));
        if a <= b {
            return a;
        }
        let terms = self.weights.iter().enumerate();
        let sum: f32 = terms.map(|(i, w)| w * at(self.first + i)).sum();
        if b <= 0.0 {
            return sum.clamp(0.0, a);
        }
        let (ln_a, ln_b) = (a.ln(), b.ln());
        let upper = ln_a + self.chord * (ln_b - ln_a);
        if self.weights.is_empty() {
            return upper.exp();
        }
        let mut lower = ln_b;
        if let Some(place) = self.from_below {
            let ln_0 = at(self.before - 1).ln();
            lower = lower.max(ln_0 + place * (ln_a - ln_0));
        }
        if let Some(place) = self.from_above {
            let next = at(self.before + 2);
            if next > 0.0 {
                lower = lower.max(ln_b + place * (next.ln() - ln_b));
            }
        }
        // Rounding may cross the bounds where all light has gone the same way.
        sum.clamp(lower.min(upper).exp(), upper.exp())
    }
}

/// Weights `w` with `sum_k w_k exp(-l levels_k) ~ exp(-l tau)` for all path lengths `l` from 0 to
/// [`LONGEST_PATH`], by least squares over log-spaced lengths. The length 0, light that never
/// entered, is exact.
fn fit_weights(levels: &[f64], tau: f64) -> Vec<f64> {
    const LENGTHS: usize = 200;
    let shortest = 1e-3f64;
    let ratio = LONGEST_PATH / shortest;
    let rows = (0..=LENGTHS).map(|i| {
        let length = match i {
            0 => 0.0,
            _ => shortest * ratio.powf((i - 1) as f64 / (LENGTHS - 1) as f64),
        };
        let target = (-length * tau).exp();
        let weight = if i == 0 { 1e4 } else { 1.0 } / (target.sqrt() + FLOOR);
        let row: Vec<f64> = levels
            .iter()
            .map(|l| weight * (-length * l).exp())
            .collect();
        (row, weight * target)
    });
    least_squares(rows.collect(), levels.len())
}

/// Least squares by modified Gram-Schmidt, one more column for the right-hand side.
fn least_squares(rows: Vec<(Vec<f64>, f64)>, columns: usize) -> Vec<f64> {
    let mut q: Vec<Vec<f64>> = (0..columns)
        .map(|k| rows.iter().map(|(row, _)| row[k]).collect())
        .collect();
    let mut rest: Vec<f64> = rows.iter().map(|(_, target)| *target).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let mut r = vec![vec![0.0; columns]; columns];
    let mut projected = vec![0.0; columns];
    for k in 0..columns {
        let norm = dot(&q[k], &q[k]).sqrt().max(f64::MIN_POSITIVE);
        r[k][k] = norm;
        q[k].iter_mut().for_each(|x| *x /= norm);
        let (done, later) = q.split_at_mut(k + 1);
        let unit = &done[k];
        for (j, column) in later.iter_mut().enumerate() {
            let along = dot(unit, column);
            r[k][k + 1 + j] = along;
            column
                .iter_mut()
                .zip(unit)
                .for_each(|(x, u)| *x -= along * u);
        }
        projected[k] = dot(unit, &rest);
        rest.iter_mut()
            .zip(unit)
            .for_each(|(x, u)| *x -= projected[k] * u);
    }
    let mut solution = vec![0.0; columns];
    for k in (0..columns).rev() {
        let known: f64 = (k + 1..columns).map(|j| r[k][j] * solution[j]).sum();
        solution[k] = (projected[k] - known) / r[k][k];
    }
    solution
}

#[cfg(test)]
mod tests;
