//! Refused species files: every report, to the letter.
//!
//! Each file of `tests/ui/species` ends with the reports that it has to give, one a line after `#~`,
//! as `line:column: message (hint)`. Lines after `#!` are overrides that it is read with.

#![allow(clippy::unwrap_used)] // all of it is test

use std::path::{Path, PathBuf};
use vair::species::{SpeciesErrors, parse};

fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/ui/species");
    let entries = std::fs::read_dir(folder).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|e| e.unwrap().path()).collect();
    files.sort();
    files
}

fn marked(text: &str, mark: &str) -> Vec<String> {
    let lines = text.lines().filter_map(|line| line.strip_prefix(mark));
    lines.map(|line| line.trim().to_owned()).collect()
}

fn reports(errors: &SpeciesErrors) -> Vec<String> {
    let plain = |line: String| line.trim_start_matches("file:").to_owned();
    errors
        .problems
        .iter()
        .map(|p| plain(errors.line(p)))
        .collect()
}

#[test]
fn every_report_is_the_expected_one() {
    let mut wrong = String::new();
    for path in files() {
        let text = std::fs::read_to_string(&path).unwrap();
        let found = match parse(&text, "test", "file", &marked(&text, "#!")) {
            Ok(_) => Vec::new(),
            Err(errors) => reports(&errors),
        };
        if found != marked(&text, "#~") {
            wrong += &format!("\n{} gives\n", path.display());
            for line in found {
                wrong += &format!("#~ {line}\n");
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn the_command_shows_the_line_and_exits_with_1() {
    let path = "tests/ui/species/unknown-keys.toml";
    let output = vair(&["species", "check", path]);
    assert_eq!(output.status.code(), Some(1));
    assert!(output.stdout.is_empty());
    let report = String::from_utf8(output.stderr).unwrap();
    assert!(report.contains("is refused: 9 problems"), "{report}");
    assert!(report.contains("pich_um = 12"), "{report}");
    assert!(report.contains("did you mean `pitch_um`?"), "{report}");
}

#[test]
fn the_command_accepts_good_files_and_names_bad_ones() {
    let good = vair(&["species", "check", "procedural/species/mink.toml"]);
    assert_eq!(good.status.code(), Some(0));
    assert!(
        String::from_utf8(good.stdout)
            .unwrap()
            .contains("mink.toml: good. 2 hair classes")
    );
    for (arguments, code) in [
        (&["species", "show", "minke"][..], 1),
        (&["species", "show", "mink", "--set", "ior=1"], 1),
        (&["species", "check", "missing.toml"], 1),
        (&["species", "show", "mink", "--json"], 0),
        (&["species", "list", "--json"], 0),
        (&["species"], 0),
        (&["schema", "species"], 0),
    ] {
        let output = vair(arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
        assert_eq!(output.stderr.is_empty(), code == 0, "{arguments:?}");
    }
}

fn vair(arguments: &[&str]) -> std::process::Output {
    std::process::Command::new(env!("CARGO_BIN_EXE_vair"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(arguments)
        .output()
        .unwrap()
}
