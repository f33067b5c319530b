//! Marching a ray through the cells of the scaled surface.
//!
//! The side of the surface is known at every step: it comes from the region that the ray travels in
//! and flips only by a hit. Each cell compares it with the side at the cell's end; a difference is a
//! crossing that must be found, so that rounding can move a hit but never lose one. Only where the
//! sides agree may a grazing pair of crossings hide, and the parabola through both ends tells.

use super::scales::{Cell, Plane, Scales, distance};
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
/// Convergence of a hit, in units of the radius over the ray's radial speed.
const TOLERANCE: f64 = 1e-13;

#[derive(Clone, Copy, PartialEq)]
enum Exit {
    Limit,
    NextSector,
    PreviousSector,
    Up,
    Down,
}

/// `c + 2 b t + a t^2`.
#[derive(Clone, Copy)]
struct Quadratic {
    a: f64,
    b: f64,
    c: f64,
}

impl Quadratic {
    fn at(self, t: f64) -> f64 {
        self.c + t * (2.0 * self.b + t * self.a)
    }

    /// The root where it falls, written so that it loses no digits.
    fn falling_root(self) -> f64 {
        let root = (self.b * self.b - self.a * self.c).max(0.0).sqrt();
        if self.b <= 0.0 {
            let q = root - self.b;
            if q > 0.0 { self.c / q } else { 0.0 }
        } else {
            -(self.b + root) / self.a
        }
    }

    /// First time up to `limit` at which a quadratic that starts at `c >= 0` turns negative.
    fn turns_negative(self, limit: f64) -> Option<f64> {
        let falls = self.at(limit) < 0.0
            || (self.a > 0.0
                && self.b < 0.0
                && -self.b < limit * self.a
                && self.b * self.b > self.a * self.c);
        falls.then(|| {
            if self.c == 0.0 && self.b <= 0.0 {
                0.0
            } else {
                self.falling_root().clamp(0.0, limit)
            }
        })
    }
}

/// Values of a cell along the ray from the cell's start.
struct Window {
    cell: Cell,
    /// Distances from the two half planes, their sum, and the rates of them.
    a: f64,
    b: f64,
    da: f64,
    db: f64,
    z: f64,
    dz: f64,
}

impl Window {
    fn new(planes: [Plane; 2], cell: Cell, p: DVec3, ray: &UnitRay) -> Self {
        Self {
            cell,
            a: distance(planes[0], p.x, p.y),
            b: -distance(planes[1], p.x, p.y),
            da: distance(planes[0], ray.dx, ray.dy),
            db: -distance(planes[1], ray.dx, ray.dy),
            z: p.z - cell.shift,
            dz: ray.dz,
        }
    }

    /// `(a + b) (end(u) - z)`: positive below the end.
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

    fn across(&self, t: f64) -> f64 {
        let a = self.a + t * self.da;
        a / (a + self.b + t * self.db)
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
        start_on: StartOn,
        limit: f64,
    ) -> March {
        // Positive outside, so that `sign * f` is positive on the ray's side.
        let sign = if side == Side::Outside { 1.0 } else { -1.0 };
        let turn = ray.x * ray.dy - ray.y * ray.dx;
        let [speed, ..] = ray.radius_squared();
        let mut on = start_on;
        let mut p = ray.at(t);
        for _ in 0..MAX_CELLS {
            let planes = [
                self.planes[cell.sector],
                self.planes[self.next_sector(cell.sector)],
            ];
            let window = Window::new(planes, cell, p, ray);
            let (mut length, exit) = self.leave_cell(&window, turn, on, limit - t);
            if length == f64::INFINITY {
                return March::Lost;
            }
            length = length.max(0.0);
            let end = ray.at(t + length);
            let rho2 = end.x * end.x + end.y * end.y;
            let r1 = self.radius(cell, window.across(length), end.z);
            let f = Crossing {
                scales: self,
                window: &window,
                z: p.z,
                on_face: on == StartOn::Face,
                c0: p.x * p.x + p.y * p.y,
                c1: p.x * ray.dx + p.y * ray.dy,
                c2: speed,
                sign,
            };
            if let Some(tau) = f.first(length, r1, sign * (rho2 - r1 * r1)) {
                let hit = ray.at(t + tau);
                return March::Face {
                    t: t + tau,
                    cell,
                    gradient: self.face_gradient(cell, hit),
                };
            }
            t += length;
            p = end;
            if exit == Exit::Limit {
                return March::Through;
            }
            let old = cell;
            (cell, on) = self.step(cell, exit, p.z);
            let r = self.radius(cell, self.across(cell.sector, p.x, p.y), p.z);
            if sign * (rho2 - r * r) < 0.0 {
                return self.step_hit(t, p, old, cell, exit, side);
            }
        }
        March::Lost
    }

    /// How far the ray stays in the window's cell and where it leaves.
    fn leave_cell(&self, window: &Window, turn: f64, on: StartOn, limit: f64) -> (f64, Exit) {
        let (mut length, mut exit) = (limit, Exit::Limit);
        if turn > 0.0 {
            if window.db < 0.0 && window.b < -window.db * length {
                (length, exit) = (window.b.max(0.0) / -window.db, Exit::NextSector);
            }
        } else if turn < 0.0 && window.da < 0.0 && window.a < -window.da * length {
            (length, exit) = (window.a.max(0.0) / -window.da, Exit::PreviousSector);
        }
        if length == f64::INFINITY {
            // An axial ray meets neither planes nor limit: only the strip's ends count.
            length = f64::MAX.sqrt();
        }
        let Cell { sector, strip, .. } = window.cell;
        let mut up = window.below(self.stack(sector)[strip].end);
        up.c = if on == StartOn::Upper {
            0.0
        } else {
            up.c.max(0.0)
        };
        if let Some(t) = up.turns_negative(length) {
            (length, exit) = (t, Exit::Up);
        }
        let down = window.below(self.begin(sector, strip));
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
        if exit == Exit::Limit {
            length = limit;
        }
        (length, exit)
    }

    /// The cell behind an exit.
    fn step(&self, cell: Cell, exit: Exit, z: f64) -> (Cell, StartOn) {
        match exit {
            Exit::Limit => (cell, StartOn::Nothing),
            Exit::Up => (self.above(cell), StartOn::Lower),
            Exit::Down => (self.below(cell), StartOn::Upper),
            Exit::NextSector | Exit::PreviousSector => {
                let (sector, u) = if exit == Exit::NextSector {
                    (self.next_sector(cell.sector), 0.0)
                } else {
                    (self.previous_sector(cell.sector), 1.0)
                };
                let strip = cell.strip.min(self.stack(sector).len() - 1);
                let near = Cell {
                    sector,
                    strip,
                    ..cell
                };
                (self.settle(near, u, z), StartOn::Nothing)
            }
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

/// `f = rho^2 - (1 + E)^2` along the ray in one cell.
struct Crossing<'a> {
    scales: &'a Scales,
    window: &'a Window,
    z: f64,
    on_face: bool,
    /// Coefficients of rho^2.
    c0: f64,
    c1: f64,
    c2: f64,
    sign: f64,
}

impl Crossing<'_> {
    /// First crossing in `0..=length`.
    ///
    /// * `r1`: `1 + E` at the end; `f1`: signed f at the end, negative if the side has changed.
    ///
    /// With E replaced by its chord f is a quadratic with exact values at both ends. Its root is
    /// refined by chords from the start to the last estimate: E is so nearly linear in a cell that
    /// each pass wins many digits.
    fn first(&self, length: f64, r1: f64, f1: f64) -> Option<f64> {
        let r0 = if self.on_face {
            self.c0.sqrt()
        } else {
            self.scales
                .radius(self.window.cell, self.window.across(0.0), self.z)
        };
        let c = if self.on_face {
            0.0
        } else {
            (self.sign * (self.c0 - r0 * r0)).max(0.0)
        };
        let chord = |t: f64, r: f64| {
            let k = (r - r0) / t;
            Quadratic {
                a: self.sign * (self.c2 - k * k),
                b: self.sign * (self.c1 - r0 * k),
                c,
            }
        };
        if length <= 0.0 {
            return (f1 < 0.0).then_some(0.0);
        }
        let q = chord(length, r1);
        let odd = f1 < 0.0;
        let pair = !odd
            && !self.on_face
            && q.a > 0.0
            && q.b < 0.0
            && -q.b < length * q.a
            && q.b * q.b > q.a * q.c;
        if !odd && !pair {
            return None;
        }
        let root = |q: Quadratic| {
            if c > 0.0 {
                q.falling_root()
            } else if q.b > 0.0 && q.a < 0.0 {
                -2.0 * q.b / q.a
            } else {
                0.0
            }
        };
        let mut t = root(q).clamp(0.0, length);
        for _ in 0..8 {
            if t <= 0.0 {
                break;
            }
            let r = self.scales.radius(
                self.window.cell,
                self.window.across(t),
                self.z + t * self.window.dz,
            );
            let next = root(chord(t, r)).clamp(0.0, length);
            let moved = (next - t).abs();
            t = next;
            if moved * self.c2.sqrt() <= TOLERANCE {
                break;
            }
        }
        Some(t)
    }
}
