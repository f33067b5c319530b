//! Materials of the parts: from checked values, with the rules that join them.

use super::structure::Layers;
use super::{Reader, number_of};
use crate::species::check::{Item, Value};
use crate::species::model::{Medulla, MedullaKind};
use crate::species::spectrum::{self, Constants};
use crate::species::{Boundary, Filling, Material, Materials, Rgb};

/// Range of the index of what light travels in.
const CLEAR_INDEX: std::ops::RangeInclusive<f64> = 1.0..=3.0;

/// Keys of what fills a part.
const FILLING: [&str; 3] = ["absorption_per_um", "scattering_per_um", "asymmetry"];

impl Reader<'_> {
    /// * `layers`: those of the `materials` tables; `ior`: index of cuticle and cortex.
    pub(super) fn materials(
        &mut self,
        layers: &Layers<'_>,
        ior: f64,
        medulla: &Medulla,
    ) -> Option<Materials> {
        let riser = layers.inner("riser");
        self.match_the_fiber(layers, medulla);
        Some(Materials {
            cuticle: self.material(&layers.inner("cuticle"), ior)?,
            riser: match riser.find("boundary") {
                Some(_) => Some(self.material(&riser, ior)?.boundary),
                None => {
                    self.idle_without_boundary(&riser);
                    None
                }
            },
            cortex: self.material(&layers.inner("cortex"), ior)?,
            medulla: self.material(&layers.inner("medulla"), ior)?,
            void: self.material(&layers.inner("void"), ior)?,
        })
    }

    /// Materials for parts that the fiber does not have.
    fn match_the_fiber(&mut self, layers: &Layers<'_>, medulla: &Medulla) {
        let cuticle = layers.inner("cuticle");
        let metal = cuticle.word("boundary") == Some("metal");
        for key in FILLING.iter().chain(&["index", "index_file"]) {
            if cuticle.find(key).is_some() && !(metal && key.starts_with("index")) {
                let message = format!(
                    "`{}` is what fills a cuticle, and here the cortex reaches to the surface",
                    cuticle.path_of(key)
                );
                self.conflict_once(cuticle.place(key), message, "write it into the cortex");
            }
        }
        let cortex = layers.inner("cortex");
        if cortex.find("boundary").is_some() {
            let message = format!(
                "`{}` is a boundary that the fiber does not have: the cortex reaches to the surface",
                cortex.path_of("boundary")
            );
            let hint = "the surface is the cuticle's";
            self.conflict_once(cortex.place("boundary"), message, hint);
        }
        // Outer tables may speak for stations of several kinds.
        let absent = match medulla.kind {
            MedullaKind::None => ["medulla", "void"].as_slice(),
            MedullaKind::Medium { .. } => &["void"],
            _ => &["medulla"],
        };
        for part in absent {
            let inner = layers.inner(part);
            if let Some(table) = inner.tables.iter().find(|t| t.path == inner.path) {
                let message = format!(
                    "`{}` has no meaning with a medulla of kind {}",
                    inner.path,
                    medulla.kind.name()
                );
                let hint = "voids are made of `void`, a medulla of kind medium of `medulla`";
                self.conflict_once(&table.place, message, hint);
            }
        }
    }

    fn material(&mut self, layers: &Layers<'_>, ior: f64) -> Option<Material> {
        let constants = self.index_file(layers)?;
        let boundary = match layers.word("boundary") {
            Some("slab") => Boundary::Slab {
                layers: self.needed(layers, "layers").and_then(number_of)?,
                index: color(layers, "layer_index").unwrap_or([ior; 3]),
            },
            Some("diffuse") => {
                self.needed(layers, "albedo")?;
                Boundary::Diffuse {
                    albedo: color(layers, "albedo")?,
                }
            }
            Some("metal") => self.metal(layers, constants)?,
            Some(_) => Boundary::Dielectric,
            None => {
                self.idle_without_boundary(layers);
                Boundary::Dielectric
            }
        };
        // The index of a metal is that of the boundary.
        let (index, absorption) = if matches!(boundary, Boundary::Metal { .. }) {
            (None, [0.0; 3])
        } else {
            self.clear_index(layers, constants);
            let index = color(layers, "index").or(constants.map(|c| c.index));
            (index, constants.map_or([0.0; 3], |c| c.absorption_per_um))
        };
        let filling = Filling {
            index,
            absorption_per_um: color(layers, "absorption_per_um").unwrap_or(absorption),
            scattering_per_um: color(layers, "scattering_per_um"),
            asymmetry: layers.find("asymmetry").and_then(number_of),
        };
        Some(Material {
            boundary,
            roughness: layers.find("roughness").and_then(number_of),
            filling,
        })
    }

    fn metal(&mut self, layers: &Layers<'_>, constants: Option<Constants>) -> Option<Boundary> {
        let (index, extinction) = (color(layers, "index"), color(layers, "extinction"));
        let named = layers.word("metal").and_then(spectrum::metal);
        let given = usize::from(named.is_some())
            + usize::from(constants.is_some())
            + usize::from(index.is_some() || extinction.is_some());
        if given != 1 {
            let message = format!(
                "`{}` is metal, expected one of `metal`, `index_file`, or `index` with `extinction`",
                layers.path_of("boundary")
            );
            let hint = "for example metal = \"gold\"";
            self.conflict_once(layers.place("boundary"), message, hint);
            return None;
        }
        if let Some(constants) = named.or(constants) {
            return Some(Boundary::Metal {
                index: constants.index,
                extinction: constants.extinction,
            });
        }
        self.needed(layers, "index")?;
        self.needed(layers, "extinction")?;
        Some(Boundary::Metal {
            index: index?,
            extinction: extinction?,
        })
    }

    /// Light has to travel in it: metals are for boundaries.
    fn clear_index(&mut self, layers: &Layers<'_>, constants: Option<Constants>) {
        if layers.is_misspelt("boundary") {
            return;
        }
        for (key, index) in [
            ("index", color(layers, "index")),
            ("index_file", constants.map(|c| c.index)),
        ] {
            let out = index.and_then(|rgb| rgb.into_iter().find(|n| !CLEAR_INDEX.contains(n)));
            if let Some(n) = out {
                let message = format!(
                    "`{}` is {n}, expected 1 to 3 for what light travels in",
                    layers.path_of(key)
                );
                let hint = "a metal needs boundary = \"metal\"";
                self.conflict_once(layers.place(key), message, hint);
            }
        }
        if constants.is_some() && layers.find("index").is_some() {
            let message = format!(
                "`{}` stands beside `index_file`, expected one of the two",
                layers.path_of("index")
            );
            self.conflict_once(layers.place("index"), message, "take one of them out");
        }
    }

    /// `Some(None)` without a file, `None` if it was refused.
    #[allow(clippy::option_option, reason = "absent is not refused")]
    fn index_file(&mut self, layers: &Layers<'_>) -> Option<Option<Constants>> {
        let Some(item) = layers.find("index_file") else {
            return Some(None);
        };
        let Value::Text(name) = &item.value else {
            return None;
        };
        match spectrum::read(&self.folder.join(name)) {
            Ok(constants) => Some(Some(constants)),
            Err(what) => {
                let path = layers.path_of("index_file");
                let message = format!("`{path}` is no table of a refractive index: {what}");
                let hint = "lines of `wavelength, n` or `wavelength, n, k`, in nm or um, ascending";
                self.conflict_once(&item.place, message, hint);
                None
            }
        }
    }

    /// Keys that only have a meaning with a `boundary`.
    fn idle_without_boundary(&mut self, layers: &Layers<'_>) {
        if layers.is_misspelt("boundary") {
            return;
        }
        for key in ["layers", "layer_index", "albedo", "metal", "extinction"] {
            if let Some(item) = layers.find(key) {
                let path = layers.path_of(key);
                let message = format!("`{path}` has no meaning without a `boundary`");
                let hint = "add boundary = \"slab\", \"diffuse\" or \"metal\"";
                self.conflict_once(&item.place, message, hint);
            }
        }
    }

    fn needed<'a>(&mut self, layers: &Layers<'a>, key: &str) -> Option<&'a Item> {
        let found = layers.find(key);
        if found.is_none() && !layers.is_misspelt(key) {
            let message = format!("`{}` is missing", layers.path_of(key));
            let hint = "this boundary needs it";
            self.conflict_once(layers.place("boundary"), message, hint);
        }
        found
    }
}

/// A color: a number for all channels or three.
fn color(layers: &Layers<'_>, key: &str) -> Option<Rgb> {
    match &layers.find(key)?.value {
        Value::Number(number) => Some([*number; 3]),
        Value::Numbers(numbers) => numbers.clone().try_into().ok(),
        _ => None,
    }
}
