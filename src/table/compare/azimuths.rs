//! Tables azimuth by azimuth.

use super::TableRef;
use crate::table::{Azimuths, ScatterMaps, StructureTable, TableError};

/// A table at one azimuth.
pub(super) enum Slice<'a> {
    /// It is the same at all.
    Whole(TableRef<'a>),
    Structure(Box<StructureTable>),
    Scatter(Box<ScatterMaps>),
}

impl<'a> Slice<'a> {
    pub(super) fn of(table: TableRef<'a>, bin: usize) -> Self {
        match table {
            _ if table.nodes().azimuths.is_averaged() => Self::Whole(table),
            TableRef::Structure(table) => Self::Structure(Box::new(table.at_azimuth(bin))),
            TableRef::Scatter(maps) => Self::Scatter(Box::new(maps.at_azimuth(bin))),
        }
    }

    pub(super) fn table(&self) -> TableRef<'_> {
        match self {
            Self::Whole(table) => *table,
            Self::Structure(table) => TableRef::Structure(table),
            Self::Scatter(maps) => TableRef::Scatter(maps),
        }
    }
}

/// The azimuths at which two tables are compared.
pub(super) fn shared(a: TableRef<'_>, b: TableRef<'_>) -> Result<Azimuths, TableError> {
    let (a, b) = (a.nodes().azimuths, b.nodes().azimuths);
    if a == b || b.is_averaged() {
        return Ok(a);
    }
    if a.is_averaged() {
        return Ok(b);
    }
    let words = |of: Azimuths| {
        let [from, to] = of.symmetry.range_turns().map(|turns| 360.0 * turns);
        format!("{} azimuths from {from} to {to} degrees", of.count)
    };
    Err(TableError::Request(format!(
        "one table has {}, the other {}; equal ones or an average can be compared",
        words(a),
        words(b)
    )))
}
