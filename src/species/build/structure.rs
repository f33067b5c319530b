//! Stations: values from the station, else from the class's `structure`, else from the species'.

use super::{Reader, number, number_of, place_of, tables};
use crate::species::check::{Checked, Item, Value, join};
use crate::species::error::Place;
use crate::species::model::{Cortex, Cuticle, Margin, Section, Station, Structure};
use crate::species::pattern::{CuticlePattern, PatternLayout, recipe_of};

/// Index of air, for fibers without voids where nothing reads it.
pub(super) const AIR: f64 = 1.0003;

/// The free edge of a scale may stand out by this share of the thin radius; beyond it neighboring
/// scales of the far side would show through the section and the shape is no longer a fiber.
const HIGHEST_SCALE: f64 = 0.25;

/// Steepest scale, height over pitch (27 degrees). Measured tilts are 1 to 5 degrees.
const STEEPEST_SCALE: f64 = 0.5;

/// A table of a station together with the tables it inherits from, innermost first.
pub(super) struct Layers<'a> {
    pub(super) path: String,
    place: &'a Place,
    pub(super) tables: Vec<&'a Checked>,
}

impl<'a> Layers<'a> {
    pub(super) fn find(&self, key: &str) -> Option<&'a Item> {
        self.tables.iter().find_map(|t| t.get(key))
    }

    pub(super) fn is_misspelt(&self, key: &str) -> bool {
        self.tables.iter().any(|t| t.is_misspelt(key))
    }

    /// The path under which the value of `key` was written.
    pub(super) fn path_of(&self, key: &str) -> String {
        let table = self.tables.iter().find(|t| t.get(key).is_some());
        table.map_or_else(|| join(&self.path, key), |t| t.path_of(key))
    }

    /// Where the value of `key` was written.
    pub(super) fn place(&self, key: &str) -> &'a Place {
        self.find(key).map_or(self.place, |i| &i.place)
    }

    /// A number that may be left out.
    pub(super) fn number_or(&self, key: &str, default: f64) -> f64 {
        self.find(key).and_then(number_of).unwrap_or(default)
    }

    /// A word that may be left out.
    pub(super) fn word(&self, key: &str) -> Option<&'static str> {
        match self.find(key)?.value {
            Value::Choice(name) => Some(name),
            _ => None,
        }
    }

    /// The tables behind `key`.
    pub(super) fn inner(&self, key: &str) -> Self {
        let inner = |t: &&'a Checked| match t.get(key).map(|i| &i.value) {
            Some(Value::Table(table)) => Some(table),
            _ => None,
        };
        let tables: Vec<&Checked> = self.tables.iter().filter_map(inner).collect();
        Self {
            path: join(&self.path, key),
            place: tables
                .first()
                .filter(|t| t.path.starts_with(&self.path))
                .map_or(self.place, |t| &t.place),
            tables,
        }
    }
}

impl Reader<'_> {
    /// The stations of a class, ascending.
    pub(super) fn stations(
        &mut self,
        class: &Checked,
        shared: Option<&Checked>,
    ) -> Option<Vec<Station>> {
        let of_class = super::table(class, "structure");
        let stations = tables(class, "stations")?;
        let mut built = Vec::new();
        let mut before: Option<f64> = None;
        for station in stations {
            let layers = Layers {
                path: station.path.clone(),
                place: &station.place,
                tables: [Some(station), of_class, shared]
                    .into_iter()
                    .flatten()
                    .collect(),
            };
            let at = number(station, "at");
            if let (Some(at), Some(before)) = (at, before)
                && at <= before
            {
                let path = station.path_of("at");
                let message =
                    format!("`{path}` is {at}, expected more than {before} of the station before");
                let hint = "stations ascend from the root (0) to the tip (1)";
                self.conflict(place_of(station, "at"), message, hint);
            }
            before = at.or(before);
            let structure = self.structure(&layers);
            if let (Some(at), Some(structure)) = (at, structure) {
                built.push(Station { at, structure });
            }
        }
        (built.len() == stations.len()).then_some(built)
    }

    fn structure(&mut self, layers: &Layers<'_>) -> Option<Structure> {
        if layers.find("mesh").is_some() {
            return self.modeled(layers);
        }
        let diameter_um = self.layered(layers, "diameter_um");
        let aspect = self.layered(layers, "aspect");
        let ior = self.layered(layers, "ior");
        let thin_radius_um = diameter_um.zip(aspect).map(|(d, a)| 0.5 * d / a.sqrt());
        let cuticle = self
            .inner(layers, "cuticle")
            .and_then(|l| self.cuticle(&l, thin_radius_um));
        let medulla = self
            .inner(layers, "medulla")
            .and_then(|l| self.medulla(&l, thin_radius_um));
        let section = self.section(layers);
        let cortex = Self::cortex(&layers.inner("cortex"));
        let materials = ior
            .zip(medulla.as_ref())
            .and_then(|(ior, medulla)| self.materials(&layers.inner("materials"), ior, medulla));
        Some(Structure {
            diameter_um: diameter_um?,
            aspect: aspect?,
            section: section?,
            twist_turns_per_cm: layers.number_or("twist_turns_per_cm", 0.0),
            ior: ior?,
            cuticle: cuticle?,
            cortex,
            medulla: medulla?,
            materials: materials?,
            mesh: None,
        })
    }

    fn section(&mut self, layers: &Layers<'_>) -> Option<Section> {
        Some(match layers.word("section") {
            Some("superellipse") => Section::Superellipse {
                squareness: self.layered(layers, "squareness")?,
            },
            Some("dumb-bell") => Section::DumbBell,
            Some("concavo-convex") => Section::ConcavoConvex {
                bend: self.layered(layers, "bend")?,
            },
            Some("bean") => Section::Bean {
                dent: self.layered(layers, "dent")?,
            },
            _ => Section::Ellipse,
        })
    }

    fn cortex(layers: &Layers<'_>) -> Cortex {
        Cortex {
            toward_medulla: layers.number_or("toward_medulla", 0.0),
            clear_rim: layers.number_or("clear_rim", 0.0),
            streaks: layers.number_or("streaks", 0.0),
            fusi_per_mm: layers.number_or("fusi_per_mm", 0.0),
        }
    }

    fn cuticle(&mut self, layers: &Layers<'_>, thin_radius_um: Option<f64>) -> Option<Cuticle> {
        let roughness = self.layered(layers, "roughness");
        let pattern = self.pattern(layers)?;
        let CuticlePattern::Scales(recipe) = &pattern else {
            // Scales of no height: nothing reads the other numbers.
            return Some(Cuticle {
                roughness: roughness?,
                ..Cuticle::default()
            });
        };
        let tiled = recipe.layout != PatternLayout::Rows;
        let pitch_um = self.layered(layers, "pitch_um");
        let height_um = self.layered(layers, "height_um");
        let around = self.layered(layers, "around");
        let jitter = self.layered(layers, "jitter");
        let riser_roughness = self.layered(layers, "riser_roughness");
        let height_path = join(&layers.path, "height_um");
        if let (Some(height), Some(radius)) = (height_um, thin_radius_um)
            && height > HIGHEST_SCALE * radius
        {
            let message = format!(
                "`{height_path}` is {height}, expected at most {:.3} um: a quarter of the fiber's \
                 thin radius",
                HIGHEST_SCALE * radius
            );
            self.conflict(
                layers.place("height_um"),
                message,
                "lower the scales or widen the fiber",
            );
        }
        if let (Some(height), Some(pitch)) = (height_um, pitch_um)
            && height > STEEPEST_SCALE * pitch
        {
            let message = format!(
                "`{height_path}` is {height}, expected at most {} um: half of the pitch",
                STEEPEST_SCALE * pitch
            );
            self.conflict(
                layers.place("height_um"),
                message,
                "the scale tilt is atan(height / pitch)",
            );
        }
        if let Some(count) = around
            && tiled
            && count < 2.0
        {
            let path = join(&layers.path, "around");
            let message = format!("`{path}` is {count}, expected at least 2 tiles round the fiber");
            self.conflict(
                layers.place("around"),
                message,
                "one scale round the fiber is `coronal`",
            );
        }
        Some(Cuticle {
            pattern,
            pitch_um: pitch_um?,
            height_um: height_um?,
            around: around? as u32,
            jitter: jitter?,
            margin: match layers.word("margin") {
                Some("crenate") => Margin::Crenate,
                Some("rippled") => Margin::Rippled,
                Some("scalloped") => Margin::Scalloped,
                Some("dentate") => Margin::Dentate,
                _ => Margin::Smooth,
            },
            wear: layers.number_or("wear", 0.0),
            lifted: layers.number_or("lifted", 0.0),
            roughness: roughness?,
            riser_roughness: riser_roughness?,
        })
    }

    /// A built-in pattern, or the recipe in a file beside this one.
    fn pattern(&mut self, layers: &Layers<'_>) -> Option<CuticlePattern> {
        let item = layers.find("pattern");
        let Some(Value::Text(file)) = item.map(|i| &i.value) else {
            return CuticlePattern::built_in(self.choice(layers, "pattern")?);
        };
        let place = layers.place("pattern");
        let path = join(&layers.path, "pattern");
        match recipe_of(&self.folder.join(file)) {
            Ok((pattern, text)) => {
                self.recipes.insert(file.clone(), text);
                return Some(pattern);
            }
            Err(error) => self.refused_recipe(place, &path, "recipe", error),
        }
        None
    }

    pub(super) fn layered(&mut self, layers: &Layers<'_>, key: &str) -> Option<f64> {
        match layers.find(key) {
            Some(item) => number_of(item),
            None => {
                self.missing(layers, key);
                None
            }
        }
    }

    pub(super) fn choice(&mut self, layers: &Layers<'_>, key: &str) -> Option<&'static str> {
        match layers.find(key) {
            Some(item) => match item.value {
                Value::Choice(name) => Some(name),
                _ => None,
            },
            None => {
                self.missing(layers, key);
                None
            }
        }
    }

    /// The tables behind `key`, unless none states any.
    fn inner<'a>(&mut self, layers: &Layers<'a>, key: &str) -> Option<Layers<'a>> {
        if layers.find(key).is_none() {
            self.missing(layers, key);
            return None;
        }
        let inner = layers.inner(key);
        (!inner.tables.is_empty()).then_some(inner)
    }

    pub(super) fn missing(&mut self, layers: &Layers<'_>, key: &str) {
        if layers.is_misspelt(key) {
            return;
        }
        let message = format!("`{}` is missing", join(&layers.path, key));
        let hint = "state it here, or for all stations in the `structure` of the class or species";
        self.problems
            .push(layers.place, message, Some(hint.to_owned()));
    }
}
