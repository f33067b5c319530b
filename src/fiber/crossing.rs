//! Where a ray crosses a scale's face within one cell.

use super::march::Window;

/// Convergence of a hit, in units of the radius over the ray's radial speed.
const TOLERANCE: f64 = 1e-12;
/// A step this small, in the same units, is the last of Newton's: the next would be about its square.
pub(super) const LAST_STEP: f64 = 1e-8;

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
pub(super) struct Crossing {
    pub(super) sign: f64,
    /// The way through the cell, micrometers.
    pub(super) length: f64,
    /// `1 + E` at both ends.
    pub(super) r0: f64,
    pub(super) r1: f64,
    /// rho^2 and signed f at the start.
    pub(super) rho2: f64,
    pub(super) c: f64,
    /// Coefficients of `rho^2 = rho2 + 2 c1 t + c2 t^2`.
    pub(super) c1: f64,
    pub(super) c2: f64,
}

impl Crossing {
    /// Whether a ray that ends on the side where it started may have been on the other: f by the
    /// chord has two roots in the cell.
    #[inline]
    pub(super) fn may_pair(&self) -> bool {
        let q = self.chord(self.r1 - self.r0);
        q.b < 0.0 && -q.b < q.a && q.b * q.b > q.a * q.c && self.length > 0.0
    }

    /// First crossing, as way from the cell's start, where there is one.
    ///
    /// With E replaced by its chord f is a quadratic with exact values at both ends. Its root starts
    /// the search: E is so nearly linear in a cell that one or two steps do.
    #[inline]
    pub(super) fn first(&self, window: &Window<'_>) -> f64 {
        if self.length <= 0.0 {
            return 0.0;
        }
        let x = self.root(self.chord(self.r1 - self.r0));
        self.newton(window, x * self.length)
            .unwrap_or_else(|| self.chords(window, x) * self.length)
    }

    /// f by x with E replaced by the chord that rises by `rise` over the cell.
    #[inline]
    fn chord(&self, rise: f64) -> Quadratic {
        Quadratic {
            a: self.sign * (self.c2 * self.length * self.length - rise * rise),
            b: self.sign * (self.c1 * self.length - self.r0 * rise),
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

    /// Newton's steps from way `t` to the root of `rho^2 w^2 - (w (1 + E))^2`, which has the sign of f and
    /// is a polynomial. `None` where they do not converge at once: at grazing rays, where f has two
    /// near roots.
    #[inline]
    fn newton(&self, window: &Window<'_>, mut t: f64) -> Option<f64> {
        let ([w0, w1], [s0, s1, s2]) = window.surface();
        let (b, a) = (self.c1, self.c2);
        let mut last = 0.5 * self.length;
        for _ in 0..4 {
            let w = w0 + t * w1;
            let (s, ds) = (s0 + t * (s1 + t * s2), s1 + 2.0 * t * s2);
            let rho2 = self.rho2 + t * (2.0 * b + t * a);
            let f = rho2 * (w * w) - s * s;
            let half_slope = (b + t * a) * (w * w) + rho2 * w * w1 - s * ds;
            let move_by = -0.5 * f / half_slope;
            let next = t + move_by;
            // Written so that NaN fails too.
            if !(self.sign * half_slope < 0.0
                && move_by.abs() <= 0.1 * last
                && (0.0..=self.length).contains(&next))
            {
                return None;
            }
            if move_by * move_by * a <= LAST_STEP * LAST_STEP {
                return Some(next);
            }
            (t, last) = (next, move_by.abs());
        }
        None
    }

    /// Roots of chords from the start to the last estimate: slower, and sure.
    #[cold]
    fn chords(&self, window: &Window<'_>, mut x: f64) -> f64 {
        let radius = |x: f64| {
            let t = x * self.length;
            window.radius(window.across(t), t)
        };
        // A handful for most; where lifted scales twist the strip each wins one digit only.
        for _ in 0..40 {
            if x <= 0.0 {
                break;
            }
            let next = self.root(self.chord((radius(x) - self.r0) / x));
            let moved = (next - x).abs();
            x = next;
            let way = moved * self.length;
            if way * way * self.c2 <= TOLERANCE * TOLERANCE {
                break;
            }
        }
        x
    }
}
