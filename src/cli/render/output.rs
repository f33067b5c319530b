//! Pictures of a film, by the names of their files.

use super::Args;
use crate::blame::Blame;
use crate::cli::Failure;
use crate::image::{self, Curve, ViewTransform};
use crate::render::Film;
use crate::species::Species;
use std::path::{Path, PathBuf};

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Format {
    Png,
    Exr,
}

pub(super) fn format_of(path: &Path) -> Result<Format, Failure> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    match extension.to_ascii_lowercase().as_str() {
        "png" => Ok(Format::Png),
        "exr" => Ok(Format::Exr),
        _ => Err(Failure::with_help(
            Blame::Input,
            format!(
                "{} is no kind of picture that can be written",
                path.display()
            ),
            "end the name in .png or .exr",
        )),
    }
}

/// Writes the film to all outputs.
pub(super) fn write(args: &Args, species: &Species, film: &Film) -> Result<(), Failure> {
    let settings = format!(
        "skin {} env {} env-turn {} res {}x{} spp {} sampler {:?} strands {:?} bake-photons {}",
        args.skin,
        args.env,
        args.env_turn,
        args.res[0],
        args.res[1],
        args.spp,
        args.sampler,
        args.strands,
        args.bake_photons
    ) + &match args.azimuths {
        1 => String::new(),
        n => format!(" azimuths {n}"),
    };
    let seed = args.seed.to_string();
    let provenance = [
        ("program", concat!("vair ", env!("CARGO_PKG_VERSION"))),
        ("species", species.id.as_str()),
        ("species_text", species.text.as_str()),
        ("settings", settings.as_str()),
        ("seed", seed.as_str()),
    ];
    let curve = if args.plain {
        Curve::Clip
    } else {
        Curve::Shoulder
    };
    let view = ViewTransform {
        exposure_ev: args.exposure,
        curve,
    };
    for output in &args.output {
        match format_of(output)? {
            Format::Png if args.no_denoise => {
                image::write_film_png(output, film, &view, &provenance)?;
            }
            Format::Png => {
                image::write_film_png(output, &image::denoise(film), &view, &provenance)?;
            }
            Format::Exr => image::write_film_exr(output, film, &provenance)?,
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
