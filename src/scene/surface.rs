//! The skin under the fur: triangles that scatter like matte paint.

use super::SceneError;
use super::strands::UNITS_PER_METER;
use crate::accel::{Accel, Ray};
use crate::color::Rgb;
use crate::math::shear::Shear;
use crate::skin::Skin;
use glam::Vec3;

/// Triangles ready for tracing, in traversal order.
pub struct Surface {
    corners: Vec<[Vec3; 3]>,
    normals: Vec<[Vec3; 3]>,
    /// Diffuse reflectance at the corners.
    colors: Vec<[Rgb; 3]>,
    accel: Accel,
}

/// A point of a matte surface met by a ray.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceHit {
    /// Distance along the ray, millimeters.
    pub t: f32,
    /// Unit geometric normal, on the side the ray came from.
    pub facing: Vec3,
    /// Unit shading normal, on the same side.
    pub normal: Vec3,
    /// Diffuse reflectance.
    pub color: Rgb,
}

impl Surface {
    /// * `color`: linear reflectance 0..1 of each vertex.
    ///
    /// # Errors
    /// A skin whose arrays do not fit together, or too many triangles.
    pub fn build(skin: &Skin, color: impl Fn(usize) -> Rgb) -> Result<Self, SceneError> {
        let bad = skin.normals.len() != skin.positions.len()
            || skin.color.len() != skin.positions.len()
            || (skin.triangles.iter().flatten()).any(|&i| i as usize >= skin.positions.len());
        if bad {
            return Err(SceneError::Skin {
                vertices: skin.positions.len(),
            });
        }
        let pick =
            |values: &[Vec3], t: &[u32; 3], scale: f32| t.map(|i| values[i as usize] * scale);
        // Triangles without area cannot be seen and would only crowd the tree.
        let solid: Vec<&[u32; 3]> = (skin.triangles.iter())
            .filter(|t| {
                let [a, b, c] = pick(&skin.positions, t, UNITS_PER_METER);
                (b - a).cross(c - a).length_squared() > 0.0 || !(a + b + c).is_finite()
            })
            .collect();
        let boxes: Vec<(Vec3, Vec3)> = solid
            .iter()
            .map(|t| pick(&skin.positions, t, UNITS_PER_METER))
            .map(|[a, b, c]| (a.min(b).min(c), a.max(b).max(c)))
            .collect();
        let accel = Accel::build(&boxes)?;
        let sorted = || accel.order().iter().map(|&i| solid[i as usize]);
        Ok(Self {
            corners: sorted()
                .map(|t| pick(&skin.positions, t, UNITS_PER_METER))
                .collect(),
            normals: sorted().map(|t| pick(&skin.normals, t, 1.0)).collect(),
            colors: sorted().map(|t| t.map(|i| color(i as usize))).collect(),
            accel,
        })
    }

    /// Corners of all triangles, millimeters.
    pub fn corners(&self) -> &[[Vec3; 3]] {
        &self.corners
    }

    /// The nearest point in front of `limit`.
    pub fn closest(&self, ray: &Ray, limit: f32) -> Option<SurfaceHit> {
        let shear = Shear::new(ray.dir);
        let (prim, t) = self.accel.closest(ray, limit, |prim, best| {
            let (t, _) = shear.intersect(ray.origin, &self.corners[prim])?;
            (t > 0.0 && t <= best).then_some(t)
        })?;
        let [a, b, c] = self.corners[prim];
        let (_, [u, v, w]) = shear.intersect(ray.origin, &self.corners[prim])?;
        let flat = (b - a).cross(c - a).normalize_or(-ray.dir);
        let facing = if flat.dot(ray.dir) > 0.0 { -flat } else { flat };
        let [na, nb, nc] = self.normals[prim];
        let [ca, cb, cc] = self.colors[prim];
        let smooth = (u * na + v * nb + w * nc).normalize_or(facing);
        let normal = if smooth.dot(facing) < 0.0 {
            -smooth
        } else {
            smooth
        };
        Some(SurfaceHit {
            t,
            facing,
            normal,
            color: u * ca + v * cb + w * cc,
        })
    }

    /// Whether any triangle lies in front of `limit`.
    pub fn occluded(&self, ray: &Ray, limit: f32) -> bool {
        let shear = Shear::new(ray.dir);
        self.accel.any(ray, limit, |prim, best| {
            shear
                .intersect(ray.origin, &self.corners[prim])
                .is_some_and(|(t, _)| t > 0.0 && t < best)
        })
    }
}
