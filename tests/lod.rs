//! Levels of detail: thinner coats are part of fuller ones and cover as much of a picture.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use glam::Vec3;
use std::collections::{HashMap, HashSet};
use vair::bsdf::HairMaterial;
use vair::export::asset::{Level, levels};
use vair::groom::{Groom, GroomSettings, grow};
use vair::progress::{Cancel, Silent};
use vair::render::{Filter, RenderJob, Sampler};
use vair::scene::{Backdrop, Environment, Scene, SceneParts, View};
use vair::skin::{self, Skin};
use vair::species::{self, Species};

fn grown(skin: &Skin, species: &Species, strands: usize) -> Groom {
    let settings = GroomSettings {
        strands: Some(strands),
        seed: 0,
    };
    grow(skin, species, &settings, &Silent, &Cancel::default()).unwrap()
}

/// A groom of which some strands are seen, with widths of their own. The others stay without a width, so that the
/// camera, which frames all strands, stands where it stood.
fn only(groom: &Groom, seen: impl Iterator<Item = (usize, Vec<f32>)>) -> Groom {
    let mut part = groom.clone();
    part.widths.fill(1e-12);
    for (strand, widths) in seen {
        part.widths[groom.range(strand)].copy_from_slice(&widths);
    }
    part
}

/// Only a level, as wide as the level has it.
fn alone(groom: &Groom, level: &Level) -> Groom {
    let strands = level.classes.iter().flat_map(|class| {
        let wider = |strand: usize| {
            let widths = groom.widths[groom.range(strand)].iter();
            widths.map(|w| w * class.widening).collect()
        };
        let strands = class.strands.iter();
        strands.map(move |&i| (i as usize, wider(i as usize)))
    });
    only(groom, strands)
}

/// Share of a picture in which hair is seen, not the skin and not what is behind.
fn coverage(groom: &Groom, skin: &Skin) -> f64 {
    let view = View {
        zoom: 0.85,
        yaw_deg: 25.0,
        ..View::from_direction(skin.view)
    };
    let scene = Scene::build(SceneParts {
        groom,
        // Black hair on white skin before nothing.
        materials: vec![HairMaterial::Isotropic(Vec3::ZERO); groom.classes.len()],
        skin: Some((skin, Vec3::ONE)),
        environment: Environment::white(),
        lamps: &[],
        backdrop: Backdrop::Environment,
        ground: None,
        view,
    })
    .unwrap();
    let job = RenderJob {
        resolution: [96, 72],
        spp: 16,
        sampler: Sampler::Bsdf,
        filter: Filter::Box,
        ..RenderJob::default()
    };
    let film = job.run(&scene, &Silent, &Cancel::default()).unwrap();
    let pixels = film.pixels.iter();
    let hair = pixels.map(|p| f64::from(p.alpha - p.albedo.x));
    hair.sum::<f64>() / film.pixels.len() as f64
}

/// Only the strands of a thinner groom, as wide as that has them.
fn seen(full: &Groom, thin: &Groom) -> Groom {
    let places: HashMap<u32, usize> = full.id.iter().enumerate().map(|(i, id)| (*id, i)).collect();
    let strands = thin.id.iter().enumerate().map(|(i, id)| {
        assert_eq!(full.strand(places[id]), thin.strand(i));
        (places[id], thin.widths[thin.range(i)].to_vec())
    });
    only(full, strands)
}

/// Fewer strands than an animal grows by default keep its look.
#[test]
fn fewer_strands_cover_as_much() {
    for (name, on) in [
        ("red-fox", "body"),
        ("sheep", "swatch"),
        ("polar-bear", "swatch"),
    ] {
        let skin = skin::load(on).unwrap();
        let mut species = species::load(name, &[]).unwrap();
        // Skin under a painted coat is tinted, and would count as hair.
        species.coat = None;
        let settings = GroomSettings::default();
        let full = grow(&skin, &species, &settings, &Silent, &Cancel::default()).unwrap();
        let all = coverage(&full, &skin);
        for part in [2, 4] {
            let thin = grown(&skin, &species, full.strands() / part);
            let share = coverage(&seen(&full, &thin), &skin) / all;
            println!("{name} on {on}, 1/{part}: {share:.3} of {all:.3}");
            assert!((share - 1.0).abs() < 0.05, "{name} 1/{part}: {share}");
        }
    }
}

#[test]
fn levels_nest_and_cover_as_much() {
    for (name, on, strands, keep_widths) in [
        ("red-fox", "ball", 30_000, false),
        ("red-fox", "ball", 30_000, true),
        ("polar-bear", "swatch", 20_000, true),
        // All that it has.
        ("polar-bear", "swatch", 58_855, false),
    ] {
        let skin = skin::load(on).unwrap();
        let mut species = species::load(name, &[]).unwrap();
        species.groom.keep_widths = keep_widths;
        let full = grown(&skin, &species, strands);
        let all = coverage(&full, &skin);
        assert!(all > 0.1, "{all}: nothing to tell");
        let levels = levels(&full, &skin, &species, 3).unwrap();
        assert_eq!(levels.len(), 3);
        let mut finer: HashSet<u32> = full.id.iter().copied().collect();
        for level in &levels {
            let strands = level.classes.iter().flat_map(|c| c.strands.iter());
            let here: HashSet<u32> = strands.map(|&i| full.id[i as usize]).collect();
            assert!(here.is_subset(&finer), "{name} {}", level.name);
            finer = here;
            let share = coverage(&alone(&full, level), &skin) / all;
            println!("{name} on {on}, {}: {share:.3} of {all:.3}", level.name);
            assert!((share - 1.0).abs() < 0.05, "{name} {}: {share}", level.name);
        }
    }
}
