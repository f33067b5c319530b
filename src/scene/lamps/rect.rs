//! Rectangular lamps. Directions are drawn evenly by solid angle. After Ureña et al. 2013, Urena13 in REFERENCES.md.

use glam::DVec3;
use std::f64::consts::TAU;

/// A rectangle that shines to one side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rect {
    /// Its middle.
    pub(super) center: DVec3,
    /// Unit: along its width, its height, and to the side that shines.
    pub(super) axes: [DVec3; 3],
    /// Half its width and height.
    pub(super) half: [f64; 2],
}

/// Below this solid angle sums of angles are all rounding: such a lamp gives no light.
const SMALLEST: f64 = 1e-11;

/// A rectangle as it is seen from a point, projected onto the unit sphere.
#[derive(Clone, Copy, Debug)]
pub(super) struct SphericalRect {
    axes: [DVec3; 3],
    /// Edges in the frame of the axes, and the distance of its plane.
    x: [f64; 2],
    y: [f64; 2],
    z: f64,
    /// z of the normals of the planes through the lower and the upper edge.
    b: [f64; 2],
    /// What the angles at the left edge leave of a full turn.
    k: f64,
    solid_angle: f64,
}

impl Rect {
    /// How it looks from a point; `None` from behind and from too far away.
    pub(super) fn seen_from(&self, point: DVec3) -> Option<SphericalRect> {
        let d = self.center - point;
        // The frame looks away from the point.
        let axes = [self.axes[0], self.axes[1], -self.axes[2]];
        let [cx, cy, z] = axes.map(|a| d.dot(a));
        if z <= 0.0 {
            return None;
        }
        let x = [cx - self.half[0], cx + self.half[0]];
        let y = [cy - self.half[1], cy + self.half[1]];
        // Inward normals of the planes through the point and the edges: lower, right, upper, left.
        let lower = DVec3::new(0.0, z, -y[0]).normalize();
        let right = DVec3::new(-z, 0.0, x[1]).normalize();
        let upper = DVec3::new(0.0, -z, y[1]).normalize();
        let left = DVec3::new(z, 0.0, -x[0]).normalize();
        let angle = |a: DVec3, b: DVec3| (-a.dot(b)).clamp(-1.0, 1.0).acos();
        let k = TAU - angle(upper, left) - angle(left, lower);
        let solid_angle = angle(lower, right) + angle(right, upper) - k;
        (solid_angle > SMALLEST).then_some(SphericalRect {
            axes,
            x,
            y,
            z,
            b: [lower.z, upper.z],
            k,
            solid_angle,
        })
    }

    /// Distance along a ray to the side that shines.
    pub(super) fn hit(&self, origin: DVec3, dir: DVec3) -> Option<f64> {
        let along = -dir.dot(self.axes[2]);
        let t = (origin - self.center).dot(self.axes[2]) / along;
        if !(along > 0.0 && t > 0.0) {
            return None;
        }
        let p = origin + t * dir - self.center;
        let inside = |i: usize| p.dot(self.axes[i]).abs() <= self.half[i];
        (inside(0) && inside(1)).then_some(t)
    }

    /// Irradiance of radiance 1 on a plane through a point, with what is below its horizon cut off: Lambert's
    /// formula for polygons.
    ///
    /// * `normal`: unit, of the plane.
    pub(super) fn irradiance(&self, point: DVec3, normal: DVec3) -> f64 {
        if (point - self.center).dot(self.axes[2]) <= 0.0 {
            return 0.0;
        }
        let corner = |sx: f64, sy: f64| {
            let (x, y) = (self.axes[0] * self.half[0], self.axes[1] * self.half[1]);
            self.center + sx * x + sy * y - point
        };
        let corners = [
            corner(-1.0, -1.0),
            corner(1.0, -1.0),
            corner(1.0, 1.0),
            corner(-1.0, 1.0),
        ];
        // Cut at the horizon: a convex polygon of at most five corners.
        let (mut above, mut n) = ([DVec3::ZERO; 5], 0);
        for (i, a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % 4];
            let (ha, hb) = (a.dot(normal), b.dot(normal));
            if ha >= 0.0 {
                above[n] = *a;
                n += 1;
            }
            if (ha >= 0.0) != (hb >= 0.0) {
                above[n] = *a + (b - *a) * (ha / (ha - hb));
                n += 1;
            }
        }
        let edge = |i: usize| {
            let (a, b) = (above[i], above[(i + 1) % n]);
            let across = a.cross(b);
            // The angle between the corners, without loss where it is small.
            let angle = across.length().atan2(a.dot(b));
            across.normalize_or_zero().dot(normal) * angle
        };
        (0.5 * (0..n).map(edge).sum::<f64>()).abs()
    }
}

impl SphericalRect {
    /// Steradians.
    pub(super) fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// A point of the rectangle, relative to where it is seen from, from two numbers in `[0, 1)`, evenly by
    /// solid angle.
    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        let angle = u[0] * self.solid_angle + self.k;
        let f = (angle.cos() * self.b[0] - self.b[1]) / angle.sin();
        let cos = (1.0 / (f * f + self.b[0] * self.b[0]).sqrt()).copysign(f);
        let cos = cos.clamp(-1.0, 1.0);
        let x = cos * self.z / (1.0 - cos * cos).sqrt().max(f64::MIN_POSITIVE);
        let x = x.clamp(self.x[0], self.x[1]);
        let d = x.hypot(self.z);
        let h = self.y.map(|y| y / d.hypot(y));
        let h = h[0] + u[1] * (h[1] - h[0]);
        let y = h * d / (1.0 - h * h).sqrt().max(f64::MIN_POSITIVE);
        let y = y.clamp(self.y[0], self.y[1]);
        self.axes[0] * x + self.axes[1] * y + self.axes[2] * self.z
    }
}
