//! Where hairs grow: points on the skin with a blue-noise spectrum, in an order of which every
//! prefix is blue noise too.
//!
//! Dart throwing with a radius that shrinks as points accumulate (McCool and Fiume 1992,
//! "Hierarchical Poisson disk sampling distributions"). Darts are thrown in rounds: the test
//! against earlier rounds runs in parallel, the test within the round in order, so that the result
//! does not depend on threads. Nothing depends on how many points are wanted, so fewer points are
//! the first of more.

use super::GroomError;
use super::vary::Varied;
use crate::progress::{Cancel, Progress};
use crate::sampling::{Rng, hash64};
use crate::skin::Skin;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::borrow::Cow;

/// Least distance of two points over that of a hexagonal packing of as many. Random darts fill up
/// at 0.78; the closer to that, the more darts miss (12 for a hit at 0.68, more than 100 at 0.76).
const PACKING: f64 = 0.68;

/// Below this share of the distance that they should have, points are crowded.
const CROWDED: f64 = 0.75;

/// The radius follows the number of points in steps of this share; small steps keep prefixes even.
const STEP: usize = 8;

/// The density factor below which spacing grows no further, relative to the largest factor. Lower
/// makes the search around a dart wide, higher lets sparse hairs clump.
const SPARSEST: f32 = 0.05;

/// The seed of one class's follicles.
pub(super) fn class_seed(seed: u64, class: usize) -> u64 {
    hash64(hash64(seed) ^ (class as u64 + 1))
}

/// A point on the skin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Follicle {
    position: Vec3,
    triangle: u32,
    barycentric: [f32; 2],
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
        let (mut sum, mut weighted_area, mut densest) = (0.0, 0.0, 0.0f32);
        let cumulative: Vec<f64> = (0..skin.triangles.len())
            .map(|i| {
                let area = skin.triangle_area(i);
                let [a, b, c] = skin.triangles[i].map(|v| density[v as usize]);
                let top = a.max(b).max(c);
                densest = densest.max(top);
                weighted_area += area * f64::from(a + b + c) / 3.0;
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
            length: self.blend(follicle, &self.skin.length),
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

    /// Dart `index`: a random point and its density factor; `None` where the skin is sparser than
    /// the dart's luck.
    fn dart(&self, seed: u64, index: u64) -> Option<(Follicle, f32)> {
        let mut rng = Rng::new(seed, index);
        let total = self.cumulative.last().copied().unwrap_or(0.0);
        // 32 bits would step over small triangles of large meshes.
        let at = (rng.uniform() + rng.uniform() / 4_294_967_296.0) * total;
        let triangle = self.triangle_at(at, total);
        let (mut u, mut v) = (rng.uniform_f32(), rng.uniform_f32());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let [a, b, c] = self.skin.corners(triangle);
        let follicle = Follicle {
            position: a * (1.0 - u - v) + b * u + c * v,
            triangle: triangle as u32,
            barycentric: [u, v],
        };
        let corners = self.skin.triangles[triangle].map(|v| self.density[v as usize]);
        let top = corners[0].max(corners[1]).max(corners[2]);
        let density = self.blend(&follicle, &self.density);
        (rng.uniform_f32() * top < density).then_some((follicle, density))
    }

    /// The first `count` follicles under `seed`.
    pub(super) fn scatter(
        &self,
        seed: u64,
        count: usize,
        progress: &dyn Progress,
        cancel: &Cancel,
    ) -> Result<Scattered, GroomError> {
        let mut taken: Vec<Follicle> = Vec::with_capacity(count.min(1 << 20));
        let mut grid = Grid::default();
        let (mut next_dart, mut slack) = (0u64, 1.0);
        let mut crowded = None;
        while taken.len() < count {
            if cancel.is_cancelled() {
                return Err(GroomError::Cancelled);
            }
            let goal = (taken.len() + taken.len() / STEP).max(64);
            let hexagonal = (2.0 / 3f64.sqrt() * self.weighted_area / goal as f64).sqrt();
            let unit_radius = (PACKING * slack * hexagonal) as f32;
            let radius = |density: f32| unit_radius / density.max(SPARSEST * self.densest).sqrt();
            grid.prepare(goal, radius(self.densest));

            let survivors: Vec<Option<(Follicle, f32)>> = (0..goal)
                .into_par_iter()
                .with_min_len(256)
                .map(|i| self.dart(seed, next_dart + i as u64))
                .map(|dart| dart.filter(|(f, d)| grid.is_free(f.position, radius(*d))))
                .collect();
            next_dart += goal as u64;
            let before = taken.len();
            for (follicle, density) in survivors.into_iter().flatten() {
                if taken.len() < goal && grid.is_free(follicle.position, radius(density)) {
                    grid.insert(follicle.position);
                    taken.push(follicle);
                }
            }
            let hits = taken.len() - before;
            // Thin or folded skin can be full before its area says so.
            if hits * 100 < goal && taken.len() < goal {
                slack *= 0.95;
                if slack < CROWDED {
                    crowded.get_or_insert(taken.len());
                }
            }
            progress.advance(hits.min(count.saturating_sub(before)) as u64);
        }
        taken.truncate(count);
        Ok(Scattered {
            crowded: count.saturating_sub(crowded.unwrap_or(count)),
            follicles: taken,
        })
    }
}

/// Points on the skin.
pub(super) struct Scattered {
    /// In their order: of these any first ones are evenly spread too.
    pub(super) follicles: Vec<Follicle>,
    /// How many of them, the last ones, had no room at the distance that they should have.
    crowded: usize,
}

impl Scattered {
    /// What is to be said of follicles that stand closer than they should.
    pub(super) fn crowding(&self, class: &str, skin: &Skin) -> Option<String> {
        (self.crowded > 0).then(|| {
            format!(
                "{} of {} strands of `{class}` had no room and stand closer than evenly: skin `{}` lies \
                 folded on itself or in several layers",
                self.crowded,
                self.follicles.len(),
                skin.name
            )
        })
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

/// Points hashed by the cube they lie in; chains are linked by index.
#[derive(Default)]
struct Grid {
    cell: f32,
    heads: Vec<u32>,
    nodes: Vec<(Vec3, u32)>,
}

const END: u32 = u32::MAX;

impl Grid {
    /// Makes room for `count` points and cells that suit `radius`.
    fn prepare(&mut self, count: usize, radius: f32) {
        let crowded = count > self.heads.len();
        if !crowded && radius * 4.0 >= self.cell {
            return;
        }
        self.cell = radius * 2.0;
        let size = (2 * count).next_power_of_two().max(1024);
        self.heads.clear();
        self.heads.resize(size, END);
        for i in 0..self.nodes.len() {
            self.link(i as u32);
        }
    }

    fn insert(&mut self, position: Vec3) {
        self.nodes.push((position, END));
        self.link(self.nodes.len() as u32 - 1);
    }

    fn link(&mut self, index: u32) {
        let slot = self.slot(
            (self.nodes[index as usize].0 / self.cell)
                .floor()
                .as_ivec3(),
        );
        self.nodes[index as usize].1 = self.heads[slot];
        self.heads[slot] = index;
    }

    fn slot(&self, cell: glam::IVec3) -> usize {
        let mixed = (cell.x as u32).wrapping_mul(0x8da6_b343)
            ^ (cell.y as u32).wrapping_mul(0xd816_3841)
            ^ (cell.z as u32).wrapping_mul(0xcb1a_b31f);
        (mixed ^ (mixed >> 15)) as usize & (self.heads.len() - 1)
    }

    /// Whether no point lies closer than `radius`.
    fn is_free(&self, position: Vec3, radius: f32) -> bool {
        let lo = ((position - radius) / self.cell).floor().as_ivec3();
        let hi = ((position + radius) / self.cell).floor().as_ivec3();
        let limit = radius * radius;
        for x in lo.x..=hi.x {
            for y in lo.y..=hi.y {
                for z in lo.z..=hi.z {
                    let mut index = self.heads[self.slot(glam::IVec3::new(x, y, z))];
                    while index != END {
                        let (other, next) = self.nodes[index as usize];
                        if other.distance_squared(position) < limit {
                            return false;
                        }
                        index = next;
                    }
                }
            }
        }
        true
    }
}
