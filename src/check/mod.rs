//! Reads files of fur back and tells what each program will refuse, ignore or misread.
//!
//! Twenty rules ([`RULES`]) of what is known of readers, by measurement, from their sources or from what
//! their users ran into. The files may be anyone's; what they refer to beside them is followed.

mod attributes;
mod consumer;
mod curves;
mod extent;
mod finding;
mod frames;
mod groom;
mod layer;
mod material;
mod package;
mod rule;
mod schema;
mod stage;
mod volume;
mod widths;

pub use consumer::Consumer;
pub use finding::{Finding, Severity};
pub use rule::{Described, RULES, Rule};
pub use schema::json_schema;

use crate::blame::Blame;
use crate::io::{FileError, read_bounded};
use crate::usd_file::{self, Files, Layer, Prim, UsdFileError, Value, compose};
use crate::vdb_file::{self, VdbFacts, VdbFileError};
use curves::Curves;
use finding::{Findings, Place};
use frames::Region;
use groom::Ids;
use stage::{Item, items};
use std::path::Path;

/// Longest file that is read, bytes.
const LONGEST: u64 = 4 << 30;

/// Most variants of a stage that are looked at.
const MOST_VIEWS: usize = 32;

/// What to hold files against.
#[derive(Clone, Debug, Default)]
pub struct CheckSettings {
    /// Who is to read them; empty for all but viewers of packages.
    pub profile: Vec<Consumer>,
    /// Strands that every file should have, if that is known.
    pub strands: Option<u64>,
}

/// A file that cannot be checked.
#[derive(Debug, thiserror::Error)]
pub enum CheckError {
    /// A name that says nothing of what is in the file.
    #[error("{file}: it cannot be checked, the name must end in .usda, .usdc, .usd, .usdz or .vdb")]
    Suffix {
        /// The file.
        file: String,
    },
    /// The file could not be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A broken layer.
    #[error("{file}: {error}")]
    Usd {
        /// The file.
        file: String,
        /// What is wrong.
        error: UsdFileError,
    },
    /// A broken file of grids.
    #[error("{file}: {error}")]
    Vdb {
        /// The file.
        file: String,
        /// What is wrong.
        error: VdbFileError,
    },
}

impl CheckError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::File(error) => error.blame(),
            _ => Blame::Input,
        }
    }
}

/// Checks files, each by itself and strands against grids where there are both. Findings come file by file,
/// those of each in the order of the rules.
///
/// # Errors
/// [`CheckError`]: a file that cannot be read.
pub fn check<P: AsRef<Path>>(
    files: &[P],
    settings: &CheckSettings,
) -> Result<Vec<Finding>, CheckError> {
    let (mut all, mut regions) = (Vec::new(), Vec::new());
    for path in files {
        let path = path.as_ref();
        let file = path.to_string_lossy();
        let mut findings = Findings::new(&file, &settings.profile);
        let lie = check_file(path, settings, &mut findings)?;
        // Against those of the files before.
        regions.extend(lie);
        frames::check_frames(&regions, &mut findings);
        let known = |f: &Finding| {
            all.iter().any(|other: &Finding| {
                f.rule == Rule::C20
                    && (&f.prim, &f.attribute, &f.message)
                        == (&other.prim, &other.attribute, &other.message)
            })
        };
        findings.all.retain(|f| !known(f));
        findings.all.sort_by_key(|f| f.rule);
        all.append(&mut findings.all);
    }
    Ok(all)
}

fn check_file(
    path: &Path,
    settings: &CheckSettings,
    findings: &mut Findings<'_>,
) -> Result<Vec<Region>, CheckError> {
    let file = path.to_string_lossy().into_owned();
    match suffix(path).as_str() {
        "vdb" => {
            let facts = vdb_file::read(&read_bounded(path, LONGEST)?);
            let facts = facts.map_err(|error| CheckError::Vdb {
                file: file.clone(),
                error,
            })?;
            volume::check_file(&facts, findings);
            Ok(frames::regions_of_file(&file, &facts))
        }
        "usd" | "usda" | "usdc" | "usdz" => {
            let bytes = read_bounded(path, LONGEST)?;
            let broken = |error| CheckError::Usd {
                file: file.clone(),
                error,
            };
            let layer = usd_file::parse(&bytes).map_err(broken)?;
            if suffix(path) == "usdz" {
                package::check(&usd_file::members(&bytes).map_err(broken)?, findings);
            }
            drop(bytes);
            Ok(check_stage(&layer, path, settings, findings))
        }
        _ => Err(CheckError::Suffix { file }),
    }
}

fn check_stage(
    layer: &Layer,
    path: &Path,
    settings: &CheckSettings,
    findings: &mut Findings<'_>,
) -> Vec<Region> {
    // What a package holds cannot be looked for beside it.
    let is_package = suffix(path) == "usdz";
    let open = |path: &Path| match is_package {
        true => None,
        false => usd_file::parse(&bytes_of(path, &["usd", "usda", "usdc"])?).ok(),
    };
    let mut files = Files::new(&open);
    let roots = compose(layer, path, &mut files, &[]);
    let all = items(&roots);
    layer::check(layer, &all, findings);
    for missing in &files.missing {
        let message = format!("{missing} could not be read: what it holds is not checked");
        let remedy = "put the file where the layer says, or check it by itself";
        let place = Place::default();
        let severity = if is_package {
            Severity::Note
        } else {
            Severity::Error
        };
        findings.add(
            (Rule::C16, severity),
            &Consumer::ALL,
            place,
            message,
            remedy,
        );
    }
    let meters = layer.field("metersPerUnit").and_then(Value::number);
    let meters = meters.filter(|m| *m > 0.0);
    let mut strands = check_view(&all, meters, findings).1;
    for (set, variants) in variants(&roots) {
        let mut levels = Vec::new();
        for variant in variants {
            let chosen = [(set.clone(), variant.clone())];
            let roots = compose(layer, path, &mut files, &chosen);
            findings.view = format!("{{{set}={variant}}}");
            let (ids, count) = check_view(&items(&roots), meters, findings);
            strands = strands.max(count);
            levels.push((variant, ids));
        }
        findings.view.clear();
        groom::check_nesting(&set, &levels, findings);
    }
    groom::check_number(&roots, strands, settings.strands, findings);
    let folder = path.parent().unwrap_or(Path::new(""));
    let open = |file: &str| vdb(&folder.join(file));
    volume::check_fields(&all, &open, findings);
    let is_z_up = layer.field("upAxis").and_then(Value::text) == Some("Z");
    let regions = frames::regions(
        &path.to_string_lossy(),
        &all,
        (meters.unwrap_or(0.01), is_z_up),
        &open,
    );
    frames::check_extents(&all, &regions, findings);
    regions
}

fn vdb(path: &Path) -> Option<VdbFacts> {
    vdb_file::read(&bytes_of(path, &["vdb"])?).ok()
}

/// Suffix of a file's name, in lower case.
fn suffix(path: &Path) -> String {
    let suffix = path.extension().and_then(|e| e.to_str());
    suffix.unwrap_or_default().to_ascii_lowercase()
}

/// A file that another one names: only a plain one, of a kind that was meant.
fn bytes_of(path: &Path, suffixes: &[&str]) -> Option<Vec<u8>> {
    let is_plain = std::fs::metadata(path).is_ok_and(|m| m.is_file());
    let is_meant = suffixes.contains(&suffix(path).as_str());
    (is_plain && is_meant).then(|| read_bounded(path, LONGEST).ok())?
}

/// Sets of variants of the root prims, with the names of all; so many in all.
fn variants(roots: &[Prim]) -> Vec<(String, Vec<String>)> {
    let mut left = MOST_VIEWS;
    let sets = roots.iter().flat_map(|root| &root.variant_sets);
    sets.map(|set| {
        let names = set.variants.iter().take(left).map(|v| v.name.clone());
        let names: Vec<String> = names.collect();
        left -= names.len();
        (set.name.clone(), names)
    })
    .collect()
}

/// The rules on what a stage shows; returns ids and number of the strands for pictures.
fn check_view(
    items: &[Item<'_>],
    meters: Option<f64>,
    findings: &mut Findings<'_>,
) -> (Ids, Option<usize>) {
    let all: Vec<Curves<'_>> = items.iter().filter_map(Curves::of).collect();
    for curves in &all {
        curves.check(meters, findings);
        attributes::check(curves, findings);
    }
    curves::check_limits(&all, findings);
    for item in items {
        attributes::check_numbers(item, findings);
        if item.prim.type_name == "Mesh" {
            extent::check_extent(item, Some(0.0), findings);
        }
    }
    material::check(items, findings);
    package::check_shown(items, findings);
    groom::check_roots(items, &all, findings);
    (groom::check_ids(&all, findings), groom::strands(&all))
}
