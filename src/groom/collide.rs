//! Strands and the skin: none passes through it.
//!
//! Where a strand would, what comes behind is moved out along the triangle's normal, again and again until
//! it passes nowhere. Where that finds no end, in folds too narrow for hair, the strand ends before it
//! passes; where not even a stub has room, no hair grows.

use super::GroomError;
use super::barrier::{Barrier, Passage, bezier, split};
use crate::skin::Skin;
use glam::Vec3;

/// Room between a strand and the skin that it would have entered, meters.
const ROOM: f32 = 1.5e-5;
/// A strand that still passes after so many pushes is cut.
const PUSHES: usize = 48;
/// Factor on the length of a strand that is cut and still passes, and how often it is tried.
const SHORTER: f32 = 0.7;
const CUTS: usize = 12;
/// Length of an upright stub, in thicknesses, at most.
const STUB: f32 = 64.0;
/// Places of a piece where its depth is measured.
const DEPTHS: usize = 8;

/// What became of a strand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Contact {
    /// It never met the skin.
    Free,
    /// It lies on the skin where it would have entered.
    Bent,
    /// It ends where it would have entered.
    Cut,
    /// It has no room even for a stub as long as thick.
    Buried,
}

/// A skin that strands are held against.
pub(super) struct Collider {
    barrier: Barrier,
    floor: f32,
}

impl Collider {
    /// # Errors
    /// Triangles that no tree is built over.
    pub(super) fn new(skin: &Skin) -> Result<Self, GroomError> {
        Ok(Self {
            barrier: Barrier::new(skin)?,
            floor: skin.floor.unwrap_or(f32::NEG_INFINITY),
        })
    }

    /// Moves the control points of a strand so that it does not pass through the skin; those of a buried one
    /// are left anyhow.
    ///
    /// * `triangle`: that the root lies on.
    /// * `thickness`: of the hair by nature, meters: a thinned coat has the same curves.
    pub(super) fn settle(&self, triangle: u32, points: &mut [Vec3], thickness: f32) -> Contact {
        let Some(mut passage) = self.barrier.first(triangle, points) else {
            return Contact::Free;
        };
        let lengths: Vec<f32> = points.windows(2).map(|p| p[0].distance(p[1])).collect();
        let mut farthest = (passage, points.to_vec());
        for _ in 0..PUSHES {
            self.push(&passage, points, ROOM + 0.5 * thickness, &lengths);
            match self.barrier.first(triangle, points) {
                Some(next) => passage = next,
                None => return Contact::Bent,
            }
            if passage.along() > farthest.0.along() {
                farthest = (passage, points.to_vec());
            }
        }
        let (passage, whole) = farthest;
        match self.cut(triangle, &passage, &whole, points, thickness)
            || self.stand(triangle, points, lengths.iter().sum(), thickness)
        {
            true => Contact::Cut,
            false => Contact::Buried,
        }
    }

    /// Moves what comes behind a passage out of the skin.
    fn push(&self, passage: &Passage, points: &mut [Vec3], room: f32, lengths: &[f32]) {
        let (k, normal) = (passage.piece + 1, passage.normal);
        let missing = |p: Vec3| room - (p - passage.point).dot(normal);
        let depth = missing(points[k]);
        if depth > 0.0 {
            self.shift(&mut points[k..], depth * normal);
        } else {
            // The curve bulges through between two control points that do not.
            let curve = bezier(points, passage.piece);
            let depths = (1..DEPTHS)
                .map(|i| split(&curve, i as f64 / DEPTHS as f64).0[3])
                .map(|p| missing(p.as_vec3()));
            let from = if k > 1 { k - 1 } else { k };
            let by = 1.5 * depths.fold(room, f32::max);
            self.shift(&mut points[from..], by * normal);
        }
        // Hair is bent, not shortened.
        let way = points[k] - points[k - 1];
        if let Some(direction) = way.try_normalize() {
            let stretched = points[k - 1] + lengths[k - 1] * direction;
            let stretched = stretched + missing(stretched).max(0.0) * normal;
            let by = stretched - points[k];
            self.shift(&mut points[k..], by);
        }
    }

    /// Moves points, but none below the ground.
    fn shift(&self, points: &mut [Vec3], by: Vec3) {
        for point in points {
            *point += by;
            point.y = point.y.max(self.floor + ROOM);
        }
    }

    /// Ends a strand before it passes; false if nothing of it is left.
    fn cut(
        &self,
        triangle: u32,
        passage: &Passage,
        whole: &[Vec3],
        points: &mut [Vec3],
        thickness: f32,
    ) -> bool {
        let step = whole[passage.piece].distance(whole[passage.piece + 1]);
        let before = passage.at - 2.0 * ROOM / step.max(ROOM);
        let mut end = passage.piece as f32 + before.max(0.0);
        let last = points.len() - 1;
        for _ in 0..CUTS {
            for (k, point) in points.iter_mut().enumerate().skip(1) {
                let at = end * k as f32 / last as f32;
                let piece = (at as usize).min(last - 1);
                let curve = bezier(whole, piece);
                *point = split(&curve, f64::from(at) - piece as f64).0[3].as_vec3();
            }
            if super::arc_length(points) < thickness {
                return false;
            }
            if self.barrier.first(triangle, points).is_none() {
                return true;
            }
            end *= SHORTER;
        }
        false
    }

    /// Makes a strand an upright stub no longer than it was; false if there is no room for any above the ground.
    fn stand(&self, triangle: u32, points: &mut [Vec3], whole: f32, thickness: f32) -> bool {
        let (root, up) = (points[0], self.barrier.normal(triangle));
        let last = points.len() - 1;
        let mut length = whole.min(STUB * thickness);
        while length >= thickness {
            for (k, point) in points.iter_mut().enumerate() {
                *point = root + up * (length * k as f32 / last as f32);
            }
            let is_above = points[last].y >= self.floor;
            if is_above && self.barrier.first(triangle, points).is_none() {
                return true;
            }
            length *= 0.5;
        }
        false
    }
}
