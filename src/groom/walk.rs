//! Straight ways over the skin, across its edges.

use super::follicle::Follicle;
use crate::skin::Skin;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// A way over more edges ends there: the skin is finer than any hair's distance from its neighbors.
const MAX_EDGES: usize = 256;

/// No triangle.
const NONE: u32 = u32::MAX;

/// A skin to walk on.
pub(super) struct Ground<'a> {
    skin: &'a Skin,
    /// For each triangle, those beyond the edges opposite to its corners.
    beyond: Vec<[u32; 3]>,
}

impl<'a> Ground<'a> {
    pub(super) fn new(skin: &'a Skin) -> Self {
        // Seams have vertices of their own on both sides: places count, not indices.
        let mut same = HashMap::with_capacity(skin.positions.len());
        let welded: Vec<u32> = (skin.positions.iter().enumerate())
            .map(|(i, p)| {
                let key = (*p + 0.0).to_array().map(f32::to_bits);
                *same.entry(key).or_insert(i as u32)
            })
            .collect();
        let mut open: HashMap<(u32, u32), (u32, u8)> = HashMap::new();
        let mut beyond = vec![[NONE; 3]; skin.triangles.len()];
        for (t, corners) in skin.triangles.iter().enumerate() {
            for k in 0..3 {
                let [a, b] =
                    [corners[(k + 1) % 3], corners[(k + 2) % 3]].map(|v| welded[v as usize]);
                let edge = (a.min(b), a.max(b));
                // Where more than two triangles meet, two of them are joined.
                if let Some((other, side)) = open.remove(&edge) {
                    beyond[t][k] = other;
                    beyond[other as usize][usize::from(side)] = t as u32;
                } else {
                    open.insert(edge, (t as u32, k as u8));
                }
            }
        }
        Self { skin, beyond }
    }

    /// The place at a distance from another, straight on as a thread would be drawn over the skin; the border
    /// if the skin ends before.
    ///
    /// * `direction`: of the way, along the skin. * `distance`: meters.
    pub(super) fn go(&self, from: &Follicle, direction: Vec3, distance: f32) -> Follicle {
        let mut triangle = from.triangle as usize;
        let [u, v] = from.barycentric.map(f64::from);
        let mut weights = [1.0 - u - v, u, v];
        let (mut direction, mut left) = (direction.as_dvec3(), f64::from(distance));
        let mut entered = None;
        for _ in 0..MAX_EDGES {
            let corners = self.skin.corners(triangle).map(|p| p.as_dvec3());
            let Some(normal) = normal_of(corners) else {
                break;
            };
            let Some(along) = (direction - normal * direction.dot(normal)).try_normalize() else {
                break;
            };
            let rates = rates(corners, along);
            let exit = (0..3)
                .filter(|&k| rates[k] < 0.0 && entered != Some(k))
                .map(|k| (weights[k].max(0.0) / -rates[k], k))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let step = exit.map_or(left, |(way, _)| way.min(left));
            for k in 0..3 {
                weights[k] += step * rates[k];
            }
            left -= step;
            let Some((_, side)) = exit.filter(|_| left > 0.0) else {
                break;
            };
            let other = self.beyond[triangle][side];
            if other == NONE {
                break;
            }
            let next = other as usize;
            let edge = [(side + 1) % 3, (side + 2) % 3];
            let point = corners[edge[0]] * weights[edge[0]] + corners[edge[1]] * weights[edge[1]];
            let Some(side) = (self.beyond[next].iter()).position(|&t| t as usize == triangle)
            else {
                break;
            };
            let new = self.skin.corners(next).map(|p| p.as_dvec3());
            let (a, b) = (new[(side + 1) % 3], new[(side + 2) % 3]);
            let Some(edge) = (b - a).try_normalize() else {
                break;
            };
            // Unfolded about the edge, the way goes straight on.
            let inward = new[side] - a;
            let Some(inward) = (inward - edge * inward.dot(edge)).try_normalize() else {
                break;
            };
            let by = along.dot(edge).clamp(-1.0, 1.0);
            direction = by * edge + (1.0 - by * by).sqrt() * inward;
            let t = ((point - a).dot(edge) / (b - a).length()).clamp(0.0, 1.0);
            weights = [0.0; 3];
            weights[(side + 1) % 3] = 1.0 - t;
            weights[(side + 2) % 3] = t;
            triangle = next;
            entered = Some(side);
        }
        let sum: f64 = weights.iter().map(|w| w.max(0.0)).sum();
        let [_, u, v] = weights.map(|w| (w.max(0.0) / sum) as f32);
        let [a, b, c] = self.skin.corners(triangle);
        Follicle {
            position: a * (1.0 - u - v) + b * u + c * v,
            triangle: triangle as u32,
            barycentric: [u, v],
        }
    }
}

fn normal_of([a, b, c]: [DVec3; 3]) -> Option<DVec3> {
    (b - a).cross(c - a).try_normalize()
}

/// How the weights of the corners change along a direction, per meter.
fn rates([a, b, c]: [DVec3; 3], along: DVec3) -> [f64; 3] {
    let doubled = (b - a).cross(c - a);
    let scale = doubled / doubled.length_squared();
    let of = |p: DVec3, q: DVec3| (q - p).cross(along).dot(scale);
    [of(b, c), of(c, a), of(a, b)]
}
