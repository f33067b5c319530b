//! Fur in the studio: a piece of it, or a whole animal in its coat.

use super::{GalleryError, Studio};
use crate::assembly;
use crate::groom::{self, GroomSettings};
use crate::image::{Canvas, ViewTransform, denoise};
use crate::progress::Silent;
use crate::render::{RenderJob, Sampler};
use crate::scene::{Backdrop, Environment, Scene, SceneParts, View};
use crate::skin;
use crate::species::Species;
use glam::Vec3;

/// Even, or a palette of few colors shows steps in it.
const BACKDROP: Vec3 = Vec3::splat(0.2);

/// What stands in the studio.
pub(super) struct Model {
    /// A built-in skin.
    pub(super) skin: &'static str,
    /// 1 shows all of it.
    pub(super) zoom: f32,
    /// Strands over those of a swatch.
    pub(super) strands: usize,
    /// Reflectance of a floor.
    pub(super) ground: Option<f32>,
}

/// A piece of fur.
pub(super) const SWATCH: Model = Model {
    skin: "swatch",
    zoom: 1.5,
    strands: 1,
    ground: None,
};

pub(super) fn draw(
    studio: &Studio,
    species: &Species,
    model: &Model,
    (width, height): (usize, usize),
) -> Result<Canvas, GalleryError> {
    let cancel = studio.cancel;
    let bake = studio.bake();
    let materials = assembly::materials(species, &bake, studio.cache, &Silent, cancel)?;
    let skin = skin::load(model.skin)?;
    let settings = GroomSettings {
        strands: Some(model.strands * studio.quality.strands),
        seed: 0,
    };
    // How many there are is chosen for the look that they have at the width an opaque coat needs.
    let mut kept = species.clone();
    kept.groom.keep_widths = true;
    let groom = groom::grow(&skin, &kept, &settings, &Silent, cancel)?;
    let view = View {
        zoom: model.zoom,
        ..View::from_direction(skin.view)
    };
    let color = Vec3::from_array(species.skin_color.map(|c| c as f32));
    let scene = Scene::build(SceneParts {
        groom: &groom,
        materials,
        skin: Some((&skin, color)),
        environment: Environment::studio().turned(view.yaw_deg),
        lamps: &[],
        backdrop: Backdrop::Plain(BACKDROP),
        ground: model.ground,
        view,
    })?;
    let job = RenderJob {
        resolution: [width as u32, height as u32],
        crop: None,
        spp: studio.quality.swatch,
        seed: 0,
        sampler: Sampler::Qsir,
        ..RenderJob::default()
    };
    let film = job.run(&scene, &Silent, cancel)?;
    if !film.report.complete {
        return Err(GalleryError::Stopped);
    }
    let transform = ViewTransform::default();
    let mut canvas = Canvas::new(width, height, Vec3::ZERO);
    for (i, pixel) in denoise(&film).pixels.iter().enumerate() {
        canvas.set(i % width, i / width, transform.display(pixel.radiance));
    }
    Ok(canvas)
}
