//! Files that a stage names: layers and grids beside it.

use super::finding::Severity;
use super::{LONGEST, suffix};
use crate::io::read_bounded;
use crate::usd_file::{self, Layer, Unfollowed, is_resolved_elsewhere};
use crate::vdb_file::{self, VdbFacts};
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

/// Stands between the path of a layer and arguments for its reader.
const ARGUMENTS: &str = ":SDF_FORMAT_ARGS:";

/// A layer that another one names.
///
/// * `is_package`: whether that is in a package, whose members are not looked for.
pub(super) fn layer(path: &Path, is_package: bool) -> Result<Layer, Unfollowed> {
    let name = path.to_string_lossy();
    let file = name.split(ARGUMENTS).next().unwrap_or_default();
    let bytes = bytes_of(file, &["usd", "usda", "usdc"], is_package)?;
    usd_file::parse(&bytes).map_err(|error| Unfollowed::Broken(error.to_string()))
}

/// A file that another one names: only a plain one, of a kind that was meant.
fn bytes_of(file: &str, suffixes: &[&str], is_package: bool) -> Result<Vec<u8>, Unfollowed> {
    if is_package || is_resolved_elsewhere(file) {
        return Err(Unfollowed::Foreign);
    }
    let path = Path::new(file);
    if !std::fs::metadata(path).is_ok_and(|m| m.is_file()) {
        return Err(Unfollowed::Gone);
    }
    if !suffixes.contains(&suffix(path).as_str()) {
        return Err(Unfollowed::Foreign);
    }
    read_bounded(path, LONGEST).map_err(|error| Unfollowed::Broken(error.to_string()))
}

/// OpenVDB files that fields name, each read once.
pub(super) struct Grids {
    is_package: bool,
    known: RefCell<HashMap<String, Facts>>,
}

type Facts = Result<Rc<VdbFacts>, Unfollowed>;

impl Grids {
    /// * `is_package`: whether fields are in a package, whose members are not looked for.
    pub(super) fn new(is_package: bool) -> Self {
        Self {
            is_package,
            known: RefCell::default(),
        }
    }

    /// What is in a file.
    pub(super) fn open(&self, file: &str) -> Facts {
        if let Some(known) = self.known.borrow().get(file) {
            return known.clone();
        }
        let read = || {
            let facts = vdb_file::read(&bytes_of(file, &["vdb"], self.is_package)?);
            let facts = facts.map_err(|error| Unfollowed::Broken(error.to_string()))?;
            Ok(Rc::new(facts))
        };
        let facts = read();
        let mut known = self.known.borrow_mut();
        known.insert(file.to_owned(), facts.clone());
        facts
    }
}

/// How bad it is that a file is not followed, why that is, and what to do.
pub(super) fn unfollowed(file: &str, why: &Unfollowed) -> (Severity, String, &'static str) {
    match why {
        Unfollowed::Gone => (
            Severity::Error,
            format!("{file} is not there: what it holds is not checked"),
            "put the file where the layer says, or mend the path",
        ),
        Unfollowed::Broken(what) => (
            Severity::Error,
            format!("{file} cannot be read: {what}"),
            "write the file again",
        ),
        Unfollowed::Foreign => (
            Severity::Note,
            format!("{file} is not looked into"),
            "nothing, if readers know it",
        ),
        Unfollowed::NoPrim => (
            Severity::Error,
            format!("{file} is not there: the file has no such prim"),
            "mend the path of the prim, or put the prim into the file",
        ),
        Unfollowed::NoDefault => (
            Severity::Error,
            format!("{file} is referred to by its default prim, but names none"),
            "set defaultPrim in that file, or name the prim that is meant",
        ),
    }
}
