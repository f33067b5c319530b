//! A bake that is stopped, killed or asked again: never half a file, never a wrong table.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

struct Desk(TempDir);

impl Desk {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The files beside each other here, in another place.
    fn copied(&self) -> Self {
        let copy = Self::new();
        for file in std::fs::read_dir(self.0.path()).unwrap() {
            let file = file.unwrap();
            if file.file_type().unwrap().is_file() {
                std::fs::copy(file.path(), copy.0.path().join(file.file_name())).unwrap();
            }
        }
        copy
    }

    fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_vair"));
        command
            .current_dir(self.0.path())
            .env("VAIR_CACHE", self.at("cache"))
            .env("NO_COLOR", "1")
            .args(line.split_whitespace());
        command
    }

    fn spawn(&self, line: &str) -> Child {
        let mut command = self.command(line);
        command.stderr(Stdio::null()).spawn().unwrap()
    }

    /// Runs a command that must succeed; what it said.
    fn run(&self, line: &str) -> String {
        let output = self.command(line).output().unwrap();
        assert!(output.status.success(), "{line}: {}", said(&output));
        said(&output)
    }

    fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.at(name)).unwrap()
    }
}

fn said(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr).replace('│', " ");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Numbers without a pattern from a counter (SplitMix64).
fn hash(index: u64) -> u64 {
    let mut z = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A small table from many photons: a fifth of a second of flying, little of writing.
const BAKE: &str = "bake glass-cylinder --face 16 --bins 4 --photons 400001";

/// 25 kills at any moment, from before the first photon to after the rename.
#[test]
fn killed_at_any_moment_it_leaves_the_old_or_the_new_table() {
    let desk = Desk::new();
    let start = Instant::now();
    desk.run(&format!("{BAKE} --no-cache --threads 1 -o new.exr"));
    // Most of that is the bake; kills are spread over a little more than all of it.
    let whole = start.elapsed().as_micros() as u64 * 9 / 8;
    let new = desk.read("new.exr");
    desk.run("bake glass-cylinder --face 16 --bins 4 --photons 1000 --no-cache -o out.exr");
    let old = desk.read("out.exr");
    let bake = format!("{BAKE} --no-cache --threads 1 --checkpoint-every 5ms -o out.exr");
    let (mut olds, mut checkpoints) = (0, 0);
    for kill in 0..25 {
        let mut child = desk.spawn(&bake);
        std::thread::sleep(Duration::from_micros(hash(kill) % whole));
        child.kill().unwrap();
        child.wait().unwrap();
        let out = desk.read("out.exr");
        assert!(out == old || out == new, "kill {kill}: {} bytes", out.len());
        olds += u32::from(out == old);
        checkpoints += u32::from(desk.at("out.exr.checkpoint").exists());
        // What it left goes on to the same bytes. The next one is killed where this one was, so that
        // some go on from a kill after a kill; those that were done begin anew.
        let copy = desk.copied();
        copy.run(&bake);
        assert!(
            copy.read("out.exr") == new,
            "kill {kill}: resumed otherwise"
        );
        assert!(!copy.at("out.exr.checkpoint").exists());
        if out == new {
            std::fs::write(desk.at("out.exr"), &old).unwrap();
        }
    }
    assert!(olds > 5 && checkpoints > 3, "{olds} {checkpoints}");
}

/// Waits until a file is there.
fn wait_for(path: &Path) {
    let start = Instant::now();
    while !path.exists() {
        assert!(
            start.elapsed() < Duration::from_secs(60),
            "{}",
            path.display()
        );
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[cfg(unix)]
fn send(signal: &str, child: &Child) {
    let pid = child.id().to_string();
    let sent = Command::new("kill").args(["-s", signal, &pid]).status();
    assert!(sent.unwrap().success());
}

/// A folder in the place of a file, whoever writes that file.
#[cfg(unix)]
fn block(path: &Path) {
    loop {
        let _ = std::fs::remove_file(path);
        if std::fs::create_dir(path).is_ok() {
            return;
        }
    }
}

#[cfg(unix)]
#[test]
fn a_signal_keeps_the_work_and_the_same_command_goes_on() {
    let desk = Desk::new();
    let bake = |output: &str| {
        format!(
            "bake glass-cylinder --face 16 --bins 4 --photons 3000001 --checkpoint-every 5ms -o {output}"
        )
    };
    desk.run(&format!("{} --no-cache", bake("whole.exr")));
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let mut child = desk.spawn(&bake("out.exr"));
        let name = || {
            let files = std::fs::read_dir(desk.at("cache")).ok()?;
            let paths = files.map(|file| file.unwrap().path());
            paths
                .filter(|path| path.extension().is_some_and(|e| e == "safetensors"))
                .find(|path| !path.to_string_lossy().contains(".part"))
        };
        while name().is_none() {
            std::thread::sleep(Duration::from_millis(2));
        }
        send(signal, &child);
        let status = child.wait().unwrap();
        assert_eq!(status.code(), Some(code));
        // The table of what was done, stated as such, and the sums to go on from.
        let info = desk.command("table info out.exr --json").output().unwrap();
        assert!(info.status.success());
        assert!(desk.read("out.exr") != desk.read("whole.exr"));
        assert!(desk.run(&bake("out.exr")).contains("going on from"));
        assert!(desk.read("out.exr") == desk.read("whole.exr"));
        desk.run("cache clear");
    }
}

/// The checkpoint cannot be written for a while, and the output in the end.
#[cfg(unix)]
#[test]
fn what_cannot_be_written_is_kept_and_said() {
    let desk = Desk::new();
    let bake = "bake glass-cylinder --face 16 --bins 4 --threads 1 --no-cache -o out.exr";
    let run = format!("{bake} --photons 1e10 --checkpoint-every 10ms --preview-every 10ms");
    let child = desk.command(&run).stderr(Stdio::piped()).spawn().unwrap();
    wait_for(&desk.at("out.exr"));
    let checkpoint = desk.at("out.exr.checkpoint");
    block(&checkpoint);
    // Some passes of a second at most.
    std::thread::sleep(Duration::from_millis(2500));
    std::fs::remove_dir(&checkpoint).unwrap();
    wait_for(&checkpoint);
    block(&desk.at("out.exr"));
    send("INT", &child);
    let output = child.wait_with_output().unwrap();
    let text = said(&output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert_eq!(text.matches("no checkpoint for now").count(), 1, "{text}");
    assert!(text.contains("out.exr: it is a folder"), "{text}");
    let kept = text.split("checkpoint keeps the ").nth(1).expect(&text);
    let photons = kept.split(' ').next().unwrap();
    std::fs::remove_dir(desk.at("out.exr")).unwrap();
    let again = desk.run(&format!("{bake} --photons {photons}"));
    let going_on = format!("going on from {photons} photons");
    assert!(again.contains(&going_on), "{again}");
    let resumed = desk.read("out.exr");
    desk.run(&format!("{bake} --photons {photons} --restart"));
    assert!(resumed == desk.read("out.exr"));
}

#[test]
fn a_finished_bake_is_found_and_more_photons_are_added_to_it() {
    let desk = Desk::new();
    let bake = |photons: u64, rest: &str| {
        format!("bake glass-cylinder --face 16 --bins 4 --photons {photons} {rest}")
    };
    assert!(!desk.run(&bake(50_000, "-o a.exr")).contains("going on"));
    assert!(
        desk.run(&bake(50_000, "-o b.exr"))
            .contains("the cache holds")
    );
    assert!(desk.read("a.exr") == desk.read("b.exr"));
    // Nothing is thrown away to bake less, and more goes on from the most.
    desk.run(&bake(20_000, "-o less.exr"));
    let more = desk.run(&bake(90_000, "-o more.exr"));
    assert!(more.contains("going on from 50000 photons"), "{more}");
    desk.run(&bake(90_000, "--no-cache -o fresh.exr"));
    assert!(desk.read("more.exr") == desk.read("fresh.exr"));
    desk.run(&bake(20_000, "--no-cache -o fresh.exr"));
    assert!(desk.read("less.exr") == desk.read("fresh.exr"));
}

#[test]
fn stopped_by_a_goal_it_says_with_how_many_photons() {
    let desk = Desk::new();
    let bake = "bake glass-cylinder --face 16 --bins 4 --no-cache";
    for goal in ["--time 50ms", "--target-error 5%"] {
        let said = desk.run(&format!("{bake} {goal} -o goal.exr"));
        let photons = said.split("--photons ").nth(1).unwrap();
        let photons = photons.split(' ').next().unwrap();
        desk.run(&format!("{bake} --photons {photons} -o again.exr"));
        assert!(desk.read("goal.exr") == desk.read("again.exr"), "{goal}");
    }
}

#[test]
fn a_foreign_checkpoint_is_refused_and_a_damaged_one_ignored() {
    let desk = Desk::new();
    let bake = format!("{BAKE} --no-cache --checkpoint-every 1ms -o out.exr");
    let checkpoint = desk.at("out.exr.checkpoint");
    let mut child = desk.spawn(&bake);
    wait_for(&checkpoint);
    child.kill().unwrap();
    child.wait().unwrap();
    let kept = std::fs::read(&checkpoint).unwrap();
    let output = desk.command(&format!("{bake} --seed 7")).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let said = said(&output);
    for word in [
        "out.exr.checkpoint",
        "settings.seed is 0, not 7",
        "--restart",
    ] {
        assert!(said.contains(word), "{said}");
    }
    let output = desk
        .command(&format!("{bake} --photon-seed 7"))
        .output()
        .unwrap();
    let said = self::said(&output);
    assert!(said.contains("settings.photon_seed is 0, not 7"), "{said}");
    assert!(std::fs::read(&checkpoint).unwrap() == kept);
    desk.run(&format!("{bake} --seed 7 --restart"));
    assert!(!checkpoint.exists());

    let mut damaged = kept.clone();
    let last = damaged.len() - 1000;
    damaged[last] ^= 4;
    std::fs::write(&checkpoint, damaged).unwrap();
    let said = desk.run(&bake);
    assert!(
        said.contains("checksum") && said.contains("starting anew"),
        "{said}"
    );
    desk.run(&format!("{BAKE} --no-cache -o whole.exr"));
    assert!(desk.read("out.exr") == desk.read("whole.exr"));
}

#[test]
fn memory_is_refused_before_the_work_and_threads_adapt_to_it() {
    let desk = Desk::new();
    let bake = "bake glass-cylinder --photons 10000 --no-cache -o out.exr --threads 3";
    let output = desk
        .command(&format!("{bake} --memory 50M"))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("needs") && said(&output).contains("50 MB are allowed"));
    assert!(!desk.at("out.exr").exists());
    desk.run(bake);
    let free = desk.read("out.exr");
    desk.run(&format!("{bake} --memory 200M"));
    assert!(free == desk.read("out.exr"));
}
