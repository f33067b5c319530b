//! Error of baked tables against photons flown.
//!
//! * `cargo bench --bench accuracy`: the paper's scheme and each improvement, three species.
//! * `cargo bench --bench accuracy -- red-fox mink`: other species.
//! * `cargo bench --bench accuracy -- --first`: what half a second gives, every species.
//! * `--reference 8e6`: photons of the reference (4e6 if not given, 1e6 with `--first`).
//!
//! The error is the relative L2 distance of S, at continuous inclinations of the query, to a
//! reference that is no table: photons counted in cells of 1.5 x 1.4 x 2.8 degrees, all within 73
//! degrees of the normal plane. The reference has two halves A and B with nothing in common, and the
//! squared error of T is taken as the sum of (T - A)(T - B): their noise drops out. So it does
//! with two tables of different seeds, which leaves the bias: what no number of photons mends.

mod cells;
#[path = "../clock/mod.rs"]
mod clock;

use cells::{Cells, Reference};
use clock::processor_seconds;
use std::time::Instant;
use vair::bake::{Bake, Goal, Settings, bake};
use vair::fiber::Fiber;
use vair::progress::{Cancel, Silent};
use vair::species::{HairClass, Station};
use vair::table::{Provenance, ScatterTable, StructureTable, Undyed};

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let mut names = Vec::new();
    let (mut first, mut reference) = (false, None);
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--first" => first = true,
            "--reference" => reference = args.next().and_then(|text| text.parse::<f64>().ok()),
            name if !name.starts_with("--") => names.push(name.to_owned()),
            // What cargo adds.
            _ => {}
        }
    }
    let photons = reference.unwrap_or(if first { 1e6 } else { 4e6 }) as u64;
    if names.is_empty() {
        names = match first {
            true => vair::species::ids().map(str::to_owned).collect(),
            false => ["human", "polar-bear", "red-fox"].map(str::to_owned).into(),
        };
    }
    if first {
        println!(
            "| species | photons in 0.5 s | error | its own estimate |\n| --- | --- | --- | --- |"
        );
    }
    for name in names {
        let species = vair::species::load(&name, &[])?;
        let class = &species.classes[0];
        let station = class.widest().ok_or("a class has stations")?;
        match first {
            true => first_table(&name, station, photons)?,
            false => schemes(&name, class, station, photons)?,
        }
    }
    Ok(())
}

/// Settings of the paper's scheme and of each improvement on top of those before.
fn ladder() -> [(&'static str, Settings); 5] {
    let paper = Settings::paper();
    // The cap cuts off light; here it is the bins that are looked at.
    let uncut = Settings {
        max_events: 1000,
        ..paper
    };
    let cone = Settings {
        fold: false,
        fork: false,
        reconstruct: false,
        ..Settings::cone()
    };
    let fold = Settings {
        fold: true,
        ..cone.clone()
    };
    let fork = Settings {
        fork: true,
        ..fold.clone()
    };
    let reconstruct = Settings {
        reconstruct: true,
        ..fork.clone()
    };
    [
        ("paper's bins", uncut),
        ("cone frame", cone),
        ("+ fold", fold),
        ("+ fork", fork),
        ("+ reconstruction", reconstruct),
    ]
}

/// Counts at which errors are printed; bakes of the filtered scheme fly the first ones of them.
const COUNTS: [f64; 5] = [3e4, 1e5, 3e5, 1e6, 1e9];
const FLOWN: u64 = 1_000_000;

fn schemes(name: &str, class: &HairClass, station: &Station, photons: u64) -> Result<(), Failure> {
    let fiber = Fiber::build(&station.structure, 0)?;
    let pigment = class.band_at(station.at).absorption_per_um();
    for (what, absorption) in [("clear", 0.0), ("its own pigment, green", pigment[1])] {
        if what != "clear" && absorption == 0.0 {
            continue;
        }
        let reference = Reference::of(name, &fiber, absorption, photons)?;
        println!(
            "\n{name}, {what}; noise of half the reference {:.2}",
            reference.noise()
        );
        println!("| scheme | bias | at 3e4 | 1e5 | 3e5 | 1e6 | 1e9 |");
        println!("| --- | --- | --- | --- | --- | --- | --- |");
        for (scheme, settings) in ladder() {
            let cells = |photons: u64, seed: u64| -> Result<Cells, Failure> {
                let settings = Settings {
                    photons,
                    seed,
                    ..settings.clone()
                };
                Ok(Cells::of(&dyed(&flown(&fiber, &settings)?, absorption)?))
            };
            let (a, b) = (cells(FLOWN, 1)?, cells(FLOWN, 2)?);
            let bias = reference.bias(&a, &b);
            let variance = reference.variance(&a, &b);
            print!("| {scheme} | {:.1} % |", 100.0 * bias.max(0.0).sqrt());
            for count in COUNTS {
                // Exact for means; what is filtered has to be flown.
                let squared = match settings.reconstruct {
                    true if count > FLOWN as f64 => {
                        print!(" |");
                        continue;
                    }
                    true => reference.error(&cells(count as u64, 3)?),
                    false => bias + variance * FLOWN as f64 / count,
                };
                print!(" {:.1} % |", 100.0 * squared.max(0.0).sqrt());
            }
            println!();
        }
    }
    Ok(())
}

fn flown(fiber: &Fiber, settings: &Settings) -> Result<StructureTable, Failure> {
    let provenance = Provenance::default();
    Ok(bake(fiber, settings, provenance, &Silent, &Cancel::default())?.table)
}

fn dyed(table: &StructureTable, absorption_per_um: f64) -> Result<ScatterTable, Failure> {
    Ok(table.dye([absorption_per_um; 3])?.into())
}

/// Seconds of processor time a photon, less than any takes.
const CHEAPEST: f64 = 3e-8;

/// Cores that half a second is counted on.
const CORES: f64 = 2.0;

/// What a bake has after half a second, all but reading the preset counted. Time is processor time over
/// two cores, so that other load on the machine does not count.
fn first_table(name: &str, station: &Station, photons: u64) -> Result<(), Failure> {
    let start = Instant::now();
    let mut structure = station.structure.clone();
    if structure.is_colored() {
        structure = structure.channel(1);
    }
    let fiber = Fiber::build(&structure, 0)?;
    let building = start.elapsed().as_secs_f64();
    let reference = Reference::of(name, &fiber, 0.0, photons)?;
    let run = |photons: u64| -> Result<(f64, f64, Undyed), Failure> {
        let settings = Settings {
            photons,
            seed: 5,
            ..Settings::cone()
        };
        let before = processor_seconds();
        let bake = Bake::of_fiber(&fiber, &settings)?;
        bake.run(&Goal::default(), &Silent, &Cancel::default());
        let table = bake.snapshot()?;
        let seconds = processor_seconds() - before;
        // The command, too, states the error when the table is there.
        Ok((seconds, bake.error(), table))
    };
    // The cost of a bake is a sum of what photons cost and of what tables cost.
    let (few, many) = (16_384, 262_144);
    let (a, b) = (run(few)?.0, run(many)?.0);
    // Ticks of the clock may be as long as all photons of a bare cylinder took.
    let each = ((b - a) / (many - few) as f64).max(CHEAPEST);
    let once = a - each * few as f64;
    let left = CORES * (0.5 - building) - once;
    let count = (left / each).max(16_384.0) as u64;
    let (_, noise, table) = run(count)?;
    let Undyed::Gray(table) = table else {
        return Err("one fiber is one table".into());
    };
    let error = reference.error(&Cells::of(&dyed(&table, 0.0)?));
    println!(
        "| {name} | {count} | {:.1} % | {:.1} % |",
        100.0 * error.max(0.0).sqrt(),
        100.0 * noise
    );
    Ok(())
}
