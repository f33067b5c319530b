//! Strands in flat arrays.

use super::Account;
use crate::skin::Skin;
use glam::{Vec2, Vec3};
use std::ops::Range;

/// All strands. Strand `i` has control points `points[offsets[i]..offsets[i + 1]]`, at least two,
/// root first; the curve is a Catmull-Rom spline pinned at both ends, through every point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Groom {
    /// Control points, meters.
    pub points: Vec<Vec3>,
    /// Full diameter at each control point, meters (after width compensation for thinned grooms).
    pub widths: Vec<f32>,
    /// Start of each strand in `points`; one more entry than strands.
    pub offsets: Vec<u32>,
    /// Hair class of each strand: index into `classes`.
    pub class: Vec<u8>,
    /// Part of the coat's pattern that each strand belongs to: index into `coats`.
    pub coat: Vec<u8>,
    /// Stable id of each strand: survives a change of density. The top four bits are the class, the
    /// rest is the rank in the class's blue-noise order: the strands of lowest rank form an evenly
    /// thinned groom.
    pub id: Vec<u32>,
    /// Texture coordinates of each root.
    pub root_uv: Vec<Vec2>,
    /// Triangle of the skin that each root lies on.
    pub root_triangle: Vec<u32>,
    /// Where each root lies on its triangle: the weights of its second and third corner.
    pub root_barycentric: Vec<Vec2>,
    /// Arc length of each strand along its control points, meters.
    pub length: Vec<f32>,
    /// Direction that the flat side of each strand's section faces at the root: unit, along the minor
    /// axis, across the first piece of the strand. It is carried along the strand without twisting.
    pub normal: Vec<Vec3>,
    /// Names of the hair classes.
    pub classes: Vec<String>,
    /// Names of the parts of the coat's pattern; the first has the pigment of the species itself.
    pub coats: Vec<String>,
    /// Factor on the skin's color at each of its vertices, so that a thin coat shows no other color
    /// through; empty for a coat of one color. See [`Groom::skin_color`].
    pub skin_tint: Vec<Vec3>,
    /// What could not be grown as asked, one sentence each.
    pub warnings: Vec<String>,
    /// Per class: how many hairs were asked for, and what became of them.
    pub accounts: Vec<Account>,
    /// Per class: factor on the natural diameter by which a thinned groom stays opaque; 1 at full
    /// density.
    pub width_scale: Vec<f32>,
    /// Per class: number of follicles that the living animal would have on this skin.
    pub natural: Vec<f64>,
}

impl Groom {
    /// Number of strands.
    pub fn strands(&self) -> usize {
        self.class.len()
    }

    /// Where the control points of strand `index` stand in `points`, and their widths in `widths`.
    pub fn range(&self, index: usize) -> Range<usize> {
        self.offsets[index] as usize..self.offsets[index + 1] as usize
    }

    /// Control points of strand `index`, root first.
    pub fn strand(&self, index: usize) -> &[Vec3] {
        &self.points[self.range(index)]
    }

    /// Factor on the species' skin color at a vertex of the skin that this groom grows on: the skin's own,
    /// tinted by the coat.
    pub fn skin_color(&self, skin: &Skin, vertex: usize) -> Vec3 {
        let tint = self.skin_tint.get(vertex).copied().unwrap_or(Vec3::ONE);
        skin.color[vertex] * tint
    }

    /// Takes out the last class's strands of no length; returns how many they were.
    ///
    /// * `first`, `start`: the class's first strand and control point. * `ranks`: of its strands.
    pub(super) fn remove_buried(
        &mut self,
        first: usize,
        start: usize,
        per_strand: usize,
        ranks: &mut Vec<u32>,
    ) -> usize {
        let mut kept = 0;
        for from in 0..ranks.len() {
            if self.length[first + from] == 0.0 {
                continue;
            }
            if kept < from {
                ranks[kept] = ranks[from];
                self.length[first + kept] = self.length[first + from];
                self.normal[first + kept] = self.normal[first + from];
                self.coat[first + kept] = self.coat[first + from];
                let strand = start + from * per_strand..start + (from + 1) * per_strand;
                let to = start + kept * per_strand;
                self.points.copy_within(strand.clone(), to);
                self.widths.copy_within(strand, to);
            }
            kept += 1;
        }
        let buried = ranks.len() - kept;
        ranks.truncate(kept);
        self.length.truncate(first + kept);
        self.normal.truncate(first + kept);
        self.coat.truncate(first + kept);
        self.points.truncate(start + kept * per_strand);
        self.widths.truncate(start + kept * per_strand);
        buried
    }
}
