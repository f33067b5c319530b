//! Scene files: a picture as a small TOML file of the options of `vair render`, and lamps, which have none.

mod fields;

pub(crate) use fields::SCENE;

use crate::scene::{Environment, Lamp, LampShape};
use crate::species::build::{flag, number, numbers, tables};
use crate::species::check::{Checked, Value};
use crate::species::error::Problems;
use crate::species::recipe::{self, missing, need, text, word};
use crate::species::{SpeciesError, tree};
use crate::{color::Rgb, skin};
use std::path::Path;

/// Most overrides of a file.
const MOST_SETS: usize = 1000;

/// What a scene file says; `None` where it says nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneFile {
    /// A built-in species or the path of a species file.
    pub species: String,
    /// A built-in coat, the path of a recipe, or none.
    pub coat: Option<String>,
    /// All hair dyed to show this, linear Rec.709.
    pub color: Option<[f64; 3]>,
    /// Overrides of fields of the species.
    pub set: Vec<String>,
    /// A built-in skin or the path of a mesh.
    pub skin: Option<String>,
    /// `m`, `cm`, `mm` or `in`.
    pub skin_units: Option<&'static str>,
    /// `y` or `z`.
    pub skin_up: Option<&'static str>,
    /// Strands in all.
    pub strands: Option<u64>,
    /// Seed of fiber, fur and picture.
    pub seed: Option<u64>,
    /// A built-in environment or the path of a picture.
    pub env: Option<String>,
    /// Turn of the environment, degrees.
    pub env_turn: Option<f32>,
    /// Whether the environment is seen behind the subject.
    pub env_visible: Option<bool>,
    /// Whether there is a floor.
    pub ground: Option<bool>,
    /// Lamps, and whether the yaw of each counts from the camera.
    pub lamps: Vec<(Lamp, bool)>,
    /// Yaw and pitch of the camera, degrees.
    pub view: Option<[f32; 2]>,
    /// Field of view along the shorter side, degrees.
    pub fov: Option<f32>,
    /// 1 frames the subject.
    pub zoom: Option<f32>,
    /// Across and up, in radii of the subject.
    pub shift: Option<[f32; 2]>,
    /// Diameter of the lens, millimeters.
    pub lens: Option<f32>,
    /// Distance that is sharp, millimeters.
    pub focus: Option<f32>,
    /// Width and height of the picture.
    pub res: Option<[u32; 2]>,
    /// Samples a pixel.
    pub spp: Option<u32>,
    /// Name of the sampler.
    pub sampler: Option<&'static str>,
    /// Name of the pixel filter.
    pub filter: Option<&'static str>,
    /// Name of the view transform.
    pub look: Option<&'static str>,
    /// Stops.
    pub exposure: Option<f32>,
}

impl SceneFile {
    /// Reads the scene file of that name; `None` if it is none: no `.toml`, or without the key `species`, as
    /// species files are.
    ///
    /// # Errors
    /// Everything that is wrong with the file.
    pub fn read(name: &str) -> Result<Option<Self>, SpeciesError> {
        let path = Path::new(name);
        let is_toml = path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("toml"));
        if !is_toml {
            return Ok(None);
        }
        // Whoever reads species files says why one cannot be read; they may be longer than scenes.
        let Ok(text) = recipe::read(path) else {
            return Ok(None);
        };
        if !tree::parse(&text).is_ok_and(|root| root.get("species").is_some()) {
            return Ok(None);
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        let scene = recipe::parse(&text, name, &SCENE, |root, problems| {
            build(root, folder, problems)
        })?;
        Ok(Some(scene))
    }
}

fn build(root: &Checked, folder: &Path, problems: &mut Problems) -> Option<SceneFile> {
    let at = |file: String| folder.join(file).to_string_lossy().into_owned();
    // Names of what is built in are no paths.
    let unless = |names: &[&str], key: &str| {
        text(root, key).map(|name| match names.contains(&name.as_str()) {
            true => name,
            false => at(name),
        })
    };
    let recipe_at = |name: String| match name.ends_with(".toml") {
        true => at(name),
        false => name,
    };
    let real = |key: &str| number(root, key).map(|v| v as f32);
    let pair = |key: &str| {
        let values = numbers(root, key)?;
        Some([*values.first()?, *values.get(1)?])
    };
    let reals = |key: &str| pair(key).map(|p| p.map(|v| v as f32));
    let lamps = tables(root, "lamps").unwrap_or_default();
    Some(SceneFile {
        lamps: (lamps.iter())
            .filter_map(|table| lamp(table, problems))
            .collect(),
        species: recipe_at(text(root, "species")?),
        coat: text(root, "coat").map(recipe_at),
        color: numbers(root, "color").and_then(|color| color.try_into().ok()),
        set: match root.get("set").map(|i| &i.value) {
            Some(Value::Texts(texts)) => texts.clone(),
            _ => Vec::new(),
        },
        skin: unless(&skin::BUILT_IN, "skin"),
        skin_units: word(root, "skin_units"),
        skin_up: word(root, "skin_up"),
        strands: number(root, "strands").map(|v| v as u64),
        seed: number(root, "seed").map(|v| v as u64),
        env: unless(&Environment::BUILT_IN, "env"),
        env_turn: real("env_turn"),
        env_visible: flag(root, "env_visible"),
        ground: flag(root, "ground"),
        view: reals("view"),
        fov: real("fov"),
        zoom: real("zoom"),
        shift: reals("shift"),
        lens: real("lens"),
        focus: real("focus"),
        res: pair("res").map(|p| p.map(|v| v as u32)),
        spp: number(root, "spp").map(|v| v as u32),
        sampler: word(root, "sampler"),
        filter: word(root, "filter"),
        look: word(root, "look"),
        exposure: real("exposure"),
    })
}

fn lamp(table: &Checked, problems: &mut Problems) -> Option<(Lamp, bool)> {
    let shape = match word(table, "shape")? {
        "sun" => LampShape::Sun {
            diameter_deg: number(table, "diameter").unwrap_or(0.53) as f32,
        },
        kind => {
            let distance = need(table, "distance", problems);
            if kind == "rect" {
                if table.get("size").is_none() {
                    missing(table, "size", problems);
                }
                let size = numbers(table, "size")?;
                LampShape::Rect {
                    distance: distance? as f32,
                    size: [*size.first()? as f32, *size.get(1)? as f32],
                }
            } else {
                let (distance, radius) = (distance, need(table, "radius", problems)?);
                let distance = distance?;
                if radius >= distance {
                    let path = table.path_of("radius");
                    let message = format!("`{path}` is {radius}, expected less than the distance");
                    let hint = "the middle of the subject would be inside of the lamp".to_owned();
                    problems.push(
                        crate::species::build::place_of(table, "radius"),
                        message,
                        Some(hint),
                    );
                }
                LampShape::Sphere {
                    distance: distance as f32,
                    radius: radius as f32,
                }
            }
        }
    };
    let strength = number(table, "strength")? as f32;
    let color = match numbers(table, "color").as_deref() {
        Some(&[r, g, b]) => Rgb::new(r as f32, g as f32, b as f32),
        _ => Rgb::ONE,
    };
    let lamp = Lamp {
        shape,
        yaw_deg: number(table, "yaw")? as f32,
        pitch_deg: number(table, "pitch")? as f32,
        strength: strength * color,
    };
    Some((lamp, flag(table, "with_camera").unwrap_or(false)))
}

#[cfg(test)]
mod tests;
