use super::super::tests::ball;
use super::super::{FilmSumsError, Sampler};
use super::*;
use crate::bsdf::HairMaterial;
use crate::color::Rgb;
use crate::progress::Silent;
use crate::scene::{Backdrop, Environment, SceneParts, View};
use std::path::PathBuf;

/// Of two hair classes and two zones.
fn fur() -> Scene {
    let mut groom = ball(1_500, 10.0, 250.0);
    groom.classes.push("under".into());
    groom.class = (0..1_500).map(|i| u8::from(i % 3 == 0)).collect();
    groom.coat = (0..1_500).map(|i| u8::from(i < 500)).collect();
    let light = Environment::studio();
    Scene::build(SceneParts {
        groom: &groom,
        materials: vec![HairMaterial::Isotropic(Rgb::new(0.8, 0.6, 0.3)); 2],
        skin: None,
        environment: light,
        lamps: &[],
        backdrop: Backdrop::default(),
        ground: Some(0.5),
        view: View::default(),
    })
    .unwrap()
}

fn job() -> RenderJob {
    RenderJob {
        resolution: [50, 40],
        spp: 40,
        seed: 3,
        sampler: Sampler::Mis,
        mattes: true,
        ..RenderJob::default()
    }
}

fn all_of<'a>(job: &RenderJob, scene: &'a Scene) -> Rendering<'a> {
    let mut rendering = Rendering::new(job, scene).unwrap();
    assert!(rendering.run(None, &Silent, &Cancel::default()));
    rendering
}

#[test]
fn ranges_of_samples_make_the_picture_of_one_run() {
    let fur = fur();
    let whole = all_of(&job(), &fur);
    let part = |first: u32, end: u32| {
        let job = RenderJob {
            first,
            spp: end - first,
            ..job()
        };
        all_of(&job, &fur).sums("fur")
    };
    let parts = [part(23, 40), part(0, 5), part(5, 23)];
    let folder = tempfile::tempdir().unwrap();
    let read = parts.iter().enumerate().map(|(i, part)| {
        let path = folder.path().join(format!("{i}.safetensors"));
        part.write(&path).unwrap();
        let read = FilmSums::read(&path).unwrap();
        assert_eq!(*part, read);
        assert!(FilmSums::are_in(&path).unwrap());
        // A single bit off is noticed.
        let mut bytes = std::fs::read(&path).unwrap();
        let last = bytes.len() - 3;
        bytes[last] ^= 1;
        std::fs::write(&path, bytes).unwrap();
        assert!(matches!(
            FilmSums::read(&path),
            Err(FilmSumsError::Damaged { .. })
        ));
        assert!(FilmSums::are_in(&path).unwrap());
        (path, read)
    });
    let merged = FilmSums::merge(read.collect()).unwrap();
    assert_eq!(merged, whole.sums("fur"));
    assert_eq!(merged.film().pixels, whole.film().pixels);
    assert_eq!(merged.film().mattes, whole.film().mattes);
    let named = |name: &str, part| (PathBuf::from(name), part);
    let merge = |parts: Vec<_>| FilmSums::merge(parts).unwrap_err().to_string();
    assert_eq!(
        merge(vec![named("b", part(23, 40)), named("a", part(0, 5))]),
        "b: samples 5 to 23 are missing or there twice"
    );
    let mut other = part(5, 23);
    other.header.of = "feathers".to_owned();
    assert_eq!(
        merge(vec![named("a", part(0, 5)), named("b", other)]),
        "b: the sums are of another picture: the scene differs"
    );
    let mut other = part(5, 23);
    other.header.mattes = None;
    assert_eq!(
        merge(vec![named("a", part(0, 5)), named("b", other)]),
        "b: the sums are of another picture: what mattes there are differs"
    );
}

/// Stopped in the middle, saved, read and gone on with.
#[test]
fn a_stopped_rendering_goes_on_to_the_same_picture() {
    let fur = fur();
    for target_error in [None, Some(0.05)] {
        let job = RenderJob {
            target_error,
            ..job()
        };
        let whole = all_of(&job, &fur);
        let mut rendering = Rendering::new(&job, &fur).unwrap();
        let mut rounds = 0;
        while !rendering.run(
            Some(Instant::now() + Duration::from_millis(2)),
            &Silent,
            &Cancel::default(),
        ) {
            let sums = rendering.sums("fur");
            rendering = Rendering::new(&job, &fur).unwrap();
            rendering.resume(sums).unwrap();
            rounds += 1;
        }
        assert!(rounds > 2, "{rounds}");
        assert_eq!(rendering.film().pixels, whole.film().pixels);
        assert_eq!(rendering.film().mattes, whole.film().mattes);
        assert_eq!(rendering.film().report.samples, whole.film().report.samples);
        let other = RenderJob { seed: 4, ..job };
        let mut other = Rendering::new(&other, &fur).unwrap();
        let refused = other.resume(rendering.sums("fur"));
        assert!(matches!(
            refused,
            Err(FilmSumsError::Foreign { what: "the seed" })
        ));
    }
}

#[test]
fn tiles_end_where_they_have_enough() {
    let fur = fur();
    let target = 0.1;
    let job = RenderJob {
        target_error: Some(target),
        spp: 2_000,
        ..job()
    };
    let whole = all_of(&job, &fur);
    let mut counts: Vec<u32> = whole.tiles.iter().map(|t| t.next).collect();
    assert!(
        whole
            .tiles
            .iter()
            .all(|t| error(&t.sums) <= target || t.next == 2_000)
    );
    counts.sort_unstable();
    assert!(
        counts[0] == LEAST && counts[counts.len() - 1] > 2 * LEAST,
        "{counts:?}"
    );
    // A crop, whose tiles it cuts, shows the same.
    let crop = Crop {
        x: 13,
        y: 9,
        width: 23,
        height: 18,
    };
    let part = all_of(
        &RenderJob {
            crop: Some(crop),
            ..job
        },
        &fur,
    );
    let (whole, part) = (whole.film(), part.film());
    for (i, pixel) in part.pixels.iter().enumerate() {
        let (x, y) = (13 + i % 23, 9 + i / 23);
        assert_eq!(*pixel, whole.pixels[y * 50 + x]);
        let mattes = |film: &Film, at| film.mattes.as_ref().map(|m| m.of_pixel(at).to_vec());
        assert_eq!(mattes(&part, i), mattes(&whole, y * 50 + x));
    }
}

/// A range that was stopped is a picture of its own, but no later one can follow it.
#[test]
fn one_unfinished_part_is_merged_as_it_is() {
    let fur = fur();
    let half = RenderJob { spp: 20, ..job() };
    let mut sums = all_of(&half, &fur).sums("fur");
    sums.header.spp = 30;
    let name = |sums: &FilmSums| (PathBuf::from("a"), sums.clone());
    let alone = FilmSums::merge(vec![name(&sums)]).unwrap();
    assert_eq!(alone, sums);
    assert!(!alone.film().report.complete);
    let mut later = sums.clone();
    later.header.first = 30;
    let error = FilmSums::merge(vec![name(&sums), name(&later)]).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("a: samples 0 to 30 are not complete"),
        "{error}"
    );
}

/// Tiles that stopped at the target are all there is to take.
#[test]
fn sums_that_met_their_target_are_complete() {
    let fur = fur();
    let job = RenderJob {
        target_error: Some(0.3),
        spp: 2_000,
        ..job()
    };
    let whole = all_of(&job, &fur);
    let sums = whole.sums("fur");
    assert!(sums.header.next.iter().any(|&next| next < 2_000));
    assert!(sums.film().report.complete && whole.film().report.complete);
}

#[test]
fn a_time_limit_is_met_after_the_first_pass() {
    let fur = fur();
    let job = RenderJob {
        time_limit: Some(Duration::ZERO),
        ..job()
    };
    let mut rendering = Rendering::new(&job, &fur).unwrap();
    assert!(!rendering.is_late());
    assert!(!rendering.run(None, &Silent, &Cancel::default()));
    assert!(rendering.is_late() && rendering.film().report.samples > 0);
}

/// The rate of a rendering that went on is that of its own rays.
#[test]
fn rays_of_the_time_before_do_not_count_twice() {
    let fur = fur();
    let half = RenderJob { spp: 20, ..job() };
    let mut sums = all_of(&half, &fur).sums("fur");
    let before = sums.film().report.rays;
    sums.header.spp = 40;
    let mut rendering = Rendering::new(&job(), &fur).unwrap();
    rendering.resume(sums).unwrap();
    assert!(rendering.run(None, &Silent, &Cancel::default()));
    let report = rendering.film().report;
    assert!(report.rays_in_elapsed > 0);
    assert_eq!(report.rays, before + report.rays_in_elapsed);
}

/// Every sample that meets strands counts for one class and one zone, and where nobody asks nothing is counted.
#[test]
fn what_samples_see_is_counted_by_name() {
    let fur = fur();
    let film = all_of(&job(), &fur).film();
    let mattes = film.mattes.as_ref().unwrap();
    let sum = |names: Vec<(&str, usize)>, pixel| {
        let shown = names.iter().filter(|(name, _)| *name != "ground");
        shown
            .map(|(_, at)| mattes.of_pixel(pixel)[*at])
            .sum::<u32>()
    };
    let mut total = std::collections::BTreeMap::new();
    for (i, pixel) in film.pixels.iter().enumerate() {
        let hits = (pixel.alpha * pixel.samples as f32).round() as u32;
        assert_eq!(sum(mattes.classes(), i), hits);
        assert_eq!(sum(mattes.zones(), i), hits);
        for (name, at) in mattes.classes().into_iter().chain(mattes.zones()) {
            *total.entry(name).or_insert(0) += mattes.of_pixel(i)[at];
        }
    }
    let names: Vec<&str> = total.keys().copied().collect();
    assert_eq!(
        names,
        ["ground", "guard", "skin", "under", "zone 0", "zone 1"]
    );
    assert!(total["guard"] > total["under"] && total["under"] > 0 && total["ground"] > 0);
    assert!(total["zone 0"] > 0 && total["zone 1"] > 0 && total["skin"] == 0);
    let plain = RenderJob {
        mattes: false,
        ..job()
    };
    let plain = all_of(&plain, &fur).film();
    assert_eq!((plain.mattes, plain.pixels), (None, film.pixels));
}
