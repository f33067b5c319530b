//! Photons that take turns go where they go alone.

use super::super::alone::Flights;
use crate::fiber::Fiber;

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
        for (forked, max_events, count) in [
            (false, 1000, 2000),
            (true, 1000, 1000),
            (false, 5, 500),
            (true, 1, 5),
        ] {
            let flights = Flights {
                seed: 8,
                count,
                forked,
                max_events,
            };
            let searches = fiber.turns().expect("a fiber of triangles");
            let mut together = Vec::new();
            super::fly(
                &fiber,
                searches,
                flights.photons(),
                forked,
                max_events,
                |part, flight| together.push((part, flight)),
            );
            flights.fly_as_alone(&fiber, name, together);
        }
    }
}
