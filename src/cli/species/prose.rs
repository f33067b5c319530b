//! Sentences of the field guide: a hair in words.

use crate::species::{
    ClassGroom, Continuity, Cuticle, CuticlePattern, HairClass, Margin, Medulla, MedullaKind,
    Section, Structure,
};

/// `50 mm long, 75 um thick, 385 to the square centimeter.`
pub(super) fn measures(groom: &ClassGroom) -> String {
    format!(
        "{} mm long, {} um thick where it is thickest, {} to the square centimeter.",
        short(groom.length_mm),
        short(groom.diameter_um),
        short(groom.density_per_cm2)
    )
}

/// Thickness and cross-section.
pub(super) fn section(structure: &Structure) -> String {
    let shape = match structure.section {
        Section::Ellipse if structure.aspect < 1.02 => "round".to_owned(),
        Section::Ellipse => oval(structure.aspect),
        Section::Superellipse { .. } => format!("oblong, {}", ratio(structure.aspect)),
        Section::DumbBell => format!("dumb-bell shaped, {}", ratio(structure.aspect)),
        Section::ConcavoConvex { .. } => format!("bent like a gutter, {}", ratio(structure.aspect)),
        Section::Bean { .. } => format!("bean shaped, {}", ratio(structure.aspect)),
    };
    format!("{} um thick, {shape}.", short(structure.diameter_um))
}

fn oval(aspect: f64) -> String {
    let word = match aspect {
        a if a < 1.12 => "nearly round",
        a if a < 1.45 => "slightly oval",
        a if a < 2.2 => "flattened",
        _ => "flat",
    };
    format!("{word}, {}", ratio(aspect))
}

fn ratio(aspect: f64) -> String {
    format!("{} : 1", short(aspect))
}

/// Pattern, number, distance and tilt of the scales.
pub(super) fn scales(cuticle: &Cuticle) -> String {
    let what = cuticle.pattern.description();
    if cuticle.pattern == CuticlePattern::Smooth {
        return format!("{what}.");
    }
    let margin = match cuticle.margin {
        Margin::Smooth => "",
        Margin::Crenate => " with finely notched margins",
        Margin::Rippled => " with rippled margins",
        Margin::Scalloped => " with scalloped margins",
        Margin::Dentate => " with toothed margins",
    };
    let tilt = (cuticle.height_um / cuticle.pitch_um).atan().to_degrees();
    format!(
        "{what}{margin}; {} round the hair, a row every {} um, free edges {} um high (a tilt of {:.1} \
         degrees).",
        cuticle.around,
        short(cuticle.pitch_um),
        short(cuticle.height_um),
        tilt
    )
}

/// Kind, width and sizes of the medulla.
pub(super) fn medulla(medulla: &Medulla) -> String {
    let what = medulla.kind.description();
    let pieces = match medulla.continuity {
        Continuity::Continuous => "",
        Continuity::Interrupted => ", with gaps",
        Continuity::Fragmentary => ", in isolated pieces",
    };
    let sizes = match medulla.kind {
        MedullaKind::None => return format!("{what}."),
        MedullaKind::Ladder { pitch_um, .. }
        | MedullaKind::Multiserial { pitch_um, .. }
        | MedullaKind::TireTread { pitch_um, .. } => format!("a rung every {} um", short(pitch_um)),
        MedullaKind::Lattice { cell_um, .. } => format!("cells {} um wide", short(cell_um)),
        MedullaKind::SChannel { pitch_um } => format!("a disc every {} um", short(pitch_um)),
        MedullaKind::Cloisonne {
            columns, pitch_um, ..
        } => {
            format!("{columns} across, a row every {} um", short(pitch_um))
        }
        MedullaKind::Globules { film_um, .. } => format!("films {} um thick", short(film_um)),
        MedullaKind::Amorphous {
            radius_um,
            air_fraction,
        }
        | MedullaKind::Froth {
            radius_um,
            air_fraction,
            ..
        } => format!(
            "bubbles {} um wide, {:.0} percent air",
            short(2.0 * radius_um),
            100.0 * air_fraction
        ),
        MedullaKind::Medium { .. } => "cells too small to tell apart".to_owned(),
    };
    format!(
        "{what}{pieces}; {:.0} percent of the width, {sizes}.",
        100.0 * medulla.ratio
    )
}

/// Colors from the tip to the root.
pub(super) fn color(class: &HairClass) -> String {
    let mut words = Vec::new();
    let mut from = 0.0;
    for band in &class.pigment {
        let word = class.color_word(band);
        let place = match (from > 0.0, band.to_mm.is_finite()) {
            (false, false) => "from tip to root".to_owned(),
            (false, true) => format!("for the first {} mm from the tip", short(band.to_mm)),
            (true, true) => format!("to {} mm", short(band.to_mm)),
            (true, false) => "to the root".to_owned(),
        };
        words.push(format!("{word} {place}"));
        from = band.to_mm;
    }
    format!("{}.", words.join(", "))
}

/// Direction, shape and clumping.
pub(super) fn growth(groom: &ClassGroom) -> String {
    let crimp = if groom.crimp_mm > 0.0 {
        format!(
            "waved by {} mm every {} mm",
            short(groom.crimp_mm),
            short(groom.crimp_wavelength_mm)
        )
    } else {
        "straight".to_owned()
    };
    let stalk = if groom.stalk < 0.95 {
        format!(
            ", thin at the root ({:.0} percent) and widest from {:.0} percent of the length on",
            100.0 * groom.stalk,
            100.0 * groom.shield[1]
        )
    } else {
        String::new()
    };
    let locks = match groom.clump {
        c if c < 0.05 => "every hair for itself".to_owned(),
        c => format!(
            "{} locks {} mm wide",
            if c < 0.35 { "loose" } else { "tight" },
            short(groom.clump_mm)
        ),
    };
    let side = if groom.roll_deg < 90.0 {
        format!(
            ", flat side to the skin give or take {} degrees",
            short(groom.roll_deg)
        )
    } else {
        String::new()
    };
    format!(
        "leaves the skin at {} degrees and bends by {}{side}; {crimp}{stalk}; {locks}.",
        short(groom.emergence_deg),
        short(groom.bend_deg)
    )
}

/// A number as people write it: at most three digits after the point, thousands apart.
pub(super) fn short(value: f64) -> String {
    let rounded = (value * 1e3).round() / 1e3;
    let text = rounded.to_string();
    let (whole, rest) = text
        .split_once('.')
        .map_or((text.as_str(), None), |(w, r)| (w, Some(r)));
    let mut grouped = String::new();
    for (index, digit) in whole.chars().enumerate() {
        let left = whole.len() - index;
        if index > 0 && left % 3 == 0 && whole.len() > 4 && digit.is_ascii_digit() {
            grouped.push(' ');
        }
        grouped.push(digit);
    }
    match rest {
        Some(rest) => format!("{grouped}.{rest}"),
        None => grouped,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_as_people_write_them() {
        for (value, text) in [
            (0.5, "0.5"),
            (1287.0, "1287"),
            (128_713.0, "128 713"),
            (10.300_000_1, "10.3"),
            (-20_000.0, "-20 000"),
            (1e7, "10 000 000"),
        ] {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn a_scale_says_its_tilt() {
        let cuticle = Cuticle {
            pattern: CuticlePattern::built_in("mosaic").unwrap(),
            pitch_um: 10.0,
            height_um: 1.0,
            around: 7,
            ..Cuticle::default()
        };
        // atan(1 / 10) = 5.71 degrees.
        assert!(scales(&cuticle).contains("tilt of 5.7 degrees"));
        assert_eq!(scales(&Cuticle::default()), "no scales: a bare cylinder.");
    }
}
