//! What the built-in species say.

use super::super::*;
use super::text_of;

#[test]
fn every_built_in_species_loads_with_all_origins() {
    for id in ids() {
        let (species, origins) = match load_with_origins(id, &[]) {
            Ok(loaded) => loaded,
            Err(error) => panic!("{id}:\n{error}"),
        };
        assert_eq!(species.id, id);
        assert_eq!(species.text, text_of(id));
        for number in &origins.numbers {
            match &number.origin {
                Origin::Source(keys) => assert!(!keys.is_empty(), "{id} {}", number.path),
                Origin::Estimate(why) => assert!(why.len() > 3, "{id} {}", number.path),
                Origin::Override => panic!("{id} {}", number.path),
            }
        }
        for reference in &origins.references {
            let cites = |c: &Cited| match &c.origin {
                Origin::Source(keys) => keys.contains(&reference.key),
                Origin::Estimate(why) => why.contains(&reference.key),
                Origin::Override => false,
            };
            let remarked = text_of(id).contains(&format!("({}", reference.key));
            let used = origins.numbers.iter().any(cites) || remarked;
            assert!(used, "{id}: nothing refers to {}", reference.key);
        }
    }
}

/// Profile of the groom: R = D (stalk + (1 - stalk) smoothstep) before the tip.
#[test]
fn stations_are_as_wide_as_the_hair_there() {
    for id in ids() {
        for class in load(id, &[]).unwrap().classes {
            let groom = &class.groom;
            for station in &class.stations {
                let [from, to] = groom.shield;
                let x = ((station.at - from) / (to - from)).clamp(0.0, 1.0);
                let smooth = x * x * (3.0 - 2.0 * x);
                let width = groom.diameter_um * (groom.stalk + (1.0 - groom.stalk) * smooth);
                let ratio = station.structure.diameter_um / width;
                let place = format!("{id} {} at {}", class.name, station.at);
                assert!((0.95..1.05).contains(&ratio), "{place}: {ratio}");
                assert!(station.at <= groom.taper_from, "{place} is in the tip");
            }
        }
    }
}

#[test]
fn the_five_species_are_what_their_literature_says() {
    let fox = load("red-fox", &[]).unwrap();
    let [stalk, shield] = &fox.classes[0].stations[..] else {
        panic!("red fox guard hair has a stalk and a shield");
    };
    assert_eq!(
        stalk.structure.cuticle.pattern,
        CuticlePattern::DiamondPetal
    );
    assert_eq!(shield.structure.cuticle.pattern, CuticlePattern::Mosaic);
    assert!((0.5..=0.77).contains(&shield.structure.medulla.ratio));
    assert_eq!(fox.classes[0].pigment.len(), 3);
    assert!(fox.classes[0].pigment[2].to_mm.is_infinite());

    let bear = load("polar-bear", &[]).unwrap();
    let clear = |b: &PigmentBand| b.absorption_per_um() == [0.0; 3];
    assert!(bear.classes.iter().all(|c| c.pigment.iter().all(clear)));
    assert!(bear.skin_color.iter().all(|c| *c < 0.05));

    let mink = load("mink", &[]).unwrap();
    let MedullaKind::Medium {
        scattering_per_um,
        asymmetry,
    } = mink.classes[0].stations[1].structure.medulla.kind
    else {
        panic!("mink guard hair has a homogeneous medulla");
    };
    assert!((scattering_per_um - 3.0 * 0.4 / (4.0 * 3.0)).abs() < 1e-12);
    assert_eq!(asymmetry, 0.5);
    assert_eq!(mink.classes[0].pigment.len(), 1);

    let human = load("human", &[]).unwrap();
    assert_eq!(
        human.classes[0].stations[0].structure.medulla.kind,
        MedullaKind::None
    );

    let glass = load("glass-cylinder", &["structure.ior=1.5".to_owned()]).unwrap();
    let fiber = &glass.classes[0].stations[0].structure;
    assert_eq!(
        (fiber.ior, fiber.aspect, fiber.cuticle.roughness),
        (1.5, 1.0, 0.0)
    );
    assert_eq!(fiber.cuticle.pattern, CuticlePattern::Smooth);
    assert!(
        glass
            .text
            .ends_with("# Overrides:\n# --set structure.ior=1.5\n")
    );
}
