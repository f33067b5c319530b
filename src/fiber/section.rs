//! The cross-section and the affine frame in which its ellipse is the unit circle.

use super::FiberError;
use super::outline::Outline;
use crate::species::Structure;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// The ellipse of the section's area and aspect. Dividing x and y by its semi-axes makes it the unit
/// circle: rays stay straight and keep their parameter, so everything is traced there. Other shapes
/// are a radius about 1 in that frame.
#[derive(Clone, Debug)]
pub(super) struct Section {
    /// Semi-axis along x, the major one, micrometers.
    pub(super) a: f64,
    /// Semi-axis along y, micrometers.
    pub(super) b: f64,
    pub(super) inverse: [f64; 2],
    /// `None` for the ellipse itself.
    outline: Option<Outline>,
}

/// A ray in the unit-circle frame: x and y in units of the semi-axes, z and t in micrometers.
#[derive(Clone, Copy, Debug)]
pub(super) struct UnitRay {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) z: f64,
    pub(super) dx: f64,
    pub(super) dy: f64,
    pub(super) dz: f64,
    /// Coefficients of `rho^2 = c + 2 b t + a t^2`, and the inverse of a.
    pub(super) a: f64,
    pub(super) b: f64,
    pub(super) c: f64,
    inverse_a: f64,
}

/// A line on the surface along which the scale heights are given: an axial half plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// Cosine and sine of the half plane's angle in the unit-circle frame.
    pub(super) cos: f64,
    pub(super) sin: f64,
    /// Radius of the section here, in units of the ellipse's.
    pub(super) rho: f64,
    /// Position round the fiber by arc length, 0..1.
    pub(super) turn: f64,
    /// What a step outward by one radius of the ellipse is along the normal, micrometers: a height
    /// over it is the height along the normal, so that scales are equally high all round a flat fiber.
    pub(super) support_um: f64,
}

impl Section {
    /// The section of a structure.
    ///
    /// # Errors
    /// A shape that folds over itself.
    pub(super) fn of(structure: &Structure) -> Result<Self, FiberError> {
        Ok(Self {
            outline: Outline::new(structure.section, structure.aspect)?,
            ..Self::new(structure.diameter_um, structure.aspect)
        })
    }

    /// An ellipse.
    ///
    /// * `diameter_um`: geometric mean of the axes; `aspect`: major over minor axis.
    pub(super) fn new(diameter_um: f64, aspect: f64) -> Self {
        let radius = 0.5 * diameter_um;
        let (a, b) = (radius * aspect.sqrt(), radius / aspect.sqrt());
        Self {
            a,
            b,
            inverse: [1.0 / a, 1.0 / b],
            outline: None,
        }
    }

    /// The ray in the unit-circle frame.
    #[inline]
    pub(super) fn unit_ray(&self, origin: DVec3, dir: DVec3) -> UnitRay {
        let [ia, ib] = self.inverse;
        let (x, y) = (origin.x * ia, origin.y * ib);
        let (dx, dy) = (dir.x * ia, dir.y * ib);
        let a = dx * dx + dy * dy;
        UnitRay {
            x,
            y,
            z: origin.z,
            dx,
            dy,
            dz: dir.z,
            a,
            b: x * dx + y * dy,
            c: x * x + y * y,
            inverse_a: 1.0 / a,
        }
    }

    /// A point in the unit-circle frame.
    #[inline]
    pub(super) fn unit_point(&self, p: DVec3) -> DVec3 {
        DVec3::new(p.x * self.inverse[0], p.y * self.inverse[1], p.z)
    }

    /// The gradient in the unit-circle frame that belongs to one in micrometers.
    #[inline]
    pub(super) fn unit_gradient(&self, gradient: DVec3) -> DVec3 {
        DVec3::new(gradient.x * self.a, gradient.y * self.b, gradient.z)
    }

    /// The unit normal that belongs to a gradient in the unit-circle frame, turned against `dir`.
    #[inline]
    pub(super) fn normal_against(&self, gradient: DVec3, dir: DVec3) -> DVec3 {
        let [ia, ib] = self.inverse;
        let n = DVec3::new(gradient.x * ia, gradient.y * ib, gradient.z);
        let n = n * (1.0 / n.length());
        if n.dot(dir) > 0.0 { -n } else { n }
    }

    /// Whether it is an ellipse.
    pub(super) fn is_ellipse(&self) -> bool {
        self.outline.is_none()
    }

    /// Whether it is a circle.
    pub(super) fn is_circle(&self) -> bool {
        self.is_ellipse() && self.a == self.b
    }

    /// Radius of the section at an angle of the unit-circle frame, in units of the ellipse's.
    pub(super) fn rho(&self, psi: f64) -> f64 {
        self.outline.as_ref().map_or(1.0, |o| o.at(psi))
    }

    /// Least radius of the section, in units of the ellipse's.
    pub(super) fn rho_min(&self) -> f64 {
        self.radii().into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Radii evenly round the outline; one of them for an ellipse.
    pub(super) fn radii(&self) -> Vec<f64> {
        const COUNT: u32 = 256;
        let at = |i: u32| self.rho(TAU * f64::from(i) / f64::from(COUNT));
        if self.is_ellipse() {
            vec![1.0]
        } else {
            (0..COUNT).map(at).collect()
        }
    }

    /// Half the extent along x and y, micrometers.
    pub(super) fn half_extents(&self) -> [f64; 2] {
        let Some(outline) = &self.outline else {
            return [self.a, self.b];
        };
        let points = (0..4096).map(|i| {
            let psi = TAU * f64::from(i) / 4096.0;
            outline.at(psi) * DVec2::new(self.a * psi.cos(), self.b * psi.sin())
        });
        let (low, high) = points.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), p| {
            (l.min(p), h.max(p))
        });
        (0.5 * (high - low)).to_array()
    }

    /// Change of the position per radian of the unit-circle frame, micrometers.
    fn tangent(&self, psi: f64) -> DVec2 {
        let along = |psi: f64| DVec2::new(-self.a * psi.sin(), self.b * psi.cos());
        let Some(outline) = &self.outline else {
            return along(psi);
        };
        let out = DVec2::new(self.a * psi.cos(), self.b * psi.sin());
        let step = 2e-3;
        let change = (outline.at(psi + step) - outline.at(psi - step)) / (2.0 * step);
        outline.at(psi) * along(psi) + change * out
    }

    /// Arc length per radian of the unit-circle frame, micrometers.
    fn speed(&self, psi: f64) -> f64 {
        self.tangent(psi).length()
    }

    /// Circumference, micrometers. The trapezoid rule converges geometrically for a period.
    pub(super) fn circumference(&self) -> f64 {
        let n = 4096;
        let sum: f64 = (0..n)
            .map(|i| self.speed(TAU * f64::from(i) / f64::from(n)))
            .sum();
        sum * TAU / f64::from(n)
    }

    /// `count` lines equally spaced by arc length.
    pub(super) fn lines(&self, count: usize) -> Vec<Line> {
        let fine = 16 * count;
        let step = TAU / fine as f64;
        let total = self.circumference();
        let mut lines = Vec::with_capacity(count);
        let mut arc = 0.0;
        for i in 0..fine {
            // Midpoint rule per step; lines fall where the running arc length passes their share.
            let ds = self.speed((i as f64 + 0.5) * step) * step;
            while lines.len() < count && total * lines.len() as f64 / count as f64 <= arc + ds {
                let target = total * lines.len() as f64 / count as f64;
                let psi = (i as f64 + ((target - arc) / ds).clamp(0.0, 1.0)) * step;
                lines.push(self.line(psi, lines.len() as f64 / count as f64));
            }
            arc += ds;
        }
        lines
    }

    fn line(&self, psi: f64, turn: f64) -> Line {
        let (sin, cos) = psi.sin_cos();
        let tangent = self.tangent(psi);
        let out = DVec2::new(self.a * cos, self.b * sin);
        Line {
            cos,
            sin,
            rho: self.rho(psi),
            turn,
            support_um: out.perp_dot(tangent) / tangent.length(),
        }
    }
}

impl UnitRay {
    /// Where the ray's line is inside the circle of radius `r`: `(enter, leave)`. An axial ray inside
    /// stays for ever.
    #[inline]
    pub(super) fn inside_circle(&self, r: f64) -> Option<(f64, f64)> {
        let (a, b, c) = (self.a, self.b, self.c - r * r);
        if a < 1e-30 {
            return (c < 0.0).then_some((f64::NEG_INFINITY, f64::INFINITY));
        }
        let discriminant = b * b - a * c;
        if discriminant <= 0.0 {
            return None;
        }
        let root = discriminant.sqrt();
        // The sum of equal signs loses no digits; the other root follows from their product.
        Some(if b > 0.0 {
            let q = -b - root;
            (q * self.inverse_a, c / q)
        } else {
            let q = root - b;
            (c / q, q * self.inverse_a)
        })
    }

    /// The same ray from its point at `t` on.
    pub(super) fn from(&self, t: f64) -> Self {
        let p = self.at(t);
        Self {
            x: p.x,
            y: p.y,
            z: p.z,
            b: self.b + t * self.a,
            c: p.x * p.x + p.y * p.y,
            ..*self
        }
    }

    /// The point at `t`.
    #[inline]
    pub(super) fn at(&self, t: f64) -> DVec3 {
        DVec3::new(
            self.x + t * self.dx,
            self.y + t * self.dy,
            self.z + t * self.dz,
        )
    }
}

/// `floor` in two instructions: the one of the standard library is a call on older processors.
#[inline]
pub(super) fn floor(x: f64) -> f64 {
    let whole = x as i64 as f64;
    if whole > x { whole - 1.0 } else { whole }
}

/// The smaller one in one instruction, as neither is NaN.
#[inline]
pub(super) fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger one likewise.
#[inline]
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The multiple of `period` that brings `z` nearest to it: `period * round(z / period)`.
#[inline]
pub(super) fn nearest_period(z: f64, period: f64) -> f64 {
    period * floor(z / period + 0.5)
}

/// The periodic image of a point that is nearest to `z`.
#[inline]
pub(super) fn nearest_image(point: DVec3, z: f64, period: f64) -> DVec3 {
    point.with_z(point.z + nearest_period(z - point.z, period))
}
