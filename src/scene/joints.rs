//! From the curves of a groom to straight segments between joints.

use super::SceneError;
use super::flatten::flatten;
use super::strands::UNITS_PER_METER;
use crate::accel::LIMIT;
use crate::groom::Groom;
use crate::pages;
use glam::{Vec4, Vec4Swizzles};
use rayon::prelude::*;

/// Strands cut together; any number gives the same result.
const BATCH: usize = 4096;

/// The joints of some strands, root first.
#[derive(Clone, Default)]
pub(super) struct Joints {
    /// Millimeters, half width in w.
    pub(super) joints: Vec<Vec4>,
    /// Position along the strand of each joint, 0..1.
    pub(super) at: Vec<f32>,
    /// For each strand; none if it has no length.
    pub(super) count: Vec<u32>,
    pub(super) length_mm: Vec<f32>,
}

impl Joints {
    /// Cuts a groom.
    ///
    /// # Errors
    /// Arrays that do not fit together; points that cannot be traced.
    pub(super) fn cut(groom: &Groom) -> Result<Self, SceneError> {
        check(groom)?;
        let count = groom.strands();
        let batches: Vec<Self> = (0..count.div_ceil(BATCH))
            .into_par_iter()
            .map_init(Self::default, |room, b| {
                cut(groom, b * BATCH..((b + 1) * BATCH).min(count), room);
                room.clone()
            })
            .collect();
        let total = |of: fn(&Self) -> usize| batches.iter().map(of).sum();
        // Without room for all of it from the start it would be in memory three times.
        let mut all = Self {
            joints: Vec::with_capacity(total(|b| b.joints.len())),
            at: Vec::with_capacity(total(|b| b.at.len())),
            count: Vec::with_capacity(count),
            length_mm: Vec::with_capacity(count),
        };
        for batch in batches {
            all.joints.extend(batch.joints);
            all.at.extend(batch.at);
            all.count.extend(batch.count);
            all.length_mm.extend(batch.length_mm);
        }
        pages::give_back();
        let is_far = |j: &Vec4| !j.is_finite() || j.abs().max_element() > LIMIT;
        match all.joints.iter().copied().find(is_far) {
            Some(far) => Err(SceneError::Coordinates { at: far.xyz() }),
            None => Ok(all),
        }
    }
}

/// * `out`: where joints come in place of those that are there, whose room is kept.
fn cut(groom: &Groom, strands: std::ops::Range<usize>, out: &mut Joints) {
    out.joints.clear();
    out.at.clear();
    out.count.clear();
    out.length_mm.clear();
    let (mut control, mut joints) = (Vec::new(), Vec::new());
    for strand in strands {
        control.clear();
        control.extend(groom.range(strand).map(|p| {
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
