//! Which scattering applies where along a strand.

use super::{Bsdf, Chiang, DoubleCylinder};
use crate::color::Rgb;
use crate::table::ScatterTable;
use glam::Vec3;

/// The scattering of one hair class along its strands.
#[derive(Clone, Debug)]
pub enum HairMaterial {
    /// The same closed-form scattering everywhere.
    Isotropic(Rgb),
    /// Baked tables at stations along the hair, dyed for zones of pigment.
    Tables(TableSet),
    /// The model of Chiang et al. 2016 for the same.
    Chiang(AlongStrand<Chiang>),
    /// A double cylinder after Yan et al. 2015 for the same.
    DoubleCylinder(AlongStrand<DoubleCylinder>),
}

/// Where a zone of pigment ends, counted from the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zone {
    /// End of the zone, millimeters from the tip; infinity for the last.
    pub to_mm: f32,
    /// Width of the transition to the next zone, millimeters.
    pub softness_mm: f32,
}

/// What differs along the strands of one hair class: tables, or the numbers of a model. A coat of several colors has several sets of zones, one for each part of
/// its pattern; every hair belongs to one part.
#[derive(Clone, Debug)]
pub struct AlongStrand<T> {
    stations: Vec<f32>,
    /// Never empty.
    parts: Vec<CoatPart>,
    /// `values[dye * stations + station]`.
    values: Vec<T>,
}

/// Tables of one hair class.
pub type TableSet = AlongStrand<ScatterTable>;

/// The pigment of the hairs in one part of a coat's pattern.
#[derive(Clone, Debug)]
pub struct CoatPart {
    /// From the tip, ascending; the last one is open-ended.
    pub zones: Vec<Zone>,
    /// Which dye colors each zone.
    pub dyes: Vec<usize>,
}

impl<T> AlongStrand<T> {
    /// A set whose hairs are all alike.
    ///
    /// * `stations`: positions along the hair, 0 root .. 1 tip, ascending.
    /// * `zones`: from the tip, ascending; the last one is open-ended.
    /// * `values`: one a zone and station, stations running fastest. `None` if the counts disagree.
    pub fn new(stations: Vec<f32>, zones: Vec<Zone>, values: Vec<T>) -> Option<Self> {
        let dyes = (0..zones.len()).collect();
        Self::with_parts(stations, vec![CoatPart { zones, dyes }], values)
    }

    /// A set whose hairs belong to the parts of a pattern.
    ///
    /// * `parts`: the pigment of each part; zones of equal pigment share a dye.
    /// * `values`: one a dye and station, stations running fastest. `None` if the counts disagree.
    pub fn with_parts(stations: Vec<f32>, parts: Vec<CoatPart>, values: Vec<T>) -> Option<Self> {
        let whole = |part: &CoatPart| {
            let dyed = |&dye: &usize| (dye + 1) * stations.len() <= values.len();
            !part.zones.is_empty()
                && part.zones.len() == part.dyes.len()
                && part.dyes.iter().all(dyed)
        };
        let complete = !stations.is_empty() && !parts.is_empty() && parts.iter().all(whole);
        complete.then_some(Self {
            stations,
            parts,
            values,
        })
    }

    /// The same value everywhere.
    pub fn uniform(value: T) -> Self {
        Self {
            stations: vec![0.0],
            parts: vec![CoatPart {
                zones: vec![Zone {
                    to_mm: f32::INFINITY,
                    softness_mm: 0.0,
                }],
                dyes: vec![0],
            }],
            values: vec![value],
        }
    }

    /// One a dye and station, stations running fastest.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// Something else at the same places, made of what is there.
    pub fn try_map<U, E>(&self, f: impl FnMut(&T) -> Result<U, E>) -> Result<AlongStrand<U>, E> {
        Ok(AlongStrand {
            stations: self.stations.clone(),
            parts: self.parts.clone(),
            values: self.values.iter().map(f).collect::<Result<_, E>>()?,
        })
    }

    /// The value at a point, and a random number that is left: between stations and across soft edges
    /// of zones one of two is drawn with the share as its probability. On average that is the blend, at
    /// a fraction of its cost.
    fn choose(&self, place: Place, u: f32) -> (&T, f32) {
        let part = &self.parts[place.part.min(self.parts.len() - 1)];
        let (s0, s1, share) = bracket_station(&self.stations, place.at);
        let (second, u) = if u < share {
            (true, u / share)
        } else {
            (false, rescale(u, share))
        };
        let station = if second { s1 } else { s0 };
        let (z0, z1, share) = bracket_zone(&part.zones, place.tip_mm);
        let (zone, u) = if u < share {
            (z1, u / share)
        } else {
            (z0, rescale(u, share))
        };
        let dye = part.dyes[zone];
        (&self.values[dye * self.stations.len() + station], u)
    }
}

/// Stretches `[share, 1)` back to `[0, 1)`.
fn rescale(u: f32, share: f32) -> f32 {
    (u - share) / (1.0 - share)
}

fn bracket_station(stations: &[f32], at: f32) -> (usize, usize, f32) {
    let above = stations.partition_point(|&s| s <= at);
    if above == 0 {
        (0, 0, 0.0)
    } else if above == stations.len() {
        (above - 1, above - 1, 0.0)
    } else {
        let (lo, hi) = (stations[above - 1], stations[above]);
        (above - 1, above, (at - lo) / (hi - lo))
    }
}

/// The zones that meet at a distance from the tip, and the share of the second.
///
/// * `zones`: never empty.
pub(crate) fn bracket_zone(zones: &[Zone], tip_mm: f32) -> (usize, usize, f32) {
    for (i, zone) in zones.iter().enumerate().take(zones.len() - 1) {
        let half = 0.5 * zone.softness_mm;
        if tip_mm < zone.to_mm - half {
            return (i, i, 0.0);
        }
        if tip_mm < zone.to_mm + half {
            let t = (tip_mm - zone.to_mm + half) / zone.softness_mm;
            return (i, i + 1, t * t * (3.0 - 2.0 * t));
        }
    }
    (zones.len() - 1, zones.len() - 1, 0.0)
}

/// A place on a hair.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Position along the hair, 0 root .. 1 tip.
    pub at: f32,
    /// Distance from the tip along the hair, millimeters.
    pub tip_mm: f32,
    /// Part of the coat's pattern that the hair belongs to; the last one if there are fewer.
    pub part: usize,
    /// Where the line of sight meets the hair across its width, -1..1 in radii, positive toward +Y of the
    /// strand frame. Of effect for near-field models ([`HairMaterial::is_near_field`]).
    pub across: f32,
}

impl HairMaterial {
    /// The model at a point of a strand, seen along `wo`.
    ///
    /// * `wo`: unit direction to the viewer in the strand frame.
    /// * `azimuth`: of `wo` around the strand from the major axis of its section, radians; asked for only
    ///   where tables tell azimuths apart.
    /// * `u`: a random number in `[0, 1)` that chooses where values blend.
    pub fn at(&self, place: Place, wo: Vec3, azimuth: impl FnOnce() -> f32, u: f32) -> Bsdf<'_> {
        match self {
            Self::Isotropic(albedo) => Bsdf::Isotropic(*albedo),
            Self::Tables(set) => {
                let (table, u) = set.choose(place, u);
                let azimuth = match table.nodes().azimuths.is_averaged() {
                    true => 0.0,
                    false => azimuth(),
                };
                Bsdf::Table(table.lobe_at(wo, azimuth, u))
            }
            Self::Chiang(models) => {
                let (model, _) = models.choose(place, u);
                Bsdf::Chiang(model.lobe_at(wo, place.across))
            }
            Self::DoubleCylinder(models) => {
                let (model, _) = models.choose(place, u);
                Bsdf::DoubleCylinder(model.lobe_at(wo, place.across))
            }
        }
    }

    /// Whether it matters where across its width a strand is met.
    pub fn is_near_field(&self) -> bool {
        matches!(self, Self::Chiang(_) | Self::DoubleCylinder(_))
    }

    /// Whether any table tells azimuths apart.
    pub fn has_azimuths(&self) -> bool {
        match self {
            Self::Isotropic(_) | Self::Chiang(_) | Self::DoubleCylinder(_) => false,
            Self::Tables(set) => {
                let has = |table: &ScatterTable| !table.nodes().azimuths.is_averaged();
                set.values.iter().any(has)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zones_blend_over_their_softness() {
        let zones = [
            Zone {
                to_mm: 2.0,
                softness_mm: 1.0,
            },
            Zone {
                to_mm: 10.0,
                softness_mm: 0.0,
            },
            Zone {
                to_mm: f32::INFINITY,
                softness_mm: 0.0,
            },
        ];
        assert_eq!(bracket_zone(&zones, 1.4), (0, 0, 0.0));
        assert_eq!(bracket_zone(&zones, 2.0), (0, 1, 0.5));
        assert_eq!(bracket_zone(&zones, 9.9), (1, 1, 0.0));
        assert_eq!(bracket_zone(&zones, 10.0), (2, 2, 0.0));
    }

    #[test]
    fn stations_interpolate_and_hold_their_ends() {
        assert_eq!(bracket_station(&[0.2, 0.8], 0.1), (0, 0, 0.0));
        let (a, b, f) = bracket_station(&[0.2, 0.8], 0.5);
        assert!(a == 0 && b == 1 && (f - 0.5).abs() < 1e-6);
        assert_eq!(bracket_station(&[0.2, 0.8], 0.9), (1, 1, 0.0));
    }
}
