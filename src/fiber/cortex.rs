//! Pigment along a ray through keratin: leaning toward the medulla or the cuticle, absent under a
//! clear rim, in streaks along the axis, denser or rarer in the medulla's walls.

mod streaks;

use super::medulla::{Pieces, Rim};
use super::section::UnitRay;
use crate::species::Structure;
use streaks::{Shade, Streaks};

/// Where the pigment lies. Its mean over the cortex is 1.
#[derive(Clone, Debug)]
pub(super) struct Pigment {
    /// Radius of the medulla in units of the semi-axes.
    pub(super) ratio: f64,
    /// Pigment of the medulla's walls relative to the cortex.
    pub(super) walls: f64,
    pub(super) lean: Option<Lean>,
    streaks: Option<Box<Streaks>>,
}

/// Density that is linear in the radius up to the rim: `base - rise * rho`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lean {
    pub(super) base: f64,
    pub(super) rise: f64,
    /// Radius at which the clear rim begins.
    pub(super) rim: f64,
}

/// A straight line crosses a waisted outline four times; more only where it grazes.
const MOST_CROSSINGS: u32 = 8;

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
        let reach = radii.iter().fold(0.0, |m: f64, &r| m.max(r));
        Self {
            ratio,
            walls: structure.medulla.pigment,
            lean: (!even).then(|| Lean::new(cortex.toward_medulla, cortex.clear_rim, ratio, radii)),
            streaks: (cortex.streaks > 0.0)
                .then(|| Box::new(Streaks::new(cortex.streaks, semi, reach, period, seed))),
        }
    }

    /// Whether it is alike all over the cortex.
    pub(super) fn is_even(&self) -> bool {
        self.lean.is_none() && self.streaks.is_none()
    }

    /// Whether it lies in streaks.
    #[cfg(target_arch = "x86_64")]
    pub(super) fn is_streaked(&self) -> bool {
        self.streaks.is_some()
    }

    /// Whether it is alike all over the cortex and the medulla's walls.
    pub(super) fn is_plain(&self) -> bool {
        self.is_even() && (self.walls == 1.0 || self.ratio <= 0.0)
    }

    /// Integral of the density along a ray through keratin from 0 to `t`, micrometers.
    #[inline]
    pub(super) fn along(&self, ray: &UnitRay, t: f64, pieces: Option<&Pieces>) -> f64 {
        if self.is_plain() {
            return t;
        }
        let even = self.is_even();
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

    /// As [`Pigment::along`] in a section that is no ellipse.
    ///
    /// * `rim`: the medulla's outline there, which a ray may cross several times.
    pub(super) fn along_shaped(
        &self,
        ray: &UnitRay,
        t: f64,
        pieces: Option<&Pieces>,
        rim: &Rim,
    ) -> f64 {
        let (mut at, mut sum, mut from) = (0.0, 0.0, None);
        let mut inside = rim.holds(ray.at(0.0));
        for _ in 0..MOST_CROSSINGS {
            let rest = ray.from(at);
            let next = if inside {
                rim.leave(&rest, from, t - at)
            } else {
                rim.enter(&rest, from, t - at)
            };
            let end = next.map_or(t, |(way, _)| (at + way).min(t));
            sum += if inside {
                let (z0, z1) = (ray.z + at * ray.dz, ray.z + end * ray.dz);
                let share = pieces.map_or(1.0, |pieces| pieces.share(z0, z1));
                let gaps = match pieces {
                    Some(_) if share < 1.0 => self.cortex(ray, at, end, pieces),
                    _ => 0.0,
                };
                share * self.walls * (end - at) + gaps
            } else {
                self.cortex(ray, at, end, None)
            };
            (at, from, inside) = (end, next.map(|(_, state)| state), !inside);
            if at >= t {
                break;
            }
        }
        sum
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
        match (&self.streaks, &self.lean) {
            (None, None) => (t1 - t0) * outside(t0, t1),
            (None, Some(lean)) if pieces.is_some() => {
                (t1 - t0) * outside(t0, t1) * lean.density(self.ratio)
            }
            (None, Some(lean)) => lean.integral(ray, t0, t1),
            (Some(streaks), lean) => {
                let mut within = (t0, t1);
                if let Some(lean) = lean {
                    let Some((a, b)) = ray.inside_circle(lean.rim) else {
                        return 0.0;
                    };
                    within = (t0.max(a), t1.min(b));
                }
                let (t0, t1) = within;
                // Where the medulla would be the density is that beside it.
                let shade = Shade {
                    lean: lean.unwrap_or(Lean::EVEN),
                    ratio: self.ratio,
                };
                if pieces.is_none() {
                    return streaks.integral(ray, t0, t1, &shade);
                }
                let mut sum = 0.0;
                streaks.walk(ray, t0, t1, |streak, t0, t1| {
                    let at = shade.at(ray, 0.5 * (t0 + t1));
                    sum += streak * at * (t1 - t0) * outside(t0, t1);
                });
                sum
            }
        }
    }
}

impl Lean {
    /// The same everywhere.
    const EVEN: Self = Self {
        base: 1.0,
        rise: 0.0,
        rim: f64::INFINITY,
    };

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
    pub(super) fn integral(&self, ray: &UnitRay, t0: f64, t1: f64) -> f64 {
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

#[cfg(test)]
mod tests;
