//! Pigment along a ray through keratin: leaning toward the medulla or the cuticle, absent under a
//! clear rim, in streaks along the axis, denser or rarer in the medulla's walls.

use super::medulla::Pieces;
use super::section::{UnitRay, floor};
use crate::sampling::{Rng, hash64};
use crate::species::Structure;
use glam::DVec3;

/// Where the pigment lies. Its mean over the cortex is 1.
#[derive(Clone, Debug)]
pub(super) struct Pigment {
    /// Radius of the medulla in units of the semi-axes.
    ratio: f64,
    /// Pigment of the medulla's walls relative to the cortex.
    walls: f64,
    lean: Option<Lean>,
    streaks: Option<Box<Streaks>>,
}

/// Density that is linear in the radius up to the rim: `base - rise * rho`.
#[derive(Clone, Copy, Debug)]
struct Lean {
    base: f64,
    rise: f64,
    /// Radius at which the clear rim begins.
    rim: f64,
}

/// Density in cells that are slender along z: a log-normal number a cell.
#[derive(Clone, Debug)]
struct Streaks {
    /// Micrometers in the unit-circle frame's units across.
    scale: [f64; 2],
    period: f64,
    seed: u64,
    /// Draws of the log-normal distribution, their mean 1.
    levels: [f64; 256],
}

/// Width of a streak, micrometers: some granules side by side.
const STREAK_UM: f64 = 1.5;
/// Mean length of a streak, micrometers; reported as dots and dashes of 10 to 40.
const STREAK_LENGTH_UM: f64 = 25.0;

impl Pigment {
    /// * `semi`: semi-axes of the section, micrometers; `radii`: of its outline, in their units.
    /// * `ratio`: radius of the medulla, 0 for none.
    pub(super) fn new(
        structure: &Structure,
        (semi, radii): ([f64; 2], &[f64]),
        ratio: f64,
        period: f64,
        seed: u64,
    ) -> Self {
        let cortex = &structure.cortex;
        let even = cortex.toward_medulla == 0.0 && cortex.clear_rim == 0.0;
        Self {
            ratio,
            walls: structure.medulla.pigment,
            lean: (!even).then(|| Lean::new(cortex.toward_medulla, cortex.clear_rim, ratio, radii)),
            streaks: (cortex.streaks > 0.0)
                .then(|| Box::new(Streaks::new(cortex.streaks, semi, period, seed))),
        }
    }

    /// Integral of the density along a ray through keratin from 0 to `t`, micrometers.
    #[inline]
    pub(super) fn along(&self, ray: &UnitRay, t: f64, pieces: Option<&Pieces>) -> f64 {
        let even = self.lean.is_none() && self.streaks.is_none();
        if even && (self.walls == 1.0 || self.ratio <= 0.0) {
            return t;
        }
        let (a, b) = self.within_medulla(ray, t);
        let inside = (b - a).max(0.0);
        let share = match pieces {
            _ if inside == 0.0 => 1.0,
            None => 1.0,
            Some(pieces) => pieces.share(ray.z + a * ray.dz, ray.z + b * ray.dz),
        };
        let core = share * self.walls * inside;
        if even {
            return t - share * inside + core;
        }
        if inside == 0.0 {
            return self.cortex(ray, 0.0, t, None);
        }
        // Between its pieces the cortex goes on.
        let gaps = match pieces {
            Some(_) if share < 1.0 => self.cortex(ray, a, b, pieces),
            _ => 0.0,
        };
        core + gaps + self.cortex(ray, 0.0, a, None) + self.cortex(ray, b, t, None)
    }

    /// The part of `0..t` within the medulla's outline.
    #[inline]
    fn within_medulla(&self, ray: &UnitRay, t: f64) -> (f64, f64) {
        if self.ratio <= 0.0 {
            return (0.0, 0.0);
        }
        // The medulla is convex: from one place in it to another all of the way is.
        let end = ray.c + t * (2.0 * ray.b + t * ray.a);
        if ray.c.max(end) <= self.ratio * self.ratio {
            return (0.0, t);
        }
        ray.inside_circle(self.ratio)
            .map_or((0.0, 0.0), |(a, b)| (a.max(0.0), b.min(t)))
    }

    /// The integral over a part of the ray in the cortex.
    ///
    /// * `pieces`: those of the medulla that the part may pass, which are left out.
    fn cortex(&self, ray: &UnitRay, t0: f64, t1: f64, pieces: Option<&Pieces>) -> f64 {
        if t1 <= t0 {
            return 0.0;
        }
        let outside = |t0: f64, t1: f64| {
            pieces.map_or(1.0, |p| {
                1.0 - p.share(ray.z + t0 * ray.dz, ray.z + t1 * ray.dz)
            })
        };
        // Where the medulla would be the density is that beside it.
        let density = |lean: &Lean, p: DVec3| lean.density(p.x.hypot(p.y).max(self.ratio));
        match (&self.streaks, &self.lean) {
            (None, None) => (t1 - t0) * outside(t0, t1),
            (None, Some(lean)) if pieces.is_some() => {
                (t1 - t0) * outside(t0, t1) * lean.density(self.ratio)
            }
            (None, Some(lean)) => lean.integral(ray, t0, t1),
            (Some(streaks), lean) => {
                let (mut sum, mut within) = (0.0, (t0, t1));
                if let Some(lean) = lean {
                    let Some((a, b)) = ray.inside_circle(lean.rim) else {
                        return 0.0;
                    };
                    within = (t0.max(a), t1.min(b));
                }
                let (t0, t1) = within;
                streaks.walk(ray, t0, t1, |streak, t0, t1| {
                    let p = ray.at(0.5 * (t0 + t1));
                    let at = lean.as_ref().map_or(1.0, |lean| density(lean, p));
                    sum += streak * at * (t1 - t0) * outside(t0, t1);
                });
                sum
            }
        }
    }
}

impl Lean {
    /// `1 + b (1 - 2 u)` up to the rim, with u from 0 at the medulla to 1 at the farthest part of the mean
    /// surface, over its mean.
    fn new(b: f64, clear_rim: f64, ratio: f64, radii: &[f64]) -> Self {
        let outer = radii.iter().fold(0.0, |m: f64, &r| m.max(r));
        let width = outer - ratio;
        let rim = outer - clear_rim * width;
        let slope = 2.0 * b / width;
        let base = 1.0 + b + slope * ratio;
        // Integral of (base - slope rho) rho from ratio to the rim, over that of rho to the surface.
        let (mut sum, mut area) = (0.0, 0.0);
        for &radius in radii {
            let end = radius.min(rim);
            sum += 0.5 * base * (end * end - ratio * ratio);
            sum -= slope / 3.0 * (end.powi(3) - ratio.powi(3));
            area += 0.5 * (radius * radius - ratio * ratio);
        }
        let mean = sum / area;
        Self {
            base: base / mean,
            rise: slope / mean,
            rim,
        }
    }

    fn density(&self, rho: f64) -> f64 {
        if rho >= self.rim {
            return 0.0;
        }
        (self.base - self.rise * rho).max(0.0)
    }

    /// Closed form: the radius along a ray is `sqrt(a s^2 + k)` with s from the point next to the axis.
    fn integral(&self, ray: &UnitRay, t0: f64, t1: f64) -> f64 {
        let Some((a, b)) = ray.inside_circle(self.rim) else {
            return 0.0;
        };
        let (t0, t1) = (t0.max(a), t1.min(b));
        if t0 >= t1 {
            return 0.0;
        }
        let flat = self.base * (t1 - t0);
        if self.rise == 0.0 {
            return flat;
        }
        if ray.a < 1e-12 {
            return flat - self.rise * ray.c.sqrt() * (t1 - t0);
        }
        let foot = -ray.b / ray.a;
        let k = (ray.c - ray.b * ray.b / ray.a).max(0.0);
        let root = ray.a.sqrt();
        let at = |t: f64| {
            let s = root * (t - foot);
            (s, (s * s + k).sqrt())
        };
        let ((s0, rho0), (s1, rho1)) = (at(t0), at(t1));
        // s + rho, without its cancellation before the foot.
        let sum = |s: f64, rho: f64| if s < 0.0 { k / (rho - s) } else { rho + s };
        let log = if k > 1e-20 {
            k * (sum(s1, rho1) / sum(s0, rho0)).ln()
        } else {
            0.0
        };
        let radius = 0.5 * (s1 * rho1 - s0 * rho0 + log) / root;
        flat - self.rise * radius
    }
}

impl Streaks {
    fn new(sigma: f64, semi: [f64; 2], period: f64, seed: u64) -> Self {
        let mut levels = [0.0; 256];
        for (k, level) in levels.iter_mut().enumerate() {
            let (normal, _) = Rng::new(seed ^ 0x57ea_0000, k as u64).normal_pair();
            *level = (sigma * normal).exp();
        }
        let mean = levels.iter().sum::<f64>() / levels.len() as f64;
        Self {
            scale: semi,
            period,
            seed: hash64(seed ^ 0x57ea_4c00),
            levels: levels.map(|l| l / mean),
        }
    }

    /// Visits the cells along a ray: density, begin and end.
    fn walk(&self, ray: &UnitRay, t0: f64, t1: f64, mut visit: impl FnMut(f64, f64, f64)) {
        let rate = [
            ray.dx * self.scale[0] / STREAK_UM,
            ray.dy * self.scale[1] / STREAK_UM,
        ];
        let at = [
            ray.x * self.scale[0] / STREAK_UM,
            ray.y * self.scale[1] / STREAK_UM,
        ];
        let (mut cell, mut next, mut delta) = ([0.0; 2], [f64::INFINITY; 2], [f64::INFINITY; 2]);
        for k in 0..2 {
            cell[k] = floor(at[k] + t0 * rate[k]);
            if rate[k] != 0.0 {
                let edge = cell[k] + f64::from(u8::from(rate[k] > 0.0));
                next[k] = (edge - at[k]) / rate[k];
                delta[k] = 1.0 / rate[k].abs();
            }
        }
        let mut t = t0;
        while t < t1 {
            let axis = usize::from(next[1] < next[0]);
            let end = next[axis].min(t1);
            if end > t {
                self.column(cell, ray, t, end, &mut visit);
                t = end;
            }
            cell[axis] += rate[axis].signum();
            next[axis] += delta[axis];
        }
    }

    /// The streaks of one column, whose ends lie at heights of its own.
    fn column(
        &self,
        cell: [f64; 2],
        ray: &UnitRay,
        t0: f64,
        t1: f64,
        visit: &mut impl FnMut(f64, f64, f64),
    ) {
        let key = hash64(self.seed ^ (cell[0] as i64 as u64) ^ ((cell[1] as i64 as u64) << 32));
        let count = (self.period / STREAK_LENGTH_UM).round().max(1.0);
        let length = self.period / count;
        let phase = (key >> 40) as f64 / f64::from(1u32 << 24);
        let level = |z: f64| {
            let k = floor(z / length + phase);
            let k = k - count * floor(k / count);
            self.levels[(hash64(key ^ k as u64) & 255) as usize]
        };
        let mut t = t0;
        if ray.dz != 0.0 {
            let at = |t: f64| (ray.z + t * ray.dz) / length + phase;
            let up = ray.dz > 0.0;
            let mut edge = floor(at(t)) + f64::from(u8::from(up));
            loop {
                let end = ((edge - phase) * length - ray.z) / ray.dz;
                if end >= t1 {
                    break;
                }
                if end > t {
                    visit(level(ray.z + 0.5 * (t + end) * ray.dz), t, end);
                    t = end;
                }
                edge += if up { 1.0 } else { -1.0 };
            }
        }
        if t1 > t {
            visit(level(ray.z + 0.5 * (t + t1) * ray.dz), t, t1);
        }
    }
}

#[cfg(test)]
mod tests;
