//! Packing spheres of given sizes into the medulla until none overlap.

use super::froth::Sphere;
use super::section::Section;
use crate::sampling::Rng;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Spheres of one period that do not overlap.
#[derive(Clone, Debug)]
pub(super) struct Packing {
    pub(super) spheres: Vec<Sphere>,
    pub(super) period: f64,
}

/// What to pack.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recipe {
    /// Median radius, micrometers, and deviation of its logarithm.
    pub(super) radius_um: f64,
    pub(super) radius_sigma: f64,
    /// Share of the medulla's volume.
    pub(super) air_fraction: f64,
    /// Medulla's radius and the largest radius that spheres may reach, in units of the semi-axes.
    pub(super) ratio: f64,
    pub(super) reach: f64,
    pub(super) period: f64,
}

/// Least wall between two voids, micrometers; thinner walls tear in life, and 0 leaks in rounding.
const WALL_UM: f64 = 0.05;
/// Rounds of pushing overlaps apart.
const ROUNDS: usize = 3000;

/// Volume of spheres.
pub(super) fn volume(spheres: &[Sphere]) -> f64 {
    let cubes: f64 = spheres.iter().map(|s| s.radius.powi(3)).sum();
    4.0 / 3.0 * PI * cubes
}

impl Recipe {
    /// Draws sizes until their volume is the asked share, places them at random and pushes overlaps
    /// apart. `Err` is the share that could be reached.
    pub(super) fn pack(&self, section: &Section, seed: u64) -> Result<Packing, f64> {
        let medulla = PI * self.ratio * self.ratio * section.a * section.b * self.period;
        let target = self.air_fraction * medulla;
        let semi = DVec2::new(section.a, section.b) * self.reach;
        let mut spheres = self.draw(target, semi, seed);
        for _ in 0..ROUNDS {
            if !self.push_apart(&mut spheres, semi) {
                break;
            }
        }
        self.shrink_to_fit(&mut spheres, semi);
        let reached = volume(&spheres) / medulla;
        if reached < 0.98 * self.air_fraction {
            return Err(reached);
        }
        Ok(Packing {
            spheres,
            period: self.period,
        })
    }

    /// Log-normal radii, cut to what fits, at random places; the last ones make up the volume.
    fn draw(&self, target: f64, semi: DVec2, seed: u64) -> Vec<Sphere> {
        let largest = (0.9 * semi.min_element()).min(0.2 * self.period);
        let smallest = 0.3 * self.radius_um;
        let mut spheres = Vec::new();
        let mut sum = 0.0;
        for index in 0.. {
            let rest = (target - sum) / (4.0 / 3.0 * PI);
            if rest <= 0.0 || largest <= 0.0 {
                break;
            }
            let mut rng = Rng::new(seed ^ 0xf207_4000, index);
            let (normal, _) = rng.normal_pair();
            let radius = self.radius_um * (self.radius_sigma * normal).exp();
            let radius = radius
                .clamp(smallest.min(largest), largest)
                .min(rest.cbrt());
            let (x, y) = crate::sampling::concentric_disk(rng.uniform(), rng.uniform());
            spheres.push(Sphere {
                center: DVec3::new(
                    x * (semi.x - radius),
                    y * (semi.y - radius).max(0.0),
                    rng.uniform() * self.period,
                ),
                radius,
            });
            sum += 4.0 / 3.0 * PI * radius.powi(3);
        }
        spheres
    }

    /// One round: overlapping pairs step apart, spheres outside step in. `false` when none moved.
    fn push_apart(&self, spheres: &mut [Sphere], semi: DVec2) -> bool {
        let mut moved = false;
        let mut pairs = Vec::new();
        self.for_each_pair(spheres, |i, j| pairs.push((i, j)));
        for (i, j) in pairs {
            let apart = self.apart(spheres[i].center, spheres[j].center);
            let gap = apart.length() - spheres[i].radius - spheres[j].radius - WALL_UM;
            if gap >= 0.0 {
                continue;
            }
            moved = true;
            // The small one yields; a little more than needed, or the end is approached for ever.
            let (a, b) = (spheres[i].radius.powi(2), spheres[j].radius.powi(2));
            let push = apart.try_normalize().unwrap_or(DVec3::Z) * (-0.6 * gap + 1e-3);
            spheres[i].center -= push * (2.0 * b / (a + b));
            spheres[j].center += push * (2.0 * a / (a + b));
        }
        for sphere in spheres {
            let inside = pull_inside(sphere, semi);
            moved |= inside;
            sphere.center.z = sphere.center.z.rem_euclid(self.period);
        }
        moved
    }

    /// From `a` to the nearest image of `b`.
    fn apart(&self, a: DVec3, b: DVec3) -> DVec3 {
        let mut d = b - a;
        d.z -= self.period * (d.z / self.period).round();
        d
    }

    /// Pairs that overlap or nearly do.
    fn for_each_pair(&self, spheres: &[Sphere], mut visit: impl FnMut(usize, usize)) {
        // Along z only: a sweep over spheres in order is enough for some thousand.
        let mut order: Vec<usize> = (0..spheres.len()).collect();
        order.sort_by(|&i, &j| {
            (spheres[i].center.z, i)
                .partial_cmp(&(spheres[j].center.z, j))
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        let largest = spheres.iter().fold(0.0f64, |r, s| r.max(s.radius));
        let n = order.len();
        for k in 0..n {
            let i = order[k];
            for step in 1..n {
                let j = order[(k + step) % n];
                let dz = spheres[j].center.z - spheres[i].center.z
                    + if k + step >= n { self.period } else { 0.0 };
                if dz > spheres[i].radius + largest + WALL_UM {
                    break;
                }
                let reach = spheres[i].radius + spheres[j].radius + WALL_UM;
                let d = self.apart(spheres[i].center, spheres[j].center);
                if d.length_squared() < reach * reach {
                    visit(i, j);
                }
            }
        }
    }

    /// Shrinks all spheres alike until none overlap or reach out.
    fn shrink_to_fit(&self, spheres: &mut [Sphere], semi: DVec2) {
        let mut factor = 1.0f64;
        self.for_each_pair(spheres, |i, j| {
            let apart = self.apart(spheres[i].center, spheres[j].center).length();
            // Half the least wall is kept in any case.
            let fits = (apart - 0.5 * WALL_UM) / (spheres[i].radius + spheres[j].radius);
            factor = factor.min(fits.max(0.0));
        });
        for sphere in spheres.iter() {
            let outside = reach_outside(sphere, semi).max(0.0);
            factor = factor.min(1.0 - outside / sphere.radius);
        }
        if factor < 1.0 {
            for sphere in spheres {
                sphere.radius *= factor.max(0.0);
            }
        }
    }
}

/// How far a sphere reaches over the ellipse: at the normal of the nearest direction, to first order.
fn reach_outside(sphere: &Sphere, semi: DVec2) -> f64 {
    let c = sphere.center.truncate();
    let nearest = nearest_on_ellipse(c, semi);
    let inside = (c / semi).length_squared() < 1.0;
    let distance = nearest.distance(c) * if inside { 1.0 } else { -1.0 };
    sphere.radius - distance
}

/// Moves a sphere that reaches out back in. Whether it had to.
fn pull_inside(sphere: &mut Sphere, semi: DVec2) -> bool {
    let over = reach_outside(sphere, semi);
    if over <= 0.0 {
        return false;
    }
    let c = sphere.center.truncate();
    let nearest = nearest_on_ellipse(c, semi);
    let normal = (nearest / (semi * semi)).normalize();
    let c = nearest - normal * (sphere.radius + 1e-3);
    sphere.center = c.extend(sphere.center.z);
    true
}

/// The point of an ellipse nearest to `p`, by iteration over the evolute (Chatfield 2017): five
/// rounds give nine digits or more.
fn nearest_on_ellipse(p: DVec2, semi: DVec2) -> DVec2 {
    let q = p.abs();
    let mut t = DVec2::splat(std::f64::consts::FRAC_1_SQRT_2);
    for _ in 0..5 {
        let point = semi * t;
        let e = DVec2::new(
            (semi.x * semi.x - semi.y * semi.y) * t.x.powi(3) / semi.x,
            (semi.y * semi.y - semi.x * semi.x) * t.y.powi(3) / semi.y,
        );
        let (r, s) = (point - e, q - e);
        let scale = r.length() / s.length().max(1e-12);
        t = ((s * scale + e) / semi).clamp(DVec2::ZERO, DVec2::ONE);
        t /= t.length().max(1e-12);
    }
    let point = semi * t;
    DVec2::new(point.x.copysign(p.x), point.y.copysign(p.y))
}
