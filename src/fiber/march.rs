//! Marching a ray through the cells of the scaled surface.
//!
//! The side of the surface is known at every step: it comes from the region that the ray travels in
//! and flips only by a hit. Each cell compares it with the side at the cell's end; a difference is a
//! crossing that must be found, so that rounding can move a hit but never lose one. Only where the
//! sides agree may a grazing pair of crossings hide, and the parabola through both ends tells.

use super::crossing::{Crossing, Quadratic};
use super::scales::{Cell, Plane, Scales, Strip, distance};
use super::section::{UnitRay, larger};
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
pub(super) const AXIAL: f64 = 1e100;

#[derive(Clone, Copy, PartialEq)]
enum Exit {
    Limit,
    /// Into the next or the previous sector.
    Sector,
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

    /// The polynomials of the surface along the ray: `w = a + b` and `w (1 + E)`.
    #[inline]
    pub(super) fn surface(&self) -> ([f64; 2], [f64; 3]) {
        let Strip { height, slope, .. } = self.strip;
        let e0 = 1.0 + height[0] + slope[0] * self.z;
        let e1 = 1.0 + height[1] + slope[1] * self.z;
        let (de0, de1) = (slope[0] * self.dz, slope[1] * self.dz);
        (
            [self.a + self.b, self.da + self.db],
            [
                e0 * self.b + e1 * self.a,
                e0 * self.db + e1 * self.da + de0 * self.b + de1 * self.a,
                de0 * self.db + de1 * self.da,
            ],
        )
    }

    /// How far the ray stays between the strip's ends, up to `length`, and by which it leaves.
    fn ends(&self, on: StartOn, mut length: f64, mut exit: Exit) -> (f64, Exit) {
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

/// Which way round the axis a ray goes: through which half planes it leaves its sectors.
#[derive(Clone, Copy)]
struct Turn {
    /// 1 toward larger angles, which the second plane of a sector ends.
    plane: usize,
    /// The sign of the distance from that plane within a sector; 0 if the ray never leaves its one.
    sign: f64,
}

impl Turn {
    fn of(ray: &UnitRay) -> Self {
        let turn = ray.x * ray.dy - ray.y * ray.dx;
        let sign = if turn == 0.0 {
            0.0
        } else {
            -1.0_f64.copysign(turn)
        };
        Self {
            plane: usize::from(turn > 0.0),
            sign,
        }
    }

    /// How far a ray from `p` stays in a sector, if it leaves it before `limit`.
    ///
    /// With a branch, though the processor often guesses it wrong: a right guess hides the division.
    #[inline(always)]
    fn way(self, planes: &[Plane; 2], p: DVec3, ray: &UnitRay, limit: f64) -> Option<f64> {
        let plane = planes[self.plane];
        let way = self.sign * distance(plane, p.x, p.y);
        let rate = -self.sign * distance(plane, ray.dx, ray.dy);
        (rate > 0.0 && way < rate * limit).then(|| larger(way, 0.0) / rate)
    }

    /// Position in a sector of the plane that ends the way.
    #[inline(always)]
    fn u(self) -> f64 {
        self.plane as f64
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
        let turn = Turn::of(ray);
        let mut p = ray.at(t);
        let mut c0 = p.x * p.x + p.y * p.y;
        // 1 + E at the start of the cell; on the surface it is the radius itself.
        let mut r0 = if on == StartOn::Face {
            c0.sqrt()
        } else {
            self.radius(cell, self.across(cell.sector, p.x, p.y), p.z)
        };
        for _ in 0..MAX_CELLS {
            let strip = self.strip(cell);
            let planes = &self.sectors[cell.sector].planes;
            let z = p.z - cell.shift;
            let rest = larger(limit - t, 0.0);
            let (mut length, mut exit) = match turn.way(planes, p, ray, rest) {
                Some(way) => (way, Exit::Sector),
                None => (rest, Exit::Limit),
            };
            if !(strip.holds(z, z + length * ray.dz) || self.bare) {
                let window = Window::new(*planes, strip, cell, p, ray);
                (length, exit) = window.ends(on, length, exit);
            }
            if length == f64::INFINITY {
                return March::Lost;
            }
            let end = ray.at(t + length);
            let c_end = end.x * end.x + end.y * end.y;
            let on_face = on == StartOn::Face;
            if exit == Exit::Limit && on_face && self.is_clear(c_end, side) {
                return March::Through;
            }
            let u1 = match exit {
                Exit::Sector => turn.u(),
                _ => self.across(cell.sector, end.x, end.y),
            };
            let r1 = 1.0 + strip.height_at(u1, end.z - cell.shift);
            let odd = sign * (c_end - r1 * r1) < 0.0;
            if odd || !on_face {
                let crossing = Crossing {
                    sign,
                    length,
                    r0,
                    r1,
                    rho2: c0,
                    c: if on_face {
                        0.0
                    } else {
                        (sign * (c0 - r0 * r0)).max(0.0)
                    },
                    c1: p.x * ray.dx + p.y * ray.dy,
                    c2: ray.a,
                };
                if odd || crossing.may_pair() {
                    return self.face(&crossing, cell, (t, p), ray);
                }
            }
            if exit == Exit::Limit {
                return March::Through;
            }
            (t, p, c0) = (t + length, end, c_end);
            let old = cell;
            let mut u = u1;
            match exit {
                Exit::Limit => {}
                Exit::Up => (cell, on) = (self.above(cell), StartOn::Lower),
                Exit::Down => (cell, on) = (self.below(cell), StartOn::Upper),
                Exit::Sector => {
                    (cell, on) = (self.beyond(cell, turn.plane, p.z), StartOn::Nothing);
                    u = 1.0 - u1;
                }
            }
            r0 = self.radius(cell, u, p.z);
            if sign * (c0 - r0 * r0) < 0.0 {
                return self.step_hit(t, p, old, cell, exit, side);
            }
        }
        March::Lost
    }

    /// The hit of a cell's face by a ray that is at `start` where it enters the cell.
    #[inline(never)]
    fn face(&self, crossing: &Crossing, cell: Cell, start: (f64, DVec3), ray: &UnitRay) -> March {
        let (t, p) = start;
        let planes = self.sectors[cell.sector].planes;
        let window = Window::new(planes, self.strip(cell), cell, p, ray);
        let t = t + crossing.first(&window);
        March::Face {
            t,
            cell,
            gradient: self.face_gradient(cell, ray.at(t)),
        }
    }

    /// Whether a place is past the circle that ends the shell on `side`: no scale reaches there.
    ///
    /// * `rho2`: square of its radius.
    #[inline]
    fn is_clear(&self, rho2: f64, side: Side) -> bool {
        match side {
            Side::Inside => rho2 <= self.within2,
            Side::Outside => rho2 >= self.beyond2,
        }
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
