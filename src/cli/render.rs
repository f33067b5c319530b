//! `vair render`: a species to a still. Bakes what the cache does not hold, grows the fur, traces.

use super::{Console, Failure, bake::parse_count};
use crate::assembly;
use crate::bake::{Cache, Settings};
use crate::blame::Blame;
use crate::groom::{self, GroomSettings};
use crate::image::{self, Curve, ViewTransform};
use crate::io::check_writable;
use crate::render::{Crop, Film, RenderJob, Sampler};
use crate::scene::{Backdrop, Environment, Scene, SceneParts, Sun, View, load_environment};
use crate::skin::{self, Skin};
use crate::species;
use crate::table::TableFile;
use glam::Vec3;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Arguments of `vair render`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair render red-fox -o red-fox.png
  vair render polar-bear --env sky --res 1280x720 --spp 128 -o bear.png -o bear.exr
  vair render harbor-seal --azimuths 8 -o seal.png
  vair render red-fox --table guard-small.exr --table under-small.exr -o fox.png
  vair render mink --skin sofa.obj --strands 1e6 -o sofa.png
  vair render red-fox --crop 200,150,64,64 --spp 256 -o eye.exr")]
pub(super) struct Args {
    /// A built-in species or a path to a species file.
    name: String,
    /// What the fur grows on: body, ball, swatch, tress, or an OBJ or PLY mesh in meters.
    #[arg(long, default_value = "body")]
    skin: String,
    /// The light: studio, sky, white, or a latitude-longitude EXR or HDR file.
    #[arg(long, default_value = "studio")]
    env: String,
    /// Turns the light about the vertical, degrees.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    env_turn: f32,
    /// Shows the environment behind the subject instead of a backdrop.
    #[arg(long)]
    env_visible: bool,
    /// Width and height of the picture.
    #[arg(long, value_parser = parse_size, default_value = "640x480")]
    res: [u32; 2],
    /// Samples a pixel.
    #[arg(long, default_value_t = 32)]
    spp: u32,
    /// Renders only a part of the frame, with the same pixels: x,y,width,height.
    #[arg(long, value_parser = parse_crop)]
    crop: Option<Crop>,
    /// Stops after so many seconds with the samples there are.
    #[arg(long, value_name = "SECONDS")]
    time: Option<f64>,
    /// How directions are drawn; all give the same picture.
    #[arg(long, value_enum, default_value = "qsir")]
    sampler: SamplerArg,
    /// Strands in all; if not given, as many as the animal has, at most 250000.
    #[arg(long, value_parser = parse_count)]
    strands: Option<u64>,
    /// Photons for each scattering table that has to be baked.
    #[arg(long, value_parser = parse_count, default_value = "3e6")]
    bake_photons: u64,
    /// Tell so many azimuths of flat hairs apart: they glint as they turn. The photons are then those of
    /// each. 1 averages over azimuths.
    #[arg(long, value_name = "N", default_value_t = 1)]
    azimuths: usize,
    /// A table to use instead of baking, packed or not: for the stations of its hair class. May repeat.
    #[arg(long, value_name = "FILE")]
    table: Vec<PathBuf>,
    /// Camera: degrees around the subject (0 is +Z, 90 is +X) and above it; if not given, the side from
    /// which the skin looks best.
    #[arg(long, value_parser = parse_pair, value_name = "YAW,PITCH", allow_hyphen_values = true)]
    view: Option<[f32; 2]>,
    /// Field of view along the shorter side, degrees.
    #[arg(long)]
    fov: Option<f32>,
    /// 1 frames the subject, 2 shows half of it.
    #[arg(long)]
    zoom: Option<f32>,
    /// Shifts the camera across and up, in radii of the subject.
    #[arg(long, value_parser = parse_pair, value_name = "X,Y", allow_hyphen_values = true)]
    shift: Option<[f32; 2]>,
    /// Leaves out the floor.
    #[arg(long)]
    no_ground: bool,
    /// Exposure of the PNG, in stops.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    exposure: f32,
    /// Cut the PNG at white instead of rolling bright parts off.
    #[arg(long)]
    plain: bool,
    /// Write the PNG as it was sampled. By default noise is taken out of it, never out of the EXR.
    #[arg(long)]
    no_denoise: bool,
    /// Seed of fiber, fur and picture.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; all cores if not given. The picture does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Override a field of the species: `guard.pigment.0.eumelanin=2`. May repeat.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Bake even if the cache holds the tables, and do not store them there.
    #[arg(long)]
    no_cache: bool,
    /// Where the picture goes: .png or .exr. May repeat.
    #[arg(long, short, required = true)]
    output: Vec<PathBuf>,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum SamplerArg {
    /// Resampled products of scattering and environment.
    Qsir,
    /// Resampled products, one ray for direct and indirect light.
    QsirOneRay,
    /// The scattering table alone.
    Bsdf,
    /// The environment for direct light.
    Env,
    /// Both, by multiple importance sampling.
    Mis,
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let parts = text.split_once(['x', 'X']);
    let sides = parts.and_then(|(w, h)| Some([w.trim().parse().ok()?, h.trim().parse().ok()?]));
    sides.ok_or_else(|| format!("`{text}` is not a size such as 960x720"))
}

fn parse_crop(text: &str) -> Result<Crop, String> {
    let numbers: Result<Vec<u32>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[x, y, width, height]) => Ok(Crop {
            x,
            y,
            width,
            height,
        }),
        _ => Err(format!(
            "`{text}` is not a crop such as 200,150,64,64 (x,y,width,height)"
        )),
    }
}

fn parse_pair(text: &str) -> Result<[f32; 2], String> {
    let pair = text.split_once(',');
    let pair = pair.and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    match pair {
        Some(pair @ [a, b]) if f32::is_finite(a) && f32::is_finite(b) => Ok(pair),
        _ => Err(format!("`{text}` is not a pair of numbers such as 35,12")),
    }
}

/// Runs the command.
pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    super::with_threads(args.threads, || run_here(args, console))?
}

/// A table whose maps the renderer can look up.
fn given_table(path: &Path) -> Result<TableFile, Failure> {
    let table = TableFile::read(path)?;
    let res = match &table {
        TableFile::Structure(table) => table.res,
        TableFile::Scatter(maps) => maps.res,
    };
    if !res.is_power_of_two() {
        let message = format!("{} has {res} texels a face edge", path.display());
        return Err(Failure::with_help(
            Blame::Input,
            message,
            "bake it again with --face 64 or another power of two",
        ));
    }
    Ok(table)
}

fn run_here(args: &Args, console: &Console) -> Result<(), Failure> {
    // All that can be refused is refused before any work.
    let species = species::load(&args.name, &args.set)?;
    let job = job(args)?;
    job.check()?;
    for output in &args.output {
        format_of(output)?;
        check_writable(output)?;
    }
    let given = args.table.iter().map(|path| given_table(path));
    let given = given.collect::<Result<Vec<TableFile>, Failure>>()?;
    let skin = skin::load(&args.skin)?;
    let view = view(args, &skin)?;
    let environment = environment(args, &view)?;
    for warning in &skin.warnings {
        console.say(format!("warning: {warning}"));
    }

    let cancel = console.cancel();
    let cache = if args.no_cache {
        None
    } else {
        Cache::of_user()
    };
    let bake = Settings {
        photons: args.bake_photons,
        azimuths: args.azimuths,
        seed: args.seed,
        ..Settings::cone()
    };
    let cache = cache.as_ref();
    let materials = assembly::materials_with(&species, &given, &bake, cache, console, cancel)?;
    let settings = GroomSettings {
        strands: args.strands.map(|n| n as usize),
        seed: args.seed,
    };
    let groom = groom::grow(&skin, &species, &settings, console, cancel)?;
    console.say(format!("{} strands on {}", groom.strands(), args.skin));
    let color = Vec3::from_array(species.skin_color.map(|c| c as f32));
    let scene = Scene::build(SceneParts {
        groom: &groom,
        materials,
        skin: Some((&skin, color)),
        environment,
        backdrop: if args.env_visible {
            Backdrop::Environment
        } else {
            Backdrop::default()
        },
        ground: (!args.no_ground && !args.env_visible).then_some(0.5),
        view,
    })?;
    let film = job.run(&scene, console, cancel)?;
    report(&film, console);
    if film.report.passes == 0 {
        return Err(Failure::new(
            Blame::Interrupted,
            "stopped before every pixel had a sample; nothing was written",
        ));
    }
    write(args, &species, &film)?;
    if cancel.is_cancelled() {
        let message = format!(
            "stopped; {} holds the samples done so far",
            list(&args.output)
        );
        return Err(Failure::new(Blame::Interrupted, message));
    }
    Ok(())
}

fn job(args: &Args) -> Result<RenderJob, Failure> {
    let time_limit = match args.time {
        Some(seconds) if !(0.0..1e9).contains(&seconds) => {
            let message = format!("--time is {seconds}, must be 0 or more seconds");
            return Err(Failure::new(Blame::Input, message));
        }
        limit => limit.map(Duration::from_secs_f64),
    };
    Ok(RenderJob {
        resolution: args.res,
        crop: args.crop,
        spp: args.spp,
        seed: args.seed,
        sampler: match args.sampler {
            SamplerArg::Qsir => Sampler::Qsir,
            SamplerArg::QsirOneRay => Sampler::QsirOneRay,
            SamplerArg::Bsdf => Sampler::Bsdf,
            SamplerArg::Env => Sampler::Env,
            SamplerArg::Mis => Sampler::Mis,
        },
        time_limit,
    })
}

fn environment(args: &Args, view: &View) -> Result<Environment, Failure> {
    check_range("--env-turn", args.env_turn, -3600.0, 3600.0)?;
    Ok(match args.env.as_str() {
        // Studio lights stand around the camera; sun and pictures stay where they are.
        "studio" => Environment::studio().turned(view.yaw_deg + args.env_turn),
        "sky" => Environment::sky(&Sun::default()).turned(args.env_turn),
        "white" => Environment::white(),
        path => load_environment(Path::new(path))?.turned(args.env_turn),
    })
}

/// The view asked for; where nothing was asked, the direction from which the skin looks best.
fn view(args: &Args, skin: &Skin) -> Result<View, Failure> {
    let base = View::from_direction(skin.view);
    let [yaw_deg, pitch_deg] = args.view.unwrap_or([base.yaw_deg, base.pitch_deg]);
    check_range("--view pitch", pitch_deg, -89.0, 89.0)?;
    Ok(View {
        yaw_deg,
        pitch_deg,
        fov_deg: check_range("--fov", args.fov.unwrap_or(base.fov_deg), 1.0, 150.0)?,
        zoom: check_range("--zoom", args.zoom.unwrap_or(base.zoom), 0.01, 1000.0)?,
        shift: args.shift.unwrap_or(base.shift),
        ..base
    })
}

fn check_range(name: &str, value: f32, lo: f32, hi: f32) -> Result<f32, Failure> {
    if (lo..=hi).contains(&value) {
        return Ok(value);
    }
    Err(Failure::new(
        Blame::Input,
        format!("{name} is {value}, must be {lo} to {hi}"),
    ))
}

#[derive(Clone, Copy, PartialEq)]
enum Format {
    Png,
    Exr,
}

fn format_of(path: &Path) -> Result<Format, Failure> {
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

fn write(args: &Args, species: &species::Species, film: &Film) -> Result<(), Failure> {
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

fn report(film: &Film, console: &Console) {
    let report = &film.report;
    let seconds = report.elapsed.as_secs_f64();
    console.say(format!(
        "{:.1} M samples, {:.1} M rays in {seconds:.1} s ({:.2} M rays/s), noise {:.2} %",
        report.samples as f64 / 1e6,
        report.rays as f64 / 1e6,
        report.rays as f64 / 1e6 / seconds.max(1e-9),
        100.0 * film.noise(),
    ));
    if report.dropped > 0 || report.capped > 0 {
        console.say(format!(
            "warning: {} samples were not finite and left out, {} paths ended at the far cap",
            report.dropped, report.capped
        ));
    }
}

fn list(paths: &[PathBuf]) -> String {
    paths
        .iter()
        .map(|path| path.display().to_string())
        .collect::<Vec<_>>()
        .join(", ")
}
