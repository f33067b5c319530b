use super::tests::{SAMPLERS, ball, half_black, mean_of, render};
use super::*;
use crate::bsdf::HairMaterial;
use crate::color::{Rgb, luminance};
use crate::groom::Groom;
use crate::progress::Silent;
use crate::scene::{Backdrop, Environment, Hit, Lamp, LampChoice, LampShape, SceneParts, View};
use crate::skin;
use glam::Vec3;

fn lamp(shape: LampShape, yaw_deg: f32, pitch_deg: f32) -> Lamp {
    Lamp {
        shape,
        yaw_deg,
        pitch_deg,
        strength: Rgb::ONE,
    }
}

fn scene(groom: &Groom, albedo: f32, lamps: &[Lamp], ground: Option<f32>, view: View) -> Scene {
    Scene::build(SceneParts {
        groom,
        materials: vec![HairMaterial::Isotropic(Rgb::splat(albedo))],
        skin: None,
        environment: Environment::black(),
        lamps,
        backdrop: Backdrop::Plain(Rgb::splat(if ground.is_some() { 0.4 } else { 0.0 })),
        ground,
        view,
    })
    .unwrap()
}

fn large_lamps() -> [Lamp; 3] {
    let size = [2.0, 3.0];
    [
        lamp(
            LampShape::Rect {
                distance: 2.0,
                size,
            },
            80.0,
            30.0,
        ),
        lamp(
            LampShape::Sphere {
                distance: 3.0,
                radius: 1.0,
            },
            -60.0,
            60.0,
        ),
        lamp(LampShape::Sun { diameter_deg: 50.0 }, 10.0, 10.0),
    ]
}

/// A cube of six lamps is a white furnace: clear fur shows their radiance whatever light does in between.
#[test]
fn clear_fur_is_as_bright_as_a_room_of_lamps() {
    let (distance, size) = (3.0, [6.0, 6.0]);
    let wall = |yaw, pitch| lamp(LampShape::Rect { distance, size }, yaw, pitch);
    let walls = [
        wall(0.0, 0.0),
        wall(90.0, 0.0),
        wall(180.0, 0.0),
        wall(270.0, 0.0),
        wall(0.0, 90.0),
        wall(0.0, -90.0),
    ];
    let groom = ball(10_000, 8.0, 120.0);
    let s = scene(&groom, 1.0, &walls, None, View::default());
    let choice = LampChoice::new(&s.lamps, Vec3::ZERO);
    let sample = choice.sample([0.3, 0.4, 0.5]).unwrap();
    for sampler in SAMPLERS {
        let film = render(&s, 24, 64, sampler);
        let mut sums = [0.0; 2];
        for pixel in &film.pixels {
            sums[0] += luminance(pixel.radiance);
            sums[1] += pixel.alpha;
        }
        let mean = sums[0] / sums[1] / luminance(sample.radiance);
        let (all, error) = mean_of(&film);
        // Rays that only meet lamps carry weight 1 all the way.
        let most = match sampler {
            Sampler::Bsdf => 1e-3,
            _ => 3.0 * (error / all) as f32,
        };
        assert!((mean - 1.0).abs() < most, "{sampler:?}: {mean} +- {most}");
        assert!(most < 0.04, "{sampler:?}: {most}");
        assert_eq!((film.report.dropped, film.report.capped), (0, 0));
    }
}

/// On a convex matte body every point shows the closed form of the lamps' irradiance.
#[test]
fn a_matte_ball_shows_the_irradiance() {
    let skin = skin::load("ball").unwrap();
    let s = Scene::build(SceneParts {
        groom: &Groom {
            offsets: vec![0],
            ..Groom::default()
        },
        materials: Vec::new(),
        skin: Some((&skin, Rgb::splat(0.5))),
        environment: Environment::black(),
        lamps: &large_lamps(),
        backdrop: Backdrop::Plain(Rgb::ZERO),
        ground: None,
        view: View::default(),
    })
    .unwrap();
    let (camera, n) = (s.camera(1.0), 256);
    let mut exact = 0.0;
    for i in 0..n * n {
        let at = [i % n, i / n].map(|k| (k as f32 + 0.5) / n as f32);
        let ray = camera.ray(at[0], at[1]);
        if let Some(Hit::Surface(hit)) = s.closest(&ray, None) {
            let point = ray.origin + hit.t * ray.dir;
            let light: Rgb = s
                .lamps
                .iter()
                .map(|l| l.irradiance(point, hit.normal))
                .sum();
            exact += luminance(light * hit.color / std::f32::consts::PI) / (n * n) as f32;
        }
    }
    for sampler in SAMPLERS {
        let (mean, error) = mean_of(&render(&s, 32, 256, sampler));
        let off = mean / f64::from(exact) - 1.0;
        assert!(off.abs() < 0.006, "{sampler:?}: {mean} +- {error}, {exact}");
    }
}

#[test]
fn samplers_agree_on_the_light_of_lamps() {
    let groom = ball(6_000, 10.0, 150.0);
    let s = scene(&groom, 0.8, &large_lamps(), None, View::default());
    let means = SAMPLERS.map(|sampler| (sampler, mean_of(&render(&s, 32, 128, sampler))));
    let (_, (truth, truth_error)) = means[0];
    for (sampler, (mean, error)) in means {
        let most = 3.0 * error.hypot(truth_error);
        assert!(
            (mean - truth).abs() < most,
            "{sampler:?}: {mean} +- {error}, {truth}"
        );
        assert!(error < 0.02 * truth, "{sampler:?}: {error}");
    }
}

/// The floor is the backdrop where the subject takes no light away, whatever lamps shine on it, and darker
/// beneath the subject.
#[test]
fn the_floor_joins_the_backdrop_under_lamps() {
    let groom = ball(3_000, 6.0, 300.0);
    let view = View {
        zoom: 0.25,
        pitch_deg: 30.0,
        ..View::default()
    };
    let lamps = [
        lamp(
            LampShape::Rect {
                distance: 3.0,
                size: [2.0, 2.0],
            },
            35.0,
            60.0,
        ),
        lamp(LampShape::Sun { diameter_deg: 30.0 }, 120.0, 70.0),
    ];
    let yellow = lamps.map(|lamp| Lamp {
        strength: Rgb::new(1.0, 1.0, 0.0),
        ..lamp
    });
    let s = scene(&groom, 0.1, &yellow, Some(0.4), view);
    let film = render(&s, 32, 64, Sampler::Qsir);
    let far = |i: usize| i / 32 >= 26 && !(6..26).contains(&(i % 32));
    let corner: Vec<f32> = (0..32 * 32)
        .filter(|&i| far(i))
        .map(|i| film.pixels[i].radiance.x)
        .collect();
    let mean = corner.iter().sum::<f32>() / corner.len() as f32;
    assert!((mean - 0.395).abs() < 0.007, "{mean}");
    let floor = || film.pixels.iter().filter(|p| p.alpha == 0.0);
    let shadow = floor().map(|p| p.radiance.x).fold(1.0, f32::min);
    assert!(shadow < 0.36, "{shadow}");
    // Nothing shines blue, so nothing blue is taken away.
    assert!(floor().all(|p| (p.radiance.z - 0.4).abs() < 1e-5));
}

/// Rays toward light are sent by chance. Where all but a few are left out the mean is still that of
/// rays that are always sent.
#[test]
fn light_asked_for_by_chance_keeps_its_mean() {
    let groom = ball(3_000, 12.0, 300.0);
    let half_black = half_black();
    let under = |environment: &Environment, lamps: &[Lamp]| {
        Scene::build(SceneParts {
            groom: &groom,
            materials: vec![HairMaterial::Isotropic(Rgb::splat(0.8))],
            skin: None,
            environment: environment.clone(),
            lamps,
            backdrop: Backdrop::Plain(Rgb::ZERO),
            ground: None,
            view: View::default(),
        })
        .unwrap()
    };
    let scenes = [
        ("studio", under(&Environment::studio(), &[])),
        ("half black", under(&half_black, &[])),
        ("lamps", under(&Environment::black(), &large_lamps())),
    ];
    for (name, s) in scenes {
        let plain = render(&s, 16, 256, Sampler::Mis);
        let job = RenderJob {
            resolution: [16, 16],
            spp: 256,
            ..RenderJob::default()
        };
        let with = |factor: f32| {
            let mut integrator = job.integrator(&s);
            integrator.enough *= factor;
            let mut rendering = Rendering::with(&job, integrator).unwrap();
            rendering.run(None, &Silent, &Cancel::default());
            rendering.film()
        };
        let (all, few) = (with(0.0), with(15.0));
        let saved = 1.0 - few.report.rays as f64 / all.report.rays as f64;
        assert!(saved > 0.1, "{name}: {saved}");
        let (truth, truth_error) = mean_of(&plain);
        for film in [&all, &with(1.0), &few] {
            let (mean, error) = mean_of(film);
            let z = (mean - truth) / error.hypot(truth_error);
            assert!(z.abs() < 4.0, "{name}: {mean} against {truth}, z = {z}");
            assert!(error < 0.02 * truth, "{name}: {error}");
        }
    }
}
