//! `vair fiber`: a fiber as a microscopist would draw it, or as a mesh.

mod mesh;
mod plate;
mod specimen;

use super::bake::{find_class, find_station};
use super::{Console, Failure};
use crate::blame::Blame;
use crate::fiber::{Fiber, FiberError};
use crate::io::check_writable;
use crate::species::{self, CuticlePattern, HairClass, Species, Station, Structure};
use plate::Labels;
use serde_json::json;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Arguments of `vair fiber`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair fiber red-fox -o fox.png
  vair fiber mink --class under -o mink-under.png --size 1920x1080
  vair fiber polar-bear --station 0.2 -o bear.obj --json
  vair fiber human --set guard.stations.0.cuticle.pitch_um=12 -o human.ply")]
pub(super) struct Args {
    /// A built-in species or a path to a species file.
    name: String,
    /// Hair class; the first of the species if not given.
    #[arg(long)]
    class: Option<String>,
    /// Position along the hair, 0 root to 1 tip: the nearest station is built. The thickest part
    /// (the last station) if not given.
    #[arg(long)]
    station: Option<f64>,
    /// Override a field of the species. May repeat.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Size of the picture, pixels.
    #[arg(long, value_parser = parse_size, default_value = "1280x720")]
    size: (usize, usize),
    /// Seed of scales and voids.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Print a summary of the fiber as JSON.
    #[arg(long)]
    json: bool,
    /// Where it goes: .png is a picture; .obj and .ply are meshes of one period with the parts
    /// `cuticle` and `medulla`. May repeat.
    #[arg(long, short)]
    output: Vec<PathBuf>,
}

impl From<FiberError> for Failure {
    fn from(error: FiberError) -> Self {
        Self::new(error.blame(), error)
    }
}

/// `1280x720`.
fn parse_size(text: &str) -> Result<(usize, usize), String> {
    let refuse = || format!("`{text}` is not a size such as 1280x720, 320x180 to 8192x8192");
    let (w, h) = text.split_once('x').ok_or_else(refuse)?;
    let number = |s: &str| s.parse::<usize>().map_err(|_| refuse());
    let (w, h) = (number(w)?, number(h)?);
    if (320..=8192).contains(&w) && (180..=8192).contains(&h) {
        Ok((w, h))
    } else {
        Err(refuse())
    }
}

/// Runs the command.
pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    if args.output.is_empty() && !args.json {
        let message = "nothing to do: neither --output nor --json is given";
        return Err(Failure::new(Blame::Input, message));
    }
    let species = species::load(&args.name, &args.set)?;
    let class = find_class(&species, args.class.as_deref())?;
    let station = find_station(class, args.station)?;
    for path in &args.output {
        format_of(path)?;
        check_writable(path)?;
    }
    let fiber = Fiber::build(&station.structure, args.seed)?;
    for path in &args.output {
        match format_of(path)? {
            Format::Png => {
                let labels = labels(&species, class, station, &fiber);
                let cancel = console.cancel();
                let picture = plate::draw(&fiber, &labels, args.size, console, cancel);
                let Some(picture) = picture else {
                    return Err(Failure::new(Blame::Interrupted, "stopped; nothing written"));
                };
                picture.write_png(path)?;
            }
            Format::Obj => mesh::write_obj(path, &fiber.mesh())?,
            Format::Ply => mesh::write_ply(path, &fiber.mesh())?,
        }
    }
    if args.json {
        let text = format!("{:#}\n", summary(&species, class, station, &fiber));
        if let Err(error) = std::io::stdout().lock().write_all(text.as_bytes())
            && error.kind() != std::io::ErrorKind::BrokenPipe
        {
            let message = format!("cannot write to stdout: {error}");
            return Err(Failure::new(Blame::Environment, message));
        }
    }
    Ok(())
}

enum Format {
    Png,
    Obj,
    Ply,
}

fn format_of(path: &Path) -> Result<Format, Failure> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    match extension.to_ascii_lowercase().as_str() {
        "png" => Ok(Format::Png),
        "obj" => Ok(Format::Obj),
        "ply" => Ok(Format::Ply),
        _ => Err(Failure::with_help(
            Blame::Input,
            format!("{}: unknown kind of file", path.display()),
            "the name must end in .png, .obj or .ply",
        )),
    }
}

/// Tilt of the scales, degrees.
fn tilt_deg(structure: &Structure) -> f64 {
    let cuticle = &structure.cuticle;
    if cuticle.pattern == CuticlePattern::Smooth {
        return 0.0;
    }
    (cuticle.height_um / cuticle.pitch_um).atan().to_degrees()
}

fn labels(species: &Species, class: &HairClass, station: &Station, fiber: &Fiber) -> Labels {
    let s = &station.structure;
    let c = &s.cuticle;
    let mut facts = vec![format!(
        "{} \u{b5}m thick, aspect {}",
        s.diameter_um, s.aspect
    )];
    facts.push(if c.pattern == CuticlePattern::Smooth {
        "cuticle: smooth".to_owned()
    } else {
        format!(
            "cuticle: {}, {} round, pitch {} \u{b5}m, step {} \u{b5}m, tilt {:.1}\u{b0}",
            c.pattern.name(),
            c.around,
            c.pitch_um,
            c.height_um,
            tilt_deg(s)
        )
    });
    let air = fiber.air_fraction();
    facts.push(match s.medulla.kind.name() {
        "none" => "medulla: none".to_owned(),
        name if air > 0.0 => format!(
            "medulla: {name}, index {:.2}, {:.0} % air",
            s.medulla.ratio,
            100.0 * air
        ),
        name => format!("medulla: {name}, index {:.2}", s.medulla.ratio),
    });
    let latin = if species.latin.is_empty() {
        String::new()
    } else {
        format!("  {}", species.latin)
    };
    Labels {
        title: format!("{}{latin}", species.name),
        subtitle: format!("{} hair at {:.2} of its length", class.name, station.at),
        facts,
    }
}

fn summary(
    species: &Species,
    class: &HairClass,
    station: &Station,
    fiber: &Fiber,
) -> serde_json::Value {
    let s = &station.structure;
    json!({
        "species": species.id,
        "class": class.name,
        "station": station.at,
        "period_um": fiber.period_um(),
        "bounding_radius_um": fiber.bounding_radius_um(),
        "semi_axes_um": fiber.semi_axes_um(),
        "cuticle": {
            "pattern": s.cuticle.pattern,
            "tilt_deg": tilt_deg(s),
            "sectors": fiber.sector_count(),
            "strips": fiber.strip_count(),
        },
        "medulla": {
            "kind": s.medulla.kind.name(),
            "ratio": s.medulla.ratio,
            "air_fraction": fiber.air_fraction(),
            "voids": fiber.void_count(),
        },
        "structure": s,
    })
}
