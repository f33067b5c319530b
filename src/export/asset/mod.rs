//! A groom as a component asset: skin, curves of every hair class, materials, levels of detail.
//!
//! ```text
//! /red_fox            Xform, kind component; for Unreal also GroomAPI; variant sets `lod`, `coat`
//!   /geo/skin         Mesh
//!   /geo/render/...   BasisCurves a hair class
//!   /geo/proxy/...    the same, few and wide, for viewports
//!   /geo/guide/...    some guard hairs at their places, with rest points
//!   /mtl/...          Material a hair class, and one of the skin
//! ```

mod color;
mod colors;
mod columns;
mod curves;
mod frame;
mod hair;
mod levels;
mod look;
mod material;
mod profile;
mod provenance;
mod skin;
mod strands;
mod tree;
mod wardrobe;
mod write;

pub use colors::colors;
pub use curves::Curves;
pub use frame::{Frame, Units, Up};
pub use levels::{Level, LevelClass, levels};
pub use look::{ClassLook, HairLook, LobeError};
pub use profile::{Column, Profile, READERS, Reader};
pub use provenance::identifier;
pub use tree::{interface, layer};
pub use wardrobe::Wear;
pub use write::{TEXT_FACTOR, estimate, payload_of, write};

use super::ExportError;
use crate::groom::Groom;
use crate::skin::Skin;
use crate::species::Species;
use rayon::prelude::*;

/// What a component asset is made of.
pub struct Parts<'a> {
    /// The fur.
    pub groom: &'a Groom,
    /// What it grew on.
    pub skin: &'a Skin,
    /// The animal.
    pub species: &'a Species,
    /// Levels of detail, the finest first; never empty.
    pub levels: &'a [Level],
    /// Materials of the hair classes, in their order; empty for none.
    pub looks: &'a [ClassLook],
    /// Coats to choose from as variants, first the one of all the above; empty if there is no choice.
    pub coats: &'a [Wear<'a>],
    /// Seed of the groom.
    pub seed: u64,
}

/// How an asset is divided into files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// Everything in one.
    #[default]
    Single,
    /// A small one that can be referred to without cost, and `NAME.payload.usdc` beside it with skin,
    /// strands and materials, which is loaded on demand.
    Payload,
}

/// How a component asset is written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AssetSettings {
    /// Kind of curves.
    pub curves: Curves,
    /// Units and axes.
    pub frame: Frame,
    /// Who is to read it.
    pub profile: Profile,
    /// In one file, or two.
    pub layout: Layout,
    /// Without few wide strands for viewports.
    pub no_proxy: bool,
    /// Without guides.
    pub no_guides: bool,
}

/// Refuses grooms that readers would drop.
///
/// # Errors
/// [`ExportError::Empty`] and [`ExportError::NotFinite`].
pub fn check(groom: &Groom) -> Result<(), ExportError> {
    if groom.strands() == 0 {
        return Err(ExportError::Empty);
    }
    let fault = |index: usize| -> Option<&'static str> {
        let range = groom.range(index);
        if !groom.points[range.clone()].iter().all(|p| p.is_finite()) {
            return Some("a point");
        }
        if !groom.widths[range].iter().all(|w| w.is_finite()) {
            return Some("a width");
        }
        (!groom.root_uv[index].is_finite()).then_some("a texture coordinate")
    };
    let first = (0..groom.strands())
        .into_par_iter()
        .with_min_len(4096)
        .find_first(|&index| fault(index).is_some());
    match first {
        None => Ok(()),
        Some(index) => Err(ExportError::NotFinite {
            id: groom.id[index],
            index,
            what: fault(index).unwrap_or_default(),
        }),
    }
}
