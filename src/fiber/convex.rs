//! Convex bodies: what some half-spaces and quadrics have in common.

use glam::{DMat3, DVec3};

/// The half-space `normal . p <= offset`, seen from a body's center.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) normal: DVec3,
    pub(super) offset: f64,
}

/// The points with `|map (p - center)| <= 1`, seen from a body's center: a ball, an ellipsoid, or a
/// cylinder where the map forgets a direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quadric {
    pub(super) center: DVec3,
    pub(super) map: DMat3,
}

/// A convex body to be put into the store. At least one face on every side, or it has no end.
#[derive(Clone, Debug, Default)]
pub(super) struct Convex {
    pub(super) center: DVec3,
    /// Half-widths of a box about the center that holds it.
    pub(super) half: DVec3,
    pub(super) planes: Vec<Plane>,
    pub(super) quadrics: Vec<Quadric>,
    /// Keratin inside a void; it touches neither the void's boundary nor another island.
    pub(super) island: bool,
}

impl Quadric {
    /// An ellipsoid with these semi-axes along the frame's; an infinite one makes a cylinder.
    pub(super) fn ellipsoid(center: DVec3, semi: DVec3) -> Self {
        Self {
            center,
            map: DMat3::from_diagonal(1.0 / semi),
        }
    }
}

/// Whether a point seen from a body's center is inside.
pub(super) fn holds(p: DVec3, planes: &[Plane], quadrics: &[Quadric]) -> bool {
    planes.iter().all(|f| f.normal.dot(p) < f.offset)
        && quadrics
            .iter()
            .all(|q| (q.map * (p - q.center)).length_squared() < 1.0)
}

impl Quadric {
    /// No less than the square of the largest semi-axis, by a few percent; infinite for a cylinder.
    fn reach2(&self) -> f64 {
        // The largest eigenvalue is at most the root of the trace of a power.
        let inverse = self.map.inverse();
        let mut power = inverse.transpose() * inverse;
        if !power.is_finite() {
            return f64::INFINITY;
        }
        for _ in 0..4 {
            power = power * power;
        }
        let trace = power.x_axis.x + power.y_axis.y + power.z_axis.z;
        trace.powf(1.0 / 16.0)
    }

    /// Where a ray is inside; `on` if it starts on the surface.
    #[inline(always)]
    pub(super) fn inside(&self, o: DVec3, dir: DVec3, on: bool) -> Option<(f64, f64)> {
        let (q, e) = (self.map * (o - self.center), self.map * dir);
        let (a, b) = (e.length_squared(), q.dot(e));
        if on {
            // A ray along a cylinder that it starts on stays on it.
            let other = if a > 1e-30 {
                -2.0 * b / a
            } else {
                f64::INFINITY
            };
            return Some((other.min(0.0), other.max(0.0)));
        }
        if a < 1e-30 {
            return (q.length_squared() < 1.0).then_some((f64::NEG_INFINITY, f64::INFINITY));
        }
        // The foot of the center on the ray keeps the digits that b^2 - a c loses.
        let foot = -b / a;
        let miss = 1.0 - (q + foot * e).length_squared();
        (miss > 0.0).then(|| {
            let half = (miss / a).sqrt();
            (foot - half, foot + half)
        })
    }
}

impl Convex {
    /// Square of the radius of a ball about the center that holds it: of its box, or of an ellipsoid
    /// about the center where that is smaller.
    pub(super) fn reach2(&self) -> f64 {
        let centered = self.quadrics.iter().filter(|q| q.center == DVec3::ZERO);
        centered.fold(self.half.length_squared(), |least, q| least.min(q.reach2()))
    }

    /// Whether it may reach into a box: not if the box lies beyond one of its planes.
    pub(super) fn may_touch(&self, lo: DVec3, hi: DVec3) -> bool {
        let (middle, half) = (0.5 * (lo + hi) - self.center, 0.5 * (hi - lo));
        self.planes
            .iter()
            .all(|f| f.normal.dot(middle) - f.normal.abs().dot(half) <= f.offset + 1e-9)
    }
}
