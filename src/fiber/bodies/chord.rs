//! Where a ray is in one body.

use super::{Bodies, Body, QUADRIC};
use glam::DVec3;

/// Where a ray is in a body, and through which faces it comes and goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    pub(super) enter: f64,
    pub(super) leave: f64,
    pub(super) enter_face: u32,
    pub(super) leave_face: u32,
}

/// How the planes of a body cut a chord.
pub(super) trait Slabs: Copy {
    /// Cuts what is beyond a body's planes off the chord; `None` if a ray along one is all beyond it.
    ///
    /// * `ray`: place and direction seen from the body's center.
    /// * `on`: the face that it starts on.
    fn cut(
        self,
        bodies: &Bodies,
        body: &Body,
        ray: (DVec3, DVec3),
        on: Option<u32>,
        chord: &mut Chord,
    ) -> Option<()>;
}

/// One plane after another, on any processor.
#[derive(Clone, Copy)]
pub(super) struct OneByOne;

impl Slabs for OneByOne {
    #[inline(always)]
    fn cut(
        self,
        bodies: &Bodies,
        body: &Body,
        (o, dir): (DVec3, DVec3),
        on: Option<u32>,
        chord: &mut Chord,
    ) -> Option<()> {
        for (plane, face) in bodies.planes_of(body).iter().zip(body.planes.clone()) {
            let rate = plane.normal.dot(dir);
            let gap = if on == Some(face) {
                0.0
            } else {
                plane.offset - plane.normal.dot(o)
            };
            if rate > 0.0 {
                chord.cut(f64::NEG_INFINITY, gap / rate, face);
            } else if rate < 0.0 {
                chord.cut(gap / rate, f64::INFINITY, face);
            } else if gap < 0.0 {
                return None;
            }
        }
        Some(())
    }
}

impl Bodies {
    /// Where a ray is in the image of a body nearest to `z`.
    ///
    /// * `on`: the face that the ray starts on; its root there is known to be 0.
    #[inline(always)]
    pub(super) fn chord(
        &self,
        slabs: impl Slabs,
        index: u32,
        origin: DVec3,
        dir: DVec3,
        z: f64,
        on: Option<u32>,
    ) -> Option<Chord> {
        let body = &self.bodies[index as usize];
        let o = origin - self.center_near(body, z);
        let along = o.dot(dir);
        if o.length_squared() - along * along > body.reach2 {
            return None;
        }
        let mut chord = Chord {
            enter: f64::NEG_INFINITY,
            leave: f64::INFINITY,
            enter_face: body.planes.start,
            leave_face: body.planes.start,
        };
        for (quadric, face) in self.quadrics_of(body).iter().zip(body.quadrics.clone()) {
            let face = face | QUADRIC;
            let (enter, leave) = quadric.inside(o, dir, on == Some(face))?;
            chord.cut(enter, leave, face);
        }
        slabs.cut(self, body, (o, dir), on, &mut chord)?;
        (chord.enter < chord.leave).then_some(chord)
    }
}

impl Chord {
    #[inline]
    pub(super) fn cut(&mut self, enter: f64, leave: f64, face: u32) {
        if enter > self.enter {
            (self.enter, self.enter_face) = (enter, face);
        }
        if leave < self.leave {
            (self.leave, self.leave_face) = (leave, face);
        }
    }
}
