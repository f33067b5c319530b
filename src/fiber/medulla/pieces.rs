//! A medulla in pieces: on and off along the hair with log-normal lengths.

use super::edge::{Edge, Part};
use crate::fiber::convex::{Convex, Plane, Quadric};
use crate::sampling::Rng;
use crate::species::Continuity;
use glam::{DVec2, DVec3};

/// Where the medulla is within one period: intervals of z in order, apart from each other.
#[derive(Clone, Debug)]
pub(in crate::fiber) struct Pieces {
    period: f64,
    spans: Vec<[f64; 2]>,
}

/// Median lengths of pieces and gaps, micrometers, and deviation of their logarithm (estimates; the
/// literature names the types without figures).
const ON_UM: f64 = 60.0;
const SIGMA: f64 = 0.8;
/// Cycles in a period: with one alone every piece would be the same.
const CYCLES: f64 = 2.0;

/// Median length of a gap, if there are any.
fn off_um(continuity: Continuity) -> Option<f64> {
    match continuity {
        Continuity::Continuous => None,
        Continuity::Interrupted => Some(40.0),
        Continuity::Fragmentary => Some(200.0),
    }
}

/// Least length of a period, micrometers.
pub(super) fn least_period_um(continuity: Continuity) -> f64 {
    // The mean of a log-normal is exp(sigma^2 / 2) medians.
    off_um(continuity).map_or(0.0, |off| {
        CYCLES * (ON_UM + off) * (0.5 * SIGMA * SIGMA).exp()
    })
}

impl Pieces {
    /// The pieces of one period; `None` for a medulla that runs through.
    pub(super) fn new(continuity: Continuity, period: f64, seed: u64) -> Option<Self> {
        let off = off_um(continuity)?;
        let cycle = (ON_UM + off) * (0.5 * SIGMA * SIGMA).exp();
        let cycles = (period / cycle).round().max(CYCLES) as u64;
        let lengths: Vec<f64> = (0..cycles)
            .flat_map(|k| {
                let (a, b) = Rng::new(seed ^ 0x7e1e_0000, k).normal_pair();
                // Beyond 1.5 deviations one piece would be all of the period.
                let draw = |median: f64, n: f64| median * (SIGMA * n.clamp(-1.5, 1.5)).exp();
                [draw(ON_UM, a), draw(off, b)]
            })
            .collect();
        let stretch = period / lengths.iter().sum::<f64>();
        let mut z = 0.0;
        let spans = lengths
            .chunks_exact(2)
            .map(|cycle| {
                // Half the gap before the piece: the period does not end in one.
                let begin = z + 0.5 * cycle[1] * stretch;
                z += (cycle[0] + cycle[1]) * stretch;
                [begin, begin + cycle[0] * stretch]
            })
            .collect();
        Some(Self { period, spans })
    }

    /// Intervals of one period.
    pub(super) fn spans(&self) -> &[[f64; 2]] {
        &self.spans
    }

    /// The pieces as rods with round ends, in parts that overlap, each shorter than half a period.
    pub(super) fn rods(&self, semi: DVec2) -> Vec<Convex> {
        let outline = Quadric::ellipsoid(DVec3::ZERO, semi.extend(f64::INFINITY));
        let disc = |half: f64| Convex {
            half: semi.extend(half),
            quadrics: vec![outline],
            ..Convex::default()
        };
        self.stacked(semi, &[&disc])
    }

    /// As much of what an edge holds.
    pub(super) fn rods_within(&self, edge: &Edge) -> Vec<Convex> {
        let parts = edge.parts();
        let disc = |part: &Part, half: f64| Convex {
            half: part.half.extend(half),
            planes: part.planes(DVec2::ZERO),
            ..Convex::default()
        };
        let discs: Vec<_> = parts
            .iter()
            .map(|part| move |half| disc(part, half))
            .collect();
        let discs: Vec<&dyn Fn(f64) -> Convex> = discs.iter().map(|d| d as _).collect();
        let reach = parts
            .iter()
            .fold(DVec2::ZERO, |all, part| all.max(part.half));
        self.stacked(reach, &discs)
    }

    /// Discs of given half height, one upon the other, within a spindle that rounds the ends of a piece.
    ///
    /// * `semi`: semi-axes of the discs.
    fn stacked(&self, semi: DVec2, discs: &[&dyn Fn(f64) -> Convex]) -> Vec<Convex> {
        const OVERLAP_UM: f64 = 0.5;
        // Thickness of the spindle over that of the piece: at 1 a piece is a lens all over, at much
        // more its ends are as good as flat, which no micrograph shows.
        const SPINDLE: f64 = 1.25;
        let mut all = Vec::new();
        for &[z0, z1] in &self.spans {
            let count = (4.0 * (z1 - z0) / self.period).ceil().max(1.0);
            let step = (z1 - z0) / count;
            let middle = 0.5 * (z0 + z1);
            let spindle = (SPINDLE * semi).extend(0.5 * (z1 - z0));
            for k in 0..count as u32 {
                let begin = z0 + f64::from(k) * step;
                let end = (begin + step + OVERLAP_UM).min(z1);
                let half = 0.5 * (end - begin);
                let plane = |normal| Plane {
                    normal,
                    offset: half,
                };
                for disc in discs {
                    let mut disc = disc(half);
                    disc.center = DVec3::Z * (begin + half);
                    disc.planes.extend([plane(DVec3::Z), plane(DVec3::NEG_Z)]);
                    let seen = DVec3::Z * middle - disc.center;
                    disc.quadrics.push(Quadric::ellipsoid(seen, spindle));
                    all.push(disc);
                }
            }
        }
        all
    }

    /// Whether the medulla is there.
    pub(super) fn holds(&self, z: f64) -> bool {
        let z = z.rem_euclid(self.period);
        self.spans.iter().any(|s| s[0] <= z && z < s[1])
    }

    /// Share of the length from `z0` to `z1` that is medulla.
    pub(in crate::fiber) fn share(&self, z0: f64, z1: f64) -> f64 {
        let length = z1 - z0;
        if length.abs() < 1e-9 {
            return f64::from(u8::from(self.holds(0.5 * (z0 + z1))));
        }
        (self.up_to(z1) - self.up_to(z0)) / length
    }

    /// Medulla from 0 to `z`.
    fn up_to(&self, z: f64) -> f64 {
        let whole = (z / self.period).floor();
        let rest = z - whole * self.period;
        let below = |z: f64| -> f64 {
            self.spans
                .iter()
                .map(|s| (z.min(s[1]) - s[0]).max(0.0))
                .sum()
        };
        whole * below(self.period) + below(rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fiber::convex;

    #[test]
    fn pieces_have_the_lengths_of_their_kind() {
        for (continuity, expected) in [
            (Continuity::Interrupted, 60.0 / 100.0),
            (Continuity::Fragmentary, 60.0 / 260.0),
        ] {
            let period = least_period_um(continuity);
            let mut share = 0.0;
            for seed in 0..400 {
                let pieces = Pieces::new(continuity, period, seed).unwrap();
                assert_eq!(pieces.spans().len(), 2);
                assert!(pieces.spans().iter().all(|s| s[0] < s[1]));
                assert!(pieces.spans()[0][1] < pieces.spans()[1][0]);
                assert!(pieces.spans()[1][1] < period);
                share += pieces.share(0.0, period) / 400.0;
                // The integral agrees with the intervals, over the seam too.
                let n = 2000;
                let (z0, z1) = (-0.7 * period, 1.6 * period);
                let step = (z1 - z0) / f64::from(n);
                let sum = (0..n)
                    .filter(|&i| pieces.holds(z0 + (f64::from(i) + 0.5) * step))
                    .count();
                assert!((pieces.share(z0, z1) - sum as f64 / f64::from(n)).abs() < 0.01);
            }
            assert!((share - expected).abs() < 0.04, "{share} {expected}");
        }
    }

    /// Full in the middle, a point at the ends: isolated lenses, as micrographs have them.
    #[test]
    fn pieces_have_round_ends() {
        let period = least_period_um(Continuity::Fragmentary);
        let pieces = Pieces::new(Continuity::Fragmentary, period, 5).unwrap();
        let semi = DVec2::new(12.0, 9.0);
        let rods = pieces.rods(semi);
        let holds = |p: DVec3| {
            (rods.iter()).any(|rod| convex::holds(p - rod.center, &rod.planes, &rod.quadrics))
        };
        for &[z0, z1] in pieces.spans() {
            let (middle, half) = (0.5 * (z0 + z1), 0.5 * (z1 - z0));
            for along in [-0.99, -0.8, -0.5, 0.0, 0.5, 0.8, 0.99_f64] {
                let radius = (1.25 * (1.0 - along * along).sqrt()).min(1.0);
                for turn in 0..8 {
                    let azimuth = f64::from(turn).to_radians() * 45.0;
                    let at = |r: f64| {
                        let across = r * semi * DVec2::from_angle(azimuth);
                        holds(across.extend(middle + along * half))
                    };
                    assert!(at(0.98 * radius), "{along}");
                    assert!(!at(1.02 * radius), "{along}");
                }
            }
        }
    }
}
