//! What a rendering gathers: sums per pixel, in double precision and sample order.

use super::path::Sample;
use crate::color::{Rgb, luminance};
use glam::{DVec3, Vec2, Vec3};
use std::time::Duration;

/// Strand id of pixels that show no strand.
pub const NO_STRAND: u32 = u32::MAX;

/// A rectangle of the full frame, pixels from the upper left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// Sums of one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PixelSums {
    samples: u32,
    radiance: DVec3,
    square: f64,
    alpha: f64,
    /// Samples that met strand or skin; the sums below are over these.
    hits: u32,
    depth: f64,
    albedo: Vec3,
    normal: Vec3,
    tangent: Vec3,
    strand: u32,
    root_uv: Vec2,
}

impl Default for PixelSums {
    fn default() -> Self {
        Self {
            samples: 0,
            radiance: DVec3::ZERO,
            square: 0.0,
            alpha: 0.0,
            hits: 0,
            depth: 0.0,
            albedo: Vec3::ZERO,
            normal: Vec3::ZERO,
            tangent: Vec3::ZERO,
            strand: NO_STRAND,
            root_uv: Vec2::ZERO,
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
        self.radiance += sample.radiance.as_dvec3();
        self.square += f64::from(luminance(sample.radiance)).powi(2);
        self.alpha += f64::from(sample.alpha);
        if let Some(first) = &sample.first {
            self.hits += 1;
            self.depth += f64::from(first.depth);
            self.albedo += first.albedo;
            self.normal += first.normal;
            self.tangent += first.tangent;
            // Ids cannot be averaged: the first strand seen keeps the pixel.
            if self.strand == NO_STRAND
                && let Some(strand) = first.strand
            {
                self.strand = strand;
                self.root_uv = first.root_uv;
            }
        }
        true
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
        let n = f64::from(sums.samples.max(1));
        let mean = sums.radiance / n;
        let spread = (sums.square / n - f64::from(luminance(mean.as_vec3())).powi(2)).max(0.0);
        let hits = sums.hits.max(1) as f32;
        Self {
            radiance: mean.as_vec3(),
            alpha: (sums.alpha / n) as f32,
            variance: (spread / (n - 1.0).max(1.0)) as f32,
            samples: sums.samples,
            depth: match sums.hits {
                0 => f32::INFINITY,
                hits => (sums.depth / f64::from(hits)) as f32,
            },
            albedo: sums.albedo / hits,
            normal: sums.normal / hits,
            tangent: sums.tangent / hits,
            strand: sums.strand,
            root_uv: sums.root_uv,
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
    /// Time spent.
    pub elapsed: Duration,
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
