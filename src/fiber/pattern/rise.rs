//! The rise of a scale from its base to its free edge, as chords.

use super::{Scale, Shown, Span};

/// A straight piece of the rise; heights in units of the scale height, ways in pitches.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    /// Height that it would have at the base.
    pub(super) level: f64,
    /// Height per pitch.
    pub(super) slope: f64,
    /// Where it ends, from the base; the last one goes on.
    end: f64,
}

/// Height along a scale: `t^p`, straight beyond its ends.
#[derive(Clone, Debug)]
pub(super) struct Rise {
    pub(super) chords: Vec<Chord>,
}

/// Chords of a curved rise: fewer show as facets, more slow photons down.
const CHORDS: usize = 5;

impl Rise {
    /// * `length`: way from base to free edge, pitches.
    pub(super) fn new(exponent: f64, length: f64) -> Self {
        if exponent == 1.0 {
            return Self {
                chords: vec![Chord {
                    level: 0.0,
                    slope: 1.0,
                    end: f64::INFINITY,
                }],
            };
        }
        let height = |t: f64| length * t.powf(exponent);
        let chords = (0..CHORDS)
            .map(|c| {
                let t = [c, c + 1].map(|c| c as f64 / CHORDS as f64);
                let slope = (height(t[1]) - height(t[0])) / (length * (t[1] - t[0]));
                Chord {
                    level: height(t[0]) - slope * length * t[0],
                    slope,
                    end: if c + 1 == CHORDS {
                        f64::INFINITY
                    } else {
                        length * t[1]
                    },
                }
            })
            .collect();
        Self { chords }
    }

    /// With the bare shaft at the foot of the scale.
    pub(super) fn on_shaft(mut self) -> Self {
        let shaft = Chord {
            level: 0.0,
            slope: 0.0,
            end: 0.0,
        };
        self.chords.insert(0, shaft);
        self
    }

    /// Height at `t` pitches from the base.
    pub(super) fn at(&self, t: f64) -> f64 {
        let chord = self.chords.iter().find(|c| t < c.end);
        chord.map_or(0.0, |c| c.level + c.slope * t)
    }

    /// The tiles that show on a line: `shown` cut at the ends of the chords, all in pitches.
    pub(super) fn cut(&self, shown: &Shown, scales: &[Scale], period: f64) -> Vec<Span> {
        let mut begin = shown.last().map_or(0.0, |&(_, end)| end) - period;
        let mut spans = Vec::new();
        for &(scale, end) in shown {
            for (c, chord) in self.chords.iter().enumerate() {
                let stop = (scales[scale].base + chord.end).min(end);
                if stop > begin {
                    spans.push(Span {
                        tile: (scale * self.chords.len() + c) as u32,
                        end_um: stop,
                    });
                    begin = stop;
                }
            }
        }
        spans
    }
}
