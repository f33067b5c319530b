//! What dyeing a table costs: `cargo bench --bench dye`. Of human hair, 16 nodes of 6 x 64 x 64 and 12
//! levels; time of one thread, best of many rounds.

use std::time::{Duration, Instant};
use vair::bake::{Settings, bake};
use vair::fiber::Fiber;
use vair::progress::{Cancel, Silent};
use vair::species;
use vair::table::Provenance;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let human = species::load("human", &[])?;
    let class = &human.classes[0];
    let fiber = Fiber::build(&class.stations[0].structure, 0)?;
    let settings = Settings {
        photons: 200_000,
        ..Settings::cone()
    };
    let (silent, cancel) = (Silent, Cancel::default());
    let table = bake(&fiber, &settings, Provenance::default(), &silent, &cancel)?.table;
    let pigments = [
        ("its own pigment", class.pigment[0].absorption_per_um()),
        ("beyond the levels", [5.0, 10.0, 20.0]),
        ("clear", [0.0; 3]),
    ];
    for threads in [1, rayon::current_num_threads()] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()?;
        for (name, absorption) in pigments {
            let mut best = Duration::MAX;
            for _ in 0..30 {
                let start = Instant::now();
                let maps = pool.install(|| table.dye(absorption))?;
                best = best.min(start.elapsed());
                std::hint::black_box(maps);
            }
            println!(
                "{name}: {:.1} ms on {threads} threads",
                best.as_secs_f64() * 1e3
            );
        }
    }
    Ok(())
}
