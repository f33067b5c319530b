//! Vair's photons beside an Embree loop over the same triangles: `benches/embree/run.sh`, which
//! compiles the loop, or `cargo bench --bench embree -- PROGRAM [--quick]` with it compiled.
//!
//! For each fiber four walks take turns in one run, each by the processor time of its own thread:
//! Vair on the fiber itself, Vair on its triangles (one period, exported and read back), Embree on the
//! same triangles by single rays and by packets of 8. Boundaries are smooth,
//! 16 events are followed, nothing is tallied. That all follow the same light shows in their events a
//! photon, which agree but for noise and for the flat pieces.

#[path = "../clock/mod.rs"]
mod clock;

use clock::thread_seconds;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use vair::bake::{End, Photon, Sides, fly_all};
use vair::fiber::Fiber;
use vair::species::{Structure, load};

const PHOTONS: u64 = 20_000;
const EVENTS: u32 = 16;

type Failure = Box<dyn std::error::Error>;

/// A scaled cuticle around an air-filled tube: as human hair, with a medium that is air.
const TUBE: [&str; 6] = [
    "guard.stations.0.medulla.kind=medium",
    "guard.stations.0.medulla.ratio=0.4",
    "guard.stations.0.medulla.pigment=0",
    "guard.stations.0.medulla.scattering_per_um=0",
    "guard.stations.0.medulla.asymmetry=0",
    "structure.materials.medulla.index=1.0003",
];

fn main() -> Result<(), Failure> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let Some(program) = args.iter().find(|arg| !arg.starts_with("--")) else {
        println!("benches/embree/run.sh compiles the Embree loop and runs this with it");
        return Ok(());
    };
    let rounds = if args.iter().any(|a| a == "--quick") {
        3
    } else {
        9
    };
    for (title, name, set) in [
        ("red-fox guard", "red-fox", &[][..]),
        ("human guard", "human", &[]),
        ("human guard with an air-filled tube", "human", &TUBE),
    ] {
        compare(title, name, set, program, rounds)?;
    }
    Ok(())
}

/// What a round took and met.
#[derive(Clone, Copy, Debug, Default)]
struct Round {
    seconds: f64,
    segments: f64,
    events: f64,
    escaped: f64,
    lost: f64,
}

fn compare(
    title: &str,
    name: &str,
    set: &[&str],
    program: &str,
    rounds: u64,
) -> Result<(), Failure> {
    let folder = tempfile::tempdir()?;
    let export = |file: &str| -> Result<String, Failure> {
        let path = folder.path().join(file).display().to_string();
        let mut command = Command::new(env!("CARGO_BIN_EXE_vair"));
        command.args(["fiber", name, "--quiet", "-o", &path]);
        command.args(set.iter().flat_map(|s| ["--set", s]));
        if !command.status()?.success() {
            return Err("vair fiber failed".into());
        }
        Ok(path)
    };
    let (ply, glb) = (export("fiber.ply")?, export("fiber.glb")?);
    let fiber = Fiber::build(&smooth(structure(name, set)?), 0)?;
    let mesh = [
        format!("structure.mesh.file={glb}"),
        format!(
            "structure.mesh.period_um={}",
            (fiber.period_um() * 1e6).round() / 1e6
        ),
    ];
    let with_mesh: Vec<&str> = set
        .iter()
        .copied()
        .chain(mesh.iter().map(String::as_str))
        .collect();
    let modeled = Fiber::build(&smooth(structure(name, &with_mesh)?), 0)?;
    let triangles: usize = fiber.mesh().iter().map(|part| part.triangles.len()).sum();
    println!("{title}, {triangles} triangles");

    let mut embree = Embree::start(program, &ply, &fiber)?;
    let names = [
        "Vair, analytic",
        "Vair, triangles",
        "Embree, single",
        "Embree, 8 rays",
    ];
    let mut all: Vec<[Round; 4]> = Vec::new();
    for round in 0..rounds {
        all.push([
            walk(&fiber, round),
            walk(&modeled, round),
            embree.walk(1, round)?,
            embree.walk(8, round)?,
        ]);
    }
    for (i, name) in names.iter().enumerate() {
        let mean = |of: fn(&Round) -> f64| {
            let sum: f64 = all.iter().map(|round| of(&round[i])).sum();
            sum / (rounds * PHOTONS) as f64
        };
        let rate = |round: &[Round; 4], i: usize| 1e-6 * PHOTONS as f64 / round[i].seconds;
        let best = all.iter().map(|r| rate(r, i)).fold(0.0, f64::max);
        let against = median(all.iter().map(|r| rate(r, i) / rate(r, 2)));
        let segments = mean(|r| r.segments);
        let segments = match segments > 0.0 {
            true => format!("{segments:5.2} rays"),
            false => " ".repeat(10),
        };
        println!(
            "  {name:<16} {best:6.3} M photons/s a core, {:5.2} events {segments} a photon, \
             {:5.2} % escape, {:6.4} % lost, {against:5.2} times Embree's single rays",
            mean(|r| r.events),
            100.0 * mean(|r| r.escaped),
            100.0 * mean(|r| r.lost),
        );
    }
    Ok(())
}

fn structure(name: &str, set: &[&str]) -> Result<Structure, Failure> {
    let set: Vec<String> = set.iter().map(|s| (*s).to_owned()).collect();
    let species = load(name, &set)?;
    let station = species.classes[0].widest().ok_or("no station")?;
    Ok(station.structure.clone())
}

/// With smooth boundaries, as the Embree loop has.
fn smooth(mut structure: Structure) -> Structure {
    structure.cuticle.roughness = 0.0;
    structure.cuticle.riser_roughness = 0.0;
    let materials = &mut structure.materials;
    for part in [
        &mut materials.cuticle,
        &mut materials.cortex,
        &mut materials.medulla,
        &mut materials.void,
    ] {
        part.roughness = Some(0.0);
    }
    structure
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Photons from every inclination through a fiber of Vair's.
fn walk(fiber: &Fiber, seed: u64) -> Round {
    let mut round = Round::default();
    let start = thread_seconds();
    let photons = (0..PHOTONS).map(|i| {
        let bin = (i % 16) as f64 / 8.0 - 1.0;
        Photon {
            seed,
            stream: i,
            sin_range: (bin, bin + 0.125),
            sides: Sides::ALL,
        }
    });
    fly_all(fiber, photons, false, EVENTS, |_, flight| {
        round.events += f64::from(flight.events);
        match flight.end {
            End::Escaped(_) | End::Missed => round.escaped += 1.0,
            End::Lost => round.lost += 1.0,
            End::Absorbed | End::Truncated => {}
        }
    });
    round.seconds = thread_seconds() - start;
    round
}

/// The Embree loop, waiting for the next round.
struct Embree {
    child: Child,
    ask: ChildStdin,
    answer: BufReader<ChildStdout>,
}

impl Embree {
    fn start(program: &str, ply: &str, fiber: &Fiber) -> Result<Self, Failure> {
        let structure = fiber.structure();
        let args = [
            ply.to_owned(),
            fiber.period_um().to_string(),
            structure.ior.to_string(),
            structure.medulla.void_ior.to_string(),
            EVENTS.to_string(),
            // One copy to both sides and fast rather than robust traversal: what is fastest here.
            "1".to_owned(),
            "0".to_owned(),
        ];
        let mut child = (Command::new(program).args(args))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let ask = child.stdin.take().ok_or("no pipe")?;
        let answer = BufReader::new(child.stdout.take().ok_or("no pipe")?);
        Ok(Self { child, ask, answer })
    }

    fn walk(&mut self, width: u32, seed: u64) -> Result<Round, Failure> {
        writeln!(self.ask, "{width} {PHOTONS} {seed}")?;
        let mut line = String::new();
        self.answer.read_line(&mut line)?;
        let numbers: Result<Vec<f64>, _> = line.split_whitespace().map(str::parse).collect();
        match numbers?[..] {
            [seconds, segments, events, escaped, _truncated, lost] => Ok(Round {
                seconds,
                segments,
                events,
                escaped,
                lost,
            }),
            _ => Err(format!("the Embree loop said {line:?}").into()),
        }
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // It only waits for more.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
