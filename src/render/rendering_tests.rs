use super::super::tests::{ball, scene};
use super::super::{FilmSumsError, Sampler};
use super::*;
use crate::color::Rgb;
use crate::progress::Silent;
use crate::scene::{Backdrop, Environment};

fn fur() -> Scene {
    let groom = ball(1_500, 10.0, 250.0);
    let light = Environment::studio();
    scene(&groom, Rgb::new(0.8, 0.6, 0.3), light, Backdrop::default())
}

fn job() -> RenderJob {
    RenderJob {
        resolution: [50, 40],
        spp: 40,
        seed: 3,
        sampler: Sampler::Mis,
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
        // A single bit off is noticed.
        let mut bytes = std::fs::read(&path).unwrap();
        let last = bytes.len() - 3;
        bytes[last] ^= 1;
        std::fs::write(&path, bytes).unwrap();
        assert!(matches!(
            FilmSums::read(&path),
            Err(FilmSumsError::Damaged { .. })
        ));
        read
    });
    let merged = FilmSums::merge(read.collect()).unwrap();
    assert_eq!(merged, whole.sums("fur"));
    assert_eq!(merged.film().pixels, whole.film().pixels);
    let gap = FilmSums::merge(vec![part(0, 5), part(23, 40)]);
    assert!(matches!(gap, Err(FilmSumsError::Gap { end: 5, next: 23 })));
    let mut other = part(5, 23);
    other.header.of = "feathers".to_owned();
    let foreign = FilmSums::merge(vec![part(0, 5), other]);
    assert!(matches!(foreign, Err(FilmSumsError::Foreign { .. })));
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
            .all(|t| t.error() <= target || t.next == 2_000)
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
    }
}
