//! Photons per second and core, per structure: `cargo bench --bench bake`, or `-- red-fox` for one
//! species. The best of five rounds, which other load on the machine disturbs least.

use std::time::Instant;
use vair::bake::{Photon, fly};
use vair::fiber::Fiber;

const PHOTONS: u64 = 80_000;
const ROUNDS: u32 = 5;

fn main() {
    let wanted: Vec<String> = std::env::args()
        .skip(1)
        .filter(|arg| !arg.starts_with("--"))
        .collect();
    for name in ["glass-cylinder", "human", "mink", "polar-bear", "red-fox"] {
        if !wanted.is_empty() && !wanted.iter().any(|w| w == name) {
            continue;
        }
        let species = match vair::species::load(name, &[]) {
            Ok(species) => species,
            Err(error) => return eprintln!("{name}: {error}"),
        };
        for class in &species.classes {
            let Some(station) = class.stations.last() else {
                continue;
            };
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
                "{name:>16} {:<6} {:6.2} M photons/s a core, {:5.2} events a photon, {:4.0} ns an event",
                class.name,
                PHOTONS as f64 / seconds / 1e6,
                events as f64 / PHOTONS as f64,
                seconds * 1e9 / events as f64
            );
        }
    }
}

/// Flies photons from every inclination. Seconds and events.
fn round(fiber: &Fiber) -> (f64, u64) {
    let start = Instant::now();
    let mut events = 0;
    for i in 0..PHOTONS {
        let bin = (i % 16) as f64 / 8.0 - 1.0;
        let photon = Photon {
            seed: 0,
            stream: i,
            sin_range: (bin, bin + 0.125),
        };
        events += u64::from(fly(fiber, &photon, 1000).events);
    }
    (start.elapsed().as_secs_f64(), events)
}
