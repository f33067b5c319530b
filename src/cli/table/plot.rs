//! `vair table plot`: the scattering function as a picture.

use super::dye::Pigment;
use super::{at_azimuth, averaged};
use crate::blame::Blame;
use crate::cli::{Console, Failure, check_output};
use crate::species;
use crate::table::{
    Mode, Plot, Provenance, ScatterMaps, SmoothCylinder, StructureTable, TableError, TableFile,
};
use std::path::PathBuf;

/// Options of `vair table plot`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  vair table plot fox.exr -o fox.png\n  \
    vair table plot fox.exr -o fox.png --incidence 30 --species red-fox --band 0\n  \
    vair table plot fox.exr -o fox.png --level 5 --size 2400x1500")]
pub(super) struct Args {
    /// A structure table or a dyed one.
    file: PathBuf,
    /// The picture to write (PNG).
    #[arg(long, short)]
    output: PathBuf,
    /// Inclination of the query direction in degrees, positive toward the tip.
    #[arg(long, value_name = "DEG", default_value_t = 45.0)]
    incidence: f64,
    /// Azimuth of the query direction in degrees from the major axis of the section, of a table that has
    /// azimuths; the mean over all if not given.
    #[arg(long, value_name = "DEG")]
    azimuth: Option<f64>,
    /// Width and height of the picture in pixels.
    #[arg(long, value_name = "WxH", default_value = "1600x1000", value_parser = parse_size)]
    size: (usize, usize),
    /// Absorption level of a structure table; the clear level if no pigment is given either.
    #[arg(long, value_name = "K", conflicts_with_all = ["eumelanin", "pheomelanin", "absorption", "species"])]
    level: Option<usize>,
    #[command(flatten)]
    pigment: Pigment,
}

pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    check_output(&args.output, "a plot", "png")?;
    let pigment = args.pigment.absorption_per_um()?;
    let table = TableFile::read(&args.file)?;
    let azimuths = table.azimuths();
    let (table, side) = match args.azimuth {
        None => (table.averaged()?, String::new()),
        Some(_) if azimuths.is_averaged() => return Err(averaged()),
        Some(degrees) => {
            let [from, to, _] = azimuths.range(azimuths.bin(degrees.to_radians()).bin);
            let [from, to] = [from, to].map(f64::to_degrees);
            (
                at_azimuth(table, degrees),
                format!(", azimuth {from}° to {to}°"),
            )
        }
    };
    let subject = match table {
        TableFile::Scatter(maps) => {
            if args.level.is_some() || pigment.is_some() {
                return Err(Failure::new(
                    Blame::Input,
                    format!("{} is dyed already", args.file.display()),
                ));
            }
            Subject::of_pigment(maps)
        }
        TableFile::Structure(table) => match (pigment, args.level) {
            (Some(absorption), _) => Subject::of_pigment(table.dye(absorption)?),
            (None, level) => Subject::of_level(&table, level.unwrap_or(0))?,
        },
    };
    let maps = &subject.maps;
    let mode = match maps.nodes.mode {
        Mode::Paper => "paper",
        Mode::Cone => "cone",
    };
    // Four digits of them.
    let photons = maps.photons();
    let last = 10f64.powf(photons.max(1.0).log10().floor() - 3.0).max(1.0);
    let photons = (photons / last).round() * last;
    let plot = Plot {
        maps,
        gray: subject.gray,
        closed_form: closed_form(maps),
        incidence_deg: args.incidence,
        title: format!(
            "{}, incidence {}°{side}",
            name(&maps.provenance),
            args.incidence
        ),
        subtitle: format!(
            "{}; {mode} mode, {} x 6 x {res} x {res}, {photons:e} photons",
            subject.color,
            maps.nodes.len(),
            res = maps.res
        ),
        size: args.size,
    };
    plot.draw()?.write_png(&args.output)?;
    console.say(format_args!("drawn: {}", args.output.display()));
    Ok(())
}

/// What is drawn, and in which color.
struct Subject {
    maps: ScatterMaps,
    gray: bool,
    color: String,
}

impl Subject {
    fn of_pigment(maps: ScatterMaps) -> Self {
        let [r, g, b] = maps.absorption_per_um;
        Self {
            maps,
            gray: false,
            color: format!("absorption {r:.4} {g:.4} {b:.4} per µm"),
        }
    }

    fn of_level(table: &StructureTable, level: usize) -> Result<Self, TableError> {
        let Some(&depth) = table.levels.get(level) else {
            let last = table.levels.len() - 1;
            return Err(TableError::Request(format!(
                "level {level} was asked for; the table has levels 0 to {last}"
            )));
        };
        Ok(Self {
            maps: table.dye([depth / table.radius_um; 3])?,
            gray: true,
            color: match level {
                0 => "clear".to_owned(),
                _ => format!("absorption level {level}, optical depth {depth} per radius"),
            },
        })
    }
}

/// The closed form of the fiber that a table comes from, if it is a smooth bare cylinder: alike in all
/// but size and index to the built-in one.
fn closed_form(maps: &ScatterMaps) -> Option<SmoothCylinder> {
    let provenance = &maps.provenance;
    let text = &provenance.species_text;
    // Overrides stand at the end as comments.
    let overrides = text
        .lines()
        .filter_map(|line| line.strip_prefix("# --set "));
    let overrides: Vec<String> = overrides.map(str::to_owned).collect();
    let (species, _) = species::parse(text, &provenance.species, "species", &overrides).ok()?;
    let class = species
        .classes
        .iter()
        .find(|c| c.name == provenance.class)?;
    let structure = class.structure_at(provenance.station)?;
    let same = format!("structure.ior={}", structure.ior);
    let glass = species::load("glass-cylinder", &[same]).ok()?;
    let mut glass = glass.classes.first()?.structure_at(0.5)?;
    glass.diameter_um = structure.diameter_um;
    (glass == structure).then(|| SmoothCylinder {
        eta: structure.ior,
        tau: maps.absorption_per_um.map(|a| a * maps.radius_um),
    })
}

fn name(provenance: &Provenance) -> String {
    let species = match provenance.species.as_str() {
        "" => "a fiber",
        species => species,
    };
    let class = &provenance.class;
    if class.is_empty() {
        return species.to_owned();
    }
    format!("{species} {class}, station {}", provenance.station)
}

/// `1600x1000`.
pub(super) fn parse_size(text: &str) -> Result<(usize, usize), String> {
    text.split_once('x')
        .and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)))
        .ok_or_else(|| "expected width and height in pixels, for example 1600x1000".to_owned())
}
