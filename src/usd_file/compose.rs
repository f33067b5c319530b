//! The prims that a reader sees: sublayers, variants, references and payloads put together.
//!
//! Opinions are ordered as in Pixar's library (local, variants, references, payloads). Inherits,
//! specializes, relocations and list edits that remove something are not followed; files of fur have none.

use super::DEEPEST;
use super::files::{Files, Unfollowed};
use super::layer::{Fields, Layer, Prim, Property, Specifier, VariantSet};
use super::value::{Reference, Value};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Memory that the prims of a stage may take, without the arrays that they share with their layers, bytes.
const MOST_MEMORY: usize = 512 << 20;

/// What a prim counts as at least, so that there are about a million at most.
const LEAST_OF_PRIM: usize = 512;

/// Metadata by which a prim takes something from another.
const ARCS: [&str; 5] = [
    "references",
    "payload",
    "inherits",
    "inheritPaths",
    "specializes",
];

/// Most files that refer to one another in a row.
const LONGEST_CHAIN: usize = 16;

/// The root prims of a stage.
///
/// * `path`: of the file that `root` was read from; others are found beside it.
/// * `chosen`: variants to show whatever the file says: set and name.
pub fn compose(
    root: &Layer,
    path: &Path,
    files: &mut Files<'_>,
    chosen: &[(String, String)],
) -> Vec<Prim> {
    let root = files.root(root, path);
    let mut composer = Composer {
        files,
        chosen,
        room: MOST_MEMORY,
    };
    composer.layer(&root, 0)
}

struct Composer<'c, 'f> {
    files: &'c mut Files<'f>,
    chosen: &'c [(String, String)],
    /// Memory that prims may still take, bytes.
    room: usize,
}

impl Composer<'_, '_> {
    /// The root prims of a layer and of those below it.
    fn layer(&mut self, layer: &Layer, chain: usize) -> Vec<Prim> {
        let mut all = Prim::default();
        for prim in &layer.prims {
            let path = format!("/{}", prim.name);
            if let Some(prim) = self.prim(prim, &path, &[], 0, chain) {
                all.children.push(prim);
            }
        }
        if let Some(Value::References(sublayers)) = layer.field("subLayers") {
            for sublayer in sublayers {
                if self.take(0, 0, chain + 1).is_none() {
                    break;
                }
                if let Some(layer) = self.files.layer(&sublayer.asset) {
                    let below = Prim {
                        children: self.layer(&layer, chain + 1),
                        ..Prim::default()
                    };
                    merge(&mut all, below);
                }
            }
        }
        all.children
    }

    /// Takes room for a prim of so many bytes; `None` beyond the limits.
    fn take(&mut self, bytes: usize, depth: usize, chain: usize) -> Option<()> {
        let left = self.room.checked_sub(bytes.max(LEAST_OF_PRIM));
        let left = left.filter(|_| depth <= DEEPEST && chain <= LONGEST_CHAIN);
        self.files.is_cut |= left.is_none();
        self.room = left?;
        Some(())
    }

    /// A prim with all that is added to it; `None` beyond the limits.
    ///
    /// * `path`: of the prim in the file that has it. * `selections`: variants that stronger opinions choose.
    fn prim(
        &mut self,
        spec: &Prim,
        path: &str,
        selections: &[(String, String)],
        depth: usize,
        chain: usize,
    ) -> Option<Prim> {
        self.take(spec.memory(), depth, chain)?;
        let mut prim = Prim {
            name: spec.name.clone(),
            specifier: spec.specifier,
            type_name: spec.type_name.clone(),
            metadata: spec.metadata.clone(),
            properties: spec.properties.clone(),
            ..Prim::default()
        };
        for child in &spec.children {
            let below = format!("{path}/{}", child.name);
            prim.children
                .extend(self.prim(child, &below, &[], depth + 1, chain));
        }
        let mut selections = selections.to_vec();
        for field in ["variants", "variantSelection"] {
            if let Some(Value::Dictionary(entries)) = spec.field(field) {
                for (set, variant) in entries {
                    let known = selections.iter().any(|(s, _)| s == set);
                    if let Some(variant) = variant.text().filter(|_| !known) {
                        selections.push((set.clone(), variant.to_owned()));
                    }
                }
            }
        }
        for set in &spec.variant_sets {
            let all = self.chosen.iter().chain(&selections);
            let choice = all.clone().find(|(name, _)| *name == set.name);
            let variant =
                choice.and_then(|(_, name)| set.variants.iter().find(|v| v.name == *name));
            if let Some(variant) = variant
                && let Some(below) = self.prim(variant, path, &selections, depth + 1, chain)
            {
                merge(&mut prim, below);
            }
            // What there is to choose from.
            prim.variant_sets.push(VariantSet {
                name: set.name.clone(),
                variants: set.variants.iter().map(name_only).collect(),
            });
        }
        for field in ["references", "payload"] {
            if let Some(Value::References(references)) = spec.field(field) {
                for reference in references {
                    if let Some(below) = self.referred(reference, path, &selections, depth, chain) {
                        merge(&mut prim, below);
                    }
                }
            }
        }
        Some(prim)
    }

    fn referred(
        &mut self,
        reference: &Reference,
        path: &str,
        selections: &[(String, String)],
        depth: usize,
        chain: usize,
    ) -> Option<Prim> {
        let mut layers = Vec::new();
        self.stack(&reference.asset, chain + 1, &mut layers);
        let from = match reference.prim.as_str() {
            "" => match layers.first()?.field("defaultPrim").and_then(Value::text) {
                Some(name) => format!("/{}", name.trim_start_matches('/')),
                None => {
                    (self.files).miss(reference.asset.clone(), Unfollowed::NoDefault);
                    return None;
                }
            },
            prim => prim.to_owned(),
        };
        let mut whole: Option<Prim> = None;
        for layer in &layers {
            let Some(spec) = spec_of(layer, &from) else {
                continue;
            };
            let prim = self.prim(spec, &from, selections, depth + 1, chain + 1)?;
            match &mut whole {
                Some(strong) => merge(strong, prim),
                None => whole = Some(prim),
            }
        }
        let Some(mut prim) = whole else {
            if !layers.is_empty() {
                let elsewhere = layers.iter().any(|layer| is_elsewhere(layer, &from));
                let why = match elsewhere {
                    true => Unfollowed::Foreign,
                    false => Unfollowed::NoPrim,
                };
                (self.files).miss(format!("{}<{from}>", reference.asset), why);
            }
            return None;
        };
        // What it refers to itself moves to where it stands, and all of it from there.
        if from != path {
            moved(&mut prim, &from, path);
        }
        Some(prim)
    }

    /// A layer and those below it, each once.
    fn stack(&mut self, file: &str, chain: usize, layers: &mut Vec<Arc<Layer>>) {
        let Some(layer) = self.files.layer(file) else {
            return;
        };
        if layers.iter().any(|known| Arc::ptr_eq(known, &layer)) {
            return;
        }
        layers.push(layer.clone());
        if let Some(Value::References(sublayers)) = layer.field("subLayers") {
            for sublayer in sublayers {
                if self.take(0, 0, chain + 1).is_none() {
                    return;
                }
                self.stack(&sublayer.asset, chain + 1, layers);
            }
        }
    }
}

fn names_of(path: &str) -> impl Iterator<Item = &str> {
    path.split('/').filter(|name| !name.is_empty())
}

/// What a layer itself says of a prim.
fn spec_of<'l>(layer: &'l Layer, path: &str) -> Option<&'l Prim> {
    let mut names = names_of(path);
    let first = names.next()?;
    let root = layer.prims.iter().find(|prim| prim.name == first)?;
    names.try_fold(root, |prim, name| prim.child(name))
}

/// Whether a prim that a layer says nothing of may come from what one above it refers to.
fn is_elsewhere(layer: &Layer, path: &str) -> bool {
    let mut level = &layer.prims;
    for name in names_of(path) {
        let Some(prim) = level.iter().find(|prim| prim.name == name) else {
            return false;
        };
        let refers = ARCS.iter().any(|arc| prim.field(arc).is_some());
        if refers || !prim.variant_sets.is_empty() {
            return true;
        }
        level = &prim.children;
    }
    false
}

fn name_only(variant: &Prim) -> Prim {
    Prim {
        name: variant.name.clone(),
        ..Prim::default()
    }
}

/// Has the targets of relationships follow a prim to another place.
fn moved(prim: &mut Prim, from: &str, to: &str) {
    for target in prim.properties.iter_mut().flat_map(|p| &mut p.targets) {
        if let Some(rest) = target.strip_prefix(from)
            && (rest.is_empty() || rest.starts_with(['/', '.']))
        {
            *target = format!("{to}{rest}");
        }
    }
    for child in &mut prim.children {
        moved(child, from, to);
    }
}

/// Adds what a weaker opinion says and the stronger one does not.
fn merge(strong: &mut Prim, weak: Prim) {
    if strong.specifier == Specifier::Over {
        strong.specifier = weak.specifier;
    }
    if strong.type_name.is_empty() {
        strong.type_name = weak.type_name;
    }
    merge_fields(&mut strong.metadata, weak.metadata);
    by_name(
        &mut strong.properties,
        weak.properties,
        |p| &p.name,
        merge_property,
    );
    by_name(&mut strong.children, weak.children, |p| &p.name, merge);
    by_name(
        &mut strong.variant_sets,
        weak.variant_sets,
        |s| &s.name,
        |_, _| {},
    );
}

fn by_name<T>(
    strong: &mut Vec<T>,
    weak: Vec<T>,
    name: impl Fn(&T) -> &String,
    merge: impl Fn(&mut T, T),
) {
    let places = strong.iter().enumerate().map(|(i, t)| (name(t).clone(), i));
    let places: HashMap<String, usize> = places.collect();
    for thing in weak {
        match places.get(name(&thing)) {
            Some(&place) => merge(&mut strong[place], thing),
            None => strong.push(thing),
        }
    }
}

fn merge_property(strong: &mut Property, weak: Property) {
    if strong.type_name.is_empty() {
        strong.type_name = weak.type_name;
    }
    if strong.value.is_none() && strong.samples.is_empty() {
        strong.value = weak.value;
        strong.samples = weak.samples;
    }
    if strong.targets.is_empty() {
        strong.targets = weak.targets;
    }
    merge_fields(&mut strong.metadata, weak.metadata);
}

fn merge_fields(strong: &mut Fields, weak: Fields) {
    for (name, value) in weak {
        match (strong.iter_mut().find(|(known, _)| *known == name), value) {
            (None, value) => strong.push((name, value)),
            (Some((_, Value::Texts(list))), Value::Texts(more)) => {
                let new: Vec<String> = more.into_iter().filter(|m| !list.contains(m)).collect();
                list.extend(new);
            }
            (Some((_, Value::Dictionary(entries))), Value::Dictionary(more)) => {
                merge_fields(entries, more);
            }
            _ => {}
        }
    }
}
