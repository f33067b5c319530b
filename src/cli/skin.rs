//! What the fur grows on, for all commands that grow it.

use crate::skin::{self, Placing, Skin, SkinError, Up};

/// The skin and how its file is meant.
#[derive(Debug, clap::Args)]
pub(super) struct SkinArgs {
    /// What the fur grows on: body, ball, swatch, tress, or an OBJ, PLY or glTF mesh.
    #[arg(long, default_value = "body")]
    pub(super) skin: String,
    /// What a unit of the skin's file is.
    #[arg(long, value_enum, default_value = "m")]
    skin_units: UnitArg,
    /// Which axis of the skin's file points up.
    #[arg(long, value_enum, default_value = "y")]
    skin_up: UpArg,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum UnitArg {
    /// Meters.
    M,
    /// Centimeters.
    Cm,
    /// Millimeters.
    Mm,
    /// Inches.
    In,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum UpArg {
    /// Y, as in glTF.
    Y,
    /// Z, as in Blender.
    Z,
}

impl SkinArgs {
    /// Reads the skin.
    ///
    /// # Errors
    /// An unknown name, or a file that cannot be read or grown on.
    pub(super) fn load(&self) -> Result<Skin, SkinError> {
        let placing = Placing {
            unit_m: match self.skin_units {
                UnitArg::M => 1.0,
                UnitArg::Cm => 0.01,
                UnitArg::Mm => 0.001,
                UnitArg::In => 0.0254,
            },
            up: match self.skin_up {
                UpArg::Y => Up::Y,
                UpArg::Z => Up::Z,
            },
        };
        skin::load_placed(&self.skin, placing)
    }
}
