//! From a signed distance to a triangle mesh: naive surface nets (Gibson 1998) on a sparse grid.

use glam::{IVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Cells along the edge of a block; blocks far from the surface are skipped.
const BLOCK: i32 = 8;

/// Vertices on the zero set of `distance` and triangles, counter-clockwise seen from outside
/// (where `distance` is positive).
///
/// * `lo`, `hi`: box that contains the surface, with room around it;
/// * `cell`: edge of a grid cell; features thinner than two cells get lost;
/// * `distance` must not exceed the true distance by more than a third.
pub(super) fn mesh(
    lo: Vec3,
    hi: Vec3,
    cell: f32,
    distance: impl Fn(Vec3) -> f32 + Sync,
) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let blocks = ((hi - lo) / (cell * BLOCK as f32)).ceil().as_ivec3();
    let reach = 0.5 * 3f32.sqrt() * cell * (BLOCK + 1) as f32 * 1.33;
    let near: Vec<IVec3> = (0..blocks.x * blocks.y * blocks.z)
        .into_par_iter()
        .map(|i| {
            IVec3::new(
                i % blocks.x,
                i / blocks.x % blocks.y,
                i / blocks.x / blocks.y,
            )
        })
        .filter(|block| {
            let center = lo + (block.as_vec3() + 0.5) * (cell * BLOCK as f32);
            distance(center).abs() < reach
        })
        .collect();
    let at = |corner: IVec3| lo + corner.as_vec3() * cell;
    let parts: Vec<BlockNet> = near
        .par_iter()
        .map(|block| block_net(*block * BLOCK, &at, &distance))
        .collect();

    let mut vertices = Vec::new();
    let mut index = HashMap::new();
    for (cell, vertex) in parts.iter().flat_map(|p| &p.vertices) {
        index.insert(*cell, vertices.len() as u32);
        vertices.push(*vertex);
    }
    let mut triangles = Vec::new();
    for quad in parts.iter().flat_map(|p| &p.quads) {
        // All four cells around a crossed edge are crossed themselves, so all have a vertex, unless
        // the box cuts the surface.
        let corners = quad.map(|cell| index.get(&cell).copied());
        if let [Some(a), Some(b), Some(c), Some(d)] = corners {
            let v = |i: u32| vertices[i as usize];
            // The shorter diagonal gives the rounder triangles.
            if v(a).distance_squared(v(c)) <= v(b).distance_squared(v(d)) {
                triangles.extend([[a, b, c], [a, c, d]]);
            } else {
                triangles.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    (vertices, triangles)
}

/// One block's share of the net: a vertex in each cell that the surface crosses, a quad of cells
/// round each crossed edge.
struct BlockNet {
    vertices: Vec<(IVec3, Vec3)>,
    quads: Vec<[IVec3; 4]>,
}

fn block_net(
    first: IVec3,
    at: &(impl Fn(IVec3) -> Vec3 + Sync),
    distance: &(impl Fn(Vec3) -> f32 + Sync),
) -> BlockNet {
    let side = BLOCK + 1;
    let corner = |i: i32| IVec3::new(i % side, i / side % side, i / side / side);
    let values: Vec<f32> = (0..side * side * side)
        .map(|i| distance(at(first + corner(i))))
        .collect();
    let value = |c: IVec3| values[(c.x + side * (c.y + side * c.z)) as usize];
    let mut net = BlockNet {
        vertices: Vec::new(),
        quads: Vec::new(),
    };
    let axes = [IVec3::X, IVec3::Y, IVec3::Z];
    for i in 0..BLOCK * BLOCK * BLOCK {
        let cell = IVec3::new(i % BLOCK, i / BLOCK % BLOCK, i / BLOCK / BLOCK);
        let (mut sum, mut crossings) = (Vec3::ZERO, 0.0);
        for (k, axis) in axes.iter().enumerate() {
            let (u, v) = (axes[(k + 1) % 3], axes[(k + 2) % 3]);
            for start in [cell, cell + u, cell + v, cell + u + v] {
                let (a, b) = (value(start), value(start + *axis));
                if (a < 0.0) != (b < 0.0) {
                    let (p, q) = (at(first + start), at(first + start + *axis));
                    sum += p + (q - p) * (a / (a - b));
                    crossings += 1.0;
                }
            }
            let (a, b) = (value(cell), value(cell + *axis));
            if (a < 0.0) != (b < 0.0) {
                // Counter-clockwise round the edge, seen from its outer end.
                let own = first + cell;
                let quad = [own - u - v, own - v, own, own - u];
                net.quads.push(if a < 0.0 {
                    quad
                } else {
                    [quad[3], quad[2], quad[1], quad[0]]
                });
            }
        }
        if crossings > 0.0 {
            net.vertices.push((first + cell, sum / crossings));
        }
    }
    net
}
