//! Pictures of a film, by the names of their files.

use crate::blame::Blame;
use crate::cli::{Failure, named};
use crate::image::{self, ViewTransform};
use crate::render::{Film, FilmSums};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// How a PNG shows the picture.
#[derive(Clone, Debug, clap::Args)]
pub(in crate::cli) struct Look {
    /// Exposure of the PNG, in stops; 0 if not given.
    #[arg(long)]
    exposure: Option<f32>,
    /// How the PNG shows bright parts; soft if not given.
    #[arg(long, value_enum)]
    look: Option<LookArg>,
    /// Write the PNG as it was sampled. By default noise is taken out of it, never out of the EXR.
    #[arg(long)]
    no_denoise: bool,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum LookArg {
    /// As they are up to one half, then rolled off.
    Soft,
    /// Toe and shoulder of film, darker in all.
    Filmic,
    /// Colors as they are up to 0.8; brighter ones keep their hue.
    Neutral,
    /// As they are, cut at white.
    Srgb,
}

impl Look {
    /// Fills what is not given with what a scene file says.
    pub(super) fn fill(&mut self, look: Option<&str>, exposure: Option<f32>) {
        self.look = self.look.or(look.and_then(named));
        self.exposure = self.exposure.or(exposure);
    }
}

/// Where a picture comes from: all that decides its samples besides their numbers.
#[derive(Debug, Serialize, Deserialize)]
pub(in crate::cli) struct Origin {
    pub(super) species: String,
    pub(super) species_text: String,
    pub(super) settings: String,
    pub(super) seed: u64,
    pub(super) view: String,
    /// Hash of what the others only name; empty where nothing is to go on.
    pub(super) content: String,
}

impl Origin {
    /// As it stands in files of sums.
    pub(super) fn text(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// From a file of sums.
    pub(in crate::cli) fn of(sums: &FilmSums) -> Option<Self> {
        serde_json::from_str(sums.of()).ok()
    }
}

#[derive(Clone, Copy, PartialEq)]
pub(in crate::cli) enum Format {
    Png,
    Exr,
    Sums,
}

pub(in crate::cli) fn format_of(path: &Path) -> Result<Format, Failure> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    match extension.to_ascii_lowercase().as_str() {
        "png" => Ok(Format::Png),
        "exr" => Ok(Format::Exr),
        "safetensors" => Ok(Format::Sums),
        _ => Err(Failure::with_help(
            Blame::Input,
            format!(
                "{} is no kind of picture that can be written",
                path.display()
            ),
            "end the name in .png or .exr, or in .safetensors for sums to be merged",
        )),
    }
}

/// Writes the film to all outputs.
pub(in crate::cli) fn write(
    outputs: &[PathBuf],
    look: &Look,
    film: &Film,
    origin: &Origin,
    sums: impl Fn() -> FilmSums,
) -> Result<(), Failure> {
    let seed = origin.seed.to_string();
    let provenance = [
        ("program", crate::PROGRAM),
        ("species", origin.species.as_str()),
        ("species_text", origin.species_text.as_str()),
        ("settings", origin.settings.as_str()),
        ("seed", seed.as_str()),
    ];
    let view = ViewTransform {
        exposure_ev: look.exposure.unwrap_or(0.0),
        look: match look.look.unwrap_or(LookArg::Soft) {
            LookArg::Soft => image::Look::Soft,
            LookArg::Filmic => image::Look::Filmic,
            LookArg::Neutral => image::Look::Neutral,
            LookArg::Srgb => image::Look::Srgb,
        },
    };
    for output in outputs {
        match format_of(output)? {
            Format::Png if look.no_denoise => {
                image::write_film_png(output, film, &view, &provenance)?;
            }
            Format::Png => {
                image::write_film_png(output, &image::denoise(film), &view, &provenance)?;
            }
            Format::Exr => image::write_film_exr(output, film, &provenance)?,
            Format::Sums => sums().write(output)?,
        }
    }
    Ok(())
}

/// The names of all outputs.
pub(super) fn list(paths: &[PathBuf]) -> String {
    paths
        .iter()
        .map(|path| path.display().to_string())
        .collect::<Vec<_>>()
        .join(", ")
}
