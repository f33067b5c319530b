//! A rendering that is killed: never half a picture, never a wrong one, and it goes on where it was.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Numbers without a pattern from a counter (SplitMix64).
fn hash(index: u64) -> u64 {
    let mut z = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z ^ (z >> 27)
}

/// No bake, a small ball of fur.
const RENDER: &str = "-q render red-fox --model chiang --skin ball --strands 800 --res 32x24 --no-ground --threads 1";

/// The command of a line, in a folder.
fn command(folder: &Path, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vair"));
    command.current_dir(folder).args(line.split_whitespace());
    command
}

fn run(folder: &Path, line: &str) {
    assert!(command(folder, line).status().unwrap().success(), "{line}");
}

#[test]
fn killed_at_any_moment_it_leaves_the_old_or_the_new_picture_and_goes_on() {
    let desk = tempfile::tempdir().unwrap();
    let run = |line: &str| run(desk.path(), line);
    let read = |name: &str| std::fs::read(desk.path().join(name)).unwrap();
    // In white light little is made ready: most of the time goes into samples.
    let render = format!("{RENDER} --env white --spp 600");
    let started = Instant::now();
    run(&format!("{render} -o new.exr"));
    let whole = started.elapsed().as_micros() as u64 * 9 / 8;
    let new = read("new.exr");
    run(&format!("{RENDER} --spp 1 -o out.exr"));
    let old = read("out.exr");
    let line = format!("{render} --checkpoint state --checkpoint-every 5ms -o out.exr");
    let (mut olds, mut resumed) = (0, 0);
    for kill in 0..25 {
        let state = desk.path().join("state");
        if kill % 5 == 0 {
            // From the start again, else every later one would be a picture that is nearly done.
            std::fs::remove_file(&state).ok();
            std::fs::write(desk.path().join("out.exr"), &old).unwrap();
        }
        resumed += u32::from(state.exists());
        let mut child = command(desk.path(), &line)
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // The first of every five waits for a state to go on from, on a machine of any speed.
        while kill % 5 == 0 && !state.exists() && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_micros(match kill % 5 {
            0 => hash(kill) % (whole / 8),
            _ => hash(kill) % whole,
        }));
        child.kill().unwrap();
        child.wait().unwrap();
        let out = read("out.exr");
        assert!(out == old || out == new, "neither old nor new");
        olds += u32::from(out == old);
    }
    assert!(olds > 0 && resumed > 0, "{olds} {resumed}");
    run(&line);
    assert!(read("out.exr") == new, "another picture than in one run");
    assert!(!desk.path().join("state").exists());
}

#[test]
fn ranges_merged_are_one_run_to_the_byte() {
    let desk = tempfile::tempdir().unwrap();
    let run = |line: &str| run(desk.path(), line);
    let read = |name: &str| std::fs::read(desk.path().join(name)).unwrap();
    run(&format!("{RENDER} --spp 20 -o whole.exr -o whole.png"));
    run(&format!("{RENDER} --samples 0..7 -o a.safetensors"));
    run(&format!("{RENDER} --samples 7..20 -o b.safetensors"));
    run("-q merge b.safetensors a.safetensors -o merged.exr");
    run("-q merge a.safetensors b.safetensors -o merged.png");
    assert!(read("whole.exr") == read("merged.exr") && read("whole.png") == read("merged.png"));
}

/// What is no checkpoint of this picture is not written over.
#[test]
fn a_checkpoint_of_something_else_is_left_alone() {
    let desk = tempfile::tempdir().unwrap();
    let state = desk.path().join("state");
    let refused = |line: &str| {
        let before = std::fs::read(&state).unwrap();
        let out = command(desk.path(), line).output().unwrap();
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(1), "{said}");
        assert!(
            said.contains("state") && said.contains("--checkpoint"),
            "{said}"
        );
        assert!(std::fs::read(&state).unwrap() == before);
        said
    };
    let line = format!("{RENDER} --spp 2 --checkpoint state -o out.exr");
    std::fs::write(&state, "my picture").unwrap();
    refused(&line);
    run(
        desk.path(),
        &format!("{RENDER} --spp 2 -o part.safetensors"),
    );
    std::fs::rename(desk.path().join("part.safetensors"), &state).unwrap();
    // The same samples with another look of what is behind the subject, and of another coat.
    for other in ["--env-visible", "--env white", "--coat cow"] {
        let said = refused(&format!("{line} {other}"));
        assert!(said.contains("the scene"), "{said}");
    }
    run(desk.path(), &line);
    assert!(!state.exists());
    // The same name, another environment in it.
    let env = desk.path().join("env.exr");
    let paint = |gray: f32| exr::prelude::write_rgb_file(&env, 16, 8, |_, _| (gray, gray, gray));
    paint(1.0).unwrap();
    let line = format!("{line} --env env.exr");
    run(desk.path(), &format!("{line} -o part.safetensors"));
    std::fs::rename(desk.path().join("part.safetensors"), &state).unwrap();
    paint(0.5).unwrap();
    assert!(refused(&line).contains("the scene"));
}

/// Where the checkpoint cannot be, the picture is not begun.
#[test]
fn a_checkpoint_that_cannot_be_written_is_refused_first() {
    let desk = tempfile::tempdir().unwrap();
    let line = format!("{RENDER} --spp 2 --checkpoint no/state -o out.exr");
    let out = command(desk.path(), &line).output().unwrap();
    assert!(!out.status.success());
    assert!(String::from_utf8_lossy(&out.stderr).contains("no/state"));
    assert!(!desk.path().join("out.exr").exists());
}
