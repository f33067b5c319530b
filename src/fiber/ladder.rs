//! The uniserial ladder: a stack of puck-shaped voids, one a rung.

use super::section::{UnitRay, floor, nearest_period};
use crate::sampling::Rng;
use glam::DVec3;

/// One void: `(rho / radius)^4 + ((z - center) / half)^4 <= 1`, a superellipsoid of exponent 4.
#[derive(Clone, Copy, Debug)]
pub(super) struct Puck {
    pub(super) center: f64,
    pub(super) half: f64,
    /// Across, in units of the section's semi-axes.
    pub(super) radius: f64,
}

/// The pucks of one period in order of z; they never touch.
#[derive(Clone, Debug)]
pub(super) struct Ladder {
    pub(super) period: f64,
    pub(super) pucks: Vec<Puck>,
    widest: f64,
}

/// Level at which a root counts as found: some roundings of its terms, 1e-13 of the size in place.
const CONVERGED: f64 = 1e-14;
/// Share of the medulla's radius that a void takes; the rest is its tube's wall.
const WIDTH: f64 = 0.92;

impl Ladder {
    /// * `ratio`: radius of the medulla in units of the semi-axes.
    /// * `count`: rungs in a period.
    pub(super) fn new(ratio: f64, period: f64, count: usize, septum_um: f64, seed: u64) -> Self {
        let pitch = period / count as f64;
        // Walls are as thick as asked in the mean; a thin neighbor of a shifted void keeps a third.
        let half = 0.5 * (pitch - septum_um);
        let mut pucks: Vec<Puck> = (0..count)
            .map(|k| {
                let mut rng = Rng::new(seed ^ 0x1add_e700, k as u64);
                let shift = 0.12 * pitch * (2.0 * rng.uniform() - 1.0);
                let breadth = 1.0 + 0.06 * (2.0 * rng.uniform() - 1.0);
                Puck {
                    center: pitch * (k as f64 + 0.5) + shift,
                    half,
                    radius: WIDTH * ratio * breadth,
                }
            })
            .collect();
        let centers: Vec<f64> = pucks.iter().map(|p| p.center).collect();
        for k in 0..count {
            let next = if k + 1 < count {
                centers[k + 1]
            } else {
                centers[0] + period
            };
            let most = 0.5 * (next - centers[k] - septum_um / 3.0);
            let other = (k + 1) % count;
            pucks[k].half = pucks[k].half.min(most);
            pucks[other].half = pucks[other].half.min(most);
        }
        let widest = pucks.iter().fold(0.0f64, |w, p| w.max(p.radius));
        Self {
            period,
            pucks,
            widest,
        }
    }

    /// Rung `k` of the endless ladder: its puck's index and the z of its center.
    fn rung(&self, k: i64) -> (u32, f64) {
        let n = self.pucks.len() as i64;
        let index = k.rem_euclid(n) as u32;
        let image = k.div_euclid(n) as f64;
        (index, self.puck(index).center + image * self.period)
    }

    /// The puck of a rung.
    pub(super) fn puck(&self, index: u32) -> Puck {
        self.pucks[index as usize]
    }

    /// z of the center of the image of a puck that is nearest to `z`.
    pub(super) fn center_near(&self, index: u32, z: f64) -> f64 {
        let center = self.puck(index).center;
        center + nearest_period(z - center, self.period)
    }

    /// First void that the ray enters in `t0..t1`: time and index.
    ///
    /// * `from`: the void that it leaves, which it cannot meet again.
    pub(super) fn enter(
        &self,
        ray: &UnitRay,
        t0: f64,
        t1: f64,
        from: Option<u32>,
    ) -> Option<(f64, u32)> {
        let (a, b) = ray.inside_circle(self.widest)?;
        let (t0, t1) = (t0.max(a), t1.min(b));
        if t0 >= t1 {
            return None;
        }
        let pitch = self.period / self.pucks.len() as f64;
        let step = if ray.dz < 0.0 { -1 } else { 1 };
        let z0 = ray.z + t0 * ray.dz;
        let mut k = match from {
            // Slabs of pucks are apart: behind the one just left there is none.
            Some(index) => {
                let image =
                    (self.center_near(index, ray.z) - self.puck(index).center) / self.period;
                i64::from(index) + image.round() as i64 * self.pucks.len() as i64 + step
            }
            None => floor(z0 / pitch) as i64 - step,
        };
        let z1 = ray.z + t1 * ray.dz;
        loop {
            let (index, center) = self.rung(k);
            let puck = self.puck(index);
            let forward = step as f64;
            if (center - z1) * forward > puck.half {
                return None;
            }
            if (z0 - center) * forward <= puck.half
                && let Some(t) = puck.enter(ray, center, (a, b), (t0, t1))
            {
                return Some((t, index));
            }
            k += step;
        }
    }

    /// Where a ray that is in a void leaves it.
    pub(super) fn leave(&self, ray: &UnitRay, index: u32) -> f64 {
        let center = self.center_near(index, ray.z);
        self.puck(index).leave(ray, center)
    }

    /// The void that holds a point of the unit-circle frame.
    pub(super) fn at(&self, p: DVec3) -> Option<u32> {
        let pitch = self.period / self.pucks.len() as f64;
        let guess = floor(p.z / pitch) as i64;
        (guess - 1..=guess + 1).find_map(|k| {
            let (index, center) = self.rung(k);
            (self.puck(index).level(p, center) < 0.0).then_some(index)
        })
    }

    /// Share of the medulla's cross-section times period that is void.
    pub(super) fn air_fraction(&self, ratio: f64) -> f64 {
        let volume: f64 = self.pucks.iter().map(Puck::volume).sum();
        volume / (std::f64::consts::PI * ratio * ratio * self.period)
    }
}

impl Puck {
    fn level(&self, p: DVec3, center: f64) -> f64 {
        let across = (p.x * p.x + p.y * p.y) / (self.radius * self.radius);
        let along = (p.z - center) / self.half;
        across * across + along.powi(4) - 1.0
    }

    /// Volume in unit-circle units across and micrometers along: `2 pi r^2 h` times the integral of
    /// `sqrt(1 - s^4)` over 0..1, which is 0.874019.
    fn volume(&self) -> f64 {
        const SHAPE: f64 = 0.874_019_184_764;
        std::f64::consts::TAU * self.radius * self.radius * self.half * SHAPE
    }

    /// Outward gradient in the unit-circle frame.
    pub(super) fn gradient(&self, p: DVec3, center: f64) -> DVec3 {
        let r2 = self.radius * self.radius;
        let across = (p.x * p.x + p.y * p.y) / (r2 * r2);
        let along = (p.z - center) / self.half;
        DVec3::new(across * p.x, across * p.y, along.powi(3) / self.half)
    }

    /// Value and slope of the level along the ray, a convex quartic.
    fn along(&self, ray: &UnitRay, center: f64) -> impl Fn(f64) -> (f64, f64) {
        let i = 1.0 / (self.radius * self.radius);
        let (a, b, c) = (i * ray.a, i * ray.b, i * ray.c);
        let (z, dz) = ((ray.z - center) / self.half, ray.dz / self.half);
        move |t| {
            let q = c + t * (2.0 * b + t * a);
            let s = z + t * dz;
            let s3 = s * s * s;
            (q * q + s3 * s - 1.0, 4.0 * (q * (b + t * a) + s3 * dz))
        }
    }

    /// The slab and cylinder around the puck cut from a ray.
    #[inline]
    fn bounds(&self, ray: &UnitRay, center: f64) -> Option<(f64, f64)> {
        let (a, b) = ray.inside_circle(self.radius)?;
        if ray.dz == 0.0 {
            return ((ray.z - center).abs() < self.half).then_some((a, b));
        }
        let (m, h) = ((center - ray.z) / ray.dz, self.half / ray.dz.abs());
        let (a, b) = (a.max(m - h), b.min(m + h));
        (a < b).then_some((a, b))
    }

    /// Where a ray from outside enters within `t0..t1`. Newton from a point before the root of a
    /// convex function stays before it: it converges without a bracket.
    ///
    /// * `around`: where the ray enters and leaves a cylinder that holds the puck.
    fn enter(
        &self,
        ray: &UnitRay,
        center: f64,
        around: (f64, f64),
        (t0, t1): (f64, f64),
    ) -> Option<f64> {
        let (mut t, mut end) = around;
        if ray.dz != 0.0 {
            let (m, h) = ((center - ray.z) / ray.dz, self.half / ray.dz.abs());
            (t, end) = (t.max(m - h), end.min(m + h));
        }
        if end <= t0 || t >= t1 {
            return None;
        }
        let level = self.along(ray, center);
        for _ in 0..60 {
            let (f, df) = level(t);
            if f <= CONVERGED {
                return (t >= t0 && t < t1).then_some(t);
            }
            if df >= 0.0 {
                return None;
            }
            t -= f / df;
            if t > end {
                return None;
            }
        }
        None
    }

    /// Where a ray from within leaves, by Newton from behind the root.
    fn leave(&self, ray: &UnitRay, center: f64) -> f64 {
        let Some((_, b)) = self.bounds(ray, center) else {
            // A point on the rim whose ray touches only: it leaves where it is.
            return 0.0;
        };
        let level = self.along(ray, center);
        let mut t = b;
        for _ in 0..60 {
            let (f, df) = level(t);
            if f <= CONVERGED || df <= 0.0 {
                break;
            }
            t -= f / df;
        }
        t.max(0.0)
    }
}
