//! `vair export` from outside: what it writes, what it refuses, what it leaves behind.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn export(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_vair"))
        .current_dir(folder)
        .args(["export", "red-fox", "--skin", "ball", "--no-material"])
        .args(arguments)
        .output()
        .unwrap()
}

fn refused(arguments: &[&str], words: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let output = export(folder.path(), arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {said}");
    for word in words {
        assert!(said.contains(word), "{arguments:?}: no {word:?} in {said}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn what_cannot_be_written_is_refused_with_a_remedy() {
    refused(&["-o", "fox.abc"], &["fox.abc", ".usdc"]);
    refused(
        &["--profile", "maxwell", "-o", "fox.usdc"],
        &["maxwell", "blender"],
    );
    refused(
        &["--levels", "9", "-o", "fox.usdc"],
        &["--levels", "1 to 4"],
    );
    refused(&["--strands", "0", "-o", "fox.usdc"], &["0 strands"]);
    refused(
        &["--strands", "5e6", "-o", "fox.usda"],
        &["of text", ".usdc"],
    );
}

#[test]
fn size_is_said_before_and_counts_after() {
    let folder = tempfile::tempdir().unwrap();
    let output = export(folder.path(), &["--strands", "4000", "-o", "fox.usdc"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    assert!(
        said.contains("4000 strands of 32000 points: about"),
        "{said}"
    );
    assert!(said.contains("fox.usdc: full"), "{said}");
    let size = fs::metadata(folder.path().join("fox.usdc")).unwrap().len() as f64;
    let (_, rest) = said.split_once("about ").unwrap();
    let foretold: f64 = rest.split_once(" MB").unwrap().0.parse().unwrap();
    // The viewport's curves come on top; here they are half as many as those for pictures.
    assert!(
        (0.5..1.1).contains(&(1e6 * foretold / size)),
        "{foretold} MB, {size} bytes"
    );
}

#[test]
fn a_payload_goes_beside_the_interface() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["--strands", "500", "--layout", "payload", "-o", "fox.usda"];
    assert!(export(folder.path(), &arguments).status.success());
    let interface = fs::read_to_string(folder.path().join("fox.usda")).unwrap();
    assert!(interface.contains("prepend payload = @./fox.payload.usdc@"));
    assert!(interface.contains("extentsHint") && interface.len() < 50_000);
    assert!(folder.path().join("fox.payload.usdc").exists());
}

#[test]
fn names_may_have_the_sign_that_ends_a_path() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [
        "--strands",
        "500",
        "--layout",
        "payload",
        "-o",
        "fox@2x.usda",
    ];
    assert!(export(folder.path(), &arguments).status.success());
    let interface = fs::read_to_string(folder.path().join("fox@2x.usda")).unwrap();
    assert!(interface.contains("identifier = @@@./fox@2x.usda@@@\n"));
    assert!(interface.contains("payload = @@@./fox@2x.payload.usdc@@@\n"));
}

#[test]
fn the_bytes_do_not_depend_on_threads() {
    let folder = tempfile::tempdir().unwrap();
    let written = |threads: &str| {
        let file = format!("{threads}/fox.usd");
        fs::create_dir(folder.path().join(threads)).unwrap();
        let arguments = ["--strands", "9000", "--threads", threads, "-o", &file];
        assert!(export(folder.path(), &arguments).status.success());
        fs::read(folder.path().join(file)).unwrap()
    };
    assert!(written("1") == written("4"));
}
