//! `vair species list`: the library, family by family.

use super::{Failure, print, print_json, sourced, summary};
use crate::species::{self, Origins, Species};
use serde_json::json;
use std::fmt::Write as _;

/// Examples of the command.
pub(super) const EXAMPLES: &str = "Examples:
  vair species list
  vair species list --json | jq '.[] | select(.family == \"Canidae\") | .id'";

/// Runs the command.
pub(super) fn run(as_json: bool) -> Result<(), Failure> {
    let mut all = Vec::new();
    for id in species::ids() {
        all.push(species::load_with_origins(id, &[])?);
    }
    if as_json {
        let rows: Vec<_> = all.iter().map(|(s, o)| summary(s, o)).collect();
        return print_json(&json!(rows));
    }
    print(&page(&all))
}

/// A heading for each group, a line for each species.
fn page(all: &[(Species, Origins)]) -> String {
    let mut page = String::new();
    for group in all.chunk_by(|(a, _), (b, _)| a.group == b.group) {
        let _ = writeln!(page, "{}", heading(group));
        for (species, origins) in group {
            let _ = writeln!(
                page,
                "  {:16} {:28} {:26} {:>9} numbers from literature",
                species.id,
                species.name,
                species.latin,
                sourced(origins)
            );
        }
        page.push('\n');
    }
    let _ = writeln!(
        page,
        "{} species. The other numbers are estimates that say why: vair species show ID",
        all.len()
    );
    page
}

/// `SEALS  Phocidae, Otariidae`.
fn heading(group: &[(Species, Origins)]) -> String {
    let mut families: Vec<&str> = group.iter().map(|(s, _)| s.family.as_str()).collect();
    families.dedup();
    let title = group.first().map_or("", |(s, _)| s.group.as_str());
    let heading = format!("{}  {}", title.to_uppercase(), families.join(", "));
    heading.trim_end().to_owned()
}
