//! A ray in single precision.

use super::super::shear::Shear;
use super::node::Grid;
use crate::accel::lanes::Way;
use glam::Vec3;

/// Half a step of the direction for each axis, times a normal of length 127, and some more for rounding.
const SLACK: i32 = 120;

/// A ray for boxes, and made an axis for triangles, as [`Shear`].
#[derive(Clone, Debug)]
pub(super) struct Line {
    /// Way of the ray from its start to the first plane of the grid along each axis, and from plane to plane.
    pub(super) start: [f32; 3],
    pub(super) steps: [f32; 3],
    /// Which plane of a box is met first along each axis.
    pub(super) down: [usize; 3],
    /// Direction for normals.
    pub(super) way: Way,
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
}

impl Line {
    #[inline(always)]
    pub(super) fn new(shear: &Shear, grid: &Grid, step: f64, room: f32) -> Self {
        let origin = shear.origin.as_vec3();
        let dir = shear.dir.as_vec3();
        // So that nothing is infinite, and nothing times zero undefined.
        let tiny = Vec3::splat(1e-18);
        let slope = Vec3::select(dir.abs().cmplt(tiny), tiny, dir);
        let inverse = slope.recip();
        let down = slope.is_negative_bitmask() as usize;
        let o = origin.to_array();
        let [sx, sy, _] = shear.shear;
        Self {
            start: ((grid.corner - origin) * inverse).to_array(),
            steps: (grid.step * inverse).to_array(),
            down: [down & 1, down >> 1 & 1, down >> 2 & 1],
            way: Way::new(dir.to_array(), SLACK),
            axes: shear.axes,
            from: shear.axes.map(|axis| o[axis]),
            slope: [sx as f32, sy as f32],
            step: step as f32,
            room,
        }
    }
}
