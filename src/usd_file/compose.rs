//! The prims that a reader sees: sublayers, variants, references and payloads put together.
//!
//! Opinions are ordered as in Pixar's library (local, variants, references, payloads). Inherits,
//! specializes, relocations and list edits that remove something are not followed; files of fur have none.

use super::DEEPEST;
use super::layer::{Fields, Layer, Prim, Property, Specifier, VariantSet};
use super::value::{Reference, Value};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Memory that the prims of a stage may take, without the arrays that they share with their layers, bytes.
const MOST_MEMORY: usize = 512 << 20;

/// What a prim counts as at least, so that there are about a million at most.
const LEAST_OF_PRIM: usize = 512;

/// Most files that refer to one another in a row.
const LONGEST_CHAIN: usize = 16;

/// Why a file that another one names is not followed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unfollowed {
    /// It is not there, or no plain file.
    Gone,
    /// It cannot be read, or is broken: what is wrong.
    Broken(String),
    /// It is of a kind that is not looked into.
    Foreign,
}

/// Reads a layer that another one names.
pub type Open<'f> = dyn Fn(&Path) -> Result<Layer, Unfollowed> + 'f;

/// The files of a stage: read once, kept for all its views.
pub struct Files<'f> {
    open: &'f Open<'f>,
    layers: HashMap<PathBuf, Option<Arc<Layer>>>,
    /// Files that are named and not followed, from where the program runs.
    pub unfollowed: Vec<(String, Unfollowed)>,
    /// Whether there are more prims, or more files in a row, than are looked at.
    pub is_cut: bool,
}

impl<'f> Files<'f> {
    /// * `open`: reads a file, or says why not.
    pub fn new(open: &'f Open<'f>) -> Self {
        Self {
            open,
            layers: HashMap::new(),
            unfollowed: Vec::new(),
            is_cut: false,
        }
    }

    /// The layer that a stage begins with; prims of it may refer to others of it.
    fn root(&mut self, root: &Layer, path: &Path) -> Arc<Layer> {
        let anchored = || {
            let mut root = root.clone();
            anchor_layer(&mut root, path);
            Some(Arc::new(root))
        };
        let known = self.layers.entry(path.to_owned()).or_insert_with(anchored);
        known.clone().unwrap_or_default()
    }

    fn layer(&mut self, path: &str) -> Option<Arc<Layer>> {
        let key = PathBuf::from(path);
        if let Some(known) = self.layers.get(&key) {
            return known.clone();
        }
        let layer = match (self.open)(&key) {
            Ok(mut layer) => {
                anchor_layer(&mut layer, &key);
                Some(Arc::new(layer))
            }
            Err(why) => {
                self.unfollowed.push((path.to_owned(), why));
                None
            }
        };
        self.layers.insert(key, layer.clone());
        layer
    }
}

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

/// Makes the files that a layer names absolute, so that it does not matter who reads them.
fn anchor_layer(layer: &mut Layer, path: &Path) {
    anchor_fields(&mut layer.metadata, path);
    for prim in &mut layer.prims {
        anchor_prim(prim, path);
    }
}

fn anchor_prim(prim: &mut Prim, path: &Path) {
    anchor_fields(&mut prim.metadata, path);
    for property in &mut prim.properties {
        let samples = property.samples.iter_mut().map(|(_, value)| value);
        for value in property.value.iter_mut().chain(samples) {
            if let Value::Asset(asset) = value {
                *asset = anchored(asset, path);
            }
        }
    }
    for child in &mut prim.children {
        anchor_prim(child, path);
    }
    for variant in prim
        .variant_sets
        .iter_mut()
        .flat_map(|set| &mut set.variants)
    {
        anchor_prim(variant, path);
    }
}

/// Whether a name is no path, but a URI or an expression (between backticks) that other programs resolve.
pub fn is_resolved_elsewhere(asset: &str) -> bool {
    asset.contains("://") || asset.starts_with('`')
}

/// The file that a layer names; none for none, and what is no path as it is.
fn anchored(asset: &str, path: &Path) -> String {
    if asset.is_empty() || is_resolved_elsewhere(asset) {
        return asset.to_owned();
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let file = folder.join(asset.strip_prefix("./").unwrap_or(asset));
    file.to_string_lossy().into_owned()
}

fn anchor_fields(fields: &mut Fields, path: &Path) {
    for (name, value) in fields {
        let sublayers = name == "subLayers";
        match value {
            Value::References(references) => {
                for reference in references {
                    reference.asset = match reference.asset.as_str() {
                        "" => path.to_string_lossy().into_owned(),
                        asset => anchored(asset, path),
                    };
                }
            }
            // A crate file has the names of sublayers as plain strings.
            Value::Texts(names) if sublayers => {
                let reference = |name: &String| Reference {
                    asset: anchored(name, path),
                    prim: String::new(),
                };
                *value = Value::References(names.iter().map(reference).collect());
            }
            _ => {}
        }
    }
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
        let layer = self.files.layer(&reference.asset)?;
        let from = match reference.prim.as_str() {
            "" => format!(
                "/{}",
                layer.field("defaultPrim")?.text()?.trim_start_matches('/')
            ),
            prim => prim.to_owned(),
        };
        let mut names = from.split('/').filter(|name| !name.is_empty());
        let first = names.next()?;
        let root = layer.prims.iter().find(|prim| prim.name == first)?;
        let spec = names.try_fold(root, |prim, name| prim.child(name))?;
        // What it refers to itself moves to where it stands, and all of it from there.
        let mut prim = self.prim(spec, &from, selections, depth + 1, chain + 1)?;
        if from != path {
            moved(&mut prim, &from, path);
        }
        Some(prim)
    }
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
