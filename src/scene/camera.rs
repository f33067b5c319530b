//! A camera that finds its own place in front of the subject: a pinhole, or a thin lens.

use crate::accel::Ray;
use crate::sampling::concentric_disk;
use glam::{DVec3, Mat3, Vec3};
use rayon::prelude::*;

/// How to look at the subject. Angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Direction from which the subject is seen, around +Y; 0 is from +Z, 90 from +X.
    pub yaw_deg: f32,
    /// Height of the camera above the subject's level, as an angle.
    pub pitch_deg: f32,
    /// Field of view along the shorter side of the picture. A long lens flatters animals as it does
    /// people: below 15 the picture is flat, above 50 noses grow.
    pub fov_deg: f32,
    /// 1 frames the subject; 2 shows half of it.
    pub zoom: f32,
    /// Free space around the subject, as a share of the shorter side.
    pub margin: f32,
    /// Shift of the target across and up the picture, as a share of the subject's radius.
    pub shift: [f32; 2],
    /// Diameter of the lens, scene units (millimeters); 0 for a pinhole, which sees all sharp.
    pub lens: f32,
    /// Distance from the camera, along its axis, of the plane that is sharp, scene units; `None` for the
    /// point of the subject that is nearest to the camera.
    pub focus: Option<f32>,
}

impl Default for View {
    fn default() -> Self {
        Self {
            yaw_deg: 35.0,
            pitch_deg: 12.0,
            fov_deg: 28.0,
            zoom: 1.0,
            margin: 0.07,
            shift: [0.0, 0.0],
            lens: 0.0,
            focus: None,
        }
    }
}

impl View {
    /// The default view from a unit direction out of the subject.
    pub fn from_direction(dir: Vec3) -> Self {
        Self {
            yaw_deg: dir.x.atan2(dir.z).to_degrees(),
            pitch_deg: dir.y.clamp(-1.0, 1.0).asin().to_degrees(),
            ..Self::default()
        }
    }
}

/// A camera at its place. Scene units.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    position: Vec3,
    /// Columns: right, up, backward.
    axes: Mat3,
    /// Half the picture at unit distance.
    half: [f32; 2],
    /// Radius of the lens and distance of what is sharp.
    lens: f32,
    focus: f32,
}

impl Camera {
    /// Frames a cloud of points.
    ///
    /// * `points`: what has to be inside the picture by batches, which several threads look at; scene units, finite.
    /// * `aspect`: width over height of the picture.
    pub fn framing<P: Iterator<Item = Vec3>>(
        batches: usize,
        points: impl Fn(usize) -> P + Sync,
        view: &View,
        aspect: f32,
    ) -> Self {
        let (yaw, pitch) = (view.yaw_deg.to_radians(), view.pitch_deg.to_radians());
        let backward = Vec3::new(
            yaw.sin() * pitch.cos(),
            pitch.sin(),
            yaw.cos() * pitch.cos(),
        );
        let right = Vec3::new(yaw.cos(), 0.0, -yaw.sin());
        let axes = Mat3::from_cols(right, backward.cross(right), backward);
        let short = (0.5 * view.fov_deg.to_radians()).tan();
        let half = [short * aspect.max(1.0), short / aspect.min(1.0)];
        let inner = half.map(|h| h * (1.0 - 2.0 * view.margin));
        let (position, radius) = place(batches, &points, axes, inner);
        // Zooming narrows the view rather than walking up to the fur: the perspective stays.
        let half = half.map(|h| h / view.zoom);
        let nearest = || {
            let depth = |p: Vec3| (position - p).dot(backward);
            let nearest = |batch| points(batch).map(depth).reduce(f32::min);
            (0..batches)
                .into_par_iter()
                .filter_map(nearest)
                .reduce_with(f32::min)
        };
        let shift = axes * Vec3::new(view.shift[0], view.shift[1], 0.0) * radius;
        Self {
            position: position + shift,
            axes,
            half,
            lens: 0.5 * view.lens,
            focus: match view.focus {
                Some(focus) => focus.max(1e-3),
                None if view.lens > 0.0 => nearest().unwrap_or(1.0).max(1e-3),
                None => 1.0,
            },
        }
    }

    /// The ray through a point of the picture.
    ///
    /// * `x`, `y`: 0..1 from the left and from the top.
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let film = Vec3::new(
            (2.0 * x - 1.0) * self.half[0],
            (1.0 - 2.0 * y) * self.half[1],
            -1.0,
        );
        Ray {
            origin: self.position,
            dir: (self.axes * film).normalize(),
        }
    }

    /// The ray through a point of the picture and a point of the lens.
    ///
    /// * `x`, `y`: 0..1 from the left and from the top. * `u`: two numbers in `[0, 1)` that choose the point
    ///   of the lens; without effect for a pinhole.
    pub fn ray_through(&self, x: f32, y: f32, u: [f32; 2]) -> Ray {
        let ray = self.ray(x, y);
        if self.lens <= 0.0 {
            return ray;
        }
        // All rays of a point of the picture meet where the one through the middle of the lens meets the
        // sharp plane.
        let along = -ray.dir.dot(self.axes.z_axis);
        let meeting = ray.origin + ray.dir * (self.focus / along);
        let (a, b) = concentric_disk(f64::from(u[0]), f64::from(u[1]));
        let offset = Vec3::new(a as f32, b as f32, 0.0) * self.lens;
        let origin = ray.origin + self.axes * offset;
        Ray {
            origin,
            dir: (meeting - origin).normalize(),
        }
    }

    /// Whether there is a lens, whose points have to be chosen.
    pub fn has_lens(&self) -> bool {
        self.lens > 0.0
    }

    /// Picture coordinates of a point, 0..1 from the left and from the top, if it is in front.
    pub fn project(&self, point: Vec3) -> Option<[f32; 2]> {
        let p = self.axes.transpose() * (point - self.position);
        (p.z < 0.0).then(|| {
            [
                0.5 + 0.5 * p.x / (-p.z * self.half[0]),
                0.5 - 0.5 * p.y / (-p.z * self.half[1]),
            ]
        })
    }

    /// Right, up and backward: unit columns.
    pub fn axes(&self) -> Mat3 {
        self.axes
    }

    /// Half the width and height of the picture at unit distance.
    pub fn half_extent(&self) -> [f32; 2] {
        self.half
    }

    /// Where the camera stands.
    pub fn position(&self) -> Vec3 {
        self.position
    }
}

/// The nearest position from which all points are inside, and the radius of the subject.
///
/// A point at (x, y, z) relative to a target is inside if `|x| <= half (distance - z)`: the bound
/// of all points is a pair of planes each way, and the camera stands where both pairs cross.
fn place<P: Iterator<Item = Vec3>>(
    batches: usize,
    points: &(impl Fn(usize) -> P + Sync),
    axes: Mat3,
    half: [f32; 2],
) -> (Vec3, f32) {
    let sum = |batch| {
        points(batch).fold((DVec3::ZERO, 0.0), |(sum, n), p| {
            (sum + p.as_dvec3(), n + 1.0)
        })
    };
    // Added up in the order of the batches, whatever thread was the first.
    let sums: Vec<(DVec3, f64)> = (0..batches).into_par_iter().map(sum).collect();
    let (sum, n) = sums
        .iter()
        .fold((DVec3::ZERO, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
    if n == 0.0 {
        return (axes.z_axis, 1.0);
    }
    let center = (sum / n).as_vec3();
    let local = axes.transpose();
    // Along each film axis how far points reach beyond a ray of either edge of the frame; radius and front.
    let extremes = |batch| {
        points(batch).fold([f32::MIN; 6], |most, point| {
            let p = local * (point - center);
            let high = [p.x + half[0] * p.z, p.y + half[1] * p.z];
            let low = [-p.x + half[0] * p.z, -p.y + half[1] * p.z];
            farther(most, [high[0], high[1], low[0], low[1], p.length(), p.z])
        })
    };
    let most = (0..batches).into_par_iter().map(extremes);
    let [h0, h1, l0, l1, radius, front] = most.reduce(|| [f32::MIN; 6], farther);
    let (high, low) = ([h0, h1], [l0, l1]);
    let offset = [0, 1].map(|i| 0.5 * (high[i] - low[i]));
    let distance = [0, 1].map(|i| 0.5 * (high[i] + low[i]) / half[i]);
    let radius = radius.max(1e-3);
    let distance = distance[0].max(distance[1]).max(front + 0.1 * radius);
    let local_position = Vec3::new(offset[0], offset[1], distance);
    (center + axes * local_position, radius)
}

fn farther(a: [f32; 6], b: [f32; 6]) -> [f32; 6] {
    std::array::from_fn(|i| a[i].max(b[i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;

    /// In batches of 64.
    fn framing(points: &[Vec3], view: &View, aspect: f32) -> Camera {
        let batches: Vec<&[Vec3]> = points.chunks(64).collect();
        Camera::framing(batches.len(), |b| batches[b].iter().copied(), view, aspect)
    }

    #[test]
    fn the_subject_fills_the_frame_and_stays_inside() {
        let mut rng = Rng::new(5, 0);
        let points: Vec<Vec3> = (0..500)
            .map(|_| Vec3::from_array(std::array::from_fn(|_| rng.uniform_f32())))
            .map(|p| p * Vec3::new(300.0, 50.0, 80.0) + 700.0)
            .collect();
        for aspect in [0.5, 1.0, 2.5] {
            for (yaw_deg, pitch_deg) in [(0.0, 0.0), (35.0, 12.0), (-120.0, 80.0), (180.0, -40.0)] {
                let view = View {
                    yaw_deg,
                    pitch_deg,
                    ..View::default()
                };
                let camera = framing(&points, &view, aspect);
                let (mut lo, mut hi) = ([1.0f32; 2], [0.0f32; 2]);
                for p in &points {
                    let at = camera.project(*p).unwrap();
                    for i in 0..2 {
                        lo[i] = lo[i].min(at[i]);
                        hi[i] = hi[i].max(at[i]);
                    }
                }
                let margin = view.margin - 1e-3;
                assert!(lo[0] >= margin && lo[1] >= margin);
                assert!(hi[0] <= 1.0 - margin && hi[1] <= 1.0 - margin);
                let fill = (hi[0] - lo[0]).max(hi[1] - lo[1]);
                assert!(fill > 1.0 - 2.0 * view.margin - 1e-3, "{fill}");
            }
        }
    }

    #[test]
    fn a_lens_is_sharp_at_its_focus_only() {
        let points = [Vec3::ZERO, Vec3::ONE];
        let view = View {
            lens: 0.5,
            focus: Some(3.0),
            ..View::default()
        };
        let camera = framing(&points, &view, 1.5);
        let middle = camera.ray(0.3, 0.6);
        let sharp = middle.origin + middle.dir * (3.0 / -middle.dir.dot(camera.axes.z_axis));
        let mut spread = 0.0f32;
        for i in 0..64 {
            let u = [(i % 8) as f32 / 8.0, (i / 8) as f32 / 8.0];
            let ray = camera.ray_through(0.3, 0.6, u);
            let from = ray.origin - camera.position;
            assert!(from.length() < 0.2501 && from.dot(camera.axes.z_axis).abs() < 1e-5);
            assert!((sharp - ray.origin).cross(ray.dir).length() < 1e-4);
            let beyond = 2.0 * sharp - camera.position;
            spread = spread.max((beyond - ray.origin).cross(ray.dir).length());
        }
        assert!(spread > 0.2, "{spread}");
        // The nearest point of the subject is sharp if nothing is said, and a pinhole has no lens.
        let camera = framing(
            &points,
            &View {
                focus: None,
                ..view
            },
            1.5,
        );
        let nearest = (points.iter())
            .map(|p| (camera.position - *p).dot(camera.axes.z_axis))
            .fold(f32::MAX, f32::min);
        assert!((camera.focus - nearest).abs() < 1e-4);
        let pinhole = framing(&points, &View::default(), 1.5);
        assert!(
            !pinhole.has_lens()
                && pinhole.ray_through(0.1, 0.1, [0.9; 2]).origin == pinhole.position
        );
    }

    #[test]
    fn rays_go_where_points_project() {
        let camera = framing(&[Vec3::ZERO, Vec3::ONE], &View::default(), 1.5);
        for (x, y) in [(0.5, 0.5), (0.1, 0.9), (0.99, 0.3)] {
            let ray = camera.ray(x, y);
            let at = camera.project(ray.origin + 3.0 * ray.dir).unwrap();
            assert!((at[0] - x).abs() < 1e-5 && (at[1] - y).abs() < 1e-5);
        }
    }

    #[test]
    fn a_single_point_is_framed() {
        let camera = framing(&[Vec3::ONE; 3], &View::default(), 1.0);
        assert!(camera.project(Vec3::ONE).is_some());
    }
}
