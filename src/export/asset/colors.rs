//! The color of a whole groom.

use super::color::Coats;
use crate::groom::Groom;
use crate::species::Species;
use glam::Vec3;

/// Color of a coat of such hair at every control point of a groom, linear Rec.709: what `displayColor`
/// has in a component asset.
pub fn colors(groom: &Groom, species: &Species) -> Vec<Vec3> {
    let classes = 0..species.classes.len();
    let coats: Vec<Coats> = classes.map(|i| Coats::new(species, i, None)).collect();
    let mut out = Vec::with_capacity(groom.points.len());
    for strand in 0..groom.strands() {
        // A groom has the classes of its species.
        let of = &coats[usize::from(groom.class[strand]).min(coats.len() - 1)];
        of.along(groom, strand, |dye| dye.color, &mut out);
    }
    out
}
