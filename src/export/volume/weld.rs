//! Vertices that should be one: seams of texture coordinates whose two sides were computed apart.

use glam::{IVec3, Vec3};
use std::collections::HashMap;

/// Vertices nearer than this share of the mesh's size are one.
const SHARE: f32 = 1e-6;

/// Moves vertices onto the first one that is nearer than a millionth of the mesh's size.
///
/// * Returns the places, and how many vertices were moved.
pub fn weld(positions: &[Vec3]) -> (Vec<Vec3>, usize) {
    let lo = positions.iter().fold(Vec3::INFINITY, |lo, p| lo.min(*p));
    let hi = positions
        .iter()
        .fold(Vec3::NEG_INFINITY, |hi, p| hi.max(*p));
    let near = SHARE * (hi - lo).max_element();
    if !(near > 0.0 && near.is_finite()) {
        return (positions.to_vec(), 0);
    }
    let mut cells: HashMap<IVec3, Vec<Vec3>> = HashMap::with_capacity(positions.len());
    let mut moved = 0;
    let places = positions.iter().map(|&p| {
        let home = ((p - lo) / (2.0 * near)).floor().as_ivec3();
        let around = (0..27).map(|i| home + IVec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
        let mut kept = around.filter_map(|cell| cells.get(&cell)).flatten();
        if let Some(&first) = kept.find(|q| q.distance_squared(p) <= near * near) {
            moved += usize::from(first != p);
            return first;
        }
        cells.entry(home).or_default().push(p);
        p
    });
    (places.collect(), moved)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_of_a_seam_meet_and_neighbors_stay_apart() {
        let near = Vec3::new(1.0, 2.0, 3.0 + 5e-7);
        let mesh = [
            Vec3::ZERO,
            Vec3::new(1.0, 2.0, 3.0),
            near,
            Vec3::new(1.0, 2.0, 3.0 + 1e-5),
        ];
        let (places, moved) = weld(&mesh);
        assert_eq!((places[2], moved), (mesh[1], 1));
        assert_eq!(
            [places[0], places[1], places[3]],
            [mesh[0], mesh[1], mesh[3]]
        );
    }
}
