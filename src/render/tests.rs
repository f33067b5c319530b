use super::*;
use crate::bsdf::HairMaterial;
use crate::color::Rgb;
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
        backdrop,
        ground: None,
        view: View::default(),
    })
    .unwrap()
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
