//! Strands added up in voxels.

use super::VolumeError;
use super::curve::{Curves, Joint, MOST_STEPS};
use super::walk::walk;
use crate::export::vdb::Leaf;
use crate::progress::{Cancel, Progress};
use glam::{DVec3, IVec3};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Strands listed together by one thread.
const BATCH: usize = 256;
/// Farthest leaf from the origin, in leaves.
const REACH: i32 = 1 << 20;

/// What strands leave in one voxel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Moments {
    /// Sum of diameter times length, square units of the file.
    pub(super) area: f64,
    /// Sum of lengths, units of the file.
    pub(super) length: f64,
    /// Sum of volumes, cubic units of the file.
    pub(super) volume: f64,
    /// Sum of unit tangents, root to tip, times area.
    pub(super) tangent: DVec3,
    /// Sum of colors times area.
    pub(super) color: DVec3,
}

/// Which spans of strands pass through which leaf. Sorted, so that what is added up in a leaf has one
/// order, whatever the threads did.
#[derive(Debug)]
pub(super) struct Listing {
    /// Leaf and index of the span's first control point.
    pairs: Vec<(u64, u32)>,
    voxel: f64,
}

impl Listing {
    /// Finds the leaves of all strands.
    pub(super) fn new(
        curves: &Curves<'_>,
        voxel: f64,
        progress: &dyn Progress,
        cancel: &Cancel,
    ) -> Result<Self, VolumeError> {
        let batches = curves.len().div_ceil(BATCH);
        progress.begin("finding voxels", curves.len() as u64, "strands");
        let lists: Result<Vec<Vec<(u64, u32)>>, VolumeError> = (0..batches)
            .into_par_iter()
            .map(|batch| {
                if cancel.is_cancelled() {
                    return Err(VolumeError::Cancelled);
                }
                let (mut list, mut joints) = (Vec::new(), Vec::new());
                let of = batch * BATCH..((batch + 1) * BATCH).min(curves.len());
                progress.advance(of.len() as u64);
                for curve in of {
                    for span in curves.spans(curve) {
                        curves.joints(span, curve, voxel, &mut joints);
                        list_span(&joints, span as u32, voxel, &mut list)?;
                    }
                }
                Ok(list)
            })
            .collect();
        let mut pairs = lists?.concat();
        pairs.par_sort_unstable();
        pairs.dedup();
        progress.finish();
        Ok(Self { pairs, voxel })
    }

    /// Number of leaves.
    pub(super) fn leaves(&self) -> usize {
        self.pairs.chunk_by(|a, b| a.0 == b.0).count()
    }

    /// Adds up each leaf and makes something of its 512 voxels, in the order of the listing.
    pub(super) fn map<R: Send>(
        &self,
        curves: &Curves<'_>,
        progress: &dyn Progress,
        cancel: &Cancel,
        make: impl Fn(IVec3, &[Moments]) -> R + Sync,
    ) -> Result<Vec<R>, VolumeError> {
        let groups: Vec<&[(u64, u32)]> = self.pairs.chunk_by(|a, b| a.0 == b.0).collect();
        progress.begin("filling voxels", groups.len() as u64, "leaves");
        let buffers = || (vec![Moments::default(); 512], Vec::new());
        let made = groups
            .par_iter()
            .map_init(buffers, |(moments, joints), group| {
                if cancel.is_cancelled() {
                    return Err(VolumeError::Cancelled);
                }
                let origin = leaf_origin(group[0].0);
                moments.fill(Moments::default());
                for &(_, span) in *group {
                    let span = span as usize;
                    let curve = curves.curve_of(span);
                    curves.joints(span, curve, self.voxel, joints);
                    add_span(curves, span, joints, self.voxel, origin, moments);
                }
                progress.advance(1);
                Ok(make(origin, moments))
            })
            .collect();
        progress.finish();
        made
    }
}

fn list_span(
    joints: &[Joint],
    span: u32,
    voxel: f64,
    list: &mut Vec<(u64, u32)>,
) -> Result<(), VolumeError> {
    let ends = joints.first().zip(joints.last());
    let length = ends.map_or(0.0, |(a, b)| a.at.distance(b.at));
    if length > MOST_STEPS * voxel {
        return Err(VolumeError::LongSpan {
            at: joints[0].at.as_vec3(),
            length,
            limit: MOST_STEPS * voxel,
        });
    }
    for pair in joints.windows(2) {
        let [from, to] = [pair[0].at, pair[1].at].map(|p| p / voxel);
        let far = from.abs().max(to.abs()).max_element();
        if far.is_nan() || far >= f64::from(REACH - 1) * 8.0 {
            return Err(VolumeError::TooFar {
                at: pair[0].at.as_vec3(),
                voxel,
            });
        }
        walk(from, to, |at, _, _| {
            let entry = (leaf_key(at), span);
            if list.last() != Some(&entry) {
                list.push(entry);
            }
        });
    }
    Ok(())
}

fn add_span(
    curves: &Curves<'_>,
    span: usize,
    joints: &[Joint],
    voxel: f64,
    origin: IVec3,
    moments: &mut [Moments],
) {
    let color = |t: f64| match curves.colors {
        [] => DVec3::ZERO,
        colors => colors[span].as_dvec3().lerp(colors[span + 1].as_dvec3(), t),
    };
    for pair in joints.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let [lo, hi] = [a.at.min(b.at), a.at.max(b.at)].map(|p| p / voxel - origin.as_dvec3());
        // With room for rounding: the walk itself decides.
        if hi.cmplt(DVec3::splat(-1.0)).any() || lo.cmpgt(DVec3::splat(8.0)).any() {
            continue;
        }
        let way = b.at - a.at;
        let length = way.length();
        let tangent = way.normalize_or_zero();
        walk(a.at / voxel, b.at / voxel, |at, t0, t1| {
            if at & !7 != origin || t0 == t1 {
                return;
            }
            let width = |t: f64| a.width + (b.width - a.width) * t;
            let (w0, w1) = (width(t0), width(t1));
            let part = length * (t1 - t0);
            let area = part * 0.5 * (w0 + w1);
            let sum = &mut moments[Leaf::<f32>::offset(at)];
            sum.length += part;
            sum.area += area;
            sum.volume += part * PI / 12.0 * (w0 * w0 + w0 * w1 + w1 * w1);
            sum.tangent += tangent * area;
            if !curves.colors.is_empty() {
                let middle = a.t + (b.t - a.t) * 0.5 * (t0 + t1);
                sum.color += color(middle) * area;
            }
        });
    }
}

/// The leaf of a voxel as a number whose order is that of its coordinates.
fn leaf_key(voxel: IVec3) -> u64 {
    let leaf: IVec3 = voxel >> 3;
    let [x, y, z] = leaf.to_array().map(|c| (c + REACH) as u64);
    x << 42 | y << 21 | z
}

fn leaf_origin(key: u64) -> IVec3 {
    let part = |shift: u32| ((key >> shift & 0x1f_ffff) as i32 - REACH) << 3;
    IVec3::new(part(42), part(21), part(0))
}
