//! The rules that every table keeps, in memory and in files.

use super::{Azimuths, Ledger, Mode, Nodes, ScatterMaps, StructureTable, TableError};
use crate::math::symmetry::Symmetry;
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;

/// Most nodes of a table.
pub(super) const MAX_BINS: usize = 256;
/// Most texels along a face edge.
pub(super) const MAX_RES: usize = 1024;
/// Most absorption levels.
pub(super) const MAX_LEVELS: usize = 64;
/// Most numbers in all maps together: 1 GiB of them. A file that claims more is refused before any
/// memory is set aside for it.
pub(super) const MAX_SAMPLES: usize = 1 << 28;

/// Texels and ledger must agree to this relative difference: single precision leaves 1e-7.
const SUM_TOLERANCE: f64 = 1e-5;

macro_rules! ensure {
    ($condition:expr, $($message:tt)+) => {
        let holds: bool = $condition;
        if !holds {
            return Err(TableError::Inconsistent(format!($($message)+)));
        }
    };
}

impl StructureTable {
    /// Whether the table keeps every rule: sizes, ranges, exact ledger, texels that sum to it.
    pub fn check(&self) -> Result<(), TableError> {
        let (bins, levels) = (self.nodes.len(), self.levels.len());
        check_shape(&self.nodes, self.res, levels)?;
        ensure!(
            self.levels.first() == Some(&0.0),
            "the first absorption level must be 0"
        );
        ensure!(
            self.levels.iter().all(|l| l.is_finite()) && self.levels.is_sorted_by(|a, b| a < b),
            "absorption levels must be finite and ascend"
        );
        check_radius(self.radius_um)?;
        ensure!(
            self.flux.len() == bins * levels * self.texels(),
            "{} flux values for {bins} nodes, {levels} levels and {} texels",
            self.flux.len(),
            self.texels()
        );
        ensure!(
            self.ledger.len() == bins * levels,
            "{} ledgers for {bins} nodes and {levels} levels",
            self.ledger.len()
        );
        check_error(self.error.iter(), bins * self.texels())?;
        let nodes = (0..bins).into_par_iter().map(|node| {
            for level in 0..levels {
                let ledger = self.ledger(node, level);
                check_ledger(ledger, node)?;
                let sum = check_map(self.map(node, level), node)?;
                let albedo = self.albedo(node, level);
                ensure!(
                    (sum - albedo).abs() <= SUM_TOLERANCE * albedo.max(1e-6),
                    "node {node} level {level}: the texels sum to {sum}, the ledger says {albedo}"
                );
            }
            Ok(())
        });
        // The first node that breaks a rule is named, whichever thread found what.
        nodes
            .collect::<Vec<_>>()
            .into_iter()
            .collect::<Result<(), _>>()?;
        Ok(())
    }
}

impl ScatterMaps {
    /// Whether the maps keep every rule: sizes and ranges.
    pub fn check(&self) -> Result<(), TableError> {
        let bins = self.nodes.len();
        check_shape(&self.nodes, self.res, 3)?;
        check_radius(self.radius_um)?;
        ensure!(
            self.absorption_per_um
                .iter()
                .all(|a| a.is_finite() && *a >= 0.0),
            "absorption must be finite and not negative, not {:?}",
            self.absorption_per_um
        );
        ensure!(
            self.rgb.len() == bins * self.texels(),
            "{} texels for {bins} nodes of {}",
            self.rgb.len(),
            self.texels()
        );
        ensure!(
            self.ledger.len() == bins || self.ledger.len() == 3 * bins,
            "{} ledgers for {bins} nodes; one or three a node are possible",
            self.ledger.len()
        );
        check_error(self.error.as_flattened().iter(), 3 * self.rgb.len())?;
        for (node, ledgers) in self.ledger.chunks(self.bakes()).enumerate() {
            for ledger in ledgers {
                check_ledger(ledger, node)?;
            }
            for channel in 0..3 {
                check_flux(self.map(node).iter().map(|t| t[channel]), node)?;
            }
        }
        Ok(())
    }
}

fn check_shape(nodes: &Nodes, res: usize, channels: usize) -> Result<(), TableError> {
    let bins = nodes.len();
    ensure!(
        (1..=MAX_BINS).contains(&bins),
        "{bins} nodes; 1 to {MAX_BINS} are allowed"
    );
    ensure!(
        res.is_power_of_two() && res <= MAX_RES,
        "{res} texels a face edge; powers of two up to {MAX_RES} are allowed"
    );
    ensure!(
        (1..=MAX_LEVELS).contains(&channels),
        "{channels} levels; 1 to {MAX_LEVELS} are allowed"
    );
    let samples = bins * (channels + 1) * 6 * res * res;
    ensure!(
        samples <= MAX_SAMPLES,
        "{samples} numbers in all; {MAX_SAMPLES} are allowed"
    );
    let Azimuths { count, symmetry } = nodes.azimuths;
    ensure!(
        count == 1 || nodes.mode == Mode::Cone,
        "{count} azimuths in paper mode, which averages them"
    );
    ensure!(
        count > 1 || symmetry == Symmetry::None,
        "symmetry without azimuths"
    );
    let bins = nodes.inclinations();
    ensure!(
        nodes.edges.len() == bins + 1,
        "{} bin boundaries for {bins} bins",
        nodes.edges.len()
    );
    let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
    ensure!(
        near(nodes.edges[0], -FRAC_PI_2) && near(nodes.edges[bins], FRAC_PI_2),
        "the bins must reach from -90 to 90 degrees"
    );
    for j in 0..bins {
        let (low, center, high) = (nodes.edges[j], nodes.centers[j], nodes.edges[j + 1]);
        ensure!(
            low < center && center < high,
            "node {j} at {:.4} degrees lies outside its bin, {:.4} to {:.4}",
            center.to_degrees(),
            low.to_degrees(),
            high.to_degrees()
        );
    }
    Ok(())
}

fn check_radius(radius_um: f64) -> Result<(), TableError> {
    ensure!(
        radius_um.is_finite() && radius_um > 0.0,
        "the mean radius must be positive, not {radius_um} um"
    );
    Ok(())
}

fn check_ledger(ledger: &Ledger, node: usize) -> Result<(), TableError> {
    let parts = [
        ledger.escaped,
        ledger.absorbed,
        ledger.truncated,
        ledger.lost,
    ];
    let sum = parts.iter().try_fold(0u64, |sum, &p| sum.checked_add(p));
    ensure!(
        sum == Some(ledger.emitted),
        "node {node}: the ledger does not balance, emitted {} against escaped {} + absorbed {} + \
         truncated {} + lost {}",
        ledger.emitted,
        ledger.escaped,
        ledger.absorbed,
        ledger.truncated,
        ledger.lost
    );
    Ok(())
}

/// [`check_flux`] of a map, eight numbers at a time.
fn check_map(map: &[f32], node: usize) -> Result<f64, TableError> {
    let (eights, rest) = map.as_chunks::<8>();
    let mut sums = [0.0; 8];
    let mut fine = true;
    for eight in eights {
        for (sum, value) in sums.iter_mut().zip(eight) {
            fine &= (0.0..=f32::MAX).contains(value);
            *sum += f64::from(*value);
        }
    }
    if !fine {
        // Says which.
        check_flux(map.iter().copied(), node)?;
    }
    Ok(sums.iter().sum::<f64>() + check_flux(rest.iter().copied(), node)?)
}

fn check_flux(flux: impl Iterator<Item = f32>, node: usize) -> Result<f64, TableError> {
    let mut sum = 0.0;
    for value in flux {
        ensure!(
            value.is_finite() && value >= 0.0,
            "node {node} holds a flux of {value}"
        );
        sum += f64::from(value);
    }
    Ok(sum)
}

fn check_error<'a>(
    mut error: impl ExactSizeIterator<Item = &'a f32>,
    expected: usize,
) -> Result<(), TableError> {
    ensure!(
        error.len() == expected,
        "{} error values, not {expected}",
        error.len()
    );
    ensure!(
        error.all(|e| *e >= 0.0),
        "an error value is negative or not a number"
    );
    Ok(())
}
