//! A rendering in progress: tiles that take samples in passes, and can be saved between any two of them.

use super::film::PixelSums;
use super::mattes::{MatteNames, Mattes};
use super::path::Integrator;
use super::sums::{Counts, Header};
use super::{Crop, Film, FilmSums, FilmSumsError, Pixel, RenderError, RenderJob, Report};
use crate::progress::{Cancel, Progress};
use crate::scene::Scene;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Side of a tile, pixels. Tiles lie on a lattice of the full frame.
const TILE: u32 = 16;

/// Samples a pixel before a tile may have enough.
const LEAST: u32 = 16;

/// Mean luminance below which a tile's error is not taken relative to its own light any more: nobody sees
/// noise in the dark.
const DARK: f64 = 0.02;

/// The pixels of one tile; only one thread touches it at a time.
struct Tile {
    extent: Crop,
    sums: Vec<PixelSums>,
    /// Counts of what each pixel's samples saw; empty if nobody asks.
    mattes: Vec<u32>,
    /// The next sample.
    next: u32,
}

/// Relative error of a tile's luminance (see [`RenderJob::target_error`]).
fn error(tile: &[PixelSums]) -> f64 {
    let (mut mean, mut variance) = (0.0, 0.0);
    for sums in tile {
        let (m, v) = sums.luminance();
        mean += m;
        variance += v;
    }
    let n = tile.len().max(1) as f64;
    (variance / n).sqrt() / (mean / n).max(DARK)
}

/// A picture that is being made.
pub struct Rendering<'a> {
    job: RenderJob,
    crop: Crop,
    integrator: Integrator<'a>,
    /// What samples are counted by, if they are.
    names: Option<MatteNames>,
    tiles: Vec<Tile>,
    counts: Counts,
    /// Rays of the sums it went on from.
    rays_before: u64,
    /// Whether its progress is shown already: it may go on in many pieces.
    is_shown: bool,
    started: Instant,
}

impl<'a> Rendering<'a> {
    /// Nothing rendered yet; the time limit begins to run.
    ///
    /// # Errors
    /// Numbers that make no picture ([`RenderJob::check`]).
    pub fn new(job: &RenderJob, scene: &'a Scene) -> Result<Self, RenderError> {
        Self::with(job, job.integrator(scene))
    }

    pub(super) fn with(job: &RenderJob, integrator: Integrator<'a>) -> Result<Self, RenderError> {
        let crop = job.check()?;
        let scene = integrator.scene;
        let names = job.mattes.then(|| MatteNames {
            classes: scene.classes.clone(),
            zones: scene.zones.clone(),
        });
        Ok(Self {
            job: job.clone(),
            crop,
            integrator,
            tiles: tiles_of(job, &crop, names.as_ref()),
            names,
            counts: Counts::default(),
            rays_before: 0,
            is_shown: false,
            started: Instant::now(),
        })
    }

    /// Takes passes of 1, 1, 2, 4, 8, 16, 16, ... samples a pixel until all are taken or something stops it:
    /// `cancel`, the job's time limit, or `until`. Whether the picture is complete.
    ///
    /// A time limit lets the first pass end, `until` does not.
    pub fn run(
        &mut self,
        until: Option<Instant>,
        progress: &dyn Progress,
        cancel: &Cancel,
    ) -> bool {
        if !std::mem::replace(&mut self.is_shown, true) {
            let pixels: usize = self.tiles.iter().map(|t| t.sums.len()).sum();
            progress.begin("render", pixels as u64 * u64::from(self.job.spp), "samples");
            let done = |t: &Tile| u64::from(t.next - self.job.first) * t.sums.len() as u64;
            progress.advance(self.tiles.iter().map(done).sum());
        }
        let stopped = AtomicBool::new(false);
        while let Some(from) = self.next_pass() {
            let is_first = from == self.job.first;
            let to = self.end().min(from + pass_size(from - self.job.first));
            let (started, limit) = (self.started, self.job.time_limit);
            let late = || {
                let due = until.is_some_and(|until| Instant::now() >= until);
                let late = cancel.is_cancelled() || due || (!is_first && is_over(started, limit));
                late && {
                    stopped.store(true, Ordering::Relaxed);
                    true
                }
            };
            if late() {
                break;
            }
            let (integrator, names) = (&self.integrator, self.names.as_ref());
            let job = &self.job;
            let counts: Vec<Counts> = self
                .tiles
                .par_iter_mut()
                .map(|tile| {
                    if tile.next >= to || enough(job, tile.next, &tile.sums) || late() {
                        return Counts::default();
                    }
                    let counts = trace(integrator, names, tile, to);
                    progress.advance(counts.samples);
                    counts
                })
                .collect();
            counts.iter().for_each(|c| self.counts.add(c));
            if stopped.load(Ordering::Relaxed) {
                break;
            }
            progress.note(&format!("{} spp", to - self.job.first));
        }
        let complete = self.next_pass().is_none();
        if complete || cancel.is_cancelled() || self.is_late() {
            progress.finish();
            self.is_shown = false;
        }
        complete
    }

    /// One past the last sample.
    fn end(&self) -> u32 {
        self.job.first + self.job.spp
    }

    /// Where the tile that is farthest behind goes on; `None` if all have enough.
    fn next_pass(&self) -> Option<u32> {
        let open = |t: &&Tile| !enough(&self.job, t.next, &t.sums);
        self.tiles.iter().filter(open).map(|t| t.next).min()
    }

    /// Whether the job's time limit has stopped it, or will before the next sample.
    pub fn is_late(&self) -> bool {
        is_over(self.started, self.job.time_limit) && self.next_pass() != Some(self.job.first)
    }

    /// The picture as it is now.
    pub fn film(&self) -> Film {
        let least = self.tiles.iter().map(|t| t.next).min();
        let least = least.unwrap_or(self.job.first) - self.job.first;
        Film {
            crop: self.crop,
            resolution: self.job.resolution,
            pixels: assemble(
                self.tiles.iter().map(|t| (t.extent, t.sums.as_slice())),
                &self.crop,
            ),
            mattes: self.names.as_ref().map(|names| {
                let tiles = self.tiles.iter().map(|t| (t.extent, t.mattes.as_slice()));
                Mattes::assemble(names, tiles, &self.crop)
            }),
            report: Report {
                passes: passes_in(least),
                complete: self.next_pass().is_none(),
                elapsed: self.started.elapsed(),
                rays_in_elapsed: self.counts.rays - self.rays_before,
                ..self.counts.report()
            },
        }
    }

    /// The sums as they are now, to be written to a file.
    ///
    /// * `of`: what the samples are of, besides what the job says: another scene has another text.
    pub fn sums(&self, of: &str) -> FilmSums {
        FilmSums {
            header: self.header(of),
            pixels: (self.tiles.iter())
                .flat_map(|tile| tile.sums.iter().copied())
                .collect(),
            mattes: (self.tiles.iter())
                .flat_map(|tile| tile.mattes.iter().copied())
                .collect(),
        }
    }

    fn header(&self, of: &str) -> Header {
        let mut header = Header::new(of, &self.job);
        header.mattes.clone_from(&self.names);
        header.next = self.tiles.iter().map(|t| t.next).collect();
        header.counts = self.counts;
        header
    }

    /// Goes on from sums of this very picture.
    ///
    /// # Errors
    /// Sums of another picture; nothing has changed then.
    pub fn resume(&mut self, sums: FilmSums) -> Result<(), FilmSumsError> {
        sums.header.same_picture(&self.header(&sums.header.of))?;
        let (mut at, mut rest) = (0, sums.mattes.as_slice());
        for (tile, next) in self.tiles.iter_mut().zip(&sums.header.next) {
            let count = tile.sums.len();
            tile.sums.copy_from_slice(&sums.pixels[at..at + count]);
            let (mattes, later) = rest.split_at(tile.mattes.len());
            tile.mattes.copy_from_slice(mattes);
            tile.next = *next;
            at += count;
            rest = later;
        }
        self.counts = sums.header.counts;
        self.rays_before = self.counts.rays;
        Ok(())
    }
}

fn is_over(started: Instant, limit: Option<Duration>) -> bool {
    limit.is_some_and(|limit| started.elapsed() >= limit)
}

/// Whether a tile needs no more samples. A function of its sums alone.
///
/// * `next`: its next sample.
pub(super) fn enough(job: &RenderJob, next: u32, tile: &[PixelSums]) -> bool {
    let met = |target: f64| next - job.first >= LEAST && error(tile) <= target;
    next >= job.first + job.spp || job.target_error.is_some_and(met)
}

/// Samples of the pass after `taken`: doubling, so that every pass ends on a whole net of points.
fn pass_size(taken: u32) -> u32 {
    taken.clamp(1, 16)
}

/// Whole passes in so many samples a pixel.
fn passes_in(taken: u32) -> u32 {
    match taken {
        0 => 0,
        1..=16 => 1 + taken.ilog2(),
        _ => 5 + (taken - 16).div_ceil(16),
    }
}

/// Tiles of a picture. Where they decide for themselves when to stop they are whole, whatever the crop, so
/// that a crop shows what the full frame does.
pub(super) fn extents(job: &RenderJob, crop: &Crop) -> Vec<Crop> {
    let bounds = if job.target_error.is_some() {
        Crop::whole(job.resolution)
    } else {
        *crop
    };
    let cut = |from: u32, low: u32, high: u32| {
        let (a, b) = (from.max(low), (from + TILE).min(high));
        (a, b - a)
    };
    let mut tiles = Vec::new();
    for ty in crop.y / TILE..(crop.y + crop.height).div_ceil(TILE) {
        for tx in crop.x / TILE..(crop.x + crop.width).div_ceil(TILE) {
            let (x, width) = cut(tx * TILE, bounds.x, bounds.x + bounds.width);
            let (y, height) = cut(ty * TILE, bounds.y, bounds.y + bounds.height);
            tiles.push(Crop {
                x,
                y,
                width,
                height,
            });
        }
    }
    tiles
}

fn tiles_of(job: &RenderJob, crop: &Crop, names: Option<&MatteNames>) -> Vec<Tile> {
    let columns = names.map_or(0, MatteNames::columns);
    extents(job, crop)
        .into_iter()
        .map(|extent| Tile {
            extent,
            sums: vec![PixelSums::default(); extent.pixels()],
            mattes: vec![0; columns * extent.pixels()],
            next: job.first,
        })
        .collect()
}

fn trace(
    integrator: &Integrator<'_>,
    names: Option<&MatteNames>,
    tile: &mut Tile,
    to: u32,
) -> Counts {
    let mut counts = Counts::default();
    for (i, sums) in tile.sums.iter_mut().enumerate() {
        let (x, y) = tile.extent.pixel(i);
        for index in tile.next..to {
            let sample = integrator.sample(x, y, index);
            counts.samples += 1;
            counts.rays += u64::from(sample.rays);
            counts.capped += u64::from(sample.capped);
            let kept = sums.add(&sample);
            counts.dropped += u64::from(!kept);
            if let (true, Some(names), Some(seen)) = (kept, names, sample.seen) {
                let columns = names.columns();
                names.count(seen, &mut tile.mattes[i * columns..(i + 1) * columns]);
            }
        }
    }
    tile.next = to;
    counts
}

/// The picture of a crop, from the tiles that cover it.
pub(super) fn assemble<'a>(
    tiles: impl Iterator<Item = (Crop, &'a [PixelSums])>,
    crop: &Crop,
) -> Vec<Pixel> {
    let mut pixels = vec![Pixel::from(&PixelSums::default()); crop.pixels()];
    for (extent, sums) in tiles {
        for (from, to) in extent.shared(crop) {
            pixels[to] = Pixel::from(&sums[from]);
        }
    }
    pixels
}

#[cfg(test)]
#[path = "rendering_tests.rs"]
mod tests;
