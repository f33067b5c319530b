//! The skin at the places where hairs grow, and darts thrown at it.

use super::GroomError;
use super::vary::Varied;
use crate::sampling::{Rng, hash64};
use crate::skin::Skin;
use glam::{Vec2, Vec3};
use std::borrow::Cow;
use std::ops::Range;

/// The seed of one class's follicles.
pub(super) fn class_seed(seed: u64, class: usize) -> u64 {
    hash64(hash64(seed) ^ (class as u64 + 1))
}

/// A point on the skin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Follicle {
    /// On the triangle.
    pub(super) position: Vec3,
    pub(super) triangle: u32,
    pub(super) barycentric: [f32; 2],
}

/// The skin at a follicle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root {
    /// On the triangle.
    pub(super) position: Vec3,
    /// Unit, interpolated.
    pub(super) normal: Vec3,
    /// Unit, tangent.
    pub(super) combing: Vec3,
    /// The same as the skin has it, before anything combs it.
    pub(super) lay: Vec3,
    /// Factor on length.
    pub(super) length: f32,
    /// What else varies over the skin.
    pub(super) vary: Varied,
}

/// The skin as something to throw darts at, uniformly by area times density factor.
pub(super) struct Surface<'a> {
    skin: &'a Skin,
    /// Density factor at each vertex.
    density: Cow<'a, [f32]>,
    /// Running sum of area times largest corner density.
    cumulative: Vec<f64>,
    /// Where to begin to look in `cumulative`: for each of as many equal parts of the total.
    guide: Vec<u32>,
    weighted_area: f64,
    /// Largest density factor.
    pub(super) densest: f32,
    /// Mean density factor of the triangles that have hair.
    pub(super) mean: f32,
    /// Lower corner of a box around the skin.
    pub(super) corner: Vec3,
}

/// A triangle while darts are thrown at it.
struct Target {
    triangle: usize,
    corners: [Vec3; 3],
    density: [f32; 3],
    densest: f32,
}

impl<'a> Surface<'a> {
    pub(super) fn new(skin: &'a Skin) -> Result<Self, GroomError> {
        check(skin)?;
        Self::with_density(skin, Cow::Borrowed(&skin.density))
    }

    /// The same density wherever there is hair at all.
    pub(super) fn even(skin: &'a Skin) -> Result<Self, GroomError> {
        check(skin)?;
        let any = skin.density.iter().map(|&d| f32::from(u8::from(d > 0.0)));
        Self::with_density(skin, any.collect())
    }

    fn with_density(skin: &'a Skin, density: Cow<'a, [f32]>) -> Result<Self, GroomError> {
        let (mut sum, mut weighted_area, mut haired, mut densest) = (0.0, 0.0, 0.0, 0.0f32);
        let cumulative: Vec<f64> = (0..skin.triangles.len())
            .map(|i| {
                let area = skin.triangle_area(i);
                let [a, b, c] = skin.triangles[i].map(|v| density[v as usize]);
                let top = a.max(b).max(c);
                densest = densest.max(top);
                weighted_area += area * f64::from(a + b + c) / 3.0;
                haired += if top > 0.0 { area } else { 0.0 };
                sum += area * f64::from(top);
                sum
            })
            .collect();
        if !(weighted_area > 0.0 && f64::is_finite(sum)) {
            return Err(GroomError::BareSkin {
                skin: skin.name.clone(),
                area_m2: weighted_area,
            });
        }
        let parts = cumulative.len();
        let mut at = 0;
        let guide = (0..parts)
            .map(|part| {
                // A part begins where the one before ends, or one earlier for rounding.
                let from = sum * part as f64 / parts as f64 * (1.0 - 1e-12);
                while at + 1 < parts && cumulative[at] <= from {
                    at += 1;
                }
                at as u32
            })
            .collect();
        Ok(Self {
            skin,
            density,
            guide,
            cumulative,
            weighted_area,
            densest,
            mean: (weighted_area / haired) as f32,
            corner: skin.bounds().0,
        })
    }

    /// Integral of the density factor over the skin, square meters.
    pub(super) fn weighted_area(&self) -> f64 {
        self.weighted_area
    }

    /// Texture coordinates of a follicle.
    pub(super) fn uv(&self, follicle: &Follicle) -> Vec2 {
        self.blend(follicle, &self.skin.uvs)
    }

    /// Factor on the length of hair at a follicle.
    pub(super) fn length(&self, follicle: &Follicle) -> f32 {
        self.blend(follicle, &self.skin.length)
    }

    /// Triangle of a follicle, and the weights of the triangle's second and third corner there.
    pub(super) fn place(&self, follicle: &Follicle) -> (u32, Vec2) {
        (follicle.triangle, follicle.barycentric.into())
    }

    /// The skin at a follicle.
    pub(super) fn root(&self, follicle: &Follicle) -> Root {
        let normal = self.blend(follicle, &self.skin.normals);
        let normal = normal.try_normalize().unwrap_or_else(|| {
            let [a, b, c] = self.skin.corners(follicle.triangle as usize);
            (b - a).cross(c - a).normalize_or(Vec3::Y)
        });
        let combing = self.blend(follicle, &self.skin.combing);
        let lay = (combing - normal * combing.dot(normal))
            .try_normalize()
            .unwrap_or_else(|| normal.any_orthonormal_vector());
        Root {
            position: follicle.position,
            normal,
            combing: lay,
            lay,
            length: self.length(follicle),
            vary: Varied::NONE,
        }
    }

    fn blend<T>(&self, follicle: &Follicle, values: &[T]) -> T
    where
        T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
    {
        let [a, b, c] = self.skin.triangles[follicle.triangle as usize];
        let [u, v] = follicle.barycentric;
        values[a as usize] * (1.0 - u - v) + values[b as usize] * u + values[c as usize] * v
    }

    /// The first triangle whose running sum is above `at` (Chen and Asau 1974, "On generating random
    /// variates from an empirical distribution": a table to begin at makes the search short).
    fn triangle_at(&self, at: f64, total: f64) -> usize {
        let parts = self.guide.len();
        let part = ((at / total * parts as f64) as usize).min(parts - 1);
        let mut triangle = self.guide[part] as usize;
        while triangle + 1 < parts && self.cumulative[triangle] <= at {
            triangle += 1;
        }
        triangle
    }

    /// Throws some of `count` darts: random points, evenly spread along the list of triangles, so that those
    /// of neighboring numbers fall near each other. `hit` is told the place and the density factor there;
    /// where the skin is sparse it is not told of all darts.
    pub(super) fn darts(
        &self,
        rng: &mut Rng,
        darts: Range<usize>,
        count: usize,
        mut hit: impl FnMut(&mut Rng, Follicle, f32),
    ) {
        let total = self.cumulative.last().copied().unwrap_or(0.0);
        let step = total / count as f64;
        let mut target = self.target(self.triangle_at(darts.start as f64 * step, total));
        for dart in darts {
            let at = (dart as f64 + rng.uniform()) * step;
            if self.cumulative[target.triangle] <= at {
                target = self.target(self.triangle_at(at, total));
            }
            let (mut u, mut v) = (rng.uniform_f32(), rng.uniform_f32());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let w = 1.0 - u - v;
            let [a, b, c] = target.density;
            let density = a * w + b * u + c * v;
            if rng.uniform_f32() * target.densest < density {
                let [a, b, c] = target.corners;
                let follicle = Follicle {
                    position: a * w + b * u + c * v,
                    triangle: target.triangle as u32,
                    barycentric: [u, v],
                };
                hit(rng, follicle, density);
            }
        }
    }

    fn target(&self, triangle: usize) -> Target {
        let density = self.skin.triangles[triangle].map(|v| self.density[v as usize]);
        Target {
            triangle,
            corners: self.skin.corners(triangle),
            density,
            densest: density[0].max(density[1]).max(density[2]),
        }
    }
}

fn check(skin: &Skin) -> Result<(), GroomError> {
    let bad = |reason: String| {
        Err(GroomError::BadSkin {
            skin: skin.name.clone(),
            reason,
        })
    };
    let n = skin.positions.len();
    let lengths = [
        skin.normals.len(),
        skin.uvs.len(),
        skin.combing.len(),
        skin.length.len(),
        skin.density.len(),
    ];
    if lengths.iter().any(|&l| l != n) {
        return bad(format!("{n} positions but other arrays of {lengths:?}"));
    }
    if let Some(t) = (skin.triangles.iter()).position(|t| t.iter().any(|&v| v as usize >= n)) {
        return bad(format!(
            "triangle {t} has a vertex beyond the last one, {n}"
        ));
    }
    for i in 0..n {
        let vectors = [skin.positions[i], skin.normals[i], skin.combing[i]];
        let numbers = [skin.length[i], skin.density[i]];
        if !(vectors.iter().all(|v| v.is_finite())
            && numbers.iter().all(|v| v.is_finite() && *v >= 0.0))
        {
            return bad(format!(
                "vertex {i} has a number that is not finite or below 0"
            ));
        }
    }
    Ok(())
}
