//! From a binary tree to nodes and leaves of eight.
//!
//! What becomes a node, a leaf or an entry of a node above is what costs a ray least (Ylitie, Karras and
//! Laine 2017, section 3): the least cost of each subtree as one to eight entries, from the bottom up.

use super::LEAF;
use super::leaf::{Leaf, SIZE, Steps};
use super::node::{CHILDREN, Grid, Node};
use crate::accel::BinaryNode;
use glam::Vec3;

/// Entries of a node.
const ENTRIES: usize = CHILDREN;
/// Pieces of triangles up to which it is asked whether they fit into a leaf: slender triangles are there in several.
const PIECES: usize = 2 * SIZE;
/// Least room around boxes, in radii.
const ROOM: f32 = 1e-5;
/// What a leaf costs over what a node does: it is seldom in a cache.
const LEAF_COST: f32 = 1.5;

/// A tree on paper.
pub(super) struct Draft {
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: Vec<Leaf>,
    pub(super) grid: Grid,
    /// For each place of a leaf, in order, the triangle there.
    pub(super) places: Vec<u32>,
    /// Nodes one below the other, at most.
    pub(super) depth: usize,
}

/// * `room`: around boxes at least, in radii.
pub(super) fn lay_out(binary: &[BinaryNode], corners: &[[Steps; 3]], room: f32) -> Draft {
    let room = room.max(ROOM);
    let (lo, hi) = (binary.first()).map_or((Vec3::ZERO, Vec3::ZERO), |root| (root.lo, root.hi));
    let mut tree = Draft {
        grid: Grid::new(lo - room, hi + room),
        nodes: Vec::new(),
        leaves: Vec::new(),
        places: Vec::new(),
        depth: 0,
    };
    let mut layout = Layout {
        binary,
        plan: plan(binary, corners),
        corners,
        places: Vec::with_capacity(corners.len() * 2),
        room,
    };
    if !binary.is_empty() {
        tree.nodes.push(Node::EMPTY);
        // Nodes to be filled: number, place in the binary tree, depth.
        let mut open = vec![(0, 0, 1)];
        while let Some((number, at, depth)) = open.pop() {
            layout.fill(&mut tree, number, at, depth, &mut open);
        }
    }
    tree.places = layout.places;
    tree
}

/// The best use of a subtree.
#[derive(Clone, Copy, Debug)]
struct Plan {
    /// Triangles, pieces of one counted each.
    count: u32,
    /// Least cost as up to so many entries and one.
    cost: [f32; ENTRIES],
    /// As many as so many and one entries: how many of them the first child gets; 0 if one fewer is as
    /// good. For one entry: those of the node that it is, 0 for a leaf.
    first: [u8; ENTRIES],
}

fn plan(binary: &[BinaryNode], corners: &[[Steps; 3]]) -> Vec<Plan> {
    let none = Plan {
        count: 0,
        cost: [0.0; ENTRIES],
        first: [0; ENTRIES],
    };
    let mut plans = vec![none; binary.len()];
    let mut stack = vec![(0usize, false)];
    while let Some((at, is_done)) = stack.pop() {
        let Some(node) = binary.get(at) else {
            break;
        };
        let size = node.hi - node.lo;
        let area = size.x * size.y + size.y * size.z + size.z * size.x;
        let child = node.index as usize;
        plans[at] = match (node.is_leaf, is_done) {
            (true, _) => Plan {
                count: 1,
                cost: [LEAF_COST * area; ENTRIES],
                ..none
            },
            (false, true) => {
                let (a, b) = (&plans[child], &plans[child + 1]);
                let fits = || fit(&triangles_below(binary, at), corners);
                let is_leaf = (a.count + b.count) as usize <= PIECES && fits();
                joined(area, a, b, is_leaf)
            }
            (false, false) => {
                stack.extend([(at, true), (child, false), (child + 1, false)]);
                none
            }
        };
    }
    plans
}

/// Whether triangles make a leaf.
fn fit(triangles: &[u32], corners: &[[Steps; 3]]) -> bool {
    let mut points: Vec<Steps> = Vec::with_capacity(SIZE);
    for point in triangles.iter().flat_map(|&t| corners[t as usize]) {
        if !points.contains(&point) {
            points.push(point);
        }
        if points.len() > SIZE {
            return false;
        }
    }
    triangles.len() <= SIZE
}

/// Different triangles of a subtree of the binary tree.
fn triangles_below(binary: &[BinaryNode], at: usize) -> Vec<u32> {
    let mut known: Vec<u32> = Vec::with_capacity(SIZE);
    let mut stack = vec![at];
    while let Some(at) = stack.pop() {
        let node = &binary[at];
        if !node.is_leaf {
            stack.extend([node.index as usize, node.index as usize + 1]);
        } else if !known.contains(&node.index) {
            known.push(node.index);
        }
    }
    known
}

/// * `is_leaf`: whether it can be one.
fn joined(area: f32, a: &Plan, b: &Plan, is_leaf: bool) -> Plan {
    // The best way to deal some entries to both children.
    let dealt = |entries: usize| {
        (1..entries)
            .map(|k| (a.cost[k - 1] + b.cost[entries - k - 1], k as u8))
            .fold((f32::INFINITY, 0), |x, y| if y.0 < x.0 { y } else { x })
    };
    let count = a.count + b.count;
    let (cost, first) = dealt(ENTRIES);
    let mut plan = Plan {
        count,
        cost: [cost + area; ENTRIES],
        first: [first; ENTRIES],
    };
    if is_leaf && LEAF_COST * area <= plan.cost[0] {
        (plan.cost[0], plan.first[0]) = (LEAF_COST * area, 0);
    }
    for entries in 2..=ENTRIES {
        let (cost, first) = dealt(entries);
        let fewer = plan.cost[entries - 2];
        (plan.cost[entries - 1], plan.first[entries - 1]) = if cost < fewer {
            (cost, first)
        } else {
            (fewer, 0)
        };
    }
    plan
}

struct Layout<'a> {
    binary: &'a [BinaryNode],
    plan: Vec<Plan>,
    corners: &'a [[Steps; 3]],
    /// Triangles by place: as many for each leaf as it may hold.
    places: Vec<u32>,
    room: f32,
}

impl Layout<'_> {
    fn is_leaf(&self, at: usize) -> bool {
        self.plan[at].first[0] == 0
    }

    fn fill(
        &mut self,
        tree: &mut Draft,
        number: usize,
        at: usize,
        depth: usize,
        open: &mut Vec<(usize, usize, usize)>,
    ) {
        let mut children = Vec::with_capacity(ENTRIES);
        if self.is_leaf(at) {
            children.push(at);
        } else {
            let first = usize::from(self.plan[at].first[0]);
            self.deal(at, first, ENTRIES - first, &mut children);
        }
        tree.depth = tree.depth.max(depth);
        // Inner children first.
        children.sort_by_key(|&child| self.is_leaf(child));
        let boxes: Vec<(Vec3, Vec3)> = (children.iter())
            .map(|&child| {
                let BinaryNode { lo, hi, .. } = self.binary[child];
                (lo - self.room, hi + self.room)
            })
            .collect();
        let first = [tree.nodes.len() as u32, tree.leaves.len() as u32];
        for &child in &children {
            if self.is_leaf(child) {
                let leaf = self.leaf(child);
                tree.leaves.push(leaf);
            } else {
                open.push((tree.nodes.len(), child, depth + 1));
                tree.nodes.push(Node::EMPTY);
            }
        }
        debug_assert!(tree.leaves.len() < LEAF as usize);
        let inner = tree.nodes.len() - first[0] as usize;
        tree.nodes[number] = Node::new(&tree.grid, &boxes, inner, first);
    }

    /// The entries that the children of a binary node become.
    fn deal(&self, at: usize, first: usize, second: usize, entries: &mut Vec<usize>) {
        let child = self.binary[at].index as usize;
        for (at, mut count) in [(child, first), (child + 1, second)] {
            let plan = &self.plan[at];
            while count > 1 && plan.first[count - 1] == 0 {
                count -= 1;
            }
            match count {
                1 => entries.push(at),
                _ => {
                    let first = usize::from(plan.first[count - 1]);
                    self.deal(at, first, count - first, entries);
                }
            }
        }
    }

    fn leaf(&mut self, at: usize) -> Leaf {
        let known = triangles_below(self.binary, at);
        for k in 0..SIZE {
            self.places.push(known[k.min(known.len() - 1)]);
        }
        let corners: Vec<[Steps; 3]> = known.iter().map(|&t| self.corners[t as usize]).collect();
        Leaf::new(&corners)
    }
}
