//! `vair table dye`: pigment for a structure table.

use crate::blame::Blame;
use crate::cli::bake::find_class;
use crate::cli::color;
use crate::cli::{Console, Failure, check_output};
use crate::species::{self, PigmentBand};
use crate::table::StructureTable;
use std::path::PathBuf;

/// Options of `vair table dye`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  \
    vair table dye fox.exr -o fox-dyed.exr --species red-fox\n  \
    vair table dye fox.exr -o fox-red.exr --eumelanin 0.3 --pheomelanin 1.2\n  \
    vair table dye fox.exr -o fox-blue.exr --absorption 0.05,0.02,0.001")]
pub(super) struct Args {
    /// The structure table.
    file: PathBuf,
    /// The dyed table to write.
    #[arg(long, short)]
    output: PathBuf,
    #[command(flatten)]
    pigment: Pigment,
}

/// A pigment: melanin or bare absorption.
#[derive(Debug, clap::Args)]
pub(super) struct Pigment {
    /// The pigment of a species: a built-in name or a path.
    #[arg(long, value_name = "NAME", conflicts_with_all = ["eumelanin", "pheomelanin", "absorption"])]
    species: Option<String>,
    /// Hair class of the species; its first one if not given.
    #[arg(long, requires = "species")]
    class: Option<String>,
    /// Pigment band of the class, counted from 0 at the tip.
    #[arg(long, requires = "species", default_value_t = 0)]
    band: usize,
    /// Eumelanin (brown to black) in the units of hair shaders, for a fiber of 40 um radius.
    #[arg(long, value_name = "C", conflicts_with = "absorption")]
    eumelanin: Option<f64>,
    /// Pheomelanin (yellow to red), same units.
    #[arg(long, value_name = "C", conflicts_with = "absorption")]
    pheomelanin: Option<f64>,
    /// Absorption of the cortex per micrometer for linear red, green and blue.
    #[arg(long, value_name = "R,G,B", value_parser = parse_rgb)]
    absorption: Option<[f64; 3]>,
}

impl Pigment {
    /// Absorption per micrometer; `None` if no option was given.
    pub(super) fn absorption_per_um(&self) -> Result<Option<[f64; 3]>, Failure> {
        if let Some(name) = &self.species {
            let species = species::load(name, &[])?;
            let class = find_class(&species, self.class.as_deref())?;
            let band = class.pigment.get(self.band).ok_or_else(|| {
                let (name, bands) = (&class.name, class.pigment.len());
                let message = format!("{} {name} has no pigment band {}", species.id, self.band);
                Failure::with_help(
                    Blame::Input,
                    message,
                    format!("it has {bands}, counted from 0 at the tip"),
                )
            })?;
            return Ok(Some(band.absorption_per_um()));
        }
        if self.eumelanin.is_some() || self.pheomelanin.is_some() {
            let band = PigmentBand {
                to_mm: f64::INFINITY,
                softness_mm: 0.0,
                eumelanin: self.eumelanin.unwrap_or(0.0),
                pheomelanin: self.pheomelanin.unwrap_or(0.0),
                dye: None,
            };
            return Ok(Some(band.absorption_per_um()));
        }
        Ok(self.absorption)
    }
}

pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    let absorption = args.pigment.absorption_per_um()?.ok_or_else(|| {
        Failure::with_help(
            Blame::Input,
            "no pigment was given",
            "use --species NAME, --eumelanin and --pheomelanin, or --absorption R,G,B",
        )
    })?;
    check_output(&args.output, "a table", "exr")?;
    let maps = StructureTable::read(&args.file)?.dye(absorption)?;
    maps.write(&args.output)?;
    console.say(format_args!(
        "dyed with {:.6} {:.6} {:.6} per um: {}",
        absorption[0],
        absorption[1],
        absorption[2],
        args.output.display()
    ));
    Ok(())
}

/// `R,G,B` or a single number for all three.
fn parse_rgb(text: &str) -> Result<[f64; 3], String> {
    let all = || text.trim().parse().ok().map(|all| [all; 3]);
    color::numbers(text)
        .or_else(all)
        .ok_or_else(|| "expected three numbers separated by commas".to_owned())
}
