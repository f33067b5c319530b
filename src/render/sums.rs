//! Exact sums of some samples of a picture: for checkpoints, and for parts made apart.

use super::film::PixelSums;
use super::mattes::{MatteNames, Mattes};
use super::rendering::{assemble, enough, extents};
use super::{Crop, Film, Filter, RenderJob, Report, Sampler};
use crate::blame::Blame;
use crate::io::FileError;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Raised when the meaning of a word changes.
const VERSION: u32 = 1;

/// Sums that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum FilmSumsError {
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// Not a file of a picture's sums, or no longer what was written.
    #[error("{} does not hold the sums of a picture: {what}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What gave it away.
        what: String,
    },
    /// Sums of another picture.
    #[error("the sums are of another picture: {what} differs")]
    Foreign {
        /// Which part of what makes a picture.
        what: &'static str,
    },
    /// Ranges of samples that do not follow one another.
    #[error("samples {end} to {next} are missing or there twice")]
    Gap {
        /// End of a range.
        end: u32,
        /// Beginning of the next.
        next: u32,
    },
    /// A range that was stopped before its end.
    #[error("samples {first} to {end} are not complete: a tile stands at {at}")]
    Unfinished {
        /// First sample.
        first: u32,
        /// One past the last.
        end: u32,
        /// Next sample of the tile that is farthest behind.
        at: u32,
    },
    /// What is wrong with one of several files.
    #[error("{}: {source}", path.display())]
    In {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: Box<FilmSumsError>,
    },
    /// No file.
    #[error("there is nothing to merge")]
    Nothing,
}

impl FilmSumsError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::File(error) => error.blame(),
            Self::In { source, .. } => source.blame(),
            _ => Blame::Input,
        }
    }
}

/// What happened to the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Counts {
    pub(super) samples: u64,
    pub(super) rays: u64,
    pub(super) dropped: u64,
    pub(super) capped: u64,
}

impl Counts {
    pub(super) fn add(&mut self, other: &Self) {
        self.samples += other.samples;
        self.rays += other.rays;
        self.dropped += other.dropped;
        self.capped += other.capped;
    }

    pub(super) fn report(&self) -> Report {
        Report {
            samples: self.samples,
            rays: self.rays,
            dropped: self.dropped,
            capped: self.capped,
            ..Report::default()
        }
    }
}

/// What sums are of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Header {
    version: u32,
    /// The scene, in whatever words.
    pub(super) of: String,
    resolution: [u32; 2],
    pub(super) crop: Crop,
    seed: u64,
    sampler: Sampler,
    filter: Filter,
    target_error: Option<f64>,
    /// What samples are counted by, if they are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) mattes: Option<MatteNames>,
    pub(super) first: u32,
    pub(super) spp: u32,
    /// The next sample of each tile.
    pub(super) next: Vec<u32>,
    pub(super) counts: Counts,
}

impl Header {
    pub(super) fn new(of: &str, job: &RenderJob) -> Self {
        Self {
            version: VERSION,
            of: of.to_owned(),
            resolution: job.resolution,
            crop: job.crop.unwrap_or(Crop::whole(job.resolution)),
            seed: job.seed,
            sampler: job.sampler,
            filter: job.filter,
            target_error: job.target_error,
            mattes: None,
            first: job.first,
            spp: job.spp,
            next: Vec::new(),
            counts: Counts::default(),
        }
    }

    fn job(&self) -> RenderJob {
        RenderJob {
            resolution: self.resolution,
            crop: Some(self.crop),
            spp: self.spp,
            first: self.first,
            target_error: self.target_error,
            seed: self.seed,
            sampler: self.sampler,
            filter: self.filter,
            mattes: self.mattes.is_some(),
            time_limit: None,
        }
    }

    /// Whether samples of the one are samples of the other too, whichever they are.
    fn same_samples(&self, other: &Self) -> Result<(), FilmSumsError> {
        let same = [
            (self.of == other.of, "the scene"),
            (self.resolution == other.resolution, "the size"),
            (self.crop == other.crop, "the crop"),
            (self.seed == other.seed, "the seed"),
            (self.sampler == other.sampler, "the sampler"),
            (self.filter == other.filter, "the pixel filter"),
            (self.target_error == other.target_error, "the target error"),
            (self.mattes == other.mattes, "what mattes there are"),
        ];
        match same.into_iter().find(|(same, _)| !same) {
            Some((_, what)) => Err(FilmSumsError::Foreign { what }),
            None => Ok(()),
        }
    }

    /// Whether sums of the one may go on as the other.
    pub(super) fn same_picture(&self, other: &Self) -> Result<(), FilmSumsError> {
        self.same_samples(other)?;
        if (self.first, self.spp) != (other.first, other.spp) {
            return Err(FilmSumsError::Foreign {
                what: "the range of samples",
            });
        }
        Ok(())
    }

    /// The tiles of a file's sums, or what is wrong with its header.
    pub(super) fn check(&self) -> Result<Vec<Crop>, String> {
        if self.version != VERSION {
            return Err(format!("it is of version {}, not {VERSION}", self.version));
        }
        let job = self.job();
        let crop = job.check().map_err(|e| e.to_string())?;
        let tiles = extents(&job, &crop);
        let end = self.first + self.spp;
        if self.next.len() != tiles.len()
            || self.next.iter().any(|n| !(self.first..=end).contains(n))
        {
            return Err("its tiles are not those of its size".to_owned());
        }
        Ok(tiles)
    }
}

/// Exact sums of some samples of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmSums {
    pub(super) header: Header,
    /// Tile by tile.
    pub(super) pixels: Vec<PixelSums>,
    /// Counts of what each pixel's samples saw; empty if they were not taken.
    pub(super) mattes: Vec<u32>,
}

impl FilmSums {
    /// What the samples are of: the text given to [`super::Rendering::sums`].
    pub fn of(&self) -> &str {
        &self.header.of
    }

    /// The samples: first, and one past the last.
    pub fn range(&self) -> [u32; 2] {
        [self.header.first, self.header.first + self.header.spp]
    }

    /// Puts finished ranges of samples together, whatever their order. One alone is taken as it is.
    ///
    /// * `parts`: each with its name.
    ///
    /// # Errors
    /// By name: sums of different pictures, several of which one is unfinished, gaps and overlaps.
    pub fn merge(mut parts: Vec<(PathBuf, Self)>) -> Result<Self, FilmSumsError> {
        parts.sort_by_key(|(_, part)| part.header.first);
        let in_file = |path: PathBuf| {
            move |source| FilmSumsError::In {
                path,
                source: Box::new(source),
            }
        };
        if parts.len() > 1 {
            for (path, part) in &parts {
                part.finished().map_err(in_file(path.clone()))?;
            }
        }
        let mut parts = parts.into_iter();
        let (_, mut all) = parts.next().ok_or(FilmSumsError::Nothing)?;
        for (path, part) in parts {
            all.append(part).map_err(in_file(path))?;
        }
        Ok(all)
    }

    fn append(&mut self, later: Self) -> Result<(), FilmSumsError> {
        self.header.same_samples(&later.header)?;
        let ([_, end], [next, _]) = (self.range(), later.range());
        if next != end {
            return Err(FilmSumsError::Gap { end, next });
        }
        for (sums, later) in self.pixels.iter_mut().zip(&later.pixels) {
            sums.append(later);
        }
        for (count, later) in self.mattes.iter_mut().zip(&later.mattes) {
            *count += later;
        }
        self.header.spp += later.header.spp;
        self.header.next = later.header.next;
        self.header.counts.add(&later.header.counts);
        Ok(())
    }

    /// Whether every tile has all samples of the range, so that later ones can follow.
    fn finished(&self) -> Result<(), FilmSumsError> {
        let [first, end] = self.range();
        match self.header.next.iter().copied().min() {
            Some(at) if at < end => Err(FilmSumsError::Unfinished { first, end, at }),
            _ => Ok(()),
        }
    }

    /// The picture.
    pub fn film(&self) -> Film {
        let (header, job) = (&self.header, self.header.job());
        let extents = extents(&job, &header.crop);
        let tiles = parts(&self.pixels, &extents, 1);
        let done = |(next, (_, sums)): (&u32, &(Crop, &[PixelSums]))| enough(&job, *next, sums);
        Film {
            crop: header.crop,
            resolution: header.resolution,
            report: Report {
                complete: header.next.iter().zip(&tiles).all(done),
                ..header.counts.report()
            },
            mattes: header.mattes.as_ref().map(|names| {
                let tiles = parts(&self.mattes, &extents, names.columns());
                Mattes::assemble(names, tiles.into_iter(), &header.crop)
            }),
            pixels: assemble(tiles.into_iter(), &header.crop),
        }
    }
}

/// An array tile by tile.
///
/// * `each`: its entries a pixel.
fn parts<'a, T>(mut array: &'a [T], tiles: &[Crop], each: usize) -> Vec<(Crop, &'a [T])> {
    let part = |tile: &Crop| {
        let (part, later) = array.split_at(tile.pixels() * each);
        array = later;
        (*tile, part)
    };
    tiles.iter().map(part).collect()
}
