//! `vair convert`: strands from one file format into another.

use super::grids::write_grids;
use super::{Console, Failure};
use crate::blame::Blame;
use crate::export::lines::{self, LineFormat, LineSet};
use crate::export::volume::{self, Curves, Field, Mesh, VolumeSettings};
use crate::export::{ExportError, Format};
use crate::io::check_writable;
use glam::Vec3;
use std::path::{Path, PathBuf};

/// Arguments of `vair convert`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair convert wWavy.hair -o wavy.npz
  vair convert straight.hair --scale 0.0254 --width-um 80 -o straight.pbrt -o straight.glb
  vair convert curly.hair --scale 0.01 -o curly.vdb

Reads Cem Yuksel's hair files. Their unit is not written in them: --scale brings it to meters, which
grids (.vdb) and widths count on.")]
pub(super) struct Args {
    /// A .hair file.
    input: PathBuf,
    /// Factor on coordinates and widths.
    #[arg(long, default_value_t = 1.0)]
    scale: f32,
    /// Diameter of all strands instead of the file's, micrometers of a meter after scaling.
    #[arg(long, value_name = "UM")]
    width_um: Option<f32>,
    /// Where the strands go: .hair, .npz, .ply, .glb, .pbrt, .txt for Mitsuba, or .vdb for grids. May repeat.
    #[arg(long, short, required = true)]
    output: Vec<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// What was refused or could not be written; no file is left half-written.
pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    for (option, value) in [("--scale", Some(args.scale)), ("--width-um", args.width_um)] {
        if value.is_some_and(|v| !(v > 0.0 && v.is_finite())) {
            let message = format!("{option} must be above 0 and finite");
            return Err(Failure::new(Blame::Input, message));
        }
    }
    for output in &args.output {
        target(output)?;
        check_writable(output)?;
    }
    let suffix = args.input.extension().and_then(|e| e.to_str());
    if suffix
        .is_none_or(|s| LineFormat::of_suffix(&s.to_ascii_lowercase()) != Some(LineFormat::Hair))
    {
        return Err(Failure::with_help(
            Blame::Input,
            format!(
                "{}: strands are read from .hair files only",
                args.input.display()
            ),
            "other formats are written, not read",
        ));
    }
    let set = scaled(lines::read_hair(&args.input)?, args)?;
    console.say(format!(
        "{}: {} strands, {} points",
        args.input.display(),
        set.offsets.len() - 1,
        set.points.len()
    ));
    let name = args.input.file_name().unwrap_or_default().to_string_lossy();
    for output in &args.output {
        match target(output)? {
            Format::Lines(format) => lines::write(output, format, &set.lines(&name))?,
            _ => write_density(output, &set, console)?,
        }
    }
    Ok(())
}

/// The format of an output that strands without an animal can have.
fn target(path: &Path) -> Result<Format, Failure> {
    match Format::of(path) {
        Ok(format @ (Format::Lines(_) | Format::Vdb)) => Ok(format),
        _ => Err(Failure::with_help(
            Blame::Input,
            ExportError::Suffix {
                path: path.to_owned(),
            },
            "end the name in .hair, .npz, .ply, .glb, .pbrt, .txt or .vdb",
        )),
    }
}

/// The strands in the unit and of the width asked for.
fn scaled(mut set: LineSet, args: &Args) -> Result<LineSet, Failure> {
    for point in &mut set.points {
        *point *= args.scale;
    }
    for width in &mut set.widths {
        *width = args.width_um.map_or(*width * args.scale, |um| um * 1e-6);
    }
    let infinite = [
        ("coordinates", set.points.iter().any(|p| !p.is_finite())),
        ("widths", set.widths.iter().any(|w| !w.is_finite())),
    ];
    if let Some((what, _)) = infinite.iter().find(|(_, any)| *any) {
        let message = format!("--scale {} makes {what} infinite", args.scale);
        return Err(Failure::new(Blame::Input, message));
    }
    if set.widths.iter().all(|w| *w == 0.0) {
        return Err(Failure::with_help(
            Blame::Input,
            format!(
                "{}: all strands have a thickness of 0",
                args.input.display()
            ),
            "give their diameter with --width-um",
        ));
    }
    Ok(set)
}

fn write_density(path: &Path, set: &LineSet, console: &Console) -> Result<(), Failure> {
    let colors: Vec<Vec3> = set
        .colors
        .iter()
        .map(|c| volume::scattering_albedo(*c))
        .collect();
    let curves = Curves {
        points: &set.points,
        widths: &set.widths,
        offsets: &set.offsets,
        colors: &colors,
    };
    let settings = VolumeSettings {
        fields: vec![Field::Density, Field::Color, Field::Tangent],
        ..VolumeSettings::default()
    };
    let no_skin = Mesh {
        name: "",
        positions: &[] as &[Vec3],
        triangles: &[],
    };
    let cancel = console.cancel();
    let plan = volume::plan(&curves, &settings, console, cancel)?;
    write_grids(path, |file| {
        volume::write(file, &curves, &no_skin, &plan, &settings, console, cancel)
    })?;
    Ok(())
}
