//! A tree with a name, a meaning and a place in the world.

use super::VdbError;
use super::metadata::Meta;
use super::pack::Compression;
use super::tree::Tree;
use super::value::Value;
use glam::IVec3;

/// OpenVDB takes a scale as singular if the volume of a voxel is below 3e-15.
const LEAST_VOXEL: f64 = 1.443e-5;

/// What the values of a grid stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// A density, 0 where there is nothing.
    FogVolume,
    /// A signed distance in the unit of the world, negative inside, cut off at the background.
    LevelSet,
    /// Anything else.
    Unknown,
}

impl Class {
    /// The name in the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::FogVolume => "fog volume",
            Self::LevelSet => "level set",
            Self::Unknown => "unknown",
        }
    }
}

/// How vectors change with the transform.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VectorKind {
    /// Not at all: colors.
    Invariant,
    /// Like displacements: directions.
    ContravariantRelative,
}

impl VectorKind {
    /// The entry of metadata that says so.
    pub fn meta(self) -> (String, Meta) {
        let name = match self {
            Self::Invariant => "invariant",
            Self::ContravariantRelative => "contravariant relative",
        };
        ("vector_type".to_owned(), Meta::Text(name.to_owned()))
    }
}

/// A grid as it goes into the file.
#[derive(Clone, Debug)]
pub struct Grid<T> {
    /// Name by which readers find it; unique in the file.
    pub name: String,
    /// What the values are.
    pub class: Class,
    /// Edge of a voxel, world units. Voxel `i` is centered at `i * voxel`.
    pub voxel: f64,
    /// Whether values are stored in half precision.
    pub half: bool,
    /// More metadata; what the format itself asks for is added by the writer.
    pub metadata: Vec<(String, Meta)>,
    /// The voxels.
    pub tree: Tree<T>,
}

impl<T: Value> Grid<T> {
    /// Whether the grid can be written.
    ///
    /// # Errors
    /// Values that are not finite or beyond halves, a voxel size that readers refuse.
    pub fn check(&self) -> Result<(), VdbError> {
        let grid = || self.name.clone();
        if !(self.voxel >= LEAST_VOXEL && self.voxel.is_finite()) {
            return Err(VdbError::Voxel {
                grid: grid(),
                voxel: self.voxel,
                least: LEAST_VOXEL,
            });
        }
        let tree = &self.tree;
        self.check_value(tree.background, IVec3::ZERO)?;
        for tile in tree.small.iter().chain(&tree.large) {
            self.check_value(tile.value, tile.origin)?;
        }
        for leaf in &tree.leaves {
            for (i, &value) in leaf.values.iter().enumerate() {
                if !is_storable(value, self.half) {
                    self.check_value(value, leaf.voxel(i))?;
                }
            }
        }
        Ok(())
    }

    fn check_value(&self, value: T, at: IVec3) -> Result<(), VdbError> {
        let grid = self.name.clone();
        if value.components().iter().any(|c| !c.is_finite()) {
            return Err(VdbError::NotFinite { grid, at });
        }
        if !is_storable(value, self.half) {
            return Err(VdbError::BeyondHalf { grid, at });
        }
        Ok(())
    }

    /// Type of the tree as the file names it; the suffix tells readers of halves.
    pub(super) fn type_name(&self) -> String {
        let suffix = if self.half { "_HalfFloat" } else { "" };
        format!("Tree_{}_5_4_3{suffix}", T::TYPE)
    }

    /// All entries of metadata.
    pub(super) fn all_metadata(
        &self,
        compression: Compression,
        creator: &str,
    ) -> Vec<(String, Meta)> {
        // Bounds of an empty grid are turned inside out, as the library has them.
        let (lo, hi) = self
            .tree
            .active_bounds()
            .unwrap_or((IVec3::MAX, IVec3::MIN));
        let mut all: Vec<(String, Meta)> = [
            ("class", Meta::Text(self.class.name().to_owned())),
            ("creator", Meta::Text(creator.to_owned())),
            ("name", Meta::Text(self.name.clone())),
            ("is_saved_as_half_float", Meta::Bool(self.half)),
            ("file_bbox_min", Meta::Vec3i(lo)),
            ("file_bbox_max", Meta::Vec3i(hi)),
            (
                "file_compression",
                Meta::Text(compression.name().to_owned()),
            ),
            ("file_mem_bytes", Meta::Int64(self.tree.memory() as i64)),
            (
                "file_voxel_count",
                Meta::Int64(self.tree.active_count() as i64),
            ),
        ]
        .map(|(name, value)| (name.to_owned(), value))
        .into();
        all.extend(self.metadata.iter().cloned());
        all
    }
}

/// Finite, also once it is rounded to a half.
fn is_storable<T: Value>(value: T, half: bool) -> bool {
    let value = if half { value.to_half() } else { value };
    value.components().iter().all(|c| c.is_finite())
}
