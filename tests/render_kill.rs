//! A rendering that is killed: never half a picture, never a wrong one, and it goes on where it was.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

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

#[test]
fn killed_at_any_moment_it_leaves_the_old_or_the_new_picture_and_goes_on() {
    let desk = tempfile::tempdir().unwrap();
    let command = |line: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_vair"));
        command
            .current_dir(desk.path())
            .args(line.split_whitespace());
        command
    };
    let run = |line: &str| assert!(command(line).status().unwrap().success(), "{line}");
    let read = |name: &str| std::fs::read(desk.path().join(name)).unwrap();
    let started = Instant::now();
    run(&format!("{RENDER} --spp 48 -o new.exr"));
    let whole = started.elapsed().as_micros() as u64 * 9 / 8;
    let new = read("new.exr");
    run(&format!("{RENDER} --spp 1 -o out.exr"));
    let old = read("out.exr");
    let line = format!("{RENDER} --spp 48 --checkpoint state --checkpoint-every 0.005 -o out.exr");
    let (mut olds, mut resumed) = (0, 0);
    for kill in 0..25 {
        let state = desk.path().join("state");
        if kill % 5 == 0 {
            // From the start again, else every later one would be a picture that is nearly done.
            std::fs::remove_file(&state).ok();
            std::fs::write(desk.path().join("out.exr"), &old).unwrap();
        }
        resumed += u32::from(state.exists());
        let mut child = command(&line).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_micros(hash(kill) % whole));
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
    let run = |line: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_vair"));
        command
            .current_dir(desk.path())
            .args(line.split_whitespace());
        assert!(command.status().unwrap().success(), "{line}");
    };
    let read = |name: &str| std::fs::read(desk.path().join(name)).unwrap();
    run(&format!("{RENDER} --spp 20 -o whole.exr -o whole.png"));
    run(&format!("{RENDER} --samples 0..7 -o a.safetensors"));
    run(&format!("{RENDER} --samples 7..20 -o b.safetensors"));
    run("-q merge b.safetensors a.safetensors -o merged.exr");
    run("-q merge a.safetensors b.safetensors -o merged.png");
    assert!(read("whole.exr") == read("merged.exr") && read("whole.png") == read("merged.png"));
}
