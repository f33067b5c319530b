//! Columns of cells whose rungs are aligned: the multiserial ladder and the tire tread.

use super::Room;
use crate::fiber::FiberError;
use crate::fiber::convex::{Convex, Plane, Quadric};
use crate::fiber::voronoi::{self, Column};
use crate::sampling::Rng;
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

/// Cells in columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stack {
    /// Width of a column, distance between rungs, wall between cells, micrometers.
    pub(super) cell_um: f64,
    pub(super) pitch_um: f64,
    pub(super) septum_um: f64,
    /// How far the rungs of a column may be out of step, in pitches.
    pub(super) jitter: f64,
    /// Semi-axes of the ellipsoid that rounds a cell's corners over the cell's; sqrt(3) is a box.
    pub(super) corner: f64,
    /// How far the outline sinks between rows, as a share of the radius.
    pub(super) dent: f64,
}

/// "Corn cob" (hare, rabbit): rungs at most 0.15 pitches out of step.
pub(super) fn multiserial(cell_um: f64, pitch_um: f64, septum_um: f64) -> Stack {
    Stack {
        cell_um,
        pitch_um,
        septum_um,
        jitter: 0.15,
        corner: 1.35,
        dent: 0.0,
    }
}

/// Flat cells in a tube with bumps at every row (squirrel).
pub(super) fn tire_tread(cell_um: f64, pitch_um: f64, septum_um: f64) -> Stack {
    Stack {
        cell_um,
        pitch_um,
        septum_um,
        jitter: 0.04,
        corner: 1.2,
        dent: 0.15,
    }
}

impl Stack {
    /// The cells of one period.
    pub(super) fn build(&self, room: &Room<'_>) -> Result<Vec<Convex>, FiberError> {
        let rungs = (room.period / self.pitch_um).round().max(3.0) as usize;
        let pitch = room.period / rungs as f64;
        if self.septum_um >= 0.9 * pitch.min(self.cell_um) {
            return Err(FiberError::SeptumTooThick {
                septum_um: self.septum_um,
                pitch_um: pitch.min(self.cell_um),
            });
        }
        let semi = room.semi - 0.5 * self.septum_um;
        if semi.min_element() <= self.septum_um {
            return Err(FiberError::CellTooWide {
                cell_um: self.cell_um,
                medulla_um: 2.0 * room.semi.min_element(),
            });
        }
        let (area, outline) = match room.edge {
            None => (PI * room.semi.x * room.semi.y, voronoi::ellipse(semi)),
            Some(edge) => (voronoi::area(edge.points()), edge.points().to_vec()),
        };
        let count = (area / (self.cell_um * self.cell_um)).round().max(1.0);
        let columns = voronoi::columns(count as usize, &outline);
        let mut cells = Vec::with_capacity(rungs * columns.len());
        for (c, column) in columns.iter().enumerate() {
            let z = self.rungs(rungs, pitch, room.seed, c as u64);
            for k in 0..rungs {
                let (above, below) = ((k + 1) % rungs, (k + rungs - 1) % rungs);
                let gap = |a: usize, b: usize| (z[b] - z[a]).rem_euclid(room.period);
                // A thin neighbor of a shifted cell keeps a third of the wall.
                let most = 0.5 * (gap(k, above).min(gap(below, k)) - self.septum_um / 3.0);
                let half = most.min(0.5 * (pitch - self.septum_um));
                cells.extend(self.cell(column, room, z[k], half, pitch));
            }
        }
        Ok(cells)
    }

    /// Heights of a column's rungs: a common phase and a smaller shift of each.
    fn rungs(&self, count: usize, pitch: f64, seed: u64, column: u64) -> Vec<f64> {
        let mut rng = Rng::new(seed ^ 0xc01_0000, column);
        let phase = 0.6 * self.jitter * (2.0 * rng.uniform() - 1.0);
        (0..count)
            .map(|k| {
                let own = 0.4 * self.jitter * (2.0 * rng.uniform() - 1.0);
                pitch * (k as f64 + 0.5 + phase + own)
            })
            .collect()
    }

    /// A cell of a column; `None` where the middle of the column is no part of the medulla.
    fn cell(
        &self,
        column: &Column,
        room: &Room<'_>,
        z: f64,
        half: f64,
        pitch: f64,
    ) -> Option<Convex> {
        let wall = 0.5 * self.septum_um;
        let mut planes: Vec<Plane> = column
            .edges
            .iter()
            .map(|&(normal, distance)| Plane {
                normal: normal.extend(0.0),
                offset: distance - wall,
            })
            .collect();
        for normal in [DVec3::Z, DVec3::NEG_Z] {
            planes.push(Plane {
                normal,
                offset: half,
            });
        }
        let extent = column.half.extend(half);
        let mut quadrics = Vec::with_capacity(2);
        if let Some(edge) = room.edge {
            if !edge.holds(column.center) {
                return None;
            }
            planes.extend(edge.planes(column, wall));
        } else {
            // A barrel that is narrower by the dent where rows meet.
            let semi = room.semi - wall;
            let rise = (1.0 - (1.0 - self.dent).powi(2)).sqrt() / (0.5 * pitch);
            quadrics.push(Quadric {
                center: (-column.center).extend(0.0),
                map: DMat3::from_diagonal(DVec3::new(1.0 / semi.x, 1.0 / semi.y, rise)),
            });
        }
        let corners = Quadric::ellipsoid(
            DVec3::ZERO,
            self.corner * (extent - DVec3::new(wall, wall, 0.0)),
        );
        quadrics.push(corners);
        Some(Convex {
            center: column.center.extend(z),
            half: extent,
            planes,
            quadrics,
            island: false,
        })
    }
}
