//! A chain of globules (bear): keratin of random size in one column, a film of air round each. Where
//! they lie nearer to each other than they are wide they flatten into discs.

use super::Room;
use crate::fiber::FiberError;
use crate::fiber::convex::{Convex, Plane, Quadric};
use crate::sampling::Rng;
use glam::DVec3;

/// Diameters over the medulla's.
const SIZES: [f64; 2] = [0.5, 1.0];
/// Least wall between two globules, micrometers: less would show as one film.
const WALL_UM: f64 = 0.3;
/// Height of the ellipsoid over that of the disc which is cut from it: 1 leaves lenses whose rims hold
/// no air, much more leaves sharp edges.
const BLUNT: f64 = 1.5;

/// The films of one period, each with an island inside.
pub(super) fn build(
    room: &Room<'_>,
    spacing: f64,
    film_um: f64,
) -> Result<Vec<Convex>, FiberError> {
    let width = 2.0 * (room.semi.x * room.semi.y).sqrt();
    let count = (room.period / (spacing * width)).round().max(3.0) as usize;
    let pitch = room.period / count as f64;
    let mut bodies = Vec::with_capacity(2 * count);
    for k in 0..count {
        let mut rng = Rng::new(room.seed ^ 0x610b_0000, k as u64);
        // Even in the area across.
        let areas = SIZES.map(|s| s * s);
        let size = (areas[0] + (areas[1] - areas[0]) * rng.uniform()).sqrt();
        // A globule shifts along within what the neighbors leave, and across within the tube.
        let along = (0.5 * size * width).min(0.46 * pitch - 0.5 * WALL_UM);
        let free = 0.5 * pitch - 0.5 * WALL_UM - along;
        let shift = free * (2.0 * rng.uniform() - 1.0);
        let aside = (1.0 - size)
            * glam::DVec2::from(crate::sampling::concentric_disk(
                rng.uniform(),
                rng.uniform(),
            ));
        let height = (BLUNT * along).min(0.5 * size * width);
        let outer = (size * room.semi).extend(height);
        let inner = outer - film_um;
        if inner.min_element() <= 0.05 * outer.min_element() || along <= 1.05 * film_um {
            return Err(FiberError::FilmTooThick {
                film_um,
                globule_um: 2.0 * outer.min_element().min(along),
            });
        }
        let center = (aside * room.semi).extend(pitch * (k as f64 + 0.5) + shift);
        for (semi, half, island) in [(outer, along, false), (inner, along - film_um, true)] {
            bodies.push(Convex {
                center,
                half: semi.min(DVec3::new(semi.x, semi.y, half)),
                planes: flat_ends(half),
                quadrics: vec![Quadric::ellipsoid(DVec3::ZERO, semi)],
                island,
            });
        }
    }
    Ok(bodies)
}

/// Between `-half` and `half` along the hair.
fn flat_ends(half: f64) -> Vec<Plane> {
    [DVec3::Z, DVec3::NEG_Z]
        .map(|normal| Plane {
            normal,
            offset: half,
        })
        .to_vec()
}
