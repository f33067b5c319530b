//! What a groom promises, on plain skins.

use super::*;
use crate::progress::Silent;
use crate::skin;
use crate::species::{
    ClassGroom, Cuticle, CuticlePattern, HairClass, Medulla, MedullaKind, PigmentBand, Station,
    Structure,
};
use std::collections::HashMap;

fn class(name: &str, groom: ClassGroom) -> HairClass {
    HairClass {
        name: name.to_owned(),
        stations: vec![Station {
            at: 0.5,
            structure: Structure {
                diameter_um: groom.diameter_um,
                aspect: 1.0,
                ior: 1.55,
                cuticle: Cuticle {
                    pattern: CuticlePattern::Smooth,
                    pitch_um: 9.0,
                    height_um: 0.5,
                    around: 6,
                    jitter: 0.0,
                    roughness: 0.1,
                    riser_roughness: 0.3,
                },
                medulla: Medulla {
                    ratio: 0.0,
                    kind: MedullaKind::None,
                    void_ior: 1.0003,
                    pigment: 0.0,
                },
            },
        }],
        pigment: vec![PigmentBand {
            to_mm: f64::INFINITY,
            softness_mm: 0.0,
            eumelanin: 0.1,
            pheomelanin: 0.5,
        }],
        groom,
    }
}

/// A fox's coat, numbers as in the literature on canids.
pub(super) fn fox() -> Species {
    let guard = ClassGroom {
        density_per_cm2: 385.0,
        length_mm: 50.0,
        length_sigma: 0.12,
        diameter_um: 75.0,
        diameter_sigma: 0.1,
        stalk: 0.5,
        shield: [0.1, 0.6],
        taper_from: 0.7,
        emergence_deg: 40.0,
        bend_deg: 30.0,
        stray_deg: 6.0,
        crimp_mm: 0.0,
        crimp_wavelength_mm: 2.0,
        clump: 0.2,
        clump_mm: 4.0,
    };
    let under = ClassGroom {
        density_per_cm2: 9615.0,
        length_mm: 30.0,
        length_sigma: 0.2,
        diameter_um: 20.0,
        stray_deg: 12.0,
        crimp_mm: 0.2,
        clump: 0.3,
        ..guard.clone()
    };
    Species {
        id: "fox".to_owned(),
        name: "Fox".to_owned(),
        latin: String::new(),
        summary: String::new(),
        classes: vec![class("guard", guard), class("under", under)],
        skin_color: [0.5; 3],
        text: String::new(),
    }
}

fn grown(skin: &Skin, species: &Species, strands: usize, seed: u64) -> Groom {
    let settings = GroomSettings {
        strands: Some(strands),
        seed,
    };
    grow(skin, species, &settings, &Silent, &Cancel::default()).unwrap()
}

#[test]
fn a_thin_groom_is_a_subset_of_a_dense_one() {
    let skin = skin::load("swatch").unwrap();
    let dense = grown(&skin, &fox(), 20_000, 3);
    let thin = grown(&skin, &fox(), 2_000, 3);
    assert_eq!((dense.strands(), thin.strands()), (20_000, 2_000));
    let by_id: HashMap<u32, usize> = dense
        .id
        .iter()
        .enumerate()
        .map(|(i, &id)| (id, i))
        .collect();
    assert_eq!(by_id.len(), dense.strands(), "ids are unique");
    for i in 0..thin.strands() {
        let other = by_id[&thin.id[i]];
        assert_eq!(thin.strand(i), dense.strand(other));
        assert_eq!(thin.class[i], dense.class[other]);
    }
}

#[test]
fn same_bytes_for_any_number_of_threads() {
    let skin = skin::load("ball").unwrap();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| grown(&skin, &fox(), 30_000, 1))
    };
    let one = on(1);
    assert!(one == on(2));
    assert!(one == on(7));
    assert!(one != grown(&skin, &fox(), 30_000, 2), "the seed matters");
}
