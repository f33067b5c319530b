//! The skin as a net of evenly spread points: what patterns live on, whatever the triangles are like.

use crate::groom::follicle::{Follicle, Surface};
use crate::groom::noise::Symmetry;
use crate::math::cells::CellMap;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Neighbors are this many spacings apart at most: some sixteen of them.
const REACH: f32 = 2.1;
/// Least cosine between the normals of neighbors: the two sides of an ear are none.
const SAME_SIDE: f32 = 0.2;
/// Points looked at around a hair's root, in spacings.
const LOOK: f32 = 1.6;

/// Points on the skin and their neighbors.
pub(super) struct Net {
    pub(super) positions: Vec<Vec3>,
    pub(super) normals: Vec<Vec3>,
    /// Lay of the hair, unit tangents.
    pub(super) lay: Vec<Vec3>,
    pub(super) uvs: Vec<Vec2>,
    /// Mean distance of nearest points, meters.
    pub(super) spacing: f32,
    /// Neighbors of point `i`: `neighbors[first[i]..first[i + 1]]`.
    first: Vec<u32>,
    neighbors: Vec<u32>,
    cells: CellMap<[i32; 3], Vec<u32>>,
}

impl Net {
    /// * `follicles`: evenly spread over `surface`.
    /// * `spacing`: their mean distance, meters.
    pub(super) fn new(surface: &Surface, follicles: &[Follicle], spacing: f32) -> Self {
        let roots: Vec<_> = follicles.iter().map(|f| surface.root(f)).collect();
        let mut net = Self {
            positions: roots.iter().map(|r| r.position).collect(),
            normals: roots.iter().map(|r| r.normal).collect(),
            lay: roots.iter().map(|r| r.combing).collect(),
            uvs: follicles.iter().map(|f| surface.uv(f)).collect(),
            spacing,
            first: vec![0],
            neighbors: Vec::new(),
            cells: CellMap::default(),
        };
        for (i, p) in net.positions.iter().enumerate() {
            let cell = net.cell_of(*p);
            net.cells.entry(cell).or_default().push(i as u32);
        }
        let reach = REACH * spacing;
        let lists: Vec<Vec<u32>> = (0..net.len())
            .into_par_iter()
            .with_min_len(256)
            .map(|i| {
                let near = net.around(net.positions[i], reach);
                let same = |j: &u32| {
                    let j = *j as usize;
                    j != i && net.normals[i].dot(net.normals[j]) > SAME_SIDE
                };
                near.filter(same).collect()
            })
            .collect();
        for list in lists {
            net.neighbors.extend(list);
            net.first.push(net.neighbors.len() as u32);
        }
        net
    }

    pub(super) fn len(&self) -> usize {
        self.positions.len()
    }

    pub(super) fn neighbors(&self, i: usize) -> &[u32] {
        &self.neighbors[self.edges(i)]
    }

    /// Where the neighbors of point `i` stand in a list of all edges.
    pub(super) fn edges(&self, i: usize) -> std::ops::Range<usize> {
        self.first[i] as usize..self.first[i + 1] as usize
    }

    pub(super) fn edge_count(&self) -> usize {
        self.neighbors.len()
    }

    fn cell_of(&self, p: Vec3) -> [i32; 3] {
        (p / (REACH * self.spacing)).floor().as_ivec3().to_array()
    }

    /// Points within `reach` of a place.
    fn around(&self, p: Vec3, reach: f32) -> impl Iterator<Item = u32> + '_ {
        let (lo, hi) = (self.cell_of(p - reach), self.cell_of(p + reach));
        let cells = (lo[0]..=hi[0]).flat_map(move |x| {
            (lo[1]..=hi[1]).flat_map(move |y| (lo[2]..=hi[2]).map(move |z| [x, y, z]))
        });
        cells
            .filter_map(|cell| self.cells.get(&cell))
            .flatten()
            .copied()
            .filter(move |&j| self.positions[j as usize].distance_squared(p) < reach * reach)
    }

    /// The point nearest to a place, however far.
    pub(super) fn nearest(&self, p: Vec3) -> Option<usize> {
        let off = |i: &usize| self.positions[*i].distance_squared(p);
        (0..self.len()).min_by(|a, b| off(a).total_cmp(&off(b)))
    }

    /// Values at the points of a coarser net, blended at the points of this one.
    pub(super) fn lift(&self, coarse: &Self, values: &[f32]) -> Vec<f32> {
        (0..self.len())
            .into_par_iter()
            .with_min_len(256)
            .map_with(Vec::new(), |near, i| {
                let (p, n) = (self.positions[i], self.normals[i]);
                coarse.weights(p, n, near);
                if near.is_empty() {
                    return coarse.nearest(p).map_or(0.0, |j| values[j]);
                }
                near.iter().map(|&(j, w)| w * values[j as usize]).sum()
            })
            .collect()
    }

    /// Where points of one side of a body have their mirror images: for each of them its index and weights of the
    /// points there.
    pub(super) fn images(&self, symmetry: Symmetry<'_>) -> Vec<(usize, Vec<(u32, f32)>)> {
        let points = (0..self.len()).into_par_iter().with_min_len(256);
        let image = |i: usize| {
            let (p, n) = symmetry.fold(self.positions[i], self.normals[i])?;
            let mut near = Vec::new();
            self.weights(p, n, &mut near);
            (!near.is_empty()).then_some((i, near))
        };
        points.filter_map(image).collect()
    }

    /// Points around a hair's root on its side of the skin, with weights that sum to 1; none far from
    /// all points.
    pub(super) fn weights(&self, position: Vec3, normal: Vec3, found: &mut Vec<(u32, f32)>) {
        let reach = LOOK * self.spacing;
        let weight = |j: u32| {
            let far = self.positions[j as usize].distance_squared(position);
            let facing = (self.normals[j as usize].dot(normal) - SAME_SIDE).max(0.0);
            facing * (-far / (0.5 * self.spacing * self.spacing)).exp()
        };
        found.clear();
        found.extend(self.around(position, reach).map(|j| (j, weight(j))));
        let sum: f32 = found.iter().map(|(_, w)| w).sum();
        if sum <= 0.0 {
            found.clear();
        }
        for (_, w) in found {
            *w /= sum;
        }
    }

    /// Length of the way along the skin from the nearest of some places to each point, meters
    /// (Dijkstra 1959 over the edges, some percent too long); infinite where no way leads.
    pub(super) fn distances(&self, from: &[Vec3]) -> Vec<f32> {
        let mut distance = vec![f32::INFINITY; self.len()];
        let mut front = BinaryHeap::new();
        // Bits of positive floats are in their order.
        for start in from.iter().filter_map(|&p| self.nearest(p)) {
            distance[start] = 0.0;
            front.push(Reverse((0u32, start as u32)));
        }
        while let Some(Reverse((bits, i))) = front.pop() {
            let (i, here) = (i as usize, f32::from_bits(bits));
            if here > distance[i] {
                continue;
            }
            for &j in self.neighbors(i) {
                let j = j as usize;
                let there = here + self.positions[i].distance(self.positions[j]);
                if there < distance[j] {
                    distance[j] = there;
                    front.push(Reverse((there.to_bits(), j as u32)));
                }
            }
        }
        distance
    }
}
