//! Grids that reach one voxel farther.

use crate::export::vdb::Leaf;
use glam::{IVec3, Vec3};
use rayon::prelude::*;
use std::collections::{BTreeSet, HashMap};

/// Gives every voxel that touches an active one the mean of those around it.
pub(super) fn spread(leaves: &[Leaf<Vec3>]) -> Vec<Leaf<Vec3>> {
    let index: HashMap<IVec3, &Leaf<Vec3>> = leaves.iter().map(|l| (l.origin, l)).collect();
    let around = |origin: IVec3| (0..27).map(move |i| origin + 8 * step(i));
    let places: BTreeSet<[i32; 3]> = leaves
        .iter()
        .flat_map(|l| around(l.origin))
        .map(|at| at.to_array())
        .collect();
    let places: Vec<[i32; 3]> = places.into_iter().collect();
    places
        .par_iter()
        .filter_map(|&origin| {
            let origin = IVec3::from_array(origin);
            let near: Vec<Option<&Leaf<Vec3>>> =
                around(origin).map(|at| index.get(&at).copied()).collect();
            grown(origin, &near)
        })
        .collect()
}

fn step(i: i32) -> IVec3 {
    IVec3::new(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1)
}

/// The leaf at `origin`; `near` are the leaves around it and itself, in the middle.
fn grown(origin: IVec3, near: &[Option<&Leaf<Vec3>>]) -> Option<Leaf<Vec3>> {
    let here = near[13];
    let mut leaf = here
        .cloned()
        .unwrap_or_else(|| Leaf::new(origin, Vec3::ZERO));
    for offset in 0..512 {
        if here.is_some_and(|leaf| leaf.is_active(offset)) {
            continue;
        }
        let at = leaf.voxel(offset);
        let (mut sum, mut count) = (Vec3::ZERO, 0.0);
        for i in 0..27 {
            let neighbor = at + step(i);
            let [to, own]: [IVec3; 2] = [neighbor, origin].map(|v| v >> 3);
            let to = to - own + 1;
            let Some(from) = near[(9 * to.x + 3 * to.y + to.z) as usize] else {
                continue;
            };
            let offset = Leaf::<Vec3>::offset(neighbor);
            if from.is_active(offset) {
                sum += from.values[offset];
                count += 1.0;
            }
        }
        if count > 0.0 {
            leaf.set(at, sum / count);
        }
    }
    (leaf.active_count() > 0).then_some(leaf)
}
