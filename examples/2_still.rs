//! From a species to a picture, stage by stage: what `vair render` does.
//!
//! `cargo run --release --example 2_still -- out/still.png`

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
    let output = PathBuf::from(std::env::args().nth(1).unwrap_or("still.png".into()));
    let cancel = Cancel::default();
    let bear = species::load("polar-bear", &[])?;

    // Scattering: one table per class, station and pigment zone.
    let bake = Settings {
        photons: 1_000_000,
        ..Settings::cone()
    };
    let cache = Cache::of_user();
    let materials = assembly::materials(&bear, &bake, cache.as_ref(), &Silent, &cancel)?;

    // Fur on a ball.
    let ball = skin::load("ball")?;
    let settings = GroomSettings {
        strands: Some(40_000),
        seed: 1,
    };
    let groom = groom::grow(&ball, &bear, &settings, &Silent, &cancel)?;

    // Picture.
    let view = View::from_direction(ball.view);
    let scene = Scene::build(SceneParts {
        groom: &groom,
        materials,
        skin: Some((&ball, bear.skin_color.map(|c| c as f32).into())),
        environment: Environment::studio().turned(view.yaw_deg),
        lamps: &[],
        backdrop: Backdrop::default(),
        ground: None,
        view,
    })?;
    let job = RenderJob {
        resolution: [480, 360],
        spp: 16,
        ..RenderJob::default()
    };
    let film = job.run(&scene, &Silent, &cancel)?;
    image::write_film_png(&output, &film, &ViewTransform::default(), &[])?;
    println!("{}", output.display());
    Ok(())
}
