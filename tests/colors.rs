//! A color that is asked for is what a coat shows: from the text of a species to the mean of a picture.

#![allow(clippy::unwrap_used)] // all of it is test

use std::path::Path;
use vair::assembly::{StationTables, match_colors, materials};
use vair::bake::{Cache, Settings};
use vair::color::Rgb;
use vair::groom::{self, GroomSettings};
use vair::progress::{Cancel, Silent};
use vair::render::{RenderJob, Sampler};
use vair::scene::{Backdrop, Environment, Scene, SceneParts, View};
use vair::species::Species;
use vair::{skin, species};

fn grown() -> GroomSettings {
    GroomSettings {
        strands: Some(20_000),
        seed: 5,
    }
}

fn settings() -> Settings {
    Settings {
        photons: 100_000,
        ..Settings::cone()
    }
}

/// The species with the strength of its dyes, and what was said about them.
fn matched(mut animal: Species, on: &str) -> (Species, Vec<String>) {
    let skin = skin::load(on).unwrap();
    let cache = Cache::at(&Path::new(env!("CARGO_TARGET_TMPDIR")).join("colors"));
    let (cancel, bake) = (Cancel::default(), settings());
    let tables = StationTables::new(&animal, &[], &bake, Some(&cache), &Silent, &cancel).unwrap();
    let said = match_colors(&mut animal, &tables, &skin, &grown(), &Silent, &cancel).unwrap();
    (animal, said)
}

/// Mean over what is not backdrop, of another size and noise than colors are matched with; with a quarter of the samples
/// it is off by 2 % itself.
fn shown(animal: &Species, on: &str) -> Rgb {
    let skin = skin::load(on).unwrap();
    let cancel = Cancel::default();
    let cache = Cache::at(&Path::new(env!("CARGO_TARGET_TMPDIR")).join("colors"));
    let groom = groom::grow(&skin, animal, &grown(), &Silent, &cancel).unwrap();
    let scene = Scene::build(SceneParts {
        groom: &groom,
        materials: materials(animal, &settings(), Some(&cache), &Silent, &cancel).unwrap(),
        skin: Some((&skin, Rgb::from_array(animal.skin_color.map(|c| c as f32)))),
        environment: Environment::white(),
        lamps: &[],
        backdrop: Backdrop::Plain(Rgb::ZERO),
        ground: None,
        view: View::from_direction(skin.view),
    });
    let job = RenderJob {
        resolution: [120, 90],
        spp: 64,
        seed: 9,
        sampler: Sampler::Qsir,
        ..RenderJob::default()
    };
    let film = job.run(&scene.unwrap(), &Silent, &cancel).unwrap();
    let radiance: Rgb = film.pixels.iter().map(|p| p.radiance).sum();
    radiance / film.pixels.iter().map(|p| p.alpha).sum::<f32>()
}

#[test]
fn what_is_asked_for_is_shown() {
    let dyed = |id: &str, color: [f64; 3]| {
        let mut animal = species::load(id, &[]).unwrap();
        animal.dye(color);
        (animal, color)
    };
    // As in a file: of one color from tip to root, in two bands.
    let bands = "guard.pigment=[{ to_mm = 9, softness_mm = 2, color = [0.25, 0.1, 0.04] }, { color = [0.25, 0.1, 0.04] }]";
    let written = species::load("human", &[bands.to_owned()]).unwrap();
    for ((animal, color), on) in [
        (dyed("alpaca", [0.5, 0.2, 0.05]), "ball"),
        ((written, [0.25, 0.1, 0.04]), "ball"),
        (dyed("alpaca", [0.1, 0.2, 0.4]), "swatch"),
    ] {
        let (animal, said) = matched(animal, on);
        assert!(said.is_empty(), "{said:?}");
        let shown = shown(&animal, on);
        // Within 2 % is promised; looked up only once the human's red is off by that.
        for c in 0..3 {
            let off = f64::from(shown[c]) / color[c] - 1.0;
            assert!(
                off.abs() < 0.015,
                "{} on {on}, asked for {color:?}, shows {shown}",
                animal.id
            );
        }
    }
}

#[test]
fn what_cannot_be_shown_is_said() {
    let mut animal = species::load("human", &[]).unwrap();
    animal.dye([1.0, 0.0, 0.2]);
    let (animal, said) = matched(animal, "ball");
    assert_eq!(said.len(), 1);
    assert!(
        said[0].starts_with("this coat cannot show 1 0 0.2 (linear), but 0."),
        "{said:?}"
    );
    let absorption = animal.classes[0].pigment[0].absorption_per_um();
    assert!(absorption[0] == 0.0 && absorption[2] > 0.0 && absorption[1] > absorption[2]);
}
