//! Strands grown per second, lifted off the skin and held against its triangles: `cargo bench --bench
//! groom`. Best of three, all threads and one.

use std::time::{Duration, Instant};
use vair::groom::{GroomSettings, grow};
use vair::progress::{Cancel, Silent};
use vair::skin;
use vair::species::{self, Collision};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let start = Instant::now();
    let body = skin::load("body")?;
    println!(
        "body: {} triangles in {:.0} ms",
        body.triangles.len(),
        start.elapsed().as_secs_f64() * 1e3
    );
    let mut fox = species::load("red-fox", &[])?;
    for threads in [rayon::current_num_threads(), 1] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()?;
        for strands in [100_000, 1_000_000] {
            let settings = GroomSettings {
                strands: Some(strands),
                seed: 0,
            };
            for collision in [Collision::Near, Collision::Exact] {
                fox.groom.collision = collision;
                let mut best = Duration::MAX;
                for _ in 0..3 {
                    let start = Instant::now();
                    let groom =
                        pool.install(|| grow(&body, &fox, &settings, &Silent, &Cancel::default()))?;
                    best = best.min(start.elapsed());
                    let buried: usize = groom.accounts.iter().map(|a| a.buried).sum();
                    assert_eq!(groom.strands() + buried, strands);
                }
                println!(
                    "{strands:>8} strands on {threads} threads, {collision:?}: {:6.2} s, {:5.0} k strands/s",
                    best.as_secs_f64(),
                    strands as f64 / best.as_secs_f64() / 1e3
                );
            }
        }
    }
    Ok(())
}
