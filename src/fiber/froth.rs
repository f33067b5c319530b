//! The froth: spheres of air that do not touch, found through a uniform grid of cells.

use super::grid::Grid;
use super::packing;
use super::section::nearest_image;
use glam::DVec3;

/// A spherical void, micrometers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sphere {
    pub(super) center: DVec3,
    pub(super) radius: f64,
}

/// The spheres of one period.
#[derive(Clone, Debug)]
pub(super) struct Froth {
    pub(super) period: f64,
    pub(super) spheres: Vec<Sphere>,
    grid: Grid,
}

impl Froth {
    /// Sorts spheres into cells.
    ///
    /// * `half`: semi-axes of the medulla, micrometers.
    pub(super) fn new(spheres: Vec<Sphere>, period: f64, half: [f64; 2]) -> Self {
        let mean = spheres.iter().map(|s| s.radius).sum::<f64>() / spheres.len().max(1) as f64;
        let boxes: Vec<(DVec3, DVec3)> = spheres
            .iter()
            .map(|s| (s.center - s.radius, s.center + s.radius))
            .collect();
        // About one sphere a cell.
        let size = DVec3::splat(2.0 * mean.max(0.25));
        let grid = Grid::new(half, period, size, &boxes, |index, lo, hi| {
            let Sphere { center, radius } = spheres[index];
            center.clamp(lo, hi).distance_squared(center) <= radius * radius * (1.0 + 1e-9)
        });
        Self {
            period,
            spheres,
            grid,
        }
    }

    /// Center of the image of a sphere that is nearest in z.
    pub(super) fn center_near(&self, index: u32, z: f64) -> DVec3 {
        nearest_image(self.spheres[index as usize].center, z, self.period)
    }

    /// First sphere that the ray enters in `t0..t1`: time and index.
    ///
    /// * `from`: the sphere that the ray starts on, leaving it.
    pub(super) fn enter(
        &self,
        origin: DVec3,
        dir: DVec3,
        t0: f64,
        t1: f64,
        from: Option<u32>,
    ) -> Option<(f64, u32)> {
        self.grid.walk(origin, dir, t0, t1, |members, z| {
            let mut best: Option<(f64, u32)> = None;
            for &index in members {
                let center = self.center_near(index, z);
                let radius = self.spheres[index as usize].radius;
                let Some(t) = enter_sphere(origin, dir, center, radius) else {
                    continue;
                };
                let on_it = from == Some(index)
                    && (origin - center).length_squared() <= radius * radius * (1.0 + 1e-6);
                if t >= t0 && t < t1 && !on_it && best.is_none_or(|(b, _)| t < b) {
                    best = Some((t, index));
                }
            }
            best
        })
    }

    /// Where a ray that starts on or in a sphere leaves it.
    pub(super) fn leave(&self, origin: DVec3, dir: DVec3, index: u32, on_it: bool) -> f64 {
        let to = origin - self.center_near(index, origin.z);
        let b = to.dot(dir);
        if on_it {
            // The root at the start is known; the other is the chord.
            return (-2.0 * b).max(0.0);
        }
        let r = self.spheres[index as usize].radius;
        (-b + (b * b - to.length_squared() + r * r).max(0.0).sqrt()).max(0.0)
    }

    /// The sphere that holds a point.
    pub(super) fn at(&self, p: DVec3) -> Option<u32> {
        self.grid.around(p).iter().copied().find(|&index| {
            let r = self.spheres[index as usize].radius;
            p.distance_squared(self.center_near(index, p.z)) < r * r
        })
    }

    /// Volume of the spheres, cubic micrometers a period.
    pub(super) fn volume(&self) -> f64 {
        packing::volume(&self.spheres)
    }
}

/// Where a ray from outside enters a sphere.
fn enter_sphere(origin: DVec3, dir: DVec3, center: DVec3, radius: f64) -> Option<f64> {
    let to = origin - center;
    let b = to.dot(dir);
    if b >= 0.0 {
        return None;
    }
    // The distance of the center from the ray by its vector keeps the digits that b^2 - c loses.
    let miss = (to - b * dir).length_squared();
    let h = radius * radius - miss;
    (h > 0.0).then(|| -b - h.sqrt())
}
