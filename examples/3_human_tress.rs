//! Figure 5 of the paper: a tress of human hair at 1024 x 768, the fiber a smooth cylinder of
//! index 1.5.
//!
//! `cargo run --release --example 3_human_tress -- tress.png`

use std::error::Error;
use std::path::PathBuf;
use vair::assembly;
use vair::bake::{Cache, Settings};
use vair::groom::{self, GroomSettings};
use vair::image::{self, ViewTransform};
use vair::progress::{Cancel, Silent};
use vair::render::RenderJob;
use vair::scene::{Backdrop, Environment, Scene, SceneParts, View};
use vair::{skin, species};

fn main() -> Result<(), Box<dyn Error>> {
    let output = PathBuf::from(std::env::args().nth(1).unwrap_or("tress.png".into()));
    let cancel = Cancel::default();
    // A smooth cylinder, and hair light enough that the inside of the fiber shows.
    let overrides = [
        "structure.ior=1.5",
        "guard.stations.0.aspect=1",
        "guard.stations.0.cuticle.pattern=smooth",
        "guard.pigment.0.eumelanin=0.5",
        "guard.groom.stray_deg=4",
    ];
    let human = species::load("human", &overrides.map(String::from))?;

    let bake = Settings {
        photons: 4_000_000,
        ..Settings::cone()
    };
    let cache = Cache::of_user();
    let materials = assembly::materials(&human, &bake, cache.as_ref(), &Silent, &cancel)?;

    let tress = skin::load("tress")?;
    let groom = groom::grow(&tress, &human, &GroomSettings::default(), &Silent, &cancel)?;
    // Light from 42 degrees above: seen from as much below, the cones of R and TRT come to the eye.
    let view = View {
        yaw_deg: 20.0,
        pitch_deg: -24.0,
        zoom: 1.3,
        ..View::default()
    };
    let scene = Scene::build(SceneParts {
        groom: &groom,
        materials,
        skin: Some((&tress, human.skin_color.map(|c| c as f32).into())),
        environment: Environment::studio().turned(view.yaw_deg),
        lamps: &[],
        backdrop: Backdrop::default(),
        ground: None,
        view,
    })?;
    let job = RenderJob {
        resolution: [1024, 768],
        spp: 32,
        ..RenderJob::default()
    };
    let film = job.run(&scene, &Silent, &cancel)?;
    let transform = ViewTransform {
        exposure_ev: -0.4,
        ..ViewTransform::default()
    };
    image::write_film_png(&output, &film, &transform, &[])?;
    println!("{} strands, {}", groom.strands(), output.display());
    Ok(())
}
