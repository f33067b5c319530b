//! The shape of one hair.

use super::clump::Tufts;
use super::comb::Comb;
use super::field::Field;
use super::follicle::Root;
use super::here::{Here, Profile, size};
use super::vary::{Variation, Varied};
use super::waves::{Crimp, Curl, Frizz, POINTS_PER_WAVE};
use crate::sampling::{Rng, hash64};
use crate::skin::Skin;
use crate::species::{ClassGroom, VaryWhat};
use glam::{Quat, Vec3};
use noise::{NoiseFn, OpenSimplex};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Position of the class in a strand's id.
pub(super) const CLASS_SHIFT: u32 = 28;

/// Control points of a strand: enough for a smooth bend of short fur, for long hair more.
const POINTS: usize = 8;
const POINTS_LONG: usize = 12;
/// From this length hair is long, millimeters.
const LONG_MM: f64 = 100.0;

/// How closely the lay keeps to the shape of the skin under it: 0 lets fur stand off every bulge,
/// 1 glues it on.
const FOLLOW: f32 = 0.7;
/// Height over length below which hair is lifted: clumping and neighbors push it no deeper.
const LEAST_HEIGHT: f32 = 0.04;
/// Lowest angle between skin and hair, radians: lower and strands dive into curved skin.
const LOWEST: f32 = 0.07;
/// How far the lay of fur turns downhill from root to tip; more reads as wet, none as brushed.
const SAG: f32 = 0.25;
/// Distance over which hanging hair gives up its direction, meters: thin hair hangs after 1-2 cm.
const HANG: f32 = 0.012;
/// Wavelength (meters) and strength (radians, and share of length) of the slow variation of a coat.
const DRIFT_SCALE: f64 = 0.03;
const DRIFT_TURN: f32 = 0.16;
const DRIFT_LENGTH: f32 = 0.08;
/// Clumps gather into locks of this many times their size, pulled together by this share of the
/// clump's pull: the tufts that a coat shows from afar.
const LOCK: f32 = 7.0;
const LOCK_PULL: f32 = 0.7;
/// The farthest that a hair is pulled, of its length. More stretches hair that is short for its clump.
const FARTHEST: f32 = 0.5;
/// How far the hairs of a tuft lean together, radians, and differ in length from the next tuft.
const TUFT_LEAN: f32 = 0.14;
const TUFT_LENGTH: f32 = 0.07;
/// How the pull of a clump grows from root to tip: 0 evenly, 1 mostly near the root.
const CLUMP_RATE: f32 = 0.4;
/// Hair of a length factor f is finer by f to this power.
const FINER: f32 = 0.2;
/// Of its emergence, bend and straying wet hair has this share left at full wetness.
const WET_LIFT: f32 = 0.35;
/// Hair pressed to the ground stays this far above it, meters.
const GROUND_GAP: f32 = 4e-4;

/// Control points of each strand of a class.
pub(super) fn points_of(class: &ClassGroom) -> usize {
    // A turn of a curl needs its points.
    if class.length_mm > LONG_MM || class.curl_mm > 0.0 {
        POINTS_LONG
    } else {
        POINTS
    }
}

/// What is to be said of curls that turn too often for the points of a strand.
pub(super) fn stretched(class: &ClassGroom, name: &str) -> Option<String> {
    let points = points_of(class);
    let least = f64::from(POINTS_PER_WAVE) * class.length_mm / (points - 1) as f64;
    let asked = class.curl_pitch_mm;
    (class.curl_mm > 0.0 && asked < least).then(|| {
        format!(
            "curls of `{name}` turn once in {least:.1} mm and not in {asked} mm as asked: a strand has {points} \
             points, three a turn"
        )
    })
}

/// Grows strands of one class.
pub(super) struct Grower<'a> {
    class: &'a ClassGroom,
    gravity: f32,
    floor: f32,
    field: Option<&'a Field>,
    comb: Option<&'a Comb>,
    seed: u64,
    drift: OpenSimplex,
    clumps: Tufts,
    locks: Tufts,
    /// Position along the hair of each control point, 0 root .. 1 tip.
    zetas: Vec<f32>,
    /// Where nothing varies it.
    profile: Profile,
    /// Its diameter at each control point, meters.
    diameters: Vec<f32>,
    /// Meters.
    widest: f32,
}

/// What is random about one strand.
pub(super) struct Luck {
    length: f32,
    width: f32,
    turn: f32,
    lift: f32,
    /// Of the crimp.
    pub(super) phase: f32,
    /// Of the plane of the crimp.
    pub(super) roll: f32,
    /// Of the section.
    side: f32,
    /// Phases of the frizz.
    pub(super) frizz: [f32; 2],
}

impl<'a> Grower<'a> {
    /// * `field`: the space above the skin, `None` for hair that hangs free of it.
    /// * `comb`: what the lay follows beside the skin.
    pub(super) fn new(
        class: &'a ClassGroom,
        variation: &Variation<'_>,
        skin: &Skin,
        field: Option<&'a Field>,
        comb: Option<&'a Comb>,
        seed: u64,
        width_scale: f64,
    ) -> Self {
        let points = points_of(class);
        // Hanging hair turns within its first centimeters: its points crowd there.
        let crowding = 1.0 + skin.gravity.clamp(0.0, 1.0);
        let zetas: Vec<f32> = (0..points)
            .map(|k| (k as f32 / (points - 1) as f32).powf(crowding))
            .collect();
        let widest = class.diameter_um * 1e-6 * width_scale;
        let profile = Profile::new(class, &Varied::NONE);
        let diameters = (zetas.iter())
            .map(|&zeta| (widest * profile.at(f64::from(zeta))) as f32)
            .collect();
        let sizes = variation.ends().map(|end| size(class, &end));
        Self {
            class,
            gravity: skin.gravity.clamp(0.0, 1.0),
            floor: skin.floor.unwrap_or(f32::NEG_INFINITY),
            field,
            comb,
            seed,
            drift: OpenSimplex::new(hash64(seed ^ 0x6472_6966) as u32),
            clumps: Tufts::new(sizes, hash64(seed ^ 0x636c_756d)),
            locks: Tufts::new(sizes.map(|size| LOCK * size), hash64(seed ^ 0x6c6f_636b)),
            zetas,
            profile,
            diameters,
            widest: widest as f32,
        }
    }

    /// Control points of each strand.
    pub(super) fn points(&self) -> usize {
        self.zetas.len()
    }

    fn luck(&self, id: u32, here: &Here) -> Luck {
        let mut rng = Rng::new(hash64(self.seed ^ 0x6861_6972), u64::from(id));
        // Mean 1: the log-normal's median is below its mean.
        let log_normal = |sigma: f64, normal: f64| {
            (sigma * normal.clamp(-3.0, 3.0) - 0.5 * sigma * sigma).exp() as f32
        };
        let (a, b) = rng.normal_pair();
        let (c, d) = rng.normal_pair();
        let stray = here.stray * f64::from(dry(here));
        Luck {
            length: log_normal(here.sigmas[0], a),
            width: log_normal(here.sigmas[1], b),
            turn: (stray * c) as f32,
            lift: (0.5 * stray * d) as f32,
            phase: rng.uniform_f32() * TAU,
            roll: rng.uniform_f32() * TAU,
            side: (here.roll * rng.normal_pair().0) as f32,
            frizz: [rng.uniform_f32() * TAU, rng.uniform_f32() * TAU],
        }
    }

    /// Writes the control points and widths of strand `id` at `root`; returns the direction that its
    /// flat side faces there.
    pub(super) fn grow(
        &self,
        id: u32,
        root: &Root,
        points: &mut [Vec3],
        widths: &mut [f32],
    ) -> Vec3 {
        let here = Here::new(self.class, &root.vary);
        let luck = self.luck(id, &here);
        let tuft_luck = hash64(self.seed ^ hash64(u64::from(id) ^ 0x7475_6674));
        let clump = self.clumps.at(root.position, here.size, tuft_luck);
        let lock = self.locks.at(root.position, LOCK * here.size, tuft_luck);
        let drift = |offset: f64| {
            let p = root.position.as_dvec3() / DRIFT_SCALE + offset;
            self.drift.get(p.to_array()) as f32
        };
        let length = here.length
            * root.length
            * root.vary[VaryWhat::Length]
            * luck.length
            * (1.0 + DRIFT_LENGTH * drift(0.0))
            * (1.0 + TUFT_LENGTH * lock.random[0]);
        let whole = length;
        let length = length.min(here.trim);
        let shared_turn =
            root.vary[VaryWhat::Turn] + DRIFT_TURN * drift(40.0) + TUFT_LEAN * lock.random[1];
        let shared_lift = 0.5 * TUFT_LEAN * lock.random[2];

        // Two curves: the hair by itself, and what it would be without straying from its tuft.
        let emergence = here.emergence * dry(&here) + shared_lift;
        let lean = |turn: f32, lift: f32| Lean {
            turn,
            combing: Quat::from_axis_angle(root.normal, turn) * root.combing,
            emergence: (emergence + lift).clamp(LOWEST, FRAC_PI_2),
        };
        let own = lean(shared_turn + luck.turn, luck.lift);
        let tuft = lean(shared_turn, 0.0);
        let tangential = |v: Vec3| v - root.normal * v.dot(root.normal);
        let to_clump = tangential(clump.center - root.position);
        let to_lock = tangential(lock.center - root.position);
        // A shorter hair has less way to its neighbors.
        let share = here.clump * root.length.min(1.0);
        let share = share + 0.9 * here.wet * (1.0 - share);
        let pull = (share * (1.0 + 0.4 * clump.random[3])).clamp(0.0, 1.0);
        // Wet hair sticks to its neighbors, not to a whole lock.
        let share = share * (1.0 - here.wet);
        let lock_pull = (LOCK_PULL * share * (1.0 + 0.4 * lock.random[3])).clamp(0.0, 1.0);

        let way = pull * to_clump.length() + lock_pull * to_lock.length();
        let ease = (FARTHEST * whole / way.max(f32::MIN_POSITIVE)).min(1.0);
        let (pull, lock_pull) = (ease * pull, ease * lock_pull);

        let (mut hair, mut center) = (root.position, root.position);
        let step = length / (self.points() - 1) as f32;
        let crimp = Crimp::new(&here, length, step, &luck);
        let curl = Curl::new(&here, step, clump.random[2]);
        let frizz = Frizz::new(&here, root, &luck);
        points[0] = root.position;
        // What is left of a cut hair has the shape and the profile that it had there.
        let left = if whole > length { length / whole } else { 1.0 };
        for k in 0..self.points() - 1 {
            let [from, zeta] = [self.zetas[k], self.zetas[k + 1]].map(|zeta| left * zeta);
            hair = self.step(hair, root, &here, &own, [from, zeta], whole);
            center = self.step(center, root, &here, &tuft, [from, zeta], whole);
            let weight = clump_weight(zeta);
            let toward = pull * weight * (center + to_clump - hair) + lock_pull * weight * to_lock;
            let point = hair
                + toward
                + crimp.offset(&own, root, zeta * whole)
                + curl.offset(&tuft, root, zeta * whole)
                + frizz.offset(zeta);
            points[k + 1] = self.lift(point, root, zeta * whole);
        }
        // Finer where it is shorter, as on faces and paws.
        let finer = root.length.clamp(0.05, 1.0).powf(FINER) * root.vary[VaryWhat::Width];
        for (width, diameter) in widths.iter_mut().zip(&self.diameters) {
            *width = diameter * luck.width * finer;
        }
        let profile = Profile::new(self.class, &root.vary);
        if left < 1.0 || profile != self.profile {
            for (width, &zeta) in widths.iter_mut().zip(&self.zetas) {
                let there = profile.at(f64::from(left * zeta)) as f32;
                *width = self.widest * there * luck.width * finer;
            }
        }
        // Lying hair faces the sky with its flat side, upright hair looks back over its lay.
        let along = (points[1] - points[0]).normalize_or(root.normal);
        let across = |v: Vec3| v - along * v.dot(along);
        let up = across(root.normal);
        let up = if up.length_squared() > 1e-6 {
            up
        } else {
            across(-root.combing)
        };
        let up = up.normalize_or(along.any_orthonormal_vector());
        Quat::from_axis_angle(along, luck.side) * up
    }

    /// Goes from `from` one segment on. The hair leaves at the emergence angle and bends toward the
    /// lay, which follows the skin below and turns downhill a little; hanging hair turns straight
    /// down.
    fn step(
        &self,
        from: Vec3,
        root: &Root,
        here: &Here,
        lean: &Lean,
        zetas: [f32; 2],
        length: f32,
    ) -> Vec3 {
        let middle = 0.5 * (zetas[0] + zetas[1]);
        let bend = here.bend * dry(here);
        let angle = (lean.emergence - bend * middle).max(LOWEST);
        let (mut normal, mut combing) = (root.normal, lean.combing);
        let field = self.field.filter(|field| length > 2.0 * field.cell());
        if let Some(above) = field.and_then(|field| field.above(from))
            // Opposite limbs are no guide.
            && above.normal.dot(root.normal) > 0.2
        {
            normal = normal.lerp(above.normal, FOLLOW).normalize_or(normal);
            combing = carried(combing, root.normal, normal);
        }
        if let Some(comb) = self.comb {
            // Hair follows a curve or whorl along its whole length.
            let lay = Quat::from_rotation_arc(root.normal, normal) * root.lay;
            let lay = comb.lay(from, normal, lay, root.vary[VaryWhat::Comb]);
            combing = Quat::from_axis_angle(normal, lean.turn) * lay;
        }
        let downhill = normal * normal.y - Vec3::Y;
        let lay = (combing + here.gravity * SAG * middle * downhill).normalize_or(combing);
        let (sin, cos) = angle.sin_cos();
        let mut direction = lay * cos + normal * sin;
        if self.gravity > 0.0 {
            let hang = (here.gravity * self.gravity).min(1.0)
                * (1.0 - (-(middle * length / HANG).powi(2)).exp());
            direction = direction.lerp(Vec3::NEG_Y, hang).normalize_or(direction);
        }
        from + direction * (length * (zetas[1] - zetas[0]))
    }

    /// A control point, lifted if it is below the skin or the ground.
    fn lift(&self, mut point: Vec3, root: &Root, along: f32) -> Vec3 {
        if self.gravity == 0.0 {
            let least = LEAST_HEIGHT * along;
            // Near the root the skin is its tangent plane; the grid is coarser than that.
            let field = self.field.filter(|field| along > 1.5 * field.cell());
            let below = field.and_then(|field| field.above(point));
            let (normal, height) = match below {
                Some(above) => (above.normal, above.height),
                None => (root.normal, (point - root.position).dot(root.normal)),
            };
            point += normal * (least - height).clamp(0.0, 0.5 * along);
        }
        point.y = point.y.max(self.floor + GROUND_GAP);
        point
    }
}

/// How a hair leans at its root.
pub(super) struct Lean {
    /// From the lay, about the normal, radians.
    turn: f32,
    pub(super) combing: Vec3,
    emergence: f32,
}

/// Factor on how far hair stands off when wet.
fn dry(here: &Here) -> f32 {
    1.0 - (1.0 - WET_LIFT) * here.wet
}

/// A tangent turned with its normal, the shortest way.
///
/// * `from`, `to`: unit, not opposite. * `tangent`: across `from`.
fn carried(tangent: Vec3, from: Vec3, to: Vec3) -> Vec3 {
    tangent - (from + to) * (tangent.dot(to) / (1.0 + from.dot(to)))
}

/// Share of the clump's pull at `zeta`, 0 at the root and 1 at the tip.
fn clump_weight(zeta: f32) -> f32 {
    let inverse = 1.0 - zeta;
    zeta * (1.0 - CLUMP_RATE) + CLUMP_RATE * (1.0 - inverse * inverse)
}
