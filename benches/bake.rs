//! Photons per second and core, per structure: `cargo bench --bench bake`, or `-- red-fox moose` for
//! these species, `-- --stations` for every station instead of the last one of a class.
//!
//! The best of five rounds by the time that the thread ran: other load on the machine disturbs it
//! least.

mod clock;

use clock::thread_seconds;
use vair::bake::{Photon, Sides, fly, fly_all};
use vair::fiber::Fiber;
use vair::species::Species;

const PHOTONS: u64 = 80_000;
const ROUNDS: u32 = 5;
/// One of each kind of fiber: bare, scaled only, and by what fills the medulla.
const SPECIES: [&str; 7] = [
    "glass-cylinder",
    "human",
    "red-fox",
    "mink",
    "polar-bear",
    "caribou",
    "moose",
];

fn main() {
    let (flags, wanted): (Vec<String>, Vec<String>) = std::env::args()
        .skip(1)
        .partition(|arg| arg.starts_with("--"));
    let all = flags.iter().any(|flag| flag == "--stations");
    let names: Vec<&str> = match wanted.is_empty() {
        true => SPECIES.to_vec(),
        false => wanted.iter().map(String::as_str).collect(),
    };
    for name in names {
        match vair::species::load(name, &[]) {
            Ok(species) => measure(name, &species, all),
            Err(error) => eprintln!("{name}: {error}"),
        }
    }
}

fn measure(name: &str, species: &Species, all: bool) {
    for class in &species.classes {
        let first = match all {
            true => 0,
            false => class.stations.len().saturating_sub(1),
        };
        for station in &class.stations[first..] {
            let fiber = match Fiber::build(&station.structure, 0) {
                Ok(fiber) => fiber,
                Err(error) => return eprintln!("{name}: {error}"),
            };
            let (mut alone, mut together) = ((f64::INFINITY, 0), (f64::INFINITY, 0));
            for _ in 0..ROUNDS {
                for (best, flight) in [
                    (&mut alone, Flight::Alone),
                    (&mut together, Flight::Together),
                ] {
                    let (seconds, events) = round(&fiber, flight);
                    *best = (best.0.min(seconds), events);
                }
            }
            let per_second = |(seconds, _): (f64, u64)| PHOTONS as f64 / seconds / 1e6;
            let (seconds, events) = together;
            println!(
                "{name:>16} {:<6} {:4.2} {:6.3} M photons/s a core, {:5.2} events a photon, {:4.0} ns an event; one by one {:6.3} M/s, {:4.2} times",
                class.name,
                station.at,
                per_second(together),
                events as f64 / PHOTONS as f64,
                seconds * 1e9 / events as f64,
                per_second(alone),
                alone.0 / seconds,
            );
        }
    }
}

#[derive(Clone, Copy)]
enum Flight {
    Alone,
    Together,
}

/// Flies photons from every inclination. Seconds and events.
fn round(fiber: &Fiber, flight: Flight) -> (f64, u64) {
    let start = thread_seconds();
    let photons = (0..PHOTONS).map(|i| {
        let bin = (i % 16) as f64 / 8.0 - 1.0;
        Photon {
            seed: 0,
            stream: i,
            sin_range: (bin, bin + 0.125),
            sides: Sides::ALL,
        }
    });
    let mut events = 0;
    match flight {
        Flight::Alone => photons.for_each(|photon| {
            events += u64::from(fly(fiber, &photon, 1000).events);
        }),
        Flight::Together => fly_all(fiber, photons, false, 1000, |_, flight| {
            events += u64::from(flight.events);
        }),
    }
    (thread_seconds() - start, events)
}
