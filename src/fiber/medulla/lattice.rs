//! The lattice: close-packed polyhedra with thin walls and sharp corners (deer, moose, caribou).

use super::Room;
use crate::fiber::FiberError;
use crate::fiber::cells::{Cell, Cells, Face, Neighbor};
use crate::fiber::convex::{Convex, Plane, Quadric};
use crate::fiber::voronoi::{PolyFace, Polyhedron};
use crate::sampling::Rng;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Edge of the body-centered cube over the mean width of its cell, the truncated octahedron: widths
/// are 1 edge across squares and 0.87 across hexagons.
const EDGE: f64 = 1.1;
/// Random shift of a cell's center, in edges. Beyond 0.2 slivers appear, at 0 the walls line up.
const JITTER: f64 = 0.13;
/// Distance of centers from the outline, in cells: less makes slivers at the rim, more makes the rim's
/// cells long.
const MARGIN: f64 = 0.42;

/// What fills the medulla: the voids, and the same by the space that belongs to each.
pub(super) struct Lattice {
    pub(super) voids: Vec<Convex>,
    /// `None` where some space belongs to none.
    pub(super) cells: Option<Cells>,
}

/// The cells of one period: Voronoi cells of a jittered body-centered lattice, shrunk by the wall.
pub(super) fn build(room: &Room<'_>, cell_um: f64, wall_um: f64) -> Result<Lattice, FiberError> {
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
    Ok(fill(room, seeds, edge, wall_um))
}

/// Another cell seen from one: its number, the way to it, and the periods that its image is up.
#[derive(Clone, Copy)]
struct Other {
    cell: usize,
    way: DVec3,
    up: i8,
}

/// Half the edge of the cube that a void is cut from, in edges of the lattice.
const REACH: f64 = 1.2;
/// As much for the space that belongs to a cell, where a void at the rim does not fill it.
const WIDE: f64 = 2.5;
/// Thinner walls are below what rays from cell to cell tell apart, micrometers.
const LEAST_WALL_UM: f64 = 1e-3;

fn fill(room: &Room<'_>, mut seeds: Vec<DVec3>, edge: f64, wall_um: f64) -> Lattice {
    // In order of z, so that the search for neighbors stops early.
    seeds.sort_by(|a, b| a.z.total_cmp(&b.z));
    let semi = room.semi - 0.5 * wall_um;
    let cells = seeds.par_iter().enumerate().map(|(index, &center)| {
        let mut filled = true;
        let (polyhedron, others) = cut(&seeds, index, room.period, edge * REACH);
        let mut faces = faces(&polyhedron, &others, wall_um);
        let half = polyhedron
            .corners()
            .fold(DVec3::ZERO, |h, p| h.max(p.abs()));
        if is_open(&polyhedron, center, semi) {
            // The void ends in the cube, the space round it only at the neighbors.
            let cube = Polyhedron::cuboid(DVec3::splat(edge * REACH));
            let (wide, others) = cut(&seeds, index, room.period, edge * WIDE);
            filled = !is_open(&wide, center, semi);
            faces = self::faces(&wide, &others, wall_um);
            faces.retain(|f| !f.next.is_empty());
            faces.extend(self::faces(&cube, &[], wall_um));
        }
        let planes = faces.iter().map(|f| Plane {
            normal: f.normal,
            offset: f.void,
        });
        let void = Convex {
            center,
            half,
            planes: planes.collect(),
            quadrics: vec![Quadric::ellipsoid(
                DVec3::new(-center.x, -center.y, 0.0),
                semi.extend(f64::INFINITY),
            )],
            island: false,
        };
        let radius2 = |p: DVec3| ((center + p).truncate() / semi).length_squared();
        let cell = Cell {
            center,
            faces,
            air: true,
            rim: polyhedron.corners().any(|p| radius2(p) > 0.999),
        };
        (void, cell, filled)
    });
    let all: Vec<(Convex, Cell, bool)> = cells.collect();
    let filled = wall_um >= LEAST_WALL_UM && all.iter().all(|(.., filled)| *filled);
    let (voids, cells): (Vec<_>, Vec<_>) = all.into_iter().map(|(v, c, _)| (v, c)).unzip();
    Lattice {
        voids,
        cells: filled.then(|| Cells::new(&cells, semi, room.period, edge)),
    }
}

/// The faces of a cell and of the void in it: a wall lies before those that neighbors made.
fn faces(polyhedron: &Polyhedron, others: &[Other], wall_um: f64) -> Vec<Face> {
    let face = |face: &PolyFace| {
        let neighbor = face.neighbor.map(|k| &others[k]);
        let wall = neighbor.map_or(0.0, |_| 0.5 * wall_um);
        let next = neighbor.map(|o| Neighbor::new(o.cell, o.up));
        Face::new(
            face.normal,
            neighbor.map_or(f64::INFINITY, |_| face.offset),
            face.offset - wall,
            next.into_iter().collect(),
        )
    };
    polyhedron.faces.iter().map(face).collect()
}

/// The Voronoi cell of a seed within a cube about it, and the seeds near it.
fn cut(seeds: &[DVec3], index: usize, period: f64, half: f64) -> (Polyhedron, Vec<Other>) {
    // Bisectors of farther seeds cannot cut the cube's faces, only its corners beyond the rim.
    let near = 2.5 * half;
    let (center, n) = (seeds[index], seeds.len());
    let mut others = Vec::new();
    for direction in [1, n - 1] {
        let mut cell = (index + direction) % n;
        while cell != index {
            let mut way = seeds[cell] - center;
            let up = -(way.z / period).round();
            way.z += period * up;
            if way.z.abs() > near {
                break;
            }
            if (direction == 1) == (way.z >= 0.0) && way.length_squared() < near * near {
                let up = up as i8;
                others.push(Other { cell, way, up });
            }
            cell = (cell + direction) % n;
        }
    }
    others.sort_by(|a, b| a.way.length_squared().total_cmp(&b.way.length_squared()));
    let mut polyhedron = Polyhedron::cuboid(DVec3::splat(half));
    for (k, other) in others.iter().enumerate() {
        let distance = 0.5 * other.way.length();
        if distance * distance > polyhedron.reach2() {
            break;
        }
        polyhedron.clip(other.way / (2.0 * distance), distance, k);
    }
    (polyhedron, others)
}

/// Whether a face that no neighbor made reaches into the outline.
fn is_open(polyhedron: &Polyhedron, center: DVec3, semi: DVec2) -> bool {
    polyhedron.faces.iter().any(|face| {
        let at = |k: usize| ((center + face.corners[k]).truncate()) / semi;
        let n = face.corners.len();
        let mut around = [true; 2];
        let mut near = false;
        for k in 0..n {
            let (a, b) = (at(k), at((k + 1) % n));
            let side = b - a;
            let s = (-a.dot(side) / side.length_squared().max(1e-300)).clamp(0.0, 1.0);
            near |= (a + s * side).length_squared() < 1.0;
            around[0] &= a.perp_dot(b) >= 0.0;
            around[1] &= a.perp_dot(b) <= 0.0;
        }
        face.neighbor.is_none() && (near || around[0] || around[1])
    })
}
