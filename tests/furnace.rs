//! The white furnace: fur that absorbs nothing, in a world that is white all over, cannot be seen.
//! It holds only if the bake loses no light, tables and sampling agree, frames are right and a ray
//! leaves the strand that it was scattered by.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use vair::assembly;
use vair::bake::Settings;
use vair::bsdf::{
    AlongStrand, Chiang, ChiangParameters, DoubleCylinder, DoubleCylinderParameters, HairMaterial,
};
use vair::color::Rgb;
use vair::groom::{self, GroomSettings};
use vair::progress::{Cancel, Silent};
use vair::render::{RenderJob, Sampler};
use vair::scene::{Backdrop, Environment, Scene, SceneParts, View};
use vair::{skin, species};

/// All of them: every one is right.
const SAMPLERS: [Sampler; 5] = [
    Sampler::Qsir,
    Sampler::QsirOneRay,
    Sampler::Bsdf,
    Sampler::Env,
    Sampler::Mis,
];

/// Mean radiance over a small picture of clear fur on nothing, its standard error, and the share of
/// the picture that is fur.
fn furnace(name: &str, overrides: &[&str], sampler: Sampler) -> (Rgb, f64, f64) {
    let bake = Settings {
        photons: 300_000,
        ..Settings::cone()
    };
    measure(&world(name, overrides, &bake), sampler)
}

/// Fur of a species in a white world.
fn world(name: &str, overrides: &[&str], bake: &Settings) -> Scene {
    let species = load(name, overrides);
    let cancel = Cancel::default();
    let materials = assembly::materials(&species, bake, None, &Silent, &cancel).unwrap();
    world_of(&species, materials)
}

fn load(name: &str, overrides: &[&str]) -> species::Species {
    let overrides: Vec<String> = overrides.iter().map(|o| (*o).to_owned()).collect();
    species::load(name, &overrides).unwrap()
}

fn world_of(species: &species::Species, materials: Vec<HairMaterial>) -> Scene {
    let cancel = Cancel::default();
    let ball = skin::load("ball").unwrap();
    let settings = GroomSettings {
        strands: Some(4000),
        seed: 2,
    };
    let groom = groom::grow(&ball, species, &settings, &Silent, &cancel).unwrap();
    Scene::build(SceneParts {
        groom: &groom,
        materials,
        skin: None,
        environment: Environment::white(),
        lamps: &[],
        backdrop: Backdrop::Environment,
        ground: None,
        view: View::default(),
    })
    .unwrap()
}

fn measure(scene: &Scene, sampler: Sampler) -> (Rgb, f64, f64) {
    let job = RenderJob {
        resolution: [40, 40],
        spp: 64,
        sampler,
        ..RenderJob::default()
    };
    let film = job.run(scene, &Silent, &Cancel::default()).unwrap();
    assert_eq!((film.report.dropped, film.report.capped), (0, 0));
    let n = film.pixels.len() as f32;
    let mean = film.pixels.iter().map(|p| p.radiance).sum::<Rgb>() / n;
    let variance: f64 = film.pixels.iter().map(|p| f64::from(p.variance)).sum();
    let fur = film.pixels.iter().map(|p| f64::from(p.alpha)).sum::<f64>() / f64::from(n);
    (mean, variance.sqrt() / f64::from(n), fur)
}

#[test]
fn clear_fur_in_a_white_world_is_invisible() {
    let bake = Settings {
        photons: 300_000,
        ..Settings::cone()
    };
    let world = world("polar-bear", &[], &bake);
    for sampler in SAMPLERS {
        let (mean, error, fur) = measure(&world, sampler);
        assert!(fur > 0.15, "there is fur: {fur}");
        // Background pixels are 1 exactly; the bound is on what the fur itself is off.
        let off = f64::from((mean - 1.0).abs().max_element()) / fur;
        assert!(
            off < 0.005 + 3.0 * error / fur,
            "{sampler:?}: {mean} +- {error}"
        );
    }
}

/// The hair models, which lose no light either.
#[test]
fn clear_fur_of_hair_models_is_invisible() {
    let chiang = Chiang::new(&ChiangParameters {
        sigma_a: Rgb::ZERO,
        ..ChiangParameters::default()
    });
    let double = DoubleCylinder::new(&DoubleCylinderParameters {
        sigma_a: Rgb::ZERO,
        layers: 1.5,
        ..DoubleCylinderParameters::default()
    });
    let species = load("polar-bear", &[]);
    for material in [
        HairMaterial::Chiang(AlongStrand::uniform(chiang)),
        HairMaterial::DoubleCylinder(AlongStrand::uniform(double)),
    ] {
        let world = world_of(&species, vec![material; species.classes.len()]);
        for sampler in SAMPLERS {
            let (mean, error, fur) = measure(&world, sampler);
            let off = f64::from((mean - 1.0).abs().max_element()) / fur;
            assert!(
                off < 0.005 + 3.0 * error / fur,
                "{sampler:?}: {mean} +- {error}"
            );
        }
    }
}

#[test]
fn pigment_is_seen_in_the_furnace() {
    let (mean, _, _) = furnace(
        "polar-bear",
        &["guard.pigment.0.eumelanin=0.2"],
        Sampler::Qsir,
    );
    assert!(
        mean.x < 0.995 && mean.z < mean.x,
        "a little eumelanin must show: {mean}"
    );
}

/// Flat hairs whose sides are told apart lose no light either.
#[test]
fn clear_flat_hair_is_invisible() {
    let clear = [
        "guard.pigment.0.eumelanin=0",
        "guard.pigment.0.pheomelanin=0",
        "under.pigment.1.eumelanin=0",
        "under.pigment.1.pheomelanin=0",
    ];
    let bake = Settings {
        photons: 100_000,
        azimuths: 3,
        face: 16,
        reconstruct: false,
        ..Settings::cone()
    };
    let world = world("harbor-seal", &clear, &bake);
    for sampler in [Sampler::Qsir, Sampler::Mis] {
        let (mean, error, fur) = measure(&world, sampler);
        assert!(fur > 0.02, "there is fur: {fur}");
        let off = f64::from((mean - 1.0).abs().max_element()) / fur;
        assert!(
            off < 0.005 + 3.0 * error / fur,
            "{sampler:?}: {mean} +- {error}"
        );
    }
}
