//! Scale patterns: where on each axial line one scale ends and the next begins.
//!
//! A scale is made of flat tiles that rise toward the tip, each with a slope of its own, `height +
//! slope z`; its free edge is the margin where the next scale begins lower down. Along every line the
//! tiles follow each other in one global order (rank), so that neighboring lines can be joined. The
//! shapes follow the terms of hair microscopy (Teerink 1991; Deedrick and Koch 2004).

mod covering;
mod damage;
mod free_edge;
mod rise;
mod rows;
mod tiles;

use super::section::Line;
use crate::sampling::{Rng, hash64};
use crate::species::{Cuticle, CuticlePattern, PatternLayout, PatternRecipe};
use damage::Lift;
use free_edge::FreeEdge;
use rise::Rise;

/// A plane piece of a scale: the height above the shaft is `height_um + slope * z`, micrometers,
/// before what damage adds.
#[derive(Clone, Copy, Debug)]
struct Tile {
    height_um: f64,
    slope: f64,
    /// The scale it belongs to.
    scale: u32,
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
    tiles: Vec<Tile>,
    /// Raised pieces, in the order of the scales.
    lifts: Vec<Lift>,
    /// For each line its spans in rank order; together they cover one period.
    pub(super) lines: Vec<Vec<Span>>,
    /// Position of each line round the fiber, 0..1.
    turns: Vec<f64>,
}

/// Rows in a period: fewer repeat visibly and blaze like a grating, more leave the cache.
const ROWS: std::ops::RangeInclusive<usize> = 8..=16;
/// A period is about this long where the number of rows allows it, micrometers.
const PERIOD_UM: f64 = 110.0;

/// Everything that the generators share. Lengths along the hair are in pitches.
struct Builder<'a> {
    cuticle: &'a Cuticle,
    recipe: &'a PatternRecipe,
    lines: &'a [Line],
    edge: FreeEdge,
    rows: usize,
    around: usize,
    circumference_um: f64,
    seed: u64,
}

/// A scale before it is cut into tiles.
#[derive(Clone, Copy, Debug)]
struct Scale {
    /// Where it rises from the shaft, pitches.
    base: f64,
    /// Way from the base to where its height is that of the undisturbed pattern, pitches.
    pivot: f64,
}

/// Scales that show along a line in order, with their upper ends in pitches.
type Shown = Vec<(usize, f64)>;

impl Pattern {
    /// Lays out a pattern on `lines`, evenly spaced on a section of `circumference_um`. A smooth
    /// cuticle gives `None`.
    pub(super) fn new(
        cuticle: &Cuticle,
        lines: &[Line],
        circumference_um: f64,
        seed: u64,
    ) -> Option<Self> {
        let CuticlePattern::Scales(recipe) = &cuticle.pattern else {
            return None;
        };
        // Even, because petals and tiles alternate from row to row.
        let rows = (PERIOD_UM / cuticle.pitch_um).ceil() as usize;
        let rows = rows.clamp(*ROWS.start(), *ROWS.end()).next_multiple_of(2);
        let spacing_um = circumference_um / lines.len() as f64;
        let builder = Builder {
            cuticle,
            recipe,
            lines,
            edge: FreeEdge::new(cuticle, recipe, rows, circumference_um, spacing_um, seed),
            rows,
            around: cuticle.around.max(1) as usize,
            circumference_um,
            seed,
        };
        let pattern = match recipe.layout {
            PatternLayout::Rows => builder.rows(),
            PatternLayout::Petals { .. } => builder.petals(),
            PatternLayout::Mosaic { scatter } => builder.mosaic(scatter),
        };
        Some(pattern)
    }

    /// One tile of no height: a section of any shape without scales.
    pub(super) fn bare(lines: &[Line], period_um: f64) -> Self {
        let whole = Span {
            tile: 0,
            end_um: period_um,
        };
        Self {
            period_um,
            tiles: vec![Tile {
                height_um: 0.0,
                slope: 0.0,
                scale: 0,
            }],
            lifts: Vec::new(),
            lines: vec![vec![whole]; lines.len()],
            turns: lines.iter().map(|line| line.turn).collect(),
        }
    }

    /// Height at z = 0 and slope of a tile on a line.
    pub(super) fn tile_on(&self, tile: u32, line: usize) -> (f64, f64) {
        let tile = self.tiles[tile as usize];
        let first = self.lifts.partition_point(|l| l.scale < tile.scale);
        let lifts = self.lifts[first..].iter();
        lifts.take_while(|l| l.scale == tile.scale).fold(
            (tile.height_um, tile.slope),
            |(height, slope), lift| {
                let more = lift.slope_at(self.turns[line]);
                (height - more * lift.hinge_um, slope + more)
            },
        )
    }

    /// Visits every span with height and slope of its tile and with its ends.
    pub(super) fn for_each_span(&self, mut visit: impl FnMut((f64, f64), f64, f64)) {
        for (line, spans) in self.lines.iter().enumerate() {
            let mut lo = spans.last().map_or(0.0, |s| s.end_um) - self.period_um;
            for span in spans {
                visit(self.tile_on(span.tile, line), lo, span.end_um);
                lo = span.end_um;
            }
        }
    }

    /// Makes the mean slope exactly height over pitch: random scales then do not change the tilt.
    fn normalize_slope(&mut self, slope: f64) {
        let (mut area, mut rise) = (0.0, 0.0);
        self.for_each_span(|tile, lo, hi| {
            area += hi - lo;
            rise += tile.1 * (hi - lo);
        });
        let scale = slope * area / rise;
        // A recipe may be so odd that no line meets a scale.
        if scale.is_finite() {
            for tile in &mut self.tiles {
                tile.slope *= scale;
                tile.height_um *= scale;
            }
        }
    }

    /// Makes the mean height zero: scales then do not change the diameter.
    fn normalize_height(&mut self) {
        let (mut area, mut volume) = (0.0, 0.0);
        self.for_each_span(|(height, slope), lo, hi| {
            area += hi - lo;
            volume += (height + slope * 0.5 * (lo + hi)) * (hi - lo);
        });
        for tile in &mut self.tiles {
            tile.height_um -= volume / area;
        }
    }
}

impl Builder<'_> {
    /// Uniform in -1..1 times the jitter, a function of the names only.
    fn jitter(&self, what: u64, index: usize) -> f64 {
        self.cuticle.jitter * symmetric(self.seed, what, index)
    }

    /// Cuts scales into tiles and lines into spans. `steady` lessens the scatter of slopes.
    fn assemble(
        &self,
        scales: &[Scale],
        rise: &Rise,
        steady: f64,
        shown: Vec<Shown>,
        lifts: Vec<Lift>,
    ) -> Pattern {
        let (pitch, height) = (self.cuticle.pitch_um, self.cuticle.height_um);
        let mut tiles = Vec::with_capacity(scales.len() * rise.chords.len());
        for (k, scale) in scales.iter().enumerate() {
            // Natural scatter: free edges +-20 % high, levels +-20 %: without it the sides of tiles
            // in one row, where neither lies over the other, would be no edges at all.
            let more = 0.2 * self.jitter(11, k) / steady;
            let lift = 0.2 * self.jitter(12, k) - more * rise.at(scale.pivot);
            for chord in &rise.chords {
                let slope = (1.0 + more) * chord.slope;
                let level = (1.0 + more) * chord.level + lift;
                tiles.push(Tile {
                    height_um: height * (level - slope * scale.base),
                    slope: height * slope / pitch,
                    scale: k as u32,
                });
            }
        }
        let period = self.rows as f64;
        let mut pattern = Pattern {
            period_um: pitch * period,
            tiles,
            lifts: Vec::new(),
            lines: shown
                .iter()
                .map(|shown| {
                    let mut spans = rise.cut(shown, scales, period);
                    for span in &mut spans {
                        span.end_um *= pitch;
                    }
                    spans
                })
                .collect(),
            turns: self.lines.iter().map(|line| line.turn).collect(),
        };
        pattern.normalize_slope(height / pitch);
        pattern.lifts = lifts;
        pattern.normalize_height();
        pattern
    }
}

/// Uniform in -1..1, a function of seed, name and index.
fn symmetric(seed: u64, what: u64, index: usize) -> f64 {
    2.0 * Rng::new(seed ^ hash64(what), index as u64).uniform() - 1.0
}
