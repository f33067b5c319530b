//! Vair's rays through strands beside Embree's linear curves: `benches/embree/run.sh strands`, which compiles the
//! Embree side, or `cargo bench --bench strands -- PROGRAM [STRANDS] [--species NAME] [--rounds N]` with it compiled.
//!
//! A groom as `vair render` grows it, cut into segments by Vair; both sides get the same segments and the
//! same rays:
//!
//! - camera: a picture of 1024 x 1024, in the order of its lines;
//! - scattered: from where those hit, evenly over the sphere;
//! - second: from where scattered rays hit, evenly over the sphere;
//! - lamp: from where camera rays hit, toward one far lamp.
//!
//! Scattered rays of the renderer start inside the strand they leave, which is not there for the first bit of their
//! way. Embree has no such rule, so that here they start where it ends. Both sides say which segment is met and how far
//! away; rays as the renderer's, which learn of the closest also what shading has to know, come in a column of their own.
//! Both sides take turns, by the processor time of their threads.

#[path = "../clock/mod.rs"]
mod clock;

use clock::thread_seconds;
use glam::{Vec3, Vec4};
use std::hint::black_box;
use std::io::{BufRead, BufReader, BufWriter, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use vair::bsdf::HairMaterial;
use vair::color::Rgb;
use vair::groom::{GroomSettings, grow};
use vair::progress::{Cancel, Silent};
use vair::sampling::Rng;
use vair::scene::{Backdrop, Environment, Leaving, Ray, Scene, SceneParts, Strands, View};

const SIDE: u32 = 1024;
/// Rays handed to a thread at a time.
const PIECE: usize = 4096;

type Failure = Box<dyn std::error::Error>;

/// Rays of one kind, as both sides get them and as the renderer has them.
struct RaySet {
    name: &'static str,
    moved: Vec<Ray>,
    leaving: Vec<(Ray, Option<Leaving>)>,
}

fn main() -> Result<(), Failure> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let option = |name: &str| {
        let at = args.iter().position(|a| a == name)?;
        args.get(at + 1).cloned()
    };
    let Some(program) = args.iter().find(|a| a.contains('/')) else {
        println!("benches/embree/run.sh strands compiles the Embree side and runs this with it");
        return Ok(());
    };
    // A number of its own, not an option's.
    let is_own = |i: usize| i == 0 || !args[i - 1].starts_with("--");
    let mut own = (0..args.len()).filter(|&i| is_own(i));
    let strands = own.find_map(|i| args[i].parse().ok()).unwrap_or(100_000);
    let species = option("--species").unwrap_or_else(|| "red-fox".into());
    let rounds = option("--rounds").map_or(Ok(5), |n| n.parse())?;

    let scene = scene(&species, strands)?;
    let sets = ray_sets(&scene);
    let folder = tempfile::tempdir()?;
    let (file, results) = (
        folder.path().join("scene").display().to_string(),
        folder.path().join("results").display().to_string(),
    );
    let segments = write_scene(&file, &scene.strands, &sets)?;
    let mut embree = Embree::start(program, &file, &results)?;
    println!(
        "{species}, {strands} strands, {} segments; Embree's builds, flat and round: version, seconds, seconds of processor, bytes: {}",
        segments.len(),
        embree.builds.trim()
    );
    for (i, set) in sets.iter().enumerate() {
        cross_check(&mut embree, i, set, &scene.strands, &segments, &results)?;
    }
    println!(
        "M rays/s a core     threads |   Vair  Embree flat   round |  Vair over flat, over round | as the renderer's"
    );
    for (i, set) in sets.iter().enumerate() {
        for query in ["closest", "occluded"] {
            for threads in [1, 2] {
                compare(&mut embree, i, set, &scene.strands, query, threads, rounds)?;
            }
        }
    }
    Ok(())
}

fn scene(species: &str, strands: usize) -> Result<Scene, Failure> {
    let body = vair::skin::load("body")?;
    let species = vair::species::load(species, &[])?;
    let settings = GroomSettings {
        strands: Some(strands),
        seed: 0,
    };
    let started = std::time::Instant::now();
    let groom = grow(&body, &species, &settings, &Silent, &Cancel::default())?;
    let grown = started.elapsed().as_secs_f64();
    let before = (clock::processor_seconds(), resident_mb());
    let started = std::time::Instant::now();
    let scene = Scene::build(SceneParts {
        groom: &groom,
        materials: vec![HairMaterial::Isotropic(Rgb::ONE); groom.classes.len()],
        skin: None,
        environment: Environment::white(),
        lamps: &[],
        backdrop: Backdrop::default(),
        ground: None,
        view: View::default(),
    })?;
    println!(
        "grown in {grown:.2} s; built in {:.2} s, {:.2} s of processor time, {:.0} MB more resident",
        started.elapsed().as_secs_f64(),
        clock::processor_seconds() - before.0,
        resident_mb() - before.1
    );
    Ok(scene)
}

fn resident_mb() -> f64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = text.split_whitespace().nth(1).map(str::parse::<f64>);
    pages.and_then(Result::ok).unwrap_or(0.0) * 4096e-6
}

fn ray_sets(scene: &Scene) -> Vec<RaySet> {
    let camera = scene.camera(1.0);
    let primary: Vec<Ray> = (0..SIDE * SIDE)
        .map(|i| {
            let at = |k: u32| (k as f32 + 0.5) / SIDE as f32;
            camera.ray(at(i % SIDE), at(i / SIDE))
        })
        .collect();
    let none = |ray: &Ray| (*ray, None);
    let first: Vec<(Ray, Option<Leaving>)> = primary.iter().map(none).collect();
    let scattered = scatter(scene, &first, |i| sphere(&mut Rng::new(1, i)));
    let second = scatter(scene, &scattered, |i| sphere(&mut Rng::new(2, i)));
    let lamp = Vec3::new(0.5, 0.8, 0.3).normalize();
    let lamp = scatter(scene, &first, |_| lamp);
    let set = |name, leaving: Vec<(Ray, Option<Leaving>)>| RaySet {
        name,
        moved: (leaving.iter())
            .map(|(ray, leaving)| Ray {
                origin: ray.origin + leaving.map_or(0.0, |l| l.clear()) * ray.dir,
                dir: ray.dir,
            })
            .collect(),
        leaving,
    };
    vec![
        set("camera", first),
        set("scattered", scattered),
        set("second", second),
        set("lamp", lamp),
    ]
}

/// Rays that go on from where others hit.
fn scatter(
    scene: &Scene,
    rays: &[(Ray, Option<Leaving>)],
    dir: impl Fn(u64) -> Vec3,
) -> Vec<(Ray, Option<Leaving>)> {
    let on = |(i, (ray, leaving)): (usize, &(Ray, Option<Leaving>))| {
        let hit = scene.strands.closest(ray, f32::INFINITY, *leaving)?;
        let dir = dir(i as u64);
        let origin = ray.origin + hit.t * ray.dir;
        Some((Ray { origin, dir }, Some(hit.departure().along(dir))))
    };
    rays.iter().enumerate().filter_map(on).collect()
}

fn sphere(rng: &mut Rng) -> Vec3 {
    let z = 1.0 - 2.0 * rng.uniform_f32();
    let (sin, cos) = (std::f32::consts::TAU * rng.uniform_f32()).sin_cos();
    let flat = (1.0 - z * z).sqrt();
    Vec3::new(flat * cos, flat * sin, z)
}

/// Writes what both sides trace and gives the first joint of each segment.
fn write_scene(path: &str, strands: &Strands, sets: &[RaySet]) -> Result<Vec<u32>, Failure> {
    let joints: Vec<(u32, Vec4)> = strands.joints().collect();
    let segments: Vec<u32> = (1..joints.len())
        .filter(|&j| joints[j - 1].0 == joints[j].0)
        .map(|j| j as u32 - 1)
        .collect();
    let mut out = BufWriter::new(std::fs::File::create(path)?);
    for n in [joints.len(), segments.len(), sets.len()] {
        out.write_all(&(n as u32).to_le_bytes())?;
    }
    for x in joints.iter().flat_map(|j| j.1.to_array()) {
        out.write_all(&x.to_le_bytes())?;
    }
    for j in &segments {
        out.write_all(&j.to_le_bytes())?;
    }
    for set in sets {
        out.write_all(&(set.moved.len() as u32).to_le_bytes())?;
        for x in (set.moved.iter()).flat_map(|r| [r.origin.to_array(), r.dir.to_array()].concat()) {
            out.write_all(&x.to_le_bytes())?;
        }
    }
    out.flush()?;
    Ok(segments)
}

/// Says how many rays meet the same on both sides.
fn cross_check(
    embree: &mut Embree,
    index: usize,
    set: &RaySet,
    strands: &Strands,
    segments: &[u32],
    results: &str,
) -> Result<(), Failure> {
    embree.ask(index, "flat", "write", 1)?;
    let results = std::fs::read(results)?;
    let joints: Vec<(u32, Vec4)> = strands.joints().collect();
    let (mut same, mut near, mut start) = (0, 0, 0);
    for (ray, result) in set.moved.iter().zip(results.chunks_exact(8)) {
        let word = |k: usize| [0, 1, 2, 3].map(|i| result[k + i]);
        let (segment, t) = (u32::from_le_bytes(word(0)), f32::from_le_bytes(word(4)));
        let theirs = segments.get(segment as usize);
        let ours = strands.closest(ray, f32::INFINITY, None);
        let close = |a: f32| (a - t).abs() <= 1e-3 + 1e-5 * t;
        match (&ours, theirs) {
            (Some(hit), Some(&joint))
                if strands.joint_of(hit) == joint as usize && close(hit.t) =>
            {
                same += 1
            }
            (None, None) => same += 1,
            (Some(hit), Some(_)) if close(hit.t) => near += 1,
            (Some(hit), _) => {
                // Embree takes no hit nearer than a width.
                let [a, b] = [0, 1].map(|k| joints[strands.joint_of(hit) + k].1.w);
                let width = 2.0 * a.max(b) * (1.0 + 1e-5);
                start += u32::from(hit.t <= width);
            }
            _ => {}
        }
    }
    let of = 100.0 / set.moved.len() as f64;
    println!(
        "{:>10}: {} rays, {:.3} % meet the same segment at the same distance or nothing, {:.3} % another at the \
         same distance, {:.3} % one nearer than its width, which Embree leaves out, {:.4} % something else",
        set.name,
        set.moved.len(),
        f64::from(same) * of,
        f64::from(near) * of,
        f64::from(start) * of,
        (set.moved.len() as f64 - f64::from(same + near) - f64::from(start)) * of
    );
    Ok(())
}

fn compare(
    embree: &mut Embree,
    index: usize,
    set: &RaySet,
    strands: &Strands,
    query: &str,
    threads: usize,
    rounds: usize,
) -> Result<(), Failure> {
    let far = f32::INFINITY;
    let mut all: Vec<[f64; 4]> = Vec::new();
    for _ in 0..rounds {
        let vair = in_pieces(&set.moved, threads, |ray| match query {
            "closest" => strands.nearest(ray, far, None).is_some(),
            _ => strands.occluded(ray, far, None),
        });
        let (flat, _) = embree.ask(index, "flat", query, threads)?;
        let (round, _) = embree.ask(index, "round", query, threads)?;
        let own = in_pieces(&set.leaving, threads, |(ray, leaving)| match query {
            "closest" => strands.closest(ray, far, *leaving).is_some(),
            _ => strands.occluded(ray, far, *leaving),
        });
        let rays = 1e-6 * set.moved.len() as f64;
        all.push([rays / vair, rays / flat, rays / round, rays / own]);
    }
    let best = |k: usize| all.iter().map(|r| r[k]).fold(0.0, f64::max);
    let over = |k: usize| median(all.iter().map(|r| r[0] / r[k]));
    println!(
        "{:>10} {query:<8} {threads:>8} | {:6.3}       {:6.3}  {:6.3} | {:15.3}  {:10.3} | {:6.3}",
        set.name,
        best(0),
        best(1),
        best(2),
        over(1),
        over(2),
        best(3)
    );
    Ok(())
}

/// Seconds of processor time that all threads together take for some rays.
fn in_pieces<T: Sync>(rays: &[T], threads: usize, test: impl Fn(&T) -> bool + Sync) -> f64 {
    let next = AtomicUsize::new(0);
    let work = || {
        let start = thread_seconds();
        while let Some(piece) = rays.chunks(PIECE).nth(next.fetch_add(1, Ordering::Relaxed)) {
            for ray in piece {
                black_box(test(ray));
            }
        }
        thread_seconds() - start
    };
    std::thread::scope(|scope| {
        let others: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        let seconds = others.into_iter().filter_map(|other| other.join().ok());
        seconds.sum()
    })
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The Embree side, waiting for the next question.
struct Embree {
    child: Child,
    ask: ChildStdin,
    answer: BufReader<ChildStdout>,
    builds: String,
}

impl Embree {
    fn start(program: &str, scene: &str, results: &str) -> Result<Self, Failure> {
        let mut child = (Command::new(program).args([scene, results]))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let ask = child.stdin.take().ok_or("no pipe")?;
        let mut answer = BufReader::new(child.stdout.take().ok_or("no pipe")?);
        let mut builds = String::new();
        answer.read_line(&mut builds)?;
        Ok(Self {
            child,
            ask,
            answer,
            builds,
        })
    }

    /// Seconds of processor time and hits.
    fn ask(
        &mut self,
        set: usize,
        kind: &str,
        query: &str,
        threads: usize,
    ) -> Result<(f64, u64), Failure> {
        writeln!(self.ask, "{set} {kind} {query} {threads}")?;
        let mut line = String::new();
        self.answer.read_line(&mut line)?;
        let mut words = line.split_whitespace();
        match (words.next(), words.next()) {
            (Some(seconds), Some(hits)) => Ok((seconds.parse()?, hits.parse()?)),
            _ => Err(format!("the Embree side said {line:?}").into()),
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
