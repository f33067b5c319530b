//! Where the pigment is.

use crate::species::{HairClass, Station};
use glam::DVec3;

/// Absorption of the cortex per micrometer for linear R, G, B where a station is: its band, or a
/// mixture of two within their transition.
pub fn absorption_at(class: &HairClass, station: &Station) -> [f64; 3] {
    let tip_mm = (1.0 - station.at) * class.groom.length_mm;
    let bands = &class.pigment;
    let mut index = 0;
    while index + 1 < bands.len() && tip_mm > bands[index].to_mm {
        index += 1;
    }
    // Share of the neighbor: one half at the border, none half a transition away from it.
    let share = |border: f64, softness: f64| {
        let gap = (tip_mm - border).abs();
        if gap < 0.5 * softness {
            0.5 - gap / softness
        } else {
            0.0
        }
    };
    let mut neighbor = (index, 0.0);
    if index + 1 < bands.len() {
        let band = &bands[index];
        neighbor = (index + 1, share(band.to_mm, band.softness_mm));
    }
    if index > 0 && neighbor.1 == 0.0 {
        let band = &bands[index - 1];
        neighbor = (index - 1, share(band.to_mm, band.softness_mm));
    }
    let here = bands[index].absorption_per_um();
    let there = bands[neighbor.0].absorption_per_um();
    std::array::from_fn(|c| here[c] + neighbor.1 * (there[c] - here[c]))
}

/// Keratin without pigment in white light, linear: faintly yellow.
const KERATIN: DVec3 = DVec3::new(0.86, 0.79, 0.66);

/// What is left of white light behind a slice of keratin.
///
/// * `thickness_um`: of the slice, times the density of the pigment in it.
pub(super) fn keratin(absorption_per_um: [f64; 3], thickness_um: f64) -> DVec3 {
    let left = absorption_per_um.map(|a| (-a * thickness_um).exp());
    KERATIN * DVec3::from_array(left)
}
