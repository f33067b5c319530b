//! How far apart two tables are.
//!
//! The measure is the relative L2 distance of the scattering function S (without cosine) from a
//! reference `b`, over all pairs of directions whose inclinations both stay below a limit, evenly in
//! both solid angles:
//!
//! ```text
//! error^2 = integral of (S_a - S_b)^2 / integral of S_b^2
//! ```
//!
//! Photons are noisy, and so is this number: on average it exceeds the distance of what the two
//! tables estimate by the variances of both. Tables carry their standard errors; with them the
//! variances are taken out again, of the difference and of the reference's square.
//!
//! Tables of the same nodes and faces are compared texel by texel; others as the renderer sees them,
//! by look-ups at a common grid of directions. Several azimuths count alike; a table that averages over
//! them is held against each.

mod azimuths;
mod measure;
mod side;
#[cfg(test)]
mod tests;

pub(super) use side::Side;
pub use side::TableRef;

use super::TableError;
use azimuths::Slice;
use measure::{Row, Sums};

/// Inclination limit that is usual here, degrees: beyond it S grows without bound toward grazing and
/// a few texels decide.
pub const THETA_MAX_DEG: f64 = 73.0;

/// How far table `a` is from the reference `b`.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Limit of both inclinations, degrees.
    pub theta_max_deg: f64,
    /// Whether texels were compared one by one; else look-ups at a grid.
    pub by_texel: bool,
    /// Query inclinations that take part.
    pub queries: usize,
    /// One a channel: absorption levels that both tables have, or R, G and B.
    pub channels: Vec<ChannelComparison>,
}

/// The comparison of one channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelComparison {
    /// Name of the channel in the file of `b`.
    pub name: String,
    /// Optical depth per mean radius of an absorption level; `None` for R, G and B.
    pub level: Option<f64>,
    /// Over all queries.
    pub total: Difference,
    /// By bin of the table with fewer nodes, ascending in inclination.
    pub bins: Vec<BinDifference>,
    /// By bin of azimuth; empty if both tables average over azimuths.
    pub azimuths: Vec<AzimuthDifference>,
    /// Largest difference of the albedo, over the queries.
    pub albedo: f64,
    /// Largest difference of S as a share of the largest S of the reference.
    pub largest: f64,
    /// Where: inclination of the query, inclination and azimuth of the direction, degrees.
    pub largest_at_deg: [f64; 3],
}

/// Relative L2 distances.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Difference {
    /// As measured, noise and all.
    pub error: f64,
    /// What the standard errors of both tables alone make of it.
    pub noise: f64,
    /// The distance without noise: 0 where noise explains all of it.
    pub debiased: f64,
}

/// The queries in one bin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BinDifference {
    /// Node of the bin, degrees.
    pub theta_deg: f64,
    /// Distances.
    pub difference: Difference,
    /// Mean albedo over the bin's queries, of `a` and `b`.
    pub albedo: [f64; 2],
}

/// The queries in one bin of azimuth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AzimuthDifference {
    /// Middle of the bin, degrees from the major axis of the section.
    pub azimuth_deg: f64,
    /// Distances.
    pub difference: Difference,
    /// Mean albedo over the queries, of `a` and `b`.
    pub albedo: [f64; 2],
}

impl Comparison {
    /// The clear level or the channel with the largest error of R, G and B.
    pub fn headline(&self) -> Option<&ChannelComparison> {
        let worst = |a: &&ChannelComparison, b: &&ChannelComparison| {
            a.total.error.total_cmp(&b.total.error)
        };
        match self.channels.first() {
            Some(first) if first.level.is_some() => Some(first),
            _ => self.channels.iter().max_by(worst),
        }
    }
}

/// Compares table `a` with the reference `b`, up to the inclination `theta_max_deg` in (0, 90] of
/// query and direction.
///
/// Structure tables are compared at the absorption levels that both hold.
///
/// * Errors: a structure table against a dyed one, an angle out of range, tables of different azimuths
///   unless one of them averages over them.
pub fn compare<'a>(
    a: impl Into<TableRef<'a>>,
    b: impl Into<TableRef<'a>>,
    theta_max_deg: f64,
) -> Result<Comparison, TableError> {
    let (a, b) = (a.into(), b.into());
    if !(theta_max_deg > 0.0 && theta_max_deg <= 90.0) {
        return Err(TableError::Request(format!(
            "an inclination limit of {theta_max_deg} degrees; above 0 up to 90 is possible"
        )));
    }
    let channels = shared_channels(a, b)?;
    let (a_channels, b_channels): (Vec<_>, Vec<_>) = channels.iter().map(|c| (c.a, c.b)).unzip();
    let azimuths = azimuths::shared(a, b)?;
    let (mut by_texel, mut rows) = (true, Vec::new());
    for bin in 0..azimuths.count {
        let slices = [Slice::of(a, bin), Slice::of(b, bin)];
        let a = Side::new(slices[0].table(), a_channels.clone());
        let b = Side::new(slices[1].table(), b_channels.clone());
        let (all_texels, of_bin) = measure::rows(&a, &b, theta_max_deg.to_radians());
        by_texel &= all_texels;
        rows.extend(of_bin.into_iter().map(|row| (bin, row)));
    }
    let (bins_of, rows): (Vec<usize>, Vec<Row>) = rows.into_iter().unzip();
    if rows.is_empty() {
        return Err(TableError::Request(format!(
            "no node of the tables lies below {theta_max_deg} degrees"
        )));
    }
    let coarse = if a.nodes().inclinations() <= b.nodes().inclinations() {
        a.nodes()
    } else {
        b.nodes()
    };
    let channels = channels.into_iter().enumerate().map(|(c, shared)| {
        let mut bins = Vec::new();
        for node in 0..coarse.inclinations() {
            let inside: Vec<_> = rows
                .iter()
                .filter(|r| coarse.bin(r.theta) == node)
                .collect();
            if inside.is_empty() {
                continue;
            }
            let (difference, albedo) = together(&inside, c);
            bins.push(BinDifference {
                theta_deg: coarse.centers[node].to_degrees(),
                difference,
                albedo,
            });
        }
        let sides = (0..azimuths.count).filter(|_| !azimuths.is_averaged());
        let sides = sides.map(|bin| {
            let inside = rows.iter().zip(&bins_of).filter(|(_, of)| **of == bin);
            let inside: Vec<_> = inside.map(|(row, _)| row).collect();
            let (difference, albedo) = together(&inside, c);
            AzimuthDifference {
                azimuth_deg: azimuths.range(bin)[2].to_degrees(),
                difference,
                albedo,
            }
        });
        let all = Sums::total(rows.iter().map(|r| &r.sums[c]));
        let [largest, theta, phi] = all.largest;
        let query = rows.iter().find(|r| r.sums[c].largest == all.largest);
        ChannelComparison {
            name: shared.name,
            level: shared.level,
            total: all.difference(),
            bins,
            azimuths: sides.collect(),
            albedo: rows
                .iter()
                .map(|r| (r.albedo[c][0] - r.albedo[c][1]).abs())
                .fold(0.0, f64::max),
            largest: largest / all.peak.max(f64::MIN_POSITIVE),
            largest_at_deg: [query.map_or(0.0, |r| r.theta), theta, phi].map(f64::to_degrees),
        }
    });
    Ok(Comparison {
        theta_max_deg,
        by_texel,
        queries: rows.len(),
        channels: channels.collect(),
    })
}

/// Distance and mean albedo of some queries.
fn together(rows: &[&Row], channel: usize) -> (Difference, [f64; 2]) {
    let mean = |side: usize| {
        let sum: f64 = rows.iter().map(|r| r.albedo[channel][side]).sum();
        sum / rows.len() as f64
    };
    let sums = Sums::total(rows.iter().map(|r| &r.sums[channel]));
    (sums.difference(), [mean(0), mean(1)])
}

/// A channel that both tables have: its number in each.
struct Shared {
    a: usize,
    b: usize,
    name: String,
    level: Option<f64>,
}

fn shared_channels(a: TableRef<'_>, b: TableRef<'_>) -> Result<Vec<Shared>, TableError> {
    match (a, b) {
        (TableRef::Scatter(_), TableRef::Scatter(_)) => Ok(["R", "G", "B"]
            .iter()
            .enumerate()
            .map(|(c, name)| Shared {
                a: c,
                b: c,
                name: (*name).to_owned(),
                level: None,
            })
            .collect()),
        (TableRef::Structure(a), TableRef::Structure(b)) => {
            let near = |x: f64, y: f64| (x - y).abs() <= 1e-9 * (1.0 + y);
            let place = |level: f64| a.levels.iter().position(|&l| near(l, level));
            Ok(b.levels
                .iter()
                .enumerate()
                .filter_map(|(c, &level)| {
                    Some(Shared {
                        a: place(level)?,
                        b: c,
                        name: format!("a{c:02}"),
                        level: Some(level),
                    })
                })
                .collect())
        }
        _ => Err(TableError::Request(
            "one table is dyed and the other is not; dye it with the same pigment first".to_owned(),
        )),
    }
}
