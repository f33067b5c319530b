//! The core: its kind and the numbers of it.

use super::structure::{AIR, Layers};
use super::{Reader, number};
use crate::species::check::join;
use crate::species::model::{Continuity, Medulla, MedullaKind};

impl Reader<'_> {
    pub(super) fn medulla(
        &mut self,
        layers: &Layers<'_>,
        thin_radius_um: Option<f64>,
    ) -> Option<Medulla> {
        let kind = self.choice(layers, "kind")?;
        let ratio_path = join(&layers.path, "ratio");
        if kind == "none" {
            // A ratio from an outer table is for the stations that have a medulla.
            let here = layers.tables.iter().find(|t| t.get("kind").is_some());
            let ratio = here.and_then(|t| number(t, "ratio"));
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
            return Some(Medulla::default());
        }
        let ratio = self.layered(layers, "ratio");
        let pigment = self.layered(layers, "pigment");
        if ratio == Some(0.0) {
            let message = format!("`{ratio_path}` is 0, expected more with a medulla of {kind}");
            self.conflict(layers.place("ratio"), message, "or set `kind` to \"none\"");
        }
        let radius_um = thin_radius_um.zip(ratio).map(|(r, m)| r * m);
        let void_ior = if kind == "medium" {
            Some(AIR)
        } else {
            self.layered(layers, "void_ior")
        };
        let kind = match kind {
            "ladder" => self.ladder(layers),
            "multiserial" => self.multiserial(layers),
            "lattice" => self.lattice(layers),
            "s-channel" => self
                .layered(layers, "pitch_um")
                .map(|pitch_um| MedullaKind::SChannel { pitch_um }),
            "cloisonne" => self.cloisonne(layers),
            "tire-tread" => self.tire_tread(layers),
            "globules" => self.globules(layers),
            "amorphous" => self.amorphous(layers),
            "froth" => self.froth(layers, radius_um),
            _ => self.medium(layers),
        };
        Some(Medulla {
            ratio: ratio?,
            kind: kind?,
            continuity: match layers.word("continuity") {
                Some("interrupted") => Continuity::Interrupted,
                Some("fragmentary") => Continuity::Fragmentary,
                _ => Continuity::Continuous,
            },
            void_ior: void_ior?,
            pigment: pigment?,
        })
    }

    fn ladder(&mut self, layers: &Layers<'_>) -> Option<MedullaKind> {
        let pitch_um = self.layered(layers, "pitch_um");
        let septum_um = self.part_of(layers, "septum_um", pitch_um, "pitch");
        Some(MedullaKind::Ladder {
            pitch_um: pitch_um?,
            septum_um: septum_um?,
        })
    }

    fn multiserial(&mut self, layers: &Layers<'_>) -> Option<MedullaKind> {
        let cell_um = self.layered(layers, "cell_um");
        let pitch_um = self.layered(layers, "pitch_um");
        let least = cell_um.zip(pitch_um).map(|(c, p)| c.min(p));
        let septum_um = self.part_of(layers, "septum_um", least, "cell");
        Some(MedullaKind::Multiserial {
            cell_um: cell_um?,
            pitch_um: pitch_um?,
            septum_um: septum_um?,
        })
    }

    fn lattice(&mut self, layers: &Layers<'_>) -> Option<MedullaKind> {
        let cell_um = self.layered(layers, "cell_um");
        let wall_um = self.part_of(layers, "wall_um", cell_um, "cell");
        Some(MedullaKind::Lattice {
            cell_um: cell_um?,
            wall_um: wall_um?,
        })
    }

    fn cloisonne(&mut self, layers: &Layers<'_>) -> Option<MedullaKind> {
        let columns = self.layered(layers, "columns");
        let pitch_um = self.layered(layers, "pitch_um");
        let height_um = self.part_of(layers, "height_um", pitch_um, "pitch");
        Some(MedullaKind::Cloisonne {
            columns: columns? as u32,
            pitch_um: pitch_um?,
            height_um: height_um?,
        })
    }

    fn tire_tread(&mut self, layers: &Layers<'_>) -> Option<MedullaKind> {
        let pitch_um = self.layered(layers, "pitch_um");
        let cell_um = self.layered(layers, "cell_um");
        let least = cell_um.zip(pitch_um).map(|(c, p)| c.min(p));
        let septum_um = self.part_of(layers, "septum_um", least, "cell");
        Some(MedullaKind::TireTread {
            pitch_um: pitch_um?,
            cell_um: cell_um?,
            septum_um: septum_um?,
        })
    }

    fn globules(&mut self, layers: &Layers<'_>) -> Option<MedullaKind> {
        let spacing = self.layered(layers, "spacing");
        let film_um = self.layered(layers, "film_um");
        Some(MedullaKind::Globules {
            spacing: spacing?,
            film_um: film_um?,
        })
    }

    fn amorphous(&mut self, layers: &Layers<'_>) -> Option<MedullaKind> {
        let radius_um = self.layered(layers, "radius_um");
        let air_fraction = self.layered(layers, "air_fraction");
        Some(MedullaKind::Amorphous {
            radius_um: radius_um?,
            air_fraction: air_fraction?,
        })
    }

    /// A length that must be less than `whole`.
    fn part_of(
        &mut self,
        layers: &Layers<'_>,
        key: &str,
        whole: Option<f64>,
        name: &str,
    ) -> Option<f64> {
        let part = self.layered(layers, key)?;
        if let Some(whole) = whole
            && part >= whole
        {
            let path = join(&layers.path, key);
            let message =
                format!("`{path}` is {part}, expected less than the {name} of {whole} um");
            let hint = format!("the rest of the {name} is the void");
            self.conflict(layers.place(key), message, &hint);
        }
        Some(part)
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

    pub(super) fn medium(&mut self, layers: &Layers<'_>) -> Option<MedullaKind> {
        let scattering_per_um = self.layered(layers, "scattering_per_um");
        let asymmetry = self.layered(layers, "asymmetry");
        Some(MedullaKind::Medium {
            scattering_per_um: scattering_per_um?,
            asymmetry: asymmetry?,
        })
    }
}
