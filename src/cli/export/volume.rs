//! The part of `vair export` that writes grids.

use super::super::bake::parse_bytes;
use super::super::grids::write_grids;
use super::super::{Console, Failure};
use crate::blame::Blame;
use crate::export::asset::{self, Frame, Parts};
use crate::export::usd::{self, Form};
use crate::export::vdb::{Compression, Meta};
use crate::export::volume::{self, Curves, Field, Mesh, Plan, VolumeSettings, Written};
use crate::export::{ExportError, Format};
use crate::io::{AtomicFile, FileError};
use glam::Vec3;
use std::path::{Path, PathBuf};

/// Arguments of `vair export` that concern .vdb files.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Grids (.vdb)")]
pub(super) struct VolumeArgs {
    /// Which grids: density, color, Cd, tangent, width, coverage, fraction, surface.
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "GRIDS",
        default_value = "density,color,tangent"
    )]
    grids: Vec<String>,
    /// Edge of a voxel, millimeters; if not given, so that some eight strands pass through one.
    #[arg(long, value_name = "MM")]
    voxel_mm: Option<f64>,
    /// Store values in half precision.
    #[arg(long)]
    half: bool,
    /// How values are stored.
    #[arg(long, value_enum, value_name = "HOW", default_value = "zip")]
    vdb_compression: CompressionArg,
    /// Thickness of the skin for the grid `surface`, millimeters; an open skin needs one.
    #[arg(long, value_name = "MM", default_value_t = 0.0)]
    shell_mm: f64,
    /// Most memory for grids. Voxels grow until they fit, unless --voxel-mm is given.
    #[arg(long, value_name = "BYTES", value_parser = parse_bytes, default_value = "2G")]
    grid_memory: u64,
    /// Also write a USD layer that shows the grids as a Volume: .usda, .usdc or .usd.
    #[arg(long, value_name = "FILE")]
    pub(super) wrap: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum CompressionArg {
    /// Deflated, node by node.
    Zip,
    /// As they are.
    None,
}

/// What was asked for in the words of the library; refuses what cannot be.
pub(super) fn settings(
    args: &VolumeArgs,
    outputs: &[PathBuf],
    frame: Frame,
) -> Result<VolumeSettings, Failure> {
    let mut fields = Vec::new();
    for name in &args.grids {
        let Some(field) = Field::of_name(name.trim()) else {
            let known: Vec<&str> = Field::ALL.iter().map(|f| f.name()).collect();
            return Err(Failure::with_help(
                Blame::Input,
                format!("`{name}` is no grid that --grids knows"),
                format!("there are {}", known.join(", ")),
            ));
        };
        if !fields.contains(&field) {
            fields.push(field);
        }
    }
    for (option, value) in [
        ("--voxel-mm", args.voxel_mm),
        ("--shell-mm", Some(args.shell_mm)),
    ] {
        if let Some(value) = value.filter(|v| !(0.0..=1000.0).contains(v)) {
            let message = format!("{option} is {value}, must be 0 to 1000");
            return Err(Failure::new(Blame::Input, message));
        }
    }
    if let Some(wrap) = &args.wrap {
        let formats: Result<Vec<Format>, ExportError> =
            outputs.iter().map(|o| Format::of(o)).collect();
        let grids = formats?.into_iter().filter(|f| *f == Format::Vdb).count();
        if grids != 1 {
            let message = format!("--wrap shows one .vdb file, but {grids} are written");
            return Err(Failure::new(Blame::Input, message));
        }
        form_of(wrap)?;
        crate::io::check_writable(wrap)?;
    }
    let units = 1e-3 / frame.meters_per_unit();
    Ok(VolumeSettings {
        fields,
        meters_per_unit: frame.meters_per_unit(),
        voxel: args.voxel_mm.map(|mm| mm * units),
        half: args.half,
        compression: match args.vdb_compression {
            CompressionArg::Zip => Compression::Zip,
            CompressionArg::None => Compression::None,
        },
        memory: args.grid_memory,
        shell: args.shell_mm * units,
        provenance: Vec::new(),
    })
}

fn form_of(path: &Path) -> Result<Form, Failure> {
    match Format::of(path)? {
        Format::Usd(form) => Ok(form),
        _ => {
            let message = format!("--wrap {}: no USD layer", path.display());
            let help = "end the name in .usda, .usdc or .usd";
            Err(Failure::with_help(Blame::Input, message, help))
        }
    }
}

/// Writes the grids of a groom.
pub(super) fn run(
    path: &Path,
    parts: &Parts<'_>,
    args: &VolumeArgs,
    settings: &VolumeSettings,
    frame: Frame,
    console: &Console,
) -> Result<(), Failure> {
    let groom = parts.groom;
    asset::check(groom)?;
    let has_color = settings
        .fields
        .iter()
        .any(|f| matches!(f, Field::Color | Field::Cd));
    let colors = match has_color {
        true => asset::colors(groom, parts.species)
            .into_iter()
            .map(volume::scattering_albedo)
            .collect(),
        false => Vec::new(),
    };
    // Copies only where the file has another frame than the groom.
    let framed = |points: &[Vec3]| -> Option<Vec<Vec3>> {
        (frame != Frame::default()).then(|| points.iter().map(|p| frame.point(*p)).collect())
    };
    let points = framed(&groom.points);
    let widths: Option<Vec<f32>> = (frame != Frame::default())
        .then(|| groom.widths.iter().map(|w| frame.length(*w)).collect());
    let mut positions = framed(&parts.skin.positions);
    if settings.fields.contains(&Field::Surface) {
        let (welded, moved) = volume::weld(positions.as_deref().unwrap_or(&parts.skin.positions));
        positions = Some(welded);
        if moved > 0 {
            console.say(format!(
                "{moved} vertices of the skin within a millionth of its size of another were welded to it"
            ));
        }
    }
    let curves = Curves {
        points: points.as_deref().unwrap_or(&groom.points),
        widths: widths.as_deref().unwrap_or(&groom.widths),
        offsets: &groom.offsets,
        colors: &colors,
    };
    let skin = Mesh {
        name: &parts.skin.name,
        positions: positions.as_deref().unwrap_or(&parts.skin.positions),
        triangles: &parts.skin.triangles,
    };
    let settings = VolumeSettings {
        provenance: provenance(parts),
        ..settings.clone()
    };
    if settings.fields.contains(&Field::Surface) && settings.shell == 0.0 {
        // Before the long work.
        skin.check_closed()?;
    }
    let cancel = console.cancel();
    let plan = volume::plan(&curves, &settings, console, cancel)?;
    let mm = 1e3 * settings.meters_per_unit;
    let statistics = &plan.statistics;
    let spacing = statistics.length_density.powf(-0.5) * mm;
    console.say(format!(
        "voxels of {:.4} mm for strands {:.4} mm apart and {:.1} mm long: {} leaves of 8 x 8 x 8, {:.0} MB of memory",
        plan.voxel * mm,
        spacing,
        statistics.mean_length * mm,
        plan.leaves,
        plan.memory as f64 / 1e6
    ));
    let written = write_grids(path, |file| {
        volume::write(file, &curves, &skin, &plan, &settings, console, cancel)
    })?;
    console.say(format!("{}: {}", path.display(), described(&written)));
    match &args.wrap {
        Some(wrap) => write_wrap(wrap, path, parts, &written, &plan, frame),
        None => Ok(()),
    }
}

/// What makes the same grids again, as metadata of every grid.
fn provenance(parts: &Parts<'_>) -> Vec<(String, Meta)> {
    let entries = [
        ("vair_species", parts.species.id.clone()),
        ("vair_skin", parts.skin.name.clone()),
        ("vair_seed", parts.seed.to_string()),
        ("vair_strands", parts.groom.strands().to_string()),
    ];
    let entry = |(name, text): (&str, String)| (name.to_owned(), Meta::Text(text));
    entries.into_iter().map(entry).collect()
}

fn described(written: &[Written]) -> String {
    let of = |w: &Written| format!("{} {} voxels", w.field.name(), w.active);
    written.iter().map(of).collect::<Vec<_>>().join(", ")
}

fn write_wrap(
    wrap: &Path,
    grids: &Path,
    parts: &Parts<'_>,
    written: &[Written],
    plan: &Plan,
    frame: Frame,
) -> Result<(), Failure> {
    let form = form_of(wrap)?;
    let file = relative(grids, wrap);
    let name = asset::identifier(&parts.species.id);
    let layer = volume::stage(&file, &name, written, plan, frame);
    let mut out = AtomicFile::create(wrap)?;
    usd::write(&layer, form, &mut out, &mut |_| Ok(()))
        .map_err(|e| FileError::new("write", wrap, e))?;
    Ok(out.commit()?)
}

/// The path of `to` as a layer at `from` names it.
fn relative(to: &Path, from: &Path) -> String {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let (to, from) = (absolute(to), absolute(from));
    let (to, from): (Vec<_>, Vec<_>) = (to.components().collect(), from.components().collect());
    let shared = to.iter().zip(&from).take_while(|(a, b)| a == b).count();
    let up = from.len().saturating_sub(shared + 1);
    let steps = std::iter::repeat_n("..".to_owned(), up);
    let down = to[shared..]
        .iter()
        .map(|step| step.as_os_str().to_string_lossy().into_owned());
    let path: Vec<String> = steps.chain(down).collect();
    match up {
        0 => format!("./{}", path.join("/")),
        _ => path.join("/"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_name_grids_from_where_they_are() {
        for (to, from, expected) in [
            ("a.vdb", "b.usda", "./a.vdb"),
            ("./a.vdb", "b.usda", "./a.vdb"),
            ("sub/a.vdb", "b.usda", "./sub/a.vdb"),
            ("a.vdb", "layers/deep/b.usda", "../../a.vdb"),
            ("grids/a.vdb", "layers/b.usda", "../grids/a.vdb"),
            ("/x/a.vdb", "/x/y/b.usda", "../a.vdb"),
        ] {
            assert_eq!(relative(Path::new(to), Path::new(from)), expected);
        }
    }
}
