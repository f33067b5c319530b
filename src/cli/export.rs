//! `vair export`: the fur of a species for other programs.

mod announce;
mod coats;
mod lines;
mod settings;
mod usdz;
mod volume;

use super::cache;
use super::color;
use super::skin::SkinArgs;
use super::{Console, Failure, bake::parse_count};
use crate::assembly::{self, StationTables};
use crate::bake::Settings;
use crate::blame::Blame;
use crate::export::asset::{self, ClassLook, Parts, Wear};
use crate::export::{ExportError, Format};
use crate::groom::{self, Groom, GroomSettings};
use crate::io::check_writable;
use crate::skin::Skin;
use crate::species::Species;
use announce::{announce, described};
use coats::Dressed;
use settings::{CurvesArg, LayoutArg, UnitsArg, UpArg, settings};
use std::path::PathBuf;

/// Arguments of `vair export`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair export red-fox -o fox.usdc
  vair export mink --skin sofa.obj --skin-units cm --strands 1e6 -o sofa.usdc
  vair export red-fox --profile unreal --units cm --up z -o fox.usd
  vair export cat --coat tabby -o tabby.usdc
  vair export cat --coats tabby,siamese,none -o cats.usdc
  vair export red-fox --layout payload -o fox.usda
  vair export lynx --profile blender --levels 1 -o lynx.usdc
  vair export cat --strands 500 --curves phantom -o cat.usda
  vair export mink --grids density,color,surface --wrap mink-volume.usda -o mink.vdb

The file is a component asset: under its default prim stand the skin as a mesh (geo/skin), the strands
as curves, one prim a hair class (geo/render), few wide strands for viewports (geo/proxy) and guides
(geo/guide). Levels of detail are the variants of `lod`; a coarser one has a quarter of the strands of
the one before, the same strands, wider so that the coat stays opaque. Coats to choose from are variants
of `coat`.

Materials are Chiang's hair model (MaterialX's ND_chiang_hair_bsdf) fitted to the baked scattering table
of each class and zone of pigment, with the error of the fit; hair that changes color along its length
reads the absorption from its points. A preview surface stands beside each.

Widths are diameters in the units of the file. The same command gives the same bytes on any number of
threads.")]
pub(super) struct Args {
    /// A built-in species or a path to a species file.
    name: String,
    /// Pattern of the coat: tabby, leopard, zebra, badger, fox, cow, countershaded, siamese,
    /// tortoiseshell, the path of a recipe, or none; if not given, that of the species.
    #[arg(long, value_name = "NAME")]
    coat: Option<String>,
    /// Coats to choose from in a USD asset, as variants of `coat`: the first is shown, and is that of other
    /// formats.
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "NAMES",
        conflicts_with = "coat"
    )]
    coats: Vec<String>,
    #[arg(long, value_name = "COLOR", value_parser = color::parse, conflicts_with_all = ["coat", "coats"], help = color::HELP)]
    color: Option<[f64; 3]>,
    #[command(flatten)]
    on: SkinArgs,
    /// Strands in all; if not given, as many as the animal has, at most 250000. Fewer are wider, to cover
    /// as much: see `keep_widths` of a species.
    #[arg(long, value_parser = parse_count)]
    strands: Option<u64>,
    /// Seed of the fur.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// How strands are written; pinned is read by most.
    #[arg(long, value_enum, default_value = "pinned")]
    curves: CurvesArg,
    /// Unit of length of the file.
    #[arg(long, value_enum, default_value = "m")]
    units: UnitsArg,
    /// Axis of the file that points up.
    #[arg(long, value_enum, default_value = "y")]
    up: UpArg,
    /// Who is to read the file: all, or some of blender, unreal, houdini, arnold, renderman, omniverse
    /// and storm. Attributes that none of them reads are left out.
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "READERS",
        default_value = "all"
    )]
    profile: Vec<String>,
    /// Levels of detail, 1 to 4.
    #[arg(long, value_name = "N", default_value_t = 3)]
    levels: usize,
    /// One file, or a small one that loads `NAME.payload.usdc` beside it on demand.
    #[arg(long, value_enum, default_value = "single")]
    layout: LayoutArg,
    /// Leave out the few wide strands for viewports.
    #[arg(long)]
    no_proxy: bool,
    /// Leave out the guides.
    #[arg(long)]
    no_guides: bool,
    /// Leave out the materials, and with them the bake.
    #[arg(long)]
    no_material: bool,
    /// Photons for each scattering table that a material is fitted to.
    #[arg(long, value_parser = parse_count, default_value = "3e5")]
    bake_photons: u64,
    /// Bake even if the cache holds the tables, and do not store them there.
    #[arg(long)]
    no_cache: bool,
    /// Threads; all cores if not given. The file does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Override a field of the species: `guard.groom.length_mm=20`. May repeat.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    #[command(flatten)]
    volume: volume::VolumeArgs,
    /// Where the fur goes: .usdc, .usd or .usda; a mesh in its place for viewers on phones: .usdz; grids of it: .vdb; plain strands: .hair, .npz, .ply,
    /// .glb, .pbrt, .txt for Mitsuba. May repeat.
    #[arg(long, short, required = true)]
    output: Vec<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// What was refused, what could not be written, or stopped; no file is left half-written.
pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    super::with_threads(args.threads, || run_here(args, console))?
}

impl From<ExportError> for Failure {
    fn from(error: ExportError) -> Self {
        match error.remedy() {
            Some(help) => Self::with_help(error.blame(), &error, help),
            None => Self::new(error.blame(), error),
        }
    }
}

fn run_here(args: &Args, console: &Console) -> Result<(), Failure> {
    // All that can be refused is refused before any work.
    let mut dressed = coats::dressed(args)?;
    let settings = settings(args)?;
    let grids = volume::settings(&args.volume, &args.output, settings.frame)?;
    for output in &args.output {
        if Format::of(output)? == Format::Usdz {
            crate::export::usdz::check(output, settings.frame)?;
        }
        check_writable(output)?;
    }
    check_apart(args)?;
    let skin = args.on.load()?;
    for warning in &skin.warnings {
        console.say(format!("warning: {warning}"));
    }
    let strands = args.strands.map(|n| n as usize);
    let forecast = groom::forecast(&skin, &dressed[0].species, strands)?;
    announce(args, &settings, &skin, &forecast, console)?;

    let cancel = console.cancel();
    let grown = GroomSettings {
        strands,
        seed: args.seed,
    };
    // Only assets have materials, and a choice of coats.
    let is_asset = writes_usd(args)?;
    let mut grooms = Vec::new();
    let shown = dressed[0].name.clone();
    for Dressed { name, species } in dressed
        .iter_mut()
        .take(if is_asset { usize::MAX } else { 1 })
    {
        if args.coats.len() > 1 {
            console.say(format!("coat {name}"));
        }
        let looks = match is_asset {
            true => looks(args, species, &skin, &grown, console)?,
            false => Vec::new(),
        };
        let groom = groom::grow(&skin, species, &grown, console, cancel)?;
        for warning in &groom.warnings {
            console.say(format!("warning: {warning}"));
        }
        let first = grooms.first().map(|(groom, ..): &(Groom, _, _)| groom);
        if first.is_some_and(|first| first.id != groom.id) {
            let message = format!(
                "coat {name} has other strands than {shown}: trim_mm cuts what coats shorten"
            );
            let help = "write each coat to a file of its own with --coat, or leave out trim_mm";
            return Err(Failure::with_help(Blame::Input, message, help));
        }
        let levels = asset::levels(&groom, &skin, species, args.levels)?;
        grooms.push((groom, looks, levels));
    }
    let species = &dressed[0].species;
    let (groom, looks, levels) = &grooms[0];
    let wears = dressed.iter().zip(&grooms);
    let wears: Vec<Wear<'_>> = wears
        .map(|(Dressed { name, species }, (groom, looks, levels))| Wear {
            name,
            species,
            groom,
            levels,
            looks,
        })
        .collect();
    let parts = Parts {
        groom,
        skin: &skin,
        species,
        levels,
        looks,
        coats: if args.coats.is_empty() { &[] } else { &wears },
        seed: args.seed,
    };
    let frame = settings.frame;
    for output in &args.output {
        match Format::of(output)? {
            Format::Lines(format) => lines::run(output, format, &parts, frame, console)?,
            Format::Vdb => volume::run(output, &parts, &args.volume, &grids, frame, console)?,
            Format::Usdz => usdz::run(output, &parts, frame, console)?,
            Format::Usd(_) => {
                asset::write(output, &parts, &settings, console, cancel)?;
                console.say(format!("{}: {}", output.display(), described(&parts)));
            }
        }
    }
    Ok(())
}

/// Materials for other renderers, and what they lose.
fn looks(
    args: &Args,
    species: &mut Species,
    skin: &Skin,
    grown: &GroomSettings,
    console: &Console,
) -> Result<Vec<ClassLook>, Failure> {
    if args.no_material {
        return Ok(Vec::new());
    }
    let cache = cache::of_user(args.no_cache, console);
    let bake = Settings {
        photons: args.bake_photons,
        seed: args.seed,
        ..Settings::cone()
    };
    let cancel = console.cancel();
    let cache = cache.as_ref();
    let mut tables = None;
    if species.is_dyed() {
        let all = StationTables::new(species, &[], &bake, cache, console, cancel)?;
        color::match_colors(species, &all, skin, grown, console)?;
        tables = Some(all);
    }
    let looks = assembly::looks(species, tables.as_ref(), &bake, cache, console, cancel)?;
    for (class, look) in species.classes.iter().zip(&looks) {
        let errors: Vec<String> = (look.parts.iter().flatten())
            .map(|zone| format!("{:.0} %", 100.0 * zone.mean_error()))
            .collect();
        console.say(format!(
            "material of {}: Chiang's model, off the table by {} (S, from tip to root)",
            class.name,
            errors.join(", ")
        ));
    }
    Ok(looks)
}

/// Refuses a command of which one file would take the place of another.
fn check_apart(args: &Args) -> Result<(), Failure> {
    let mut files: Vec<PathBuf> = args.output.clone();
    files.extend(args.volume.wrap.clone());
    if matches!(args.layout, LayoutArg::Payload) {
        for output in &args.output {
            if let Format::Usd(_) = Format::of(output)? {
                files.push(asset::payload_of(output));
            }
        }
    }
    let mut places = std::collections::HashSet::new();
    for file in files {
        if !places.insert(std::path::absolute(&file).unwrap_or_else(|_| file.clone())) {
            let message = format!(
                "{} would be written twice, one over the other",
                file.display()
            );
            let help = "give each -o, --wrap and payload (NAME.payload.usdc) a name of its own";
            return Err(Failure::with_help(Blame::Input, message, help));
        }
    }
    Ok(())
}

/// Whether any output is an asset, not only grids and plain strands.
fn writes_usd(args: &Args) -> Result<bool, ExportError> {
    let formats: Result<Vec<_>, _> = args.output.iter().map(|o| Format::of(o)).collect();
    Ok(formats?.iter().any(|f| matches!(f, Format::Usd(_))))
}
