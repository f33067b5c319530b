//! The space above the skin: which way is out, and how far.
//!
//! A grid whose points know the nearest skin vertex, found by passing it on from neighbor to
//! neighbor. Coarse on purpose: hair follows the shape of the body, not its pores.

use crate::skin::Skin;
use glam::{IVec3, Vec3, Vec4};

/// Edge of a grid cell, meters: finer costs time and memory, coarser lets fur cut through legs.
const CELL: f32 = 0.007;
/// Grid points at most; larger skins get larger cells.
const MAX_POINTS: f32 = 1.5e6;
/// Cells above the skin that are known; farther out hair keeps the direction it has.
const BAND: i32 = 5;

/// Outward direction and height above the skin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Above {
    /// Unit.
    pub(super) normal: Vec3,
    /// Meters, negative inside.
    pub(super) height: f32,
}

/// The grid.
pub(super) struct Field {
    lo: Vec3,
    cell: f32,
    size: IVec3,
    /// Normal and height at each grid point; zeros where the skin is too far.
    values: Vec<Vec4>,
}

impl Field {
    pub(super) fn new(skin: &Skin) -> Self {
        let (lo, hi) = skin.bounds();
        let extent = hi - lo;
        // Roughly the volume of the box with its margin.
        let volume = (extent + 2.0 * BAND as f32 * CELL).element_product();
        let cell = CELL.max((volume / MAX_POINTS).cbrt());
        let lo = lo - BAND as f32 * cell;
        let size = (extent / cell).ceil().as_ivec3() + 2 * BAND + 1;
        let mut field = Self {
            lo,
            cell,
            size,
            values: Vec::new(),
        };
        let nearest = field.nearest_vertices(skin);
        field.values = (0..nearest.len())
            .map(|i| match nearest[i] {
                NONE => Vec4::ZERO,
                v => {
                    let (p, n) = (skin.positions[v as usize], skin.normals[v as usize]);
                    n.extend((field.point(field.place(i)) - p).dot(n))
                }
            })
            .collect();
        field
    }

    fn place(&self, index: usize) -> IVec3 {
        let (i, nx, ny) = (index as i32, self.size.x, self.size.y);
        IVec3::new(i % nx, i / nx % ny, i / nx / ny)
    }

    fn index(&self, place: IVec3) -> Option<usize> {
        let inside = place.cmpge(IVec3::ZERO).all() && place.cmplt(self.size).all();
        inside.then(|| (place.x + self.size.x * (place.y + self.size.y * place.z)) as usize)
    }

    fn point(&self, place: IVec3) -> Vec3 {
        self.lo + place.as_vec3() * self.cell
    }

    /// Nearest vertex of each grid point within the band.
    fn nearest_vertices(&self, skin: &Skin) -> Vec<u32> {
        let count = self.size.element_product() as usize;
        let mut nearest = vec![NONE; count];
        let mut front = Vec::new();
        let offer = |nearest: &mut Vec<u32>, place: IVec3, vertex: u32| -> Option<usize> {
            let index = self.index(place)?;
            let distance = |v: u32| {
                self.point(place)
                    .distance_squared(skin.positions[v as usize])
            };
            let old = nearest[index];
            if old != NONE && distance(old) <= distance(vertex) {
                return None;
            }
            nearest[index] = vertex;
            Some(index)
        };
        for (v, p) in skin.positions.iter().enumerate() {
            let home = ((*p - self.lo) / self.cell).floor().as_ivec3();
            for corner in 0..8 {
                let place = home + IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
                front.extend(offer(&mut nearest, place, v as u32));
            }
        }
        for _ in 0..BAND {
            let mut next = Vec::new();
            front.sort_unstable();
            front.dedup();
            for &index in &front {
                let (place, vertex) = (self.place(index), nearest[index]);
                for step in [IVec3::X, IVec3::Y, IVec3::Z] {
                    next.extend(offer(&mut nearest, place + step, vertex));
                    next.extend(offer(&mut nearest, place - step, vertex));
                }
            }
            front = next;
        }
        nearest
    }

    /// The skin below `p`, or `None` far from it.
    pub(super) fn above(&self, p: Vec3) -> Option<Above> {
        let q = (p - self.lo) / self.cell;
        // The grid is larger than the skin by its band: beyond its outer cells nothing is known.
        let inside = q.cmpge(Vec3::ZERO) & q.cmplt((self.size - 1).as_vec3());
        if !inside.all() {
            return None;
        }
        // Casts round down.
        let home = q.as_ivec3();
        let (far, near) = (q - home.as_vec3(), 1.0 - (q - home.as_vec3()));
        let (ny, nz) = (self.size.x, self.size.x * self.size.y);
        let first = home.x + home.y * ny + home.z * nz;
        let (mut value, mut known) = (Vec4::ZERO, 0.0);
        for (row, weight) in [
            (first, near.y * near.z),
            (first + ny, far.y * near.z),
            (first + nz, near.y * far.z),
            (first + ny + nz, far.y * far.z),
        ] {
            let row = row as usize;
            for (corner, weight) in
                (self.values[row..row + 2].iter()).zip([near.x * weight, far.x * weight])
            {
                value += weight * *corner;
                // Normals are units.
                known += if corner.truncate() == Vec3::ZERO {
                    0.0
                } else {
                    weight
                };
            }
        }
        if known < 0.5 {
            return None;
        }
        Some(Above {
            normal: value.truncate().try_normalize()?,
            height: value.w / known,
        })
    }

    /// Edge of a cell, meters.
    pub(super) fn cell(&self) -> f32 {
        self.cell
    }
}

const NONE: u32 = u32::MAX;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_is_known_around_its_surface() {
        let skin = crate::skin::load("ball").unwrap();
        let field = Field::new(&skin);
        let direction = Vec3::new(0.3, -0.5, 0.8).normalize();
        for height in [-0.005, 0.0, 0.01, 0.02, 0.03] {
            let above = field.above(direction * (0.08 + height)).unwrap();
            assert!(
                (above.height - height).abs() < 1e-3,
                "{height}: {}",
                above.height
            );
            assert!(above.normal.dot(direction) > 0.995);
        }
        assert!(field.above(direction * 0.5).is_none());
        assert!(field.above(Vec3::splat(f32::MAX)).is_none());
    }
}
