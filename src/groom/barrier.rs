//! Where a strand passes through the skin: decided exactly.
//!
//! A piece of a strand, a cubic, lies within the convex hull of its four Bezier points, and so does the
//! straight line between its ends. If a plane keeps the hull and a triangle apart, neither passes through
//! it: the triangle's own plane, or one upright on an edge. If none of these does, the cubic is halved. A
//! point that is not on the triangle is above, below or beyond an edge, so halving ends, and what still
//! is not apart when it is a few nanometers long touches the triangle. All of this is in double precision, where
//! coordinates in single precision leave no room for doubt.

use super::GroomError;
use crate::accel::{AccelError, BinaryNode, Effort, binary_tree};
use crate::math::spline::bezier_piece;
use crate::skin::Skin;
use glam::{DVec3, Vec3, Vec4};

/// A strand and a triangle nearer than this touch, meters.
const APART: f64 = 1e-9;
/// Pieces shorter than this are not halved, meters.
const SHORTEST: f64 = 4e-9;
/// A hair leaves the skin where it is rooted: nothing is asked of its first micrometer, far less than its
/// radius, meters; on skins so large that coordinates are coarser, of so many roundings.
const ROOT: f64 = 1e-6;
const ROOT_ROUNDINGS: f32 = 16.0;
/// Roundings by which boxes of the tree may be too small, and by which heights above a plane may be wrong, in
/// single precision.
const BOX_ROUNDINGS: f32 = 4.0;
const PLANE_ROUNDINGS: f32 = 8.0;

/// The triangles of a skin, to be held against strands.
pub(super) struct Barrier {
    /// Those that have an area.
    corners: Vec<[Vec3; 3]>,
    /// Their planes in single precision: normals and heights.
    planes: Vec<Vec4>,
    /// Unit normals of the triangles in the order of the skin; zero where there is no area.
    normals: Vec<Vec3>,
    nodes: Vec<BinaryNode>,
    /// Largest coordinate, meters.
    size: f32,
    root: f64,
}

/// Where a strand passes through the skin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passage {
    /// Control points before it.
    pub(super) piece: usize,
    /// Where in the piece, 0..1.
    pub(super) at: f32,
    /// On the triangle.
    pub(super) point: Vec3,
    /// Of the triangle, unit, toward where the strand comes from.
    pub(super) normal: Vec3,
}

impl Passage {
    /// Place along the strand, in pieces.
    pub(super) fn along(&self) -> f32 {
        self.piece as f32 + self.at
    }
}

impl Barrier {
    /// # Errors
    /// Triangles that no tree is built over.
    pub(super) fn new(skin: &Skin) -> Result<Self, GroomError> {
        let normals: Vec<Vec3> = (0..skin.triangles.len())
            .map(|i| normal(&skin.corners(i)).as_vec3())
            .collect();
        // Nothing passes through triangles without area.
        let corners: Vec<[Vec3; 3]> = (normals.iter().enumerate())
            .filter(|(_, normal)| **normal != Vec3::ZERO)
            .map(|(i, _)| skin.corners(i))
            .collect();
        let nodes =
            binary_tree(&corners, Effort::Fast).map_err(|error| GroomError::NoCollisions {
                skin: skin.name.clone(),
                reason: match error {
                    AccelError::Coordinates { at } => {
                        format!("it reaches to {at} m: is the mesh in meters?")
                    }
                    AccelError::Coincident { count, at } => {
                        format!("{count} of its triangles lie in the same box at {at} m")
                    }
                },
            })?;
        let (lo, hi) = skin.bounds();
        let size = lo.abs().max(hi.abs()).max_element();
        let plane = |corners: &[Vec3; 3]| {
            let normal = normal(corners);
            let height = normal.dot(corners[0].as_dvec3());
            normal.extend(-height).as_vec4()
        };
        Ok(Self {
            planes: corners.iter().map(plane).collect(),
            corners,
            normals,
            nodes,
            size,
            root: ROOT.max(f64::from(ROOT_ROUNDINGS * size * f32::EPSILON)),
        })
    }

    /// Normal of a triangle of the skin, unit; zero without area.
    pub(super) fn normal(&self, triangle: u32) -> Vec3 {
        self.normals[triangle as usize]
    }

    /// Where the drawn curve of a strand, or the straight line between two of its control points, first
    /// touches a triangle or passes through it; at the root if it does not leave the skin on its outer side.
    ///
    /// * `triangle`: that the root lies on.
    pub(super) fn first(&self, triangle: u32, points: &[Vec3]) -> Option<Passage> {
        let up = self.normal(triangle);
        if (points[1] - points[0]).dot(up) <= 0.0 {
            return Some(Passage {
                piece: 0,
                at: 0.0,
                point: points[0],
                normal: up,
            });
        }
        // A spline leaves the box of its points by less than their distances.
        let longest = (points.windows(2)).fold(0.0, |most: f32, p| most.max(p[0].distance(p[1])));
        let (lo, hi) =
            (points.iter()).fold((points[0], points[0]), |b, &p| (b.0.min(p), b.1.max(p)));
        let node = self.around((lo - longest, hi + longest));
        (0..points.len() - 1).find_map(|piece| self.first_of(node, points, piece))
    }

    /// The deepest node that holds all that meets a box.
    fn around(&self, reach: (Vec3, Vec3)) -> usize {
        let meets = |at: &BinaryNode| (at.lo.cmple(reach.1) & at.hi.cmpge(reach.0)).all();
        let mut node = 0;
        while let Some(at) = self.nodes.get(node).filter(|at| !at.is_leaf) {
            let first = at.index as usize;
            node = match [first, first + 1].map(|child| meets(&self.nodes[child])) {
                [true, true] => break,
                [false, true] => first + 1,
                _ => first,
            };
        }
        node
    }

    /// * `node`: of the tree, that holds all that the strand can meet.
    fn first_of(&self, node: usize, points: &[Vec3], piece: usize) -> Option<Passage> {
        let mut curve = bezier(points, piece);
        let mut line = straight(curve[0], curve[3]);
        let skipped = if piece == 0 {
            let legs = (0..3).map(|k| curve[k].distance(curve[k + 1]));
            let speed = 3.0 * legs.fold(f64::MIN_POSITIVE, f64::max);
            (self.root / speed).min(0.5)
        } else {
            0.0
        };
        if skipped > 0.0 {
            (curve, line) = (split(&curve, skipped).1, split(&line, skipped).1);
        }
        let hull = curve.map(|p| p.as_vec3());
        let lo = hull[0].min(hull[1]).min(hull[2].min(hull[3]));
        let hi = hull[0].max(hull[1]).max(hull[2].max(hull[3]));
        let rounding = f32::EPSILON * self.size.max(lo.abs().max(hi.abs()).max_element());
        let room = BOX_ROUNDINGS * rounding + APART as f32;
        let apart = PLANE_ROUNDINGS * rounding + APART as f32;
        let mut first: Option<(f64, u32, bool)> = None;
        self.near(node, (lo - room, hi + room), &mut |index| {
            let heights = hull.map(|p| self.planes[index as usize].dot(p.extend(1.0)));
            if heights.iter().all(|&h| h > apart) || heights.iter().all(|&h| h < -apart) {
                return;
            }
            let walls = Walls::new(&self.corners[index as usize]);
            if walls.part(&curve) {
                return;
            }
            for (way, is_line) in [(&curve, false), (&line, true)] {
                let most = first.map_or(2.0, |(t, ..)| t);
                if let Some(t) = walls.touch(way, [0.0, 1.0], most)
                    && first.is_none_or(|(least, i, _)| t < least || t == least && index < i)
                {
                    first = Some((t, index, is_line));
                }
            }
        });
        let (t, index, is_line) = first?;
        let way = if is_line { line } else { curve };
        let normal = normal(&self.corners[index as usize]);
        let (before, after) = split(&way, t);
        let against = (after[3] - before[0]).dot(normal) > 0.0;
        let ahead = (after[1] - after[0]).dot(normal);
        let against = if ahead == 0.0 { against } else { ahead > 0.0 };
        Some(Passage {
            piece,
            at: (skipped + (1.0 - skipped) * t) as f32,
            point: after[0].as_vec3(),
            normal: if against { -normal } else { normal }.as_vec3(),
        })
    }

    /// All triangles whose boxes meet another box.
    fn near(&self, node: usize, reach: (Vec3, Vec3), found: &mut impl FnMut(u32)) {
        let Some(at) = self.nodes.get(node) else {
            return;
        };
        if !(at.lo.cmple(reach.1) & at.hi.cmpge(reach.0)).all() {
            return;
        }
        if at.is_leaf {
            found(at.index);
        } else {
            self.near(at.index as usize, reach, found);
            self.near(at.index as usize + 1, reach, found);
        }
    }
}

/// Planes through a triangle and upright on its edges.
struct Walls {
    corners: [DVec3; 3],
    normal: DVec3,
}

impl Walls {
    fn new(corners: &[Vec3; 3]) -> Self {
        Self {
            corners: corners.map(|p| p.as_dvec3()),
            normal: normal(corners),
        }
    }

    /// Whether one of the planes has the triangle on one side and all points on the other.
    fn part(&self, points: &[DVec3; 4]) -> bool {
        let [a, b, c] = self.corners;
        let beyond = |from: DVec3, out: DVec3| points.iter().all(|p| (*p - from).dot(out) > APART);
        if beyond(a, self.normal) || beyond(a, -self.normal) {
            return true;
        }
        [(a, b), (b, c), (c, a)].into_iter().any(|(from, to)| {
            let out = (to - from).cross(self.normal).normalize_or_zero();
            beyond(from, out)
        })
    }

    /// Where a cubic first touches the triangle, of what lies within `range` of it and before `most`.
    fn touch(&self, curve: &[DVec3; 4], range: [f64; 2], most: f64) -> Option<f64> {
        if range[0] > most || self.part(curve) {
            return None;
        }
        let length: f64 = curve.windows(2).map(|p| p[0].distance(p[1])).sum();
        let middle = 0.5 * (range[0] + range[1]);
        if length < SHORTEST || middle <= range[0] {
            return Some(range[0]);
        }
        let (first, second) = split(curve, 0.5);
        (self.touch(&first, [range[0], middle], most))
            .or_else(|| self.touch(&second, [middle, range[1]], most))
    }
}

fn normal(corners: &[Vec3; 3]) -> DVec3 {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    (b - a).cross(c - a).normalize_or_zero()
}

/// Bezier points of a piece of a strand.
pub(super) fn bezier(points: &[Vec3], piece: usize) -> [DVec3; 4] {
    bezier_piece::<_, f64>(points.len(), |i| points[i].as_dvec3(), piece)
}

fn straight(from: DVec3, to: DVec3) -> [DVec3; 4] {
    [from, from.lerp(to, 1.0 / 3.0), from.lerp(to, 2.0 / 3.0), to]
}

/// The parts of a cubic before and after `t` (de Casteljau).
pub(super) fn split(p: &[DVec3; 4], t: f64) -> ([DVec3; 4], [DVec3; 4]) {
    let [ab, bc, cd] = [0, 1, 2].map(|k| p[k].lerp(p[k + 1], t));
    let (abc, bcd) = (ab.lerp(bc, t), bc.lerp(cd, t));
    let middle = abc.lerp(bcd, t);
    ([p[0], ab, abc, middle], [middle, bcd, cd, p[3]])
}
