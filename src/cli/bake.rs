//! `vair bake`: photons through a fiber, a structure table out; a dyed one where materials differ by
//! color.

use super::{Console, Failure};
use crate::assembly::station_table;
use crate::bake::{Cache, Settings};
use crate::blame::Blame;
use crate::io::check_writable;
use crate::species::{self, HairClass, Species, Station};
use crate::table::{Mode, StructureTable, Undyed};
use std::path::PathBuf;

/// Arguments of `vair bake`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair bake red-fox -o fox.exr
  vair bake glass-cylinder --set structure.ior=1.55 --mode paper --photons 1e8 -o glass.exr
  vair bake my-cat.toml --class under --photons 1e7 -o cat-under.exr")]
pub(super) struct Args {
    /// A built-in species or a path to a species file.
    name: String,
    /// Hair class; the first of the species if not given.
    #[arg(long)]
    class: Option<String>,
    /// Position along the hair, 0 root to 1 tip: the nearest station is baked. The thickest if not
    /// given.
    #[arg(long)]
    station: Option<f64>,
    /// Table frame: `cone` follows the specular cone, `paper` is the paper to the letter.
    #[arg(long, value_enum, default_value = "cone")]
    mode: ModeArg,
    /// Photons over all directions, for instance 1e7.
    #[arg(long, value_parser = parse_count, default_value = "1e9")]
    photons: u64,
    /// Inclination nodes.
    #[arg(long, default_value_t = 16)]
    bins: usize,
    /// Texels along a face edge, a power of two.
    #[arg(long, default_value_t = 64)]
    face: usize,
    /// Reflections, refractions and scatterings a photon may undergo; 16 in paper mode, else 1000.
    #[arg(long)]
    max_events: Option<u32>,
    /// Seed of geometry and photons.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; all cores if not given. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Override a field of the species: `guard.stations.0.cuticle.pitch_um=9`. May repeat.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Bake even if the cache holds this table, and do not store it there.
    #[arg(long)]
    no_cache: bool,
    /// Where the table goes: an EXR file.
    #[arg(long, short)]
    output: PathBuf,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum ModeArg {
    Cone,
    Paper,
}

/// `1e9`, `250000` and `2.5e6` are counts.
pub(super) fn parse_count(text: &str) -> Result<u64, String> {
    let refuse = || format!("`{text}` is not a count such as 1000000 or 1e6");
    let value: f64 = text.parse().map_err(|_| refuse())?;
    let exact = value.fract() == 0.0 && (0.0..1.8e19).contains(&value);
    if exact {
        Ok(value as u64)
    } else {
        Err(refuse())
    }
}

/// Runs the command.
pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    let species = species::load(&args.name, &args.set)?;
    let class = find_class(&species, args.class.as_deref())?;
    let station = find_station(class, args.station)?;
    let settings = settings(args);
    check_writable(&args.output)?;
    let cache = if args.no_cache {
        None
    } else {
        Cache::of_user()
    };
    let baked = super::with_threads(args.threads, || {
        let (cache, cancel) = (cache.as_ref(), console.cancel());
        station_table(&species, class, station, &settings, cache, console, cancel)
    })??;
    match &baked.table {
        Undyed::Gray(table) => table.write(&args.output)?,
        Undyed::Colored(_) => {
            // Absorption levels serve all colors of one fiber; here each color meets another one.
            let band = class.band_at(station.at);
            let maps = baked.table.dye(band.absorption_per_um())?;
            maps.write(&args.output)?;
            console.say(format!(
                "materials differ by color: a table of R G B, with eumelanin {} and pheomelanin {}",
                band.eumelanin, band.pheomelanin
            ));
        }
    }
    report(baked.table.tables(), console);
    if !baked.complete {
        let kept = format!(
            "stopped; {} holds the passes done so far",
            args.output.display()
        );
        return Err(Failure::new(Blame::Interrupted, kept));
    }
    Ok(())
}

fn settings(args: &Args) -> Settings {
    let base = match args.mode {
        ModeArg::Cone => Settings::cone(),
        ModeArg::Paper => Settings::paper(),
    };
    Settings {
        photons: args.photons,
        bins: args.bins,
        face: args.face,
        max_events: args.max_events.unwrap_or(base.max_events),
        seed: args.seed,
        ..base
    }
}

/// The class of that name, or the first one.
pub(super) fn find_class<'a>(
    species: &'a Species,
    name: Option<&str>,
) -> Result<&'a HairClass, Failure> {
    let Some(name) = name else {
        return Ok(&species.classes[0]);
    };
    species
        .classes
        .iter()
        .find(|class| class.name == name)
        .ok_or_else(|| {
            let names: Vec<_> = species
                .classes
                .iter()
                .map(|class| class.name.as_str())
                .collect();
            let message = format!("{} has no hair class `{name}`", species.id);
            Failure::with_help(
                Blame::Input,
                message,
                format!("it has {}", names.join(", ")),
            )
        })
}

/// The station nearest to a position along the hair, or the thickest one.
pub(super) fn find_station(class: &HairClass, at: Option<f64>) -> Result<&Station, Failure> {
    let none = || Failure::new(Blame::Internal, "a hair class without stations");
    let Some(at) = at else {
        return class.widest().ok_or_else(none);
    };
    if !(0.0..=1.0).contains(&at) {
        let message = format!("--station is {at}, must be 0 (root) to 1 (tip)");
        return Err(Failure::new(Blame::Input, message));
    }
    let distance = |station: &&Station| (station.at - at).abs();
    let nearest = class
        .stations
        .iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.ok_or_else(none)
}

/// Energy and loss, so that a bad bake is seen at once.
fn report(tables: &[StructureTable], console: &Console) {
    let clear = |f: fn(&crate::table::Ledger) -> u64| -> f64 {
        let nodes = |t: &StructureTable| {
            (0..t.nodes.len())
                .map(|n| f(t.ledger(n, 0)) as f64)
                .sum::<f64>()
        };
        tables.iter().map(nodes).sum()
    };
    let emitted = clear(|l| l.emitted);
    console.say(format!(
        "{:.3e} photons: {:.4} % escaped, {:.4} % truncated, {:.1e} of them lost",
        emitted / crate::table::PHOTON as f64,
        100.0 * clear(|l| l.escaped) / emitted,
        100.0 * clear(|l| l.truncated) / emitted,
        clear(|l| l.lost) / emitted,
    ));
    if tables[0].nodes.mode == Mode::Paper && clear(|l| l.truncated) > 1e-3 * emitted {
        console.say("warning: the cap on events cuts off light; cone mode does not have it");
    }
}
