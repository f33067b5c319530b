//! How a hair class grows.

use super::{Reader, flag, number, numbers, place_of, table as table_of};
use crate::species::check::Checked;
use crate::species::model::{
    Arrangement, ClassGroom, Collision, Comb, HairClass, Pores, SharedGroom,
};
use crate::species::recipe::word;

/// A hair shorter than this many diameters is not a hair.
const SHORTEST: f64 = 20.0;

impl Reader<'_> {
    /// The groom of a class from its table.
    pub(super) fn groom(&mut self, table: &Checked) -> Option<ClassGroom> {
        self.length(table);
        self.profile(table);
        self.crimp(table);
        let vary = self.vary(table);
        Some(ClassGroom {
            density_per_cm2: number(table, "density_per_cm2")?,
            length_mm: number(table, "length_mm")?,
            length_sigma: number(table, "length_sigma")?,
            diameter_um: number(table, "diameter_um")?,
            diameter_sigma: number(table, "diameter_sigma")?,
            stalk: number(table, "stalk")?,
            shield: numbers(table, "shield")?.try_into().ok()?,
            taper_from: number(table, "taper_from")?,
            emergence_deg: number(table, "emergence_deg")?,
            bend_deg: number(table, "bend_deg")?,
            gravity: number(table, "gravity").unwrap_or(1.0),
            stray_deg: number(table, "stray_deg")?,
            roll_deg: number(table, "roll_deg").unwrap_or(90.0),
            crimp_mm: number(table, "crimp_mm")?,
            crimp_wavelength_mm: number(table, "crimp_wavelength_mm")?,
            curl_mm: number(table, "curl_mm").unwrap_or(0.0),
            curl_pitch_mm: number(table, "curl_pitch_mm").unwrap_or(10.0),
            frizz_mm: number(table, "frizz_mm").unwrap_or(0.0),
            trim_mm: number(table, "trim_mm").unwrap_or(f64::INFINITY),
            wet: number(table, "wet").unwrap_or(0.0),
            clump: number(table, "clump")?,
            clump_mm: number(table, "clump_mm")?,
            vary,
        })
    }

    /// What all classes share; what is refused is left out.
    ///
    /// * `classes`: those of the species, if all of them could be read.
    pub(super) fn shared_groom(
        &mut self,
        root: &Checked,
        classes: Option<&Vec<HairClass>>,
    ) -> SharedGroom {
        let Some(groom) = table_of(root, "groom") else {
            return SharedGroom::default();
        };
        SharedGroom {
            comb: table_of(groom, "comb").map_or_else(Comb::default, |comb| self.comb(comb)),
            pores: table_of(groom, "pores").and_then(|pores| self.pores(pores, classes)),
            keep_widths: flag(groom, "keep_widths").unwrap_or(false),
            symmetry: number(groom, "symmetry").unwrap_or(0.0),
            collision: match word(groom, "collision") {
                Some("exact") => Collision::Exact,
                _ => Collision::Near,
            },
        }
    }

    fn pores(&mut self, table: &Checked, classes: Option<&Vec<HairClass>>) -> Option<Pores> {
        let density_per_cm2 = number(table, "density_per_cm2");
        let hairs = classes.map_or(f64::INFINITY, |classes| {
            classes.iter().map(|c| c.groom.density_per_cm2).sum()
        });
        if let Some(density) = density_per_cm2
            && density > hairs
        {
            let path = table.path_of("density_per_cm2");
            let message = format!("`{path}` is {density}, expected at most {hairs}: all hairs");
            let hint = "each group has a hair";
            self.conflict(place_of(table, "density_per_cm2"), message, hint);
        }
        Some(Pores {
            density_per_cm2,
            spread_mm: number(table, "spread_mm")?,
            arrangement: match word(table, "arrangement") {
                Some("row") => Arrangement::Row,
                _ => Arrangement::Cluster,
            },
            uneven: number(table, "uneven").unwrap_or(0.3),
        })
    }

    fn length(&mut self, table: &Checked) {
        let (Some(length), Some(diameter)) =
            (number(table, "length_mm"), number(table, "diameter_um"))
        else {
            return;
        };
        let least = SHORTEST * diameter * 1e-3;
        if length < least {
            let path = table.path_of("length_mm");
            let message = format!(
                "`{path}` is {length}, expected at least {least:.3} mm: {SHORTEST} times the diameter"
            );
            self.conflict(
                place_of(table, "length_mm"),
                message,
                "lengths are in mm, diameters in um",
            );
        }
    }

    fn profile(&mut self, table: &Checked) {
        let Some(shield) = numbers(table, "shield") else {
            return;
        };
        let (Some(from), Some(to)) = (shield.first(), shield.get(1)) else {
            return;
        };
        if from >= to {
            let path = table.path_of("shield");
            let message = format!("`{path}` is [{from}, {to}], expected two ascending numbers");
            let hint = "where the stalk begins to widen, and where it is widest";
            self.conflict(place_of(table, "shield"), message, hint);
        }
        if let Some(taper) = number(table, "taper_from")
            && taper < *to
        {
            let path = table.path_of("taper_from");
            let message = format!("`{path}` is {taper}, expected at least the shield's {to}");
            let hint = "the tip tapers from the widest place on";
            self.conflict(place_of(table, "taper_from"), message, hint);
        }
    }

    fn crimp(&mut self, table: &Checked) {
        let (Some(amplitude), Some(wavelength)) = (
            number(table, "crimp_mm"),
            number(table, "crimp_wavelength_mm"),
        ) else {
            return;
        };
        if amplitude > 0.5 * wavelength {
            let path = table.path_of("crimp_mm");
            let message = format!(
                "`{path}` is {amplitude}, expected at most {} mm: half of the wavelength",
                0.5 * wavelength
            );
            let hint = "steeper waves would cross themselves";
            self.conflict(place_of(table, "crimp_mm"), message, hint);
        }
    }
}
