//! The shape of one hair.

use super::clump::Clumps;
use super::follicle::Root;
use crate::sampling::{Rng, hash64};
use crate::skin::Skin;
use crate::species::ClassGroom;
use glam::{Quat, Vec3};
use noise::{NoiseFn, OpenSimplex};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Position of the class in a strand's id.
pub(super) const CLASS_SHIFT: u32 = 28;

/// Control points of a strand: enough for a smooth bend of short fur, for long hair more.
const POINTS: usize = 8;
const POINTS_LONG: usize = 12;
/// From this length hair is long, millimeters.
const LONG_MM: f64 = 120.0;

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
/// How far the hairs of a tuft lean together, radians, and differ in length from the next tuft.
const TUFT_LEAN: f32 = 0.14;
const TUFT_LENGTH: f32 = 0.07;
/// How the pull of a clump grows from root to tip: 0 evenly, 1 mostly near the root.
const CLUMP_RATE: f32 = 0.4;
/// Control points that carry one wave of crimp. Fewer and it vanishes between the points.
const POINTS_PER_WAVE: f32 = 3.0;
/// Largest crimp amplitude relative to length.
const CRIMP_LIMIT: f32 = 0.06;
/// Exponent of the tip's taper, and the width left at the very tip.
const TAPER: f64 = 1.5;
const TIP: f64 = 0.08;

/// Grows strands of one class.
pub(super) struct Grower<'a> {
    class: &'a ClassGroom,
    gravity: f32,
    seed: u64,
    drift: OpenSimplex,
    clumps: Clumps,
    /// Position along the hair of each control point, 0 root .. 1 tip.
    zetas: Vec<f32>,
    profile: Vec<f32>,
}

/// What is random about one strand.
struct Luck {
    length: f32,
    width: f32,
    turn: f32,
    lift: f32,
    phase: f32,
    roll: f32,
}

impl<'a> Grower<'a> {
    pub(super) fn new(class: &'a ClassGroom, skin: &Skin, seed: u64, width_scale: f64) -> Self {
        let points = if class.length_mm > LONG_MM {
            POINTS_LONG
        } else {
            POINTS
        };
        // Hanging hair turns within its first centimeters: its points crowd there.
        let crowding = 1.0 + skin.gravity.clamp(0.0, 1.0);
        let zetas: Vec<f32> = (0..points)
            .map(|k| (k as f32 / (points - 1) as f32).powf(crowding))
            .collect();
        let widest = class.diameter_um * 1e-6 * width_scale;
        let profile = (zetas.iter())
            .map(|&zeta| (widest * profile(class, f64::from(zeta))) as f32)
            .collect();
        Self {
            class,
            gravity: skin.gravity.clamp(0.0, 1.0),
            seed,
            drift: OpenSimplex::new(hash64(seed ^ 0x6472_6966) as u32),
            clumps: Clumps {
                size: (class.clump_mm * 1e-3).max(1e-4) as f32,
                seed: hash64(seed ^ 0x636c_756d),
            },
            zetas,
            profile,
        }
    }

    /// Control points of each strand.
    pub(super) fn points(&self) -> usize {
        self.zetas.len()
    }

    fn luck(&self, id: u32) -> Luck {
        let mut rng = Rng::new(hash64(self.seed ^ 0x6861_6972), u64::from(id));
        let class = self.class;
        // Mean 1: the log-normal's median is below its mean.
        let log_normal = |sigma: f64, normal: f64| {
            (sigma * normal.clamp(-3.0, 3.0) - 0.5 * sigma * sigma).exp() as f32
        };
        let (a, b) = rng.normal_pair();
        let (c, d) = rng.normal_pair();
        let stray = class.stray_deg.to_radians();
        Luck {
            length: log_normal(class.length_sigma, a),
            width: log_normal(class.diameter_sigma, b),
            turn: (stray * c) as f32,
            lift: (0.5 * stray * d) as f32,
            phase: rng.uniform_f32() * TAU,
            roll: rng.uniform_f32() * TAU,
        }
    }

    /// Writes the control points and widths of strand `id` at `root`.
    pub(super) fn grow(&self, id: u32, root: &Root, points: &mut [Vec3], widths: &mut [f32]) {
        let class = self.class;
        let luck = self.luck(id);
        let clump = self.clumps.at(root.position);
        let drift = |offset: f64| {
            let p = root.position.as_dvec3() / DRIFT_SCALE + offset;
            self.drift.get(p.to_array()) as f32
        };
        let length = class.length_mm as f32
            * 1e-3
            * root.length
            * luck.length
            * (1.0 + DRIFT_LENGTH * drift(0.0))
            * (1.0 + TUFT_LENGTH * clump.random[0]);
        let shared_turn = DRIFT_TURN * drift(40.0) + TUFT_LEAN * clump.random[1];
        let shared_lift = 0.5 * TUFT_LEAN * clump.random[2];

        // Two curves: the hair by itself, and what it would be without straying from its tuft.
        let emergence = class.emergence_deg.to_radians() as f32 + shared_lift;
        let lean = |turn: f32, lift: f32| Lean {
            combing: Quat::from_axis_angle(root.normal, turn) * root.combing,
            emergence: (emergence + lift).clamp(LOWEST, FRAC_PI_2),
        };
        let own = lean(shared_turn + luck.turn, luck.lift);
        let tuft = lean(shared_turn, 0.0);
        let to_center = clump.center - root.position;
        let to_center = to_center - root.normal * to_center.dot(root.normal);
        let pull = (class.clump as f32 * (1.0 + 0.4 * clump.random[3])).clamp(0.0, 1.0);

        let (mut hair, mut center) = (root.position, root.position);
        let crimp = Crimp::new(class, length, length / (self.points() - 1) as f32, &luck);
        points[0] = root.position;
        for k in 0..self.points() - 1 {
            let (from, zeta) = (self.zetas[k], self.zetas[k + 1]);
            let (middle, step) = (0.5 * (from + zeta), length * (zeta - from));
            hair += step * self.direction(root, &own, middle, length);
            center += step * self.direction(root, &tuft, middle, length);
            let toward = pull * clump_weight(zeta) * (center + to_center - hair);
            points[k + 1] = hair + toward + crimp.offset(&own, root, zeta * length);
        }
        if self.gravity == 0.0 {
            keep_above(root, points, length);
        }
        for (width, profile) in widths.iter_mut().zip(&self.profile) {
            *width = profile * luck.width;
        }
    }

    /// Direction at `zeta` along the hair: it leaves at the emergence angle and bends toward the
    /// lay, which turns downhill a little; hanging hair turns straight down.
    fn direction(&self, root: &Root, lean: &Lean, zeta: f32, length: f32) -> Vec3 {
        let bend = self.class.bend_deg.to_radians() as f32;
        let angle = (lean.emergence - bend * zeta).max(LOWEST);
        let downhill = root.normal * root.normal.y - Vec3::Y;
        let lay = (lean.combing + SAG * zeta * downhill).normalize_or(lean.combing);
        let direction = lay * angle.cos() + root.normal * angle.sin();
        let hang = self.gravity * (1.0 - (-(zeta * length / HANG).powi(2)).exp());
        direction.lerp(Vec3::NEG_Y, hang).normalize_or(direction)
    }
}

struct Lean {
    combing: Vec3,
    emergence: f32,
}

/// The waves of an undercoat hair.
struct Crimp {
    amplitude: f32,
    wavenumber: f32,
    phase: f32,
    roll: f32,
}

impl Crimp {
    /// Where control points are too far apart for the wavelength, the wave is stretched along and
    /// across alike: its slope, and so the spread of directions that light meets, stays.
    fn new(class: &ClassGroom, length: f32, step: f32, luck: &Luck) -> Self {
        let natural = class.crimp_wavelength_mm as f32 * 1e-3;
        let wavelength = natural.max(POINTS_PER_WAVE * step);
        let stretch = if natural > 0.0 {
            wavelength / natural
        } else {
            0.0
        };
        Self {
            amplitude: (class.crimp_mm as f32 * 1e-3 * stretch).min(CRIMP_LIMIT * length),
            wavenumber: TAU / wavelength.max(1e-6),
            phase: luck.phase,
            roll: luck.roll,
        }
    }

    fn offset(&self, lean: &Lean, root: &Root, along: f32) -> Vec3 {
        if self.amplitude == 0.0 {
            return Vec3::ZERO;
        }
        // The first half wave grows from nothing: the hair stays in its follicle.
        let grown = (along * self.wavenumber / (0.5 * TAU)).min(1.0);
        let wave = (along * self.wavenumber + self.phase).sin();
        let (sin, cos) = self.roll.sin_cos();
        let across = lean.combing.cross(root.normal) * cos + root.normal * (0.5 * sin);
        across * (self.amplitude * grown * wave)
    }
}

/// Share of the clump's pull at `zeta`, 0 at the root and 1 at the tip.
fn clump_weight(zeta: f32) -> f32 {
    let inverse = 1.0 - zeta;
    zeta * (1.0 - CLUMP_RATE) + CLUMP_RATE * (1.0 - inverse * inverse)
}

/// Lifts control points that clumping or crimp pushed below the skin, seen as the root's tangent
/// plane.
fn keep_above(root: &Root, points: &mut [Vec3], length: f32) {
    let segments = (points.len() - 1) as f32;
    for (k, point) in points.iter_mut().enumerate().skip(1) {
        let least = 0.02 * length * k as f32 / segments;
        let height = (*point - root.position).dot(root.normal);
        *point += root.normal * (least - height).max(0.0);
    }
}

/// Diameter at `zeta` over the widest: a thin stalk, the shield, a tapering tip.
fn profile(class: &ClassGroom, zeta: f64) -> f64 {
    let [from, to] = class.shield;
    let t = if to > from {
        ((zeta - from) / (to - from)).clamp(0.0, 1.0)
    } else {
        f64::from(u8::from(zeta >= from))
    };
    let body = class.stalk + (1.0 - class.stalk) * t * t * (3.0 - 2.0 * t);
    let past = ((zeta - class.taper_from) / (1.0 - class.taper_from).max(1e-6)).clamp(0.0, 1.0);
    body * (1.0 - past.powf(TAPER)).sqrt().max(TIP)
}
