//! All strands of a scene as segments behind a tree.

use super::SceneError;
use super::joints::Joints;
use super::ribbon::Segment;
use super::tree::{Found, Ignored, Run, Tree};
use crate::accel::{Ray, hash_bits};
use crate::groom::Groom;
use crate::math::octahedral;
use crate::pages::Table;
use glam::{Quat, Vec2, Vec3, Vec4, Vec4Swizzles};
use rayon::prelude::*;

/// Scene units (millimeters) in a meter.
pub(super) const UNITS_PER_METER: f32 = 1000.0;

/// A point of a strand met by a ray.
#[derive(Clone, Copy, Debug)]
pub struct StrandHit {
    /// Distance along the ray, millimeters.
    pub t: f32,
    found: Found,
    /// The segment as rays meet it, which scattered rays have to leave.
    segment: Segment,
    /// Where along the segment, 0..1.
    along: f32,
    /// Runs of the strand from the first to before the second.
    runs: [u32; 2],
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

/// What shading has to know of a strand, together.
#[derive(Clone, Copy, Debug, Default)]
struct Span {
    first_run: u32,
    length_mm: f32,
}

/// A place on a strand that rays leave.
#[derive(Clone, Copy, Debug)]
pub struct Departure {
    /// Unit, along the segment; zero if it has no length.
    axis: Vec3,
    width: f32,
    runs: [u32; 2],
}

impl Departure {
    /// The start of a ray along unit `dir`.
    ///
    /// In a far-field model light enters and leaves at one point, inside the ribbon. A ray at angle
    /// a to the tangent is two half widths away from a straight strand after `width / sin a`, and
    /// cannot meet it beyond; a bent strand may be met again farther on, as it should.
    #[inline]
    pub fn along(&self, dir: Vec3) -> Leaving {
        let [first, end] = self.runs;
        Leaving(Ignored {
            first,
            end,
            clear: self.width / self.axis.cross(dir).length().max(1e-6),
        })
    }
}

/// What is kept of each strand for those that ask for it, which shading does not.
#[derive(Clone, Copy, Debug)]
struct Strand {
    id: u32,
    root_uv: Vec2,
}

/// What a strand says of each of its runs.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    strand: u32,
    class: u8,
    coat: u8,
}

/// What shading has to know of a run, together: one line of a cache a hit, where arrays of each cost four and
/// tangents from neighboring joints up to three leaves.
#[derive(Clone, Copy, Debug, Default)]
struct Course {
    place: Place,
    /// Position along the strand of its joints, in 65535ths.
    at: [u16; 3],
    /// Unit tangents at its joints.
    tangents: [[i16; 2]; 3],
}

const AT_STEPS: f32 = 65_535.0;

impl Course {
    /// * `joints`: of the strand. * `at`: position of each along it. * `first`: joint of the run.
    fn new(place: Place, joints: &[Vec4], at: &[f32], first: usize) -> Self {
        let joint = [0, 1, 2].map(|k| (first + k).min(joints.len() - 1));
        Self {
            place,
            at: joint.map(|j| (AT_STEPS * at[j] + 0.5) as u16),
            tangents: joint.map(|j| octahedral::encode(tangent(joints, j))),
        }
    }
}

/// Strands ready for tracing. Joints are numbered in the order of strands, root first, and segments by the
/// joint they start at. Where joints are is known to the tree alone.
pub struct Strands {
    /// First joint of each strand, and their number.
    first_joint: Vec<u32>,
    /// For each strand, and at the end the number of runs.
    spans: Vec<Span>,
    /// For each run.
    courses: Table<Course>,
    /// For each strand.
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
        let count = groom.strands();
        let all = Joints::cut(groom)?;
        let (mut first_joint, mut spans, mut runs) = (vec![0], Vec::new(), Vec::new());
        let mut joint = 0;
        for (&count, &length_mm) in all.count.iter().zip(&all.length_mm) {
            spans.push(Span {
                first_run: runs.len() as u32,
                length_mm,
            });
            for first in (0..count.saturating_sub(1)).step_by(2) {
                runs.push(Run {
                    joint: joint + first,
                    segments: (count - 1 - first).min(2) as u8,
                    is_last: first + 3 >= count,
                });
            }
            joint += count;
            first_joint.push(joint);
        }
        spans.push(Span {
            first_run: runs.len() as u32,
            length_mm: 0.0,
        });
        let copies = copies(&all.joints, &runs);
        let tree = Tree::build(&all.joints, &runs, &copies);
        let copied: usize = copies.iter().map(|&(r, _)| segments_of(&runs, r)).sum();
        let segments = runs.iter().map(|r| usize::from(r.segments)).sum::<usize>() - copied;
        // Runs come one after another: the strand of one is that of the last or a later one.
        let course = |last: &mut Option<usize>, run: usize| {
            let is_before = |span: &Span| span.first_run as usize <= run;
            let from = last.unwrap_or_else(|| spans.partition_point(is_before) - 1);
            let later = spans[from + 1..].iter().take_while(|span| is_before(span));
            let strand = from + later.count();
            *last = Some(strand);
            let place = Place {
                strand: strand as u32,
                class: groom.class[strand],
                coat: groom.coat.get(strand).copied().unwrap_or_default(),
            };
            let joints = first_joint[strand] as usize..first_joint[strand + 1] as usize;
            let first = 2 * (run - spans[strand].first_run as usize);
            Course::new(place, &all.joints[joints.clone()], &all.at[joints], first)
        };
        let every = (0..runs.len()).into_par_iter();
        let courses = Table::collect(&Course::default(), every.map_init(|| None, course));
        let strand = |i: usize| Strand {
            id: groom.id.get(i).copied().unwrap_or(i as u32),
            root_uv: groom.root_uv.get(i).copied().unwrap_or_default(),
        };
        Ok(Self {
            first_joint,
            spans,
            courses,
            strands: (0..count).map(strand).collect(),
            sides: Vec::new(),
            tree,
            segments,
        })
    }

    /// Carries the sides of the strands along them, for tables that tell azimuths apart: from the root
    /// on they turn as the tangent does and no further (parallel transport). Strands of which the groom
    /// does not say how they lie get any side.
    pub fn carry_sides(&mut self, groom: &Groom) {
        let mut sides = Vec::new();
        for strand in 0..self.strands.len() as u32 {
            let mut last: Option<(Vec3, Vec3)> = None;
            for joint in 0..self.joint_count(strand) {
                let (run, k) = self.run_of(strand, joint);
                let tangent = octahedral::decode(self.courses[run as usize].tangents[k]);
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

    /// Number of segments that rays are tested against.
    pub fn segments(&self) -> usize {
        self.segments
    }

    /// Joints of all strands in order with the strand, by its index in the groom, that each belongs to:
    /// millimeters, half width in w.
    pub fn joints(&self) -> impl Iterator<Item = (u32, Vec4)> + '_ {
        let strands = 0..self.strands.len() as u32;
        strands.flat_map(move |s| self.joints_of(s).map(move |joint| (s, joint)))
    }

    /// Number of strands.
    pub(super) fn count(&self) -> usize {
        self.strands.len()
    }

    /// Joints of a strand, by its index in the groom; none if it has no length.
    pub(super) fn joints_of(&self, strand: u32) -> impl Iterator<Item = Vec4> + '_ {
        (0..self.joint_count(strand)).map(move |joint| self.joint(strand, joint))
    }

    /// The tree, whose leaves have the joints in the order in which they lie in memory.
    pub(super) fn tree(&self) -> &Tree {
        &self.tree
    }

    /// Number of joints of a strand; none if it has no length.
    fn joint_count(&self, strand: u32) -> u32 {
        self.first_joint[strand as usize + 1] - self.first_joint[strand as usize]
    }

    /// A joint of a strand, counted from the root.
    fn joint(&self, strand: u32, joint: u32) -> Vec4 {
        let (run, k) = self.run_of(strand, joint);
        self.tree.joint(run, k)
    }

    /// A run that a joint of a strand, counted from the root, belongs to, and the joint's number there.
    fn run_of(&self, strand: u32, joint: u32) -> (u32, usize) {
        let first = self.spans[strand as usize].first_run;
        let last = self.spans[strand as usize + 1].first_run - 1;
        let run = (first + joint / 2).min(last);
        (run, (joint - 2 * (run - first)) as usize)
    }

    /// The segment of a strand that starts at a joint, as rays meet it.
    #[cfg(test)]
    pub(super) fn piece(&self, strand: u32, joint: u32) -> Segment {
        let run = self.spans[strand as usize].first_run + joint / 2;
        let [root, tip] = [0, 1].map(|k| self.tree.joint(run, joint as usize % 2 + k));
        Segment { root, tip }
    }

    /// Where among [`Strands::joints`] the segment begins that was met.
    pub fn joint_of(&self, hit: &StrandHit) -> usize {
        self.joint_index(&hit.found, hit.strand)
    }

    fn joint_index(&self, found: &Found, strand: u32) -> usize {
        let strand = strand as usize;
        let local = 2 * (found.run - self.spans[strand].first_run) + found.half;
        (self.first_joint[strand] + local) as usize
    }

    /// Stable id of a strand.
    pub fn id(&self, strand: u32) -> u32 {
        self.strands[strand as usize].id
    }

    /// Texture coordinates of a strand's root.
    pub fn root_uv(&self, strand: u32) -> Vec2 {
        self.strands[strand as usize].root_uv
    }

    /// The nearest strand in front of `limit`, with what shading has to know of it.
    ///
    /// * `leaving`: the strand the ray starts on, if any.
    pub fn closest(&self, ray: &Ray, limit: f32, leaving: Option<Leaving>) -> Option<StrandHit> {
        let found = self.nearest(ray, limit, leaving)?;
        Some(self.describe(&found, ray))
    }

    /// Where the nearest strand in front of `limit` is met.
    ///
    /// * `leaving`: the strand the ray starts on, if any.
    pub fn nearest(&self, ray: &Ray, limit: f32, leaving: Option<Leaving>) -> Option<Found> {
        let found = self.tree.closest(ray, limit, leaving.map(|l| l.0))?;
        // Whoever asks next how it lies there has it sooner.
        self.courses.fetch(found.run as usize);
        Some(found)
    }

    /// Whether any strand lies in front of `limit`.
    pub fn occluded(&self, ray: &Ray, limit: f32, leaving: Option<Leaving>) -> bool {
        self.tree.any(ray, limit, leaving.map(|l| l.0))
    }

    /// What shading has to know of where a ray met a strand.
    pub fn describe(&self, found: &Found, ray: &Ray) -> StrandHit {
        let course = &self.courses[found.run as usize];
        let segment = self.tree.segment(found);
        let along = segment.nearest(ray.origin, ray.dir);
        let half = found.half as usize;
        let [from, to] = [half, half + 1].map(|k| f32::from(course.at[k]) / AT_STEPS);
        let at = from + along * (to - from);
        let [before, after] = [half, half + 1].map(|k| octahedral::decode(course.tangents[k]));
        let tangent = before.lerp(after, along).normalize_or(before);
        let Place {
            strand,
            class,
            coat,
        } = course.place;
        let [span, next] = [0, 1].map(|k| self.spans[strand as usize + k]);
        let side = if self.sides.is_empty() {
            Vec3::ZERO
        } else {
            let joint = self.joint_index(found, strand);
            across(
                self.sides[joint].lerp(self.sides[joint + 1], along),
                tangent,
            )
        };
        StrandHit {
            t: found.t,
            found: *found,
            segment,
            along,
            runs: [span.first_run, next.first_run],
            strand,
            class,
            coat,
            at,
            tip_mm: (1.0 - at) * span.length_mm,
            tangent,
            side,
        }
    }
}

impl StrandHit {
    /// How scattered rays leave the strand.
    pub fn departure(&self) -> Departure {
        let Segment { root, tip } = self.segment;
        Departure {
            axis: (tip - root).xyz().normalize_or_zero(),
            width: 2.0 * root.w.max(tip.w),
            runs: self.runs,
        }
    }

    /// Where `ray` met the strand across its width, -1..1 in radii, positive toward `tangent x viewer`.
    pub fn across(&self, ray: &Ray) -> f32 {
        let Segment { root, tip } = self.segment;
        let radius = root.w + self.along * (tip.w - root.w);
        let side = (tip - root).xyz().cross(-ray.dir).normalize_or_zero();
        ((ray.origin - root.xyz()).dot(side) / radius.max(f32::MIN_POSITIVE)).clamp(-1.0, 1.0)
    }
}

/// Unit tangent at a joint: halfway between the segments that meet there.
fn tangent(joints: &[Vec4], joint: usize) -> Vec3 {
    let chord = |i: usize| match joints.get(i..i + 2) {
        Some([a, b]) => (*b - *a).xyz().normalize_or_zero(),
        _ => Vec3::ZERO,
    };
    let before = joint.checked_sub(1).map_or(Vec3::ZERO, chord);
    let after = chord(joint);
    let any = if after == Vec3::ZERO { before } else { after };
    // Back on itself or without length: any direction will do.
    (before + after).normalize_or(any.normalize_or(Vec3::Y))
}

/// The part of a vector across a unit tangent, as a unit vector; any such where there is none.
fn across(v: Vec3, tangent: Vec3) -> Vec3 {
    let part = v - tangent * v.dot(tangent);
    part.try_normalize()
        .unwrap_or_else(|| tangent.any_orthonormal_vector())
}

fn segments_of(runs: &[Run], run: u32) -> usize {
    runs[run as usize].segments.into()
}

/// Runs that are exact copies of lower ones, in order, each with the lowest.
fn copies(joints: &[Vec4], runs: &[Run]) -> Vec<(u32, u32)> {
    let key = |r: u32| {
        let run = runs[r as usize];
        let at = |i: u8| joints[run.joint as usize + i.min(run.segments) as usize];
        let joints = [at(0), at(1), at(2)].map(|j| j.to_array().map(f32::to_bits));
        (joints, run.segments)
    };
    // The number of a run in the lower bits and in the others some that equal runs have alike.
    let mut hashed: Vec<u64> = (0..runs.len() as u32)
        .into_par_iter()
        .map(|r| hash_bits(key(r).0.as_flattened()) << 32 | u64::from(r))
        .collect();
    hashed.par_sort_unstable();
    let mut copies = Vec::new();
    let alike = hashed.chunk_by(|a, b| a >> 32 == b >> 32);
    for alike in alike.filter(|alike| alike.len() > 1) {
        // Of runs that are not copies.
        let mut lowest: Vec<u32> = Vec::new();
        for run in alike.iter().map(|&h| h as u32) {
            match lowest.iter().find(|&&r| key(r) == key(run)) {
                Some(&like) => copies.push((run, like)),
                None => lowest.push(run),
            }
        }
    }
    copies.sort_unstable();
    copies
}
