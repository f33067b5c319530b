use super::*;
use crate::bsdf::HairMaterial;
use crate::color::{Rgb, luminance};
use crate::groom::Groom;
use crate::image::{ViewTransform, write_film_exr, write_film_png};
use crate::progress::Silent;
use crate::sampling::Rng;
use crate::scene::{Backdrop, Environment, SceneParts, View};
use glam::Vec3;

/// A ball of radius 50 mm with bent hairs.
pub(super) fn ball(strands: u32, length_mm: f32, width_um: f32) -> Groom {
    let mut groom = Groom {
        classes: vec!["guard".into()],
        offsets: vec![0],
        ..Groom::default()
    };
    for i in 0..strands {
        let mut rng = Rng::new(11, u64::from(i));
        let y = 1.0 - 2.0 * (i as f32 + 0.5) / strands as f32;
        let phi = i as f32 * 2.399_963;
        let flat = (1.0 - y * y).sqrt();
        let normal = Vec3::new(flat * phi.cos(), y, flat * phi.sin());
        let down = (Vec3::NEG_Y - normal * -y).normalize_or(Vec3::X);
        let stray = Vec3::from_array(std::array::from_fn(|_| rng.uniform_f32() - 0.5));
        let lean = (0.5 * normal + 0.6 * down + 0.35 * stray).normalize();
        let length = length_mm * 1e-3 * (0.7 + 0.6 * rng.uniform_f32());
        for k in 0..6 {
            let s = k as f32 / 5.0;
            let bend = normal.lerp(lean, s).normalize() * s * length;
            groom
                .points
                .push(0.05 * normal + bend + Vec3::NEG_Y * 0.15 * length * s * s);
            groom.widths.push(width_um * 1e-6 * (1.0 - 0.8 * s * s));
        }
        groom.offsets.push(groom.points.len() as u32);
        groom.class.push(0);
        groom.id.push(i);
        groom.root_uv.push(glam::Vec2::new(phi.sin(), y));
        groom.length.push(length);
    }
    groom
}

pub(super) fn scene(
    groom: &Groom,
    albedo: Rgb,
    environment: Environment,
    backdrop: Backdrop,
) -> Scene {
    Scene::build(SceneParts {
        groom,
        materials: vec![HairMaterial::Isotropic(albedo)],
        skin: None,
        environment,
        lamps: &[],
        backdrop,
        ground: None,
        view: View::default(),
    })
    .unwrap()
}

fn straight(width_um: f32) -> Groom {
    Groom {
        points: vec![
            Vec3::ZERO,
            Vec3::new(0.0, 0.01, 0.0),
            Vec3::new(0.0, 0.02, 0.0),
        ],
        widths: vec![width_um * 1e-6; 3],
        offsets: vec![0, 3],
        class: vec![0],
        id: vec![7],
        root_uv: vec![glam::Vec2::splat(0.25)],
        length: vec![0.02],
        classes: vec!["guard".into()],
        ..Groom::default()
    }
}

pub(super) fn render(scene: &Scene, side: u32, spp: u32, sampler: Sampler) -> Film {
    let job = RenderJob {
        resolution: [side, side],
        spp,
        sampler,
        ..RenderJob::default()
    };
    job.run(scene, &Silent, &Cancel::default()).unwrap()
}

/// Mean luminance of a picture and its standard error. Samples of one pixel are better than
/// independent, so the error is an upper bound.
pub(super) fn mean_of(film: &Film) -> (f64, f64) {
    let n = film.pixels.len() as f64;
    let sum: f64 = film
        .pixels
        .iter()
        .map(|p| f64::from(luminance(p.radiance)))
        .sum();
    let variance: f64 = film.pixels.iter().map(|p| f64::from(p.variance)).sum();
    (sum / n, variance.sqrt() / n)
}

pub(super) const SAMPLERS: [Sampler; 5] = [
    Sampler::Qsir,
    Sampler::QsirOneRay,
    Sampler::Bsdf,
    Sampler::Env,
    Sampler::Mis,
];

#[test]
fn clear_fur_is_invisible_in_a_white_furnace() {
    let groom = ball(10_000, 8.0, 120.0);
    let s = scene(
        &groom,
        Rgb::ONE,
        Environment::white(),
        Backdrop::Plain(Rgb::ONE),
    );
    for sampler in SAMPLERS {
        let film = render(&s, 24, 32, sampler);
        let (mean, error) = mean_of(&film);
        assert!((mean - 1.0).abs() < 0.005, "{sampler:?}: {mean} +- {error}");
        assert_eq!((film.report.dropped, film.report.capped), (0, 0));
        if matches!(sampler, Sampler::Bsdf | Sampler::QsirOneRay) {
            // Every path carries weight 1, whatever it meets.
            assert!(
                film.pixels
                    .iter()
                    .all(|p| (p.radiance.y - 1.0).abs() < 1e-4)
            );
        }
    }
}

/// Light that a strand sends to itself would be absorbed twice.
#[test]
fn a_single_absorbing_strand_shows_its_albedo() {
    let groom = straight(2_000.0);
    let s = scene(
        &groom,
        Rgb::splat(0.3),
        Environment::white(),
        Backdrop::Plain(Rgb::ZERO),
    );
    for sampler in SAMPLERS {
        let film = render(&s, 16, 256, sampler);
        let (mut sum, mut alpha) = (0.0, 0.0);
        for p in &film.pixels {
            sum += f64::from(p.radiance.y);
            alpha += f64::from(p.alpha);
            assert!(p.strand == if p.alpha > 0.0 { 7 } else { NO_STRAND });
        }
        assert!(alpha > 5.0);
        let shown = sum / alpha;
        assert!((shown - 0.3).abs() < 0.003, "{sampler:?}: {shown}");
    }
}

/// Light from one half of all directions.
pub(super) fn half_black() -> Environment {
    let lit = |i: usize| if i % 32 < 16 { Rgb::ONE } else { Rgb::ZERO };
    Environment::from_texels(32, 16, (0..512).map(lit).collect())
}

/// Same mean in every light; |z| < 4 for each sampler against the mean of MIS. The planted fault
/// is the bare product as the target of the only ray: half of the sky is black, so light from lit
/// strands on the dark side is lost.
#[test]
fn samplers_agree_and_the_bare_product_does_not() {
    let groom = ball(3_000, 12.0, 300.0);
    let half_black = half_black();
    let lights = [
        ("studio", Environment::studio()),
        (
            "sky",
            // A sun of 25 degrees: one of natural size is met by the scattering model alone once
            // in 50,000 paths, which no test can wait for.
            Environment::sky(&crate::scene::Sun {
                diameter_deg: 25.0,
                ..Default::default()
            }),
        ),
        ("half black", half_black),
    ];
    for (name, light) in lights {
        let s = scene(&groom, Rgb::splat(0.8), light, Backdrop::Plain(Rgb::ZERO));
        let (mean, error) = mean_of(&render(&s, 16, 256, Sampler::Mis));
        for sampler in [
            Sampler::Qsir,
            Sampler::QsirOneRay,
            Sampler::Bsdf,
            Sampler::Env,
        ] {
            let (other, noise) = mean_of(&render(&s, 16, 256, sampler));
            let z = (other - mean) / error.hypot(noise);
            assert!(
                z.abs() < 4.0,
                "{name} {sampler:?}: {other} against {mean}, z = {z}"
            );
        }
        if name == "half black" {
            let job = RenderJob {
                resolution: [16, 16],
                spp: 256,
                sampler: Sampler::QsirOneRay,
                ..RenderJob::default()
            };
            let mut integrator = job.integrator(&s);
            integrator.bare_target = true;
            let mut rendering = Rendering::with(&job, integrator).unwrap();
            rendering.run(None, &Silent, &Cancel::default());
            let film = rendering.film();
            let (biased, noise) = mean_of(&film);
            let z = (biased - mean) / error.hypot(noise);
            assert!(
                z < -8.0,
                "the bias went unseen: {biased} against {mean}, z = {z}"
            );
        }
    }
}

/// Where little light comes in and from few sides, rays to light are drawn far from evenly; their weights make up for it.
#[test]
fn guided_rays_bring_what_unguided_ones_do() {
    let groom = ball(20_000, 10.0, 300.0);
    let light = Environment::studio();
    let mut s = scene(&groom, Rgb::splat(0.8), light, Backdrop::Plain(Rgb::ZERO));
    assert!(s.outlook.is_some());
    let guided = render(&s, 24, 256, Sampler::Qsir);
    s.outlook = None;
    let unguided = render(&s, 24, 256, Sampler::Qsir);
    let [(a, a_noise), (b, b_noise)] = [&guided, &unguided].map(mean_of);
    let z = (a - b) / a_noise.hypot(b_noise);
    assert!(z.abs() < 4.0, "{a} {b}, z = {z}");
    let noise = a_noise / b_noise;
    assert!(noise < 0.97, "{noise}");
}

/// However wrong it is known how bright it is in the fur, so that paths end and split at random: fur that takes no light
/// stays invisible where all directions send as much, and other fur looks as it does where paths do neither.
#[test]
fn paths_that_end_and_split_bring_what_others_do() {
    let white = Environment::from_texels(32, 16, vec![Rgb::ONE; 512]);
    for (albedo, light) in [(1.0, white), (0.8, half_black())] {
        let groom = ball(10_000, 10.0, 300.0);
        let mut s = scene(&groom, Rgb::splat(albedo), light, Backdrop::Environment);
        let mut rng = Rng::new(12, 0);
        let outlook = s.outlook.as_mut().unwrap();
        outlook.guess(|| 0.1 + 2.0 * rng.uniform_f32().powi(2));
        let (mean, noise) = mean_of(&render(&s, 24, 512, Sampler::Qsir));
        let (expected, error) = if albedo == 1.0 {
            (1.0, 0.0)
        } else {
            s.outlook = None;
            mean_of(&render(&s, 24, 512, Sampler::Qsir))
        };
        let z = (mean - expected) / noise.hypot(error);
        assert!(z.abs() < 4.0, "{albedo}: {mean} {expected}, z = {z}");
        assert!(noise < 0.006 * mean, "{albedo}: {noise}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits_and_crops_match() {
    let groom = ball(2_000, 10.0, 200.0);
    let s = scene(
        &groom,
        Rgb::splat(0.7),
        Environment::studio(),
        Backdrop::default(),
    );
    let job = RenderJob {
        resolution: [50, 40],
        spp: 5,
        seed: 3,
        ..RenderJob::default()
    };
    let with = |job: &RenderJob, threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| job.run(&s, &Silent, &Cancel::default()).unwrap())
    };
    let full = with(&job, 1);
    assert_eq!(full.pixels, with(&job, 2).pixels);
    assert_eq!(full.pixels, with(&job, 7).pixels);
    let crop = Crop {
        x: 13,
        y: 9,
        width: 23,
        height: 18,
    };
    let part = RenderJob {
        crop: Some(crop),
        ..job.clone()
    };
    let part = with(&part, 2);
    for (i, pixel) in part.pixels.iter().enumerate() {
        let (x, y) = (13 + i % 23, 9 + i / 23);
        assert_eq!(*pixel, full.pixels[y * 50 + x]);
    }
    let other = RenderJob { seed: 4, ..job };
    assert_ne!(full.pixels, with(&other, 1).pixels);
}

#[test]
fn a_time_limit_leaves_a_whole_picture_and_a_cancel_stops() {
    let groom = ball(500, 10.0, 200.0);
    let s = scene(
        &groom,
        Rgb::splat(0.7),
        Environment::studio(),
        Backdrop::default(),
    );
    let job = RenderJob {
        resolution: [40, 40],
        spp: 1 << 20,
        time_limit: Some(Duration::from_millis(50)),
        ..RenderJob::default()
    };
    let film = job.run(&s, &Silent, &Cancel::default()).unwrap();
    assert!(!film.report.complete && film.report.passes >= 1);
    assert!(film.pixels.iter().all(|p| p.samples >= 1));
    let cancel = Cancel::default();
    cancel.cancel();
    let film = job.run(&s, &Silent, &cancel).unwrap();
    assert_eq!((film.report.passes, film.report.samples), (0, 0));
}

#[test]
fn impossible_pictures_are_refused() {
    let job = RenderJob::default();
    let message = |job: &RenderJob| job.check().unwrap_err().to_string();
    let empty = RenderJob {
        resolution: [0, 0],
        ..job.clone()
    };
    assert!(message(&empty).contains("0 x 0"));
    assert_eq!(empty.check().unwrap_err().blame(), Blame::Input);
    let none = RenderJob {
        spp: 0,
        ..job.clone()
    };
    assert!(message(&none).contains("0 samples"));
    let outside = RenderJob {
        crop: Some(Crop {
            x: 900,
            y: 0,
            width: 61,
            height: 1,
        }),
        ..job
    };
    assert!(message(&outside).contains("900"));
}

/// The floor is the backdrop where the subject takes no light away, and darker beneath it.
#[test]
fn the_floor_joins_the_backdrop() {
    let groom = ball(3_000, 6.0, 300.0);
    let backdrop = Rgb::splat(0.4);
    let s = Scene::build(SceneParts {
        groom: &groom,
        materials: vec![HairMaterial::Isotropic(Rgb::splat(0.1))],
        skin: None,
        environment: Environment::white(),
        lamps: &[],
        backdrop: Backdrop::Plain(backdrop),
        ground: Some(0.4),
        view: View {
            zoom: 0.25,
            pitch_deg: 30.0,
            ..View::default()
        },
    })
    .unwrap();
    let film = render(&s, 32, 64, Sampler::Qsir);
    // Of the floor in the near corners the ball hides about 1.5 %.
    let corners = (26..32).flat_map(|y| {
        (0..32)
            .filter(|x| !(6..26).contains(x))
            .map(move |x| (x, y))
    });
    let values: Vec<f32> = corners
        .map(|(x, y)| film.pixels[y * 32 + x].radiance.x)
        .collect();
    let corner = values.iter().sum::<f32>() / values.len() as f32;
    assert!((corner - 0.394).abs() < 0.006, "{corner}");
    let floor = film.pixels.iter().filter(|p| p.alpha == 0.0);
    let shadow = floor.map(|p| p.radiance.x).fold(1.0, f32::min);
    assert!(shadow < 0.36, "{shadow}");
}

#[test]
#[ignore = "writes pictures to look at"]
fn look() {
    let groom = ball(60_000, 12.0, 90.0);
    let albedo = Rgb::new(0.86, 0.72, 0.55);
    let environment = Environment::studio().turned(35.0);
    let mut scene = scene(&groom, albedo, environment, Backdrop::default());
    if std::env::var_os("GROUND").is_some() {
        let s = Scene::build(SceneParts {
            groom: &groom,
            materials: vec![HairMaterial::Isotropic(albedo)],
            skin: None,
            environment: Environment::studio().turned(35.0),
            lamps: &[],
            backdrop: Backdrop::default(),
            ground: Some(0.4),
            view: View::default(),
        });
        scene = s.unwrap();
    }
    let job = RenderJob {
        resolution: [640, 480],
        spp: 32,
        ..RenderJob::default()
    };
    let film = job.run(&scene, &Silent, &Cancel::default()).unwrap();
    eprintln!(
        "{} segments, noise {}, {:?}",
        scene.strands.segments(),
        film.noise(),
        film.report
    );
    let folder = std::path::PathBuf::from(std::env::var("OUT").unwrap());
    let view = ViewTransform::default();
    write_film_png(&folder.join("ball.png"), &film, &view, &[]).unwrap();
    write_film_exr(&folder.join("ball.exr"), &film, &[("species", "test")]).unwrap();
}

#[test]
#[ignore = "prints noise of the samplers"]
fn noise_of_samplers() {
    let groom = ball(20_000, 12.0, 150.0);
    for (name, env) in [
        ("studio", Environment::studio().turned(35.0)),
        ("sky", Environment::sky(&crate::scene::Sun::default())),
        ("white", Environment::white()),
    ] {
        let s = scene(&groom, Rgb::splat(0.8), env, Backdrop::Plain(Rgb::ZERO));
        for sampler in [Sampler::Mis, Sampler::Qsir, Sampler::QsirOneRay] {
            let job = RenderJob {
                resolution: [48, 48],
                spp: 64,
                sampler,
                ..RenderJob::default()
            };
            let film = job.run(&s, &Silent, &Cancel::default()).unwrap();
            let mean: f32 = film.pixels.iter().map(|p| p.radiance.y).sum::<f32>() / 2304.0;
            let (noise, time) = (film.noise(), film.report.elapsed.as_secs_f64());
            eprintln!(
                "{name} {sampler:?}: mean {mean:.4} noise {noise:.4} time {time:.2} rays {} eff {:.3}",
                film.report.rays,
                1.0 / (noise * noise * time)
            );
        }
    }
}
