//! Waves of a hair about its course: crimp, curl and frizz.

use super::follicle::Root;
use super::here::Here;
use super::strand::{Lean, Luck};
use glam::Vec3;
use std::f32::consts::TAU;

/// Control points that carry one wave of crimp. Fewer and it vanishes between the points.
pub(super) const POINTS_PER_WAVE: f32 = 3.0;
/// Largest crimp amplitude relative to length.
const CRIMP_LIMIT: f32 = 0.06;
/// Waves of frizz along a hair.
const FRIZZ_WAVES: f32 = 2.2;

/// The waves of an undercoat hair.
pub(super) struct Crimp {
    amplitude: f32,
    wavenumber: f32,
    phase: f32,
    roll: f32,
}

impl Crimp {
    /// Where control points are too far apart for the wavelength, the wave is stretched along and
    /// across alike: its slope, and so the spread of directions that light meets, stays.
    pub(super) fn new(here: &Here, length: f32, step: f32, luck: &Luck) -> Self {
        let wavelength = here.wavelength.max(POINTS_PER_WAVE * step);
        let stretch = wavelength / here.wavelength;
        Self {
            amplitude: (here.crimp * stretch).min(CRIMP_LIMIT * length),
            wavenumber: TAU / wavelength,
            phase: luck.phase,
            roll: luck.roll,
        }
    }

    pub(super) fn offset(&self, lean: &Lean, root: &Root, along: f32) -> Vec3 {
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

/// The helix of a curl, the same for all hairs of a clump: they curl as one.
pub(super) struct Curl {
    radius: f32,
    wavenumber: f32,
    phase: f32,
}

impl Curl {
    /// * `phase`: -1..1, of the clump.
    pub(super) fn new(here: &Here, step: f32, phase: f32) -> Self {
        // Stretched where points are too few, but no wider: it would leave the coat.
        let pitch = here.pitch.max(POINTS_PER_WAVE * step);
        Self {
            radius: here.curl,
            wavenumber: TAU / pitch,
            phase: phase * 0.5 * TAU,
        }
    }

    pub(super) fn offset(&self, lean: &Lean, root: &Root, along: f32) -> Vec3 {
        if self.radius == 0.0 {
            return Vec3::ZERO;
        }
        let grown = (along * self.wavenumber / TAU).min(1.0);
        let (sin, cos) = (along * self.wavenumber + self.phase).sin_cos();
        let across = lean.combing.cross(root.normal);
        (across * cos + root.normal * sin) * (self.radius * grown)
    }
}

/// The wandering of a single hair: a slow wave in each of two directions, growing toward the tip.
pub(super) struct Frizz {
    across: [Vec3; 2],
    amplitude: f32,
    phases: [f32; 2],
}

impl Frizz {
    pub(super) fn new(here: &Here, root: &Root, luck: &Luck) -> Self {
        Self {
            across: [root.combing.cross(root.normal), root.normal],
            amplitude: here.frizz,
            phases: luck.frizz,
        }
    }

    pub(super) fn offset(&self, zeta: f32) -> Vec3 {
        if self.amplitude == 0.0 {
            return Vec3::ZERO;
        }
        let wave = |k: usize| {
            let turns = FRIZZ_WAVES * zeta * (1.0 - 0.35 * k as f32);
            (TAU * turns + self.phases[k]).sin()
        };
        (self.across[0] * wave(0) + self.across[1] * wave(1)) * (self.amplitude * zeta)
    }
}
