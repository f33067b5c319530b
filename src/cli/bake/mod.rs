//! `vair bake`: photons through a fiber, a structure table out; a dyed one where materials differ by
//! color. Stops at a number of photons, an error or a time, and goes on where it was stopped.

mod report;
mod run;
mod values;

pub(super) use report::report;
pub(super) use values::{parse_bytes, parse_count, parse_share, parse_time};

use super::{Console, Failure};
use crate::bake::{Settings, Shard};
use crate::blame::Blame;
use crate::species::{HairClass, Species, Station};
use crate::table::Undyed;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Arguments of `vair bake`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair bake red-fox -o fox.exr
  vair bake red-fox --time 10s -o fox.exr
  vair bake polar-bear --target-error 2% --photons 1e9 -o bear.exr
  vair bake glass-cylinder --set structure.ior=1.55 --mode paper --photons 1e8 -o glass.exr
  vair bake harbor-seal --azimuths 8 --photons 1e8 -o seal.exr
  vair bake my-cat.toml --class under --photons 1e7 -o cat-under.exr
  vair bake human --photons 1e7 --photon-seed 1 -o human-again.exr
  vair bake human --photons 1e10 --shard 2/3 -o human-2.safetensors

A bake ends at whichever comes first of --photons, --target-error and --time. Its table says how many
photons it has; --photons with that number gives the same bytes on any machine, with any number of
threads, in one piece or in several.

Its exact sums are saved every 30 seconds and when it is stopped (Ctrl-C, SIGTERM): the same command
goes on from there. They stay in the cache when it is done, so that a later command with more photons
adds only those. With --no-cache, and for shards, they lie beside the output as FILE.checkpoint until
it is done.

Exit codes: 0 done, 1 input refused, 2 a file, the disk or memory failed, 3 defect of the program,
130 or 143 stopped by SIGINT or SIGTERM with the photons done so far kept.")]
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
    /// Photons over all directions, for instance 1e7; at most 4.29e9 a node. 1e9 if no other goal is
    /// given.
    #[arg(long, value_parser = parse_count)]
    photons: Option<u64>,
    /// Stop when the noise of the table is below this: relative L2 error of S, for instance 1% or 0.01.
    #[arg(long, value_name = "ERROR", value_parser = parse_share)]
    target_error: Option<f64>,
    /// Have a table written after this time, for instance 30s or 2m, with what is done by then.
    #[arg(long, value_name = "TIME", value_parser = parse_time)]
    time: Option<Duration>,
    /// Bake only a part, the second of three for instance, into a file of exact sums
    /// (.safetensors) for `vair merge`.
    #[arg(long, value_name = "I/N", conflicts_with_all = ["target_error", "time", "preview_every"])]
    shard: Option<Shard>,
    /// Inclination nodes.
    #[arg(long, default_value_t = 16)]
    bins: usize,
    /// Bins of the query's azimuth around the section, for flat hairs: 8, say. 1 averages over azimuths.
    #[arg(long, value_name = "N", default_value_t = 1)]
    azimuths: usize,
    /// Texels along a face edge, a power of two.
    #[arg(long, default_value_t = 64)]
    face: usize,
    /// Reflections, refractions and scatterings a photon may undergo; 16 in paper mode, else 1000.
    #[arg(long)]
    max_events: Option<u32>,
    /// Leave the noise in the maps: plain means of the photons, as always in paper mode.
    #[arg(long)]
    raw: bool,
    /// Seed of the fiber, as for `vair fiber`: another one is another hair of the same kind.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Seed of the photons: another one flies other photons through the same fiber, so that two
    /// tables differ by noise alone.
    #[arg(long, default_value_t = 0)]
    photon_seed: u64,
    /// Threads; all cores if not given. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Keep sums and tables within this memory, for instance 500M or 2G, by fewer threads if need be.
    #[arg(long, value_name = "BYTES", value_parser = parse_bytes)]
    memory: Option<u64>,
    /// Write the table as soon as there is one and then this often; each is whole and takes the place
    /// of the one before.
    #[arg(long, value_name = "TIME", value_parser = parse_time)]
    preview_every: Option<Duration>,
    /// How often the sums are saved.
    #[arg(long, value_name = "TIME", value_parser = parse_time, default_value = "30s")]
    checkpoint_every: Duration,
    /// Start anew, whatever was saved of this bake or of another one to the same output.
    #[arg(long)]
    restart: bool,
    /// Override a field of the species: `guard.stations.0.cuticle.pitch_um=9`. May repeat.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Bake even if the cache holds this table, and do not store it there.
    #[arg(long)]
    no_cache: bool,
    /// Where the table goes: an EXR file; for a shard a .safetensors file.
    #[arg(long, short)]
    output: PathBuf,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum ModeArg {
    Cone,
    Paper,
}

/// Runs the command.
pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    let start = Instant::now();
    super::memory::take_in_large_pieces();
    super::with_threads(args.threads, || run::run(args, start, console))?
}

/// Writes a structure table, or a dyed one where the bake has three channels.
pub(super) fn write_table(
    table: &Undyed,
    dye: Option<[f64; 3]>,
    output: &Path,
) -> Result<(), Failure> {
    match table {
        Undyed::Gray(table) => table.write(output)?,
        // Absorption levels serve all colors of one fiber; here each color meets another one.
        Undyed::Colored(_) => table.dye(dye.unwrap_or_default())?.write(output)?,
    }
    Ok(())
}

fn settings(args: &Args) -> Settings {
    let base = match args.mode {
        ModeArg::Cone => Settings::cone(),
        ModeArg::Paper => Settings::paper(),
    };
    // An error or a time is a goal of its own: then as many photons as the sums can hold may be flown.
    let photons = match (args.photons, args.target_error, args.time) {
        (Some(photons), ..) => photons,
        (None, None, None) => base.photons,
        _ => Settings::most_photons(args.bins.saturating_mul(args.azimuths)),
    };
    Settings {
        photons,
        bins: args.bins,
        azimuths: args.azimuths,
        face: args.face,
        max_events: args.max_events.unwrap_or(base.max_events),
        reconstruct: base.reconstruct && !args.raw,
        seed: args.seed,
        photon_seed: args.photon_seed,
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
