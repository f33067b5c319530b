//! Tables as OpenEXR files. The format is described in `docs/table-format.md`.
//!
//! One part a bin, each a unicube with its faces stacked from top to bottom; one 32-bit float
//! channel an absorption level (`a00`, `a01`, ...) and `error`, or `R`, `G`, `B` and an error each. Everything else
//! is in attributes named `vair:...`.

mod attributes;
mod azimuths;
mod decode;
mod encode;
mod headed;
mod packed;
mod parts;
mod raw;

pub(super) use packed::encode_packed;

use super::{Nodes, PackedTable, Provenance, ScatterMaps, StructureTable, TableError};
use crate::io::{AtomicFile, read_bounded};
use std::path::Path;

/// Version of the file format; files of other versions are refused.
const FORMAT: i32 = 1;
/// Version of the files of tables with several azimuths.
const FORMAT_AZIMUTHS: i32 = 3;

/// Channels of a dyed table.
const COLORS: [&str; 3] = ["R", "G", "B"];

/// Version of the file that a table of these nodes makes, unpacked.
pub fn format_of(nodes: &Nodes) -> i32 {
    match nodes.azimuths.is_averaged() {
        true => FORMAT,
        false => FORMAT_AZIMUTHS,
    }
}

/// Name of a part of that file.
///
/// * `part`: counted from 0 in the order of the file.
pub fn part_name(nodes: &Nodes, part: usize) -> String {
    azimuths::part_name(&nodes.azimuths, part, nodes.inclinations())
}

/// Longest file that is read, bytes. Tables may hold `check::MAX_SAMPLES` floats at most.
const MAX_FILE: u64 = 1 << 31;

/// A table as a file holds it.
#[derive(Clone, Debug, PartialEq)]
pub enum TableFile {
    /// A map per absorption level: what a bake writes.
    Structure(StructureTable),
    /// A map per color channel: what dyeing writes.
    Scatter(ScatterMaps),
}

impl TableFile {
    /// Reads a table of either kind, packed or not. Refuses files that are not tables, of another format version,
    /// larger than the limits, or inconsistent.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let bytes = read_bounded(path, MAX_FILE)?;
        let raw = parts::decode_raw(&bytes, path)?;
        let format = raw.first().map(|p| p.attributes.get_int::<i32>("format"));
        let table = if matches!(format, Some(Ok(packed::FORMAT))) {
            packed::decode_packed(raw).and_then(|packed| packed.unpack())
        } else {
            parts::from_raw(raw).and_then(decode::table)
        };
        table.map_err(|e| e.of_file(path))
    }

    /// Where the table comes from.
    pub fn provenance(&self) -> &Provenance {
        match self {
            Self::Structure(table) => &table.provenance,
            Self::Scatter(maps) => &maps.provenance,
        }
    }

    /// Writes the table: the file appears complete or not at all, and the same table gives the
    /// same bytes.
    pub fn write(&self, path: &Path) -> Result<(), TableError> {
        match self {
            Self::Structure(table) => table.write(path),
            Self::Scatter(maps) => maps.write(path),
        }
    }
}

impl StructureTable {
    /// Reads a structure table. See [`TableFile::read`].
    pub fn read(path: &Path) -> Result<Self, TableError> {
        match TableFile::read(path)? {
            TableFile::Structure(table) => Ok(table),
            TableFile::Scatter(_) => Err(TableError::NotTable {
                path: path.to_owned(),
                what: "it is dyed already (kind scatter); a structure table is needed".to_owned(),
            }),
        }
    }

    /// Writes the table. See [`TableFile::write`].
    pub fn write(&self, path: &Path) -> Result<(), TableError> {
        self.check()?;
        parts::write(encode::structure(self), path)
    }
}

impl PackedTable {
    /// Reads a packed table as it is; [`TableFile::read`] unpacks as well. Refuses what that refuses, and
    /// tables that are not packed.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let bytes = read_bounded(path, MAX_FILE)?;
        let raw = parts::decode_raw(&bytes, path)?;
        let format = raw.first().map(|p| p.attributes.get_int::<i32>("format"));
        if !matches!(format, Some(Ok(packed::FORMAT))) {
            return Err(TableError::NotTable {
                path: path.to_owned(),
                what: "it is not packed".to_owned(),
            });
        }
        packed::decode_packed(raw).map_err(|e| e.of_file(path))
    }

    /// Writes the table. See [`TableFile::write`].
    pub fn write(&self, path: &Path) -> Result<(), TableError> {
        let bytes = encode_packed(self, path)?;
        Ok(AtomicFile::write_all_to(path, &bytes)?)
    }
}

impl ScatterMaps {
    /// Reads a dyed table. See [`TableFile::read`].
    pub fn read(path: &Path) -> Result<Self, TableError> {
        match TableFile::read(path)? {
            TableFile::Scatter(maps) => Ok(maps),
            TableFile::Structure(_) => Err(TableError::NotTable {
                path: path.to_owned(),
                what: "it is not dyed yet (kind structure); dye it first".to_owned(),
            }),
        }
    }

    /// Writes the table. See [`TableFile::write`].
    pub fn write(&self, path: &Path) -> Result<(), TableError> {
        self.check()?;
        parts::write(encode::scatter(self), path)
    }
}

/// Channel name of an absorption level.
fn level_channel(level: usize) -> String {
    format!("a{level:02}")
}

/// The channel of a color's error.
fn error_channel(color: &str) -> String {
    format!("error.{color}")
}

#[cfg(test)]
mod tests;
