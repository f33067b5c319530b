//! The color of a whole groom.

use super::color::Zones;
use crate::groom::Groom;
use crate::species::Species;
use glam::Vec3;

/// Color of a coat of such hair at every control point of a groom, linear Rec.709: what `displayColor`
/// has in a component asset.
pub fn colors(groom: &Groom, species: &Species) -> Vec<Vec3> {
    // Of each class, for each part of the coat's pattern.
    let zones: Vec<Vec<Zones>> = (species.classes.iter().enumerate())
        .map(|(i, class)| {
            let parts = species.pigments(i);
            let zones = parts.iter().map(|part| Zones::new(class, part, None));
            zones.collect()
        })
        .collect();
    let mut out = Vec::with_capacity(groom.points.len());
    for strand in 0..groom.strands() {
        // A groom has the classes of its species; there are parts in each.
        let parts = &zones[usize::from(groom.class[strand]).min(zones.len() - 1)];
        let of = &parts[usize::from(groom.coat[strand]).min(parts.len() - 1)];
        of.along(groom, strand, |dye| dye.color, &mut out);
    }
    out
}
