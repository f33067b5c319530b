//! The inclinations, and azimuths where they matter, at which a table holds maps.

use super::Azimuths;
use crate::math::frame;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, PI};

/// How query directions map to nodes, and in which frame photons are deposited.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// As published: constant bins over the polar angle, `j = floor(N alpha / pi)`; photons in the
    /// frame of the fiber; at most 16 events.
    Paper,
    /// Nodes denser toward grazing; photons in the frame that follows the specular cone,
    /// `theta_o' = theta_o + (theta_q - theta_node)`; interpolated at look-up.
    Cone,
}

/// The nodes of a table: bin `j` covers inclinations `edges[j] .. edges[j + 1]`, ascending, and is
/// represented by `centers[j]`. Radians.
///
/// Each bin of azimuth has all inclinations: node `n` is inclination `n % centers.len()` of azimuth
/// `n / centers.len()`. Nearly all tables have one bin for all azimuths.
#[derive(Clone, Debug, PartialEq)]
pub struct Nodes {
    /// How the nodes are used.
    pub mode: Mode,
    /// Bin boundaries, one more than bins, from -pi/2 to pi/2.
    pub edges: Vec<f64>,
    /// The inclination that stands for each bin.
    pub centers: Vec<f64>,
    /// Bins of the query's azimuth.
    pub azimuths: Azimuths,
}

impl Nodes {
    /// * `bins`: 2..=256.
    ///
    /// In paper mode node `j` is the paper's bin `bins - 1 - j`: the paper counts from the tip, nodes
    /// ascend in theta; file parts keep the paper's count.
    pub fn new(mode: Mode, bins: usize) -> Self {
        let at = |v: f64| match mode {
            Mode::Paper => (v - 0.5) * PI,
            Mode::Cone => grazing_warp(v),
        };
        let edges: Vec<f64> = (0..=bins).map(|i| at(i as f64 / bins as f64)).collect();
        let centers = (0..bins)
            .map(|i| at((i as f64 + 0.5) / bins as f64))
            .collect();
        Self {
            mode,
            edges,
            centers,
            azimuths: Azimuths::AVERAGED,
        }
    }

    /// The same inclinations at each of some azimuths.
    pub fn at_azimuths(self, azimuths: Azimuths) -> Self {
        Self { azimuths, ..self }
    }

    /// Number of nodes, of all azimuths.
    pub fn len(&self) -> usize {
        self.centers.len() * self.azimuths.count
    }

    /// Number of bins of inclination.
    pub fn inclinations(&self) -> usize {
        self.centers.len()
    }

    /// The inclination of a node, radians.
    pub fn theta(&self, node: usize) -> f64 {
        self.centers[node % self.centers.len()]
    }

    /// The inclinations that a node covers, from and to, radians.
    pub fn theta_range(&self, node: usize) -> [f64; 2] {
        let bin = node % self.centers.len();
        [self.edges[bin], self.edges[bin + 1]]
    }

    /// The bin of azimuth of a node.
    pub fn azimuth_bin(&self, node: usize) -> usize {
        node / self.centers.len()
    }

    /// Never true of a valid table.
    pub fn is_empty(&self) -> bool {
        self.centers.is_empty()
    }

    /// The node that part `bin` of a table file holds: the paper's count in paper mode, else the
    /// node of the same number. Its own inverse.
    pub fn node_of_part(&self, bin: usize) -> usize {
        match self.mode {
            Mode::Paper => self.len() - 1 - bin,
            Mode::Cone => bin,
        }
    }

    /// The bin of inclination that holds `theta`.
    pub fn bin(&self, theta: f64) -> usize {
        match self.mode {
            Mode::Paper => {
                let bins = self.inclinations();
                bins - 1 - frame::paper_bin(theta, bins)
            }
            Mode::Cone => {
                let last = self.inclinations() - 1;
                let above = self.edges[1..=last].partition_point(|&e| e <= theta);
                above.min(last)
            }
        }
    }

    /// The two inclinations between which a look-up at `theta` interpolates, and the share of the second.
    /// Paper mode does not interpolate: the share is 0.
    pub fn bracket(&self, theta: f64) -> (usize, usize, f64) {
        if self.mode == Mode::Paper {
            let j = self.bin(theta);
            return (j, j, 0.0);
        }
        let above = self.centers.partition_point(|&c| c <= theta);
        if above == 0 {
            return (0, 0, 0.0);
        }
        if above == self.inclinations() {
            return (above - 1, above - 1, 0.0);
        }
        let (lo, hi) = (self.centers[above - 1], self.centers[above]);
        (above - 1, above, (theta - lo) / (hi - lo))
    }
}

/// Maps `[0, 1]` to `[-pi/2, pi/2]`, evenly up to 60 degrees and [`GRAZING`] times as dense beyond:
/// there the lobes change fastest.
fn grazing_warp(v: f64) -> f64 {
    const BEND: f64 = 60.0;
    let end = BEND + GRAZING * (90.0 - BEND);
    let x = (2.0 * v - 1.0).abs() * end;
    let degrees = if x <= BEND {
        x
    } else {
        BEND + (x - BEND) / GRAZING
    };
    degrees.to_radians().min(FRAC_PI_2).copysign(v - 0.5)
}

/// Density of nodes near grazing over that in the middle. What 16 nodes leave of error below 73 degrees
/// (human, polar bear, red fox) and below 87 (human), in percent: at 1, 6.6, 3.3, 13 and 22; at 1.5, 6.8,
/// 3.3, 15 and 16; at 2, 7.5, 3.8, 17 and 14.
const GRAZING: f64 = 1.5;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_span_the_sphere_and_bins_contain_their_centers() {
        for mode in [Mode::Paper, Mode::Cone] {
            for bins in [2, 16, 31] {
                let nodes = Nodes::new(mode, bins);
                assert!((nodes.edges[0] + FRAC_PI_2).abs() < 1e-12);
                assert!((nodes.edges[bins] - FRAC_PI_2).abs() < 1e-12);
                for (j, &c) in nodes.centers.iter().enumerate() {
                    assert!(nodes.edges[j] < c && c < nodes.edges[j + 1]);
                    assert_eq!(nodes.bin(c), j);
                }
            }
        }
    }

    #[test]
    fn brackets_interpolate_linearly() {
        let nodes = Nodes::new(Mode::Cone, 16);
        for i in -900..=900 {
            let theta = f64::from(i) / 900.0 * FRAC_PI_2;
            let (a, b, f) = nodes.bracket(theta);
            let c = nodes.centers[a] * (1.0 - f) + nodes.centers[b] * f;
            let clamped = theta.clamp(nodes.centers[0], nodes.centers[15]);
            assert!((c - clamped).abs() < 1e-12, "{theta}");
        }
    }
}
