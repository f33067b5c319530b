//! Rays a second through fur, on one thread: camera rays and rays scattered evenly over the sphere
//! from where those hit. `cargo bench --bench rays [strands]`.
//!
//! Time is that of the thread, so that a busy machine does not count.

mod clock;

use clock::thread_seconds;
use glam::Vec3;
use std::hint::black_box;
use vair::bsdf::HairMaterial;
use vair::color::Rgb;
use vair::groom::Groom;
use vair::sampling::Rng;
use vair::scene::{Backdrop, Environment, Leaving, Ray, Scene, SceneError, SceneParts, View};

fn main() -> Result<(), SceneError> {
    let strands = std::env::args().skip(1).find_map(|a| a.parse().ok());
    let groom = ball(strands.unwrap_or(100_000));
    let started = std::time::Instant::now();
    let scene = Scene::build(SceneParts {
        groom: &groom,
        materials: vec![HairMaterial::Isotropic(Rgb::ONE)],
        skin: None,
        environment: Environment::white(),
        lamps: &[],
        backdrop: Backdrop::default(),
        ground: None,
        view: View::default(),
    })?;
    println!(
        "{} strands, {} segments, built in {:.2} s",
        groom.strands(),
        scene.strands.segments(),
        started.elapsed().as_secs_f64()
    );

    let side = 1024;
    let camera = scene.camera(1.0);
    let primary: Vec<Ray> = (0..side * side)
        .map(|i| {
            let at = |k: u32| (k as f32 + 0.5) / side as f32;
            camera.ray(at(i % side), at(i / side))
        })
        .collect();
    let mut scattered: Vec<(Ray, Leaving)> = Vec::new();
    measure("camera", primary.len(), || {
        scattered.clear();
        for (i, ray) in primary.iter().enumerate() {
            if let Some(hit) = scene.strands.closest(ray, f32::INFINITY, None) {
                let dir = sphere(&mut Rng::new(1, i as u64));
                let origin = ray.origin + hit.t * ray.dir;
                scattered.push((Ray { origin, dir }, hit.departure().along(dir)));
            }
        }
    });
    println!(
        "{:.1} % of the camera rays hit",
        100.0 * scattered.len() as f64 / primary.len() as f64
    );
    measure("incoherent", scattered.len(), || {
        for (ray, leaving) in &scattered {
            black_box(scene.strands.closest(ray, f32::INFINITY, Some(*leaving)));
        }
    });
    measure("occlusion", scattered.len(), || {
        for (ray, leaving) in &scattered {
            black_box(scene.strands.occluded(ray, f32::INFINITY, Some(*leaving)));
        }
    });
    Ok(())
}

fn measure(name: &str, rays: usize, mut work: impl FnMut()) {
    let mut best = f64::INFINITY;
    for _ in 0..3 {
        let start = thread_seconds();
        work();
        best = best.min(thread_seconds() - start);
    }
    println!("{name:>10}: {:.3} M rays/s", rays as f64 / best * 1e-6);
}

fn sphere(rng: &mut Rng) -> Vec3 {
    let z = 1.0 - 2.0 * rng.uniform_f32();
    let (sin, cos) = (std::f32::consts::TAU * rng.uniform_f32()).sin_cos();
    let flat = (1.0 - z * z).sqrt();
    Vec3::new(flat * cos, flat * sin, z)
}

/// A ball of 100 mm with bent, stray hairs 20 mm long and 60 um wide, 8 control points each.
fn ball(strands: u32) -> Groom {
    let mut groom = Groom {
        classes: vec!["guard".into()],
        offsets: vec![0],
        ..Groom::default()
    };
    for i in 0..strands {
        let mut rng = Rng::new(11, u64::from(i));
        let normal = sphere(&mut rng);
        let down = (Vec3::NEG_Y + normal * normal.y).normalize_or(Vec3::X);
        let lean = (0.6 * normal + 0.6 * down + 0.3 * sphere(&mut rng)).normalize();
        let length = 0.02 * (0.7 + 0.6 * rng.uniform_f32());
        for k in 0..8 {
            let s = k as f32 / 7.0;
            let dir = normal.lerp(lean, s).normalize();
            groom.points.push(0.05 * normal + dir * s * length);
            groom.widths.push(6e-5 * (1.0 - 0.8 * s * s));
        }
        groom.offsets.push(groom.points.len() as u32);
        groom.class.push(0);
        groom.id.push(i);
        groom.root_uv.push(glam::Vec2::ZERO);
        groom.length.push(length);
    }
    groom
}
