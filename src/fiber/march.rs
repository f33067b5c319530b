//! Marching a ray through the cells of the scaled surface.
//!
//! The side of the surface is known at every step: it comes from the region that the ray travels in
//! and flips only by a hit. Each cell compares it with the side at the cell's end; a difference is a
//! crossing that must be found, so that rounding can move a hit but never lose one. Only where the
//! sides agree may a grazing pair of crossings hide, and the parabola through both ends tells.

use super::crossing::{Crossing, Quadratic};
use super::scales::{Cell, Plane, Scales, Strip, distance};
use super::section::UnitRay;
use glam::DVec3;

/// Which side of the surface a ray travels on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Inside,
    Outside,
}

/// What a ray starts on; the root at its start is then known and not searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StartOn {
    Nothing,
    Face,
    /// The riser that begins the cell.
    Lower,
    /// The riser that ends the cell.
    Upper,
}

/// What a march came to.
#[derive(Clone, Copy, Debug)]
pub(super) enum March {
    /// The limit was reached on the same side.
    Through,
    /// A scale face.
    Face { t: f64, cell: Cell, gradient: DVec3 },
    /// The riser above `cell`.
    Riser {
        t: f64,
        cell: Cell,
        /// Whether the strip below the riser is the higher one.
        solid_below: bool,
        gradient: DVec3,
    },
    /// Too many cells: a ray along the axis that never ends.
    Lost,
}

/// Cells in one march; at the axis a ray meets a strip a micrometer, so this is some centimeters.
const MAX_CELLS: usize = 20_000;
/// Stands for an endless way where infinity would give NaN.
const AXIAL: f64 = 1e100;

#[derive(Clone, Copy, PartialEq)]
enum Exit {
    Limit,
    NextSector,
    PreviousSector,
    Up,
    Down,
}

/// A cell seen along the ray, from where the ray enters it.
pub(super) struct Window<'a> {
    strip: &'a Strip,
    /// Distances from the two half planes and the rates of them.
    a: f64,
    b: f64,
    da: f64,
    db: f64,
    /// In the cell's own period.
    z: f64,
    dz: f64,
}

impl<'a> Window<'a> {
    #[inline]
    fn new(planes: [Plane; 2], strip: &'a Strip, cell: Cell, p: DVec3, ray: &UnitRay) -> Self {
        Self {
            strip,
            a: distance(planes[0], p.x, p.y),
            b: -distance(planes[1], p.x, p.y),
            da: distance(planes[0], ray.dx, ray.dy),
            db: -distance(planes[1], ray.dx, ray.dy),
            z: p.z - cell.shift,
            dz: ray.dz,
        }
    }

    /// `(a + b) (end(u) - z)`: positive below the end.
    #[inline]
    fn below(&self, end: [f64; 2]) -> Quadratic {
        let (w, dw) = (self.a + self.b, self.da + self.db);
        // Relative to z, so that the coefficients stay small however long the period is.
        let (e0, e1) = (end[0] - self.z, end[1] - self.z);
        Quadratic {
            a: -self.dz * dw,
            b: 0.5 * (e0 * self.db + e1 * self.da - self.dz * w),
            c: e0 * self.b + e1 * self.a,
        }
    }

    /// Position between the half planes at `t`.
    #[inline]
    pub(super) fn across(&self, t: f64) -> f64 {
        let (a, b) = (self.a + t * self.da, self.b + t * self.db);
        a / (a + b)
    }

    /// `1 + E` at `t`, where the ray is at `u` between the half planes.
    #[inline]
    pub(super) fn radius(&self, u: f64, t: f64) -> f64 {
        1.0 + self.strip.height_at(u, self.z + t * self.dz)
    }

    /// How far the ray stays in the cell and where it leaves.
    #[inline]
    fn leave(&self, turn: f64, on: StartOn, limit: f64, bare: bool) -> (f64, Exit) {
        let (mut length, mut exit) = (limit.max(0.0), Exit::Limit);
        if turn > 0.0 {
            if self.db < 0.0 && self.b < -self.db * length {
                (length, exit) = (self.b.max(0.0) / -self.db, Exit::NextSector);
            }
        } else if turn < 0.0 && self.da < 0.0 && self.a < -self.da * length {
            (length, exit) = (self.a.max(0.0) / -self.da, Exit::PreviousSector);
        }
        if bare {
            return (length, exit);
        }
        if length == f64::INFINITY {
            // An axial ray meets neither planes nor limit: only the strip's ends count.
            length = AXIAL;
        }
        let mut up = self.below(self.strip.end);
        up.c = if on == StartOn::Upper {
            0.0
        } else {
            up.c.max(0.0)
        };
        if let Some(t) = up.turns_negative(length) {
            (length, exit) = (t, Exit::Up);
        }
        let down = self.below(self.strip.begin);
        let down = Quadratic {
            a: -down.a,
            b: -down.b,
            c: if on == StartOn::Lower {
                0.0
            } else {
                (-down.c).max(0.0)
            },
        };
        if let Some(t) = down.turns_negative(length) {
            (length, exit) = (t, Exit::Down);
        }
        if length == AXIAL {
            length = f64::INFINITY;
        }
        (length, exit)
    }
}

impl Scales {
    /// Follows `ray` from `t` in `cell` on `side` up to `limit`.
    pub(super) fn march(
        &self,
        ray: &UnitRay,
        mut t: f64,
        mut cell: Cell,
        side: Side,
        mut on: StartOn,
        limit: f64,
    ) -> March {
        // Positive outside, so that `sign * f` is positive on the ray's side.
        let sign = if side == Side::Outside { 1.0 } else { -1.0 };
        let turn = ray.x * ray.dy - ray.y * ray.dx;
        let mut p = ray.at(t);
        let mut c0 = p.x * p.x + p.y * p.y;
        // 1 + E at the start of the cell; on the surface it is the radius itself.
        let mut r0 = if on == StartOn::Face {
            c0.sqrt()
        } else {
            self.radius(cell, self.across(cell.sector, p.x, p.y), p.z)
        };
        for _ in 0..MAX_CELLS {
            let window = Window::new(
                self.sectors[cell.sector].planes,
                self.strip(cell),
                cell,
                p,
                ray,
            );
            let (length, exit) = window.leave(turn, on, limit - t, self.bare);
            if length == f64::INFINITY {
                return March::Lost;
            }
            let end = ray.at(t + length);
            let c_end = end.x * end.x + end.y * end.y;
            let u1 = window.across(length);
            let on_face = on == StartOn::Face;
            let crossing = Crossing {
                window: &window,
                sign,
                length,
                r0,
                r1: window.radius(u1, length),
                rho2: c0,
                c: if on_face {
                    0.0
                } else {
                    (sign * (c0 - r0 * r0)).max(0.0)
                },
                c1: (p.x * ray.dx + p.y * ray.dy) * length,
                c2: ray.a * (length * length),
            };
            if let Some(tau) = crossing.first(c_end, on_face) {
                let hit = ray.at(t + tau);
                return March::Face {
                    t: t + tau,
                    cell,
                    gradient: self.face_gradient(cell, hit),
                };
            }
            if exit == Exit::Limit {
                return March::Through;
            }
            (t, p, c0) = (t + length, end, c_end);
            let old = cell;
            let u;
            (cell, on, u) = self.step(cell, exit, p.z, u1);
            r0 = self.radius(cell, u, p.z);
            if sign * (c0 - r0 * r0) < 0.0 {
                return self.step_hit(t, p, old, cell, exit, side);
            }
        }
        March::Lost
    }

    /// The cell behind an exit, what of it the ray starts on and its position across it.
    #[inline]
    fn step(&self, cell: Cell, exit: Exit, z: f64, u: f64) -> (Cell, StartOn, f64) {
        let (sector, u) = match exit {
            Exit::Limit => return (cell, StartOn::Nothing, u),
            Exit::Up => return (self.above(cell), StartOn::Lower, u),
            Exit::Down => return (self.below(cell), StartOn::Upper, u),
            Exit::NextSector => (self.next_sector(cell.sector), 0.0),
            Exit::PreviousSector => (self.previous_sector(cell.sector), 1.0),
        };
        let near = Cell {
            sector,
            strip: cell.strip.min(self.count(sector) - 1),
            ..cell
        };
        (self.settle(near, u, z), StartOn::Nothing, u)
    }

    /// The surface between two cells is crossed on their common boundary.
    fn step_hit(&self, t: f64, p: DVec3, old: Cell, new: Cell, exit: Exit, side: Side) -> March {
        match exit {
            // The ray leaves air for solid or solid for air: old is solid if it came from inside.
            Exit::Up => March::Riser {
                t,
                cell: old,
                solid_below: side == Side::Inside,
                gradient: self.riser_gradient(old, p),
            },
            Exit::Down => March::Riser {
                t,
                cell: new,
                solid_below: side == Side::Outside,
                gradient: self.riser_gradient(new, p),
            },
            // Neighboring sectors agree on their plane: only rounding at the surface gets here.
            _ => March::Face {
                t,
                cell: new,
                gradient: self.face_gradient(new, p),
            },
        }
    }
}
