//! From a signed distance to a triangle mesh: naive surface nets (Gibson 1998) on a sparse grid.

use crate::math::cells::CellMap;
use glam::{IVec3, Vec3};
use rayon::prelude::*;

/// Cells along the edge of a block; blocks far from the surface are skipped.
const BLOCK: i32 = 8;

/// Cells along the edge of the parts of a block; in parts far from the surface nothing is looked at closely.
const PART: i32 = 2;

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
    let reach = reach(BLOCK + 1, cell);
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
        .map(|block| block_net(*block * BLOCK, cell, &at, &distance))
        .collect();

    let mut vertices = Vec::new();
    let mut index = CellMap::default();
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

/// The surface does not come into a cube of `cells` cells if its distance from the middle is as large.
fn reach(cells: i32, cell: f32) -> f32 {
    0.5 * 3f32.sqrt() * cell * cells as f32 * 1.34
}

/// Distances at the corners of the cells of a block, the first corner being `first`. Where the surface is far
/// only their sign is right.
fn corner_values(
    first: IVec3,
    cell: f32,
    at: &(impl Fn(IVec3) -> Vec3 + Sync),
    distance: &(impl Fn(Vec3) -> f32 + Sync),
) -> Vec<f32> {
    let side = BLOCK + 1;
    let mut values = vec![f32::NAN; (side * side * side) as usize];
    let parts = BLOCK / PART;
    let mut far = Vec::new();
    for i in 0..parts * parts * parts {
        let part = PART * IVec3::new(i % parts, i / parts % parts, i / parts / parts);
        let middle = 0.5 * (at(first + part) + at(first + part + PART));
        let there = distance(middle);
        let corners = (0..(PART + 1) * (PART + 1) * (PART + 1)).map(|k| {
            let n = PART + 1;
            let corner = part + IVec3::new(k % n, k / n % n, k / n / n);
            (
                corner,
                (corner.x + side * (corner.y + side * corner.z)) as usize,
            )
        });
        if there.abs() >= reach(PART, cell) {
            far.extend(corners.map(|(_, index)| (index, there)));
            continue;
        }
        for (corner, index) in corners {
            if values[index].is_nan() {
                values[index] = distance(at(first + corner));
            }
        }
    }
    for (index, there) in far {
        if values[index].is_nan() {
            values[index] = there;
        }
    }
    values
}

/// One block's share of the net: a vertex in each cell that the surface crosses, a quad of cells
/// round each crossed edge.
struct BlockNet {
    vertices: Vec<(IVec3, Vec3)>,
    quads: Vec<[IVec3; 4]>,
}

fn block_net(
    first: IVec3,
    cell: f32,
    at: &(impl Fn(IVec3) -> Vec3 + Sync),
    distance: &(impl Fn(Vec3) -> f32 + Sync),
) -> BlockNet {
    let side = BLOCK + 1;
    let values = corner_values(first, cell, at, distance);
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A bone: what is far from it is known by its sign, what is near by its value.
    #[test]
    fn what_is_skipped_is_on_one_side() {
        let distance = |p: Vec3| {
            let along = p.x.clamp(-0.6, 0.6);
            (p - Vec3::X * along).length() - 0.2 - 0.1 * along * along
        };
        let cell = 0.03;
        let at = |corner: IVec3| Vec3::splat(-1.0) + corner.as_vec3() * cell;
        let side = BLOCK + 1;
        let (mut skipped, mut crossed) = (0, 0);
        for block in 0..512 {
            let first = IVec3::new(block % 8, block / 8 % 8, block / 64) * BLOCK;
            let values = corner_values(first, cell, &at, &distance);
            let place = |i: i32| IVec3::new(i % side, i / side % side, i / side / side);
            let true_at = |corner: IVec3| distance(at(first + corner));
            for i in 0..side * side * side {
                let (value, exact) = (values[i as usize], true_at(place(i)));
                skipped += i32::from(value != exact);
                assert_eq!(value < 0.0, exact < 0.0, "{first} {}", place(i));
                let around = [IVec3::X, IVec3::Y, IVec3::Z].map(|axis| place(i) + axis);
                let inside = |c: &IVec3| c.max_element() < side;
                if around
                    .iter()
                    .any(|c| inside(c) && (true_at(*c) < 0.0) != (exact < 0.0))
                {
                    crossed += 1;
                    assert_eq!(value, exact, "{first} {}", place(i));
                }
            }
        }
        assert!(skipped > 100_000 && crossed > 1_000, "{skipped} {crossed}");
    }
}
