//! `vair species`: the library as a field guide.

use super::{Console, Failure};
use crate::blame::Blame;
use crate::species::{self, Cited, HairClass, MedullaKind, Origin, Origins, Species};
use clap::Subcommand;
use serde_json::json;
use std::fmt::Write as _;
use std::io::Write as _;

/// Lists, shows and checks species.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair species
  vair species show red-fox
  vair species show red-fox --set guard.stations.1.cuticle.pitch_um=12 --json
  vair species check my-animal.toml")]
pub(super) struct Args {
    /// Print JSON.
    #[arg(long, global = true)]
    json: bool,
    #[command(subcommand)]
    action: Option<Action>,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Lists the built-in species (the default).
    List,
    /// Shows a species: its hairs, pigment and groom, and where each number comes from.
    Show {
        /// Built-in species, or path of a .toml file.
        name: String,
        /// Overrides a value: key.path=value, list items by index from 0.
        #[arg(long = "set", value_name = "KEY=VALUE")]
        set: Vec<String>,
    },
    /// Checks a species file and reports everything that is wrong with it.
    Check {
        /// Path of a .toml file, or built-in species.
        file: String,
        /// Overrides a value: key.path=value, list items by index from 0.
        #[arg(long = "set", value_name = "KEY=VALUE")]
        set: Vec<String>,
    },
}

/// Runs the command.
///
/// # Errors
/// A species that cannot be loaded.
pub(super) fn run(args: &Args, _console: &Console) -> Result<(), Failure> {
    match &args.action {
        None | Some(Action::List) => list(args.json),
        Some(Action::Show { name, set }) => {
            let (species, origins) = species::load_with_origins(name, set)?;
            if args.json {
                print_json(&json!({ "species": species, "origins": origins }))
            } else {
                print(&field_guide(&species, &origins))
            }
        }
        Some(Action::Check { file, set }) => {
            let (species, origins) = species::load_with_origins(file, set)?;
            let summary = summary(&species, &origins);
            if args.json {
                print_json(&summary)
            } else {
                let stations: usize = species.classes.iter().map(|c| c.stations.len()).sum();
                print(&format!(
                    "{file}: good. {} hair classes, {stations} stations, {} numbers from \
                     literature, {} estimates\n",
                    species.classes.len(),
                    origins.sourced(),
                    origins.estimated()
                ))
            }
        }
    }
}

fn list(as_json: bool) -> Result<(), Failure> {
    let mut rows = Vec::new();
    for id in species::ids() {
        rows.push(species::load_with_origins(id, &[])?);
    }
    if as_json {
        let all: Vec<_> = rows.iter().map(|(s, o)| summary(s, o)).collect();
        return print_json(&json!(all));
    }
    let mut text = format!(
        "{:16}{:16}{:18}{:16}{:>8}{:>11}\n",
        "id", "name", "latin", "hair classes", "sourced", "estimated"
    );
    for (species, origins) in &rows {
        let _ = writeln!(
            text,
            "{:16}{:16}{:18}{:16}{:>8}{:>11}",
            species.id,
            species.name,
            species.latin,
            class_names(species).join(", "),
            origins.sourced(),
            origins.estimated()
        );
    }
    print(&text)
}

fn class_names(species: &Species) -> Vec<&str> {
    species.classes.iter().map(|c| c.name.as_str()).collect()
}

fn summary(species: &Species, origins: &Origins) -> serde_json::Value {
    json!({
        "id": species.id,
        "name": species.name,
        "latin": species.latin,
        "summary": species.summary,
        "classes": class_names(species),
        "sourced": origins.sourced(),
        "estimated": origins.estimated(),
    })
}

fn field_guide(species: &Species, origins: &Origins) -> String {
    let mut page = species.name.clone();
    if !species.latin.is_empty() {
        let _ = write!(page, " ({})", species.latin);
    }
    let _ = writeln!(page, "\n{}\n\nSKIN", species.summary);
    rows(&mut page, &origins.of_table("skin"));
    for class in &species.classes {
        class_pages(&mut page, class, origins);
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

fn class_pages(page: &mut String, class: &HairClass, origins: &Origins) {
    let title = class.name.to_uppercase();
    for (index, station) in class.stations.iter().enumerate() {
        let structure = &station.structure;
        let layers = [
            format!("{}.stations.{index}", class.name),
            format!("{}.structure", class.name),
            "structure".to_owned(),
        ];
        let pattern = json!(structure.cuticle.pattern);
        let _ = writeln!(page, "\n{title}: structure at {} of the length", station.at);
        rows(page, &origins.of_layers(&layers, ""));
        let _ = writeln!(page, "  cuticle: {}", pattern.as_str().unwrap_or_default());
        rows(page, &origins.of_layers(&layers, ".cuticle"));
        let _ = writeln!(page, "  medulla: {}", structure.medulla.kind.name());
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
        let _ = writeln!(page, "\n{title}: pigment from {from} mm to {end}");
        rows(
            page,
            &origins.of_table(&format!("{}.pigment.{index}", class.name)),
        );
        from = band.to_mm;
    }
    let _ = writeln!(page, "\n{title}: groom");
    rows(page, &origins.of_table(&format!("{}.groom", class.name)));
}

/// A line for each number: key, value with unit, origin.
fn rows(page: &mut String, numbers: &[&Cited]) {
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
        wrapped(
            page,
            &format!("    {key:<20} {:<20} ", value.trim()),
            &origin,
        );
    }
}

/// Writes `text` after `head`, broken at 100 columns and indented below the end of `head`.
fn wrapped(page: &mut String, head: &str, text: &str) {
    const WIDTH: usize = 100;
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

fn print_json(value: &serde_json::Value) -> Result<(), Failure> {
    print(&format!("{value:#}\n"))
}

/// Writes to stdout; a reader that has gone away (`| head`) is no failure.
fn print(text: &str) -> Result<(), Failure> {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::new(
            Blame::Environment,
            format!("cannot write to stdout: {e}"),
        )),
        _ => Ok(()),
    }
}
