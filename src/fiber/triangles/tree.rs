//! The triangles of a tile in a tree: nodes of eight boxes, leaves of up to eight triangles with eight corners. All of a
//! node, and of a leaf, is tested at once in single precision, with the room that its rounding needs: what a ray meets is
//! shown to the caller, who decides in double precision, and little else is.

mod layout;
mod leaf;
mod node;
mod ray;
mod search;
#[cfg(test)]
mod tests;
mod walk;

use super::OVERLAP;
use super::shear::Shear;
use super::solid::Bound;
use crate::accel::lanes::Siblings;
use crate::accel::{AccelError, Effort, binary_tree};
use crate::fiber::{Part, Region};
use crate::pages::Table;
use glam::{DVec3, Vec3};
use leaf::{Leaf, SIZE, Steps};
use node::{Grid, Node};
use search::Query;
pub(super) use walk::Walk;

/// Room for single precision, relative to the longest way of a ray: half a rounding for each of up to
/// 32 operations in a row.
const ROUNDINGS: f32 = 16.0 * f32::EPSILON;
/// Marks children that are leaves.
const LEAF: u32 = Siblings::SECOND;

/// Number of kinds of triangles that can be asked for.
const KINDS: usize = Region::COUNT + 3;

/// A kind of triangles that a ray is to be shown; others it may be shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kind(usize);

impl Kind {
    pub(super) const ALL: Self = Self(KINDS - 1);

    /// What a ray in a region leaves it through.
    pub(super) fn around(region: Region) -> Self {
        Self(region as usize)
    }

    /// What bounds voids, or a medium, from either side, and what a ray in it leaves it through besides.
    pub(super) fn layers(bound: Bound) -> Self {
        match bound {
            Bound::Medulla => Self(Region::COUNT),
            Bound::Void => Self(Region::COUNT + 1),
            // Nobody counts those.
            Bound::Outer | Bound::Cortex => Self::ALL,
        }
    }
}

/// What is known of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Label {
    /// The triangle of the mesh that it is an image of.
    pub(super) source: u32,
    /// Regions outside and inside.
    pub(super) sides: [Region; 2],
    pub(super) bound: Bound,
    pub(super) part: Part,
}

impl Label {
    const NONE: Self = Self {
        source: u32::MAX,
        sides: [Region::Outside; 2],
        bound: Bound::Outer,
        part: Part::Scale,
    };

    /// For each kind whether it is of it if entered, and if left.
    fn kinds(&self) -> [[bool; 2]; KINDS] {
        let mut all = [[false; 2]; KINDS];
        let [outside, inside] = self.sides;
        all[outside as usize][0] = true;
        all[inside as usize][1] = true;
        all[KINDS - 1] = [true; 2];
        for (region, bound) in [
            (Region::Medulla, Bound::Medulla),
            (Region::Void, Bound::Void),
        ] {
            let around = all[region as usize];
            let is_bound = self.bound == bound;
            all[Kind::layers(bound).0] = around.map(|is_around| is_around || is_bound);
        }
        all
    }
}

/// What is known of the triangles of a leaf: read when one of them is met.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct Labels([Label; SIZE]);

/// A tree over triangles that the caller keeps.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    nodes: Table<Node>,
    leaves: Table<Leaf>,
    /// By leaf.
    labels: Table<Labels>,
    grid: Grid,
    /// Nodes one below the other, at most.
    depth: usize,
    /// Corners are multiples of this, in radii.
    step: f64,
    /// Room around what is single precision, in radii.
    room: f32,
}

impl Tree {
    /// The tree, and for each place in it the triangle there: some are at several places, and those
    /// have the same label.
    ///
    /// * `corners`: of all triangles, in radii: multiples of `step`, a power of two, by no more than
    ///   2^31. * `period`: length of the tile, in radii.
    pub(super) fn new(
        corners: &[[DVec3; 3]],
        step: f64,
        period: f64,
    ) -> Result<(Self, Vec<u32>), AccelError> {
        let single: Vec<[Vec3; 3]> = corners.iter().map(|t| t.map(|p| p.as_vec3())).collect();
        let binary = binary_tree(&single, Effort::Best)?;
        // From a little outside of the fiber through all of a tile, and to corners beyond it.
        let corner = |most: f64, p: &DVec3| most.max(p.abs().max_element());
        let corners_reach = corners.iter().flatten().fold(0.0, corner);
        let reach = (2.5 + period + 4.0 * OVERLAP).max(corners_reach) as f32;
        let room = ROUNDINGS * reach;
        let steps: Vec<[Steps; 3]> = (corners.iter())
            .map(|t| t.map(|p| (p / step).to_array().map(|x| x as i32)))
            .collect();
        let draft = layout::lay_out(&binary, &steps, room);
        let tree = Self {
            labels: Table::new(vec![Labels([Label::NONE; SIZE]); draft.leaves.len()]),
            nodes: Table::new(draft.nodes),
            leaves: Table::new(draft.leaves),
            grid: draft.grid,
            depth: draft.depth,
            step,
            room,
        };
        Ok((tree, draft.places))
    }

    /// Turns some triangles inside out.
    pub(super) fn turn(&mut self, which: impl Fn(usize) -> bool) {
        for (index, leaf) in self.leaves.entries_mut().iter_mut().enumerate() {
            for k in (0..leaf.count()).filter(|k| which(SIZE * index + k)) {
                leaf.turn(k);
            }
        }
    }

    /// Labels the triangles; before, every one is of all kinds.
    ///
    /// * `of`: by place.
    pub(super) fn label(&mut self, of: impl Fn(usize) -> Label) {
        for (index, leaf) in self.leaves.entries_mut().iter_mut().enumerate() {
            leaf.holds = [[0; 2]; KINDS];
            for k in 0..leaf.count() {
                let label = of(SIZE * index + k);
                for (holds, is_of) in leaf.holds.iter_mut().zip(label.kinds()) {
                    holds[0] |= u8::from(is_of[0]) << k;
                    holds[1] |= u8::from(is_of[1]) << k;
                }
                self.labels[index].0[k] = label;
            }
        }
        // Children come after their parents.
        for index in (0..self.nodes.len()).rev() {
            let node = &self.nodes[index];
            let held = |k: usize| {
                let child = node.children.number(k as u32);
                let number = (child & !LEAF) as usize;
                if child & LEAF == 0 {
                    return self.nodes[number].held();
                }
                let leaf = &self.leaves[number];
                let holds = leaf.holds.map(|holds| holds.map(|holds| holds != 0));
                (holds, leaf.normals(self.step))
            };
            let children: Vec<_> = (0..node.count()).map(held).collect();
            self.nodes[index].label(&children);
        }
    }

    /// Shows the caller all triangles of a kind that a ray may meet in front of a limit, near ones
    /// as a rule first, perhaps more than once, and some that it does not meet.
    ///
    /// * `test`: the new limit if it is to be nearer.
    #[inline(always)]
    pub(super) fn visit<'a>(
        &'a self,
        ray: &Shear,
        limit: f64,
        kind: Kind,
        test: impl FnMut(Candidate<'a>) -> Option<f64>,
    ) {
        let query = Query {
            tree: self,
            ray,
            limit,
            kind,
        };
        query.answer(test);
    }
}

/// A triangle that a ray may meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate<'a> {
    leaf: &'a Leaf,
    label: &'a Label,
    place: usize,
    step: f64,
}

impl Candidate<'_> {
    /// Its place.
    #[inline(always)]
    pub(super) fn place(self) -> usize {
        self.place
    }

    /// Its label, once it has one.
    #[inline(always)]
    pub(super) fn label(self) -> Label {
        *self.label
    }

    #[inline(always)]
    pub(super) fn corners(self) -> [DVec3; 3] {
        self.leaf.corners(self.place % SIZE, self.step)
    }

    /// Whether it is of a kind, entered or left.
    #[inline(always)]
    pub(super) fn is_of(self, kind: Kind, enters: bool) -> bool {
        let held = self.leaf.holds[kind.0 % KINDS][usize::from(!enters)];
        held >> (self.place % SIZE) & 1 != 0
    }
}
