//! The nearest triangle of a kind along a ray.

use super::layers::counted_in;
use super::shear::{Meeting, Shear};
use super::solid::Bound;
use super::tree::{Candidate, Kind};
use super::way::{Stretch, Way};
use super::{Found, Triangles};
use crate::fiber::trace::Ray;
use glam::DVec3;

/// What a ray is to meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quest {
    pub(super) kind: Kind,
    /// The triangle that it starts on.
    pub(super) from: Option<u32>,
    /// In the one layer of these: where it comes into another, all are to be counted.
    pub(super) layer: Option<Bound>,
}

/// What of one tile is nearest.
#[derive(Clone, Debug)]
pub(super) struct Nearest<'a> {
    kind: Kind,
    from: Option<u32>,
    /// In radii, itself included.
    pub(super) limit: f64,
    /// Distance, triangle, and whether that is entered.
    pub(super) best: Option<(f64, Candidate<'a>, bool)>,
}

impl Quest {
    /// What a ray leaves a region through. `None` where layers have to be counted from the first.
    ///
    /// * `is_layered`: whether surfaces of voids, or of a medium, overlap or hold each other.
    #[inline(always)]
    pub(super) fn new(is_layered: bool, ray: &Ray) -> Option<Self> {
        let (from, on) = ray.triangle().unzip();
        let Some((bound, part)) = counted_in(ray.region).filter(|_| is_layered) else {
            return Some(Self {
                kind: Kind::around(ray.region),
                from,
                layer: None,
            });
        };
        // The boundary of a union has one layer on its inner side.
        (on == Some(part)).then(|| Self {
            kind: Kind::layers(bound),
            from,
            layer: Some(bound),
        })
    }

    /// Whether what is nearest is what the ray leaves the region through.
    pub(super) fn is_met_by(&self, found: &Found<'_>) -> bool {
        !(found.enters && self.layer == Some(found.triangle.label().bound))
    }
}

impl<'a> Nearest<'a> {
    #[inline(always)]
    pub(super) fn new(quest: &Quest, stretch: &Stretch) -> Self {
        Self {
            kind: quest.kind,
            from: quest.from.filter(|_| stretch.is_first),
            // Layers are counted tile by tile, each triangle in one of them.
            limit: match quest.layer {
                Some(_) => stretch.length().next_down(),
                None => stretch.beyond,
            },
            best: None,
        }
    }

    /// The new limit if a triangle is the nearest yet. The tree sees single precision; what is nearest is decided here.
    #[inline(always)]
    pub(super) fn test(&mut self, ray: &Shear, triangle: Candidate<'a>) -> Option<f64> {
        let Meeting { t, enters } = ray.meet(&triangle.corners())?;
        if !(t >= 0.0 && t <= self.limit && triangle.is_of(self.kind, enters)) {
            return None;
        }
        // Labels come last: they are read where something is met.
        let source = triangle.label().source;
        let is_nearer = (self.best)
            .is_none_or(|(b, other, _)| t < b || (t == b && source < other.label().source));
        if !is_nearer || self.from == Some(source) {
            return None;
        }
        self.best = Some((t, triangle, enters));
        Some(t)
    }

    pub(super) fn found(&self, stretch: &Stretch) -> Option<Found<'a>> {
        let (t, triangle, enters) = self.best?;
        Some(Found {
            t: stretch.before + t,
            triangle,
            enters,
            image: stretch.image,
        })
    }
}

impl Triangles {
    /// The first triangle of a kind that a ray meets.
    ///
    /// * `origin`: in radii.
    pub(super) fn first(&self, origin: DVec3, dir: DVec3, quest: &Quest) -> Option<Found<'_>> {
        Way::new(self.screw, origin, dir)?.find_map(|stretch| {
            let mut nearest = Nearest::new(quest, &stretch);
            (self.tree).visit(&stretch.ray, nearest.limit, quest.kind, |triangle| {
                nearest.test(&stretch.ray, triangle)
            });
            nearest.found(&stretch)
        })
    }
}
