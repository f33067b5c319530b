//! Unit vectors in 32 bits: the sphere unfolded from an octahedron onto a square (Cigolle, Donow,
//! Evangelakos, Mara, McGuire and Meyer 2014).

use glam::{Vec2, Vec3};

/// Steps to either side of the middle.
const STEPS: f32 = 32_767.0;

/// * `v`: of length 1.
/// * Returns the place in the square; [`decode`] gives back the vector within 1e-4 radian.
pub fn encode(v: Vec3) -> [i16; 2] {
    let flat = Vec2::new(v.x, v.y) / (v.x.abs() + v.y.abs() + v.z.abs());
    let place = if v.z < 0.0 { fold(flat) } else { flat };
    // To the nearest, all of them positive for a while.
    let place = place * STEPS + (STEPS + 0.5);
    place.to_array().map(|x| (x as i32 - STEPS as i32) as i16)
}

/// The unit vector of a place.
pub fn decode(place: [i16; 2]) -> Vec3 {
    let place = Vec2::from_array(place.map(f32::from)) / STEPS;
    let z = 1.0 - place.x.abs() - place.y.abs();
    let flat = if z < 0.0 { fold(place) } else { place };
    flat.extend(z).normalize()
}

/// Turns the lower half out of the diamond and back.
fn fold(place: Vec2) -> Vec2 {
    (Vec2::ONE - Vec2::new(place.y, place.x).abs()) * Vec2::ONE.copysign(place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;

    #[test]
    fn every_direction_comes_back() {
        let mut rng = Rng::new(1, 0);
        let random = (0..100_000)
            .map(|_| Vec3::from_array(std::array::from_fn(|_| 2.0 * rng.uniform_f32() - 1.0)));
        let axes = Vec3::AXES.into_iter().flat_map(|a| [a, -a]);
        let diagonals = [Vec3::new(1.0, -1.0, 0.0), Vec3::new(-1.0, 0.0, -1.0)];
        for v in random.chain(axes).chain(diagonals) {
            let Some(v) = v.try_normalize() else { continue };
            let back = decode(encode(v));
            assert!((back - v).length() < 1e-4, "{v} {back}");
            assert!((back.length() - 1.0).abs() < 1e-6);
        }
    }
}
