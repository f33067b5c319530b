//! Stations: values from the station, else from the class's `structure`, else from the species'.

use super::{Reader, number, number_of, place_of, tables};
use crate::species::check::{Checked, Item, Value, join};
use crate::species::error::Place;
use crate::species::model::{Cuticle, CuticlePattern, Medulla, MedullaKind, Station, Structure};

/// Index of air, for fibers without voids where nothing reads it.
const AIR: f64 = 1.0003;

/// The free edge of a scale may stand out by this share of the thin radius; beyond it neighboring
/// scales of the far side would show through the section and the shape is no longer a fiber.
const HIGHEST_SCALE: f64 = 0.25;

/// Steepest scale, height over pitch (27 degrees). Measured tilts are 1 to 5 degrees.
const STEEPEST_SCALE: f64 = 0.5;

/// A table of a station together with the tables it inherits from, innermost first.
struct Layers<'a> {
    path: String,
    place: &'a Place,
    tables: Vec<&'a Checked>,
}

impl<'a> Layers<'a> {
    fn find(&self, key: &str) -> Option<&'a Item> {
        self.tables.iter().find_map(|t| t.get(key))
    }

    fn is_misspelt(&self, key: &str) -> bool {
        self.tables.iter().any(|t| t.is_misspelt(key))
    }

    /// Where the value of `key` was written.
    fn place(&self, key: &str) -> &'a Place {
        self.find(key).map_or(self.place, |i| &i.place)
    }

    /// The tables behind `key`.
    fn inner(&self, key: &str) -> Self {
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
        Some(Structure {
            diameter_um: diameter_um?,
            aspect: aspect?,
            ior: ior?,
            cuticle: cuticle?,
            medulla: medulla?,
        })
    }

    fn cuticle(&mut self, layers: &Layers<'_>, thin_radius_um: Option<f64>) -> Option<Cuticle> {
        let roughness = self.layered(layers, "roughness");
        let pattern = match self.choice(layers, "pattern")? {
            "coronal" => CuticlePattern::Coronal,
            "irregular-wave" => CuticlePattern::IrregularWave,
            "mosaic" => CuticlePattern::Mosaic,
            "diamond-petal" => CuticlePattern::DiamondPetal,
            _ => {
                // Scales of no height: nothing reads the other numbers.
                return Some(Cuticle {
                    pattern: CuticlePattern::Smooth,
                    pitch_um: 10.0,
                    height_um: 0.0,
                    around: 1,
                    jitter: 0.0,
                    roughness: roughness?,
                    riser_roughness: 0.0,
                });
            }
        };
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
        let tiled = matches!(
            pattern,
            CuticlePattern::Mosaic | CuticlePattern::DiamondPetal
        );
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
            roughness: roughness?,
            riser_roughness: riser_roughness?,
        })
    }

    fn medulla(&mut self, layers: &Layers<'_>, thin_radius_um: Option<f64>) -> Option<Medulla> {
        let kind = self.choice(layers, "kind")?;
        let ratio_path = join(&layers.path, "ratio");
        if kind == "none" {
            let ratio = layers.find("ratio").and_then(number_of);
            if let Some(ratio) = ratio
                && ratio != 0.0
            {
                let message = format!("`{ratio_path}` is {ratio}, expected 0 without a medulla");
                self.conflict(
                    layers.place("ratio"),
                    message,
                    "choose a `kind` or set the ratio to 0",
                );
            }
            return Some(Medulla {
                ratio: 0.0,
                kind: MedullaKind::None,
                void_ior: AIR,
                pigment: 1.0,
            });
        }
        let ratio = self.layered(layers, "ratio");
        let pigment = self.layered(layers, "pigment");
        if ratio == Some(0.0) {
            let message = format!("`{ratio_path}` is 0, expected more with a medulla of {kind}");
            self.conflict(layers.place("ratio"), message, "or set `kind` to \"none\"");
        }
        let radius_um = thin_radius_um.zip(ratio).map(|(r, m)| r * m);
        let (kind, void_ior) = match kind {
            "ladder" => (self.ladder(layers), self.layered(layers, "void_ior")),
            "froth" => (
                self.froth(layers, radius_um),
                self.layered(layers, "void_ior"),
            ),
            _ => (self.medium(layers), Some(AIR)),
        };
        Some(Medulla {
            ratio: ratio?,
            kind: kind?,
            void_ior: void_ior?,
            pigment: pigment?,
        })
    }

    fn ladder(&mut self, layers: &Layers<'_>) -> Option<MedullaKind> {
        let pitch_um = self.layered(layers, "pitch_um");
        let septum_um = self.layered(layers, "septum_um");
        let (pitch_um, septum_um) = (pitch_um?, septum_um?);
        if septum_um >= pitch_um {
            let path = join(&layers.path, "septum_um");
            let message =
                format!("`{path}` is {septum_um}, expected less than the pitch of {pitch_um} um");
            self.conflict(
                layers.place("septum_um"),
                message,
                "the rest of the pitch is the void",
            );
        }
        Some(MedullaKind::Ladder {
            pitch_um,
            septum_um,
        })
    }

    fn froth(&mut self, layers: &Layers<'_>, medulla_um: Option<f64>) -> Option<MedullaKind> {
        let radius_um = self.layered(layers, "radius_um");
        let radius_sigma = self.layered(layers, "radius_sigma");
        let air_fraction = self.layered(layers, "air_fraction");
        if let (Some(radius), Some(medulla)) = (radius_um, medulla_um)
            && medulla > 0.0
            && radius >= medulla
        {
            let path = join(&layers.path, "radius_um");
            let message = format!(
                "`{path}` is {radius}, expected less than the medulla's thin radius of {medulla:.3} um"
            );
            self.conflict(
                layers.place("radius_um"),
                message,
                "voids lie inside the medulla",
            );
        }
        Some(MedullaKind::Froth {
            radius_um: radius_um?,
            radius_sigma: radius_sigma?,
            air_fraction: air_fraction?,
        })
    }

    fn medium(&mut self, layers: &Layers<'_>) -> Option<MedullaKind> {
        let scattering_per_um = self.layered(layers, "scattering_per_um");
        let asymmetry = self.layered(layers, "asymmetry");
        Some(MedullaKind::Medium {
            scattering_per_um: scattering_per_um?,
            asymmetry: asymmetry?,
        })
    }

    fn layered(&mut self, layers: &Layers<'_>, key: &str) -> Option<f64> {
        match layers.find(key) {
            Some(item) => number_of(item),
            None => {
                self.missing(layers, key);
                None
            }
        }
    }

    fn choice(&mut self, layers: &Layers<'_>, key: &str) -> Option<&'static str> {
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

    fn missing(&mut self, layers: &Layers<'_>, key: &str) {
        if layers.is_misspelt(key) {
            return;
        }
        let message = format!("`{}` is missing", join(&layers.path, key));
        let hint = "state it here, or for all stations in the `structure` of the class or species";
        self.problems
            .push(layers.place, message, Some(hint.to_owned()));
    }
}
