//! Bins of azimuth as attributes.

use super::attributes::Attributes;
use super::decode::wrong;
use super::parts::Part;
use crate::math::symmetry::Symmetry;
use crate::table::{Azimuths, Nodes, TableError};

const SYMMETRIES: [(Symmetry, &str); 3] = [
    (Symmetry::None, "none"),
    (Symmetry::MinorAxis, "minor-axis"),
    (Symmetry::BothAxes, "both-axes"),
];

/// Name of a part.
pub(super) fn part_name(azimuths: &Azimuths, bin: usize, inclinations: usize) -> String {
    if azimuths.is_averaged() {
        return format!("bin{bin:02}");
    }
    let (azimuth, bin) = (bin / inclinations, bin % inclinations);
    format!("azimuth{azimuth:02}-bin{bin:02}")
}

/// What a table with several azimuths says of them in its first part.
pub(super) fn put_head(head: &mut Attributes, azimuths: &Azimuths) {
    if azimuths.is_averaged() {
        return;
    }
    head.int("azimuths", azimuths.count);
    let name = SYMMETRIES.iter().find(|(s, _)| *s == azimuths.symmetry);
    head.text("symmetry", name.map_or("", |(_, name)| name));
}

/// What a node says of its own.
pub(super) fn put_bin(attributes: &mut Attributes, nodes: &Nodes, node: usize) {
    if nodes.azimuths.is_averaged() {
        return;
    }
    let [from, to, middle] = degrees(&nodes.azimuths, nodes.azimuth_bin(node));
    attributes.double("azimuth_deg", middle);
    attributes.double("azimuth_from_deg", from);
    attributes.double("azimuth_to_deg", to);
}

fn degrees(azimuths: &Azimuths, bin: usize) -> [f64; 3] {
    let [from, to] = azimuths.range_turns(bin).map(|turns| 360.0 * turns);
    [from, to, 0.5 * (from + to)]
}

/// The azimuths of a table that has several.
pub(super) fn of_head(head: &Attributes) -> Result<Azimuths, TableError> {
    let count = head.get_int("azimuths")?;
    if count < 2 {
        return Err(wrong(format!("it has {count} azimuths, not 2 or more")));
    }
    let name = head.get_text("symmetry")?;
    let symmetry = SYMMETRIES.iter().find(|(_, n)| *n == name);
    let &(symmetry, _) = symmetry.ok_or_else(|| {
        wrong(format!(
            "its symmetry is {name:?}, not none, minor-axis or both-axes"
        ))
    })?;
    Ok(Azimuths { count, symmetry })
}

/// Refuses parts whose azimuths are not those of the table, or whose inclinations differ from one
/// azimuth to the next.
pub(super) fn check_parts(azimuths: &Azimuths, parts: &[Part]) -> Result<(), TableError> {
    if azimuths.is_averaged() {
        return Ok(());
    }
    let bins = parts.len() / azimuths.count;
    for (i, part) in parts.iter().enumerate() {
        let near = |name: &str, expected: f64| {
            let found = part.attributes.get_double(name)?;
            if (found - expected).abs() < 1e-9 {
                return Ok(());
            }
            Err(wrong(format!(
                "vair:{name} of part {} is {found}, not {expected}",
                part.name
            )))
        };
        let [from, to, middle] = degrees(azimuths, i / bins);
        near("azimuth_from_deg", from)?;
        near("azimuth_deg", middle)?;
        near("azimuth_to_deg", to)?;
        let first = &parts[i % bins].attributes;
        for name in ["theta_from_deg", "theta_deg", "theta_to_deg"] {
            near(name, first.get_double(name)?)?;
        }
    }
    Ok(())
}
