//! Scale patterns: where on each axial line one scale ends and the next begins.
//!
//! A scale is a flat tile that rises toward the tip with a slope of its own, `height + slope z`; its
//! free edge is the margin where the next scale begins lower down. Along every line the scales follow
//! each other in one global order (rank), so that neighboring lines can be joined. The shapes follow
//! the terms of hair microscopy (Teerink 1991; Deedrick and Koch 2004).

use super::covering::{ascend, envelope, visible};
use super::section::Line;
use crate::sampling::{Rng, hash64};
use crate::species::{Cuticle, CuticlePattern};
use std::f64::consts::TAU;

/// A plane piece of a scale: the height above the shaft is `height_um + slope * z`, micrometers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tile {
    pub(super) height_um: f64,
    pub(super) slope: f64,
}

/// The part of a line that one tile covers; it begins where the previous one ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    /// Index of the tile and rank along the line.
    pub(super) tile: u32,
    /// Upper end, micrometers.
    pub(super) end_um: f64,
}

/// A periodic scale pattern on all lines.
#[derive(Clone, Debug)]
pub(super) struct Pattern {
    pub(super) period_um: f64,
    pub(super) tiles: Vec<Tile>,
    /// For each line its spans in rank order; together they cover one period.
    pub(super) lines: Vec<Vec<Span>>,
}

/// Rows in a period: fewer repeat visibly and blaze like a grating, more leave the cache.
const ROWS: std::ops::RangeInclusive<usize> = 8..=16;
/// A period is about this long where the number of rows allows it, micrometers.
const PERIOD_UM: f64 = 110.0;

/// Everything that the generators share.
struct Builder<'a> {
    cuticle: &'a Cuticle,
    lines: &'a [Line],
    rows: usize,
    around: usize,
    seed: u64,
}

impl Pattern {
    /// Lays out a pattern on `lines`. `Smooth` gives `None`.
    pub(super) fn new(cuticle: &Cuticle, lines: &[Line], seed: u64) -> Option<Self> {
        // Even, because petals and tiles alternate from row to row.
        let rows = (PERIOD_UM / cuticle.pitch_um).ceil() as usize;
        let rows = rows.clamp(*ROWS.start(), *ROWS.end()).next_multiple_of(2);
        let builder = Builder {
            cuticle,
            lines,
            rows,
            around: cuticle.around.max(1) as usize,
            seed,
        };
        let mut pattern = match cuticle.pattern {
            CuticlePattern::Smooth => return None,
            CuticlePattern::Coronal | CuticlePattern::CoronalDentate => builder.coronal(),
            CuticlePattern::Mosaic
            | CuticlePattern::MosaicRippled
            | CuticlePattern::SquatPolygon => builder.mosaic(),
            CuticlePattern::BroadPetal
            | CuticlePattern::DiamondPetal
            | CuticlePattern::LanceolatePetal
            | CuticlePattern::OtterFin
            | CuticlePattern::Pectinate => builder.diamond_petal(),
            _ => builder.irregular_wave(),
        };
        pattern.normalize(cuticle);
        Some(pattern)
    }

    /// Makes the mean slope exactly height over pitch and the mean height zero: random scales
    /// then change neither the mean tilt nor the diameter.
    fn normalize(&mut self, cuticle: &Cuticle) {
        let (mut area, mut slope) = (0.0, 0.0);
        self.for_each_span(|tile, lo, hi| {
            area += hi - lo;
            slope += tile.slope * (hi - lo);
        });
        let scale = cuticle.height_um / cuticle.pitch_um / (slope / area);
        for tile in &mut self.tiles {
            tile.slope *= scale;
            tile.height_um *= scale;
        }
        let mut sum = 0.0;
        self.for_each_span(|tile, lo, hi| {
            sum += (tile.height_um + tile.slope * 0.5 * (lo + hi)) * (hi - lo);
        });
        for tile in &mut self.tiles {
            tile.height_um -= sum / area;
        }
    }

    /// Visits every span with its tile and its ends.
    pub(super) fn for_each_span(&self, mut visit: impl FnMut(&Tile, f64, f64)) {
        for line in &self.lines {
            let mut lo = line.last().map_or(0.0, |s| s.end_um) - self.period_um;
            for span in line {
                visit(&self.tiles[span.tile as usize], lo, span.end_um);
                lo = span.end_um;
            }
        }
    }
}

impl Builder<'_> {
    fn pitch(&self) -> f64 {
        self.cuticle.pitch_um
    }

    fn period(&self) -> f64 {
        self.rows as f64 * self.pitch()
    }

    fn slope(&self) -> f64 {
        self.cuticle.height_um / self.pitch()
    }

    /// Uniform in -1..1 times the jitter, a function of the names only.
    fn jitter(&self, what: u64, index: usize) -> f64 {
        self.cuticle.jitter * self.symmetric(what, index)
    }

    fn symmetric(&self, what: u64, index: usize) -> f64 {
        2.0 * Rng::new(self.seed ^ hash64(what), index as u64).uniform() - 1.0
    }

    /// Value noise round the fiber, -1..1, with `knots` values a turn so that it closes.
    fn noise(&self, what: u64, row: usize, knots: usize, turn: f64) -> f64 {
        let x = turn.rem_euclid(1.0) * knots as f64;
        let cell = x.floor();
        let f = x - cell;
        let knot = |k: usize| self.symmetric(hash64(what) ^ row as u64, k % knots);
        let (a, b) = (knot(cell as usize), knot(cell as usize + 1));
        a + (b - a) * f * f * (3.0 - 2.0 * f)
    }

    /// A flat scale of row `row`: height zero at `base`, slope and level jittered.
    fn scale(&self, base: f64, index: usize) -> Tile {
        // Natural scatter: free edges +-20 % high, levels +-20 %: without it the sides of tiles in
        // one row, where neither lies over the other, would be no edges at all.
        let slope = self.slope() * (1.0 + 0.2 * self.jitter(11, index));
        let lift = 0.2 * self.cuticle.height_um * self.jitter(12, index);
        Tile {
            height_um: lift - slope * base,
            slope,
        }
    }

    /// Rows whose margins are given as curves `margin(row, turn)` over the row's upper end.
    fn with_margins(
        &self,
        tiles: Vec<Tile>,
        bases: &[f64],
        margin: impl Fn(usize, f64) -> f64,
    ) -> Pattern {
        let n = bases.len();
        let period = self.period();
        let lines = self
            .lines
            .iter()
            .map(|line| {
                let ends: Vec<f64> = (0..n).map(|k| bases[k] + margin(k, line.turn)).collect();
                visible(&ends, period)
                    .map(|k| Span {
                        tile: k as u32,
                        end_um: ends[k],
                    })
                    .collect()
            })
            .collect();
        Pattern {
            period_um: period,
            tiles,
            lines,
        }
    }

    /// One scale a row, a stack of paper cups with flared rims.
    fn coronal(&self) -> Pattern {
        /// Chords of the flare `t^1.8`.
        const CHORDS: usize = 5;
        let p = self.pitch();
        let rise = |t: f64| self.cuticle.height_um * t.signum() * t.abs().powf(1.8);
        let (mut tiles, mut bases) = (Vec::new(), Vec::new());
        for row in 0..self.rows {
            let base = p * (row as f64 + 0.08 * self.jitter(1, row));
            let high = 1.0 + 0.2 * self.jitter(2, row);
            for chord in 0..CHORDS {
                let t = [chord, chord + 1].map(|c| c as f64 / CHORDS as f64);
                let slope = high * (rise(t[1]) - rise(t[0])) / ((t[1] - t[0]) * p);
                tiles.push(Tile {
                    height_um: high * rise(t[0]) - slope * (base + t[0] * p),
                    slope,
                });
                bases.push(base + t[1] * p);
            }
        }
        // The last chord of a row ends at the next row's base.
        let next: Vec<f64> = (0..self.rows)
            .map(|row| {
                let wrap = if row + 1 == self.rows {
                    self.period()
                } else {
                    0.0
                };
                bases[((row + 1) % self.rows) * CHORDS] - p / CHORDS as f64 + wrap
            })
            .collect();
        for (row, &end) in next.iter().enumerate() {
            bases[row * CHORDS + CHORDS - 1] = end;
        }
        self.with_margins(tiles, &bases, |k, turn| {
            if k % CHORDS + 1 < CHORDS {
                return 0.0;
            }
            let row = k / CHORDS;
            let phase = TAU * 0.5 * self.symmetric(3, row);
            // A rim is never quite plane; 0.6 um is what the micrographs of underfur show.
            (0.6 * (TAU * turn + phase).sin() + 0.3 * self.noise(4, row, 7, turn))
                .clamp(-0.15 * p, 0.15 * p)
        })
    }

    /// Wavy margins that change from row to row.
    fn irregular_wave(&self) -> Pattern {
        let p = self.pitch();
        let n = self.around as f64;
        let bases: Vec<f64> = (0..self.rows)
            .map(|row| p * (row as f64 + 0.1 * self.jitter(1, row)))
            .collect();
        let tiles = (0..self.rows)
            .map(|k| self.scale(bases[k] - p, k))
            .collect();
        // The phase wanders slowly over the rows and comes back after the period.
        let wander = TAU * (0.9 * self.rows as f64 / TAU).round().max(1.0) / self.rows as f64;
        let jitter = self.cuticle.jitter;
        let coarse_knots = (2.4 * n).round().max(5.0) as usize;
        let fine_knots = (8.0 * n).round().max(12.0) as usize;
        let crenate_knots = (20.0 * n).round().max(24.0) as usize;
        self.with_margins(tiles, &bases, |row, turn| {
            let phase = TAU * n * turn + 1.1 * jitter * (wander * row as f64).sin();
            let wave = 0.42 * phase.sin();
            // The coarse part is shared by three rows with a cross-fade, the fine ones are each row's own.
            let knots = (self.rows / 3).max(1);
            let x = row as f64 * knots as f64 / self.rows as f64;
            let (i, f) = (x.floor() as usize, x.fract());
            let coarse = (1.0 - f) * self.noise(5, i % knots, coarse_knots, turn)
                + f * self.noise(5, (i + 1) % knots, coarse_knots, turn);
            let fine = self.noise(6, row, fine_knots, turn);
            let crenate = self.noise(7, row, crenate_knots, turn);
            p * (wave + jitter * (0.32 * coarse + 0.16 * fine + 0.07 * crenate))
        })
    }

    /// Overlapping rhombic petals, alternate rows set off by half a petal.
    fn diamond_petal(&self) -> Pattern {
        /// Length in pitches, width in petals, where the taper begins, its exponent.
        const LENGTH: f64 = 2.7;
        const WIDTH: f64 = 1.1;
        const WAIST: f64 = 0.45;
        const TAPER: f64 = 1.1;
        let p = self.pitch();
        let n = self.around.max(2);
        let (mut tiles, mut ranks) = (Vec::new(), Vec::new());
        for row in 0..self.rows {
            for i in 0..n {
                let index = row * n + i;
                let base = p * (row as f64 + 0.12 * self.jitter(1, index));
                let shift = 0.5 * (row % 2) as f64 + 0.06 * self.jitter(2, index);
                let length = p * LENGTH * (1.0 + 0.08 * self.jitter(3, index));
                tiles.push(self.scale(base + p, index));
                ranks.push((base, (i as f64 + shift) / n as f64, length));
            }
        }
        self.with_margins(tiles, &vec![0.0; self.rows * n], |k, turn| {
            let (base, center, length) = ranks[k];
            let d = (turn - center + 0.5).rem_euclid(1.0) - 0.5;
            let across = 2.0 * (d * n as f64).abs() / WIDTH;
            if across >= 1.0 {
                return f64::NEG_INFINITY;
            }
            base + length * (WAIST + (1.0 - WAIST) * (1.0 - across).powf(1.0 / TAPER))
        })
    }

    /// Jittered polygons: the Voronoi cells of hexagonal seeds, stretched by the pitch and the width.
    fn mosaic(&self) -> Pattern {
        let p = self.pitch();
        let n = self.around.max(2);
        let mut seeds: Vec<(f64, f64)> = (0..self.rows * n)
            .map(|index| {
                let (row, i) = (index / n, index % n);
                let turn = i as f64 + 0.5 * (row % 2) as f64 + 0.3 * self.jitter(1, index);
                let z = row as f64 + 0.33 * self.jitter(2, index);
                (z, turn)
            })
            .collect();
        seeds.sort_by(|a, b| a.0.total_cmp(&b.0));
        let count = seeds.len();
        let tiles = (0..count).map(|k| self.scale(p * seeds[k].0, k)).collect();
        let rows = self.rows as f64;
        let lines = self
            .lines
            .iter()
            .map(|line| {
                // With equal curvature along z the lower envelope of the squared distances is the
                // upper envelope of straight lines with slopes in seed order.
                let offset = |k: usize| {
                    let d = line.turn * n as f64 - seeds[k].1 + 0.5 * n as f64;
                    (d.rem_euclid(n as f64) - 0.5 * n as f64).powi(2)
                };
                let ripple = |k: usize| self.ripple(k, line.turn);
                envelope(&seeds, rows, offset)
                    .into_iter()
                    .map(|(k, end)| Span {
                        tile: k as u32,
                        end_um: p * (end + ripple(k)),
                    })
                    .collect::<Vec<_>>()
            })
            .map(|mut spans: Vec<Span>| {
                ascend(&mut spans, self.period());
                spans
            })
            .collect();
        Pattern {
            period_um: self.period(),
            tiles,
            lines,
        }
    }

    /// Crenation of tile margins, in pitches.
    fn ripple(&self, tile: usize, turn: f64) -> f64 {
        let knots = (12.0 * self.around as f64).round().max(24.0) as usize;
        self.cuticle.jitter
            * (0.07 * self.noise(8, tile, knots, turn)
                + 0.02 * self.noise(9, tile, 2 * knots, turn))
    }
}
