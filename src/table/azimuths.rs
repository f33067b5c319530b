//! The query azimuths at which a table holds maps: one bin for all, or several for flat fibers.

use crate::math::symmetry::Symmetry;
use std::f64::consts::TAU;

/// Bins of query azimuth, even over what [`Symmetry`] leaves of the turn. The first begins at its
/// lower end; a bin's map is the mean over it and stands for its middle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Azimuths {
    /// Number of bins; 1 averages the azimuth away.
    pub count: usize,
    /// What the fiber's section makes the same.
    pub symmetry: Symmetry,
}

/// A bin to look in: its number, whether directions are to be mirrored, `phi -> -phi`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AzimuthBin {
    /// Number of the bin.
    pub bin: usize,
    /// Whether the map is read at `-phi`.
    pub mirrored: bool,
}

impl Azimuths {
    /// All azimuths in one bin: tables of round fibers, and of all fibers far away.
    pub const AVERAGED: Self = Self {
        count: 1,
        symmetry: Symmetry::None,
    };

    /// Whether the azimuth of the query does not matter.
    pub fn is_averaged(&self) -> bool {
        self.count == 1
    }

    /// Bounds of a bin, turns from the major axis.
    pub fn range_turns(&self, bin: usize) -> [f64; 2] {
        let [from, to] = self.symmetry.range_turns();
        let at = |i: usize| from + (to - from) * i as f64 / self.count as f64;
        [at(bin), at(bin + 1)]
    }

    /// Bounds and middle of a bin, radians from the major axis.
    pub fn range(&self, bin: usize) -> [f64; 3] {
        let [from, to] = self.range_turns(bin);
        [from, to, 0.5 * (from + to)].map(|turns| turns * TAU)
    }

    /// The bin that holds an azimuth, radians.
    pub fn bin(&self, azimuth: f64) -> AzimuthBin {
        let (folded, mirrored) = self.symmetry.fold(azimuth);
        let [from, to] = self.symmetry.range_turns();
        let x = (folded / TAU - from) / (to - from) * self.count as f64;
        AzimuthBin {
            bin: (x.max(0.0) as usize).min(self.count - 1),
            mirrored,
        }
    }

    /// The two bins between whose middles an azimuth lies, radians, and the share of the second. Beyond
    /// the ends of the range they are mirror images of the bins inside.
    pub fn bracket(&self, azimuth: f64) -> (AzimuthBin, AzimuthBin, f64) {
        let first = AzimuthBin {
            bin: 0,
            mirrored: false,
        };
        if self.is_averaged() {
            return (first, first, 0.0);
        }
        let [from, to] = self.symmetry.range_turns();
        let width = (to - from) / self.count as f64;
        let x = (azimuth / TAU - from) / width - 0.5;
        let middle = |k: f64| self.bin((from + (k + 0.5) * width) * TAU);
        (middle(x.floor()), middle(x.floor() + 1.0), x - x.floor())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Symmetry; 3] = [Symmetry::None, Symmetry::MinorAxis, Symmetry::BothAxes];

    #[test]
    fn bins_hold_their_middles_and_brackets_interpolate() {
        for symmetry in ALL {
            for count in [2, 5, 8] {
                let azimuths = Azimuths { count, symmetry };
                for bin in 0..count {
                    let [from, to, middle] = azimuths.range(bin);
                    assert!(from < middle && middle < to);
                    assert_eq!(
                        azimuths.bin(middle),
                        AzimuthBin {
                            bin,
                            mirrored: false
                        }
                    );
                }
                for i in -500..500 {
                    let azimuth = 0.013 * f64::from(i);
                    let (a, b, share) = azimuths.bracket(azimuth);
                    assert!((0.0..1.0).contains(&share));
                    // What varies as the azimuth does, up to symmetry, is read as it is at middles.
                    let value = |at: AzimuthBin| azimuths.range(at.bin)[2];
                    if a.mirrored == b.mirrored && (value(a) - value(b)).abs() < 2.0 {
                        let (folded, _) = symmetry.fold(azimuth);
                        let read = (1.0 - share) * value(a) + share * value(b);
                        assert!((read - folded).abs() < 1e-9, "{azimuths:?} {azimuth}");
                    } else if symmetry != Symmetry::None {
                        // Across a mirror plane lies the same bin.
                        assert_eq!(a.bin, b.bin, "{azimuths:?} {azimuth}");
                        assert_ne!(a.mirrored, b.mirrored);
                    }
                }
            }
        }
    }

    #[test]
    fn one_bin_is_all_azimuths() {
        let (a, b, share) = Azimuths::AVERAGED.bracket(2.0);
        assert!(a == b && share == 0.0 && !a.mirrored);
        assert_eq!(Azimuths::AVERAGED.range_turns(0), [0.0, 1.0]);
    }
}
