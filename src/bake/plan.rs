//! What turns sums into tables: all that a bake knows beside its photons.

use super::content::Recipe;
use super::reconstruct::Reconstruction;
use super::tally::Tally;
use super::{BakeError, Settings};
use crate::fiber::Fiber;
use crate::math::symmetry::Symmetry;
use crate::math::unicube::Unicube;
use crate::table::{Azimuths, Nodes, Provenance, StructureTable, Undyed};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Settings and what the fiber adds to them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Plan {
    /// The settings; their number of photons is what the whole bake is to have.
    pub(super) settings: Settings,
    /// Mean radius of the fiber, micrometers.
    pub(super) radius_um: f64,
    /// Whether what is symmetric is averaged: maps with their mirror images, or sides of the fiber.
    pub(super) folded: bool,
    /// The symmetry of the section; of use for several azimuths only.
    #[serde(default, skip_serializing_if = "is_none")]
    pub(super) symmetry: Symmetry,
    /// Hash of the recipe of each channel: one, or three where materials differ by color.
    pub(super) recipes: Vec<String>,
}

impl Plan {
    pub(super) fn new(fibers: &[&Fiber], settings: &Settings) -> Self {
        Self {
            settings: settings.clone(),
            radius_um: fibers
                .first()
                .map_or(0.0, |f| 0.5 * f.structure().diameter_um),
            folded: settings.fold && fibers.iter().all(|f| f.is_mirror_symmetric()),
            symmetry: match fibers.first() {
                Some(fiber) if settings.fold && settings.azimuths > 1 => fiber.symmetry(),
                _ => Symmetry::None,
            },
            recipes: fibers
                .iter()
                .map(|f| Recipe::new(f.structure(), settings).hash())
                .collect(),
        }
    }

    pub(super) fn nodes(&self) -> Nodes {
        let Settings {
            mode,
            bins,
            azimuths,
            ..
        } = self.settings;
        Nodes::new(mode, bins).at_azimuths(Azimuths {
            count: azimuths,
            symmetry: self.symmetry,
        })
    }

    /// Whether each map is averaged with its own mirror image. Not so for several azimuths, where it
    /// would be that of another one.
    pub(super) fn folds_maps(&self) -> bool {
        self.folded && self.settings.azimuths == 1
    }

    /// Sums to be kept: one a node and channel, channel by channel.
    pub(super) fn units(&self) -> usize {
        self.recipes.len() * self.settings.nodes()
    }

    /// What takes noise off the maps of a table.
    pub(super) fn filter(&self, cube: &Unicube) -> Option<Reconstruction> {
        let wanted = self.settings.reconstruct;
        wanted.then(|| Reconstruction::new(cube, &self.nodes(), self.folds_maps()))
    }

    /// An empty sum of one node.
    pub(super) fn empty_tally(&self) -> Tally {
        let texels = 6 * self.settings.face * self.settings.face;
        Tally::new(texels, self.settings.levels.len())
    }

    /// Bytes that a bake needs in any case and those that each thread adds: the sums and the pass
    /// under way, the table and what becomes of it on its way into a file; a thread's own sums of a
    /// node.
    pub(super) fn memory(&self) -> (u64, u64) {
        let Settings {
            face, ref levels, ..
        } = self.settings;
        let values = Tally::shapes(face, levels.len())
            .iter()
            .map(|(_, shape)| shape.iter().map(|&n| n as u64).product::<u64>())
            .sum::<u64>();
        let table = 4 * 6 * (face * face * (levels.len() + 1)) as u64;
        (
            self.units() as u64 * (2 * 8 * values + 3 * table),
            8 * values,
        )
    }

    /// The tables of `photons` photons that are summed up in `tallies`.
    ///
    /// * `filter`: that of this plan.
    ///
    /// # Errors
    /// [`BakeError::Stopped`] if a node has no photon yet.
    pub(super) fn tables(
        &self,
        tallies: &[Tally],
        filter: Option<&Reconstruction>,
        photons: u64,
        provenance: &Provenance,
    ) -> Result<Undyed, BakeError> {
        if tallies.iter().any(Tally::is_empty) {
            return Err(BakeError::Stopped);
        }
        let mut tables = self
            .recipes
            .iter()
            .zip(tallies.chunks(self.settings.nodes()))
            .map(|(recipe, tallies)| self.table(recipe, tallies, filter, photons, provenance));
        match (tables.next(), tables.next(), tables.next()) {
            (Some(red), Some(green), Some(blue)) => {
                Ok(Undyed::Colored(Box::new([red, green, blue])))
            }
            (Some(gray), ..) => Ok(Undyed::Gray(Box::new(gray))),
            _ => Err(BakeError::Stopped),
        }
    }

    /// Makes the maps of the nodes of one channel: flux fractions node by node and level by level, and errors
    /// node by node.
    fn maps(
        &self,
        tallies: &[Tally],
        filter: Option<&Reconstruction>,
        flux: &mut [f32],
        error: &mut [f32],
    ) {
        if let Some(filter) = filter {
            return filter.maps(tallies, flux, error);
        }
        // One map at a time and thread is copied, to be folded.
        let cube = Unicube::new(self.settings.face);
        let (texels, levels) = (cube.texels(), self.settings.levels.len());
        let maps = flux.par_chunks_mut(levels * texels);
        let maps = maps.zip(error.par_chunks_mut(texels)).zip(tallies);
        maps.with_max_len(1).for_each(|((flux, error), tally)| {
            let mut tally = tally.clone();
            if self.folds_maps() {
                tally.fold(&cube);
            }
            flux.copy_from_slice(&tally.flux());
            error.copy_from_slice(&tally.error());
        });
    }

    fn table(
        &self,
        recipe: &str,
        tallies: &[Tally],
        filter: Option<&Reconstruction>,
        photons: u64,
        provenance: &Provenance,
    ) -> StructureTable {
        let texels = 6 * self.settings.face * self.settings.face * tallies.len();
        let mut flux = vec![0.0; texels * self.settings.levels.len()];
        let mut error = vec![0.0; texels];
        self.maps(tallies, filter, &mut flux, &mut error);
        StructureTable {
            nodes: self.nodes(),
            res: self.settings.face,
            levels: self.settings.levels.clone(),
            radius_um: self.radius_um,
            flux,
            error,
            ledger: tallies.iter().flat_map(Tally::ledger).collect(),
            provenance: Provenance {
                seed: self.settings.seed,
                photon_seed: self.settings.photon_seed,
                max_events: self.settings.max_events,
                content: Recipe::content(recipe, photons),
                program: crate::PROGRAM.to_owned(),
                ..provenance.clone()
            },
        }
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
fn is_none(symmetry: &Symmetry) -> bool {
    *symmetry == Symmetry::None
}
