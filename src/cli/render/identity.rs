//! What a picture is of: sums of other samples of it may be added, and of no other.

use super::args::{Args, ModelArg};
use super::output::{self, Format, Origin};
use crate::bake::{Settings, content_hash};
use crate::cli::Failure;
use crate::groom::Groom;
use crate::hex::hex;
use crate::io::FileError;
use crate::scene::Scene;
use crate::species::Species;
use sha2::{Digest, Sha256};
use std::path::Path;

/// All that decides the samples besides the job.
pub(super) fn of(
    args: &Args,
    species: &Species,
    groom: &Groom,
    scene: &Scene,
) -> Result<Origin, Failure> {
    let res = args.res();
    let mut settings = format!(
        "skin {} env {} env-turn {} res {}x{} sampler {:?} strands {:?} bake-photons {}",
        args.on.name(),
        args.env(),
        args.env_turn(),
        res[0],
        res[1],
        args.sampler(),
        args.strands,
        args.bake_photons
    );
    if args.azimuths != 1 {
        settings += &format!(" azimuths {}", args.azimuths);
    }
    settings += &match args.model {
        ModelArg::Table => String::new(),
        ModelArg::Chiang | ModelArg::ChiangFit => {
            format!(" model {:?} {:?}", args.model, args.chiang)
        }
        ModelArg::DoubleCylinder => format!(" model {:?} {:?}", args.model, args.double_cylinder),
        ModelArg::DoubleCylinderFit => format!(" model {:?}", args.model),
    };
    settings += &format!(" tables {:?} ground {}", args.table, !args.no_ground);
    if args.env_visible {
        settings += " env-visible";
    }
    if args.coat.as_deref() == Some("none") {
        settings += " coat none";
    }
    for (lamp, with_camera) in &args.lamps {
        settings += &format!(" {lamp:?} with camera {with_camera}");
    }
    // Only what goes on later has to be known again, and large grooms take a while to hash.
    let is_kept = args.checkpoint.is_some()
        || (args.output.iter()).any(|path| matches!(output::format_of(path), Ok(Format::Sums)));
    Ok(Origin {
        species: species.id.clone(),
        species_text: species.text.clone(),
        settings,
        seed: args.seed(),
        view: format!("{:?}", scene.view),
        content: match is_kept {
            true => content(args, species, groom, scene)?,
            false => String::new(),
        },
    })
}

/// Hash of what names do not tell: the program, everything that rays can meet and the parts of the coat that it
/// belongs to, what is in the files of fibers, spectra, tables and the environment.
fn content(
    args: &Args,
    species: &Species,
    groom: &Groom,
    scene: &Scene,
) -> Result<String, FileError> {
    let mut hasher = Sha256::new_with_prefix(crate::PROGRAM);
    for class in &species.classes {
        for station in &class.stations {
            hasher.update(content_hash(&station.structure, &Settings::cone()));
        }
    }
    let environment = match args.env() {
        "studio" | "sky" | "white" | "black" => None,
        file => Some(Path::new(file)),
    };
    for path in args.table.iter().map(AsRef::as_ref).chain(environment) {
        let bytes = std::fs::read(path).map_err(|e| FileError::new("read", path, e))?;
        hasher.update(Sha256::digest(bytes));
    }
    hasher.update(&groom.coat);
    for (_, joint) in scene.strands.joints() {
        for x in joint.to_array() {
            hasher.update(x.to_le_bytes());
        }
    }
    for corner in scene
        .surface
        .iter()
        .flat_map(|s| s.corners().iter().flatten())
    {
        for x in corner.to_array() {
            hasher.update(x.to_le_bytes());
        }
    }
    Ok(hex(&hasher.finalize()))
}
