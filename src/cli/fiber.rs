//! `vair fiber`: a fiber as a microscopist would draw it, or as a mesh.

mod mesh;
mod volume;

use super::bake::{find_class, find_station};
use super::stdout::print_json;
use super::{Console, Failure};
use crate::blame::Blame;
use crate::fiber::Fiber;
use crate::io::{AtomicFile, check_writable};
use crate::micrograph::{self, Legend, Microscope, Shot, Subject, View, tilt_deg};
use crate::species::{self, HairClass, Species, Station};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Arguments of `vair fiber`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair fiber red-fox -o fox.png
  vair fiber mink --class under --view sem --res 1920x1080 -o mink-under.png
  vair fiber red-fox --view light --mount 1.0 -o dry.png
  vair fiber red-fox --view light --set guard.structure.medulla.void_ior=1.33 -o flooded.png
  vair fiber polar-bear --station 0.2 -o bear.obj --json
  vair fiber human --set guard.stations.0.cuticle.pitch_um=12 -o human.ply")]
pub(super) struct Args {
    /// A built-in species or a path to a species file.
    name: String,
    /// Hair class; the first of the species if not given.
    #[arg(long)]
    class: Option<String>,
    /// Position along the hair, 0 root to 1 tip: what grows there, blended from the stations next to
    /// it. The station at the thickest place if not given.
    #[arg(long)]
    station: Option<f64>,
    /// Override a field of the species. May repeat.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// What pictures show.
    #[arg(long, value_enum, default_value = "plate")]
    view: ViewArg,
    /// Width and height of the picture, pixels.
    #[arg(long, alias = "size", value_parser = parse_size, default_value = "1280x720")]
    res: (usize, usize),
    /// Samples a pixel; more is smoother.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=65536))]
    spp: Option<u32>,
    /// Electron microscope: tilt of the stage, degrees. Seen from straight above, free edges vanish.
    #[arg(long, value_name = "DEGREES", default_value_t = 17.0)]
    tilt: f64,
    /// Light microscope: refractive index of the medium around the fiber; 1 is dry.
    #[arg(long, value_name = "INDEX", default_value_t = Microscope::default().mount)]
    mount: f64,
    /// Light microscope: numerical aperture of objective and condenser.
    #[arg(long, value_name = "NA", default_value_t = Microscope::default().objective)]
    aperture: f64,
    /// Light microscope: aperture of the condenser if it is another.
    #[arg(long, value_name = "NA")]
    condenser: Option<f64>,
    /// Light microscope: plane in focus, micrometers above the middle of the fiber.
    #[arg(long, value_name = "UM", default_value_t = 0.0)]
    focus: f64,
    /// Light microscope: how much brighter the lamp is than for the empty field, stops; if not given,
    /// as bright as dark hair needs.
    #[arg(long, value_name = "STOPS")]
    lamp: Option<f64>,
    /// Leave the caption out; a scale bar stays.
    #[arg(long)]
    no_caption: bool,
    /// Seed of scales and voids.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Edge of a voxel of a .vdb, micrometers; for some four million of them if not given.
    #[arg(long, value_name = "UM")]
    voxel_um: Option<f64>,
    /// Store the grids of a .vdb in half precision.
    #[arg(long)]
    half: bool,
    /// Print a summary of the fiber as JSON.
    #[arg(long)]
    json: bool,
    /// Where it goes: .png is a picture; .obj, .ply and .glb are meshes of one period with the
    /// parts `cuticle`, `riser`, `medulla` (a medium) and `void`; .vdb are grids of one period: `density`,
    /// `ior`, `medulla`, `absorption`, in micrometers. May repeat.
    #[arg(long, short)]
    output: Vec<PathBuf>,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum ViewArg {
    /// Outside, longitudinal cut and cross-section with labels.
    Plate,
    /// The scales under a scanning electron microscope.
    Sem,
    /// A transmitted-light micrograph, traced through the fiber in its mounting medium.
    Light,
    /// A thin section across the fiber.
    Section,
    /// A piece of the fiber with its front quarter taken out.
    Cutaway,
}

/// `1280x720`.
fn parse_size(text: &str) -> Result<(usize, usize), String> {
    let refuse = || format!("`{text}` is not a size such as 1280x720");
    let (w, h) = text.split_once(['x', 'X']).ok_or_else(refuse)?;
    let number = |s: &str| s.trim().parse::<usize>().map_err(|_| refuse());
    Ok((number(w)?, number(h)?))
}

/// The view asked for, and how it is taken.
fn view(args: &Args) -> (View, Shot) {
    let (view, samples) = match args.view {
        ViewArg::Plate => (View::Plate, 25),
        ViewArg::Sem => {
            let tilt = args.tilt.to_radians();
            (View::Sem { tilt }, 36)
        }
        ViewArg::Light => {
            let microscope = Microscope {
                mount: args.mount,
                objective: args.aperture,
                condenser: args.condenser.unwrap_or(args.aperture),
                focus_um: args.focus,
                lamp_ev: args.lamp,
            };
            (View::Light(microscope), 64)
        }
        ViewArg::Section => (View::Section, 16),
        ViewArg::Cutaway => (View::Cutaway, 36),
    };
    let shot = Shot {
        size: args.res,
        samples: args.spp.unwrap_or(samples),
        legend: if args.no_caption {
            Legend::Bar
        } else {
            Legend::Caption
        },
    };
    (view, shot)
}

/// Runs the command.
pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    if args.output.is_empty() && !args.json {
        let message = "nothing to do: neither --output nor --json is given";
        return Err(Failure::new(Blame::Input, message));
    }
    let species = species::load(&args.name, &args.set)?;
    let class = find_class(&species, args.class.as_deref())?;
    let mut station = find_station(class, args.station)?.clone();
    if let Some(at) = args.station {
        let blended = class.structure_at(at);
        station = Station {
            at,
            structure: blended.unwrap_or(station.structure),
        };
    }
    let station = &station;
    for path in &args.output {
        format_of(path)?;
        check_writable(path)?;
    }
    let (view, shot) = view(args);
    micrograph::check(view, &shot)?;
    let fiber = Fiber::build(&station.structure, args.seed)?;
    for warning in fiber.warnings() {
        console.say(format!("warning: {warning}"));
    }
    for path in &args.output {
        match format_of(path)? {
            Format::Png => {
                let subject = Subject {
                    fiber: &fiber,
                    species: &species,
                    class,
                    station,
                };
                let cancel = console.cancel();
                micrograph::draw(view, &subject, &shot, console, cancel)?.write_png(path)?;
                console.say(format_args!("drawn: {}", path.display()));
            }
            Format::Obj => mesh::write_obj(path, &fiber.mesh())?,
            Format::Ply => mesh::write_ply(path, &fiber.mesh())?,
            Format::Vdb => {
                let subject = (&species, class, station);
                volume::write(path, subject, &fiber, args.voxel_um, args.half, console)?;
            }
            Format::Glb => {
                AtomicFile::write_all_to(path, &fiber.to_glb(&species.name))?;
                console.say(mesh::how_to_use(path, &fiber));
            }
        }
    }
    if args.json {
        print_json(&summary(&species, class, station, &fiber))?;
    }
    Ok(())
}

enum Format {
    Png,
    Obj,
    Ply,
    Glb,
    Vdb,
}

fn format_of(path: &Path) -> Result<Format, Failure> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    match extension.to_ascii_lowercase().as_str() {
        "png" => Ok(Format::Png),
        "obj" => Ok(Format::Obj),
        "ply" => Ok(Format::Ply),
        "glb" => Ok(Format::Glb),
        "vdb" => Ok(Format::Vdb),
        _ => Err(Failure::with_help(
            Blame::Input,
            format!("{}: unknown kind of file", path.display()),
            "the name must end in .png, .obj, .ply, .glb or .vdb",
        )),
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
            "pattern": s.cuticle.pattern.name(),
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
