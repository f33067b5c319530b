//! What the fur grows on, for all commands that grow it.

use super::named;
use crate::skin::{self, Placing, Skin, SkinError, Up};

/// The skin and how its file is meant.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct SkinArgs {
    /// What the fur grows on: body, ball, swatch, tress, or an OBJ, PLY, glTF or USD mesh; body if
    /// not given.
    #[arg(long)]
    skin: Option<String>,
    /// What a unit of the skin's file is; m if not given. USD files say it themselves; this comes on top.
    #[arg(long, value_enum)]
    skin_units: Option<UnitArg>,
    /// Which axis of the skin's file points up; y if not given. What a USD file says counts.
    #[arg(long, value_enum)]
    skin_up: Option<UpArg>,
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
    /// Its name or path.
    pub(super) fn name(&self) -> &str {
        self.skin.as_deref().unwrap_or("body")
    }

    /// Fills what is not given with what a scene file says; the units of a file go with its name.
    pub(super) fn fill(&mut self, skin: Option<String>, units: Option<&str>, up: Option<&str>) {
        if self.skin.is_some() {
            return;
        }
        self.skin = skin;
        self.skin_units = self.skin_units.or(units.and_then(named));
        self.skin_up = self.skin_up.or(up.and_then(named));
    }

    /// Reads the skin.
    ///
    /// # Errors
    /// An unknown name, or a file that cannot be read or grown on.
    pub(super) fn load(&self) -> Result<Skin, SkinError> {
        let placing = Placing {
            unit_m: match self.skin_units.unwrap_or(UnitArg::M) {
                UnitArg::M => 1.0,
                UnitArg::Cm => 0.01,
                UnitArg::Mm => 0.001,
                UnitArg::In => 0.0254,
            },
            up: match self.skin_up.unwrap_or(UpArg::Y) {
                UpArg::Y => Up::Y,
                UpArg::Z => Up::Z,
            },
        };
        skin::load_placed(self.name(), placing)
    }
}
