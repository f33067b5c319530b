//! The files of a stage, and where they lie.

use super::layer::{Fields, Layer, Prim};
use super::value::{Reference, Value};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Why a file that another one names is not followed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unfollowed {
    /// It is not there, or no plain file.
    Gone,
    /// It cannot be read, or is broken: what is wrong.
    Broken(String),
    /// It is of a kind that is not looked into.
    Foreign,
    /// It is there, but has no such prim.
    NoPrim,
    /// It is there, but does not say which prim is meant if none is named.
    NoDefault,
}

/// Reads a layer that another one names.
pub type Open<'f> = dyn Fn(&Path) -> Result<Layer, Unfollowed> + 'f;

/// The files of a stage: read once, kept for all its views.
pub struct Files<'f> {
    open: &'f Open<'f>,
    layers: HashMap<PathBuf, Option<Arc<Layer>>>,
    /// Files that are named and not followed, from where the program runs, and prims of files, `file</prim>`.
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
    pub(super) fn root(&mut self, root: &Layer, path: &Path) -> Arc<Layer> {
        let anchored = || {
            let mut root = root.clone();
            anchor_layer(&mut root, path);
            Some(Arc::new(root))
        };
        let known = self.layers.entry(path.to_owned()).or_insert_with(anchored);
        known.clone().unwrap_or_default()
    }

    pub(super) fn layer(&mut self, path: &str) -> Option<Arc<Layer>> {
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

    /// Notes that something is not followed.
    pub(super) fn miss(&mut self, what: String, why: Unfollowed) {
        if !self.unfollowed.iter().any(|(known, _)| *known == what) {
            self.unfollowed.push((what, why));
        }
    }
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
