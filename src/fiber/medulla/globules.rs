//! A chain of globules (bear): keratin of random size in one column, a film of air round each.

use super::Room;
use crate::fiber::FiberError;
use crate::fiber::convex::{Convex, Quadric};
use crate::sampling::Rng;
use glam::DVec3;

/// Diameters over the medulla's.
const SIZES: [f64; 2] = [0.5, 1.0];
/// Least wall between two globules, micrometers: less would show as one film.
const WALL_UM: f64 = 0.3;

/// The films of one period, each with an island inside.
pub(super) fn build(room: &Room, spacing: f64, film_um: f64) -> Result<Vec<Convex>, FiberError> {
    let width = 2.0 * (room.semi.x * room.semi.y).sqrt();
    let count = (room.period / (spacing * width)).round().max(3.0) as usize;
    let pitch = room.period / count as f64;
    let mut bodies = Vec::with_capacity(2 * count);
    for k in 0..count {
        let mut rng = Rng::new(room.seed ^ 0x610b_0000, k as u64);
        let size = SIZES[0] + (SIZES[1] - SIZES[0]) * rng.uniform();
        // A globule shifts along within what the neighbors leave, and across within the tube.
        let along = (0.5 * size * width).min(0.46 * pitch - 0.5 * WALL_UM);
        let free = 0.5 * pitch - 0.5 * WALL_UM - along;
        let shift = free * (2.0 * rng.uniform() - 1.0);
        let aside = (1.0 - size)
            * glam::DVec2::from(crate::sampling::concentric_disk(
                rng.uniform(),
                rng.uniform(),
            ));
        let outer = (size * room.semi).extend(along);
        let inner = outer - film_um;
        if inner.min_element() <= 0.05 * outer.min_element() {
            return Err(FiberError::FilmTooThick {
                film_um,
                globule_um: 2.0 * outer.min_element(),
            });
        }
        let center = (aside * room.semi).extend(pitch * (k as f64 + 0.5) + shift);
        for (semi, island) in [(outer, false), (inner, true)] {
            bodies.push(Convex {
                center,
                half: semi,
                planes: Vec::new(),
                quadrics: vec![Quadric::ellipsoid(DVec3::ZERO, semi)],
                island,
            });
        }
    }
    Ok(bodies)
}
