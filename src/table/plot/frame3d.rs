//! A parallel projection with a depth buffer: enough for one shaded surface and some lines.

use super::Area;
use crate::image::Canvas;
use glam::{Mat3, Vec2, Vec3};

/// A view onto the unit ball.
pub(super) struct View {
    /// Rows: right, up, toward the viewer.
    axes: Mat3,
    area: Area,
    center: Vec2,
    scale: f32,
    width: usize,
    depth: Vec<f32>,
}

impl View {
    /// * `toward`: direction from the origin to the viewer; world +Z is up.
    /// * `reach`: half the extent of the world that fits the shorter side of `area`.
    pub(super) fn new(area: Area, toward: Vec3, reach: f32) -> Self {
        let back = toward.normalize();
        let right = Vec3::Z.cross(back).normalize();
        let size = area.size();
        let width = size.x.ceil() as usize;
        Self {
            axes: Mat3::from_cols(right, back.cross(right), back).transpose(),
            area,
            center: area.min + 0.5 * size,
            scale: 0.5 * size.min_element() / reach,
            width,
            depth: vec![f32::NEG_INFINITY; width * size.y.ceil() as usize],
        }
    }

    /// Pixel and depth (larger is nearer) of a point.
    pub(super) fn project(&self, p: Vec3) -> (Vec2, f32) {
        let v = self.axes * p;
        (self.center + self.scale * Vec2::new(v.x, -v.y), v.z)
    }

    /// A normal in view space: z toward the viewer.
    pub(super) fn turn(&self, normal: Vec3) -> Vec3 {
        self.axes * normal
    }

    /// Fills a triangle with colors interpolated between its corners.
    pub(super) fn triangle(&mut self, canvas: &mut Canvas, corners: [(Vec3, Vec3); 3]) {
        let [(a, za), (b, zb), (c, zc)] = corners.map(|(p, _)| self.project(p));
        let area = (b - a).perp_dot(c - a);
        if area.abs() < 1e-9 {
            return;
        }
        let lo = a.min(b).min(c).max(self.area.min);
        let hi = a.max(b).max(c).min(self.area.max - 1.0);
        for y in lo.y.floor() as i64..=hi.y.ceil() as i64 {
            for x in lo.x.floor() as i64..=hi.x.ceil() as i64 {
                let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let wa = (b - p).perp_dot(c - p) / area;
                let wb = (c - p).perp_dot(a - p) / area;
                let wc = 1.0 - wa - wb;
                if wa < 0.0 || wb < 0.0 || wc < 0.0 {
                    continue;
                }
                let color = wa * corners[0].1 + wb * corners[1].1 + wc * corners[2].1;
                self.plot(canvas, x, y, wa * za + wb * zb + wc * zc, color);
            }
        }
    }

    /// A disk of `radius` pixels at a point, hidden by what is nearer.
    pub(super) fn dot(&mut self, canvas: &mut Canvas, p: Vec3, radius: f32, color: Vec3) {
        let (center, z) = self.project(p);
        let r = radius + 0.5;
        for y in (center.y - r).floor() as i64..=(center.y + r).ceil() as i64 {
            for x in (center.x - r).floor() as i64..=(center.x + r).ceil() as i64 {
                let distance = center.distance(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
                if distance < r {
                    self.plot(canvas, x, y, z, color);
                }
            }
        }
    }

    /// A line as a row of dots, hidden by what is nearer.
    pub(super) fn line(&mut self, canvas: &mut Canvas, a: Vec3, b: Vec3, width: f32, color: Vec3) {
        let length = self.project(a).0.distance(self.project(b).0);
        let steps = (2.0 * length / width.max(1.0)).ceil().max(1.0) as usize;
        for i in 0..=steps {
            self.dot(
                canvas,
                a.lerp(b, i as f32 / steps as f32),
                0.5 * width,
                color,
            );
        }
    }

    fn plot(&mut self, canvas: &mut Canvas, x: i64, y: i64, z: f32, color: Vec3) {
        let (column, row) = (x - self.area.min.x as i64, y - self.area.min.y as i64);
        if column < 0 || row < 0 || column as usize >= self.width {
            return;
        }
        let Some(depth) = self
            .depth
            .get_mut(row as usize * self.width + column as usize)
        else {
            return;
        };
        if z >= *depth {
            *depth = z;
            canvas.blend(x, y, color, 1.0);
        }
    }
}
