//! Path tracing of a [`Scene`] to a [`Film`].

mod draws;
mod film;
mod filter;
mod path;
mod resample;
mod scatter;

pub use film::{Crop, Film, NO_STRAND, Pixel, Report};
pub use filter::{Filter, GAUSSIAN_SIGMA};

use crate::blame::Blame;
use crate::progress::{Cancel, Progress};
use crate::scene::Scene;
use film::PixelSums;
use path::Integrator;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Side of a tile, pixels. Any size gives the same picture.
const TILE: u32 = 16;

/// Largest side of a picture, pixels.
pub const SIDE_LIMIT: u32 = 32_768;

/// Most samples a pixel.
pub const SPP_LIMIT: u32 = 1 << 24;

/// How directions are drawn. All converge to the same picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sampler {
    /// Direct light by quasi-random sampling importance resampling of scattering times environment;
    /// the path goes on by the scattering model, its escapes weighted in.
    #[default]
    Qsir,
    /// The paper's scheme: resampling draws the one ray that carries direct and indirect light.
    /// Half the rays, but 1.1 to 3 times the noise a sample of [`Sampler::Qsir`].
    QsirOneRay,
    /// The scattering model alone.
    Bsdf,
    /// Direct light by the environment alone, indirect light by the scattering model.
    Env,
    /// Direct light by both, combined with the power heuristic.
    Mis,
}

/// A picture to be made.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderJob {
    /// Width and height of the full frame, pixels, 1..=[`SIDE_LIMIT`].
    pub resolution: [u32; 2],
    /// Part of the frame to render; `None` for all.
    pub crop: Option<Crop>,
    /// Samples a pixel, 1..=[`SPP_LIMIT`].
    pub spp: u32,
    /// Another seed gives another noise.
    pub seed: u64,
    /// How directions are drawn.
    pub sampler: Sampler,
    /// How samples spread over and around their pixel.
    pub filter: Filter,
    /// Stop after this time with the samples there are; the first pass is always finished.
    pub time_limit: Option<Duration>,
}

impl Default for RenderJob {
    fn default() -> Self {
        Self {
            resolution: [960, 720],
            crop: None,
            spp: 64,
            seed: 0,
            sampler: Sampler::Qsir,
            filter: Filter::Gaussian,
            time_limit: None,
        }
    }
}

/// A picture that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RenderError {
    /// No pixels, or too many.
    #[error(
        "a picture of {width} x {height} pixels cannot be made: both sides must be 1 to {SIDE_LIMIT}"
    )]
    Resolution {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// The crop is empty or reaches over the frame.
    #[error("the crop {crop:?} is not inside the picture of {width} x {height} pixels")]
    Crop {
        /// The crop.
        crop: Crop,
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// No samples, or too many.
    #[error("{spp} samples a pixel cannot be taken: 1 to {SPP_LIMIT} are possible")]
    Spp {
        /// Samples a pixel.
        spp: u32,
    },
}

impl RenderError {
    /// All of these are the user's to mend.
    pub fn blame(&self) -> Blame {
        Blame::Input
    }
}

/// The pixels of one tile; only one thread touches it at a time.
struct Tile {
    x: u32,
    y: u32,
    width: u32,
    sums: Vec<PixelSums>,
}

/// Counts of one tile in one pass.
#[derive(Clone, Copy, Default)]
struct Counts {
    samples: u64,
    rays: u64,
    dropped: u64,
    capped: u64,
}

impl RenderJob {
    /// Checks the numbers and gives the pixels to render.
    pub fn check(&self) -> Result<Crop, RenderError> {
        let [width, height] = self.resolution;
        if !(1..=SIDE_LIMIT).contains(&width) || !(1..=SIDE_LIMIT).contains(&height) {
            return Err(RenderError::Resolution { width, height });
        }
        if !(1..=SPP_LIMIT).contains(&self.spp) {
            return Err(RenderError::Spp { spp: self.spp });
        }
        let crop = self.crop.unwrap_or(Crop {
            x: 0,
            y: 0,
            width,
            height,
        });
        let inside = |from: u32, size: u32, limit: u32| {
            size > 0 && from.checked_add(size).is_some_and(|end| end <= limit)
        };
        if inside(crop.x, crop.width, width) && inside(crop.y, crop.height, height) {
            Ok(crop)
        } else {
            Err(RenderError::Crop {
                crop,
                width,
                height,
            })
        }
    }

    /// Renders.
    ///
    /// * Passes of 1, 1, 2, 4, 8, 16, 16, ... samples a pixel: stopped by `cancel` or the time limit,
    ///   the film holds what there is. Only a cancel within the first pass leaves pixels without a
    ///   sample; then `report.passes` is 0.
    /// * The same job on the same scene gives the same bits on any number of threads, unless it is
    ///   stopped; a crop gives the bits of the full frame.
    pub fn run(
        &self,
        scene: &Scene,
        progress: &dyn Progress,
        cancel: &Cancel,
    ) -> Result<Film, RenderError> {
        self.run_with(self.integrator(scene), progress, cancel)
    }

    fn integrator<'a>(&self, scene: &'a Scene) -> Integrator<'a> {
        let [width, height] = self.resolution;
        Integrator {
            scene,
            camera: scene.camera(width as f32 / height.max(1) as f32),
            resolution: self.resolution,
            seed: self.seed,
            sampler: self.sampler,
            filter: self.filter,
            #[cfg(test)]
            bare_target: false,
        }
    }

    fn run_with(
        &self,
        integrator: Integrator<'_>,
        progress: &dyn Progress,
        cancel: &Cancel,
    ) -> Result<Film, RenderError> {
        let crop = self.check()?;
        let started = Instant::now();
        let mut tiles = tiles_of(&crop);
        let pixels = u64::from(crop.width) * u64::from(crop.height);
        progress.begin("render", pixels * u64::from(self.spp), "samples");
        let mut report = Report::default();
        let mut taken = 0;
        while taken < self.spp {
            let size = pass_size(taken).min(self.spp - taken);
            let late = || {
                let over = self.time_limit.is_some_and(|l| started.elapsed() >= l);
                cancel.is_cancelled() || (taken > 0 && over)
            };
            if late() {
                break;
            }
            let stopped = AtomicU64::new(0);
            let counts: Vec<Counts> = tiles
                .par_iter_mut()
                .map(|tile| {
                    if late() {
                        stopped.fetch_add(1, Ordering::Relaxed);
                        return Counts::default();
                    }
                    let counts = trace_tile(&integrator, tile, taken..taken + size);
                    progress.advance(counts.samples);
                    counts
                })
                .collect();
            for c in &counts {
                report.samples += c.samples;
                report.rays += c.rays;
                report.dropped += c.dropped;
                report.capped += c.capped;
            }
            if stopped.into_inner() > 0 {
                break;
            }
            taken += size;
            report.passes += 1;
            progress.note(&format!("{taken} spp"));
        }
        progress.finish();
        report.complete = taken == self.spp;
        report.elapsed = started.elapsed();
        Ok(Film {
            crop,
            resolution: self.resolution,
            pixels: assemble(&tiles, &crop),
            report,
        })
    }
}

/// Samples of the pass after `taken`: doubling, so that every pass ends on a whole net of points.
fn pass_size(taken: u32) -> u32 {
    taken.clamp(1, 16)
}

fn tiles_of(crop: &Crop) -> Vec<Tile> {
    let mut tiles = Vec::new();
    for y in (0..crop.height).step_by(TILE as usize) {
        for x in (0..crop.width).step_by(TILE as usize) {
            let (width, height) = (TILE.min(crop.width - x), TILE.min(crop.height - y));
            tiles.push(Tile {
                x: crop.x + x,
                y: crop.y + y,
                width,
                sums: vec![PixelSums::default(); (width * height) as usize],
            });
        }
    }
    tiles
}

fn trace_tile(
    integrator: &Integrator<'_>,
    tile: &mut Tile,
    indices: std::ops::Range<u32>,
) -> Counts {
    let mut counts = Counts::default();
    for (i, sums) in tile.sums.iter_mut().enumerate() {
        let (x, y) = (
            tile.x + i as u32 % tile.width,
            tile.y + i as u32 / tile.width,
        );
        for index in indices.clone() {
            let sample = integrator.sample(x, y, index);
            counts.samples += 1;
            counts.rays += u64::from(sample.rays);
            counts.capped += u64::from(sample.capped);
            counts.dropped += u64::from(!sums.add(&sample));
        }
    }
    counts
}

fn assemble(tiles: &[Tile], crop: &Crop) -> Vec<Pixel> {
    let blank = Pixel::from(&PixelSums::default());
    let mut pixels = vec![blank; crop.width as usize * crop.height as usize];
    for tile in tiles {
        for (i, sums) in tile.sums.iter().enumerate() {
            let x = tile.x - crop.x + i as u32 % tile.width;
            let y = tile.y - crop.y + i as u32 / tile.width;
            pixels[y as usize * crop.width as usize + x as usize] = Pixel::from(sums);
        }
    }
    pixels
}

#[cfg(test)]
mod tests;
