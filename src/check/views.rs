//! A stage, as the file shows it and with each of its variants.

use super::beside::{self, Grids, unfollowed};
use super::consumer::OF_LAYERS;
use super::curves::{self, Curves};
use super::finding::{Findings, Place, Severity};
use super::frames::{self, Region};
use super::groom::{self, Ids};
use super::rule::Rule;
use super::stage::{Item, items};
use super::{CheckSettings, attributes, extent, layer, material, package, suffix, volume};
use crate::usd_file::{Files, Layer, Prim, Value, compose, is_z_up};
use std::collections::VecDeque;
use std::path::Path;

/// Most variants of a stage that are looked at.
const MOST_VIEWS: usize = 32;

/// Length of a unit where a layer does not say, meters.
const UNIT: f64 = 0.01;

/// What all views of a stage have in common.
struct Stage<'s> {
    file: &'s str,
    /// A unit, if the layer says.
    meters: Option<f64>,
    is_z_up: bool,
    grids: Grids,
}

/// All rules on a stage; returns where its strands and grids lie.
pub(super) fn check(
    layer: &Layer,
    path: &Path,
    settings: &CheckSettings,
    findings: &mut Findings<'_>,
) -> Vec<Region> {
    let is_package = suffix(path) == "usdz";
    let meters = layer.field("metersPerUnit").and_then(Value::number);
    let stage = Stage {
        file: &path.to_string_lossy(),
        meters: meters.filter(|m| *m > 0.0),
        is_z_up: is_z_up(layer) == Some(true),
        grids: Grids::new(is_package),
    };
    let open = |path: &Path| beside::layer(path, is_package);
    let mut files = Files::new(&open);
    let roots = compose(layer, path, &mut files, &[]);
    let all = items(&roots);
    layer::check(layer, &all, findings);
    let mut seen = stage.check(&all, findings);
    // Sets of variants that are to be looked at, and the choices that lead to them.
    let mut known = Vec::new();
    let mut waiting = VecDeque::new();
    add_sets(&roots, &[], &mut known, &mut waiting);
    let (mut left, mut variants) = (MOST_VIEWS, 0);
    while let Some((before, set, names)) = waiting.pop_front() {
        let mut levels = Vec::new();
        for name in names.iter().take(left) {
            let mut chosen = before.clone();
            chosen.push((set.clone(), name.clone()));
            let roots = compose(layer, path, &mut files, &chosen);
            let choices: Vec<String> = chosen.iter().map(|(s, v)| format!("{s}={v}")).collect();
            findings.view = format!("{{{}}}", choices.join(","));
            let view = stage.check(&items(&roots), findings);
            seen.strands = seen.strands.max(view.strands);
            frames::add_unseen(&mut seen.regions, view.regions);
            levels.push((name.clone(), view.ids));
            add_sets(&roots, &chosen, &mut known, &mut waiting);
        }
        left -= levels.len();
        variants += names.len();
        findings.view.clear();
        groom::check_nesting(&set, &levels, findings);
    }
    groom::check_number(&roots, seen.strands, settings.strands, findings);
    check_whole(variants, &files, findings);
    seen.regions
}

/// What is known of a view after the rules.
struct View {
    ids: Ids,
    /// Number of strands for pictures, if there are any curves.
    strands: Option<usize>,
    regions: Vec<Region>,
}

impl Stage<'_> {
    /// The rules on what a view shows.
    fn check(&self, items: &[Item<'_>], findings: &mut Findings<'_>) -> View {
        let all: Vec<Curves<'_>> = items.iter().filter_map(Curves::of).collect();
        for curves in &all {
            curves.check(self.meters, findings);
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
        volume::check_fields(items, &self.grids, findings);
        let frame = (self.meters.unwrap_or(UNIT), self.is_z_up);
        let regions = frames::regions(self.file, items, frame, &self.grids);
        frames::check_extents(items, &regions, findings);
        frames::check_frames(&regions, &regions, findings);
        View {
            ids: groom::check_ids(&all, findings),
            strands: groom::strands(&all),
            regions,
        }
    }
}

/// A set of variants and their names, after the choices without which it is not there.
type Set = (Vec<(String, String)>, String, Vec<String>);

/// Adds the sets of all prims that are not known yet; one choice is made of all sets of a name.
fn add_sets(
    prims: &[Prim],
    chosen: &[(String, String)],
    known: &mut Vec<String>,
    waiting: &mut VecDeque<Set>,
) {
    let mut new = Vec::new();
    collect(prims, known, &mut new);
    known.extend(new.iter().map(|(name, _)| name.clone()));
    waiting.extend(
        new.into_iter()
            .map(|(name, names)| (chosen.to_vec(), name, names)),
    );
}

/// Names of variants by their set, of sets that are not known.
fn collect(prims: &[Prim], known: &[String], new: &mut Vec<(String, Vec<String>)>) {
    for set in prims.iter().flat_map(|prim| &prim.variant_sets) {
        if known.contains(&set.name) {
            continue;
        }
        let place = new.iter().position(|(name, _)| *name == set.name);
        let place = place.unwrap_or_else(|| {
            new.push((set.name.clone(), Vec::new()));
            new.len() - 1
        });
        for variant in &set.variants {
            if !new[place].1.contains(&variant.name) {
                new[place].1.push(variant.name.clone());
            }
        }
    }
    for prim in prims {
        collect(&prim.children, known, new);
    }
}

/// That all was looked at.
///
/// * `variants`: that there are.
fn check_whole(variants: usize, files: &Files<'_>, findings: &mut Findings<'_>) {
    let mut add = |severity, message: String, remedy: &str| {
        let (rule, place) = ((Rule::C16, severity), Place::default());
        findings.add(rule, OF_LAYERS, place, message, remedy);
    };
    for (file, why) in &files.unfollowed {
        let (severity, message, remedy) = unfollowed(file, why);
        add(severity, message, remedy);
    }
    if variants > MOST_VIEWS {
        let message = format!("of {variants} variants only the first {MOST_VIEWS} were looked at");
        add(Severity::Note, message, "check files of fewer variants");
    }
    if files.is_cut {
        let message = "there are more prims, or more files in a row, than are looked at: \
                       what lies beyond was not checked";
        let remedy = "check the layers that are put together here one by one";
        add(Severity::Note, message.to_owned(), remedy);
    }
}
