//! A table as means over bins of directions: what models are fitted to.

use crate::math::frame;
use crate::math::unicube::Unicube;
use crate::table::TableRef;
use std::f64::consts::{FRAC_PI_2, PI};

/// Inclinations of query and direction that take part, radians: as in comparisons.
const LIMIT: f64 = 73.0 * PI / 180.0;

/// Rows of 2 degrees: half the width of the sharpest lobe that hair shaders are used with.
const ROWS: usize = 90;

/// Columns of 5 degrees over one half; the other is its mirror image.
pub(super) const COLUMNS: usize = 36;

/// Points along each axis of a texel by which its flux is shared among bins.
const POINTS: usize = 4;

/// Mean densities `S cos(theta)` of some channels.
#[derive(Clone, Debug)]
pub(super) struct Data {
    /// Query inclinations, radians.
    pub(super) queries: Vec<f64>,
    /// Inclinations of the bins' lower edges and one more; radians.
    pub(super) edges: Vec<f64>,
    /// `density[channel][(query * rows + row) * COLUMNS + column]`.
    pub(super) density: Vec<Vec<f64>>,
    /// `weight[query * rows + row]`: what squared errors count, so that errors of S count evenly.
    pub(super) weight: Vec<f64>,
    /// Per channel, the weighted sum of squares.
    pub(super) square: Vec<f64>,
    /// Share of even light that each query stands for; they add up to 1.
    pub(super) seen: Vec<f64>,
    /// Per channel, the share of even light that is scattered.
    pub(super) albedo: Vec<f64>,
}

impl Data {
    pub(super) fn rows(&self) -> usize {
        self.edges.len() - 1
    }

    /// * `channels`: levels or colors.
    pub(super) fn new(table: TableRef<'_>, channels: &[usize]) -> Self {
        let nodes = table.nodes();
        let used: Vec<usize> = (0..nodes.len())
            .filter(|&n| nodes.centers[n].abs() < LIMIT)
            .collect();
        let step = PI / ROWS as f64;
        let first = ((FRAC_PI_2 - LIMIT) / step).ceil() as usize;
        let edges: Vec<f64> = (first..=ROWS - first)
            .map(|i| i as f64 * step - FRAC_PI_2)
            .collect();
        let rows = edges.len() - 1;
        let column = PI / COLUMNS as f64;
        let mut data = Self {
            queries: used.iter().map(|&n| nodes.centers[n]).collect(),
            weight: used
                .iter()
                .flat_map(|&n| {
                    let node = nodes.edges[n + 1].sin() - nodes.edges[n].sin();
                    edges.windows(2).map(move |e| {
                        let cosine = (0.5 * (e[0] + e[1])).cos();
                        node * 2.0 * column * (e[1].sin() - e[0].sin()) / (cosine * cosine)
                    })
                })
                .collect(),
            density: Vec::new(),
            square: Vec::new(),
            seen: shares(&used, |n| {
                let sines = nodes.edges[n + 1].sin() - nodes.edges[n].sin();
                nodes.centers[n].cos() * sines
            }),
            albedo: Vec::new(),
            edges,
        };
        let bins = bins(table.res(), &data.edges);
        // Points lie in rows of their own; what they stand for, not the exact size of a bin, divides, or
        // the two would beat.
        let cube = Unicube::new(table.res());
        let mut measure = vec![0.0; rows * COLUMNS];
        for (i, bin) in bins.iter().enumerate() {
            if let Some(bin) = bin {
                let solid_angle = cube.solid_angle(i / (POINTS * POINTS));
                measure[*bin] += solid_angle / (POINTS * POINTS) as f64;
            }
        }
        for &channel in channels {
            let flux = table.channel(channel).unwrap_or_default();
            let texels = 6 * table.res() * table.res();
            let mut density = vec![0.0; used.len() * rows * COLUMNS];
            for (query, &node) in used.iter().enumerate() {
                let out = &mut density[query * rows * COLUMNS..(query + 1) * rows * COLUMNS];
                for (i, bin) in bins.iter().enumerate() {
                    if let Some(bin) = bin {
                        let f = flux[node * texels + i / (POINTS * POINTS)];
                        out[*bin] += f64::from(f) / (POINTS * POINTS) as f64;
                    }
                }
                for (d, m) in out.iter_mut().zip(&measure) {
                    *d /= f64::max(*m, f64::MIN_POSITIVE);
                }
            }
            let terms = density.iter().enumerate();
            let square = terms
                .map(|(i, d)| data.weight[i / COLUMNS] * d * d)
                .sum::<f64>();
            data.square.push(square.max(f64::MIN_POSITIVE));
            let scattered = used.iter().zip(&data.seen).map(|(&n, seen)| {
                let flux = &flux[n * texels..(n + 1) * texels];
                seen * flux.iter().map(|&f| f64::from(f)).sum::<f64>()
            });
            data.albedo.push(scattered.sum());
            data.density.push(density);
        }
        data
    }
}

/// Weights of nodes as shares of their sum.
fn shares(nodes: &[usize], weight: impl Fn(usize) -> f64) -> Vec<f64> {
    let all: f64 = nodes.iter().map(|&n| weight(n)).sum();
    nodes.iter().map(|&n| weight(n) / all).collect()
}

/// For every point of every texel the bin that holds it.
fn bins(res: usize, edges: &[f64]) -> Vec<Option<usize>> {
    let cube = Unicube::new(res);
    let at = |i: usize| (i as f64 + 0.5) / POINTS as f64;
    let step = edges[1] - edges[0];
    let point = |i: usize| {
        let (texel, point) = (i / (POINTS * POINTS), i % (POINTS * POINTS));
        let (w, _) = cube.direction(texel, at(point % POINTS), at(point / POINTS));
        let row = ((frame::theta_of(w) - edges[0]) / step).floor();
        let column = (w.y.atan2(w.x).abs() / PI * COLUMNS as f64) as usize;
        let inside = row >= 0.0 && (row as usize) < edges.len() - 1;
        inside.then(|| row as usize * COLUMNS + column.min(COLUMNS - 1))
    };
    (0..cube.texels() * POINTS * POINTS).map(point).collect()
}
