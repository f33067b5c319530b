//! Photons that take turns go where they go alone.

use super::super::entry::{Photon, Sides, fly, fly_forked};
use super::super::{End, Flight};
use crate::fiber::Fiber;
use crate::table::PHOTON;

/// A flight as whole numbers, to be sorted.
fn bits(part: u64, flight: &Flight) -> [u64; 7] {
    let (end, dir) = match flight.end {
        End::Escaped(dir) => (0, dir.to_array().map(f64::to_bits)),
        End::Absorbed => (1, [0; 3]),
        End::Truncated => (2, [0; 3]),
        End::Lost => (3, [0; 3]),
        End::Missed => (4, [0; 3]),
    };
    let path = flight.path_um.to_bits() ^ flight.share.to_bits().rotate_left(32);
    let [x, y, z] = dir;
    [part, u64::from(flight.events), path, end, x, y, z]
}

fn photons(count: u64) -> impl Iterator<Item = Photon> {
    (0..count).map(|stream| Photon {
        seed: 8,
        stream,
        sin_range: (-1.0, 1.0),
        sides: Sides::ALL,
    })
}

/// Voids that overlap, a medium that scatters and absorbs, and rough boundaries: all in triangles, as the fiber is twisted.
#[test]
fn photons_that_take_turns_fly_as_they_do_alone() {
    let twist = "structure.twist_turns_per_cm=3";
    let medium = [
        twist,
        "guard.stations.0.medulla.kind=medium",
        "guard.stations.0.medulla.ratio=0.5",
        "guard.stations.0.medulla.pigment=1",
        "guard.stations.0.medulla.scattering_per_um=0.2",
        "guard.stations.0.medulla.asymmetry=0.4",
    ];
    for (name, set) in [("mink", &[twist][..]), ("human", &medium)] {
        let set: Vec<String> = set.iter().map(|s| (*s).to_owned()).collect();
        let species = crate::species::load(name, &set).unwrap();
        let station = species.classes[0].widest().unwrap();
        let fiber = Fiber::build(&station.structure, 0).unwrap();
        for (forked, most, count) in [
            (false, 1000, 2000),
            (true, 1000, 1000),
            (false, 5, 500),
            (true, 1, 5),
        ] {
            let (mut alone, mut together) = (Vec::new(), Vec::new());
            for photon in photons(count) {
                if forked {
                    fly_forked(&fiber, &photon, most, |part, flight| {
                        alone.push(bits(part, &flight));
                    });
                } else {
                    alone.push(bits(PHOTON, &fly(&fiber, &photon, most)));
                }
            }
            let searches = fiber.turns().expect("a fiber of triangles");
            super::fly(&fiber, searches, photons(count), forked, most, |part, f| {
                together.push(bits(part, &f));
            });
            alone.sort_unstable();
            together.sort_unstable();
            assert_eq!(alone.len(), together.len());
            let same = alone.iter().zip(&together).filter(|(a, b)| a == b);
            assert_eq!(same.count(), alone.len(), "{name} {forked} {most}");
        }
    }
}
