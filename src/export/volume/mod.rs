//! A coat as grids: how much fur, of which color and direction, is where; and the skin under it.
//!
//! Lengths are in one unit throughout, meters unless [`VolumeSettings`] say otherwise, and in the frame
//! of the strands, so that grids lie over them. Voxel `i` is centered at `i` times its edge. What strands leave in a voxel is exact up to how they
//! are cut into straight pieces: every piece is shared out among the voxels it passes through.

mod color;
mod curve;
mod error;
mod fiber;
mod field;
mod level_set;
mod moments;
mod resolution;
mod spread;
mod stage;
#[cfg(test)]
mod tests;
mod walk;
mod weld;
mod winding;

pub use color::scattering_albedo;
pub use curve::Curves;
pub use error::VolumeError;
pub use fiber::{FiberGrids, write_fiber};
pub use field::Field;
pub use level_set::Mesh;
pub use resolution::Statistics;
pub use stage::stage;
pub use weld::weld;

use crate::export::vdb::{Compression, Grid, Leaf, Meta, Tree, Value, Writer};
use crate::progress::{Cancel, Progress};
use field::{scalar_leaf, vector_leaf};
use glam::{IVec3, Vec3};
use level_set::signed_distance;
use moments::{Listing, Moments};
use resolution::{range, statistics};
use spread::spread;
use std::io::{Seek, Write};

/// What is wanted of a volume.
#[derive(Clone, Debug)]
pub struct VolumeSettings {
    /// Which grids.
    pub fields: Vec<Field>,
    /// Length of a unit, meters: what the coordinates of strands and skin are in.
    pub meters_per_unit: f64,
    /// Edge of a voxel, units; `None` for what suits the coat and the memory.
    pub voxel: Option<f64>,
    /// Whether values are stored in half precision.
    pub half: bool,
    /// How values are stored.
    pub compression: Compression,
    /// Most memory for the grids of strands, bytes.
    pub memory: u64,
    /// Thickness of the skin for [`Field::Surface`], units; 0 for the solid inside it.
    pub shell: f64,
    /// Entries of metadata that every grid gets: where it comes from.
    pub provenance: Vec<(String, Meta)>,
}

impl Default for VolumeSettings {
    fn default() -> Self {
        Self {
            fields: vec![Field::Density, Field::Color, Field::Tangent],
            meters_per_unit: 1.0,
            voxel: None,
            half: false,
            compression: Compression::Zip,
            memory: 2 << 30,
            shell: 0.0,
            provenance: Vec::new(),
        }
    }
}

/// What is going to be made.
#[derive(Debug)]
pub struct Plan {
    /// Edge of a voxel, units.
    pub voxel: f64,
    /// Leaves of 8 x 8 x 8 voxels that strands pass through.
    pub leaves: usize,
    /// Memory for the grids of strands, bytes.
    pub memory: u64,
    /// What is known of the coat; of interest where the voxel was chosen.
    pub statistics: Statistics,
    listing: Listing,
}

/// A grid that was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// Which one.
    pub field: Field,
    /// Active voxels.
    pub active: u64,
    /// First and last active voxel along each axis.
    pub bounds: Option<(IVec3, IVec3)>,
    /// Sum of the values times the volume of a voxel, the first component of vectors: for the density,
    /// the area of all strands.
    pub integral: f64,
}

/// Chooses the voxels and finds those that strands pass through.
///
/// # Errors
/// A voxel out of range, strands too far away, more memory than allowed for a voxel that was asked for.
pub fn plan(
    curves: &Curves<'_>,
    settings: &VolumeSettings,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<Plan, VolumeError> {
    let range @ [least, most] = range(settings.meters_per_unit);
    let statistics = statistics(curves, range, cancel)?;
    let mut voxel = settings.voxel.unwrap_or_else(|| statistics.voxel(range));
    let mm = 1e3 * settings.meters_per_unit;
    if !(least..=most).contains(&voxel) {
        return Err(VolumeError::Voxel {
            voxel_mm: voxel * mm,
            least_mm: least * mm,
            most_mm: most * mm,
        });
    }
    let per_leaf: u64 = settings.fields.iter().map(|f| f.leaf_bytes()).sum();
    loop {
        let listing = Listing::new(curves, voxel, progress, cancel)?;
        let leaves = listing.leaves();
        let memory = leaves as u64 * per_leaf;
        if memory <= settings.memory {
            return Ok(Plan {
                voxel,
                leaves,
                memory,
                statistics,
                listing,
            });
        }
        if settings.voxel.is_some() || voxel * 1.25 > most {
            return Err(VolumeError::Memory {
                voxel_mm: voxel * mm,
                leaves,
                needed_mb: memory as f64 / 1e6,
                limit_mb: settings.memory as f64 / 1e6,
            });
        }
        voxel *= 1.25;
    }
}

/// A grid of a coat.
#[derive(Clone, Debug)]
pub enum CoatGrid {
    /// Of numbers.
    Scalar(Grid<f32>),
    /// Of directions or colors.
    Vector(Grid<Vec3>),
}

/// Fills the grids and writes them as an OpenVDB file.
///
/// * `skin`: the mesh for [`Field::Surface`].
///
/// # Errors
/// An open skin where its distance is asked for, an output that fails, `cancel`.
pub fn write<W: Write + Seek>(
    out: W,
    curves: &Curves<'_>,
    skin: &Mesh<'_>,
    plan: &Plan,
    settings: &VolumeSettings,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<(W, Vec<Written>), VolumeError> {
    let mut writer = Writer::new(out, settings.compression, crate::PROGRAM)?;
    let mut written = Vec::new();
    let put = &mut |field, grid: CoatGrid| {
        written.push(match grid {
            CoatGrid::Scalar(grid) => put(&mut writer, field, &grid),
            CoatGrid::Vector(grid) => put(&mut writer, field, &grid),
        }?);
        Ok(())
    };
    fill(curves, skin, plan, settings, progress, cancel, put)?;
    Ok((writer.finish()?, written))
}

/// Fills the grids one after the other, in the order of [`write()`].
///
/// * `skin`: the mesh for [`Field::Surface`].
/// * `put`: takes each grid when it is full.
///
/// # Errors
/// An open skin where its distance is asked for, those of `put`, `cancel`.
pub fn fill(
    curves: &Curves<'_>,
    skin: &Mesh<'_>,
    plan: &Plan,
    settings: &VolumeSettings,
    progress: &dyn Progress,
    cancel: &Cancel,
    put: &mut dyn FnMut(Field, CoatGrid) -> Result<(), VolumeError>,
) -> Result<(), VolumeError> {
    let of_strands = || settings.fields.iter().filter(|f| **f != Field::Surface);
    let make = |origin, voxels: &[Moments]| {
        let leaf = |&field: &Field| match field.is_vector() {
            true => AnyLeaf::Vector(vector_leaf(field, origin, voxels)),
            false => AnyLeaf::Scalar(scalar_leaf(field, origin, voxels, plan.voxel)),
        };
        of_strands().map(leaf).collect::<Vec<_>>().into_iter()
    };
    let mut made = plan.listing.map(curves, progress, cancel, make)?;
    for &field in of_strands() {
        let (mut scalars, mut vectors) = (Vec::new(), Vec::new());
        for leaf in made.iter_mut().filter_map(Iterator::next) {
            match leaf {
                AnyLeaf::Scalar(leaf) => scalars.push(leaf),
                AnyLeaf::Vector(leaf) => vectors.push(leaf),
            }
        }
        if matches!(field, Field::Color | Field::Cd) {
            vectors = spread(&vectors);
        }
        let filled = if field.is_vector() {
            let tree = Tree::new(Vec3::ZERO, vectors, Vec::new())?;
            CoatGrid::Vector(grid(field, tree, plan, settings))
        } else {
            let tree = Tree::new(0.0, scalars, Vec::new())?;
            CoatGrid::Scalar(grid(field, tree, plan, settings))
        };
        put(field, filled)?;
    }
    if settings.fields.contains(&Field::Surface) {
        let tree = signed_distance(skin, plan.voxel, settings.shell, progress, cancel)?;
        let filled = grid(Field::Surface, tree, plan, settings);
        put(Field::Surface, CoatGrid::Scalar(filled))?;
    }
    Ok(())
}

/// A leaf of either type.
enum AnyLeaf {
    Scalar(Leaf<f32>),
    Vector(Leaf<Vec3>),
}

fn grid<T: Value>(
    field: Field,
    mut tree: Tree<T>,
    plan: &Plan,
    settings: &VolumeSettings,
) -> Grid<T> {
    tree.drop_empty();
    let mut metadata = field.metadata(settings.meters_per_unit);
    metadata.extend(settings.provenance.iter().cloned());
    Grid {
        name: field.name().to_owned(),
        class: field.class(),
        voxel: plan.voxel,
        half: settings.half,
        metadata,
        tree,
    }
}

fn put<T: Value, W: Write + Seek>(
    writer: &mut Writer<W>,
    field: Field,
    grid: &Grid<T>,
) -> Result<Written, VolumeError> {
    let mut sum = 0.0;
    for leaf in grid.tree.leaves() {
        let active = (0..512).filter(|&i| leaf.is_active(i));
        sum += active
            .map(|i| f64::from(leaf.values[i].components()[0]))
            .sum::<f64>();
    }
    writer.grid(grid)?;
    Ok(Written {
        field,
        active: grid.tree.active_count(),
        bounds: grid.tree.active_bounds(),
        integral: sum * grid.voxel.powi(3),
    })
}
