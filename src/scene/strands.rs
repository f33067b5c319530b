//! All strands of a scene as segments behind an acceleration structure.

use super::SceneError;
use super::flatten::flatten;
use super::ribbon::Segment;
use crate::accel::{Accel, LIMIT, Ray, hash_bits};
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
pub struct Leaving {
    strand: u32,
    /// Distance along the ray within which the strand itself is not there.
    clear: f32,
}

impl Leaving {
    /// Distance along the ray within which the strand that it leaves is not there, millimeters.
    pub fn clear(&self) -> f32 {
        self.clear
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

/// Strands ready for tracing. Segments are numbered by the joint they start at, in strand order.
pub struct Strands {
    /// Joints of all strands in order, half width in w.
    joints: Vec<Vec4>,
    /// Position along the strand of each joint, 0..1.
    at: Vec<f32>,
    /// Strand of each joint.
    strand_of: Vec<u32>,
    strands: Vec<Strand>,
    /// Segments in traversal order and the joint each starts at.
    segments: Vec<Segment>,
    first_joint: Vec<u32>,
    /// Major axis of the section at each joint; empty if nobody asks for it.
    sides: Vec<Vec3>,
    accel: Accel,
}

impl Strands {
    /// Cuts and sorts a groom.
    ///
    /// * Strands without length are left out. Segments that coincide to the last bit are kept once:
    ///   the one of the lowest strand, the only one a ray could have met.
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
            all.strand_of.extend(batch.strand_of);
            all.length_mm.extend(batch.length_mm);
        }
        let first_joint = starts(&all);
        let segment_at = |j: u32| Segment {
            root: all.joints[j as usize],
            tip: all.joints[j as usize + 1],
        };
        let boxes: Vec<(Vec3, Vec3)> = first_joint
            .iter()
            .map(|&j| segment_at(j).bounds())
            .collect();
        let accel = Accel::build(&boxes)?;
        let first_joint: Vec<u32> = accel
            .order()
            .iter()
            .map(|&i| first_joint[i as usize])
            .collect();
        let segments = first_joint.iter().map(|&j| segment_at(j)).collect();
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
            joints: all.joints,
            at: all.at,
            strand_of: all.strand_of,
            strands,
            segments,
            first_joint,
            sides: Vec::new(),
            accel,
        })
    }

    /// Carries the sides of the strands along them, for tables that tell azimuths apart: from the root
    /// on they turn as the tangent does and no further (parallel transport). Strands of which the groom
    /// does not say how they lie get any side.
    pub fn carry_sides(&mut self, groom: &Groom) {
        let mut sides = vec![Vec3::ZERO; self.joints.len()];
        let mut last: Option<(u32, Vec3, Vec3)> = None;
        for (joint, side) in sides.iter_mut().enumerate() {
            let strand = self.strand_of[joint];
            let tangent = self.tangent_at_joint(joint);
            let carried = match last {
                Some((of, before, side)) if of == strand => {
                    Quat::from_rotation_arc(before, tangent) * side
                }
                _ => {
                    let normal = groom.normal.get(strand as usize).copied();
                    normal.unwrap_or_default().cross(tangent)
                }
            };
            *side = across(carried, tangent);
            last = Some((strand, tangent, *side));
        }
        self.sides = sides;
    }

    /// Unit tangent at a joint.
    fn tangent_at_joint(&self, joint: usize) -> Vec3 {
        let next = self.strand_of.get(joint + 1);
        if next == Some(&self.strand_of[joint]) {
            self.tangent(joint, 0.0)
        } else {
            // The last of its strand, which has two at least.
            self.tangent(joint - 1, 1.0)
        }
    }

    /// Number of segments that rays are tested against.
    pub fn segments(&self) -> usize {
        self.segments.len()
    }

    /// Joints of all strands, millimeters, half width in w.
    pub fn joints(&self) -> &[Vec4] {
        &self.joints
    }

    /// The strand, by its index in the groom, that a joint belongs to.
    pub fn strand_of_joint(&self, joint: usize) -> u32 {
        self.strand_of[joint]
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
        let (prim, t) = self.accel.closest(ray, limit, |prim, best| {
            self.test(prim, ray, best, leaving.as_ref())
        })?;
        self.describe(prim, ray, t)
    }

    /// Whether any strand lies in front of `limit`.
    pub fn occluded(&self, ray: &Ray, limit: f32, leaving: Option<Leaving>) -> bool {
        self.accel.any(ray, limit, |prim, best| {
            self.test(prim, ray, best, leaving.as_ref()).is_some()
        })
    }

    #[inline(always)]
    fn test(&self, prim: usize, ray: &Ray, best: f32, leaving: Option<&Leaving>) -> Option<f32> {
        let (t, _) = self.segments[prim].intersect(ray.origin, ray.dir)?;
        if !(t > 0.0 && t <= best) {
            return None;
        }
        if let Some(own) = leaving
            && t < own.clear
            && self.strand_of[self.first_joint[prim] as usize] == own.strand
        {
            return None;
        }
        Some(t)
    }

    fn describe(&self, prim: usize, ray: &Ray, t: f32) -> Option<StrandHit> {
        let (_, along) = self.segments[prim].intersect(ray.origin, ray.dir)?;
        let joint = self.first_joint[prim] as usize;
        let strand = self.strand_of[joint];
        let Strand {
            class,
            coat,
            length_mm,
            ..
        } = self.strands[strand as usize];
        let at = self.at[joint] + along * (self.at[joint + 1] - self.at[joint]);
        let tangent = self.tangent(joint, along);
        let side = match self.sides.get(joint..joint + 2) {
            Some(&[a, b]) => across(a.lerp(b, along), tangent),
            _ => Vec3::ZERO,
        };
        Some(StrandHit {
            t,
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
        let joint = hit.segment as usize;
        let width = 2.0 * self.joints[joint].w.max(self.joints[joint + 1].w);
        let axis = (self.joints[joint + 1] - self.joints[joint]).xyz();
        let sin = (axis.cross(dir).length() / axis.length()).max(1e-6);
        Leaving {
            strand: hit.strand,
            clear: width / sin,
        }
    }

    fn tangent(&self, joint: usize, along: f32) -> Vec3 {
        let strand = self.strand_of[joint];
        let chord = |j: usize| {
            (self.joints[j + 1] - self.joints[j])
                .xyz()
                .normalize_or_zero()
        };
        let own = chord(joint);
        let same = |j: usize| self.strand_of.get(j) == Some(&strand);
        let before = match joint.checked_sub(1) {
            Some(j) if same(j) => (chord(j) + own).normalize_or(own),
            _ => own,
        };
        let after = if same(joint + 2) {
            (chord(joint + 1) + own).normalize_or(own)
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
    strand_of: Vec<u32>,
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
        out.strand_of.resize(out.at.len(), strand as u32);
        out.joints.extend_from_slice(&joints);
    }
    out
}

/// Joints at which a segment starts, without exact duplicates, in strand order.
fn starts(all: &Batch) -> Vec<u32> {
    let key = |j: u32| {
        let (a, b) = (all.joints[j as usize], all.joints[j as usize + 1]);
        [a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w].map(f32::to_bits)
    };
    let last = all.joints.len().saturating_sub(1) as u32;
    let mut hashed: Vec<(u64, u32)> = (0..last)
        .into_par_iter()
        .filter(|&j| all.strand_of[j as usize] == all.strand_of[j as usize + 1])
        .map(|j| (hash_bits(&key(j)), j))
        .collect();
    hashed.par_sort_unstable();
    // Equal segments have equal hashes and the lowest comes first; two different ones with one hash
    // are both kept.
    hashed.dedup_by(|later, kept| later.0 == kept.0 && key(later.1) == key(kept.1));
    let mut starts: Vec<u32> = hashed.into_iter().map(|(_, j)| j).collect();
    starts.par_sort_unstable();
    starts
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
