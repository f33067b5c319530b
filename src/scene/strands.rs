//! All strands of a scene as segments behind a tree.

use super::SceneError;
use super::flatten::flatten;
use super::ribbon::Segment;
use super::tree::{Found, Ignored, Run, Tree};
use crate::accel::{LIMIT, Ray, hash_bits};
use crate::groom::Groom;
use glam::{Quat, Vec2, Vec3, Vec4, Vec4Swizzles};
use rayon::prelude::*;

/// Scene units (millimeters) in a meter.
pub(super) const UNITS_PER_METER: f32 = 1000.0;

/// Strands cut together; any number gives the same result.
const BATCH: usize = 4096;

/// A point of a strand met by a ray.
#[derive(Clone, Copy, Debug)]
pub struct StrandHit {
    /// Distance along the ray, millimeters.
    pub t: f32,
    /// The segment, which scattered rays have to leave.
    pub segment: u32,
    /// Index of the strand in the groom.
    pub strand: u32,
    /// Hair class of the strand.
    pub class: u8,
    /// Part of the coat's pattern that the strand belongs to.
    pub coat: u8,
    /// Position along the strand by arc length, 0 root .. 1 tip.
    pub at: f32,
    /// Distance from the tip along the strand, millimeters.
    pub tip_mm: f32,
    /// Unit tangent, root to tip, running smoothly over joints.
    pub tangent: Vec3,
    /// Unit, across the tangent: the major axis of the section. Zero if no sides are carried.
    pub side: Vec3,
}

/// Where a scattered ray starts, so that it does not meet the strand it is leaving.
#[derive(Clone, Copy, Debug)]
pub struct Leaving(Ignored);

impl Leaving {
    /// Distance along the ray within which the strand that it leaves is not there, millimeters.
    pub fn clear(&self) -> f32 {
        self.0.clear
    }
}

/// What is kept of each strand.
#[derive(Clone, Copy, Debug)]
struct Strand {
    class: u8,
    coat: u8,
    length_mm: f32,
    id: u32,
    root_uv: Vec2,
}

/// Runs between two entries of [`Strands::strand_of`].
const STRIDE: usize = 32;

/// Strands ready for tracing. Joints are numbered in the order of strands, root first, and segments by the
/// joint they start at. Where joints are is known to the tree alone.
pub struct Strands {
    /// First joint of each strand, and their number.
    first_joint: Vec<u32>,
    /// First run of each strand, and their number.
    first_run: Vec<u32>,
    /// The strand of every so many runs.
    strand_of: Vec<u32>,
    /// Position along the strand of each joint, 0..1.
    at: Vec<f32>,
    strands: Vec<Strand>,
    /// Major axis of the section at each joint; empty if nobody asks for it.
    sides: Vec<Vec3>,
    tree: Tree,
    segments: usize,
}

impl Strands {
    /// Cuts and sorts a groom.
    ///
    /// * Strands without length are left out. Where strands coincide to the last bit the lowest is there, the only
    ///   one a ray could have met.
    pub fn build(groom: &Groom) -> Result<Self, SceneError> {
        check(groom)?;
        let count = groom.strands();
        let batches: Vec<Batch> = (0..count.div_ceil(BATCH))
            .into_par_iter()
            .map(|b| cut(groom, b * BATCH..((b + 1) * BATCH).min(count)))
            .collect();
        let mut all = Batch::default();
        for batch in batches {
            all.joints.extend(batch.joints);
            all.at.extend(batch.at);
            all.count.extend(batch.count);
            all.length_mm.extend(batch.length_mm);
        }
        let is_far = |j: &Vec4| !j.is_finite() || j.abs().max_element() > LIMIT;
        if let Some(far) = all.joints.iter().copied().find(is_far) {
            return Err(SceneError::Coordinates { at: far.xyz() });
        }
        let (mut first_joint, mut first_run) = (vec![0], vec![0]);
        let (mut runs, mut strand_of) = (Vec::new(), Vec::new());
        let mut joint = 0;
        for (strand, &count) in all.count.iter().enumerate() {
            for first in (0..count.saturating_sub(1)).step_by(2) {
                if runs.len().is_multiple_of(STRIDE) {
                    strand_of.push(strand as u32);
                }
                runs.push(Run {
                    joint: joint + first,
                    segments: (count - 1 - first).min(2) as u8,
                });
            }
            joint += count;
            first_joint.push(joint);
            first_run.push(runs.len() as u32);
        }
        let copies = copies(&all.joints, &runs);
        let tree = Tree::build(&all.joints, &runs, &copies);
        let copied: usize = copies.iter().map(|&(r, _)| segments_of(&runs, r)).sum();
        let segments = runs.iter().map(|r| usize::from(r.segments)).sum::<usize>() - copied;
        let strands = (0..count)
            .map(|i| Strand {
                class: groom.class[i],
                coat: groom.coat.get(i).copied().unwrap_or_default(),
                length_mm: all.length_mm[i],
                id: groom.id.get(i).copied().unwrap_or(i as u32),
                root_uv: groom.root_uv.get(i).copied().unwrap_or_default(),
            })
            .collect();
        Ok(Self {
            first_joint,
            first_run,
            strand_of,
            at: all.at,
            strands,
            sides: Vec::new(),
            tree,
            segments,
        })
    }

    /// Carries the sides of the strands along them, for tables that tell azimuths apart: from the root
    /// on they turn as the tangent does and no further (parallel transport). Strands of which the groom
    /// does not say how they lie get any side.
    pub fn carry_sides(&mut self, groom: &Groom) {
        let mut sides = Vec::with_capacity(self.at.len());
        for strand in 0..self.strands.len() as u32 {
            let mut last: Option<(Vec3, Vec3)> = None;
            for joint in 0..self.joints_of(strand) {
                let tangent = self.tangent_at_joint(strand, joint);
                let carried = match last {
                    Some((before, side)) => Quat::from_rotation_arc(before, tangent) * side,
                    None => {
                        let normal = groom.normal.get(strand as usize).copied();
                        normal.unwrap_or_default().cross(tangent)
                    }
                };
                let side = across(carried, tangent);
                sides.push(side);
                last = Some((tangent, side));
            }
        }
        self.sides = sides;
    }

    /// Unit tangent at a joint of a strand.
    fn tangent_at_joint(&self, strand: u32, joint: u32) -> Vec3 {
        if joint + 1 < self.joints_of(strand) {
            self.tangent(strand, joint, 0.0)
        } else {
            // The last of its strand, which has two at least.
            self.tangent(strand, joint - 1, 1.0)
        }
    }

    /// Number of segments that rays are tested against.
    pub fn segments(&self) -> usize {
        self.segments
    }

    /// Joints of all strands in order with the strand, by its index in the groom, that each belongs to:
    /// millimeters, half width in w.
    pub fn joints(&self) -> impl Iterator<Item = (u32, Vec4)> + '_ {
        let strands = 0..self.strands.len() as u32;
        strands.flat_map(move |s| (0..self.joints_of(s)).map(move |j| (s, self.joint(s, j))))
    }

    /// Number of joints of a strand; none if it has no length.
    fn joints_of(&self, strand: u32) -> u32 {
        self.first_joint[strand as usize + 1] - self.first_joint[strand as usize]
    }

    /// A joint of a strand, counted from the root.
    fn joint(&self, strand: u32, joint: u32) -> Vec4 {
        let first = self.first_run[strand as usize];
        let last = self.first_run[strand as usize + 1] - 1;
        let run = (first + joint / 2).min(last);
        self.tree.joint(run, (joint - 2 * (run - first)) as usize)
    }

    /// The segment of a strand that starts at a joint, to the bit as rays meet it: where two runs join, each has the
    /// joint rounded in its own way.
    pub(super) fn piece(&self, strand: u32, joint: u32) -> Segment {
        let run = self.first_run[strand as usize] + joint / 2;
        let half = joint as usize % 2;
        Segment {
            root: self.tree.joint(run, half),
            tip: self.tree.joint(run, half + 1),
        }
    }

    /// The segment that was met.
    pub fn segment(&self, hit: &StrandHit) -> Segment {
        let first = self.first_joint[hit.strand as usize];
        self.piece(hit.strand, hit.segment - first)
    }

    /// Stable id of a strand.
    pub fn id(&self, strand: u32) -> u32 {
        self.strands[strand as usize].id
    }

    /// Texture coordinates of a strand's root.
    pub fn root_uv(&self, strand: u32) -> Vec2 {
        self.strands[strand as usize].root_uv
    }

    /// The nearest strand in front of `limit`.
    ///
    /// * `leaving`: the strand the ray starts on, if any.
    pub fn closest(&self, ray: &Ray, limit: f32, leaving: Option<Leaving>) -> Option<StrandHit> {
        let found = self.tree.closest(ray, limit, leaving.map(|l| l.0))?;
        self.describe(&found, ray)
    }

    /// Whether any strand lies in front of `limit`.
    pub fn occluded(&self, ray: &Ray, limit: f32, leaving: Option<Leaving>) -> bool {
        self.tree.any(ray, limit, leaving.map(|l| l.0))
    }

    fn describe(&self, found: &Found, ray: &Ray) -> Option<StrandHit> {
        let mut strand = self.strand_of[found.run as usize / STRIDE];
        while self.first_run[strand as usize + 1] <= found.run {
            strand += 1;
        }
        let local = 2 * (found.run - self.first_run[strand as usize]) + found.half;
        let piece = self.piece(strand, local);
        let (_, along) = piece.intersect(ray.origin, ray.dir)?;
        let joint = (self.first_joint[strand as usize] + local) as usize;
        let Strand {
            class,
            coat,
            length_mm,
            ..
        } = self.strands[strand as usize];
        let at = self.at[joint] + along * (self.at[joint + 1] - self.at[joint]);
        let tangent = self.tangent(strand, local, along);
        let side = match self.sides.get(joint..joint + 2) {
            Some(&[a, b]) => across(a.lerp(b, along), tangent),
            _ => Vec3::ZERO,
        };
        Some(StrandHit {
            t: found.t,
            segment: joint as u32,
            strand,
            class,
            coat,
            at,
            tip_mm: (1.0 - at) * length_mm,
            tangent,
            side,
        })
    }

    /// The start of a ray that leaves a strand along unit `dir`.
    ///
    /// In a far-field model light enters and leaves at one point, inside the ribbon. A ray at angle
    /// a to the tangent is two half widths away from a straight strand after `width / sin a`, and
    /// cannot meet it beyond; a bent strand may be met again farther on, as it should.
    pub fn leave(&self, hit: &StrandHit, dir: Vec3) -> Leaving {
        let strand = hit.strand as usize;
        let Segment { root, tip } = self.segment(hit);
        let width = 2.0 * root.w.max(tip.w);
        let axis = (tip - root).xyz();
        let sin = (axis.cross(dir).length() / axis.length()).max(1e-6);
        Leaving(Ignored {
            first: self.first_run[strand],
            end: self.first_run[strand + 1],
            clear: width / sin,
        })
    }

    fn tangent(&self, strand: u32, joint: u32, along: f32) -> Vec3 {
        let at = |j: u32| self.joint(strand, j).xyz();
        let chord = |a: Vec3, b: Vec3| (b - a).normalize_or_zero();
        let (root, tip) = (at(joint), at(joint + 1));
        let own = chord(root, tip);
        let before = match joint.checked_sub(1) {
            Some(j) => (chord(at(j), root) + own).normalize_or(own),
            None => own,
        };
        let after = if joint + 2 < self.joints_of(strand) {
            (chord(tip, at(joint + 2)) + own).normalize_or(own)
        } else {
            own
        };
        before.lerp(after, along).normalize_or(own)
    }
}

/// The part of a vector across a unit tangent, as a unit vector; any such where there is none.
fn across(v: Vec3, tangent: Vec3) -> Vec3 {
    let part = v - tangent * v.dot(tangent);
    part.try_normalize()
        .unwrap_or_else(|| tangent.any_orthonormal_vector())
}

/// The joints of some strands.
#[derive(Default)]
struct Batch {
    joints: Vec<Vec4>,
    at: Vec<f32>,
    /// For each strand.
    count: Vec<u32>,
    length_mm: Vec<f32>,
}

fn cut(groom: &Groom, strands: std::ops::Range<usize>) -> Batch {
    let mut out = Batch::default();
    let (mut control, mut joints) = (Vec::new(), Vec::new());
    for strand in strands {
        let range = groom.offsets[strand] as usize..groom.offsets[strand + 1] as usize;
        control.clear();
        control.extend(range.map(|p| {
            (groom.points[p] * UNITS_PER_METER).extend(0.5 * groom.widths[p] * UNITS_PER_METER)
        }));
        joints.clear();
        flatten(&control, &mut joints);
        if joints.len() < 2 {
            out.length_mm.push(0.0);
            out.count.push(0);
            continue;
        }
        let start = out.at.len();
        let mut length = 0.0f64;
        out.at.push(0.0);
        for pair in joints.windows(2) {
            length += f64::from(pair[0].xyz().distance(pair[1].xyz()));
            out.at.push(length as f32);
        }
        for at in &mut out.at[start..] {
            *at /= length as f32;
        }
        out.length_mm.push(length as f32);
        out.count.push(joints.len() as u32);
        out.joints.extend_from_slice(&joints);
    }
    out
}

fn segments_of(runs: &[Run], run: u32) -> usize {
    runs[run as usize].segments.into()
}

/// Runs that are exact copies of lower ones, in order, each with the lowest.
fn copies(joints: &[Vec4], runs: &[Run]) -> Vec<(u32, u32)> {
    let key = |r: u32| {
        let run = runs[r as usize];
        let at = |i: u8| joints[run.joint as usize + i.min(run.segments) as usize];
        [at(0), at(1), at(2)].map(|j| j.to_array().map(f32::to_bits))
    };
    let mut hashed: Vec<(u64, u32)> = (0..runs.len() as u32)
        .into_par_iter()
        .map(|r| (hash_bits(key(r).as_flattened()), r))
        .collect();
    hashed.par_sort_unstable();
    // Equal runs have equal hashes and the lowest comes first; two different ones with one hash
    // are both kept.
    let mut copies = Vec::new();
    for same in hashed.chunk_by(|a, b| a.0 == b.0) {
        let lowest = same[0].1;
        let others = same[1..].iter().map(|&(_, r)| r);
        let equal = others.filter(|&r| {
            segments_of(runs, r) == segments_of(runs, lowest) && key(r) == key(lowest)
        });
        copies.extend(equal.map(|r| (r, lowest)));
    }
    copies.sort_unstable();
    copies
}

fn check(groom: &Groom) -> Result<(), SceneError> {
    let (points, strands) = (groom.points.len(), groom.strands());
    let whole = groom.offsets.len() == strands + 1
        && groom.widths.len() == points
        && groom.offsets.windows(2).all(|o| o[0] <= o[1])
        && groom.offsets.last().is_some_and(|&o| o as usize == points);
    if !whole {
        return Err(SceneError::Groom { strands, points });
    }
    let limit = LIMIT / UNITS_PER_METER;
    for (i, (p, w)) in groom.points.iter().zip(&groom.widths).enumerate() {
        if !p.is_finite() || p.abs().max_element() > limit || !(0.0..=limit).contains(w) {
            return Err(SceneError::Point {
                index: i,
                at: *p,
                width: *w,
            });
        }
    }
    Ok(())
}
