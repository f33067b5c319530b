//! From runs to nodes and leaves, from the top down.
//!
//! A node's runs are looked at along axes of its own: those of the scene, or such that one lies along
//! the hair where that makes boxes smaller (Woop, Benthin, Wald, Johnson and Tabellion 2014). They are
//! cut in two where that costs a ray least (surface area heuristic in bins, Wald 2007), the largest part
//! first, until there are sixteen parts.

use super::bounds::Bounds;
use super::leaf::{Leaf, RUNS};
use super::node::{Child, Node};
use super::{DEPTH, Run};
use crate::accel::lanes::CHILDREN;
use crate::pages::{self, Table};
use glam::{Mat3, Mat3A, Vec3, Vec3A, Vec4, Vec4Swizzles};
use rayon::prelude::*;

/// Bins along an axis.
const BINS: usize = 16;
/// From this depth on runs are halved, so that no way is longer than [`DEPTH`].
const EVEN: usize = DEPTH - 7;
/// Runs from which on the parts are built on several threads.
const MANY: usize = 2048;
/// Leaves of a child at most.
const LEAVES: usize = 2;
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
    let numbers: Vec<u32> = items.into_par_iter().map(|item| item.number).collect();
    let (mut nodes, mut leaves) = (vec![None], Vec::new());
    let mut open = vec![(0, &root)];
    while let Some((number, branch)) = open.pop() {
        let first = [nodes.len() as u32, leaves.len() as u32];
        for part in &branch.parts {
            match &part.below {
                Some(below) => {
                    open.push((nodes.len(), below));
                    nodes.push(None);
                }
                None => {
                    let (from, to) = (part.begin, part.begin + part.count);
                    leaves.extend((from..to).step_by(RUNS).map(|l| (l, to)));
                }
            }
        }
        let children: Vec<Child> = branch.parts.iter().map(|part| part.child).collect();
        nodes[number] = Some(Node::new(&branch.axes, &children, first, blur));
    }
    let nodes = Table::new(nodes.into_iter().flatten().collect());
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

/// A run along the axes of a node.
#[derive(Clone, Copy)]
struct Item {
    bounds: Bounds,
    number: u32,
}

/// Runs next to each other in the list of a node.
struct Group {
    begin: usize,
    end: usize,
    bounds: Bounds,
    middles: Bounds,
}

impl Group {
    fn new(items: &[Item], begin: usize, end: usize) -> Self {
        let one = |item: &Item| {
            let middle = item.bounds.middle();
            let (lo, hi) = (middle, middle);
            (item.bounds, Bounds { lo, hi })
        };
        let both = |a: (Bounds, Bounds), b: (Bounds, Bounds)| (a.0.with(b.0), a.1.with(b.1));
        let none = (Bounds::NONE, Bounds::NONE);
        let items = &items[begin..end];
        let (bounds, middles) = match items.len() > 64 * MANY {
            true => items.par_iter().map(one).reduce(|| none, both),
            false => items.iter().map(one).fold(none, both),
        };
        Self {
            begin,
            end,
            bounds,
            middles,
        }
    }

    fn count(&self) -> usize {
        self.end - self.begin
    }
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
        Item {
            bounds: self.bounds(number, &local(axes)),
            number,
        }
    }

    /// Axes, as columns, along which boxes are small.
    fn axes(&self, items: &[Item]) -> Mat3 {
        let some = || {
            let step = items.len().div_ceil(SOME);
            items.iter().step_by(step).map(|item| item.number)
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
            let turn = |item: &mut Item| *item = self.item(item.number, &axes);
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

/// Sorts runs into the parts of a node.
fn deal(items: &mut [Item], is_even: bool) -> Vec<Group> {
    let mut groups = vec![Group::new(items, 0, items.len())];
    while groups.len() < CHILDREN {
        let size = |i: usize| match is_even {
            true => groups[i].count() as f32,
            false => groups[i].bounds.area(),
        };
        let largest = |least: usize| {
            (0..groups.len())
                .filter(|&i| groups[i].count() > least)
                .max_by(|&a, &b| size(a).total_cmp(&size(b)).then(b.cmp(&a)))
        };
        let Some(i) = largest(LEAVES * RUNS).or_else(|| largest(RUNS)) else {
            break;
        };
        let whole = groups.swap_remove(i);
        let first = cut(&mut items[whole.begin..whole.end], &whole.middles, is_even);
        let middle = whole.begin + first;
        groups.push(Group::new(items, whole.begin, middle));
        groups.push(Group::new(items, middle, whole.end));
    }
    groups.sort_unstable_by_key(|g| g.begin);
    groups
}

/// Bins along each axis: what is in them and how many.
type Bins = [[(Bounds, usize); BINS]; 3];

fn join(a: (Bounds, usize), b: (Bounds, usize)) -> (Bounds, usize) {
    (a.0.with(b.0), a.1 + b.1)
}

/// Cuts runs in two and gives how many are in the first part, neither none nor all.
fn cut(items: &mut [Item], middles: &Bounds, is_even: bool) -> usize {
    let size = middles.hi - middles.lo;
    let widest = size.max_position();
    if is_even || size[widest] <= 0.0 {
        let half = items.len() / 2;
        items.select_nth_unstable_by(half, |a, b| {
            let at = |item: &Item| item.bounds.middle()[widest];
            at(a).total_cmp(&at(b)).then(a.number.cmp(&b.number))
        });
        return half;
    }
    let scale = (0.9999 * BINS as f32) / size.max(Vec3A::splat(f32::MIN_POSITIVE));
    let bins_of = |item: &Item| {
        // 1.5 times 2^23: what is added to it is rounded to a whole number, in the lowest bits. Conversions that saturate
        // took a quarter of the builder's time.
        const WHOLE: f32 = 12_582_912.0;
        let at = (item.bounds.middle() - middles.lo) * scale - 0.5 + WHOLE;
        at.to_array().map(|at| at.to_bits() as usize % BINS)
    };
    let sort = |items: &[Item]| {
        let mut bins: Bins = [[(Bounds::NONE, 0); BINS]; 3];
        for item in items {
            for (bins, bin) in bins.iter_mut().zip(bins_of(item)) {
                let (bounds, count) = &mut bins[bin];
                *bounds = bounds.with(item.bounds);
                *count += 1;
            }
        }
        bins
    };
    let none = [[(Bounds::NONE, 0); BINS]; 3];
    let both = |a: Bins, b: Bins| {
        std::array::from_fn(|axis| std::array::from_fn(|k| join(a[axis][k], b[axis][k])))
    };
    let bins = match items.len() > 64 * MANY {
        true => (items.par_chunks(16 * MANY))
            .map(sort)
            .reduce(|| none, both),
        false => sort(items),
    };
    let (axis, place) = cheapest(&bins).unwrap_or((widest, BINS / 2));
    let mut first = 0;
    for i in 0..items.len() {
        if bins_of(&items[i])[axis] < place {
            items.swap(first, i);
            first += 1;
        }
    }
    first
}

/// Axis and first bin of the second part, of all cuts that leave something on both sides.
fn cheapest(bins: &Bins) -> Option<(usize, usize)> {
    let cost = |(bounds, count): (Bounds, usize)| bounds.area() * count.div_ceil(RUNS) as f32;
    let mut best = None;
    let mut least = f32::INFINITY;
    for (axis, bins) in bins.iter().enumerate() {
        let mut above = [f32::INFINITY; BINS];
        let mut sum = (Bounds::NONE, 0);
        for k in (1..BINS).rev() {
            sum = join(sum, bins[k]);
            if sum.1 > 0 {
                above[k] = cost(sum);
            }
        }
        let mut sum = (Bounds::NONE, 0);
        for k in 1..BINS {
            sum = join(sum, bins[k - 1]);
            if sum.1 > 0 && cost(sum) + above[k] < least {
                least = cost(sum) + above[k];
                best = Some((axis, k));
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever the sizes of the boxes, parts of one size: else [`DEPTH`] is no bound.
    #[test]
    fn even_parts_have_one_size() {
        let count = 800;
        let joints: Vec<Vec4> = (0..count)
            .flat_map(|i| {
                let size = 1.02f32.powi(i);
                [size, 1.01 * size].map(|x| Vec4::new(x, 0.3 * x, -x, 1e-3 * x))
            })
            .collect();
        let runs: Vec<Run> = (0..count as u32)
            .map(|i| Run {
                joint: 2 * i,
                segments: 1,
                is_last: true,
            })
            .collect();
        let fur = Fur {
            joints: &joints,
            runs: &runs,
        };
        let mut items: Vec<Item> = (0..count as u32)
            .map(|number| fur.item(number, &Mat3::IDENTITY))
            .collect();
        let groups = deal(&mut items, true);
        let counts: Vec<usize> = groups.iter().map(Group::count).collect();
        assert_eq!(counts, [count as usize / CHILDREN; CHILDREN]);
    }
}
