//! The best code of a size.

use super::prepare::Prepared;
use super::tree::{Tiles, Trees};
use super::{Code, Kind, PackedTable, Packing};
use crate::table::compare::TableRef;
use crate::table::lowrank::{Factors, Grid, Rows, symmetric};
use crate::table::{TableError, exr};
use rayon::prelude::*;
use std::path::Path;

/// Bits of mantissa to choose from; half floats have ten. Three leave 3 % of error, five 0.7 %.
const MANTISSAS: [u32; 4] = [3, 4, 5, 7];

/// Halvings of the range of prices; after ten the size is within some percent of the wish.
const STEPS: usize = 11;

/// Prices of a bit, in relative squared error: at the first nothing is merged but noise, at the last
/// everything.
const PRICES: [f64; 2] = [1e-13, 1e-3];

/// Below this size the species file is left out: it would be a quarter of it.
const WITHOUT_TEXT: usize = 50_000;

pub(super) fn pack(table: TableRef<'_>, packing: Packing) -> Result<PackedTable, TableError> {
    let maps = table.nodes().len() * table.channels();
    if packing.rank.is_some_and(|rank| rank == 0 || rank > maps) {
        return Err(TableError::Request(format!(
            "a rank of {}; 1 to {maps}, the number of maps, are possible",
            packing.rank.unwrap_or(0)
        )));
    }
    let prepared = Prepared::new(table);
    let images = match packing.rank {
        Some(rank) => Images::aligned(&prepared, rank),
        None if packing.bytes.is_some() => Images::components(&prepared),
        None => Images::channels(&prepared),
    };
    let mut packed = frame(table, images.code(&prepared, Trees::default()));
    let Some(bytes) = packing.bytes else {
        packed.code.trees = images.trees(0.0).0;
        shorten(&mut packed.code.trees.leaves, 10);
        return Ok(packed);
    };
    if bytes < WITHOUT_TEXT {
        packed.provenance.species_text.clear();
    }
    let mut best: Option<(f64, Trees)> = None;
    for mantissa in MANTISSAS {
        if let Some((error, trees)) = images.within(&mut packed, bytes, mantissa)?
            && best.as_ref().is_none_or(|(least, _)| error < *least)
        {
            best = Some((error, trees));
        }
    }
    let Some((_, trees)) = best else {
        packed.code.trees = images.trees(f64::MAX).0;
        return Err(TableError::Request(format!(
            "{bytes} bytes were asked for; the least that this table packs to is {}",
            packed.size()?
        )));
    };
    packed.code.trees = trees;
    Ok(packed)
}

/// What a packed table takes over as it is.
fn frame(table: TableRef<'_>, code: Code) -> PackedTable {
    let nodes = table.nodes();
    let albedo = (0..nodes.len())
        .flat_map(|node| (0..table.channels()).map(move |c| table.albedo(node, c) as f32));
    let (kind, radius_um, provenance, ledger) = match table {
        TableRef::Structure(t) => {
            let levels = t.levels.clone();
            let kind = Kind::Structure { levels };
            (kind, t.radius_um, &t.provenance, &t.ledger)
        }
        TableRef::Scatter(t) => {
            let absorption_per_um = t.absorption_per_um;
            let kind = Kind::Scatter { absorption_per_um };
            (kind, t.radius_um, &t.provenance, &t.ledger)
        }
    };
    PackedTable {
        kind,
        nodes: nodes.clone(),
        radius_um,
        provenance: provenance.clone(),
        ledger: ledger.clone(),
        albedo: albedo.collect(),
        code,
    }
}

/// Images before their trees.
struct Images {
    aligned: bool,
    /// Images of each node, or in all if aligned.
    count: usize,
    side: usize,
    mix: Vec<f32>,
    images: Vec<Image>,
}

struct Image {
    values: Vec<f32>,
    measure: Vec<f32>,
    cost: Vec<f32>,
    variance: Vec<f32>,
}

impl Images {
    /// Each channel of each node.
    fn channels(prepared: &Prepared) -> Self {
        let n = prepared.channels;
        let unit: Vec<f64> = (0..n * n)
            .map(|i| f64::from(u8::from(i / n == i % n)))
            .collect();
        let mut images = Self::of_basis(prepared, &unit, n);
        // Exact: noise and all.
        images.images.iter_mut().for_each(|i| i.variance.fill(0.0));
        images
    }

    /// The principal components of the channels, the same for all nodes.
    fn components(prepared: &Prepared) -> Self {
        let n = prepared.channels;
        let mut gram = vec![0.0; n * n];
        for (node, weight) in prepared.node_weight.iter().enumerate() {
            for i in 0..n {
                for j in 0..=i {
                    let (a, b) = (&prepared.maps[node * n + i], &prepared.maps[node * n + j]);
                    let terms = a.iter().zip(b).zip(&prepared.cost);
                    let sum: f64 = terms.map(|((a, b), c)| f64::from(a * b * c)).sum();
                    gram[i * n + j] += weight * sum;
                }
            }
        }
        for i in 0..n {
            for j in i + 1..n {
                gram[i * n + j] = gram[j * n + i];
            }
        }
        let (values, vectors) = symmetric(&gram, n);
        // What lies below a thousandth of the error that one aims at is rounding or noise.
        let keep = values.iter().filter(|&&v| v > 1e-7 * n as f64).count();
        Self::of_basis(prepared, &vectors, keep.max(1))
    }

    /// * `basis`: orthonormal rows over the channels.
    fn of_basis(prepared: &Prepared, basis: &[f64], keep: usize) -> Self {
        let n = prepared.channels;
        let rows: Vec<(usize, usize)> = (0..prepared.thetas.len())
            .flat_map(|node| (0..keep).map(move |k| (node, k)))
            .collect();
        let images = rows.par_iter().map(|&(node, k)| {
            let (mut values, mut deviation) = (
                vec![0.0f32; prepared.layout.len()],
                vec![0.0f32; prepared.layout.len()],
            );
            for c in 0..n {
                let w = basis[k * n + c] as f32;
                let (map, noise) = (
                    &prepared.maps[node * n + c],
                    &prepared.variance[node * n + c],
                );
                for (i, (value, deviation)) in values.iter_mut().zip(&mut deviation).enumerate() {
                    *value += w * map[i];
                    // The same photons made all channels: their noise adds up, not its squares.
                    *deviation += w * noise[i].sqrt();
                }
            }
            let weight = prepared.node_weight[node] as f32;
            Image {
                values,
                measure: prepared.measure.clone(),
                cost: prepared.cost.iter().map(|c| c * weight).collect(),
                variance: deviation.into_iter().map(|d| d * d).collect(),
            }
        });
        let mix = (0..n).flat_map(|c| {
            let scale = prepared.scale[c];
            (0..keep).map(move |k| (basis[k * n + c] * scale) as f32)
        });
        Self {
            aligned: false,
            count: keep,
            side: prepared.layout.res,
            mix: mix.collect(),
            images: images.collect(),
        }
    }

    /// The factors of all maps.
    fn aligned(prepared: &Prepared, rank: usize) -> Self {
        let n = prepared.channels;
        let importance: Vec<f64> = (0..prepared.maps.len())
            .map(|row| {
                let node = row / n;
                let cosine = prepared.thetas[node].cos().max(0.292);
                prepared.node_weight[node].sqrt() / cosine.powf(1.5)
            })
            .collect();
        let rows = Rows {
            layout: prepared.layout,
            thetas: &prepared.thetas,
            maps: &prepared.maps,
            importance: &importance,
        };
        let mut factors = Factors::new(&rows, rank);
        let grid = factors.grid;
        let count = factors.images.len();
        // Images of a root mean square of 1, so that half floats hold them.
        for k in 0..count {
            let image = &mut factors.images[k];
            let square: f64 = image.iter().map(|&x| f64::from(x).powi(2)).sum();
            let unit = ((square / image.len() as f64).sqrt() as f32).max(f32::MIN_POSITIVE);
            image.iter_mut().for_each(|x| *x /= unit);
            factors
                .weights
                .iter_mut()
                .skip(k)
                .step_by(count)
                .for_each(|w| *w *= unit);
        }
        let images = factors
            .images
            .par_iter()
            .enumerate()
            .map(|(k, values)| Image {
                values: values.clone(),
                measure: vec![1.0; grid.len()],
                cost: cell_costs(prepared, grid, |row| factors.weights[row * count + k]),
                variance: vec![0.0; grid.len()],
            });
        let images = images.collect();
        let weights = factors.weights.iter().enumerate();
        let mix = weights.map(|(i, w)| (f64::from(*w) * prepared.scale[i / count % n]) as f32);
        Self {
            aligned: true,
            count,
            side: grid.columns,
            mix: mix.collect(),
            images,
        }
    }

    fn code(&self, prepared: &Prepared, trees: Trees) -> Code {
        Code {
            layout: prepared.layout,
            aligned: self.aligned,
            images: self.count,
            mix: self.mix.clone(),
            trees,
        }
    }

    /// Trees at a price, and the estimate of their squared error.
    fn trees(&self, price: f64) -> (Trees, f64) {
        let all: Vec<(Trees, f64)> = self
            .images
            .par_iter()
            .map(|image| {
                let mut trees = Trees::default();
                let error = trees.prune(
                    &Tiles {
                        side: self.side,
                        values: &image.values,
                        measure: &image.measure,
                        cost: &image.cost,
                        variance: &image.variance,
                    },
                    price,
                );
                (trees, error)
            })
            .collect();
        let mut sum = (Trees::default(), 0.0);
        for (trees, error) in all {
            sum.0.bits.extend(trees.bits);
            sum.0.leaves.extend(trees.leaves);
            sum.1 += error;
        }
        sum
    }

    /// The trees of least error whose file has at most so many bytes, if any; leaves shortened to
    /// `mantissa` bits.
    fn within(
        &self,
        packed: &mut PackedTable,
        bytes: usize,
        mantissa: u32,
    ) -> Result<Option<(f64, Trees)>, TableError> {
        let [mut low, mut high] = PRICES.map(f64::ln);
        let mut best = None;
        for step in 0..=STEPS {
            // The dearest first: if that does not fit, nothing does.
            let price = if step == 0 { high } else { 0.5 * (low + high) };
            let (mut trees, error) = self.trees(price.exp());
            // Before any bytes are made: no value has ever taken less than two bits.
            let hopeless = trees.leaves.len() / 4 > bytes;
            shorten(&mut trees.leaves, mantissa);
            packed.code.trees = trees;
            if hopeless || exr::encode_packed(packed, Path::new("size"))?.len() > bytes {
                if step == 0 {
                    return Ok(None);
                }
                low = price;
            } else {
                high = price;
                // Rounding to m bits leaves a relative deviation of 2^-m / sqrt(24) or so.
                let rounding = (0.5f64).powi(2 * mantissa as i32) / 24.0 * self.mix_channels();
                let trees = std::mem::take(&mut packed.code.trees);
                best = Some((error + rounding, trees));
            }
        }
        Ok(best)
    }

    /// Channels, each of which has a squared norm of 1.
    fn mix_channels(&self) -> f64 {
        (self.mix.len() / self.count) as f64
    }
}

/// What errors of an image's cells count: through all rows in which it takes part.
fn cell_costs(prepared: &Prepared, grid: Grid, weight: impl Fn(usize) -> f32) -> Vec<f32> {
    let n = prepared.channels;
    let cell = (std::f64::consts::TAU / grid.rows as f64).powi(2);
    let of_row = |row: usize| {
        let x = ((row as f64 + 0.5) / grid.rows as f64 * 2.0 - 1.0) * std::f64::consts::PI;
        let mut sum = 0.0;
        for (node, theta) in prepared.thetas.iter().enumerate() {
            let inclination = x - theta;
            if inclination.abs() >= std::f64::consts::FRAC_PI_2 {
                continue;
            }
            // Density is the image over a cosine, S over one more; a cell has cosine times its area.
            let cosine = inclination.cos();
            let s = cosine.max(0.292).powi(2) * cosine;
            for c in 0..n {
                let w = f64::from(weight(node * n + c));
                sum += prepared.node_weight[node] * w * w * cell / s.max(0.01);
            }
        }
        // Folded maps count both halves elsewhere; here the scale does not matter but among images.
        sum as f32
    };
    (0..grid.rows)
        .flat_map(|row| std::iter::repeat_n(of_row(row), grid.columns))
        .collect()
}

/// Rounds values to half floats of `mantissa` bits, 1..=10.
fn shorten(values: &mut [f32], mantissa: u32) {
    let drop = 10 - mantissa;
    for value in values {
        let bits = half(*value).to_bits();
        let round = (1u16 << drop) >> 1;
        let rounded = (bits.saturating_add(round) >> drop) << drop;
        *value = ::exr::prelude::f16::from_bits(rounded).to_f32();
    }
}

/// The nearest half float, finite.
fn half(value: f32) -> ::exr::prelude::f16 {
    ::exr::prelude::f16::from_f32(value.clamp(-65000.0, 65000.0))
}
