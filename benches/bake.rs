//! Photons per second and core, per structure: `cargo bench --bench bake`, or `-- red-fox moose` for
//! these species, `-- --stations` for every station instead of the last one of a class.
//!
//! The best of five rounds by the time that the thread ran: other load on the machine disturbs it
//! least.

mod clock;

use clock::thread_seconds;
use vair::bake::{Photon, Sides, fly_all};
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
            let (mut seconds, mut events) = (f64::INFINITY, 0);
            for _ in 0..ROUNDS {
                let (took, met) = round(&fiber);
                (seconds, events) = (seconds.min(took), met);
            }
            println!(
                "{name:>16} {:<6} {:4.2} {:6.3} M photons/s a core, {:5.2} events a photon, {:4.0} ns an event",
                class.name,
                station.at,
                PHOTONS as f64 / seconds / 1e6,
                events as f64 / PHOTONS as f64,
                seconds * 1e9 / events as f64
            );
        }
    }
}

/// Flies photons from every inclination. Seconds and events.
fn round(fiber: &Fiber) -> (f64, u64) {
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
    fly_all(fiber, photons, false, 1000, |_, flight| {
        events += u64::from(flight.events);
    });
    (thread_seconds() - start, events)
}
