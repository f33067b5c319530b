//! Every pixel of a picture from its own quasi-random samples.

use crate::color::srgb_from_linear;
use crate::image::Canvas;
use crate::progress::{Cancel, Progress};
use crate::sampling::{Rng, Sobol, hash64};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// How pictures are rastered.
pub(super) struct Raster<'a> {
    /// Samples a pixel.
    pub(super) samples: u32,
    pub(super) progress: &'a dyn Progress,
    pub(super) cancel: &'a Cancel,
}

/// One sample of a pixel.
pub(super) struct Sample {
    /// Place in the picture, pixels from the upper left corner.
    pub(super) x: f64,
    pub(super) y: f64,
    /// Two more numbers in `[0, 1)`, well spread over the samples of the pixel.
    pub(super) pair: [f64; 2],
    /// For all other choices.
    pub(super) rng: Rng,
}

impl Raster<'_> {
    /// A picture of linear colors; `None` when canceled.
    pub(super) fn draw(
        &self,
        (width, height): (usize, usize),
        color: impl Fn(&mut Sample) -> DVec3 + Sync,
    ) -> Option<Canvas> {
        self.progress.begin("drawing", height as u64, "rows");
        let rows: Vec<Option<Vec<Vec3>>> = (0..height)
            .into_par_iter()
            .map(|y| {
                if self.cancel.is_cancelled() {
                    return None;
                }
                let row = (0..width).map(|x| self.pixel(x, y, &color)).collect();
                self.progress.advance(1);
                Some(row)
            })
            .collect();
        self.progress.finish();
        let mut canvas = Canvas::new(width, height, Vec3::ZERO);
        for (y, row) in rows.into_iter().enumerate() {
            for (x, color) in row?.into_iter().enumerate() {
                canvas.set(x, y, color);
            }
        }
        Some(canvas)
    }

    fn pixel(&self, x: usize, y: usize, color: &impl Fn(&mut Sample) -> DVec3) -> Vec3 {
        // Rows keep their numbers whatever the width is.
        let key = hash64(((y as u64) << 32) | x as u64);
        let points = Sobol::new(key);
        let mut sum = DVec3::ZERO;
        for index in 0..self.samples {
            let [u, v, p, q] = points.point(index).map(f64::from);
            sum += color(&mut Sample {
                x: x as f64 + u,
                y: y as f64 + v,
                pair: [p, q],
                rng: Rng::new(key, u64::from(index)),
            });
        }
        let mean = (sum / f64::from(self.samples)).as_vec3();
        mean.map(srgb_from_linear)
    }
}
