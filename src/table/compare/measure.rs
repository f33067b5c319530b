//! The sums behind a comparison, one row a query inclination.

use super::Difference;
use super::side::Side;
use crate::math::frame;
use crate::math::unicube::Unicube;
use crate::table::taps::{Taps, cosine_integrals};
use glam::DVec3;
use rayon::prelude::*;

/// Queries of the common grid. The nodes of a 16-node table are 11 degrees apart: this many put four
/// or more between two of them.
const QUERIES: usize = 64;

/// Sums over the directions of one query, weighted by their solid angles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sums {
    /// Of `(S_a - S_b)^2`.
    difference: f64,
    /// Of `S_b^2`.
    square: f64,
    /// Of the variances of `S_a` and `S_b`.
    variance: [f64; 2],
    /// Largest `S_b`.
    pub(super) peak: f64,
    /// Largest `|S_a - S_b|`, and inclination and azimuth where it is, radians.
    pub(super) largest: [f64; 3],
}

impl Sums {
    fn add(&mut self, w: DVec3, weight: f64, a: (f64, f64), b: (f64, f64)) {
        let off = a.0 - b.0;
        self.difference += weight * off * off;
        self.square += weight * b.0 * b.0;
        self.variance[0] += weight * a.1;
        self.variance[1] += weight * b.1;
        self.peak = self.peak.max(b.0);
        if off.abs() > self.largest[0] {
            self.largest = [off.abs(), frame::theta_of(w), w.y.atan2(w.x)];
        }
    }

    fn scaled(self, weight: f64) -> Self {
        Self {
            difference: weight * self.difference,
            square: weight * self.square,
            variance: self.variance.map(|v| weight * v),
            ..self
        }
    }

    pub(super) fn total<'a>(all: impl Iterator<Item = &'a Self>) -> Self {
        all.fold(Self::default(), |sum, one| Self {
            difference: sum.difference + one.difference,
            square: sum.square + one.square,
            variance: [0, 1].map(|i| sum.variance[i] + one.variance[i]),
            peak: sum.peak.max(one.peak),
            largest: if one.largest[0] > sum.largest[0] {
                one.largest
            } else {
                sum.largest
            },
        })
    }

    pub(super) fn difference(&self) -> Difference {
        let noise = self.variance[0] + self.variance[1];
        // Where noise is all there is, the reference's own square may be no more than its variance.
        let truth = (self.square - self.variance[1]).max(0.1 * self.square);
        let relative = |part: f64, whole: f64| {
            if part > 0.0 {
                (part / whole).sqrt()
            } else {
                0.0
            }
        };
        Difference {
            error: relative(self.difference, self.square),
            noise: relative(noise, self.square),
            debiased: relative(self.difference - noise, truth),
        }
    }
}

/// One query inclination.
pub(super) struct Row {
    pub(super) theta: f64,
    /// Per channel.
    pub(super) sums: Vec<Sums>,
    /// Per channel, of `a` and `b`.
    pub(super) albedo: Vec<[f64; 2]>,
}

/// The rows below an inclination, and whether they are nodes compared texel by texel.
pub(super) fn rows(a: &Side<'_>, b: &Side<'_>, limit: f64) -> (bool, Vec<Row>) {
    let alike = |x: &[f64], y: &[f64]| {
        x.len() == y.len() && x.iter().zip(y).all(|(x, y)| (x - y).abs() < 1e-9)
    };
    let (na, nb) = (a.table.nodes(), b.table.nodes());
    let by_texel = na.mode == nb.mode
        && alike(&na.edges, &nb.edges)
        && alike(&na.centers, &nb.centers)
        && a.cube.res() == b.cube.res();
    let rows = if by_texel {
        let cosines = cosine_integrals(&b.cube);
        let nodes = (0..nb.len()).filter(|&n| nb.centers[n].abs() < limit);
        let nodes: Vec<usize> = nodes.collect();
        let row = |&node: &usize| texel_row(a, b, &cosines, node, limit);
        nodes.par_iter().map(row).collect()
    } else {
        let finest = Unicube::new(a.cube.res().max(b.cube.res()));
        let row = |i: usize| {
            let place = 2.0 * (i as f64 + 0.5) / QUERIES as f64 - 1.0;
            grid_row(a, b, &finest, (place * limit.sin()).asin(), limit)
        };
        (0..QUERIES).into_par_iter().map(row).collect()
    };
    (by_texel, rows)
}

fn texel_row(a: &Side<'_>, b: &Side<'_>, cosines: &[f64], node: usize, limit: f64) -> Row {
    let nodes = b.table.nodes();
    let solid_angle = nodes.edges[node + 1].sin() - nodes.edges[node].sin();
    let channels = 0..b.channels.len();
    let sums = channels.clone().map(|c| {
        let mut sums = Sums::default();
        for (texel, &cosine) in cosines.iter().enumerate() {
            let (w, _) = b.cube.direction(texel, 0.5, 0.5);
            if frame::theta_of(w).abs() < limit {
                let s = |(flux, variance): (f64, f64)| (flux / cosine, variance / cosine.powi(2));
                let (sa, sb) = (s(a.flux(c, node, texel)), s(b.flux(c, node, texel)));
                sums.add(w, b.cube.solid_angle(texel), sa, sb);
            }
        }
        sums.scaled(solid_angle)
    });
    Row {
        theta: nodes.centers[node],
        sums: sums.collect(),
        albedo: channels
            .map(|c| [a, b].map(|side| side.table.albedo(node, side.channels[c])))
            .collect(),
    }
}

fn grid_row(a: &Side<'_>, b: &Side<'_>, grid: &Unicube, theta: f64, limit: f64) -> Row {
    let mut sums = vec![Sums::default(); b.channels.len()];
    for texel in 0..grid.texels() {
        let (w, _) = grid.direction(texel, 0.5, 0.5);
        let inclination = frame::theta_of(w);
        if inclination.abs() >= limit {
            continue;
        }
        let cosine = inclination.cos();
        let taps = [a, b].map(|side| Taps::new(side.table.nodes(), &side.cube, theta, w));
        let look_up = |side: &Side<'_>, taps: &Taps, channel: usize| {
            taps.iter().fold((0.0, 0.0), |(s, variance), tap| {
                let (f, v) = side.flux(channel, tap.node, tap.texel);
                let weight = tap.weight / cosine;
                (s + weight * f, variance + weight * weight * v)
            })
        };
        for (c, sums) in sums.iter_mut().enumerate() {
            let (sa, sb) = (look_up(a, &taps[0], c), look_up(b, &taps[1], c));
            sums.add(w, grid.solid_angle(texel), sa, sb);
        }
    }
    let albedo = |side: &Side<'_>, channel: usize| {
        let (lo, hi, share) = side.table.nodes().bracket(theta);
        let at = |node: usize| side.table.albedo(node, side.channels[channel]);
        (1.0 - share) * at(lo) + share * at(hi)
    };
    Row {
        theta,
        albedo: (0..sums.len())
            .map(|c| [a, b].map(|side| albedo(side, c)))
            .collect(),
        sums,
    }
}
