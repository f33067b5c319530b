//! `vair species show`: an animal like a page of a field guide.

use super::{Failure, print, print_json, prose, sourced};
use crate::species::{self, Cited, HairClass, MedullaKind, Origin, Origins, Species};
use serde_json::json;
use std::fmt::Write as _;

/// Columns of the page.
const WIDTH: usize = 100;

/// Options of `vair species show`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair species show red-fox
  vair species show \"vulpes vulpes\" --json
  vair species show my-cat.toml
  vair species show mink --set guard.stations.1.cuticle.pitch_um=12")]
pub(super) struct Args {
    /// Built-in species by id, common or scientific name, or path of a .toml file.
    name: String,
    /// Overrides a value: key.path=value, list items by index from 0.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
}

/// Runs the command.
pub(super) fn run(args: &Args, as_json: bool) -> Result<(), Failure> {
    let (species, origins) = species::load_with_origins(&args.name, &args.set)?;
    if as_json {
        print_json(&json!({ "species": species, "origins": origins }))
    } else {
        print(&page(&species, &origins))
    }
}

/// The page of an animal as text.
pub(in crate::cli) fn page(species: &Species, origins: &Origins) -> String {
    let mut page = title(species);
    for class in &species.classes {
        description(&mut page, class);
    }
    let _ = writeln!(
        page,
        "\nNUMBERS\n  {} come from literature [KEY], the others are estimates.",
        sourced(origins)
    );
    let _ = writeln!(page, "\n  Skin");
    rows(&mut page, &origins.of_table("skin"));
    for class in &species.classes {
        numbers(&mut page, class, origins);
    }
    if !origins.references.is_empty() {
        page.push_str("\nSOURCES\n");
        for reference in &origins.references {
            wrapped(
                &mut page,
                &format!("  {:<12}", reference.key),
                &reference.text,
            );
        }
    }
    page
}

/// Names and summary.
fn title(species: &Species) -> String {
    let mut page = format!("{}\n", species.name.to_uppercase());
    let kin = [&species.latin, &species.family, &species.group];
    let kin: Vec<&str> = kin
        .iter()
        .map(|s| s.as_str())
        .filter(|s| !s.is_empty())
        .collect();
    if !kin.is_empty() {
        let _ = writeln!(page, "{}", kin.join(" - "));
    }
    if !species.synonyms.is_empty() {
        wrapped(&mut page, "also ", &species.synonyms.join(", "));
    }
    page.push('\n');
    wrapped(&mut page, "", &species.summary);
    page
}

/// A hair class in sentences, root to tip.
fn description(page: &mut String, class: &HairClass) {
    let _ = writeln!(page, "\n{}", class.name.to_uppercase());
    wrapped(page, "  ", &prose::measures(&class.groom));
    let several = class.stations.len() > 1;
    for station in &class.stations {
        let place = if several {
            format!("at {:.0} %", 100.0 * station.at)
        } else {
            "all along".to_owned()
        };
        let head = format!("  {place:<11}");
        wrapped(page, &head, &prose::section(&station.structure));
        wrapped(
            page,
            "             scales   ",
            &prose::scales(&station.structure.cuticle),
        );
        wrapped(
            page,
            "             medulla  ",
            &prose::medulla(&station.structure.medulla),
        );
    }
    wrapped(page, "  color      ", &prose::color(class));
    wrapped(page, "  growth     ", &prose::growth(&class.groom));
}

/// Every number of a class with its origin.
fn numbers(page: &mut String, class: &HairClass, origins: &Origins) {
    let name = &class.name;
    for (index, station) in class.stations.iter().enumerate() {
        let layers = [
            format!("{name}.stations.{index}"),
            format!("{name}.structure"),
            "structure".to_owned(),
        ];
        let structure = &station.structure;
        let _ = writeln!(page, "\n  {name} at {} of the length", station.at);
        rows(page, &origins.of_layers(&layers, ""));
        let _ = writeln!(page, "   cuticle: {}", structure.cuticle.pattern.name());
        rows(page, &origins.of_layers(&layers, ".cuticle"));
        let cortex = origins.of_layers(&layers, ".cortex");
        if !cortex.is_empty() {
            let _ = writeln!(page, "   cortex");
            rows(page, &cortex);
        }
        let _ = writeln!(page, "   medulla: {}", structure.medulla.kind.name());
        if structure.medulla.kind != MedullaKind::None {
            rows(page, &origins.of_layers(&layers, ".medulla"));
        }
    }
    let mut from = 0.0;
    for (index, band) in class.pigment.iter().enumerate() {
        let end = if band.to_mm.is_finite() {
            format!("{} mm from the tip", band.to_mm)
        } else {
            "the root".to_owned()
        };
        let _ = writeln!(page, "\n  {name}: pigment from {from} mm to {end}");
        rows(page, &origins.of_table(&format!("{name}.pigment.{index}")));
        from = band.to_mm;
    }
    let _ = writeln!(page, "\n  {name}: groom");
    rows(page, &origins.of_table(&format!("{name}.groom")));
}

/// A line for each number: key, value with unit, origin unless it is that of the line above.
fn rows(page: &mut String, numbers: &[&Cited]) {
    let mut above = String::new();
    for number in numbers {
        let key = number.path.rsplit('.').next().unwrap_or_default();
        let values: Vec<String> = number.values.iter().map(f64::to_string).collect();
        let value = format!("{} {}", values.join(" "), number.unit);
        let mut origin = match &number.origin {
            Origin::Source(keys) => format!("[{}]", keys.join(", ")),
            Origin::Estimate(why) => format!("estimate: {why}"),
            Origin::Override => "given by --set".to_owned(),
        };
        if let Some(note) = &number.note {
            let _ = write!(origin, " {note}");
        }
        let shown = if origin == above { "same" } else { &origin };
        wrapped(page, &format!("    {key:<20} {:<20} ", value.trim()), shown);
        above = origin;
    }
}

/// Writes `text` after `head`, broken at the width of the page and indented below the end of `head`.
fn wrapped(page: &mut String, head: &str, text: &str) {
    let indent = head.chars().count();
    let mut column = indent;
    page.push_str(head);
    for (index, word) in text.split_whitespace().enumerate() {
        let length = word.chars().count();
        if index > 0 {
            if column + 1 + length > WIDTH {
                let _ = write!(page, "\n{:indent$}", "");
                column = indent;
            } else {
                page.push(' ');
                column += 1;
            }
        }
        page.push_str(word);
        column += length;
    }
    page.push('\n');
}
