//! `vair species check`: everything that is wrong with species files.

use super::{Failure, print, print_json, summary};
use crate::blame::Blame;
use crate::species::{self, Origins, Place, Problem, Species, SpeciesError, SpeciesErrors};
use serde_json::{Value, json};

/// Options of `vair species check`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair species check my-cat.toml
  vair species check animals/*.toml
  vair species check my-cat.toml --json
  vair species check my-cat.toml --set guard.groom.length_mm=40

Ends with 0 if all files are good, 1 if one is refused or not there, 2 if one cannot be read.")]
pub(super) struct Args {
    /// Paths of .toml files, or built-in species.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<String>,
    /// Overrides a value in each file: key.path=value, list items by index from 0.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
}

/// Runs the command.
pub(super) fn run(args: &Args, as_json: bool) -> Result<(), Failure> {
    let mut rows = Vec::new();
    let mut refused: Vec<Failure> = Vec::new();
    for file in &args.files {
        match species::load_with_origins(file, &args.set) {
            Ok((species, origins)) if as_json => rows.push(good_row(file, &species, &origins)),
            Ok((species, origins)) => print(&good_line(file, &species, &origins))?,
            Err(error) => {
                rows.push(refused_row(file, &error));
                refused.push(error.into());
            }
        }
    }
    if as_json {
        print_json(&Value::Array(rows))?;
    }
    finish(refused, args.files.len())
}

/// All reports, one after the other; the worst blame decides the exit code.
fn finish(mut refused: Vec<Failure>, files: usize) -> Result<(), Failure> {
    if files == 1 {
        return refused.pop().map_or(Ok(()), Err);
    }
    if refused.is_empty() {
        return Ok(());
    }
    for failure in &refused {
        failure.report();
    }
    let environment = refused.iter().any(|f| f.blame == Blame::Environment);
    let blame = if environment {
        Blame::Environment
    } else {
        Blame::Input
    };
    let message = format!("{} of {files} files are refused", refused.len());
    Err(Failure::new(blame, message))
}

fn good_line(file: &str, species: &Species, origins: &Origins) -> String {
    let stations: usize = species.classes.iter().map(|c| c.stations.len()).sum();
    format!(
        "{file}: good. {} hair classes, {stations} stations, {} numbers from literature, {} \
         estimates\n",
        species.classes.len(),
        origins.sourced(),
        origins.estimated()
    )
}

fn good_row(file: &str, species: &Species, origins: &Origins) -> Value {
    let mut row = summary(species, origins);
    row["file"] = json!(file);
    row["good"] = json!(true);
    row["problems"] = json!([]);
    row
}

fn refused_row(file: &str, error: &SpeciesError) -> Value {
    let (problems, count) = match error {
        SpeciesError::Invalid(errors) => {
            let rows = errors.problems.iter().map(|p| problem_row(errors, p));
            (rows.collect(), errors.count)
        }
        other => (vec![json!({ "message": other.to_string() })], 1),
    };
    json!({ "file": file, "good": false, "problems": problems, "count": count })
}

fn problem_row(errors: &SpeciesErrors, problem: &Problem) -> Value {
    let mut row = json!({ "message": problem.message, "hint": problem.hint });
    match &problem.place {
        Place::File(span) => {
            let (line, column) = errors.line_column(span.start);
            row["line"] = json!(line);
            row["column"] = json!(column);
        }
        Place::Set(_) => row["set"] = json!(errors.locate(&problem.place)),
    }
    row
}
