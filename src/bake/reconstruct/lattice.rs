//! S of all nodes on one lattice.
//!
//! With inclinations `q` of the query and `o` of an exit, `x = q + o` measures from the specular cone
//! and `y = (q - o) / 2` runs along it. In the cone frame the texel of a node at inclination `t` holds
//! light of `x = center + t`, whatever its query was within the bin. Lobes are narrow along x and change
//! slowly along y and azimuth, so that nodes can help each other. And S is reciprocal: S(q, o, phi)
//! = S(o, q, -phi), which is y -> -y. A photon from `q` to `o` tells as much of light from `o` to `q`;
//! of grazing exits, where the cosine lets few photons out, most of what is known comes so.
//!
//! Fibers of one's choice need not be mirror images of themselves, nor are those of elliptic section
//! reciprocal when all sides are seen alike: what is read off the lattice is a first guess, and what
//! photons say against it is put right per node.

use super::field::{Field, Plane};
use crate::math::frame;
use crate::math::unicube::Unicube;
use crate::math::widest;
use crate::table::Nodes;
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Finest lattice along x and azimuth: one cell a texel of a face with 64.
const FINEST: usize = 64;
/// Points of a texel along each side that are placed on the lattice.
const SIDE: usize = 3;
/// Numbers that are read off several lattices at a time: as many as a cache line holds.
pub(super) const STRIP: usize = 16;
/// Steps of the integrals over a bin.
const STEPS: usize = 32;

/// A point of a texel.
#[derive(Clone, Copy, Debug, Default)]
struct Point {
    /// Inclination in cells, and over how many of them it stands, at most one: rows of points lie about half a cell apart, near
    /// the equator all along it, and with whole points to a cell tables ripple by 8 % there.
    theta: f32,
    reach: f32,
    /// `1 / (cos(inclination) points)`.
    weight: f32,
    /// The first cell of the azimuths that it stands for, and the share of them in the next: strips of a face are not equally
    /// wide in azimuth, and with whole points to a cell tables ripple by 5 %.
    phi: u32,
    beyond: f32,
    /// Between the centers of which cell and the next it lies, and how far from the first; even at both ends.
    low: u32,
    high: f32,
}

/// Which photons of which node tell of which cells.
#[derive(Debug)]
pub(super) struct Lattice {
    size: [usize; 3],
    /// Where inclination 0 of a node lies along x, in cells.
    zeros: Vec<f32>,
    /// `[node * nx + x]`: integral over the bin, with the density of queries, of `cos^2 o`.
    mass: Vec<f32>,
    /// Where the shares of `[node * nx + x]` begin.
    starts: Vec<usize>,
    /// Cells along y and their shares of that integral.
    shares: Vec<(usize, f32)>,
    /// Of every cell of a map.
    points: Vec<[Point; SIDE * SIDE]>,
    /// Texels of a map that are one cell, over those that fall on one place of the lattice.
    sides: f64,
}

impl Lattice {
    /// * `texels`: the texel of every cell of a map.
    /// * `folded`: a cell is a texel and its mirror image.
    pub(super) fn new(cube: &Unicube, nodes: &Nodes, texels: &[[usize; 2]], folded: bool) -> Self {
        let face = cube.res().min(FINEST);
        let ny = if nodes.len() < 24 { 12 } else { 24 };
        let size = [4 * face, ny, face];
        let (mut mass, mut starts, mut shares) = (Vec::new(), vec![0], Vec::new());
        let mut cells = vec![0.0; ny];
        for bin in nodes.edges.windows(2) {
            let queries = (0..STEPS).map(|step| {
                let along = (step as f64 + 0.5) / STEPS as f64;
                let query = bin[0] + (bin[1] - bin[0]) * along;
                (query, query.cos())
            });
            let queries: Vec<_> = queries.collect();
            for x in 0..size[0] {
                let x = 2.0 * PI * (x as f64 + 0.5) / size[0] as f64 - PI;
                cells.fill(0.0);
                for &(query, cos) in &queries {
                    if (x - query).abs() < FRAC_PI_2 {
                        let y = (query - 0.5 * x).abs() / FRAC_PI_2 * ny as f64;
                        cells[(y as usize).min(ny - 1)] += cos * (x - query).cos().powi(2);
                    }
                }
                let sum: f64 = cells.iter().sum();
                let density = (bin[1] - bin[0]) / (bin[1].sin() - bin[0].sin()) / STEPS as f64;
                mass.push((sum * density) as f32);
                let met = cells.iter().enumerate().filter(|(_, c)| **c > 0.0);
                shares.extend(met.map(|(y, c)| (y, (c / sum) as f32)));
                starts.push(shares.len());
            }
        }
        let cells = size[0] as f64 / (2.0 * PI);
        let azimuth = |w: DVec3| w.y.atan2(w.x).abs() / PI * size[2] as f64;
        // Azimuths of the strips that points of the four faces round the axis stand for.
        let (res, steps) = (cube.res(), SIDE * cube.res());
        let strips = (0..4 * steps).map(|strip| {
            let (face, step) = (strip / steps, strip % steps);
            let texel = face * res * res + step / SIDE;
            let along = |step: usize| step as f64 / SIDE as f64;
            let [a, b] = [step % SIDE, step % SIDE + 1]
                .map(|step| azimuth(cube.direction(texel, along(step), 0.5).0));
            (a.min(b), a.max(b))
        });
        let strips: Vec<(f64, f64)> = strips.collect();
        let inclination = |w: DVec3| frame::theta_of(w) * cells;
        // How far apart rows of points are in a texel, by the wider of the two ways to count them, in cells: along the
        // inclination and around.
        let rows = |texel: usize| {
            let [left, right] = [0.0, 1.0].map(|at| cube.direction(texel, at, 0.5).0);
            let [low, high] = [0.0, 1.0].map(|at| cube.direction(texel, 0.5, at).0);
            let apart = |of: &dyn Fn(DVec3) -> f64| {
                let sides = [(left, right), (low, high)].map(|(a, b)| (of(a) - of(b)).abs());
                (sides[0].max(sides[1]) / SIDE as f64).clamp(1e-6, 1.0)
            };
            [apart(&inclination), apart(&azimuth)]
        };
        let point = |texel: usize, [reach, around]: [f64; 2], i: usize| {
            let at = |i: usize| (i as f64 + 0.5) / SIDE as f64;
            let (w, _) = cube.direction(texel, at(i % SIDE), at(i / SIDE));
            let phi = azimuth(w);
            let face = texel / (res * res);
            let strip = strips.get(face * steps + texel % res * SIDE + i % SIDE);
            // On the faces at the poles rows of points run past each other, the diagonals along a border of cells.
            let around = (phi - 0.5 * around, phi + 0.5 * around);
            let (from, to) = strip.copied().unwrap_or(around);
            let last = size[2] - 1;
            let cell = (from.max(0.0) as usize).min(last);
            let beyond = (to - cell as f64 - 1.0).max(0.0) / (to - from);
            let phi = phi as f32;
            let at = (phi - 0.5).clamp(0.0, last as f32);
            let low = (at as usize).min(last - 1);
            Point {
                theta: inclination(w) as f32,
                reach: reach as f32,
                weight: (1.0 / w.x.hypot(w.y).max(1e-6) / (SIDE * SIDE) as f64) as f32,
                phi: cell as u32,
                beyond: if cell < last { beyond as f32 } else { 0.0 },
                low: low as u32,
                high: at - low as f32,
            }
        };
        Self {
            size,
            zeros: nodes
                .centers
                .iter()
                .map(|c| ((c + PI) * cells) as f32)
                .collect(),
            mass,
            starts,
            shares,
            points: texels
                .par_iter()
                .with_min_len(256)
                .map(|&[texel, _]| {
                    let rows = rows(texel);
                    std::array::from_fn(|i| point(texel, rows, i))
                })
                .collect(),
            sides: if folded { 1.0 } else { 2.0 },
        }
    }

    /// Cells along x, y and azimuth.
    pub(super) fn size(&self) -> [usize; 3] {
        self.size
    }

    /// Photons that reach a cell if S is 1, `[x][y]`.
    ///
    /// * `photons`: of every node.
    pub(super) fn exposure(&self, photons: &[f64]) -> Plane {
        let [nx, ny, np] = self.size;
        let mut plane = Plane::new(nx, ny);
        let cell = self.sides * 2.0 * PI / nx as f64 * PI / np as f64;
        for (node, photons) in photons.iter().enumerate() {
            for x in 0..nx {
                let scale = (photons * cell) as f32 * self.mass[node * nx + x];
                for &(y, share) in self.shares(node, x) {
                    plane.values[x * ny + y] += scale * share;
                }
            }
        }
        plane
    }

    fn shares(&self, node: usize, x: usize) -> &[(usize, f32)] {
        let at = node * self.size[0] + x;
        &self.shares[self.starts[at]..self.starts[at + 1]]
    }

    /// The first cell along x that a point stands for, and the share of it in the next.
    fn rows_of(&self, node: usize, point: &Point) -> (usize, f32) {
        let from = self.zeros[node] + point.theta - 0.5 * point.reach;
        let (first, last) = (from.max(0.0) as usize, self.size[0] - 1);
        let beyond = (from + point.reach - first as f32 - 1.0).max(0.0) / point.reach;
        match first < last {
            true => (first, beyond),
            false => (last, 0.0),
        }
    }

    /// Adds the photons of a node to the cells that they tell of, to several fields at once.
    ///
    /// * `counts`: photons of every cell of the map, from its density.
    pub(super) fn gather<const K: usize>(
        &self,
        node: usize,
        counts: impl Iterator<Item = [[f32; 4]; K]>,
        into: &mut [Field<4>; K],
    ) {
        let [_, ny, np] = self.size;
        let into = into.each_mut().map(|field| field.values.as_mut_slice());
        let all = counts.zip(&self.points);
        for (counts, points) in all.filter(|(counts, _)| *counts != [[0.0; 4]; K]) {
            let parts = counts.map(|count| count.map(|v| v / (SIDE * SIDE) as f32));
            for point in points {
                let (x, beyond) = self.rows_of(node, point);
                for (x, part) in [(x, 1.0 - beyond), (x + 1, beyond)] {
                    if part == 0.0 {
                        continue;
                    }
                    for &(y, share) in self.shares(node, x) {
                        let share = share * part;
                        let at = (x * ny + y) * np + point.phi as usize;
                        for k in 0..K {
                            let mut add = |at: usize, share: f32| {
                                for (cell, part) in into[k][at].iter_mut().zip(parts[k]) {
                                    *cell += share * part;
                                }
                            };
                            add(at, share - share * point.beyond);
                            if point.beyond > 0.0 {
                                add(at + 1, share * point.beyond);
                            }
                        }
                    }
                }
            }
        }
    }

    /// The densities that a node sees of several S, side by side.
    ///
    /// * `seen`: memory to work in.
    /// * `see`: gets every cell of the map in order; lanes beyond the fields are 0.
    pub(super) fn project(
        &self,
        node: usize,
        fields: &[Field<4>],
        seen: &mut Vec<[f32; STRIP]>,
        mut see: impl FnMut(usize, &[f32; STRIP]),
    ) {
        let [nx, ny, np] = self.size;
        seen.clear();
        seen.resize(nx * np, [0.0; STRIP]);
        widest(
            #[inline(always)]
            || {
                for (x, row) in seen.chunks_exact_mut(np).enumerate() {
                    for &(y, share) in self.shares(node, x) {
                        let weight = share * self.mass[node * nx + x];
                        for (field, at) in fields.iter().zip((0..STRIP).step_by(4)) {
                            for (to, from) in row.iter_mut().zip(field.row(x * ny + y)) {
                                for (to, from) in to[at..at + 4].iter_mut().zip(from) {
                                    *to += weight * from;
                                }
                            }
                        }
                    }
                }
                for (cell, points) in self.points.iter().enumerate() {
                    let mut sum = [0.0; STRIP];
                    for point in points {
                        let (x, beyond) = self.rows_of(node, point);
                        let low = point.low as usize;
                        for (x, part) in [(x, 1.0 - beyond), (x + 1, beyond)] {
                            if part == 0.0 {
                                continue;
                            }
                            let row = &seen[x * np..][..np];
                            let weight = part * point.weight;
                            for ((sum, a), b) in sum.iter_mut().zip(row[low]).zip(row[low + 1]) {
                                *sum += weight * (a + point.high * (b - a));
                            }
                        }
                    }
                    see(cell, &sum);
                }
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::frame;
    use crate::table::Mode;

    /// The lattice of maps averaged with their mirror images, and the texels of their cells.
    fn folded(cube: &Unicube, nodes: &Nodes) -> (Lattice, Vec<[usize; 2]>) {
        let texels: Vec<[usize; 2]> = (0..cube.texels())
            .map(|t| [t, cube.mirrored(t)])
            .filter(|[t, mirror]| t < mirror)
            .collect();
        (Lattice::new(cube, nodes, &texels, true), texels)
    }

    /// The mean density of a texel over the queries of a node's bin.
    ///
    /// * `steps`: queries, and points of the texel along each side.
    /// * `s_of`: S of query, exit and azimuth.
    fn density(
        cube: &Unicube,
        nodes: &Nodes,
        [node, texel]: [usize; 2],
        steps: [usize; 2],
        s_of: impl Fn(f64, f64, f64) -> f64,
    ) -> f64 {
        let (lo, hi) = (nodes.edges[node], nodes.edges[node + 1]);
        let [queries, points] = steps;
        let (mut sum, mut weights) = (0.0, 0.0);
        for i in 0..queries {
            let query = lo + (hi - lo) * (i as f64 + 0.5) / queries as f64;
            weights += query.cos();
            for j in 0..points * points {
                let at = |i: usize| (i as f64 + 0.5) / points as f64;
                let (w, _) = cube.direction(texel, at(j % points), at(j / points));
                let theta = frame::theta_of(w);
                let exit = theta + nodes.centers[node] - query;
                if exit.abs() < FRAC_PI_2 {
                    let s = s_of(query, exit, w.y.atan2(w.x));
                    let all = (points * points) as f64;
                    sum += query.cos() * s * exit.cos().powi(2) / theta.cos() / all;
                }
            }
        }
        sum / weights
    }

    /// Light that is the same all round is so on the lattice.
    #[test]
    fn azimuths_get_what_is_theirs() {
        let cube = Unicube::new(64);
        let nodes = Nodes::new(Mode::Cone, 16);
        let (lattice, texels) = folded(&cube, &nodes);
        let counts = texels.iter().map(|&[texel, _]| {
            let (w, _) = cube.direction(texel, 0.5, 0.5);
            let count = cube.solid_angle(texel) * frame::theta_of(w).cos().powi(2);
            [[count as f32; 4]]
        });
        let mut sums = [Field::new(lattice.size())];
        lattice.gather(8, counts, &mut sums);
        let mut by_azimuth = vec![0.0; lattice.size()[2]];
        for (i, cell) in sums[0].values.iter().enumerate() {
            by_azimuth[i % lattice.size()[2]] += f64::from(cell[0]);
        }
        let mean = by_azimuth.iter().sum::<f64>() / by_azimuth.len() as f64;
        for (cell, sum) in by_azimuth.iter().enumerate() {
            assert!((sum / mean - 1.0).abs() < 1e-3, "{cell}: {sum} of {mean}");
        }
    }

    /// An S that is 1 everywhere is so at every inclination.
    #[test]
    fn inclinations_get_what_is_theirs() {
        let cube = Unicube::new(64);
        let nodes = Nodes::new(Mode::Cone, 16);
        let (lattice, texels) = folded(&cube, &nodes);
        let [nx, ny, np] = lattice.size();
        for node in [4, 8, 11] {
            let counts = texels.iter().map(|&[texel, _]| {
                let density = density(&cube, &nodes, [node, texel], [16, 8], |_, _, _| 1.0);
                [[(1000.0 * density * cube.solid_angle(texel)) as f32; 4]]
            });
            let mut sums = [Field::new(lattice.size())];
            lattice.gather(node, counts, &mut sums);
            let mut photons = vec![0.0; nodes.len()];
            photons[node] = 1000.0;
            let exposure = lattice.exposure(&photons);
            for x in 0..nx {
                let theta =
                    360.0 * (x as f64 + 0.5) / nx as f64 - 180.0 - nodes.centers[node].to_degrees();
                let cells = &sums[0].values[x * ny * np..(x + 1) * ny * np];
                let sum: f64 = cells.iter().map(|cell| f64::from(cell[0])).sum();
                let all: f32 = exposure.values[x * ny..(x + 1) * ny].iter().sum();
                let ratio = sum / (f64::from(all) * np as f64);
                if theta.abs() < 60.0 {
                    assert!((ratio - 1.0).abs() < 2e-3, "{node}, {theta}: {ratio}");
                }
            }
        }
    }

    /// A smooth reciprocal S is found again from what it lets photons of all nodes do, and the nodes
    /// see what they did.
    #[test]
    fn counts_of_s_give_s_and_s_gives_densities() {
        let cube = Unicube::new(32);
        let nodes = Nodes::new(Mode::Cone, 16);
        let (lattice, texels) = folded(&cube, &nodes);
        let s_of = |q: f64, o: f64, phi: f64| {
            let along = 0.5 * (q - o);
            0.1 + (-6.0 * (q + o).powi(2)).exp() * (1.5 + phi.cos()) * (0.5 + 2.0 * along * along)
        };
        let density =
            |node: usize, texel: usize| density(&cube, &nodes, [node, texel], [8, 3], s_of);
        let photons = vec![1000.0; nodes.len()];
        let mut sums = [Field::new(lattice.size())];
        for (node, &photons) in photons.iter().enumerate() {
            let counts = texels.iter().map(|&[texel, _]| {
                let count = density(node, texel) * cube.solid_angle(texel) * photons;
                [[0.0, 0.0, count as f32, 0.0]]
            });
            lattice.gather(node, counts, &mut sums);
        }
        let [mut sums] = sums;
        sums.divide(&lattice.exposure(&photons));
        let fields = [Field::new(lattice.size()), sums];
        for node in 4..12 {
            let mut seen = vec![0.0; texels.len()];
            lattice.project(node, &fields, &mut Vec::new(), |cell, lanes| {
                seen[cell] = lanes[6];
            });
            let (mut off, mut all) = (0.0, 0.0);
            for (&[texel, _], seen) in texels.iter().zip(seen) {
                let (w, _) = cube.direction(texel, 0.5, 0.5);
                if frame::theta_of(w).abs() < 1.2 {
                    let density = density(node, texel);
                    off += (f64::from(seen) - density).powi(2);
                    all += density * density;
                }
            }
            let off = (off / all).sqrt();
            // Cells of the lattice are as large as texels; a lost factor or a wrong sign is far more.
            assert!(off < 0.08, "{node}: {off}");
        }
    }
}
