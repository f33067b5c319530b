//! Path tracing of a [`Scene`] to a [`Film`].

mod direct;
mod draws;
mod film;
mod filter;
mod mattes;
mod path;
mod rendering;
mod resample;
mod scatter;
mod sums;
mod sums_file;
mod worth;

pub use film::{Crop, Film, NO_STRAND, Pixel, Report};
pub use filter::{Filter, GAUSSIAN_SIGMA};
pub use mattes::{MatteNames, Mattes};
pub use rendering::Rendering;
pub use sums::{FilmSums, FilmSumsError};

use crate::blame::Blame;
use crate::color::luminance;
use crate::progress::{Cancel, Progress};
use crate::scene::Scene;
use path::Integrator;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Largest side of a picture, pixels.
pub const SIDE_LIMIT: u32 = 32_768;

/// Most samples a pixel.
pub const SPP_LIMIT: u32 = 1 << 24;

/// How directions are drawn. All converge to the same picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Sampler {
    /// Direct light by quasi-random sampling importance resampling of scattering times environment: rays are
    /// sent in proportion to what they would bring; the path goes on by the scattering model, its escapes
    /// weighted in.
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
    /// Samples a pixel, 1..=[`SPP_LIMIT`]; the most if there is a target.
    pub spp: u32,
    /// Index of the first sample: ranges of samples make one picture when they are put together.
    pub first: u32,
    /// Relative error at which a tile has samples enough: root mean square over its pixels of the standard
    /// error of luminance, over its mean luminance (but for the darkest tiles).
    pub target_error: Option<f64>,
    /// Another seed gives another noise.
    pub seed: u64,
    /// How directions are drawn.
    pub sampler: Sampler,
    /// How samples spread over and around their pixel.
    pub filter: Filter,
    /// Whether samples are also counted by what they saw.
    pub mattes: bool,
    /// Stop after this time with the samples there are; the first pass is always finished.
    pub time_limit: Option<Duration>,
}

impl Default for RenderJob {
    fn default() -> Self {
        Self {
            resolution: [960, 720],
            crop: None,
            spp: 64,
            first: 0,
            target_error: None,
            seed: 0,
            sampler: Sampler::Qsir,
            filter: Filter::Gaussian,
            mattes: false,
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
    #[error("the crop {},{},{},{} is not inside the picture of {width} x {height} pixels",
        crop.x, crop.y, crop.width, crop.height)]
    Crop {
        /// The crop.
        crop: Crop,
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// A target that no picture can meet.
    #[error("a relative error of {error} cannot be aimed at: it must be above 0")]
    Target {
        /// What was asked for.
        error: f64,
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

impl RenderJob {
    /// Checks the numbers and gives the pixels to render.
    pub fn check(&self) -> Result<Crop, RenderError> {
        let [width, height] = self.resolution;
        if !(1..=SIDE_LIMIT).contains(&width) || !(1..=SIDE_LIMIT).contains(&height) {
            return Err(RenderError::Resolution { width, height });
        }
        if !(1..=SPP_LIMIT).contains(&self.spp) || self.first > SPP_LIMIT - self.spp {
            let spp = self.spp.saturating_add(self.first);
            return Err(RenderError::Spp { spp });
        }
        if let Some(error) = self.target_error
            && !(error > 0.0 && error < f64::INFINITY)
        {
            return Err(RenderError::Target { error });
        }
        let crop = self.crop.unwrap_or(Crop::whole(self.resolution));
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

    /// Bytes that the sums of a checked job and the film made of them take together.
    pub fn memory(&self) -> u64 {
        let crop = self.crop.unwrap_or(Crop::whole(self.resolution));
        let pixel = std::mem::size_of::<film::PixelSums>() + std::mem::size_of::<Pixel>();
        u64::from(crop.width) * u64::from(crop.height) * pixel as u64
    }

    /// Renders. See [`Rendering`] for pictures that are saved on the way.
    ///
    /// * Stopped by `cancel` or the time limit, the film holds what there is. Only a cancel within the first
    ///   pass leaves pixels without a sample; then `report.passes` is 0.
    /// * The same job on the same scene gives the same bits on any number of threads, unless it is
    ///   stopped; a crop gives the bits of the full frame.
    pub fn run(
        &self,
        scene: &Scene,
        progress: &dyn Progress,
        cancel: &Cancel,
    ) -> Result<Film, RenderError> {
        let mut rendering = Rendering::new(self, scene)?;
        rendering.run(None, progress, cancel);
        Ok(rendering.film())
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
            enough: path::ENOUGH * luminance(scene.mean_light()),
            far_share: luminance(scene.environment.mean())
                / luminance(scene.mean_light()).max(f32::MIN_POSITIVE),
            #[cfg(test)]
            bare_target: false,
        }
    }
}

#[cfg(test)]
mod lamp_tests;
#[cfg(test)]
mod tests;
