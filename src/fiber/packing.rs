//! Packing spheres of given sizes into the medulla until none overlap.

use super::froth::Sphere;
use super::medulla::Edge;
use crate::sampling::Rng;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// What to pack.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recipe<'a> {
    /// Median radius, micrometers, and deviation of its logarithm.
    pub(super) radius_um: f64,
    pub(super) radius_sigma: f64,
    /// Share of the medulla's volume.
    pub(super) air_fraction: f64,
    /// Cross-section of the medulla, square micrometers.
    pub(super) area: f64,
    /// Semi-axes of the ellipse that spheres may reach, micrometers.
    pub(super) semi: DVec2,
    /// What they may reach instead in a section that is no ellipse, and the semi-axes of the section.
    pub(super) edge: Option<&'a Edge>,
    pub(super) axes: DVec2,
    /// Depth of the dents in the wall, as a share of the radius.
    pub(super) wobble: f64,
    pub(super) period: f64,
    /// Where along z spheres may be: intervals in order.
    pub(super) spans: &'a [[f64; 2]],
}

/// Least wall between two voids, micrometers; thinner walls tear in life, and 0 leaks in rounding.
const WALL_UM: f64 = 0.05;
/// Rounds of pushing overlaps apart.
const ROUNDS: usize = 3000;
/// Pairs are listed that are as near as this share of the median radius, so that a list serves many
/// rounds. Less makes lists often, more makes them long.
const SKIN: f64 = 0.6;
/// Share of the volume that may be off. Overlaps are left to shrinking when that costs twice as much:
/// the last thousandths would take most of the rounds.
const TOLERANCE: f64 = 0.0075;
/// Distance of the dents in the wall of a froth, micrometers.
const DENT_UM: f64 = 10.0;

/// Volume of spheres.
pub(super) fn volume(spheres: &[Sphere]) -> f64 {
    let cubes: f64 = spheres.iter().map(|s| s.radius.powi(3)).sum();
    4.0 / 3.0 * PI * cubes
}

impl Recipe<'_> {
    /// Draws sizes until their volume is the asked share, places them at random and pushes overlaps
    /// apart. `Err` is the share that could be reached.
    pub(super) fn pack(&self, seed: u64) -> Result<Vec<Sphere>, f64> {
        let wall = Wall::new(self, seed);
        let room = self.area * self.spans.iter().map(|s| s[1] - s[0]).sum::<f64>();
        let target = (1.0 + TOLERANCE) * self.air_fraction * room;
        let mut spheres = self.draw(target, self.semi, seed);
        let skin = SKIN * self.radius_um;
        let mut pairs = Vec::new();
        // How far the two fastest spheres may have come together since the list was made.
        let mut drift = f64::INFINITY;
        for _ in 0..ROUNDS {
            if drift >= skin {
                pairs.clear();
                self.for_each_pair(&spheres, skin, |i, j| pairs.push((i, j)));
                drift = 0.0;
            }
            let (step, overlap) = self.push_apart(&mut spheres, &pairs, &wall);
            if overlap <= 0.6 * TOLERANCE {
                break;
            }
            drift += 2.0 * step;
        }
        self.shrink_to_fit(&mut spheres, &wall);
        let reached = volume(&spheres) / room;
        if reached < 0.98 * self.air_fraction {
            return Err(reached);
        }
        Ok(spheres)
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
            let across = match self.edge {
                None => DVec2::new(x * (semi.x - radius), y * (semi.y - radius).max(0.0)),
                Some(edge) => x.hypot(y) * edge.at(y.atan2(x)),
            };
            // Evenly along the hair: in a slender tube crowds could not get apart.
            let own = 4.0 / 3.0 * PI * radius.powi(3);
            let along = (sum + rng.uniform() * own) / target;
            spheres.push(Sphere {
                center: across.extend(self.height_at(along)),
                radius,
            });
            sum += own;
        }
        spheres
    }

    /// The height where a share of the length of all spans lies below.
    fn height_at(&self, share: f64) -> f64 {
        let whole: f64 = self.spans.iter().map(|s| s[1] - s[0]).sum();
        let mut rest = share * whole;
        for [begin, end] in self.spans {
            if rest <= end - begin {
                return begin + rest;
            }
            rest -= end - begin;
        }
        self.spans.last().map_or(0.0, |s| s[1])
    }

    /// Moves a sphere back into the span that it is nearest to; wraps where there is one span alone.
    fn keep_in_span(&self, sphere: &mut Sphere) -> f64 {
        let z = sphere.center.z;
        if self.spans.len() < 2 {
            sphere.center.z = z.rem_euclid(self.period);
            return 0.0;
        }
        let beyond = |s: &&[f64; 2]| (s[0] - z).max(z - s[1]).max(0.0);
        let nearest = self
            .spans
            .iter()
            .min_by(|a, b| beyond(a).total_cmp(&beyond(b)));
        let Some(&[begin, end]) = nearest else {
            return 0.0;
        };
        let (lo, hi) = (begin + sphere.radius, end - sphere.radius);
        let kept = if lo < hi {
            z.clamp(lo, hi)
        } else {
            0.5 * (begin + end)
        };
        sphere.center.z = kept;
        (kept - z).abs()
    }

    /// One round: overlapping pairs step apart, spheres outside step in. The longest way that one
    /// moved, and the greatest overlap before, as a share of the radius.
    fn push_apart(
        &self,
        spheres: &mut [Sphere],
        pairs: &[(u32, u32)],
        wall: &Wall<'_>,
    ) -> (f64, f64) {
        let mut worst = 0.0f64;
        let before: Vec<DVec3> = spheres.iter().map(|s| s.center).collect();
        for &(i, j) in pairs {
            let (i, j) = (i as usize, j as usize);
            let apart = self.apart(spheres[i].center, spheres[j].center);
            let reach = spheres[i].radius + spheres[j].radius + WALL_UM;
            if apart.length_squared() >= reach * reach {
                continue;
            }
            let gap = apart.length() - reach;
            worst = worst.max((-gap - 0.5 * WALL_UM) / (reach - WALL_UM));
            // The small one yields; a little more than needed, or the end is approached for ever.
            let (a, b) = (spheres[i].radius.powi(2), spheres[j].radius.powi(2));
            let push = apart.try_normalize().unwrap_or(DVec3::Z) * (-0.6 * gap + 1e-3);
            spheres[i].center -= push * (2.0 * b / (a + b));
            spheres[j].center += push * (2.0 * a / (a + b));
        }
        let mut longest = 0.0f64;
        for (sphere, before) in spheres.iter_mut().zip(before) {
            let over = wall.pull_inside(sphere);
            let over = over.max(self.keep_in_span(sphere));
            worst = worst.max(over / sphere.radius);
            longest = longest.max(self.apart(before, sphere.center).length_squared());
        }
        (longest.sqrt(), worst)
    }

    /// From `a` to the nearest image of `b`.
    fn apart(&self, a: DVec3, b: DVec3) -> DVec3 {
        let mut d = b - a;
        d.z -= self.period * (d.z / self.period).round();
        d
    }

    /// Pairs that overlap or are nearer than `skin`.
    fn for_each_pair(&self, spheres: &[Sphere], skin: f64, mut visit: impl FnMut(u32, u32)) {
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
                if dz > spheres[i].radius + largest + WALL_UM + skin {
                    break;
                }
                let reach = spheres[i].radius + spheres[j].radius + WALL_UM + skin;
                let d = self.apart(spheres[i].center, spheres[j].center);
                if d.length_squared() < reach * reach {
                    visit(i as u32, j as u32);
                }
            }
        }
    }

    /// Shrinks all spheres alike until none overlap or reach out.
    fn shrink_to_fit(&self, spheres: &mut [Sphere], wall: &Wall<'_>) {
        let mut factor = 1.0f64;
        self.for_each_pair(spheres, 0.0, |i, j| {
            let (p, q) = (&spheres[i as usize], &spheres[j as usize]);
            let apart = self.apart(p.center, q.center).length();
            // Half the least wall is kept in any case.
            let fits = (apart - 0.5 * WALL_UM) / (p.radius + q.radius);
            factor = factor.min(fits.max(0.0));
        });
        for sphere in spheres.iter() {
            let outside = wall.reach_outside(sphere).max(0.0);
            factor = factor.min(1.0 - outside / sphere.radius);
        }
        if factor < 1.0 {
            for sphere in spheres {
                sphere.radius *= factor.max(0.0);
            }
        }
    }
}

/// The wall of the tube: the ellipse, or the edge, with shallow dents.
struct Wall<'a> {
    edge: Option<&'a Edge>,
    axes: DVec2,
    semi: DVec2,
    depth: f64,
    /// Wave numbers round and along, and phases.
    waves: [[f64; 3]; 6],
}

impl<'a> Wall<'a> {
    fn new(recipe: &Recipe<'a>, seed: u64) -> Self {
        let round = std::f64::consts::PI * (recipe.semi.x + recipe.semi.y) / DENT_UM;
        let along = recipe.period / DENT_UM;
        let mut rng = Rng::new(seed ^ 0x3a11_0000, 0);
        let waves = [(); 6].map(|()| {
            let m = (round * (2.0 * rng.uniform() - 1.0)).round();
            let n = (along * (2.0 * rng.uniform() - 1.0)).round();
            [
                m,
                n * std::f64::consts::TAU / recipe.period,
                std::f64::consts::TAU * rng.uniform(),
            ]
        });
        Self {
            edge: recipe.edge,
            axes: recipe.axes,
            semi: recipe.semi,
            depth: recipe.wobble,
            waves,
        }
    }

    /// Its size beside a point over that without dents.
    fn scale_at(&self, p: DVec3) -> f64 {
        if self.depth == 0.0 {
            return 1.0;
        }
        let phi = (p.y * self.semi.x).atan2(p.x * self.semi.y);
        let sum: f64 = self
            .waves
            .iter()
            .map(|[m, n, phase]| (m * phi + n * p.z + phase).cos())
            .sum();
        // The sum of six waves has a deviation of 1.7; dents point inward only.
        let dent = (0.5 + 0.25 * sum).clamp(0.0, 1.0);
        1.0 - self.depth * dent
    }

    /// Its point nearest to the center of a sphere, and whether the center is inside.
    fn nearest(&self, sphere: &Sphere) -> (DVec2, bool) {
        let scale = self.scale_at(sphere.center);
        let c = sphere.center.truncate();
        match self.edge {
            None => {
                let semi = scale * self.semi;
                let inside = (c / semi).length_squared() < 1.0;
                (nearest_on_ellipse(c, semi), inside)
            }
            Some(edge) => {
                let psi = (c.y / self.axes.y).atan2(c.x / self.axes.x);
                let inside = c.length() < scale * edge.at(psi).length();
                (edge.near(c, self.axes, scale), inside)
            }
        }
    }

    /// How far a sphere reaches over the wall: at the normal of the nearest direction, to first order.
    fn reach_outside(&self, sphere: &Sphere) -> f64 {
        let (nearest, inside) = self.nearest(sphere);
        let distance = nearest.distance(sphere.center.truncate());
        sphere.radius - if inside { distance } else { -distance }
    }

    /// Moves a sphere that reaches out back in. How far it reached.
    fn pull_inside(&self, sphere: &mut Sphere) -> f64 {
        let (nearest, inside) = self.nearest(sphere);
        let c = sphere.center.truncate();
        let apart = nearest - c;
        let distance = apart.length() * if inside { 1.0 } else { -1.0 };
        let over = sphere.radius - distance;
        if over <= 0.0 {
            return 0.0;
        }
        let outward = match self.edge {
            None => (nearest / (self.semi * self.semi)).normalize(),
            // Along the way to the wall, which meets it squarely.
            Some(_) => (apart * distance.signum())
                .try_normalize()
                .unwrap_or_else(|| nearest.normalize_or_zero()),
        };
        let c = nearest - outward * (sphere.radius + 1e-3);
        sphere.center = c.extend(sphere.center.z);
        over
    }
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
