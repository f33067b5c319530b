//! Photons per second and core, per structure: `cargo bench --bench bake`.

use std::time::Instant;
use vair::bake::{Photon, fly};
use vair::fiber::Fiber;

fn main() {
    let photons = 400_000u64;
    for name in ["glass-cylinder", "human", "mink", "polar-bear", "red-fox"] {
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
            let start = Instant::now();
            let mut events = 0;
            for i in 0..photons {
                let bin = (i % 16) as f64 / 8.0 - 1.0;
                let photon = Photon {
                    seed: 0,
                    stream: i,
                    sin_range: (bin, bin + 0.125),
                };
                events += u64::from(fly(&fiber, &photon, 1000).events);
            }
            let seconds = start.elapsed().as_secs_f64();
            println!(
                "{name:>16} {:<6} {:6.2} M photons/s a core, {:5.2} events a photon, {:4.0} ns an event",
                class.name,
                photons as f64 / seconds / 1e6,
                events as f64 / photons as f64,
                seconds * 1e9 / events as f64
            );
        }
    }
}
