//! Where a ray crosses a scale's face within one cell.

use super::march::Window;

/// Convergence of a hit, in units of the radius over the ray's radial speed.
const TOLERANCE: f64 = 1e-12;
/// A step this small, in the same units, is the last of the secants: the next would be smaller by
/// the share that the slope is off, a thousandth and less.
const LAST_STEP: f64 = 1e-9;
/// f is known to some roundings of its terms, which are about 1.
const ROUNDING: f64 = 5e-16;

/// `c + 2 b t + a t^2`.
#[derive(Clone, Copy)]
pub(super) struct Quadratic {
    pub(super) a: f64,
    pub(super) b: f64,
    pub(super) c: f64,
}

impl Quadratic {
    #[inline]
    pub(super) fn at(self, t: f64) -> f64 {
        self.c + t * (2.0 * self.b + t * self.a)
    }

    /// The root where it falls, written so that it loses no digits.
    pub(super) fn falling_root(self) -> f64 {
        let root = (self.b * self.b - self.a * self.c).max(0.0).sqrt();
        if self.b <= 0.0 {
            let q = root - self.b;
            if q > 0.0 { self.c / q } else { 0.0 }
        } else {
            -(self.b + root) / self.a
        }
    }

    #[inline]
    /// First time up to `limit` at which a quadratic that starts at `c >= 0` turns negative.
    pub(super) fn turns_negative(self, limit: f64) -> Option<f64> {
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

/// `f = rho^2 - (1 + E)^2` along the ray in one cell; the ray's parameter x runs from 0 to 1 in it.
pub(super) struct Crossing<'a> {
    pub(super) window: &'a Window<'a>,
    pub(super) sign: f64,
    /// The way through the cell, micrometers.
    pub(super) length: f64,
    /// `1 + E` at both ends.
    pub(super) r0: f64,
    pub(super) r1: f64,
    /// rho^2 and signed f at the start.
    pub(super) rho2: f64,
    pub(super) c: f64,
    /// Coefficients of `rho^2 = rho2 + 2 c1 x + c2 x^2`.
    pub(super) c1: f64,
    pub(super) c2: f64,
}

impl Crossing<'_> {
    /// First crossing, as way from the cell's start.
    ///
    /// * `c_end`: rho^2 at the end.
    ///
    /// With E replaced by its chord f is a quadratic with exact values at both ends. Its root starts
    /// the search: E is so nearly linear in a cell that each pass wins many digits.
    #[inline]
    pub(super) fn first(&self, c_end: f64, on_face: bool) -> Option<f64> {
        let odd = self.sign * (c_end - self.r1 * self.r1) < 0.0;
        if !odd && on_face {
            return None;
        }
        if self.length <= 0.0 {
            return odd.then_some(0.0);
        }
        let q = self.chord(self.r1 - self.r0);
        let pair = || q.b < 0.0 && -q.b < q.a && q.b * q.b > q.a * q.c;
        (odd || pair()).then(|| self.length * self.refine(q))
    }

    /// f with E replaced by the chord that rises by `rise` over the cell.
    #[inline]
    fn chord(&self, rise: f64) -> Quadratic {
        Quadratic {
            a: self.sign * (self.c2 - rise * rise),
            b: self.sign * (self.c1 - self.r0 * rise),
            c: self.c,
        }
    }

    #[inline]
    fn root(&self, q: Quadratic) -> f64 {
        let x = if self.c > 0.0 {
            q.falling_root()
        } else if q.b > 0.0 && q.a < 0.0 {
            -2.0 * q.b / q.a
        } else {
            0.0
        };
        x.clamp(0.0, 1.0)
    }

    #[inline]
    fn radius(&self, x: f64) -> f64 {
        let t = x * self.length;
        self.window.radius(self.window.across(t), t)
    }

    /// Signed f.
    #[inline]
    fn at(&self, x: f64) -> f64 {
        let r = self.radius(x);
        self.sign * (self.rho2 + x * (2.0 * self.c1 + x * self.c2) - r * r)
    }

    #[inline]
    fn refine(&self, q: Quadratic) -> f64 {
        let x = self.root(q);
        // The slope of the chord's quadratic serves the first step, secants the others.
        self.secant(x, 2.0 * (q.b + q.a * x))
            .unwrap_or_else(|| self.chords(x))
    }

    /// Secants from `x`, where f has about `slope`. `None` where they do not converge at once: at
    /// grazing rays, where f has two near roots.
    #[inline]
    fn secant(&self, mut x: f64, mut slope: f64) -> Option<f64> {
        let mut f = self.at(x);
        let mut last = 0.5;
        for _ in 0..4 {
            if f.abs() <= ROUNDING {
                return Some(x);
            }
            let move_by = -f / slope;
            let next = x + move_by;
            // Written so that NaN fails too.
            if !(slope < 0.0 && move_by.abs() <= 0.1 * last && (0.0..=1.0).contains(&next)) {
                return None;
            }
            if move_by * move_by * self.c2 <= LAST_STEP * LAST_STEP {
                return Some(next);
            }
            let value = self.at(next);
            slope = (value - f) / (next - x);
            (x, f, last) = (next, value, move_by.abs());
        }
        None
    }

    /// Roots of chords from the start to the last estimate: slower, and sure.
    #[cold]
    fn chords(&self, mut x: f64) -> f64 {
        // A handful for most; where lifted scales twist the strip each wins one digit only.
        for _ in 0..40 {
            if x <= 0.0 {
                break;
            }
            let next = self.root(self.chord((self.radius(x) - self.r0) / x));
            let moved = (next - x).abs();
            x = next;
            if moved * moved * self.c2 <= TOLERANCE * TOLERANCE {
                break;
            }
        }
        x
    }
}
