//! How a whole bake scales: with threads, with photons, in memory.
//!
//! `cargo bench --bench scaling` or, for another species and up to more photons,
//! `cargo bench --bench scaling -- red-fox 1e9`.
//!
//! One and two threads take turns, so that other load on the machine meets both; processor seconds
//! stand beside wall seconds, since those do not count what others use.

mod clock;

use clock::processor_seconds;
use std::time::Instant;
use vair::bake::{Bake, Goal, Settings};
use vair::progress::{Cancel, Silent};

const ROUNDS: u32 = 5;

fn main() {
    let args: Vec<String> = std::env::args()
        .skip(1)
        .filter(|arg| !arg.starts_with("--"))
        .collect();
    let name = args.first().map_or("glass-cylinder", String::as_str);
    let most: f64 = args.get(1).and_then(|n| n.parse().ok()).unwrap_or(3e7);
    if let Err(error) = threads(name).and_then(|()| photons(name, most)) {
        eprintln!("{error}");
    }
}

/// One bake: wall and processor seconds.
fn bake(name: &str, photons: u64, threads: usize) -> Result<(f64, f64), String> {
    let species = vair::species::load(name, &[]).map_err(|e| e.to_string())?;
    let station = species.classes[0].widest().ok_or("no station")?;
    let settings = Settings {
        photons,
        ..Settings::cone()
    };
    let bake = Bake::new(&station.structure, &settings).map_err(|e| e.to_string())?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|e| e.to_string())?;
    let (wall, used) = (Instant::now(), processor_seconds());
    pool.install(|| bake.run(&Goal::default(), &Silent, &Cancel::default()));
    Ok((wall.elapsed().as_secs_f64(), processor_seconds() - used))
}

fn threads(name: &str) -> Result<(), String> {
    let mut best = [(f64::INFINITY, f64::INFINITY); 2];
    for _ in 0..ROUNDS {
        for (i, best) in best.iter_mut().enumerate() {
            let (wall, used) = bake(name, 4_000_000, i + 1)?;
            *best = (best.0.min(wall), best.1.min(used));
        }
    }
    let [one, two] = best;
    println!("{name}, 4e6 photons, best of {ROUNDS}");
    println!("  1 thread:  {:.2} s, {:.2} processor s", one.0, one.1);
    println!("  2 threads: {:.2} s, {:.2} processor s", two.0, two.1);
    println!("  {:.2} times as fast", one.0 / two.0);
    Ok(())
}

fn photons(name: &str, most: f64) -> Result<(), String> {
    println!("{name}, all cores");
    let mut count = 1e6;
    while count <= most {
        let (wall, used) = bake(name, count as u64, rayon::current_num_threads())?;
        let memory = peak_memory_mb().map_or(String::new(), |mb| format!(", {mb:.0} MB at most"));
        let cost = 1e9 * used / count;
        println!("  {count:.0e} photons: {cost:.0} processor ns a photon, {wall:.1} s{memory}");
        count *= 10f64.sqrt();
    }
    Ok(())
}

/// The most memory this process had, on Linux.
fn peak_memory_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes / 1e3)
}
