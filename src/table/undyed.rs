//! What a station's bake leaves to be dyed: one table, or one a color channel.

use super::{ScatterMaps, StructureTable, TableError};

/// The scattering of one fiber before pigment.
#[derive(Clone, Debug, PartialEq)]
pub enum Undyed {
    /// Materials are gray: one table serves all colors.
    Gray(Box<StructureTable>),
    /// Materials differ by color: a table each for R, G and B, alike but for what the materials do.
    Colored(Box<[StructureTable; 3]>),
}

impl Undyed {
    /// The tables: one, or three.
    pub fn tables(&self) -> &[StructureTable] {
        match self {
            Self::Gray(table) => std::slice::from_ref(table),
            Self::Colored(tables) => tables.as_slice(),
        }
    }

    /// The scattering with a pigment. See [`StructureTable::dye`].
    pub fn dye(&self, absorption_per_um: [f64; 3]) -> Result<ScatterMaps, TableError> {
        match self {
            Self::Gray(table) => table.dye(absorption_per_um),
            Self::Colored(tables) => ScatterMaps::of_channels(tables, absorption_per_um),
        }
    }
}
