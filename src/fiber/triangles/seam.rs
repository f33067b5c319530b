//! The two ends of a period: points of open rims that lie one period apart are one point.

use super::solid::{Bound, Face, Solid};
use glam::{DVec3, I64Vec3};
use std::collections::HashMap;

/// For each point the point that it is an image of and the periods between them: itself and 0, or
/// the nearest rim point one period below.
pub(super) fn match_ends(solid: &Solid<'_>) -> Vec<(u32, i32)> {
    let mut images: Vec<(u32, i32)> = (0..solid.points.len() as u32).map(|v| (v, 0)).collect();
    for bound in Bound::ALL {
        let rim = rim(&solid.faces, bound);
        // Rims with points nearer to each other than the tolerance still match nearest first.
        let cell = solid.tolerance();
        let key = |p: DVec3| (p / cell).floor().as_i64vec3();
        let mut grid: HashMap<I64Vec3, Vec<u32>> = HashMap::new();
        for &v in &rim {
            grid.entry(key(solid.points[v as usize]))
                .or_default()
                .push(v);
        }
        let mut pairs: Vec<(f64, u32, u32)> = Vec::new();
        for &v in &rim {
            let target = solid.screw.image(solid.points[v as usize], 1.0);
            let at = key(target);
            for i in 0..27 {
                let cell_key = at + I64Vec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
                for &w in grid.get(&cell_key).into_iter().flatten().take(CROWD) {
                    let off = solid.points[w as usize].distance(target);
                    if off <= cell && w != v {
                        pairs.push((off, v, w));
                    }
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let mut taken = vec![false; solid.points.len()];
        for (_, below, above) in pairs {
            if !taken[below as usize] && !taken[above as usize] {
                taken[below as usize] = true;
                taken[above as usize] = true;
                images[above as usize] = (below, 1);
            }
        }
    }
    images
}

/// Rim points of one cell that are looked at: more lie upon each other only in broken files.
const CROWD: usize = 64;

/// Points of edges that have one face.
fn rim(faces: &[Face], bound: Bound) -> Vec<u32> {
    let mut edges: Vec<(u32, u32)> = (faces.iter().filter(|f| f.bound == bound))
        .flat_map(|f| {
            let [a, b, c] = f.corners;
            [(a, b), (b, c), (c, a)].map(|(p, q)| (p.min(q), p.max(q)))
        })
        .collect();
    edges.sort_unstable();
    let mut points: Vec<u32> = edges
        .chunk_by(|a, b| a == b)
        .filter(|same| same.len() == 1)
        .flat_map(|same| [same[0].0, same[0].1])
        .collect();
    points.sort_unstable();
    points.dedup();
    points
}
