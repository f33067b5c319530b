//! Cloisonne (mustelid shields): rows of flat ovals merged two by two into letters, H, X, V and Y, with
//! fingers of cortex between them.

use super::Room;
use crate::fiber::FiberError;
use crate::fiber::convex::{Convex, Plane, Quadric};
use crate::fiber::voronoi;
use crate::sampling::Rng;
use glam::{DMat3, DVec2, DVec3};

/// Least wall between rows, micrometers.
const WALL_UM: f64 = 0.8;

/// Rows of ovals.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ovals {
    /// Ovals across the medulla.
    pub(super) columns: u32,
    /// Distance between rows and height of an oval, micrometers.
    pub(super) pitch_um: f64,
    pub(super) height_um: f64,
}

/// One of two rows that make a letter.
#[derive(Clone, Copy)]
struct Stroke {
    /// Middle of the oval seen from the middle of the letter.
    at: DVec3,
    /// Rise along the plane of the letter.
    slope: f64,
    /// Semi-axes across and height.
    across: DVec2,
    half: f64,
}

impl Ovals {
    /// The ovals of one period. They overlap.
    pub(super) fn build(&self, room: &Room<'_>) -> Result<Vec<Convex>, FiberError> {
        let pairs = (0.5 * room.period / self.pitch_um).round().max(2.0) as usize;
        let pitch = 0.5 * room.period / pairs as f64;
        if self.height_um >= pitch - 0.5 * WALL_UM {
            return Err(FiberError::SeptumTooThick {
                septum_um: WALL_UM,
                pitch_um: pitch,
            });
        }
        let n = f64::from(self.columns);
        let count = (0.785 * n * n).round().max(1.0) as usize;
        let mut bodies = Vec::new();
        let outline = match room.edge {
            None => voronoi::ellipse(room.semi),
            Some(edge) => edge.points().to_vec(),
        };
        for (c, column) in voronoi::columns(count, &outline).iter().enumerate() {
            let least = column.edges.iter().fold(f64::INFINITY, |d, e| d.min(e.1));
            // Neighbors' ovals touch and merge here and there; the outline cuts the outer ones.
            let radius = if least.is_finite() {
                1.06 * least
            } else {
                room.semi.min_element()
            };
            for pair in 0..pairs {
                let mut rng = Rng::new(room.seed ^ 0xc701_5000, (c * 4096 + pair) as u64);
                let shift = 0.1 * pitch * (2.0 * rng.uniform() - 1.0);
                let middle = column
                    .center
                    .extend(2.0 * pitch * (pair as f64 + 0.5) + shift);
                let wide = radius * (0.9 + 0.2 * rng.uniform());
                for stroke in self.letter(wide, pitch, &mut rng) {
                    bodies.extend(stroke.0.body(middle, stroke.1, room));
                }
            }
        }
        Ok(bodies)
    }

    /// The strokes of a random letter and the directions of their planes.
    fn letter(&self, radius: f64, pitch: f64, rng: &mut Rng) -> Vec<(Stroke, DVec2)> {
        let plane = DVec2::from_angle(std::f64::consts::TAU * rng.uniform());
        let half = 0.5 * self.height_um;
        let flat = |z: f64| Stroke {
            at: DVec3::Z * z,
            slope: 0.0,
            across: DVec2::splat(radius),
            half,
        };
        let rise = 0.5 * pitch;
        let strokes = match rng.bits() % 20 {
            // Two ovals side by side.
            0..5 => vec![flat(-rise), flat(rise)],
            // H: a bar between them.
            5..12 => {
                let bar = Stroke {
                    at: DVec3::ZERO,
                    slope: 0.0,
                    across: DVec2::splat(0.33 * radius),
                    half: rise + 0.5 * half,
                };
                vec![flat(-rise), flat(rise), bar]
            }
            // X: two that cross.
            12..16 => [-1.0, 1.0]
                .map(|side| Stroke {
                    slope: side * 1.1 * rise / radius,
                    across: DVec2::new(radius, 0.8 * radius),
                    half: 0.8 * half,
                    at: DVec3::ZERO,
                })
                .to_vec(),
            // Y: a stem and two arms.
            _ => {
                let stem = Stroke {
                    at: (-0.5 * radius * plane).extend(0.0),
                    slope: 0.0,
                    across: DVec2::new(0.5 * radius, 0.7 * radius),
                    half: 0.9 * half,
                };
                let arm = |side: f64| Stroke {
                    at: (0.4 * radius * plane).extend(side * 0.5 * rise),
                    slope: side * rise / radius,
                    across: DVec2::new(0.6 * radius, 0.8 * radius),
                    half: 0.8 * half,
                };
                vec![stem, arm(-1.0), arm(1.0)]
            }
        };
        strokes.into_iter().map(|s| (s, plane)).collect()
    }
}

impl Stroke {
    /// An oval with blunt edges: an ellipsoid half as high again, cut flat.
    fn body(&self, middle: DVec3, plane: DVec2, room: &Room<'_>) -> Option<Convex> {
        let center = middle + self.at;
        let along = plane.extend(0.0);
        let side = DVec3::new(-plane.y, plane.x, 0.0);
        // z over the tilted middle plane.
        let over = DVec3::Z - self.slope * along;
        let map = DMat3::from_cols(
            along / self.across.x,
            side / self.across.y,
            over / (1.5 * self.half),
        )
        .transpose();
        let length = over.length();
        let reach = self.across.max_element();
        let mut planes: Vec<Plane> = [1.0, -1.0]
            .map(|sign| Plane {
                normal: sign * over / length,
                offset: self.half / length,
            })
            .to_vec();
        let mut quadrics = vec![Quadric {
            center: DVec3::ZERO,
            map,
        }];
        let across = center.truncate();
        if let Some(edge) = room.edge {
            if !edge.holds(across) {
                return None;
            }
            planes.extend(edge.box_planes(across, reach));
        } else {
            quadrics.push(Quadric::ellipsoid(
                (-across).extend(0.0),
                room.semi.extend(f64::INFINITY),
            ));
        }
        Some(Convex {
            center,
            half: DVec3::new(
                reach,
                reach,
                1.5 * self.half + self.slope.abs() * self.across.x,
            ),
            planes,
            quadrics,
            island: false,
        })
    }
}
