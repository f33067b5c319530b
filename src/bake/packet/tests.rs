//! Photons in company go where they go alone.

use super::super::alone::Flights;
use super::Packets;
use crate::fiber::Fiber;
use crate::math::lanes::{Avx2, Avx512, Wide};

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
            for (forked, max_events) in [(false, 1000), (true, 1000), (false, 9)] {
                let flights = Flights {
                    seed: 7,
                    count,
                    forked,
                    max_events,
                };
                let mut together = Vec::new();
                packets.fly(flights.photons(), forked, max_events, |part, flight| {
                    together.push((part, flight));
                });
                flights.fly_as_alone(&fiber, &format!("{name} {}", class.name), together);
            }
        }
    }
}
