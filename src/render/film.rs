//! What a rendering gathers: exact sums per pixel.

use super::mattes::Mattes;
use super::path::Sample;
use crate::color::{Rgb, luminance};
use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Strand id of pixels that show no strand.
pub const NO_STRAND: u32 = u32::MAX;

/// A rectangle of the full frame, pixels from the upper left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Crop {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Crop {
    /// The full frame of a size.
    pub fn whole([width, height]: [u32; 2]) -> Self {
        Self {
            x: 0,
            y: 0,
            width,
            height,
        }
    }

    /// Number of its pixels.
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Column and row in the full frame of its pixel `index`, rows from the top.
    pub(super) fn pixel(&self, index: usize) -> (u32, u32) {
        let index = index as u32;
        (self.x + index % self.width, self.y + index / self.width)
    }

    /// Indices of the pixels that are in another crop too, here and there.
    pub(super) fn shared(self, other: &Self) -> impl Iterator<Item = (usize, usize)> {
        let other = *other;
        (0..self.pixels()).filter_map(move |index| {
            let (x, y) = self.pixel(index);
            let (x, y) = (x.checked_sub(other.x)?, y.checked_sub(other.y)?);
            let is_inside = x < other.width && y < other.height;
            is_inside.then(|| (index, y as usize * other.width as usize + x as usize))
        })
    }
}

/// Sums of one pixel, in integers: samples may be added in any order and by any number of programs, to
/// the bit the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PixelSums {
    samples: u32,
    /// Samples that met strand or skin; the sums over first hits are over these.
    hits: u32,
    /// Strand of the first sample that met one, and its root's texture coordinates (bits).
    strand: u32,
    root_uv: [u32; 2],
    /// Of squared luminance, in units of 2^-40.
    square: u128,
    /// Radiance (3), depth, albedo (3), normal (3), tangent (3): in units of 2^-28, depth of 2^-10.
    sums: [i64; SUMS],
}

const SUMS: usize = 13;
const UNIT: f64 = (1u64 << 28) as f64;
const DEPTH_UNIT: f64 = (1u64 << 10) as f64;
const SQUARE_UNIT: f64 = (1u64 << 40) as f64;

/// 64-bit words of a pixel's sums in a file.
pub(super) const WORDS: usize = SUMS + 5;

impl Default for PixelSums {
    fn default() -> Self {
        Self {
            samples: 0,
            hits: 0,
            strand: NO_STRAND,
            root_uv: [0; 2],
            square: 0,
            sums: [0; SUMS],
        }
    }
}

impl PixelSums {
    /// Adds a sample; `false` if it was not finite and dropped.
    pub(super) fn add(&mut self, sample: &Sample) -> bool {
        if !sample.radiance.is_finite() {
            return false;
        }
        self.samples += 1;
        self.square = self.square.saturating_add(
            (f64::from(luminance(sample.radiance)).powi(2) * SQUARE_UNIT).round() as u128,
        );
        self.add_at(0, sample.radiance);
        if let Some(first) = &sample.first {
            self.hits += 1;
            let depth = (f64::from(first.depth) * DEPTH_UNIT).round() as i64;
            self.sums[3] = self.sums[3].saturating_add(depth);
            self.add_at(4, first.albedo);
            self.add_at(7, first.normal);
            self.add_at(10, first.tangent);
            // Ids cannot be averaged: the first strand seen keeps the pixel.
            if self.strand == NO_STRAND
                && let Some(strand) = first.strand
            {
                self.strand = strand;
                self.root_uv = first.root_uv.to_array().map(f32::to_bits);
            }
        }
        true
    }

    fn add_at(&mut self, at: usize, v: Vec3) {
        for (sum, x) in self.sums[at..at + 3].iter_mut().zip(v.to_array()) {
            // Numbers too large end at the greatest there is.
            *sum = sum.saturating_add((f64::from(x) * UNIT).round() as i64);
        }
    }

    /// Adds the sums of samples that come later.
    pub(super) fn append(&mut self, later: &Self) {
        self.samples += later.samples;
        self.hits += later.hits;
        self.square = self.square.saturating_add(later.square);
        for (sum, x) in self.sums.iter_mut().zip(later.sums) {
            *sum = sum.saturating_add(x);
        }
        if self.strand == NO_STRAND {
            (self.strand, self.root_uv) = (later.strand, later.root_uv);
        }
    }

    /// As they stand in a file.
    pub(super) fn words(&self) -> [u64; WORDS] {
        let pair = |a: u32, b: u32| u64::from(a) | u64::from(b) << 32;
        let mut words = [0; WORDS];
        words[0] = pair(self.samples, self.hits);
        words[1] = pair(self.strand, 0);
        words[2] = pair(self.root_uv[0], self.root_uv[1]);
        (words[3], words[4]) = (self.square as u64, (self.square >> 64) as u64);
        for (word, sum) in words[5..].iter_mut().zip(self.sums) {
            *word = sum as u64;
        }
        words
    }

    /// From a file.
    pub(super) fn from_words(words: &[u64; WORDS]) -> Self {
        let pair = |word: u64| [word as u32, (word >> 32) as u32];
        let [samples, hits] = pair(words[0]);
        Self {
            samples,
            hits,
            strand: words[1] as u32,
            root_uv: pair(words[2]),
            square: u128::from(words[3]) | u128::from(words[4]) << 64,
            sums: std::array::from_fn(|i| words[5 + i] as i64),
        }
    }

    fn mean_at(&self, at: usize, count: u32) -> Vec3 {
        let scale = 1.0 / (UNIT * f64::from(count.max(1)));
        Vec3::from_array(std::array::from_fn(|i| {
            (self.sums[at + i] as f64 * scale) as f32
        }))
    }

    /// Mean luminance and the variance of that mean.
    pub(super) fn luminance(&self) -> (f64, f64) {
        let n = f64::from(self.samples.max(1));
        let mean = f64::from(luminance(self.mean_at(0, self.samples)));
        let spread = (self.square as f64 / SQUARE_UNIT / n - mean * mean).max(0.0);
        (mean, spread / (n - 1.0).max(1.0))
    }
}

/// One finished pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Mean radiance, linear Rec.709, backdrop included.
    pub radiance: Rgb,
    /// Share of samples that met strand or skin.
    pub alpha: f32,
    /// Variance of the mean luminance.
    pub variance: f32,
    /// Samples taken.
    pub samples: u32,
    /// Mean distance of the first hits, millimeters; infinite where there are none.
    pub depth: f32,
    /// Mean albedo of the first hits.
    pub albedo: Rgb,
    /// Mean normal of the first hits, world.
    pub normal: Vec3,
    /// Mean tangent of the first hits, world.
    pub tangent: Vec3,
    /// Stable id of the first strand seen, or [`NO_STRAND`].
    pub strand: u32,
    /// Texture coordinates of that strand's root.
    pub root_uv: Vec2,
}

impl From<&PixelSums> for Pixel {
    fn from(sums: &PixelSums) -> Self {
        let hits = sums.hits;
        Self {
            radiance: sums.mean_at(0, sums.samples),
            alpha: (f64::from(hits) / f64::from(sums.samples.max(1))) as f32,
            variance: sums.luminance().1 as f32,
            samples: sums.samples,
            depth: match hits {
                0 => f32::INFINITY,
                _ => (sums.sums[3] as f64 / DEPTH_UNIT / f64::from(hits)) as f32,
            },
            albedo: sums.mean_at(4, hits),
            normal: sums.mean_at(7, hits),
            tangent: sums.mean_at(10, hits),
            strand: sums.strand,
            root_uv: Vec2::from_array(sums.root_uv.map(f32::from_bits)),
        }
    }
}

/// What happened during a rendering.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// Camera samples taken.
    pub samples: u64,
    /// Rays traced, camera rays included.
    pub rays: u64,
    /// Samples that were not finite and left out. Always a defect.
    pub dropped: u64,
    /// Paths that the far cap cut.
    pub capped: u64,
    /// Passes that covered the whole picture.
    pub passes: u32,
    /// Whether all samples asked for were taken.
    pub complete: bool,
    /// Time spent since the rendering was begun or gone on with.
    pub elapsed: Duration,
    /// Rays traced in that time.
    pub rays_in_elapsed: u64,
}

/// A rendered picture, or a crop of one.
#[derive(Clone, Debug)]
pub struct Film {
    /// Which pixels of the full frame these are.
    pub crop: Crop,
    /// Size of the full frame.
    pub resolution: [u32; 2],
    /// Pixels of the crop, rows from the top.
    pub pixels: Vec<Pixel>,
    /// What the samples of each pixel saw, if that was asked for.
    pub mattes: Option<Mattes>,
    /// What happened.
    pub report: Report,
}

impl Film {
    /// Root mean square over the pixels of the standard error of luminance, over the mean luminance:
    /// the noise of the picture.
    pub fn noise(&self) -> f64 {
        let (mut variance, mut mean) = (0.0, 0.0);
        for p in &self.pixels {
            variance += f64::from(p.variance);
            mean += f64::from(luminance(p.radiance));
        }
        let n = self.pixels.len().max(1) as f64;
        (variance / n).sqrt() / (mean / n).max(f64::MIN_POSITIVE)
    }
}
