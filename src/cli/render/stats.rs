//! What a rendering cost, as JSON: wall and processor seconds by stage, rays, memory.

use crate::io::{AtomicFile, FileError};
use crate::render::Film;
use crate::scene::Scene;
use serde_json::{Map, Value, json};
use std::path::Path;
use std::time::Instant;

/// Times of the stages so far.
pub(super) struct Stages {
    stages: Map<String, Value>,
    since: Instant,
    cpu: Option<f64>,
}

impl Stages {
    pub(super) fn begin() -> Self {
        Self {
            stages: Map::new(),
            since: Instant::now(),
            cpu: cpu_seconds(),
        }
    }

    /// Ends a stage; the next begins.
    pub(super) fn end(&mut self, name: &str) {
        let cpu = cpu_seconds();
        let spent = cpu.zip(self.cpu).map(|(now, before)| now - before);
        let stage = json!({ "wall_s": self.since.elapsed().as_secs_f64(), "cpu_s": spent });
        self.stages.insert(name.to_owned(), stage);
        (self.since, self.cpu) = (Instant::now(), cpu);
    }

    /// Writes all to a file.
    pub(super) fn write(&self, path: &Path, scene: &Scene, film: &Film) -> Result<(), FileError> {
        let report = &film.report;
        let text = json!({
            "stages": self.stages,
            "strand_segments": scene.strands.segments(),
            "samples": report.samples,
            "rays": report.rays,
            "rays_per_sample": report.rays as f64 / report.samples.max(1) as f64,
            "dropped": report.dropped,
            "capped": report.capped,
            "noise": film.noise(),
            "peak_mb": peak_mb(),
        });
        AtomicFile::write_all_to(path, format!("{text:#}\n").as_bytes())
    }
}

/// Processor seconds of this process so far, in steps of a hundredth; known on Linux.
fn cpu_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The name of the program, in parentheses, may hold anything; user and system time are the 12th and
    // 13th fields behind it, in hundredths of a second.
    let mut fields = stat.get(stat.rfind(')')? + 1..)?.split_ascii_whitespace();
    let user: f64 = fields.nth(11)?.parse().ok()?;
    let system: f64 = fields.next()?.parse().ok()?;
    Some((user + system) / 100.0)
}

/// Most memory this process held, mebibytes; known on Linux.
fn peak_mb() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: u64 = line.split_ascii_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes / 1024)
}
