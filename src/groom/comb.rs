//! The lay of hair where somebody combed it: curves that it follows and whorls that it turns about.
//!
//! Each pulls the lay toward a direction of its own, by a weight that fades smoothly with the distance
//! and with how far the skin turns away, so that what is combed on the back leaves the belly alone. Pulls
//! and the lay of the skin are added as vectors: where they oppose each other only single points are
//! left without a direction, as between the whorls of an animal.

use crate::math::triangle;
use crate::skin::{Placing, Skin};
use crate::species::{Comb as Recipe, CombCurve, Hand, Whorl as WhorlRecipe, WhorlCenter};
use glam::{DVec3, Quat, Vec3};
use rayon::prelude::*;

/// A curve is cut into pieces of at most this share of its radius.
const PIECE: f32 = 0.25;
/// Most pieces of a curve.
const MAX_PIECES: usize = 8192;
/// Pieces that share a box.
const CHUNK: usize = 16;
/// Near a curve hair takes its direction from this share of the radius, so that bends stay.
const CLOSE: f32 = 0.1;
/// Skin whose normal makes a cosine below 0 with that under the curve is not combed, above this all.
const FACING: f32 = 0.5;

/// Everything that combs the hair of a skin.
pub(super) struct Comb {
    curves: Vec<Curve>,
    whorls: Vec<Whorl>,
    /// What has no effect, one sentence each.
    pub(super) warnings: Vec<String>,
}

struct Curve {
    radius: f32,
    strength: f32,
    pieces: Vec<Piece>,
    /// Box around each [`CHUNK`] of pieces.
    boxes: Vec<(Vec3, Vec3)>,
}

/// A straight piece of a curve.
struct Piece {
    from: Vec3,
    to: Vec3,
    /// Directions of the curve at both ends, unit.
    along: [Vec3; 2],
    /// Of the skin below, unit.
    normal: Vec3,
}

struct Whorl {
    center: Vec3,
    normal: Vec3,
    radius: f32,
    strength: f32,
    /// Angles to the way out at the center and at the rim, radians, counter-clockwise.
    angles: [f32; 2],
}

/// Directions and how much they count.
#[derive(Default)]
struct Pull {
    direction: Vec3,
    weights: f32,
    /// Share of the lay that is left to the skin.
    left: f32,
}

impl Comb {
    /// `None` if nothing combs.
    pub(super) fn new(recipe: &Recipe, skin: &Skin) -> Option<Self> {
        if recipe.is_empty() {
            return None;
        }
        let ground = Ground { skin };
        let mut comb = Self {
            curves: Vec::new(),
            whorls: Vec::new(),
            warnings: Vec::new(),
        };
        for (index, curve) in recipe.curves.iter().enumerate() {
            comb.add_curve(index, curve, &ground);
        }
        for (index, whorl) in recipe.whorls.iter().enumerate() {
            comb.add_whorl(index, whorl, &ground);
        }
        Some(comb)
    }

    fn add_curve(&mut self, index: usize, recipe: &CombCurve, ground: &Ground<'_>) {
        let radius = recipe.radius_mm as f32 * 1e-3;
        let mut nearest = f32::INFINITY;
        for line in &recipe.lines {
            let place = |p: &[f32; 3]| ground.placed(*p, recipe.is_placed);
            let knots: Vec<Vec3> = line.iter().map(place).collect();
            let curve = Curve::new(&knots, radius, recipe.strength as f32, ground);
            nearest = nearest.min(curve.1);
            self.curves.push(curve.0);
        }
        self.miss(&format!("combing curve {index}"), nearest, radius);
    }

    fn add_whorl(&mut self, index: usize, recipe: &WhorlRecipe, ground: &Ground<'_>) {
        let radius = recipe.radius_mm as f32 * 1e-3;
        let centers = match recipe.center {
            WhorlCenter::Point(point) => vec![ground.placed(point, false)],
            WhorlCenter::Landmark(landmark) => {
                let known = ground.skin.landmarks.iter();
                let places: Vec<Vec3> = known
                    .filter(|(name, _)| *name == landmark)
                    .flat_map(|(_, places)| places.clone())
                    .collect();
                if places.is_empty() {
                    self.warnings.push(format!(
                        "whorl {index} has no effect: skin `{}` has no place named {}",
                        ground.skin.name,
                        landmark.name()
                    ));
                    return;
                }
                places
            }
        };
        let sense = match recipe.hand {
            Hand::CounterClockwise => 1.0,
            Hand::Clockwise => -1.0,
        };
        let mut nearest = f32::INFINITY;
        for center in centers {
            let (below, normal) = ground.below(center);
            nearest = nearest.min(below.distance(center));
            self.whorls.push(Whorl {
                center: below,
                normal,
                radius,
                strength: recipe.strength as f32,
                angles: [recipe.spiral_deg, recipe.rim_deg]
                    .map(|angle| sense * angle.to_radians() as f32),
            });
        }
        if matches!(recipe.center, WhorlCenter::Point(_)) {
            self.miss(&format!("the center of whorl {index}"), nearest, radius);
        }
    }

    /// Says that something is too far from the skin to comb it.
    fn miss(&mut self, what: &str, nearest: f32, radius: f32) {
        if nearest > radius {
            self.warnings.push(format!(
                "{what} is {:.1} mm from the skin, farther than its radius of {:.1} mm: are its coordinates \
                 those of the skin's file?",
                1e3 * nearest,
                1e3 * radius
            ));
        }
    }

    /// The lay at a place: a unit tangent.
    ///
    /// * `normal`: of the skin there, unit; `lay`: of the skin by itself, unit and tangent.
    /// * `share`: factor on all strengths, 0..1.
    pub(super) fn lay(&self, place: Vec3, normal: Vec3, lay: Vec3, share: f32) -> Vec3 {
        let mut pull = Pull {
            left: 1.0,
            ..Pull::default()
        };
        for curve in &self.curves {
            curve.pull(place, normal, share, &mut pull);
        }
        for whorl in &self.whorls {
            whorl.pull(place, normal, share, &mut pull);
        }
        if pull.weights == 0.0 {
            return lay;
        }
        let combed = (1.0 - pull.left) / pull.weights * pull.direction;
        tangent(pull.left * lay + combed, normal).unwrap_or(lay)
    }
}

impl Pull {
    fn add(&mut self, direction: Vec3, weight: f32) {
        self.direction += weight * direction;
        self.weights += weight;
        self.left *= 1.0 - weight;
    }
}

impl Curve {
    /// The curve, and how near it comes to the skin.
    fn new(knots: &[Vec3], radius: f32, strength: f32, ground: &Ground<'_>) -> (Self, f32) {
        let below: Vec<(Vec3, Vec3)> = knots.par_iter().map(|&knot| ground.below(knot)).collect();
        let nearest = (knots.iter().zip(&below))
            .map(|(knot, (point, _))| knot.distance(*point))
            .fold(f32::INFINITY, f32::min);
        // What was drawn above the fur or a little below the skin is meant on it.
        let on_skin: Vec<Vec3> = (knots.iter().zip(&below))
            .map(
                |(&knot, &(point, _))| match knot.distance(point) <= radius {
                    true => point,
                    false => knot,
                },
            )
            .collect();
        let last = knots.len() - 1;
        let along: Vec<Vec3> = (0..knots.len())
            .map(|i| on_skin[(i + 1).min(last)] - on_skin[i.saturating_sub(1)])
            .map(Vec3::normalize_or_zero)
            .collect();
        let length: f32 = on_skin.windows(2).map(|p| p[0].distance(p[1])).sum();
        let step = (PIECE * radius).max(length / MAX_PIECES as f32);
        let mut pieces = Vec::new();
        for i in 0..last {
            let count = (on_skin[i].distance(on_skin[i + 1]) / step).ceil().max(1.0) as usize;
            let at = |k: usize| k as f32 / count as f32;
            let blend = |t: f32, a: Vec3, b: Vec3| a.lerp(b, t).normalize_or_zero();
            pieces.extend((0..count).map(|k| Piece {
                from: on_skin[i].lerp(on_skin[i + 1], at(k)),
                to: on_skin[i].lerp(on_skin[i + 1], at(k + 1)),
                along: [at(k), at(k + 1)].map(|t| blend(t, along[i], along[i + 1])),
                normal: blend(at(k) + 0.5 / count as f32, below[i].1, below[i + 1].1),
            }));
        }
        pieces.retain(|piece| piece.from != piece.to);
        let bounds = |pieces: &[Piece]| {
            pieces
                .iter()
                .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), piece| {
                    (
                        lo.min(piece.from.min(piece.to)),
                        hi.max(piece.from.max(piece.to)),
                    )
                })
        };
        let curve = Self {
            radius,
            strength,
            boxes: pieces.chunks(CHUNK).map(bounds).collect(),
            pieces,
        };
        (curve, nearest)
    }

    fn pull(&self, place: Vec3, normal: Vec3, share: f32, pull: &mut Pull) {
        let (mut direction, mut sum, mut facing) = (Vec3::ZERO, 0.0, 0.0);
        let mut nearest = self.radius * self.radius;
        for (chunk, (lo, hi)) in self.pieces.chunks(CHUNK).zip(&self.boxes) {
            if (place.clamp(*lo, *hi)).distance_squared(place) >= self.radius * self.radius {
                continue;
            }
            for piece in chunk {
                let way = piece.to - piece.from;
                let t = ((place - piece.from).dot(way) / way.length_squared()).clamp(0.0, 1.0);
                let distance = place.distance_squared(piece.from + t * way);
                let fade = fade(distance / (self.radius * self.radius));
                if fade == 0.0 {
                    continue;
                }
                nearest = nearest.min(distance);
                let close = CLOSE * self.radius;
                let weight = fade * way.length() / (distance + close * close);
                let faces = smooth(piece.normal.dot(normal) / FACING);
                let along = piece.along[0].lerp(piece.along[1], t);
                direction += weight * faces * along;
                facing += weight * faces;
                sum += weight;
            }
        }
        if sum == 0.0 {
            return;
        }
        if let Some(direction) = tangent(direction, normal) {
            let fade = fade(nearest / (self.radius * self.radius));
            pull.add(direction, share * self.strength * fade * facing / sum);
        }
    }
}

impl Whorl {
    fn pull(&self, place: Vec3, normal: Vec3, share: f32, pull: &mut Pull) {
        let far = place.distance_squared(self.center) / (self.radius * self.radius);
        let weight = share * self.strength * fade(far) * smooth(self.normal.dot(normal) / FACING);
        if weight == 0.0 {
            return;
        }
        if let Some(out) = tangent(place - self.center, normal) {
            let angle = self.angles[0] + (self.angles[1] - self.angles[0]) * far.sqrt();
            pull.add(Quat::from_axis_angle(normal, angle) * out, weight);
        }
    }
}

/// 1 at the center to 0 at the radius, smooth at both, of the squared distance over that of the radius.
fn fade(squared: f32) -> f32 {
    let left = (1.0 - squared).max(0.0);
    left * left
}

/// 0 to 1 where `t` goes from 0 to 1.
fn smooth(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The part of a direction along the skin, unit; `None` where nothing is left.
fn tangent(direction: Vec3, normal: Vec3) -> Option<Vec3> {
    (direction - normal * direction.dot(normal)).try_normalize()
}

/// The skin, where places on it are looked for.
struct Ground<'a> {
    skin: &'a Skin,
}

impl Ground<'_> {
    /// A place of the recipe in space.
    fn placed(&self, point: [f32; 3], is_placed: bool) -> Vec3 {
        let placing = match is_placed {
            true => Placing::default(),
            false => self.skin.placing,
        };
        placing.place(point.into())
    }

    /// The nearest point of the skin, and its normal there.
    fn below(&self, place: Vec3) -> (Vec3, Vec3) {
        let place = place.as_dvec3();
        let mut best = (f64::INFINITY, DVec3::ZERO, 0, DVec3::X);
        for index in 0..self.skin.triangles.len() {
            let corners = self.skin.corners(index).map(|p| p.as_dvec3());
            let weights = triangle::nearest(&corners, place);
            let point = triangle::blend(&corners, weights);
            let distance = point.distance_squared(place);
            if distance < best.0 {
                best = (distance, point, index, weights);
            }
        }
        let normals = self.skin.triangles[best.2].map(|v| self.skin.normals[v as usize]);
        let normal = triangle::blend(&normals.map(|n| n.as_dvec3()), best.3);
        (best.1.as_vec3(), normal.as_vec3().normalize_or(Vec3::Y))
    }
}
