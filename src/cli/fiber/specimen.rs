//! A fiber as a specimen under the microscope: parts of it cut away, lit from the side.

use crate::fiber::{Fiber, HitState, Region};
use crate::sampling::{Rng, concentric_disk};
use glam::DVec3;

/// A half-space `normal . p > offset`.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfSpace {
    pub(super) normal: DVec3,
    pub(super) offset: f64,
}

/// A fiber of which the part common to all of `removed` is cut away; nothing if that is empty.
pub(super) struct Specimen<'a> {
    pub(super) fiber: &'a Fiber,
    pub(super) removed: Vec<HalfSpace>,
    /// Toward the lamp.
    pub(super) lamp: DVec3,
    /// Whether parts are tinted; a scanning electron microscope sees gray.
    pub(super) tinted: bool,
}

/// What a ray sees.
struct Seen {
    point: DVec3,
    /// Toward the ray's origin.
    normal: DVec3,
    what: What,
    /// The surface and region to go on from.
    region: Option<Region>,
    from: Option<HitState>,
}

#[derive(Clone, Copy, PartialEq)]
enum What {
    Face,
    Riser,
    VoidWall,
    Cut(Region),
}

/// Where a ray begins.
#[derive(Clone, Copy)]
struct Start {
    point: DVec3,
    /// `None` in the part cut away.
    region: Option<Region>,
    from: Option<HitState>,
}

/// Half-width of the lamp, radians: the shadow of a margin fades over the height of the margin.
const LAMP_SIZE: f64 = 0.22;
/// Sections crossed before a ray gives up; a straight line crosses some ten.
const MAX_STEPS: usize = 200;

impl Specimen<'_> {
    /// Linear color along a ray; `None` past the fiber.
    pub(super) fn look(&self, origin: DVec3, dir: DVec3, rng: &mut Rng) -> Option<DVec3> {
        let inside = self.is_removed(origin);
        let start = Start {
            point: origin,
            region: (!inside).then_some(Region::Outside),
            from: None,
        };
        self.first(start, dir)
            .map(|seen| self.shade(&seen, dir, rng))
    }

    fn shade(&self, seen: &Seen, dir: DVec3, rng: &mut Rng) -> DVec3 {
        let start = Start {
            point: seen.point,
            region: seen.region,
            from: seen.from,
        };
        let (u, v) = concentric_disk(rng.uniform(), rng.uniform());
        let (a, b) = self.lamp.any_orthonormal_pair();
        let lamp = (self.lamp + LAMP_SIZE * (u * a + v * b)).normalize();
        let cosine = seen.normal.dot(lamp).max(0.0);
        let lit = cosine > 0.0 && self.first(start, lamp).is_none();
        // Ambient light of a cosine law: what escapes arrives.
        let (u, v) = concentric_disk(rng.uniform(), rng.uniform());
        let (a, b) = seen.normal.any_orthonormal_pair();
        let up = (1.0 - u * u - v * v).max(0.0).sqrt();
        let sky = (u * a + v * b + up * seen.normal).normalize();
        let open = self.first(start, sky).is_none();
        let light = 0.85 * cosine * f64::from(u8::from(lit)) + 0.32 * f64::from(u8::from(open));
        let color = self.albedo(seen.what, seen.point);
        // More electrons leave a slanted surface, so that rims and risers shine (edge effect).
        let facing = -seen.normal.dot(dir);
        let edge = match seen.what {
            What::Face => 0.5 * (1.0 - facing).max(0.0).powi(3),
            What::Riser => 0.25,
            What::VoidWall | What::Cut(_) => 0.0,
        };
        color * (light + edge)
    }

    fn albedo(&self, what: What, point: DVec3) -> DVec3 {
        if !self.tinted {
            return DVec3::splat(0.62);
        }
        match what {
            What::Face | What::Riser => DVec3::new(0.60, 0.58, 0.55),
            What::VoidWall => DVec3::new(0.32, 0.36, 0.44),
            What::Cut(Region::Medulla) => DVec3::new(0.46, 0.36, 0.40),
            What::Cut(_) if self.fiber.is_in_medulla(point) => DVec3::new(0.70, 0.42, 0.22),
            What::Cut(_) => DVec3::new(0.82, 0.66, 0.45),
        }
    }

    fn is_removed(&self, p: DVec3) -> bool {
        !self.removed.is_empty() && self.removed.iter().all(|h| h.normal.dot(p) > h.offset)
    }

    /// Where the ray is in the part cut away: begin, end and the normal of the cut at the end.
    fn removed_along(&self, p: DVec3, dir: DVec3) -> Option<(f64, f64, DVec3)> {
        let (mut t0, mut t1, mut normal) = (f64::NEG_INFINITY, f64::INFINITY, DVec3::ZERO);
        for h in &self.removed {
            let (rate, gap) = (h.normal.dot(dir), h.offset - h.normal.dot(p));
            if rate == 0.0 {
                if gap >= 0.0 {
                    return None;
                }
            } else if rate > 0.0 {
                t0 = t0.max(gap / rate);
            } else if gap / rate < t1 {
                (t1, normal) = (gap / rate, h.normal);
            }
        }
        (t0 < t1 && t1 > 0.0 && !self.removed.is_empty()).then_some((t0, t1, normal))
    }

    /// First thing seen from `start`.
    fn first(&self, start: Start, dir: DVec3) -> Option<Seen> {
        let Start {
            point: mut p,
            mut region,
            mut from,
        } = start;
        for _ in 0..MAX_STEPS {
            let gap = self.removed_along(p, dir);
            let Some(now) = region else {
                // In the part cut away: straight to its end.
                let (_, t, normal) = gap?;
                if t == f64::INFINITY {
                    return None;
                }
                p += t * dir;
                let behind = self.fiber.region_at(p + 1e-7 * dir);
                if matches!(behind, Region::Cortex | Region::Medulla) {
                    return Some(Seen {
                        point: p,
                        normal,
                        what: What::Cut(behind),
                        region: None,
                        from: None,
                    });
                }
                (region, from) = (Some(behind), None);
                p += 1e-7 * dir;
                continue;
            };
            let hit = self.fiber.next_hit(p, dir, now, from);
            let enter = gap.filter(|g| g.0 > 1e-6).map_or(f64::INFINITY, |g| g.0);
            let t = hit.map_or(f64::INFINITY, |h| h.t);
            if enter < t {
                p += enter * dir;
                (region, from) = (None, None);
                continue;
            }
            let hit = hit?;
            let riser = self.fiber.is_riser(hit.state);
            return Some(Seen {
                point: p + hit.t * dir,
                normal: hit.normal,
                what: match (now, riser) {
                    (Region::Void, _) => What::VoidWall,
                    (_, true) => What::Riser,
                    (_, false) => What::Face,
                },
                region,
                from: Some(hit.state),
            });
        }
        None
    }
}
