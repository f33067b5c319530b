//! From runs to nodes and leaves, from the top down.
//!
//! A node's runs are looked at along axes of its own: those of the scene, or such that one lies along
//! the hair where that makes boxes smaller (Woop, Benthin, Wald, Johnson and Tabellion 2014). They are
//! cut in two where that costs a ray least (surface area heuristic in bins, Wald 2007), the largest part
//! first, until there are sixteen parts.

use super::bounds::Bounds;
use super::cut::{Group, Item, LEAVES, deal};
use super::leaf::{Leaf, RUNS};
use super::node::{Child, Node};
use super::{DEPTH, Run};
use crate::pages::{self, Table};
use glam::{Mat3, Mat3A, Vec3, Vec3A, Vec4, Vec4Swizzles};
use rayon::prelude::*;

/// From this depth on runs are halved, so that no way is longer than [`DEPTH`].
const EVEN: usize = DEPTH - 7;
/// Runs from which on the parts are built on several threads.
const MANY: usize = 2048;
/// Runs that are looked at to choose axes.
const SOME: usize = 256;

/// Nodes, the root first, and leaves.
pub(super) struct Draft {
    pub(super) nodes: Table<Node>,
    pub(super) leaves: Table<Leaf>,
}

/// * `numbers`: of the runs that are in the tree. * `blur`: as [`Node::new`].
pub(super) fn build(joints: &[Vec4], runs: &[Run], numbers: Vec<u32>, blur: f32) -> Draft {
    if numbers.is_empty() {
        return Draft {
            nodes: Table::default(),
            leaves: Table::default(),
        };
    }
    let fur = Fur { joints, runs };
    let axes = Mat3::IDENTITY;
    let mut items: Vec<Item> = (numbers.into_par_iter())
        .map(|number| fur.item(number, &axes))
        .collect();
    let root = fur.branch(&mut items, &axes, 0, 0);
    let numbers: Vec<u32> = items.par_iter().map(Item::number).collect();
    drop(items);
    // Each with its first children.
    let (mut branches, mut leaves) = (vec![(&root, [0; 2])], Vec::new());
    let mut open = vec![0];
    while let Some(number) = open.pop() {
        let (branch, _) = branches[number];
        branches[number].1 = [branches.len() as u32, leaves.len() as u32];
        for part in &branch.parts {
            match &part.below {
                Some(below) => {
                    open.push(branches.len());
                    branches.push((below, [0; 2]));
                }
                None => {
                    let (from, to) = (part.begin, part.begin + part.count);
                    leaves.extend((from..to).step_by(RUNS).map(|l| (l, to)));
                }
            }
        }
    }
    let node = |(branch, first): (&Branch, [u32; 2])| {
        let children: Vec<Child> = branch.parts.iter().map(|part| part.child).collect();
        Node::new(&branch.axes, &children, first, blur)
    };
    let nodes = Table::collect(&node(branches[0]), branches.par_iter().map(|&b| node(b)));
    drop(root);
    pages::give_back();
    let leaf = |(from, to): (usize, usize)| {
        let end = to.min(from + RUNS);
        Leaf::new(joints, runs, &numbers[from..end], end < to)
    };
    Draft {
        nodes,
        leaves: Table::collect(&leaf(leaves[0]), leaves.par_iter().map(|&l| leaf(l))),
    }
}

/// A node that is to be.
struct Branch {
    /// Columns.
    axes: Mat3,
    parts: Vec<Part>,
}

/// A child that is to be.
struct Part {
    child: Child,
    /// Its runs in the order of the tree.
    begin: usize,
    count: usize,
    below: Option<Box<Branch>>,
}

struct Fur<'a> {
    joints: &'a [Vec4],
    runs: &'a [Run],
}

impl Fur<'_> {
    fn joints_of(&self, number: u32) -> &[Vec4] {
        let run = self.runs[number as usize];
        let first = run.joint as usize;
        &self.joints[first..=first + run.segments as usize]
    }

    /// * `local`: rows are the axes.
    fn bounds(&self, number: u32, local: &Mat3A) -> Bounds {
        let mut bounds = Bounds::NONE;
        for joint in self.joints_of(number) {
            let at = *local * Vec3A::from_vec4(*joint);
            bounds.lo = bounds.lo.min(at - joint.w);
            bounds.hi = bounds.hi.max(at + joint.w);
        }
        bounds
    }

    /// * `axes`: columns.
    fn item(&self, number: u32, axes: &Mat3) -> Item {
        Item::new(self.bounds(number, &local(axes)), number)
    }

    /// Axes, as columns, along which boxes are small.
    fn axes(&self, items: &[Item]) -> Mat3 {
        let some = || {
            let step = items.len().div_ceil(SOME);
            items.iter().step_by(step).map(Item::number)
        };
        let mut along = Vec3::ZERO;
        for number in some() {
            let joints = self.joints_of(number);
            along += joints[joints.len() - 1].xyz() - joints[0].xyz();
        }
        let Some(along) = along.try_normalize() else {
            return Mat3::IDENTITY;
        };
        let (x, y) = along.any_orthonormal_pair();
        let axes = Mat3::from_cols(x, y, along);
        let area = |local: &Mat3A| {
            let boxes = some().map(|number| self.bounds(number, local));
            let none = (0.0f32, Bounds::NONE);
            let (sum, all) = boxes.fold(none, |(sum, all), b| (sum + b.area(), all.with(b)));
            sum * all.area()
        };
        match area(&local(&axes)) < area(&Mat3A::IDENTITY) {
            true => axes,
            false => Mat3::IDENTITY,
        }
    }

    /// * `items`: along `known`, columns; they are sorted and turned, and what is below as well.
    fn branch(&self, items: &mut [Item], known: &Mat3, begin: usize, depth: usize) -> Branch {
        let axes = self.axes(items);
        let is_many = items.len() > MANY;
        // Near the root axes stay those of the scene, and joints would be far apart in memory.
        if axes != *known {
            let turn = |item: &mut Item| *item = self.item(item.number(), &axes);
            match is_many {
                true => items.par_iter_mut().for_each(turn),
                false => items.iter_mut().for_each(turn),
            }
        }
        let groups = deal(items, depth >= EVEN);
        let mut rest = items;
        let mut parts: Vec<(Group, &mut [Item])> = Vec::with_capacity(groups.len());
        for group in groups {
            let (own, others) = rest.split_at_mut(group.count());
            rest = others;
            parts.push((group, own));
        }
        let part = |(group, items): (Group, &mut [Item])| {
            let (begin, count) = (begin + group.begin, items.len());
            let leaves = match count <= LEAVES * RUNS {
                true => count.div_ceil(RUNS),
                false => 0,
            };
            // Joints of leaves are rounded, by a good deal less than this.
            let Bounds { lo, hi } = group.bounds;
            let room = (hi - lo).max_element() * (1.0 / 16384.0);
            let below =
                (leaves == 0).then(|| Box::new(self.branch(items, &axes, begin, depth + 1)));
            let (lo, hi) = (lo - room, hi + room);
            Part {
                child: Child {
                    lo: lo.into(),
                    hi: hi.into(),
                    leaves,
                },
                begin,
                count,
                below,
            }
        };
        let parts = match is_many {
            true => parts.into_par_iter().map(part).collect(),
            false => parts.into_iter().map(part).collect(),
        };
        Branch { axes, parts }
    }
}

/// From the scene to a node.
///
/// * `axes`: columns.
fn local(axes: &Mat3) -> Mat3A {
    axes.transpose().into()
}
