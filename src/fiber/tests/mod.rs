//! Structures like those of real animals, and what every fiber must keep to.

mod cells;
mod kinds;
mod library;
mod light;
mod scales;
mod sections;
mod shaped;
mod shapes;
mod twist;
mod walk;

use super::Fiber;
use crate::species::{Cuticle, CuticlePattern, Margin, Medulla, MedullaKind, Section, Structure};

pub(super) fn structure(
    diameter_um: f64,
    aspect: f64,
    (pattern, pitch_um, height_um, around): (&str, f64, f64, u32),
    (ratio, kind): (f64, MedullaKind),
) -> Structure {
    Structure {
        diameter_um,
        aspect,
        ior: 1.55,
        cuticle: Cuticle {
            pattern: CuticlePattern::built_in(pattern).unwrap(),
            pitch_um,
            height_um,
            around,
            jitter: 1.0,
            roughness: 0.1,
            riser_roughness: 0.3,
            ..Default::default()
        },
        medulla: Medulla {
            ratio,
            kind,
            void_ior: 1.0003,
            pigment: 1.0,
            ..Default::default()
        },
        ..Default::default()
    }
}

pub(super) fn glass() -> Structure {
    let cuticle = ("smooth", 10.0, 0.0, 1);
    structure(80.0, 1.0, cuticle, (0.0, MedullaKind::None))
}

pub(super) fn fox_guard() -> Structure {
    let ladder = MedullaKind::Ladder {
        pitch_um: 9.0,
        septum_um: 2.0,
    };
    structure(75.0, 1.2, ("mosaic", 9.0, 0.5, 7), (0.7, ladder))
}

pub(super) fn bear_guard() -> Structure {
    let froth = MedullaKind::Froth {
        radius_um: 5.0,
        radius_sigma: 0.35,
        air_fraction: 0.4,
    };
    structure(130.0, 1.1, ("irregular-wave", 11.0, 0.6, 5), (0.37, froth))
}

pub(super) fn mink_under() -> Structure {
    let ladder = MedullaKind::Ladder {
        pitch_um: 9.0,
        septum_um: 2.0,
    };
    let mut s = structure(14.0, 1.0, ("diamond-petal", 12.0, 0.5, 3), (0.5, ladder));
    s.medulla.pigment = 2.0;
    s
}

pub(super) fn chinchilla() -> Structure {
    let medium = MedullaKind::Medium {
        scattering_per_um: 0.1,
        asymmetry: 0.5,
    };
    structure(15.0, 1.0, ("coronal", 25.0, 0.7, 1), (0.75, medium))
}

pub(super) fn flat_seal() -> Structure {
    structure(
        40.0,
        3.5,
        ("irregular-wave", 8.0, 0.4, 10),
        (0.0, MedullaKind::None),
    )
}

/// Waisted, with deep margins.
pub(super) fn rabbit_guard() -> Structure {
    let medium = MedullaKind::Medium {
        scattering_per_um: 0.05,
        asymmetry: 0.5,
    };
    let scales = ("single-chevron", 8.0, 0.5, 2);
    Structure {
        section: Section::DumbBell,
        ..structure(70.0, 2.4, scales, (0.6, medium))
    }
}

/// Bent, worn and damaged.
pub(super) fn mouse_guard() -> Structure {
    let scales = ("lanceolate-petal", 8.0, 0.4, 5);
    let mut s = structure(45.0, 1.7, scales, (0.0, MedullaKind::None));
    s.section = Section::ConcavoConvex { bend: 0.4 };
    s.cuticle.margin = Margin::Dentate;
    s.cuticle.wear = 0.3;
    s.cuticle.lifted = 0.2;
    s
}

/// A shape without scales.
pub(super) fn bean() -> Structure {
    Structure {
        section: Section::Bean { dent: 0.3 },
        aspect: 1.6,
        ..glass()
    }
}

pub(super) fn otter_under() -> Structure {
    let scales = ("otter-fin", 16.0, 0.8, 4);
    structure(12.0, 1.0, scales, (0.0, MedullaKind::None))
}

pub(super) fn worn_bear() -> Structure {
    let mut s = bear_guard();
    s.cuticle.pattern = CuticlePattern::built_in("torn-paper").unwrap();
    s.cuticle.wear = 0.5;
    s.cuticle.lifted = 0.3;
    s.medulla = Medulla::default();
    s
}

pub(super) fn all() -> Vec<(&'static str, Fiber)> {
    let mut structures = vec![
        ("glass", glass()),
        ("fox guard", fox_guard()),
        ("bear guard", bear_guard()),
        ("mink under", mink_under()),
        ("chinchilla", chinchilla()),
        ("flat seal", flat_seal()),
        ("rabbit guard", rabbit_guard()),
        ("mouse guard", mouse_guard()),
        ("bean", bean()),
        ("otter under", otter_under()),
        ("worn bear", worn_bear()),
    ];
    structures.extend(kinds::structures());
    structures.extend(shaped::structures());
    structures
        .into_iter()
        .map(|(name, s)| (name, Fiber::build(&s, 7).unwrap()))
        .collect()
}
