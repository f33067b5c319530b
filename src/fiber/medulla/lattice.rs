//! The lattice: close-packed polyhedra with thin walls and sharp corners (deer, moose, caribou).

use super::Room;
use crate::fiber::FiberError;
use crate::fiber::convex::{Convex, Plane, Quadric};
use crate::fiber::voronoi::Polyhedron;
use crate::sampling::Rng;
use glam::DVec3;

/// Edge of the body-centered cube over the mean width of its cell, the truncated octahedron: widths
/// are 1 edge across squares and 0.87 across hexagons.
const EDGE: f64 = 1.1;
/// Random shift of a cell's center, in edges. Beyond 0.2 slivers appear, at 0 the walls line up.
const JITTER: f64 = 0.13;
/// Distance of centers from the outline, in cells: less makes slivers at the rim, more makes the rim's
/// cells long.
const MARGIN: f64 = 0.42;

/// The cells of one period: Voronoi cells of a jittered body-centered lattice, shrunk by the wall.
pub(super) fn build(
    room: &Room<'_>,
    cell_um: f64,
    wall_um: f64,
) -> Result<Vec<Convex>, FiberError> {
    let inner = room.semi - MARGIN * cell_um;
    if inner.min_element() <= 0.0 || wall_um >= 0.5 * cell_um {
        return Err(FiberError::CellTooWide {
            cell_um,
            medulla_um: 2.0 * room.semi.min_element(),
        });
    }
    let edge = EDGE * cell_um;
    let layers = (room.period / edge).round().max(3.0);
    let step = DVec3::new(edge, edge, room.period / layers);
    let (nx, ny) = (
        (inner.x / edge).ceil() as i64 + 1,
        (inner.y / edge).ceil() as i64 + 1,
    );
    let mut seeds = Vec::new();
    for z in 0..layers as i64 {
        for y in -ny..=ny {
            for x in -nx..=nx {
                for corner in [0.0, 0.5] {
                    let index = seeds.len() as u64 ^ (x as u64) << 20 ^ (y as u64) << 40;
                    let mut rng = Rng::new(room.seed ^ 0x1a77_1ce0, index);
                    let shift = DVec3::from_array([(); 3].map(|()| 2.0 * rng.uniform() - 1.0));
                    let at = DVec3::new(x as f64, y as f64, z as f64) + corner + JITTER * shift;
                    let p = at * step;
                    if (p.truncate() / inner).length_squared() < 1.0 {
                        seeds.push(p);
                    }
                }
            }
        }
    }
    if seeds.is_empty() {
        seeds = (0..layers as i64)
            .map(|k| DVec3::Z * (k as f64 + 0.5) * step.z)
            .collect();
    }
    Ok(cells(room, &seeds, edge, wall_um))
}

fn cells(room: &Room<'_>, seeds: &[DVec3], edge: f64, wall_um: f64) -> Vec<Convex> {
    // Cells at the rim reach far out and meet others far from their own center.
    let near = 3.0 * edge;
    // Seeds in order of z let the search stop early.
    let mut order: Vec<usize> = (0..seeds.len()).collect();
    order.sort_by(|&i, &j| seeds[i].z.total_cmp(&seeds[j].z));
    let semi = room.semi - 0.5 * wall_um;
    let n = order.len();
    (0..n)
        .map(|k| {
            let center = seeds[order[k]];
            let mut neighbors = Vec::new();
            for direction in [1, n - 1] {
                let mut m = (k + direction) % n;
                while m != k {
                    let mut apart = seeds[order[m]] - center;
                    apart.z -= room.period * (apart.z / room.period).round();
                    if apart.z.abs() > near {
                        break;
                    }
                    if (direction == 1) == (apart.z >= 0.0) && apart.length_squared() < near * near
                    {
                        neighbors.push(apart);
                    }
                    m = (m + direction) % n;
                }
            }
            neighbors.sort_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
            let mut cell = Polyhedron::cuboid(DVec3::splat(1.2 * edge));
            for apart in neighbors {
                let distance = 0.5 * apart.length();
                if distance * distance > cell.reach2() {
                    break;
                }
                cell.clip(apart / (2.0 * distance), distance - 0.5 * wall_um);
            }
            let half = cell.corners().fold(DVec3::ZERO, |h, p| h.max(p.abs()));
            let outline = Quadric::ellipsoid(
                DVec3::new(-center.x, -center.y, 0.0),
                semi.extend(f64::INFINITY),
            );
            Convex {
                center,
                half,
                planes: cell
                    .faces
                    .iter()
                    .map(|f| Plane {
                        normal: f.normal,
                        offset: f.offset,
                    })
                    .collect(),
                quadrics: vec![outline],
                island: false,
            }
        })
        .collect()
}
