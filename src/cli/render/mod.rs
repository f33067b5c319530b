//! `vair render`: a species to a still. Bakes what the cache does not hold, grows the fur, traces.

mod checkpoint;
mod material;
pub(super) mod output;
mod parse;
mod stats;

use super::{Console, Failure, bake::parse_count};
use crate::blame::Blame;
use crate::bsdf::ChiangParameters;
use crate::export::mitsuba::MitsubaScene;
use crate::groom::{self, GroomSettings};
use crate::io::check_writable;
use crate::render::{Crop, Film, Filter, RenderJob, Rendering, Sampler};
use crate::scene::{Backdrop, Environment, Scene, SceneParts, Sun, View, load_environment};
use crate::skin::{self, Placing, Skin, Up};
use crate::species;
use glam::Vec3;
use output::Origin;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Arguments of `vair render`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair render red-fox -o red-fox.png
  vair render polar-bear --env sky --res 1280x720 --spp 128 -o bear.png -o bear.exr
  vair render harbor-seal --azimuths 8 -o seal.png
  vair render red-fox --table guard-small.exr --table under-small.exr -o fox.png
  vair render red-fox --model chiang-fit -o shader.png
  vair render cat --coat leopard -o leopard.png
  vair render mink --skin sofa.obj --strands 1e6 -o sofa.png
  vair render red-fox --crop 200,150,64,64 --spp 256 -o eye.exr")]
pub(super) struct Args {
    /// A built-in species or a path to a species file.
    name: String,
    /// Pattern of the coat: tabby, leopard, zebra, badger, fox, cow, countershaded, siamese,
    /// tortoiseshell, the path of a recipe, or none; if not given, that of the species.
    #[arg(long, value_name = "NAME")]
    coat: Option<String>,
    /// What the fur grows on: body, ball, swatch, tress, or an OBJ, PLY or glTF mesh.
    #[arg(long, default_value = "body")]
    skin: String,
    /// What a unit of the skin's file is.
    #[arg(long, value_enum, default_value = "m")]
    skin_units: UnitArg,
    /// Which axis of the skin's file points up.
    #[arg(long, value_enum, default_value = "y")]
    skin_up: UpArg,
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
    #[arg(long, value_parser = parse::size, default_value = "640x480")]
    res: [u32; 2],
    /// Samples a pixel; 32 if not given.
    #[arg(long)]
    spp: Option<u32>,
    /// Renders only these samples of every pixel, from the first to one before the last: `0..64`. Ranges
    /// written to .safetensors files are put together by `vair merge`, to the bit what one run gives.
    #[arg(long, value_parser = parse::samples, value_name = "A..B", conflicts_with_all = ["spp", "target_error"])]
    samples: Option<[u32; 2]>,
    /// Ends tile by tile where the noise is below this many per cent of the tile's light; `--spp` is the
    /// most samples then, and 4096 if it is not given.
    #[arg(long, value_name = "PERCENT", value_parser = parse::percent)]
    target_error: Option<f64>,
    /// Saves all samples to this file now and then and when stopped, and goes on from it if it is there. It
    /// goes when the picture is done.
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Seconds between two saves of the checkpoint.
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0, value_parser = parse::seconds)]
    checkpoint_every: f64,
    /// Renders only a part of the frame, with the same pixels: x,y,width,height.
    #[arg(long, value_parser = parse::crop)]
    crop: Option<Crop>,
    /// Stops after so many seconds with the samples there are.
    #[arg(long, value_name = "SECONDS")]
    time: Option<f64>,
    /// How directions are drawn; all give the same picture.
    #[arg(long, value_enum, default_value = "qsir")]
    sampler: SamplerArg,
    /// How samples spread over and around their pixel.
    #[arg(long, value_enum, default_value = "gaussian")]
    filter: FilterArg,
    /// What scatters light: the baked tables, the hair model of Chiang et al. 2016 (Mitsuba, pbrt and
    /// Cycles have it too) with given numbers, or that model as near to the tables as it comes.
    #[arg(long, value_enum, default_value = "table")]
    model: ModelArg,
    /// Numbers of `--model chiang`; absorption is per radius.
    #[arg(
        long,
        value_parser = parse::chiang,
        value_name = "KEY=VALUE,..",
        default_value = "sigma_a=0.06:0.10:0.20,beta_m=0.3,beta_n=0.3,alpha=2,eta=1.55",
        allow_hyphen_values = true
    )]
    chiang: ChiangParameters,
    /// Also writes strands, skin, light and camera to this folder as a scene for Mitsuba 3; needs
    /// `--model chiang`.
    #[arg(long, value_name = "FOLDER")]
    mitsuba: Option<PathBuf>,
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
    #[arg(long, value_parser = parse::pair, value_name = "YAW,PITCH", allow_hyphen_values = true)]
    view: Option<[f32; 2]>,
    /// Field of view along the shorter side, degrees.
    #[arg(long)]
    fov: Option<f32>,
    /// 1 frames the subject, 2 shows half of it.
    #[arg(long)]
    zoom: Option<f32>,
    /// Shifts the camera across and up, in radii of the subject.
    #[arg(long, value_parser = parse::pair, value_name = "X,Y", allow_hyphen_values = true)]
    shift: Option<[f32; 2]>,
    /// Leaves out the floor.
    #[arg(long)]
    no_ground: bool,
    #[command(flatten)]
    look: output::Look,
    /// Seed of fiber, fur and picture.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Another seed for the noise of the picture alone.
    #[arg(long, value_name = "SEED")]
    picture_seed: Option<u64>,
    /// Writes times, rays and memory to this JSON file.
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,
    /// Threads; all cores if not given. The picture does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Override a field of the species: `guard.pigment.0.eumelanin=2`. May repeat.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Bake even if the cache holds the tables, and do not store them there.
    #[arg(long)]
    no_cache: bool,
    /// Where the picture goes: .png or .exr, or .safetensors for its sums. May repeat.
    #[arg(long, short, required = true)]
    output: Vec<PathBuf>,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum UnitArg {
    /// Meters.
    M,
    /// Centimeters.
    Cm,
    /// Millimeters.
    Mm,
    /// Inches.
    In,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum UpArg {
    /// Y, as in glTF.
    Y,
    /// Z, as in Blender.
    Z,
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

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum FilterArg {
    /// A narrow Gaussian.
    Gaussian,
    /// Even over the pixel.
    Box,
    /// A tent of two pixels.
    Tent,
}

#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum ModelArg {
    /// Photons baked into tables.
    Table,
    /// The model with the numbers of `--chiang`.
    Chiang,
    /// The model fitted to the tables.
    ChiangFit,
}

/// Runs the command.
pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    super::with_threads(args.threads, || run_here(args, console))?
}

fn run_here(args: &Args, console: &Console) -> Result<(), Failure> {
    // All that can be refused is refused before any work.
    let mut species = species::load(&args.name, &args.set)?;
    if let Some(coat) = &args.coat {
        species.wear(coat)?;
    }
    let job = job(args)?;
    job.check()?;
    if args.mitsuba.is_some() && args.model != ModelArg::Chiang {
        return Err(Failure::with_help(
            Blame::Input,
            "--mitsuba writes the numbers of a hair model, and the picture is of baked tables",
            "add --model chiang, with --chiang for other numbers than the usual",
        ));
    }
    for output in &args.output {
        output::format_of(output)?;
        check_writable(output)?;
    }
    if let Some(path) = &args.stats {
        check_writable(path)?;
    }
    let given = args.table.iter().map(|path| material::given_table(path));
    let given = given.collect::<Result<Vec<_>, Failure>>()?;
    let mut skin = skin::load_placed(
        &args.skin,
        Placing {
            unit_m: match args.skin_units {
                UnitArg::M => 1.0,
                UnitArg::Cm => 0.01,
                UnitArg::Mm => 0.001,
                UnitArg::In => 0.0254,
            },
            up: match args.skin_up {
                UpArg::Y => Up::Y,
                UpArg::Z => Up::Z,
            },
        },
    )?;
    let view = view(args, &skin)?;
    let environment = environment(args, &view)?;
    for warning in &skin.warnings {
        console.say(format!("warning: {warning}"));
    }

    let cancel = console.cancel();
    let mut stages = stats::Stages::begin();
    let materials = material::materials(args, &species, &given, console)?;
    stages.end("materials");
    let settings = GroomSettings {
        strands: args.strands.map(|n| n as usize),
        seed: args.seed,
    };
    let groom = groom::grow(&skin, &species, &settings, console, cancel)?;
    stages.end("groom");
    skin.tint(&groom.skin_tint);
    for warning in &groom.warnings {
        console.say(format!("warning: {warning}"));
    }
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
    stages.end("scene");
    if let Some(folder) = &args.mitsuba {
        let [width, height] = job.resolution;
        MitsubaScene {
            groom: &groom,
            hair: &args.chiang,
            skin: Some((&skin, color)),
            environment: &scene.environment,
            camera: &scene.camera(width as f32 / height as f32),
            job: &job,
        }
        .write(folder)?;
        stages.end("export");
        console.say(format!("Mitsuba scene in {}", folder.display()));
    }
    let of = identity(args, &species, &scene);
    let mut rendering = Rendering::new(&job, &scene)?;
    checkpoint::run(args, &mut rendering, &of, console)?;
    let film = rendering.film();
    stages.end("render");
    report(&film, console);
    if film.report.passes == 0 {
        return Err(Failure::new(
            Blame::Interrupted,
            "stopped before every pixel had a sample; nothing was written",
        ));
    }
    output::write(&args.output, &args.look, &film, &of, || {
        rendering.sums(&of.text())
    })?;
    stages.end("write");
    if let Some(path) = &args.stats {
        stages.write(path, &scene, &film)?;
    }
    if film.report.complete {
        checkpoint::remove(args)?;
    }
    if cancel.is_cancelled() {
        let message = format!(
            "stopped; {} holds the samples done so far",
            output::list(&args.output)
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
    let [first, end] = args.samples.unwrap_or_else(|| {
        let most = if args.target_error.is_some() {
            4096
        } else {
            32
        };
        [0, args.spp.unwrap_or(most)]
    });
    Ok(RenderJob {
        resolution: args.res,
        crop: args.crop,
        spp: end - first,
        first,
        target_error: args.target_error,
        seed: args.picture_seed.unwrap_or(args.seed),
        sampler: match args.sampler {
            SamplerArg::Qsir => Sampler::Qsir,
            SamplerArg::QsirOneRay => Sampler::QsirOneRay,
            SamplerArg::Bsdf => Sampler::Bsdf,
            SamplerArg::Env => Sampler::Env,
            SamplerArg::Mis => Sampler::Mis,
        },
        filter: match args.filter {
            FilterArg::Gaussian => Filter::Gaussian,
            FilterArg::Box => Filter::Box,
            FilterArg::Tent => Filter::Tent,
        },
        time_limit,
    })
}

/// All that decides the samples besides the job.
fn identity(args: &Args, species: &species::Species, scene: &Scene) -> Origin {
    let mut settings = format!(
        "skin {} env {} env-turn {} res {}x{} sampler {:?} strands {:?} bake-photons {}",
        args.skin,
        args.env,
        args.env_turn,
        args.res[0],
        args.res[1],
        args.sampler,
        args.strands,
        args.bake_photons
    );
    if args.azimuths != 1 {
        settings += &format!(" azimuths {}", args.azimuths);
    }
    if args.model != ModelArg::Table {
        settings += &format!(" model {:?} {:?}", args.model, args.chiang);
    }
    settings += &format!(" tables {:?} ground {}", args.table, !args.no_ground);
    Origin {
        species: species.id.clone(),
        species_text: species.text.clone(),
        settings,
        seed: args.seed,
        view: format!("{:?}", scene.view),
        geometry: fingerprint(scene),
    }
}

/// Hash of everything that rays can meet.
fn fingerprint(scene: &Scene) -> String {
    let mut hasher = Sha256::new();
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
    let hash = hasher.finalize();
    hash.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn environment(args: &Args, view: &View) -> Result<Environment, Failure> {
    parse::check_range("--env-turn", args.env_turn, -3600.0, 3600.0)?;
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
    parse::check_range("--view pitch", pitch_deg, -89.0, 89.0)?;
    Ok(View {
        yaw_deg,
        pitch_deg,
        fov_deg: parse::check_range("--fov", args.fov.unwrap_or(base.fov_deg), 1.0, 150.0)?,
        zoom: parse::check_range("--zoom", args.zoom.unwrap_or(base.zoom), 0.01, 1000.0)?,
        shift: args.shift.unwrap_or(base.shift),
        ..base
    })
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
