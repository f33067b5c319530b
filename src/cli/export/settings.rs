//! What of an asset was asked for, in the words of the library.

use super::Args;
use crate::blame::Blame;
use crate::cli::Failure;
use crate::export::asset::{AssetSettings, Curves, Frame, Layout, Profile, READERS, Units, Up};

/// Levels of detail that have names.
const MOST_LEVELS: usize = 4;

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum CurvesArg {
    /// Catmull-Rom through all points, pinned at its ends.
    Pinned,
    /// Catmull-Rom with a point beyond each end, for RenderMan up to 25 and USD before 22.11.
    Phantom,
    /// Bezier, for readers that know no other cubic curve.
    Bezier,
    /// Straight pieces.
    Linear,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum LayoutArg {
    /// All in one file.
    Single,
    /// An interface and its payload.
    Payload,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum UnitsArg {
    /// Meters.
    M,
    /// Centimeters.
    Cm,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum UpArg {
    /// Y.
    Y,
    /// Z.
    Z,
}

/// The arguments as settings of an asset.
pub(super) fn settings(args: &Args) -> Result<AssetSettings, Failure> {
    if !(1..=MOST_LEVELS).contains(&args.levels) {
        let message = format!("--levels is {}, must be 1 to {MOST_LEVELS}", args.levels);
        return Err(Failure::new(Blame::Input, message));
    }
    let mut readers = Vec::new();
    for name in args.profile.iter().map(|name| name.trim()) {
        if name == "all" {
            readers.clear();
            break;
        }
        let Some((_, reader)) = READERS.iter().find(|(known, _)| *known == name) else {
            let known: Vec<&str> = READERS.iter().map(|(name, _)| *name).collect();
            return Err(Failure::with_help(
                Blame::Input,
                format!("`{name}` is no reader that --profile knows"),
                format!("there are all, {}", known.join(", ")),
            ));
        };
        readers.push(*reader);
    }
    Ok(AssetSettings {
        curves: match args.curves {
            CurvesArg::Pinned => Curves::Pinned,
            CurvesArg::Phantom => Curves::Phantom,
            CurvesArg::Bezier => Curves::Bezier,
            CurvesArg::Linear => Curves::Linear,
        },
        frame: Frame {
            units: match args.units {
                UnitsArg::M => Units::Meters,
                UnitsArg::Cm => Units::Centimeters,
            },
            up: match args.up {
                UpArg::Y => Up::Y,
                UpArg::Z => Up::Z,
            },
        },
        profile: Profile::of(&readers),
        layout: match args.layout {
            LayoutArg::Single => Layout::Single,
            LayoutArg::Payload => Layout::Payload,
        },
        no_proxy: args.no_proxy,
        no_guides: args.no_guides,
    })
}
