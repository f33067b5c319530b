//! `vair render`: a species to a still. Bakes what the cache does not hold, grows the fur, traces.

mod args;
mod checkpoint;
mod filled;
mod identity;
mod live;
mod material;
pub(super) mod output;
mod parse;
mod stats;

pub(super) use args::Args;

use super::console::short_count;
use super::{Console, Failure};
use crate::blame::Blame;
use crate::export::mitsuba::MitsubaScene;
use crate::groom::{self, GroomSettings};
use crate::io::check_writable;
use crate::render::{Film, Filter, RenderJob, Rendering, Sampler};
use crate::scene::{Backdrop, Environment, Lamp, Scene, SceneParts, Sun, View, load_environment};
use crate::skin::Skin;
use crate::species;
use crate::table::TableFile;
use args::{FilterArg, ModelArg, SamplerArg};
use glam::Vec3;
use live::Live;
use output::Format;
use std::path::Path;

/// Runs the command.
pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    super::with_threads(args.threads, || run_here(args, console))?
}

fn run_here(args: &Args, console: &Console) -> Result<(), Failure> {
    // All that can be refused is refused before any work.
    let args = &args.filled()?;
    let mut species = species::load(&args.name, &args.set)?;
    if let Some(coat) = &args.coat {
        species.wear(coat)?;
    }
    if let Some(color) = args.color {
        species.dye(color);
    }
    let job = job(args)?;
    job.check()?;
    check_memory(&job)?;
    if args.mitsuba.is_some() && args.model != ModelArg::Chiang {
        return Err(Failure::with_help(
            Blame::Input,
            "--mitsuba writes the numbers of Chiang's hair model, and the picture is not of it",
            "add --model chiang, with --chiang for other numbers than the usual",
        ));
    }
    if let Some(option) = args.model.numbers()
        && args.color.is_some()
    {
        return Err(Failure::with_help(
            Blame::Input,
            "--color dyes baked tables, and the picture is of a hair model with numbers of its own",
            format!("leave out --model, or give its absorption: {option} sigma_a=R:G:B"),
        ));
    }
    for output in &args.output {
        output::format_of(output)?;
        check_writable(output)?;
    }
    let holds_mattes = |path| matches!(output::format_of(path), Ok(Format::Exr | Format::Sums));
    if args.cryptomatte && !args.output.iter().any(|path| holds_mattes(path)) {
        return Err(Failure::with_help(
            Blame::Input,
            "--cryptomatte is for EXR files, and none is written",
            "add -o NAME.exr, or .safetensors to merge into one",
        ));
    }
    for path in args.stats.iter().chain(&args.checkpoint) {
        check_writable(path)?;
    }
    let live = args
        .tev
        .as_ref()
        .map(|address| Live::connect(address, &args.output[0]));
    let live = live.transpose()?;
    let given = args.table.iter().map(|path| TableFile::read(path));
    let given = given.collect::<Result<Vec<_>, _>>()?;
    for table in &given {
        let of = &table.provenance().species;
        if *of != species.id {
            console.say(format!(
                "note: a table of {of} stands in for one of {}",
                species.id
            ));
        }
    }
    let skin = args.on.load()?;
    let view = view(args, &skin)?;
    let environment = environment(args, &view)?;
    for warning in &skin.warnings {
        console.say(format!("warning: {warning}"));
    }

    let cancel = console.cancel();
    let lamps = lamps(args, &view);
    let mut stages = stats::Stages::begin();
    let settings = GroomSettings {
        strands: args.strands.map(|n| n as usize),
        seed: args.seed(),
    };
    let materials = material::materials(args, &mut species, &given, &skin, &settings, console)?;
    stages.end("materials");
    let groom = groom::grow(&skin, &species, &settings, console, cancel)?;
    stages.end("groom");
    for warning in &groom.warnings {
        console.say(format!("warning: {warning}"));
    }
    console.say(format!("{} strands on {}", groom.strands(), args.on.name()));
    let color = Vec3::from_array(species.skin_color.map(|c| c as f32));
    let scene = Scene::build(SceneParts {
        groom: &groom,
        materials,
        skin: Some((&skin, color)),
        environment,
        lamps: &lamps,
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
            lamps: &scene.lamps,
            camera: &scene.camera(width as f32 / height as f32),
            job: &job,
        }
        .write(folder)?;
        stages.end("export");
        console.say(format!("Mitsuba scene in {}", folder.display()));
    }
    let of = identity::of(args, &species, &groom, &scene)?;
    let mut rendering = Rendering::new(&job, &scene)?;
    let kept = checkpoint::run(args, &mut rendering, live, &of, console)?;
    let film = rendering.film();
    stages.end("render");
    report(&film, console);
    if film.report.passes == 0 {
        let kept = kept.map_or("nothing was written".to_owned(), |path| {
            format!("{} keeps those there are", path.display())
        });
        let message = format!("stopped before every pixel had a sample; {kept}");
        return Err(Failure::new(Blame::Interrupted, message));
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
            "stopped; {} holds the samples done so far{}",
            output::list(&args.output),
            if kept.is_some() {
                ", and the same command goes on from there"
            } else {
                ""
            }
        );
        return Err(Failure::new(Blame::Interrupted, message));
    }
    Ok(())
}

fn job(args: &Args) -> Result<RenderJob, Failure> {
    let [first, end] = args.samples.unwrap_or_else(|| {
        let most = if args.target_error.is_some() {
            4096
        } else {
            32
        };
        [0, args.spp.unwrap_or(most)]
    });
    Ok(RenderJob {
        resolution: args.res(),
        crop: args.crop,
        spp: end - first,
        first,
        target_error: args.target_error,
        seed: args.picture_seed.unwrap_or(args.seed()),
        sampler: match args.sampler() {
            SamplerArg::Qsir => Sampler::Qsir,
            SamplerArg::QsirOneRay => Sampler::QsirOneRay,
            SamplerArg::Bsdf => Sampler::Bsdf,
            SamplerArg::Env => Sampler::Env,
            SamplerArg::Mis => Sampler::Mis,
        },
        filter: match args.filter() {
            FilterArg::Gaussian => Filter::Gaussian,
            FilterArg::Box => Filter::Box,
            FilterArg::Tent => Filter::Tent,
        },
        mattes: args.cryptomatte,
        time_limit: args.time,
    })
}

fn environment(args: &Args, view: &View) -> Result<Environment, Failure> {
    parse::check_range("--env-turn", args.env_turn(), -3600.0, 3600.0)?;
    Ok(match args.env() {
        // Studio lights stand around the camera; sun and pictures stay where they are.
        "studio" => Environment::studio().turned(view.yaw_deg + args.env_turn()),
        "sky" => Environment::sky(&Sun::default()).turned(args.env_turn()),
        "white" => Environment::white(),
        "black" => Environment::black(),
        path => load_environment(Path::new(path))?.turned(args.env_turn()),
    })
}

/// The view asked for; where nothing was asked, the direction from which the skin looks best.
fn view(args: &Args, skin: &Skin) -> Result<View, Failure> {
    let base = View::from_direction(skin.view);
    let [yaw_deg, pitch_deg] = args.view.unwrap_or([base.yaw_deg, base.pitch_deg]);
    parse::check_range("--view pitch", pitch_deg, -89.0, 89.0)?;
    let lens = parse::check_range("--lens", args.lens.unwrap_or(0.0), 0.0, 1000.0)?;
    if args.focus.is_some() && lens == 0.0 {
        return Err(Failure::with_help(
            Blame::Input,
            "--focus is given without --lens: a pinhole sees all sharp",
            "add --lens MM, the diameter of the lens",
        ));
    }
    Ok(View {
        yaw_deg,
        pitch_deg,
        fov_deg: parse::check_range("--fov", args.fov.unwrap_or(base.fov_deg), 1.0, 150.0)?,
        zoom: parse::check_range("--zoom", args.zoom.unwrap_or(base.zoom), 0.01, 1000.0)?,
        shift: args.shift.unwrap_or(base.shift),
        lens,
        focus: match args.focus {
            Some(mm) => Some(parse::check_range("--focus", mm, 1.0, 1e6)?),
            None => None,
        },
        ..base
    })
}

/// The lamps of a scene file, those beside the camera where it stands.
fn lamps(args: &Args, view: &View) -> Vec<Lamp> {
    let place = |&(lamp, with_camera): &(Lamp, bool)| Lamp {
        yaw_deg: lamp.yaw_deg + if with_camera { view.yaw_deg } else { 0.0 },
        ..lamp
    };
    args.lamps.iter().map(place).collect()
}

/// Refuses a picture that is too large now rather than when the fur is grown.
fn check_memory(job: &RenderJob) -> Result<(), Failure> {
    let bytes = job.memory();
    // The system gives nothing of it until it is written to, but refuses what it does not have.
    let probe = usize::try_from(bytes).map(|bytes| Vec::<u8>::new().try_reserve_exact(bytes));
    match probe {
        Ok(Ok(())) => Ok(()),
        _ => Err(Failure::with_help(
            Blame::Environment,
            format!(
                "the pixels need {:.1} GB of memory, which the system does not have",
                bytes as f64 / 1e9
            ),
            "a smaller --res, or a --crop of it at a time",
        )),
    }
}

fn report(film: &Film, console: &Console) {
    let report = &film.report;
    let seconds = report.elapsed.as_secs_f64();
    let noise = match film.pixels.iter().all(|pixel| pixel.samples < 2) {
        true => "one sample a pixel says nothing of its noise: nothing is taken out".to_owned(),
        false => format!("noise {:.2} %", 100.0 * film.noise()),
    };
    console.say(format!(
        "{} samples, {} rays in {seconds:.1} s ({}/s), {noise}",
        short_count(report.samples as f64),
        short_count(report.rays as f64),
        short_count(report.rays_in_elapsed as f64 / seconds.max(1e-9)),
    ));
    if report.dropped > 0 || report.capped > 0 {
        console.say(format!(
            "warning: {} samples were not finite and left out, {} paths ended at the far cap",
            report.dropped, report.capped
        ));
    }
}
