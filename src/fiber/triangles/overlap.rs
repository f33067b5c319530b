//! Pairs of triangles that go through each other.

use glam::DVec3;

/// Triangles of a leaf: few enough that boxes are worth their while.
const LEAF: usize = 4;
/// Pairs of boxes looked at for each triangle. Meshes of fibers need some dozens; a thousand faces in
/// one place need as many for each.
const PAIRS_EACH: usize = 600;

/// A node: its box, its range of the order, its second child; the first one follows it.
struct Node {
    lo: DVec3,
    hi: DVec3,
    begin: usize,
    end: usize,
    second: usize,
}

/// Triangles ordered in a tree of boxes.
struct Tree<'a> {
    triangles: &'a [[DVec3; 3]],
    order: Vec<u32>,
    nodes: Vec<Node>,
}

/// More pairs of overlapping boxes than can be tested in bounded time.
pub(super) struct Crowded {
    /// One of the triangles that are too many.
    pub(super) triangle: usize,
}

/// Calls `visit` for each pair of triangles that go through each other; touching ones and ones that
/// share a corner do not. Pairs come in an order that depends on the triangles alone.
///
/// * `tolerance`: what reaches less deep than this only touches.
pub(super) fn crossing_pairs(
    triangles: &[[DVec3; 3]],
    tolerance: f64,
    mut visit: impl FnMut(usize, usize),
) -> Result<(), Crowded> {
    if triangles.is_empty() {
        return Ok(());
    }
    let tree = Tree::new(triangles);
    let mut budget = PAIRS_EACH * triangles.len() + 10_000;
    let mut stack = vec![(0, 0)];
    while let Some((i, j)) = stack.pop() {
        let (a, b) = (&tree.nodes[i], &tree.nodes[j]);
        if a.lo.cmpgt(b.hi).any() || b.lo.cmpgt(a.hi).any() {
            continue;
        }
        if budget == 0 {
            return Err(Crowded {
                triangle: tree.order[a.begin] as usize,
            });
        }
        budget -= 1;
        let leaves = [a, b].map(|n| n.second == 0);
        match leaves {
            [true, true] => {
                for k in a.begin..a.end {
                    let first = if i == j { k + 1 } else { b.begin };
                    for l in first..b.end {
                        let [p, q] = [k, l].map(|k| tree.order[k] as usize);
                        if cross(&triangles[p], &triangles[q], tolerance) {
                            visit(p.min(q), p.max(q));
                        }
                    }
                }
            }
            _ if i == j => stack.extend([(i + 1, i + 1), (i + 1, a.second), (a.second, a.second)]),
            [false, _] if leaves[1] || a.end - a.begin >= b.end - b.begin => {
                stack.extend([(i + 1, j), (a.second, j)]);
            }
            _ => stack.extend([(i, j + 1), (i, b.second)]),
        }
    }
    Ok(())
}

impl<'a> Tree<'a> {
    fn new(triangles: &'a [[DVec3; 3]]) -> Self {
        let mut tree = Self {
            triangles,
            order: (0..triangles.len() as u32).collect(),
            nodes: Vec::new(),
        };
        tree.split(0, triangles.len());
        tree
    }

    /// Halves by number, so that the depth is bounded whatever the triangles.
    fn split(&mut self, begin: usize, end: usize) {
        let triangles = self.triangles;
        let corners = || {
            self.order[begin..end]
                .iter()
                .flat_map(|&t| triangles[t as usize])
        };
        let lo = corners().fold(DVec3::INFINITY, DVec3::min);
        let hi = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
        let index = self.nodes.len();
        self.nodes.push(Node {
            lo,
            hi,
            begin,
            end,
            second: 0,
        });
        if end - begin <= LEAF {
            return;
        }
        // Across the axis along which the triangles overlap least: not the longest one of the box,
        // as scales are slender.
        let (mut extent, mut first, mut last) = (DVec3::ZERO, DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &t in &self.order[begin..end] {
            let [a, b, c] = triangles[t as usize];
            let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
            extent += hi - lo;
            (first, last) = (first.min(lo + hi), last.max(lo + hi));
        }
        let share = (last - first) / (extent + f64::MIN_POSITIVE);
        let axis = if share.x >= share.y && share.x >= share.z {
            0
        } else if share.y >= share.z {
            1
        } else {
            2
        };
        let center = |t: u32| {
            let [a, b, c] = triangles[t as usize];
            a[axis] + b[axis] + c[axis]
        };
        let middle = (begin + end) / 2;
        self.order[begin..end].select_nth_unstable_by(middle - begin, |&a, &b| {
            center(a).total_cmp(&center(b)).then(a.cmp(&b))
        });
        self.split(begin, middle);
        self.nodes[index].second = self.nodes.len();
        self.split(middle, end);
    }
}

/// Whether two triangles without a common corner go through each other.
fn cross(a: &[DVec3; 3], b: &[DVec3; 3], tolerance: f64) -> bool {
    if a.iter().any(|p| b.contains(p)) {
        return false;
    }
    let pierces = |a: &[DVec3; 3], b: &[DVec3; 3]| {
        let normal = (b[1] - b[0]).cross(b[2] - b[0]);
        let area = normal.length();
        if area == 0.0 {
            return false;
        }
        let normal = normal / area;
        let height = a.map(|p| (p - b[0]).dot(normal));
        (0..3).any(|i| {
            let j = (i + 1) % 3;
            let through =
                height[i].min(height[j]) < -tolerance && height[i].max(height[j]) > tolerance;
            through && {
                let share = height[i] / (height[i] - height[j]);
                holds(b, normal, a[i].lerp(a[j], share), tolerance)
            }
        })
    };
    pierces(a, b) || pierces(b, a)
}

/// Whether a point of a triangle's plane is inside of all edges by more than the tolerance.
fn holds(t: &[DVec3; 3], normal: DVec3, p: DVec3, tolerance: f64) -> bool {
    (0..3).all(|i| {
        let (from, to) = (t[i], t[(i + 1) % 3]);
        let edge = to - from;
        normal.cross(edge).dot(p - from) > tolerance * edge.length()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pairs(triangles: &[[DVec3; 3]]) -> Vec<(usize, usize)> {
        let mut pairs = Vec::new();
        let found = crossing_pairs(triangles, 1e-9, |a, b| pairs.push((a, b)));
        assert!(found.is_ok());
        pairs.sort_unstable();
        pairs
    }

    fn triangle(at: DVec3, u: DVec3, v: DVec3) -> [DVec3; 3] {
        [at, at + u, at + v]
    }

    #[test]
    fn only_what_goes_through_counts() {
        let flat = triangle(DVec3::ZERO, DVec3::X, DVec3::Y);
        let pin = triangle(
            DVec3::new(0.2, 0.2, -0.5),
            DVec3::Z,
            DVec3::new(0.01, 0.0, 1.0),
        );
        assert_eq!(pairs(&[flat, pin]), [(0, 1)]);
        let beside = pin.map(|p| p + DVec3::new(0.7, 0.2, 0.0));
        let touching = pin.map(|p| p + 0.5 * DVec3::Z);
        let next = [flat[1], flat[2], DVec3::new(1.0, 1.0, -3.0)];
        assert_eq!(pairs(&[flat, touching, next]), []);
        assert_eq!(pairs(&[flat, beside]), []);
    }

    /// Of many triangles in a row just the planted pairs are found.
    #[test]
    fn planted_pairs_are_found() {
        let mut all: Vec<_> = (0..1000)
            .map(|k| triangle(2.0 * f64::from(k) * DVec3::X, DVec3::X, DVec3::Y))
            .collect();
        for k in [3, 500, 999] {
            let at = DVec3::new(2.0 * f64::from(k) + 0.2, 0.2, -0.5);
            all.push(triangle(at, DVec3::Z, DVec3::new(0.01, 0.0, 1.0)));
        }
        assert_eq!(pairs(&all), [(3, 1000), (500, 1001), (999, 1002)]);
    }

    #[test]
    fn crowds_end_in_bounded_time() {
        let turned = |k: u32| {
            let (sin, cos) = f64::from(k).sin_cos();
            [
                DVec3::new(cos, sin, -1.0),
                DVec3::new(-cos, sin, 1.0),
                DVec3::new(sin, -cos, 0.1),
            ]
        };
        let crowd: Vec<_> = (0..20_000).map(turned).collect();
        assert!(crossing_pairs(&crowd, 1e-9, |_, _| {}).is_err());
    }
}
