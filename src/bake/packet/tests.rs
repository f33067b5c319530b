//! Photons in company go where they go alone.

use super::super::entry::{Photon, Sides, fly, fly_forked};
use super::super::{End, Flight};
use super::Packets;
use crate::fiber::Fiber;
use crate::math::lanes::{Avx2, Avx512, Wide};
use crate::table::PHOTON;

/// A flight as whole numbers, to be sorted.
fn bits(part: u64, flight: &Flight) -> [u64; 9] {
    let (end, dir) = match flight.end {
        End::Escaped(dir) => (0, dir.to_array().map(f64::to_bits)),
        End::Absorbed => (1, [0; 3]),
        End::Truncated => (2, [0; 3]),
        End::Lost => (3, [0; 3]),
        End::Missed => (4, [0; 3]),
    };
    let [x, y, z] = dir;
    let [cos, sin] = flight.query.to_array().map(f64::to_bits);
    let path = flight.path_um.to_bits();
    [part, cos, sin, path, u64::from(flight.events), end, x, y, z]
}

fn photons(count: u64) -> impl Iterator<Item = Photon> {
    (0..count).map(|stream| Photon {
        seed: 7,
        stream,
        sin_range: (-1.0, 1.0),
        sides: Sides::ALL,
    })
}

#[test]
fn photons_in_company_fly_as_they_do_alone_with_avx512() {
    match Avx512::detect() {
        Some(simd) => fly_in_company_and_alone(simd),
        None => println!("not on this processor"),
    }
}

#[test]
fn photons_in_company_fly_as_they_do_alone_with_avx2() {
    match Avx2::detect() {
        Some(simd) => fly_in_company_and_alone(simd),
        None => println!("not on this processor"),
    }
}

fn fly_in_company_and_alone<W: Wide>(simd: W) {
    for (name, count) in [
        ("human", 6000),
        ("red-fox", 4000),
        ("mink", 1000),
        ("moose", 600),
    ] {
        let species = crate::species::load(name, &[]).unwrap();
        for class in &species.classes {
            let station = class.stations.last().unwrap();
            let fiber = Fiber::build(&station.structure, 0).unwrap();
            let Some(packets) = Packets::new(simd, &fiber) else {
                println!("not here: {name}");
                continue;
            };
            for (forked, most) in [(false, 1000), (true, 1000), (false, 9)] {
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
                packets.fly(photons(count), forked, most, |part, flight| {
                    together.push(bits(part, &flight));
                });
                alone.sort_unstable();
                together.sort_unstable();
                let same = alone.iter().filter(|a| together.binary_search(a).is_ok());
                let same = same.count();
                assert_eq!(alone.len(), together.len());
                assert_eq!(same, alone.len(), "{name} {} {forked}", class.name);
            }
        }
    }
}
