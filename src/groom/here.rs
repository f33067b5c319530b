//! The numbers of a hair class at one root: those of the species with all that varies there.

use super::vary::Varied;
use crate::species::{ClassGroom, VaryWhat};

/// Bounds of the species file that a factor may not leave either.
const LEAST_STALK: f64 = 0.05;
const MOST_TAPER: f64 = 0.99;
const LEAST_WAVELENGTH: f32 = 1e-4;
const LEAST_PITCH: f32 = 5e-4;
const LEAST_CLUMP: f32 = 1e-4;

/// How much closer wet hair clings: at full wetness clumps are this many times as large.
const WET_CLUMP: f32 = 3.0;

/// Lengths in meters, angles in radians.
pub(super) struct Here {
    /// Mean length, but for the factor of the skin.
    pub(super) length: f32,
    /// Hairs are cut to this length, infinity for uncut ones.
    pub(super) trim: f32,
    /// Standard deviations of the logarithms of length and width.
    pub(super) sigmas: [f64; 2],
    pub(super) stray: f64,
    pub(super) roll: f64,
    pub(super) emergence: f32,
    pub(super) bend: f32,
    /// Factor on what turns hair downhill.
    pub(super) gravity: f32,
    pub(super) crimp: f32,
    pub(super) wavelength: f32,
    pub(super) curl: f32,
    pub(super) pitch: f32,
    pub(super) frizz: f32,
    /// 0 dry .. 1.
    pub(super) wet: f32,
    /// Share of the way to the clump's center, 0..1.
    pub(super) clump: f32,
    /// Size of a clump.
    pub(super) size: f32,
}

impl Here {
    pub(super) fn new(class: &ClassGroom, vary: &Varied) -> Self {
        let of = |what: VaryWhat| vary[what];
        let wide = |what: VaryWhat| f64::from(vary[what]);
        let wavelength = class.crimp_wavelength_mm as f32 * 1e-3 * of(VaryWhat::CrimpWavelength);
        let wavelength = wavelength.max(LEAST_WAVELENGTH);
        Self {
            length: class.length_mm as f32 * 1e-3,
            trim: trim(class, vary),
            sigmas: [
                (class.length_sigma * wide(VaryWhat::LengthSpread)).min(1.0),
                (class.diameter_sigma * wide(VaryWhat::WidthSpread)).min(1.0),
            ],
            stray: (class.stray_deg * wide(VaryWhat::Stray))
                .min(90.0)
                .to_radians(),
            roll: (class.roll_deg * wide(VaryWhat::Roll))
                .min(90.0)
                .to_radians(),
            emergence: class.emergence_deg.to_radians() as f32 * of(VaryWhat::Tilt),
            bend: class.bend_deg.to_radians() as f32 * of(VaryWhat::Bend),
            gravity: class.gravity as f32 * of(VaryWhat::Gravity),
            // Steeper waves would cross themselves.
            crimp: (class.crimp_mm as f32 * 1e-3 * of(VaryWhat::Crimp)).min(0.5 * wavelength),
            wavelength,
            curl: class.curl_mm as f32 * 1e-3 * of(VaryWhat::Curl),
            pitch: (class.curl_pitch_mm as f32 * 1e-3 * of(VaryWhat::CurlPitch)).max(LEAST_PITCH),
            frizz: class.frizz_mm as f32 * 1e-3 * of(VaryWhat::Frizz),
            wet: wet(class, vary),
            clump: (class.clump as f32 * of(VaryWhat::Clump)).min(1.0),
            size: size(class, vary),
        }
    }
}

/// The length to which hairs are cut, meters.
pub(super) fn trim(class: &ClassGroom, vary: &Varied) -> f32 {
    if class.trim_mm.is_finite() {
        class.trim_mm as f32 * 1e-3 * vary[VaryWhat::Trim]
    } else {
        f32::INFINITY
    }
}

fn wet(class: &ClassGroom, vary: &Varied) -> f32 {
    (class.wet as f32 * vary[VaryWhat::Wet]).min(1.0)
}

/// Size of clumps, meters: wet hair sticks together in larger ones.
pub(super) fn size(class: &ClassGroom, vary: &Varied) -> f32 {
    let dry = (class.clump_mm * 1e-3) as f32 * vary[VaryWhat::ClumpSize];
    dry.max(LEAST_CLUMP) * (1.0 + (WET_CLUMP - 1.0) * wet(class, vary))
}

/// How thick a hair is along its length.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Profile {
    stalk: f64,
    shield: [f64; 2],
    taper_from: f64,
}

/// Exponent of the tip's taper, and the width left at the very tip.
const TAPER: f64 = 1.5;
const TIP: f64 = 0.08;

impl Profile {
    pub(super) fn new(class: &ClassGroom, vary: &Varied) -> Self {
        let of = |what: VaryWhat| f64::from(vary[what]);
        let shield = class.shield.map(|at| at * of(VaryWhat::Shield));
        let taper_from = (class.taper_from * of(VaryWhat::Taper)).min(MOST_TAPER);
        Self {
            stalk: (class.stalk * of(VaryWhat::Stalk)).clamp(LEAST_STALK, 1.0),
            shield: shield.map(|at| at.min(1.0)),
            taper_from,
        }
    }

    /// Diameter at `zeta` over the widest: a thin stalk, the shield, a tapering tip.
    pub(super) fn at(&self, zeta: f64) -> f64 {
        let [from, to] = self.shield;
        let t = if to > from {
            ((zeta - from) / (to - from)).clamp(0.0, 1.0)
        } else {
            f64::from(u8::from(zeta >= from))
        };
        let body = self.stalk + (1.0 - self.stalk) * t * t * (3.0 - 2.0 * t);
        let past = ((zeta - self.taper_from) / (1.0 - self.taper_from).max(1e-6)).clamp(0.0, 1.0);
        body * (1.0 - past.powf(TAPER)).sqrt().max(TIP)
    }
}
