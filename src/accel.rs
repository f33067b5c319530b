//! The only file that names the acceleration structure's crate: what it cannot take is refused
//! here, and its order of traversal is hidden from results.
//!
//! Skins are in millimeters, and meshes of fibers in units of the radius, because the crate's nodes ignore everything nearer than a fixed
//! 1e-4 units: a tenth of a micrometer of skin, well below the width of a hair. In meters it would be a
//! tenth of a millimeter, and light that leaves the skin would pass through the folds beside it.

pub(crate) mod lanes;

use crate::sampling::hash64;
use glam::{UVec2, Vec3, Vec3A};
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh};
use obvhs::ray::Ray as BoxRay;
use obvhs::triangle::Triangle;
use obvhs::{Boundable, BvhBuildParams, aabb::Aabb};
use std::time::Duration;

/// Largest coordinate taken, scene units. Box areas of larger ones overflow single precision.
pub(crate) const LIMIT: f32 = 1e6;

/// Most distinct primitives allowed in exactly the same box. Building is quadratic in this number,
/// and every ray through the box tests all of them.
const COINCIDENT_LIMIT: usize = 64;

/// Boxes that no hierarchy is built over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum AccelError {
    /// Something not finite or beyond the limit, here.
    Coordinates { at: Vec3 },
    /// So many primitives in exactly the same box, here.
    Coincident { count: usize, at: Vec3 },
}

/// A straight path: unit direction, scene units.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// Unit direction.
    pub dir: Vec3,
}

struct Bounds(Aabb);

impl Boundable for Bounds {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

/// A bounding volume hierarchy over primitives that the caller keeps, in the order of
/// [`Accel::order`].
#[derive(Clone, Debug)]
pub(crate) struct Accel {
    bvh: CwBvh,
}

impl Accel {
    /// * `boxes`: corners of each primitive's box.
    /// * Fails on non-finite or huge coordinates and on too many primitives in one place.
    pub(crate) fn build(boxes: &[(Vec3, Vec3)]) -> Result<Self, AccelError> {
        check(boxes)?;
        if boxes.is_empty() {
            return Ok(Self {
                bvh: CwBvh::default(),
            });
        }
        // Rays are tested against boxes in rounded arithmetic: a little room keeps edges closed.
        let prims: Vec<Bounds> = boxes
            .iter()
            .map(|(lo, hi)| {
                let room = 4.0 * f32::EPSILON * lo.abs().max(hi.abs()).max_element();
                Bounds(Aabb::new(Vec3A::from(*lo - room), Vec3A::from(*hi + room)))
            })
            .collect();
        let params = BvhBuildParams::medium_build();
        let bvh = build_cwbvh(&prims, params, &mut Duration::default());
        Ok(Self { bvh })
    }

    /// Index in the caller's original order of each primitive in traversal order.
    pub(crate) fn order(&self) -> &[u32] {
        &self.bvh.primitive_indices
    }

    /// The nearest hit in front of `limit`.
    ///
    /// * `test(primitive, best)`: distance to a primitive (in traversal order), or `None` if there
    ///   is no hit at or before `best`.
    /// * Of equal distances the lowest original index wins, whatever the shape of the tree.
    #[inline(always)]
    pub(crate) fn closest(
        &self,
        ray: &Ray,
        limit: f32,
        mut test: impl FnMut(usize, f32) -> Option<f32>,
    ) -> Option<(usize, f32)> {
        if self.bvh.nodes.is_empty() {
            return None;
        }
        let mut walk = box_ray(ray, limit);
        let mut found = None;
        let mut state = self.bvh.new_traversal(walk.direction);
        let mut node;
        obvhs::traverse!(
            self.bvh,
            node,
            state,
            node.intersect_ray(&walk, state.oct_inv4),
            {
                let prim = state.primitive_id as usize;
                if let Some(t) = test(prim, walk.tmax) {
                    let order = self.order();
                    let first = match found {
                        Some(old) if t == walk.tmax => order[prim] < order[old],
                        _ => t <= walk.tmax,
                    };
                    if first {
                        walk.tmax = t;
                        found = Some(prim);
                    }
                }
            }
        );
        found.map(|prim| (prim, walk.tmax))
    }

    /// Whether anything is hit in front of `limit`; stops at the first hit found.
    #[inline(always)]
    pub(crate) fn any(
        &self,
        ray: &Ray,
        limit: f32,
        mut test: impl FnMut(usize, f32) -> bool,
    ) -> bool {
        if self.bvh.nodes.is_empty() {
            return false;
        }
        let walk = box_ray(ray, limit);
        let mut state = self.bvh.new_traversal(walk.direction);
        let mut node;
        'walk: {
            obvhs::traverse!(
                self.bvh,
                node,
                state,
                node.intersect_ray(&walk, state.oct_inv4),
                {
                    if test(state.primitive_id as usize, limit) {
                        break 'walk true;
                    }
                }
            );
            false
        }
    }
}

/// A node of [`binary_tree`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct BinaryNode {
    /// Corners of its box.
    pub(crate) lo: Vec3,
    pub(crate) hi: Vec3,
    /// The triangle of a leaf, or the first of two children one after the other.
    pub(crate) index: u32,
    pub(crate) is_leaf: bool,
}

/// How much time a tree is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effort {
    /// Little: it is asked seldom.
    Fast,
    /// The best that the crate builds, slender triangles in several leaves.
    Best,
}

/// A hierarchy over triangles for layouts and walks of one's own: a triangle a leaf. The first node is the
/// root; empty without triangles.
///
/// * Fails as [`Accel::build`].
pub(crate) fn binary_tree(
    triangles: &[[Vec3; 3]],
    effort: Effort,
) -> Result<Vec<BinaryNode>, AccelError> {
    let boxes: Vec<(Vec3, Vec3)> = triangles
        .iter()
        .map(|&[a, b, c]| (a.min(b).min(c), a.max(b).max(c)))
        .collect();
    check(&boxes)?;
    if triangles.is_empty() {
        return Ok(Vec::new());
    }
    let triangles: Vec<Triangle> = triangles
        .iter()
        .map(|t| {
            let [v0, v1, v2] = t.map(Vec3A::from);
            Triangle { v0, v1, v2 }
        })
        .collect();
    let params = BvhBuildParams {
        max_prims_per_leaf: 1,
        ..match effort {
            Effort::Fast => BvhBuildParams::fast_build(),
            Effort::Best => BvhBuildParams::slow_build(),
        }
    };
    let bvh = build_bvh2_from_tris(&triangles, params, &mut Duration::default());
    let node = |n: &obvhs::bvh2::node::Bvh2Node| BinaryNode {
        lo: n.aabb().min.into(),
        hi: n.aabb().max.into(),
        index: match n.is_leaf() {
            true => bvh.primitive_indices[n.first_index as usize],
            false => n.first_index,
        },
        is_leaf: n.is_leaf(),
    };
    Ok(bvh.nodes.iter().map(node).collect())
}

fn box_ray(ray: &Ray, limit: f32) -> BoxRay {
    // Adding zero turns -0 into 0: the node test takes the sign of the reciprocal from one and the
    // near side of the box from the other.
    let dir = Vec3A::from(ray.dir) + Vec3A::ZERO;
    BoxRay::new(Vec3A::from(ray.origin), dir, 0.0, limit)
}

fn check(boxes: &[(Vec3, Vec3)]) -> Result<(), AccelError> {
    for (lo, hi) in boxes {
        let reach = lo.abs().max(hi.abs()).max_element();
        if !(lo.is_finite() && hi.is_finite()) || reach > LIMIT {
            return Err(AccelError::Coordinates { at: *lo });
        }
    }
    refuse_crowds(boxes)
}

fn refuse_crowds(boxes: &[(Vec3, Vec3)]) -> Result<(), AccelError> {
    let key = |i: u32| {
        let (lo, hi) = boxes[i as usize];
        [lo.x, lo.y, lo.z, hi.x, hi.y, hi.z].map(f32::to_bits)
    };
    let mut hashed: Vec<(u64, u32)> = (0..boxes.len() as u32)
        .map(|i| (hash_bits(&key(i)), i))
        .collect();
    hashed.sort_unstable();
    for group in hashed.chunk_by(|a, b| a.0 == b.0) {
        if group.len() > COINCIDENT_LIMIT {
            return Err(AccelError::Coincident {
                count: group.len(),
                at: boxes[group[0].1 as usize].0,
            });
        }
    }
    Ok(())
}

/// A hash of some words.
pub(crate) fn hash_bits(words: &[u32]) -> u64 {
    words.iter().fold(0x5851_f42d_4c95_7f2d, |h, &w| {
        hash64(h ^ u64::from(w).wrapping_mul(0x9e37_79b9_7f4a_7c15)).wrapping_add(u64::from(w))
    })
}
