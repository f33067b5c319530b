//! The skin as a signed distance in a narrow band.

use super::VolumeError;
use super::winding::Winding;
use crate::export::vdb::{Leaf, Tile, TileSize, Tree};
use crate::math::triangle;
use crate::progress::{Cancel, Progress};
use glam::{DVec3, IVec3, Vec3};
use rayon::prelude::*;
use std::collections::{BTreeSet, HashMap};

/// Voxels on either side of the surface whose distance is known, as OpenVDB's own tools have it.
const BAND: f64 = 3.0;
/// Most voxels along an axis: one node of the tree, so that none lies wholly inside.
const ACROSS: i64 = 4000;

/// A mesh whose distance is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Mesh<'a> {
    /// Its name, for errors.
    pub name: &'a str,
    /// Vertices, units.
    pub positions: &'a [Vec3],
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: &'a [[u32; 3]],
}

impl Mesh<'_> {
    /// Edges of faces that have no opposite, vertices at equal places taken as one; 0 if the mesh is
    /// closed.
    pub fn open_edges(&self) -> usize {
        let mut balance: HashMap<([u32; 3], [u32; 3]), i32> = HashMap::new();
        let place = |v: u32| {
            (self.positions[v as usize] + 0.0)
                .to_array()
                .map(f32::to_bits)
        };
        for t in self.triangles {
            let [a, b, c] = t.map(place);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                if from != to {
                    let sign = if from < to { 1 } else { -1 };
                    *balance.entry((from.min(to), from.max(to))).or_default() += sign;
                }
            }
        }
        balance.values().map(|b| b.unsigned_abs() as usize).sum()
    }

    /// Refuses a mesh that has no inside.
    ///
    /// # Errors
    /// [`VolumeError::Open`] with the number of open edges.
    pub fn check_closed(&self) -> Result<(), VolumeError> {
        match self.open_edges() {
            0 => Ok(()),
            open => Err(VolumeError::Open {
                skin: self.name.to_owned(),
                open,
            }),
        }
    }
}

/// The signed distance from a mesh, negative inside.
///
/// * `voxel`: edge of a voxel, units.
/// * `shell`: 0 for the solid inside a closed mesh; otherwise the mesh is a plate of this thickness,
///   units, and may be open.
/// * Distances are those of the nearest triangle, exact up to rounding; farther than three voxels from the surface
///   the value is plus or minus three voxels. Inside is where the mesh winds around at least once,
///   so parts may overlap.
///
/// # Errors
/// An open mesh without `shell`, one that is too large for the voxels.
pub(super) fn signed_distance(
    mesh: &Mesh<'_>,
    voxel: f64,
    shell: f64,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<Tree<f32>, VolumeError> {
    if shell == 0.0 {
        mesh.check_closed()?;
    }
    let corners: Vec<[DVec3; 3]> = (mesh.triangles.iter())
        .map(|t| t.map(|v| mesh.positions[v as usize].as_dvec3() / voxel))
        .collect();
    check_size(&corners, voxel)?;
    // All from here on is in voxels.
    let half = 0.5 * shell / voxel;
    let winding = (shell == 0.0).then(|| Winding::new(&corners));
    let listed = list(&corners, BAND + half);
    let groups: Vec<&[(Key, u32)]> = listed.chunk_by(|a, b| a.0 == b.0).collect();
    progress.begin("measuring distances", groups.len() as u64, "leaves");
    let background = (BAND * voxel) as f32;
    let leaves: Result<Vec<Option<Leaf<f32>>>, VolumeError> = groups
        .par_iter()
        .map(|group| {
            if cancel.is_cancelled() {
                return Err(VolumeError::Cancelled);
            }
            progress.advance(1);
            let near: Vec<&[DVec3; 3]> = group.iter().map(|&(_, t)| &corners[t as usize]).collect();
            let origin = IVec3::from_array(group[0].0) * 8;
            let mut leaf = Leaf::new(origin, background);
            for (offset, distance) in distances(origin, &near, BAND + half)
                .into_iter()
                .enumerate()
            {
                let at = leaf.voxel(offset);
                let signed = match &winding {
                    Some(winding) if winding.is_inside(at) => -distance,
                    Some(_) => distance,
                    None => distance - half,
                };
                if signed.abs() < BAND {
                    leaf.set(at, (signed * voxel) as f32);
                } else if signed < 0.0 {
                    leaf.values[offset] = -background;
                }
            }
            // Without an active voxel it is all outside or all inside: what is inside a closed mesh gets
            // tiles, what is deep in a plate has this leaf alone.
            let deep = winding.is_none() && leaf.values[0] < 0.0;
            Ok((leaf.active_count() > 0 || deep).then_some(leaf))
        })
        .collect();
    let leaves: Vec<Leaf<f32>> = leaves?.into_iter().flatten().collect();
    progress.finish();
    let tiles = winding.map_or_else(Vec::new, |w| inner_tiles(&leaves, &w, -background));
    Ok(Tree::new(background, leaves, tiles)?)
}

fn check_size(corners: &[[DVec3; 3]], voxel: f64) -> Result<(), VolumeError> {
    let all = || corners.iter().flatten();
    if let Some(at) = all().find(|p| !p.is_finite() || p.abs().max_element() > 1e8) {
        let at = (*at * voxel).as_vec3();
        return Err(VolumeError::TooFar { at, voxel });
    }
    let lo = all().fold(DVec3::INFINITY, |lo, p| lo.min(*p));
    let hi = all().fold(DVec3::NEG_INFINITY, |hi, p| hi.max(*p));
    let across = (hi - lo).max_element() as i64;
    if across > ACROSS {
        return Err(VolumeError::TooFine {
            across,
            limit: ACROSS,
        });
    }
    Ok(())
}

type Key = [i32; 3];

/// Leaves that each triangle may reach, sorted.
fn list(corners: &[[DVec3; 3]], reach: f64) -> Vec<(Key, u32)> {
    let mut listed: Vec<(Key, u32)> = (corners.par_iter().enumerate())
        .flat_map_iter(|(i, triangle)| {
            let lo = triangle[0].min(triangle[1]).min(triangle[2]) - reach;
            let hi = triangle[0].max(triangle[1]).max(triangle[2]) + reach;
            let mut found = Vec::new();
            let boxes = [lo, hi].map(|p| (p / 8.0).floor().as_ivec3());
            descend(triangle, reach, boxes, &mut found);
            found.into_iter().map(move |key| (key, i as u32))
        })
        .collect();
    listed.par_sort_unstable();
    listed
}

/// Distance from the nearest point of a triangle.
fn to_triangle(p: DVec3, corners: &[DVec3; 3]) -> f64 {
    p.distance(triangle::blend(corners, triangle::nearest(corners, p)))
}

/// Halves the box of leaves until single leaves are left that the triangle is near to.
fn descend(triangle: &[DVec3; 3], reach: f64, [lo, hi]: [IVec3; 2], found: &mut Vec<Key>) {
    // Of the centers of voxels.
    let (first, last) = (lo.as_dvec3() * 8.0, hi.as_dvec3() * 8.0 + 7.0);
    let radius = 0.5 * (last - first).length();
    if to_triangle(0.5 * (first + last), triangle) > reach + radius {
        return;
    }
    let size = hi - lo;
    let axis = (0..3).fold(0, |widest, axis| {
        if size[axis] > size[widest] {
            axis
        } else {
            widest
        }
    });
    if size[axis] == 0 {
        found.push(lo.to_array());
        return;
    }
    let middle = lo[axis] + size[axis] / 2;
    let (mut left, mut right) = (hi, lo);
    left[axis] = middle;
    right[axis] = middle + 1;
    descend(triangle, reach, [lo, left], found);
    descend(triangle, reach, [right, hi], found);
}

/// Distances of the 512 voxels of a leaf, in voxels; what is farther than `reach` may come out farther
/// than it is.
fn distances(origin: IVec3, near: &[&[DVec3; 3]], reach: f64) -> Vec<f64> {
    let mut out = vec![f64::INFINITY; 512];
    // Half the diagonal of 4 x 4 x 4 voxel centers.
    let radius = 1.5 * 3f64.sqrt();
    let mut candidates = Vec::new();
    for block in 0..8 {
        let first = origin + 4 * IVec3::new(block >> 2, block >> 1 & 1, block & 1);
        let center = first.as_dvec3() + 1.5;
        candidates.clear();
        candidates.extend(near.iter().map(|t| (to_triangle(center, t), *t)));
        let nearest = candidates
            .iter()
            .fold(f64::INFINITY, |least, c| least.min(c.0));
        let limit = (nearest + radius).min(reach) + radius;
        candidates.retain(|c| c.0 <= limit);
        for i in 0..64 {
            let at = first + IVec3::new(i >> 4, i >> 2 & 3, i & 3);
            let p = at.as_dvec3();
            let all = candidates.iter().map(|(_, t)| to_triangle(p, t));
            out[Leaf::<f32>::offset(at)] = all.fold(f64::INFINITY, f64::min);
        }
    }
    out
}

/// Tiles for what lies inside and has no leaf.
fn inner_tiles(leaves: &[Leaf<f32>], winding: &Winding, value: f32) -> Vec<Tile<f32>> {
    let homes = |edge: i32| -> BTreeSet<Key> {
        let of = leaves.iter().map(|l| (l.origin & !(edge - 1)).to_array());
        of.collect()
    };
    let taken: BTreeSet<Key> = leaves.iter().map(|l| l.origin.to_array()).collect();
    let lowers = homes(128);
    let small = slots(&lowers, 16, 8, &taken, winding);
    let large = slots(&homes(4096), 32, 128, &lowers, winding);
    let tile = |at: Key, size| Tile {
        origin: IVec3::from_array(at),
        size,
        value,
        active: false,
    };
    let small = small.into_iter().map(|at| tile(at, TileSize::Leaf));
    let large = large.into_iter().map(|at| tile(at, TileSize::Lower));
    small.chain(large).collect()
}

/// Places of `count^3` in each node, `edge` voxels wide, that are inside and not taken.
fn slots(
    nodes: &BTreeSet<Key>,
    count: i32,
    edge: i32,
    taken: &BTreeSet<Key>,
    winding: &Winding,
) -> Vec<Key> {
    let mut found = Vec::new();
    for node in nodes {
        for i in 0..count * count * count {
            let at = IVec3::new(i / count / count, i / count % count, i % count) * edge;
            let at = IVec3::from_array(*node) + at;
            if !taken.contains(&at.to_array()) && winding.is_inside(at) {
                found.push(at.to_array());
            }
        }
    }
    found
}
