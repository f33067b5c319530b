//! A ray in single precision.

use super::super::shear::Shear;
use glam::{Vec3, Vec4};

/// A ray for boxes, and made an axis for triangles, as [`Shear`].
#[derive(Clone, Debug)]
pub(super) struct Line {
    pub(super) origin: Vec4,
    pub(super) inverse: Vec4,
    /// Which plane of a box is met first along each axis.
    pub(super) down: [usize; 3],
    /// Axes across the ray and the one along it.
    pub(super) axes: [usize; 3],
    /// Origin along these.
    pub(super) from: [f32; 3],
    /// How far the ray goes across for each radius along the third axis.
    pub(super) slope: [f32; 2],
    /// Length of a step of corners, in radii.
    pub(super) step: f32,
    /// Room for rounding, in radii.
    pub(super) room: f32,
    /// Direction in parts of [`UNIT`], and the room for the rounding of its product with a normal.
    pub(super) steps: [i16; 3],
    pub(super) slack: i16,
}

/// Length of a direction: so small that three products with bytes have room in 16 bits.
const UNIT: f32 = 63.0;
/// Half a step for each axis, times a normal of length 127, and some more for normals of slender triangles.
const SLACK: i16 = 120;

impl Line {
    #[inline(always)]
    pub(super) fn new(shear: &Shear, step: f64, room: f32) -> Self {
        let origin = shear.origin.as_vec3();
        let dir = shear.dir.as_vec3();
        // So that nothing is infinite, and nothing times zero undefined.
        let tiny = Vec3::splat(1e-18);
        let dir = Vec3::select(dir.abs().cmplt(tiny), tiny, dir);
        let down = dir.is_negative_bitmask() as usize;
        let o: [f32; 3] = origin.to_array();
        let [sx, sy, _] = shear.shear;
        Self {
            origin: origin.extend(0.0),
            inverse: dir.extend(1.0).recip(),
            down: [down & 1, down >> 1 & 1, down >> 2 & 1],
            axes: shear.axes,
            from: shear.axes.map(|axis| o[axis]),
            slope: [sx as f32, sy as f32],
            step: step as f32,
            room,
            steps: (UNIT * shear.dir.as_vec3())
                .to_array()
                .map(|d| d.round_ties_even() as i16),
            slack: SLACK,
        }
    }
}
