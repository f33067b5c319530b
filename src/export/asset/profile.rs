//! Who reads which attribute.

/// A program that reads grooms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reader {
    /// Blender's import.
    Blender,
    /// Unreal's USD import.
    Unreal,
    /// Houdini's Solaris and Karma.
    Houdini,
    /// Arnold.
    Arnold,
    /// RenderMan.
    RenderMan,
    /// Omniverse.
    Omniverse,
    /// usdview and other viewports of Hydra.
    Storm,
}

/// Names of the readers, as on the command line.
pub const READERS: [(&str, Reader); 7] = [
    ("blender", Reader::Blender),
    ("unreal", Reader::Unreal),
    ("houdini", Reader::Houdini),
    ("arnold", Reader::Arnold),
    ("renderman", Reader::RenderMan),
    ("omniverse", Reader::Omniverse),
    ("storm", Reader::Storm),
];

/// The readers that a file is for: all, or a few so that it is smaller.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Profile(Vec<Reader>);

/// What strands can be given besides points and widths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// `st`: texture coordinates of the root.
    RootUv,
    /// The same as `groom_root_uv`.
    GroomRootUv,
    /// The same as `surface_uv_coordinate`.
    SurfaceUv,
    /// `skinprim` and `skinprimuv`: triangle of the skin and place on it.
    SkinPrim,
    /// `curve_id`.
    CurveId,
    /// The same as `groom_id`.
    GroomId,
    /// `groom_group_id`, `groom_group_name`.
    GroomGroup,
    /// `groom_guide`.
    GroomGuide,
    /// `displayColor`.
    DisplayColor,
    /// The same as `groom_color`.
    GroomColor,
    /// `eumelanin`, `pheomelanin`.
    Melanin,
    /// `absorption`: the coefficient of the material, where it changes along the hair.
    Absorption,
}

impl Column {
    /// All there are.
    pub const ALL: [Self; 12] = [
        Self::RootUv,
        Self::GroomRootUv,
        Self::SurfaceUv,
        Self::SkinPrim,
        Self::CurveId,
        Self::GroomId,
        Self::GroomGroup,
        Self::GroomGuide,
        Self::DisplayColor,
        Self::GroomColor,
        Self::Melanin,
        Self::Absorption,
    ];

    /// The column that has the same numbers and is stored once for all of them; mostly the column itself.
    pub fn original(self) -> Self {
        match self {
            Self::GroomRootUv | Self::SurfaceUv => Self::RootUv,
            Self::GroomId => Self::CurveId,
            Self::GroomColor => Self::DisplayColor,
            itself => itself,
        }
    }

    /// Bytes a strand and a control point.
    pub fn bytes(self) -> (usize, usize) {
        match self.original() {
            Self::RootUv => (8, 0),
            Self::SkinPrim => (16, 0),
            Self::CurveId => (2, 0),
            Self::DisplayColor | Self::Absorption => (0, 12),
            Self::Melanin => (0, 8),
            _ => (0, 0),
        }
    }

    fn readers(self) -> &'static [Reader] {
        use Reader::{Arnold, Blender, Houdini, Omniverse, RenderMan, Storm, Unreal};
        match self {
            Self::RootUv => &[Houdini, Omniverse, RenderMan, Arnold, Storm, Blender],
            Self::GroomRootUv | Self::GroomId | Self::GroomGroup => &[Unreal],
            Self::GroomGuide | Self::GroomColor => &[Unreal],
            Self::SurfaceUv => &[Blender],
            Self::SkinPrim => &[Houdini],
            Self::CurveId => &[Blender, Houdini, Arnold, RenderMan, Omniverse],
            Self::DisplayColor => &[Storm, Omniverse, Houdini, Blender],
            Self::Melanin => &[Blender],
            Self::Absorption => &[Houdini, Arnold, RenderMan, Omniverse, Storm, Blender],
        }
    }
}

impl Profile {
    /// A file for a few readers; for all if there are none.
    pub fn of(readers: &[Reader]) -> Self {
        Self(readers.to_vec())
    }

    /// Whether one of the readers is to read the file.
    pub fn has(&self, reader: Reader) -> bool {
        self.0.is_empty() || self.0.contains(&reader)
    }

    /// Whether one of the readers reads a column.
    pub fn wants(&self, column: Column) -> bool {
        column.readers().iter().any(|&reader| self.has(reader))
    }
}
