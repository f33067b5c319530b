//! The micro-structure of a fiber as grids: index, absorption, where the medulla is.

use super::VolumeError;
use crate::export::vdb::{
    Class, Compression, Grid, LEAF, Leaf, Meta, Tree, Value, VectorKind, Writer,
};
use crate::fiber::{Fiber, Region};
use crate::progress::{Cancel, Progress};
use glam::{IVec3, Vec3};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::io::{Seek, Write};

/// Voxels of a fiber if no size is asked for.
const VOXELS: f64 = 4e6;
/// Most voxels of a fiber: some 600 MB of memory.
const MOST_VOXELS: f64 = 4e7;

/// How a fiber is made into grids.
#[derive(Clone, Debug, Default)]
pub struct FiberGrids {
    /// Edge of a voxel, micrometers; `None` for some four million voxels. It is made a little smaller,
    /// so that a whole number of voxels is a period.
    pub voxel_um: Option<f64>,
    /// Whether values are stored in half precision.
    pub half: bool,
    /// Absorption of the cortex per micrometer, linear R, G, B.
    pub absorption_per_um: [f64; 3],
    /// Entries of metadata that every grid gets.
    pub provenance: Vec<(String, Meta)>,
}

/// Grids of one leaf.
struct Block {
    density: Leaf<f32>,
    ior: Leaf<f32>,
    medulla: Leaf<f32>,
    absorption: Leaf<Vec3>,
}

/// Writes one period of a fiber as an OpenVDB file; a unit of length is a micrometer.
///
/// | grid | |
/// |---|---|
/// | `density` | 1 in keratin and media, 0 in voids and outside |
/// | `ior` | refractive index; the background is that of the medium around |
/// | `medulla` | 1 in voids and in a medulla that is a medium |
/// | `absorption` | absorption coefficient, 1/um, linear R, G, B |
///
/// A voxel has the value at its center. The axis is z; voxels are active within the outer surface.
///
/// # Errors
/// Too many voxels, the output, stopped.
pub fn write_fiber<W: Write + Seek>(
    out: W,
    fiber: &Fiber,
    settings: &FiberGrids,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<(W, f64), VolumeError> {
    let period = fiber.period_um();
    let radius = fiber.bounding_radius_um();
    let [a, b] = fiber.semi_axes_um();
    let volume = PI * a * b * period;
    let wanted = settings
        .voxel_um
        .unwrap_or_else(|| (volume / VOXELS).cbrt());
    let layers = (period / wanted).ceil().max(1.0);
    let voxel = period / layers;
    // Also not a number.
    let count = volume / voxel.powi(3);
    if !(wanted > 0.0 && count <= MOST_VOXELS) {
        return Err(VolumeError::FineFiber {
            voxel_um: wanted,
            voxels: count,
            limit: MOST_VOXELS,
        });
    }
    let reach = (radius / voxel).ceil() as i32 + 1;
    let lo = IVec3::new(-reach, -reach, 0) >> 3;
    let hi = IVec3::new(reach, reach, layers as i32 - 1) >> 3;
    let size: IVec3 = hi - lo + 1;
    let total = size.element_product();
    progress.begin("sampling the fiber", total as u64, "leaves");
    let outside = fiber.medium(Region::Outside).ior as f32;
    let blocks: Result<Vec<Option<Block>>, VolumeError> = (0..total)
        .into_par_iter()
        .map(|i| {
            if cancel.is_cancelled() {
                return Err(VolumeError::Cancelled);
            }
            progress.advance(1);
            let place = IVec3::new(i / size.z / size.y, i / size.z % size.y, i % size.z) + lo;
            Ok(block(
                fiber,
                settings,
                place * LEAF,
                voxel,
                layers as i32,
                outside,
            ))
        })
        .collect();
    progress.finish();
    let blocks: Vec<Block> = blocks?.into_iter().flatten().collect();
    let mut writer = Writer::new(out, Compression::Zip, crate::PROGRAM)?;
    let mut scalars = |name: &str, class, unit, background, pick: fn(&Block) -> &Leaf<f32>| {
        let leaves = blocks.iter().map(|block| pick(block).clone()).collect();
        let tree = Tree::new(background, leaves, Vec::new())?;
        writer.grid(&grid(name, class, unit, voxel, settings, tree))
    };
    scalars("density", Class::FogVolume, "1", 0.0, |b| &b.density)?;
    scalars("ior", Class::Unknown, "1", outside, |b| &b.ior)?;
    scalars("medulla", Class::FogVolume, "1", 0.0, |b| &b.medulla)?;
    let leaves = blocks.into_iter().map(|block| block.absorption).collect();
    let tree = Tree::new(Vec3::ZERO, leaves, Vec::new())?;
    let mut absorption = grid("absorption", Class::Unknown, "1/um", voxel, settings, tree);
    absorption.metadata.push(VectorKind::Invariant.meta());
    writer.grid(&absorption)?;
    Ok((writer.finish()?, voxel))
}

fn grid<T: Value>(
    name: &str,
    class: Class,
    unit: &str,
    voxel: f64,
    settings: &FiberGrids,
    tree: Tree<T>,
) -> Grid<T> {
    let mut metadata = settings.provenance.clone();
    metadata.push(("unit".to_owned(), Meta::Text(unit.to_owned())));
    metadata.push(("unit_of_length".to_owned(), Meta::Text("um".to_owned())));
    Grid {
        name: name.to_owned(),
        class,
        voxel,
        half: settings.half,
        metadata,
        tree,
    }
}

/// The voxels of one leaf, or `None` if all are outside.
fn block(
    fiber: &Fiber,
    settings: &FiberGrids,
    origin: IVec3,
    voxel: f64,
    layers: i32,
    outside: f32,
) -> Option<Block> {
    let mut block = Block {
        density: Leaf::new(origin, 0.0),
        ior: Leaf::new(origin, outside),
        medulla: Leaf::new(origin, 0.0),
        absorption: Leaf::new(origin, Vec3::ZERO),
    };
    for offset in 0..512 {
        let at = block.density.voxel(offset);
        if at.z >= layers || at.z < 0 {
            continue;
        }
        let point = at.as_dvec3() * voxel;
        let region = fiber.region_at(point);
        if region == Region::Outside {
            continue;
        }
        let medium = fiber.medium(region);
        let pigment = fiber.pigment_at(point, region);
        let absorption = settings
            .absorption_per_um
            .map(|a| (a * pigment + medium.absorption_per_um) as f32);
        let is = |yes: bool| f32::from(u8::from(yes));
        block.density.set(at, is(region != Region::Void));
        block.ior.set(at, medium.ior as f32);
        block
            .medulla
            .set(at, is(matches!(region, Region::Void | Region::Medulla)));
        block.absorption.set(at, Vec3::from_array(absorption));
    }
    (block.density.active_count() > 0).then_some(block)
}
