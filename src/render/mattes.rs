//! What the samples of a pixel saw, counted by name: exact coverage for mattes.

use super::Crop;
use serde::{Deserialize, Serialize};

/// What a camera ray met first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Seen {
    /// A strand of a hair class and of a zone of the coat.
    Strand {
        class: u8,
        zone: u8,
    },
    Skin,
    Ground,
}

/// Names that the counts of a picture are kept by. Skin and ground are counted too.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MatteNames {
    /// Of the hair classes, by their index.
    pub classes: Vec<String>,
    /// Of the zones of the coat, by their index.
    pub zones: Vec<String>,
}

const SKIN: usize = 0;
const GROUND: usize = 1;
const CLASSES: usize = 2;

impl MatteNames {
    /// Counts of a pixel: skin, ground, hair classes, zones.
    pub(super) fn columns(&self) -> usize {
        CLASSES + self.classes.len() + self.zones.len()
    }

    /// Counts a sample in its pixel's counts.
    pub(super) fn count(&self, seen: Seen, counts: &mut [u32]) {
        match seen {
            Seen::Skin => counts[SKIN] += 1,
            Seen::Ground => counts[GROUND] += 1,
            Seen::Strand { class, zone } => {
                counts[CLASSES + usize::from(class)] += 1;
                counts[CLASSES + self.classes.len() + usize::from(zone)] += 1;
            }
        }
    }
}

/// How many samples of each pixel saw what.
#[derive(Clone, Debug, PartialEq)]
pub struct Mattes {
    pub(super) names: MatteNames,
    /// Pixel after pixel as in the film, [`MatteNames::columns`] each.
    pub(super) counts: Vec<u32>,
}

impl Mattes {
    /// The counts of a crop, from those of the tiles that cover it.
    pub(super) fn assemble<'a>(
        names: &MatteNames,
        tiles: impl Iterator<Item = (Crop, &'a [u32])>,
        crop: &Crop,
    ) -> Self {
        let columns = names.columns();
        let mut counts = vec![0; columns * crop.pixels()];
        for (extent, tile) in tiles {
            for (from, to) in extent.shared(crop) {
                counts[to * columns..(to + 1) * columns]
                    .copy_from_slice(&tile[from * columns..(from + 1) * columns]);
            }
        }
        Self {
            names: names.clone(),
            counts,
        }
    }

    /// Names of skin, ground and hair classes, each with its index in [`Mattes::of_pixel`]. A sample counts for
    /// one of them at most.
    pub fn classes(&self) -> Vec<(&str, usize)> {
        Self::with_surfaces(&self.names.classes, CLASSES)
    }

    /// The same of skin, ground and zones of the coat.
    pub fn zones(&self) -> Vec<(&str, usize)> {
        Self::with_surfaces(&self.names.zones, CLASSES + self.names.classes.len())
    }

    fn with_surfaces(names: &[String], from: usize) -> Vec<(&str, usize)> {
        let names = names.iter().map(String::as_str).zip(from..);
        [("skin", SKIN), ("ground", GROUND)]
            .into_iter()
            .chain(names)
            .collect()
    }

    /// Samples of a pixel that saw each.
    pub fn of_pixel(&self, index: usize) -> &[u32] {
        let columns = self.names.columns();
        &self.counts[index * columns..(index + 1) * columns]
    }
}
