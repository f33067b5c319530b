//! Programs that read files of fur.

/// A program, or a group of them that behave alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Consumer {
    /// Blender's import.
    Blender,
    /// Cycles, by itself or through Hydra.
    Cycles,
    /// Unreal's import of USD.
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
    /// Pixar's and NVIDIA's validators.
    Validators,
    /// OpenVDB's own library.
    OpenVdb,
    /// LuxCore, of Cem Yuksel's hair files.
    LuxCore,
    /// `cyhair2pbrt`, which makes curves of pbrt of such files.
    Pbrt,
    /// Viewers of packages on telephones and headsets. Only where asked for: fur cannot be shown there.
    Ar,
}

use Consumer::{
    Ar, Arnold, Blender, Cycles, Houdini, LuxCore, Omniverse, OpenVdb, Pbrt, RenderMan, Storm,
    Unreal, Validators,
};

impl Consumer {
    /// All there are.
    pub const ALL: [Self; 13] = [
        Blender, Cycles, Unreal, Houdini, Arnold, RenderMan, Omniverse, Storm, Validators, OpenVdb,
        LuxCore, Pbrt, Ar,
    ];

    /// As on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Blender => "blender",
            Cycles => "cycles",
            Unreal => "unreal",
            Houdini => "houdini",
            Arnold => "arnold",
            RenderMan => "renderman",
            Omniverse => "omniverse",
            Storm => "storm",
            Validators => "validators",
            OpenVdb => "openvdb",
            LuxCore => "luxcore",
            Pbrt => "pbrt",
            Ar => "ar",
        }
    }

    /// The consumer of a name.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|c| c.name() == name)
    }
}

/// All that read layers.
pub(super) const OF_LAYERS: &[Consumer] = &[
    Blender, Cycles, Unreal, Houdini, Arnold, RenderMan, Omniverse, Storm, Validators, Ar,
];

/// All that draw curves.
pub(super) const DRAWING: &[Consumer] = &[
    Blender, Cycles, Unreal, Houdini, Arnold, RenderMan, Omniverse, Storm,
];
