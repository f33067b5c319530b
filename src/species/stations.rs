//! The structure between stations.

use super::model::{Cortex, Cuticle, HairClass, Medulla, MedullaKind, Section, Station, Structure};

/// Length of the hair over which scales of one pattern pass into those of another.
const CROSS_FADE: f64 = 0.1;
/// From here on scales close up toward the tip, and the share of the pitch that is left there: near
/// every guard hair of the Alaska Fur ID Project ends with closely set margins; the numbers are
/// estimates.
const TIP_FROM: f64 = 0.9;
const TIP_PITCH: f64 = 0.5;
/// Steepest scale, height over pitch, as for files.
const STEEPEST_SCALE: f64 = 0.5;

impl HairClass {
    /// The structure at any place along the hair, 0 root .. 1 tip: that of a station where there is
    /// one, that of the nearest station before the first and after the last.
    ///
    /// Numbers change linearly between two stations. What is a kind, such as the medulla's, is that
    /// of the nearer station. Where the scale patterns differ the scales' numbers stay each station's
    /// own but for a tenth of the length about the middle. In the last tenth of the hair, or beyond
    /// its last station, the pitch falls to half.
    ///
    /// `None` for a class without stations, which no file gives.
    pub fn structure_at(&self, at: f64) -> Option<Structure> {
        let at = at.clamp(0.0, 1.0);
        let after = self.stations.iter().position(|s| s.at >= at);
        let mut structure = match after {
            Some(0) => self.stations.first()?.structure.clone(),
            Some(i) => between(&self.stations[i - 1], &self.stations[i], at),
            None => self.stations.last()?.structure.clone(),
        };
        let tip = TIP_FROM.max(self.stations.last()?.at);
        if at > tip {
            let cuticle = &mut structure.cuticle;
            cuticle.pitch_um *= mix(1.0, TIP_PITCH, (at - tip) / (1.0 - tip));
            cuticle.height_um = cuticle.height_um.min(STEEPEST_SCALE * cuticle.pitch_um);
        }
        Some(structure)
    }
}

fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + t * (b - a)
}

fn between(before: &Station, after: &Station, at: f64) -> Structure {
    let t = (at - before.at) / (after.at - before.at);
    let (a, b) = (&before.structure, &after.structure);
    let near = if t < 0.5 { a } else { b };
    let fade = if a.cuticle.pattern == b.cuticle.pattern {
        t
    } else {
        let middle = 0.5 * (before.at + after.at);
        let length = CROSS_FADE.min(after.at - before.at);
        ((at - middle) / length + 0.5).clamp(0.0, 1.0)
    };
    Structure {
        diameter_um: mix(a.diameter_um, b.diameter_um, t),
        aspect: mix(a.aspect, b.aspect, t),
        section: section(a.section, b.section, t),
        twist_turns_per_cm: mix(a.twist_turns_per_cm, b.twist_turns_per_cm, t),
        ior: mix(a.ior, b.ior, t),
        cuticle: cuticle(&a.cuticle, &b.cuticle, &near.cuticle, fade),
        cortex: cortex(&a.cortex, &b.cortex, t),
        medulla: medulla(&a.medulla, &b.medulla, t),
        ..near.clone()
    }
}

fn section(a: Section, b: Section, t: f64) -> Section {
    match (a, b) {
        (Section::Superellipse { squareness: p }, Section::Superellipse { squareness: q }) => {
            Section::Superellipse {
                squareness: mix(p, q, t),
            }
        }
        (Section::ConcavoConvex { bend: p }, Section::ConcavoConvex { bend: q }) => {
            Section::ConcavoConvex { bend: mix(p, q, t) }
        }
        (Section::Bean { dent: p }, Section::Bean { dent: q }) => {
            Section::Bean { dent: mix(p, q, t) }
        }
        _ if t < 0.5 => a,
        _ => b,
    }
}

fn cuticle(a: &Cuticle, b: &Cuticle, near: &Cuticle, t: f64) -> Cuticle {
    // A bare cylinder has no numbers to fade to.
    if a.height_um <= 0.0 || b.height_um <= 0.0 {
        return near.clone();
    }
    Cuticle {
        pitch_um: mix(a.pitch_um, b.pitch_um, t),
        height_um: mix(a.height_um, b.height_um, t),
        around: mix(f64::from(a.around), f64::from(b.around), t).round() as u32,
        jitter: mix(a.jitter, b.jitter, t),
        wear: mix(a.wear, b.wear, t),
        lifted: mix(a.lifted, b.lifted, t),
        roughness: mix(a.roughness, b.roughness, t),
        riser_roughness: mix(a.riser_roughness, b.riser_roughness, t),
        ..near.clone()
    }
}

fn cortex(a: &Cortex, b: &Cortex, t: f64) -> Cortex {
    Cortex {
        toward_medulla: mix(a.toward_medulla, b.toward_medulla, t),
        clear_rim: mix(a.clear_rim, b.clear_rim, t),
        streaks: mix(a.streaks, b.streaks, t),
        fusi_per_mm: mix(a.fusi_per_mm, b.fusi_per_mm, t),
    }
}

fn medulla(a: &Medulla, b: &Medulla, t: f64) -> Medulla {
    let near = if t < 0.5 { a } else { b };
    // No medulla has no numbers either.
    if a.kind == MedullaKind::None || b.kind == MedullaKind::None {
        return near.clone();
    }
    Medulla {
        ratio: mix(a.ratio, b.ratio, t),
        kind: kind(a.kind, b.kind, t),
        void_ior: mix(a.void_ior, b.void_ior, t),
        pigment: mix(a.pigment, b.pigment, t),
        ..near.clone()
    }
}

/// Writes a match of equal kinds, each number of which is mixed; of unequal ones the nearer counts.
macro_rules! mixed {
    ($a:expr, $b:expr, $t:expr, $($kind:ident { $($field:ident),* }),* $(,)?) => {
        match ($a, $b) {
            $((MedullaKind::$kind { $($field),* }, MedullaKind::$kind { .. }) => {
                let first = [$($field),*];
                let second = match $b {
                    MedullaKind::$kind { $($field),* } => [$($field),*],
                    _ => first,
                };
                let mut mixed = first.iter().zip(second).map(|(&p, q)| mix(p, q, $t));
                MedullaKind::$kind { $($field: mixed.next().unwrap_or($field)),* }
            })*
            (near, far) => if $t < 0.5 { near } else { far },
        }
    };
}

fn kind(a: MedullaKind, b: MedullaKind, t: f64) -> MedullaKind {
    if let (
        MedullaKind::Cloisonne {
            columns: n,
            pitch_um: p,
            height_um: h,
        },
        MedullaKind::Cloisonne {
            columns: m,
            pitch_um: q,
            height_um: k,
        },
    ) = (a, b)
    {
        return MedullaKind::Cloisonne {
            columns: mix(f64::from(n), f64::from(m), t).round() as u32,
            pitch_um: mix(p, q, t),
            height_um: mix(h, k, t),
        };
    }
    mixed!(
        a,
        b,
        t,
        Ladder {
            pitch_um,
            septum_um
        },
        Multiserial {
            cell_um,
            pitch_um,
            septum_um
        },
        Lattice { cell_um, wall_um },
        SChannel { pitch_um },
        TireTread {
            pitch_um,
            cell_um,
            septum_um
        },
        Globules { spacing, film_um },
        Amorphous {
            radius_um,
            air_fraction
        },
        Froth {
            radius_um,
            radius_sigma,
            air_fraction
        },
        Medium {
            scattering_per_um,
            asymmetry
        },
    )
}

#[cfg(test)]
mod tests {
    use super::super::{CuticlePattern, load};
    use super::*;

    fn class(stations: Vec<(f64, Structure)>) -> HairClass {
        let mut class = load("glass-cylinder", &[]).unwrap().classes.swap_remove(0);
        class.stations = stations
            .into_iter()
            .map(|(at, structure)| Station { at, structure })
            .collect();
        class
    }

    fn structure(pattern: &str, pitch_um: f64, diameter_um: f64) -> Structure {
        let mut s = Structure {
            diameter_um,
            ..Structure::default()
        };
        s.cuticle.pattern = CuticlePattern::built_in(pattern).unwrap();
        s.cuticle.pitch_um = pitch_um;
        s.cuticle.height_um = 0.5;
        s.medulla = Medulla {
            ratio: diameter_um / 200.0,
            kind: MedullaKind::Ladder {
                pitch_um,
                septum_um: 2.0,
            },
            ..Medulla::default()
        };
        s
    }

    #[test]
    fn numbers_are_linear_and_kinds_switch_half_way() {
        let (stalk, shield) = (
            structure("diamond-petal", 16.0, 40.0),
            structure("mosaic", 8.0, 80.0),
        );
        let class = class(vec![(0.2, stalk.clone()), (0.7, shield.clone())]);
        let at = |x: f64| class.structure_at(x).unwrap();
        assert_eq!((at(0.0), at(0.2)), (stalk.clone(), stalk.clone()));
        assert_eq!((at(0.7), at(0.9)), (shield.clone(), shield));
        let quarter = at(0.325);
        assert!((quarter.diameter_um - 50.0).abs() < 1e-12);
        assert!((quarter.medulla.ratio - 0.25).abs() < 1e-12);
        let MedullaKind::Ladder {
            pitch_um,
            septum_um,
        } = quarter.medulla.kind
        else {
            panic!("a ladder between ladders")
        };
        assert!((pitch_um - 14.0).abs() < 1e-12 && (septum_um - 2.0).abs() < 1e-12);
        // Patterns differ: the pitch only changes from 0.4 to 0.5.
        assert_eq!(
            (quarter.cuticle.pitch_um, at(0.51).cuticle.pitch_um),
            (16.0, 8.0)
        );
        assert!((at(0.45).cuticle.pitch_um - 12.0).abs() < 1e-9);
        assert_eq!(at(0.449).cuticle.pattern.name(), "diamond-petal");
        assert_eq!(at(0.451).cuticle.pattern.name(), "mosaic");
        // Margins close up toward the tip.
        assert!((at(0.95).cuticle.pitch_um - 6.0).abs() < 1e-9);
        assert!((at(1.0).cuticle.pitch_um - 4.0).abs() < 1e-9);
    }

    /// Anywhere along any hair of the library stands a fiber that can be built.
    #[test]
    fn every_place_along_every_hair_can_be_built() {
        for id in super::super::ids() {
            for class in load(id, &[]).unwrap().classes {
                for x in [0.0, 0.37, 0.5, 0.97] {
                    let structure = class.structure_at(x).unwrap();
                    if let Err(error) = crate::fiber::Fiber::build(&structure, 0) {
                        panic!("{id} {} at {x}: {error}", class.name);
                    }
                }
            }
        }
    }
}
