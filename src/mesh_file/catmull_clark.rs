//! Catmull-Clark surfaces: faces are split into quads, and points move to where the surface is.
//!
//! Rules of Catmull and Clark 1978, creases of DeRose, Kass and Truong 1998 ("Subdivision surfaces in character
//! animation"), points of the limit of Halstead, Kass and DeRose 1993. Borders are creases.

use glam::DVec3;
use std::collections::HashMap;

/// How faces are joined, and where they are creased.
#[derive(Clone, Debug, Default)]
pub(super) struct Cage {
    /// Corners of each face.
    pub(super) counts: Vec<u32>,
    /// Values at the corners, face after face: indices of what is split with the cage.
    pub(super) corners: Vec<u32>,
    /// Sharpness of edges, the lower end first: for so many levels they are creases.
    pub(super) creases: HashMap<[u32; 2], f64>,
    /// Sharpness of points.
    pub(super) peaks: HashMap<u32, f64>,
    /// Whether a point of a single face stays where it is.
    pub(super) keeps_corners: bool,
}

/// Where values go when faces are split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// Onto the smooth surface.
    Smooth,
    /// Nowhere: new ones are halfway.
    Linear,
}

/// The edges of a cage.
struct Edges {
    ends: Vec<[u32; 2]>,
    /// Sum of the first two faces' points, and how many faces there are.
    faces: Vec<(DVec3, u32)>,
    /// The edge from each corner to the next.
    of_corner: Vec<u32>,
}

/// What stands around a value.
#[derive(Clone, Copy, Default)]
struct Ring {
    faces: u32,
    edges: u32,
    /// Sum of the points of faces.
    middle: DVec3,
    /// Sum of the other ends of edges.
    ends: DVec3,
    sharp: u32,
    sharpness: f64,
    /// Sum of the other ends of sharp edges.
    sharp_ends: DVec3,
}

impl Cage {
    /// The faces with their first corners.
    pub(super) fn faces(&self) -> impl Iterator<Item = (usize, &[u32])> {
        let mut begin = 0;
        self.counts.iter().map(move |&count| {
            let at = begin;
            begin += count as usize;
            (at, &self.corners[at..begin])
        })
    }

    /// Each face of n corners becomes n quads, in the order of the corners. Values that were there keep
    /// their numbers.
    pub(super) fn split(&self, values: &[DVec3], rule: Rule) -> (Self, Vec<DVec3>) {
        let middles: Vec<DVec3> = (self.faces())
            .map(|(_, face)| {
                face.iter().map(|&v| values[v as usize]).sum::<DVec3>() / face.len() as f64
            })
            .collect();
        let edges = self.edges(&middles);
        let sharpness: Vec<f64> = (0..edges.ends.len())
            .map(|e| self.sharpness(&edges, e))
            .collect();

        let mut next: Vec<DVec3> = match rule {
            Rule::Linear => values.to_vec(),
            Rule::Smooth => {
                let rings = self.rings(values, &middles, &edges, &sharpness);
                (values.iter().zip(&rings).zip(0..))
                    .map(|((&value, ring), v)| self.moved(v, value, ring))
                    .collect()
            }
        };
        let first_middle = next.len() as u32;
        next.extend_from_slice(&middles);
        let first_edge = next.len() as u32;
        for ((&[a, b], &(sum, _)), &sharp) in edges.ends.iter().zip(&edges.faces).zip(&sharpness) {
            let ends = values[a as usize] + values[b as usize];
            let smooth = if rule == Rule::Linear {
                0.0
            } else {
                1.0 - sharp.min(1.0)
            };
            next.push((ends / 2.0).lerp((ends + sum) / 4.0, smooth));
        }

        let mut cage = Self {
            counts: vec![4; self.corners.len()],
            corners: Vec::with_capacity(4 * self.corners.len()),
            creases: HashMap::new(),
            peaks: less_sharp(&self.peaks),
            keeps_corners: self.keeps_corners,
        };
        for ((begin, face), middle) in self.faces().zip(first_middle..) {
            for i in 0..face.len() {
                let before = begin + (i + face.len() - 1) % face.len();
                let edge = |corner: usize| first_edge + edges.of_corner[corner];
                cage.corners
                    .extend([face[i], edge(begin + i), middle, edge(before)]);
            }
        }
        for ((&[a, b], &sharp), edge) in edges.ends.iter().zip(&sharpness).zip(first_edge..) {
            // Borders are known as such.
            if sharp > 1.0 && self.creases.contains_key(&[a, b]) {
                for end in [a, b] {
                    cage.creases.insert([end, edge], sharp - 1.0);
                }
            }
        }
        (cage, next)
    }

    /// Where values end if faces are split for ever. The cage was split at least once.
    pub(super) fn limit(&self, values: &[DVec3]) -> Vec<DVec3> {
        debug_assert!(self.counts.iter().all(|&n| n == 4));
        // Across each quad instead of in its middle.
        let mut across = vec![DVec3::ZERO; values.len()];
        for (_, face) in self.faces() {
            for i in 0..4 {
                across[face[i] as usize] += values[face[(i + 2) % 4] as usize];
            }
        }
        let middles = vec![DVec3::ZERO; self.counts.len()];
        let edges = self.edges(&middles);
        let sharpness: Vec<f64> = (0..edges.ends.len())
            .map(|e| self.sharpness(&edges, e))
            .collect();
        let rings = self.rings(values, &middles, &edges, &sharpness);
        (values.iter().zip(&rings).zip(&across).zip(0..))
            .map(|(((&value, ring), &across), v)| {
                let n = f64::from(ring.edges);
                if ring.faces == 0 || self.is_corner(v, ring) {
                    value
                } else if ring.sharp == 2 {
                    (4.0 * value + ring.sharp_ends) / 6.0
                } else {
                    (n * n * value + 4.0 * ring.ends + across) / (n * (n + 5.0))
                }
            })
            .collect()
    }

    /// Where values are at an edge of a single face, each once or more.
    pub(super) fn border(&self) -> Vec<u32> {
        let edges = self.edges(&vec![DVec3::ZERO; self.counts.len()]);
        (edges.ends.iter().zip(&edges.faces))
            .filter(|(_, (_, faces))| *faces == 1)
            .flat_map(|(ends, _)| *ends)
            .collect()
    }

    fn edges(&self, middles: &[DVec3]) -> Edges {
        let mut numbers: HashMap<[u32; 2], u32> = HashMap::with_capacity(2 * self.counts.len());
        let mut edges = Edges {
            ends: Vec::new(),
            faces: Vec::new(),
            of_corner: Vec::with_capacity(self.corners.len()),
        };
        for ((_, face), &middle) in self.faces().zip(middles) {
            for (i, &a) in face.iter().enumerate() {
                let key = key(a, face[(i + 1) % face.len()]);
                let edge = *numbers.entry(key).or_insert(edges.ends.len() as u32);
                if edge as usize == edges.ends.len() {
                    edges.ends.push(key);
                    edges.faces.push((DVec3::ZERO, 0));
                }
                let (sum, count) = &mut edges.faces[edge as usize];
                *sum += middle;
                *count += 1;
                edges.of_corner.push(edge);
            }
        }
        edges
    }

    /// Borders, and where more than two faces meet, are sharp for ever.
    fn sharpness(&self, edges: &Edges, edge: usize) -> f64 {
        match edges.faces[edge].1 {
            2 => self.creases.get(&edges.ends[edge]).copied().unwrap_or(0.0),
            _ => f64::INFINITY,
        }
    }

    fn rings(
        &self,
        values: &[DVec3],
        middles: &[DVec3],
        edges: &Edges,
        sharpness: &[f64],
    ) -> Vec<Ring> {
        let mut rings = vec![Ring::default(); values.len()];
        for ((_, face), &middle) in self.faces().zip(middles) {
            for &v in face {
                rings[v as usize].faces += 1;
                rings[v as usize].middle += middle;
            }
        }
        for (&[a, b], &sharp) in edges.ends.iter().zip(sharpness) {
            for (from, to) in [(a, b), (b, a)] {
                let (ring, end) = (&mut rings[from as usize], values[to as usize]);
                ring.edges += 1;
                ring.ends += end;
                if sharp > 0.0 {
                    ring.sharp += 1;
                    ring.sharpness += sharp;
                    ring.sharp_ends += end;
                }
            }
        }
        rings
    }

    /// Where a value goes in one level.
    fn moved(&self, v: u32, value: DVec3, ring: &Ring) -> DVec3 {
        if ring.faces == 0 {
            return value;
        }
        let n = f64::from(ring.edges);
        let smooth = (ring.middle / f64::from(ring.faces) + ring.ends / n + (n - 2.0) * value) / n;
        let crease = 0.75 * value + ring.sharp_ends / 8.0;
        let creased = match ring.sharp {
            0 | 1 => smooth,
            sharp => {
                let target = if sharp == 2 { crease } else { value };
                smooth.lerp(target, (ring.sharpness / f64::from(sharp)).min(1.0))
            }
        };
        if self.keeps_corners && ring.faces == 1 {
            return value;
        }
        let peak = self.peaks.get(&v).copied().unwrap_or(0.0);
        creased.lerp(value, peak.min(1.0))
    }

    fn is_corner(&self, v: u32, ring: &Ring) -> bool {
        ring.sharp > 2
            || (self.keeps_corners && ring.faces == 1)
            || self.peaks.get(&v).is_some_and(|&peak| peak > 0.0)
    }
}

/// The name of an edge.
pub(super) fn key(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

fn less_sharp(peaks: &HashMap<u32, f64>) -> HashMap<u32, f64> {
    (peaks.iter())
        .filter(|(_, sharp)| **sharp > 1.0)
        .map(|(&v, &sharp)| (v, sharp - 1.0))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> (Cage, Vec<DVec3>) {
        let values = (0..8)
            .map(|i| DVec3::from([1, 2, 4].map(|bit| if i & bit > 0 { 1.0 } else { -1.0 })))
            .collect();
        let corners = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let cage = Cage {
            counts: vec![4; 6],
            corners: corners.as_flattened().to_vec(),
            keeps_corners: true,
            ..Cage::default()
        };
        (cage, values)
    }

    /// A grid of 4 x 4 squares of side 1 in the plane z = 0.
    fn grid() -> (Cage, Vec<DVec3>) {
        let values = (0..25).map(|i| DVec3::new(f64::from(i % 5), f64::from(i / 5), 0.0));
        let corners = (0..16).flat_map(|i| {
            let at = i % 4 + i / 4 * 5;
            [at, at + 1, at + 6, at + 5]
        });
        let cage = Cage {
            counts: vec![4; 16],
            corners: corners.collect(),
            keeps_corners: true,
            ..Cage::default()
        };
        (cage, values.collect())
    }

    /// The limit of values that were split so many times.
    fn limit(cage: &Cage, values: &[DVec3], levels: usize) -> Vec<DVec3> {
        let mut cage = cage.clone();
        let mut values = values.to_vec();
        for _ in 0..levels {
            (cage, values) = cage.split(&values, Rule::Smooth);
        }
        cage.limit(&values)
    }

    /// A corner of three squares goes 5/9 of the way out at first, half of it in the end.
    #[test]
    fn corners_of_a_cube_end_where_the_closed_form_says() {
        let (cage, values) = cube();
        let (once, points) = cage.split(&values, Rule::Smooth);
        assert_eq!((once.counts.len(), points.len()), (24, 26));
        assert!(points[7].distance(DVec3::splat(5.0 / 9.0)) < 1e-15);
        let (early, late) = (limit(&cage, &values, 1), limit(&cage, &values, 4));
        assert!(early[7].distance(DVec3::splat(0.5)) < 1e-15, "{}", early[7]);
        // The surface is the same from every level.
        for (early, late) in early.iter().zip(late) {
            assert!(early.distance(late) < 1e-14, "{early} {late}");
        }
    }

    /// Among squares it is a cubic B-spline, along borders one of the border: both add 1/3 to squares of
    /// numbers one apart.
    #[test]
    fn grids_and_their_borders_are_splines() {
        let (cage, mut values) = grid();
        for value in &mut values {
            value.z = value.x * value.x + value.y * value.y;
        }
        let found = limit(&cage, &values, 2);
        for (point, expected) in [
            (12, DVec3::new(2.0, 2.0, 8.0 + 2.0 / 3.0)),
            (2, DVec3::new(2.0, 0.0, 4.0 + 1.0 / 3.0)),
            (24, DVec3::new(4.0, 4.0, 32.0)),
        ] {
            assert!(
                found[point].distance(expected) < 1e-13,
                "{point}: {}",
                found[point]
            );
        }
        let loose = Cage {
            keeps_corners: false,
            ..cage
        };
        let corner = limit(&loose, &values, 1)[24];
        let expected = DVec3::new(23.0, 23.0, 178.0) / 6.0;
        assert!(corner.distance(expected) < 1e-14, "{corner}");
        let (_, halves) = loose.split(&values, Rule::Linear);
        assert_eq!(halves[..25], values);
        assert_eq!(
            halves[25],
            (values[0] + values[1] + values[6] + values[5]) / 4.0
        );
    }

    #[test]
    fn creases_last_as_long_as_they_are_sharp() {
        let (smooth, values) = cube();
        let top = [[4, 5], [5, 7], [6, 7], [4, 6]];
        let creased = |sharp: f64| Cage {
            creases: top.map(|edge| (edge, sharp)).into(),
            ..smooth.clone()
        };
        let found = limit(&creased(f64::INFINITY), &values, 3)[7];
        let expected = DVec3::new(2.0 / 3.0, 2.0 / 3.0, 1.0);
        assert!(found.distance(expected) < 1e-14, "{found}");

        // One level of creases, and then none.
        let (mut once, points) = creased(f64::INFINITY).split(&values, Rule::Smooth);
        once.creases.clear();
        let (expected, found) = (limit(&once, &points, 1), limit(&creased(1.0), &values, 2));
        for (found, expected) in found.iter().zip(expected) {
            assert!(found.distance(expected) < 1e-14, "{found} {expected}");
        }
        let heights =
            [0.0, 0.5, 1.0, 2.0, 9.0].map(|sharp| limit(&creased(sharp), &values, 3)[7].z);
        assert!(
            heights.is_sorted() && heights[0] < heights[1],
            "{heights:?}"
        );

        let peaked = Cage {
            peaks: [(7, f64::INFINITY)].into(),
            ..smooth.clone()
        };
        assert_eq!(limit(&peaked, &values, 2)[7], values[7]);
    }

    /// Where three faces meet there is no smooth surface; the edge stays, and points of no face too.
    #[test]
    fn edges_of_three_faces_are_creases() {
        let values = [0.0, 1.0].map(|y| {
            [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0)].map(|(x, z)| DVec3::new(x, y, z))
        });
        let mut values = values.as_flattened().to_vec();
        values.push(DVec3::ONE);
        let cage = Cage {
            counts: vec![4; 3],
            corners: vec![0, 1, 5, 4, 0, 2, 6, 4, 0, 3, 7, 4],
            keeps_corners: true,
            ..Cage::default()
        };
        let found = limit(&cage, &values, 2);
        assert_eq!(
            (found[0], found[4], found[8]),
            (values[0], values[4], DVec3::ONE)
        );
    }
}
