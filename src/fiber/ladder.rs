//! The uniserial ladder: a stack of puck-shaped voids, one a rung.

use super::convex::{Convex, Plane};
use super::medulla::Part;
use super::section::{UnitRay, floor};
use crate::sampling::Rng;
use glam::{DVec2, DVec3};

/// One void: `(rho / radius)^4 + ((z - center) / half)^4 <= 1`, a superellipsoid of exponent 4.
#[derive(Clone, Copy, Debug)]
pub(super) struct Puck {
    pub(super) center: f64,
    pub(super) half: f64,
    /// Across, in units of the section's semi-axes.
    pub(super) radius: f64,
    inverse_half: f64,
    inverse_radius2: f64,
    /// Whether it is there: an interrupted ladder keeps the places of all rungs.
    present: bool,
}

/// The pucks of one period in order of z; they never touch.
#[derive(Clone, Debug)]
pub(super) struct Ladder {
    pub(super) period: f64,
    pub(super) pucks: Vec<Puck>,
    widest: f64,
    inverse_period: f64,
    /// Rungs per micrometer.
    rate: f64,
}

/// Where a walk along the endless ladder is: a puck and the z of its image's period.
#[derive(Clone, Copy)]
struct Rung {
    index: usize,
    base: f64,
}

/// Level at which a root counts as found: some roundings of its terms, 1e-13 of the size in place.
const CONVERGED: f64 = 1e-14;
/// Share of the medulla's radius that a void takes; the rest is its tube's wall.
pub(super) const WIDTH: f64 = 0.92;

impl Ladder {
    /// * `ratio`: radius of the medulla in units of the semi-axes.
    /// * `reach`: radius that voids may reach, no more.
    /// * `count`: rungs in a period.
    pub(super) fn new(
        (ratio, reach): (f64, f64),
        period: f64,
        count: usize,
        septum_um: f64,
        seed: u64,
    ) -> Self {
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
                    radius: (WIDTH * ratio * breadth).min(reach),
                    inverse_half: 0.0,
                    inverse_radius2: 0.0,
                    present: true,
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
        for puck in &mut pucks {
            puck.inverse_half = 1.0 / puck.half;
            puck.inverse_radius2 = 1.0 / (puck.radius * puck.radius);
        }
        Self {
            period,
            pucks,
            widest,
            inverse_period: 1.0 / period,
            rate: 1.0 / pitch,
        }
    }

    /// Takes away the pucks where `there` says no of their centers.
    pub(super) fn keep(&mut self, there: impl Fn(f64) -> bool) {
        for puck in &mut self.pucks {
            puck.present = there(puck.center);
        }
    }

    /// The pucks that are there.
    pub(super) fn present(&self) -> impl Iterator<Item = &Puck> {
        self.pucks.iter().filter(|p| p.present)
    }

    /// The pucks that are there as discs of other shapes, each in convex parts that overlap.
    pub(super) fn within(&self, parts: &[Part]) -> Vec<Convex> {
        let mut discs = Vec::new();
        for puck in self.present() {
            for part in parts {
                let mut planes = part.planes(DVec2::ZERO);
                planes.extend([DVec3::Z, DVec3::NEG_Z].map(|normal| Plane {
                    normal,
                    offset: puck.half,
                }));
                discs.push(Convex {
                    center: DVec3::Z * puck.center,
                    half: part.half.extend(puck.half),
                    planes,
                    ..Convex::default()
                });
            }
        }
        discs
    }

    /// The rung whose pitch holds `z`; its puck may be shifted into a neighbor's.
    #[inline]
    fn rung_at(&self, z: f64) -> Rung {
        let base = self.period * floor(z * self.inverse_period);
        let index = ((z - base) * self.rate) as usize;
        Rung {
            index: index.min(self.pucks.len() - 1),
            base,
        }
    }

    /// The rung above, or below.
    #[inline]
    fn step(&self, rung: Rung, up: bool) -> Rung {
        let Rung { index, base } = rung;
        match (up, index) {
            (true, _) if index + 1 < self.pucks.len() => Rung {
                index: index + 1,
                base,
            },
            (true, _) => Rung {
                index: 0,
                base: base + self.period,
            },
            (false, 0) => Rung {
                index: self.pucks.len() - 1,
                base: base - self.period,
            },
            (false, _) => Rung {
                index: index - 1,
                base,
            },
        }
    }

    /// The puck of a rung.
    pub(super) fn puck(&self, index: u32) -> Puck {
        self.pucks[index as usize]
    }

    /// z of the center of the image of a puck that is nearest to `z`.
    pub(super) fn center_near(&self, index: u32, z: f64) -> f64 {
        let center = self.puck(index).center;
        center + self.period * floor((z - center) * self.inverse_period + 0.5)
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
        let up = ray.dz >= 0.0;
        let inverse_dz = 1.0 / ray.dz;
        let (z0, z1) = (ray.z + t0 * ray.dz, ray.z + t1 * ray.dz);
        let mut rung = match from {
            // Slabs of pucks are apart: behind the one just left there is none.
            Some(index) => {
                let here = Rung {
                    index: index as usize,
                    base: self.center_near(index, ray.z) - self.puck(index).center,
                };
                self.step(here, up)
            }
            None => self.step(self.rung_at(z0), !up),
        };
        let forward = if up { 1.0 } else { -1.0 };
        loop {
            let puck = &self.pucks[rung.index];
            let center = puck.center + rung.base;
            if (center - z1) * forward > puck.half {
                return None;
            }
            if puck.present
                && (z0 - center) * forward <= puck.half
                && let Some(t) = puck.enter(ray, inverse_dz, center, (a, b), (t0, t1))
            {
                return Some((t, rung.index as u32));
            }
            rung = self.step(rung, up);
        }
    }

    /// Where a ray that is in a void leaves it.
    pub(super) fn leave(&self, ray: &UnitRay, index: u32) -> f64 {
        let center = self.center_near(index, ray.z);
        self.puck(index).leave(ray, center)
    }

    /// The void that holds a point of the unit-circle frame.
    pub(super) fn at(&self, p: DVec3) -> Option<u32> {
        let near = self.rung_at(p.z);
        [self.step(near, false), near, self.step(near, true)]
            .into_iter()
            .find_map(|rung| {
                let puck = &self.pucks[rung.index];
                (puck.present && puck.level(p, puck.center + rung.base) < 0.0)
                    .then_some(rung.index as u32)
            })
    }

    /// Share of the medulla's cross-section times period that is void.
    pub(super) fn air_fraction(&self, ratio: f64) -> f64 {
        let volume: f64 = self.present().map(Puck::volume).sum();
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
        let i = self.inverse_radius2;
        let across = (p.x * p.x + p.y * p.y) * (i * i);
        let along = (p.z - center) * self.inverse_half;
        DVec3::new(
            across * p.x,
            across * p.y,
            along * along * along * self.inverse_half,
        )
    }

    /// The level along the ray, a convex quartic.
    #[inline]
    fn along(&self, ray: &UnitRay, center: f64) -> Quartic {
        Quartic {
            a: self.inverse_radius2 * ray.a,
            b: self.inverse_radius2 * ray.b,
            c: self.inverse_radius2 * ray.c,
            s: (ray.z - center) * self.inverse_half,
            ds: ray.dz * self.inverse_half,
        }
    }

    /// What a range of the ray has in common with the puck's slab.
    #[inline]
    fn within_slab(
        &self,
        ray: &UnitRay,
        inverse_dz: f64,
        center: f64,
        (a, b): (f64, f64),
    ) -> (f64, f64) {
        if ray.dz == 0.0 {
            return (a, b);
        }
        let (middle, reach) = ((center - ray.z) * inverse_dz, self.half * inverse_dz.abs());
        (a.max(middle - reach), b.min(middle + reach))
    }

    /// Where a ray from outside enters within `t0..t1`. Newton from a point before the root of a
    /// convex function stays before it: it converges without a bracket.
    ///
    /// * `around`: where the ray enters and leaves a cylinder that holds the puck.
    #[inline]
    fn enter(
        &self,
        ray: &UnitRay,
        inverse_dz: f64,
        center: f64,
        around: (f64, f64),
        (t0, t1): (f64, f64),
    ) -> Option<f64> {
        let (mut t, end) = self.within_slab(ray, inverse_dz, center, around);
        if end <= t0 || t >= t1 {
            return None;
        }
        let quartic = self.along(ray, center);
        let least = quartic.accuracy();
        for _ in 0..60 {
            let (f, df) = quartic.at(t);
            if f <= CONVERGED {
                break;
            }
            if df >= 0.0 {
                return None;
            }
            t -= f / df;
            if t > end {
                return None;
            }
            if f * f <= least * df * df {
                break;
            }
        }
        (t >= t0 && t < t1).then_some(t)
    }

    /// Where a ray from within leaves, by Newton from behind the root.
    #[inline]
    fn leave(&self, ray: &UnitRay, center: f64) -> f64 {
        let Some(around) = ray.inside_circle(self.radius) else {
            // A point on the rim whose ray touches only: it leaves where it is.
            return 0.0;
        };
        let (begin, end) = self.within_slab(ray, 1.0 / ray.dz, center, around);
        if begin >= end {
            return 0.0;
        }
        let quartic = self.along(ray, center);
        let least = quartic.accuracy();
        let mut t = end;
        for _ in 0..60 {
            let (f, df) = quartic.at(t);
            if f <= CONVERGED || df <= 0.0 {
                break;
            }
            t -= f / df;
            if f * f <= least * df * df {
                break;
            }
        }
        t.max(0.0)
    }
}

/// `q^2 + s^4 - 1` with `q = c + 2 b t + a t^2` and `s + ds t` for s.
struct Quartic {
    a: f64,
    b: f64,
    c: f64,
    s: f64,
    ds: f64,
}

impl Quartic {
    /// Value and slope.
    #[inline]
    fn at(&self, t: f64) -> (f64, f64) {
        let q = self.c + t * (2.0 * self.b + t * self.a);
        let s = self.s + t * self.ds;
        let s3 = s * s * s;
        (
            q * q + s3 * s - 1.0,
            4.0 * (q * (self.b + t * self.a) + s3 * self.ds),
        )
    }

    /// Greatest `(f / f')^2` at which one more step leaves less than the converged level: half the
    /// curvature times it, where the curvature is at most `12 (a q + s^2 ds^2)`, q and s below 1.2.
    #[inline]
    fn accuracy(&self) -> f64 {
        CONVERGED / (9.0 * (self.a + self.ds * self.ds))
    }
}
