//! `vair table` from outside: what it prints, what it refuses, what it leaves behind.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::path::Path;
use std::process::Command;
use vair::table::{Ledger, Mode, Nodes, PHOTON, Provenance, StructureTable};

/// A table that scatters evenly; each level halves the light.
fn even(path: &Path) {
    let (bins, res) = (4, 8);
    let texels = 6 * res * res;
    let levels = vec![0.0, 0.5, 1.0];
    let mut table = StructureTable {
        nodes: Nodes::new(Mode::Paper, bins),
        res,
        levels: levels.clone(),
        radius_um: 20.0,
        flux: Vec::new(),
        error: vec![0.5; bins * texels],
        ledger: Vec::new(),
        provenance: Provenance {
            species: "even".into(),
            class: "guard".into(),
            ..Provenance::default()
        },
    };
    for i in 0..bins * levels.len() {
        let escaped = (PHOTON * 1000) >> (i % levels.len());
        let share = escaped as f64 / (PHOTON * 1000) as f64;
        let flux = (share / texels as f64) as f32;
        table.flux.extend(std::iter::repeat_n(flux, texels));
        table.ledger.push(Ledger {
            emitted: PHOTON * 1000,
            escaped,
            absorbed: PHOTON * 1000 - escaped,
            ..Ledger::default()
        });
    }
    table.write(path).unwrap();
}

fn vair() -> Command {
    Command::new(env!("CARGO_BIN_EXE_vair"))
}

#[test]
fn info_dye_and_plot_work_together() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    even(&at("even.exr"));
    let info = vair()
        .arg("table")
        .arg("info")
        .arg(at("even.exr"))
        .arg("--json")
        .output()
        .unwrap();
    let json: serde_json::Value = serde_json::from_slice(&info.stdout).unwrap();
    assert_eq!(json["kind"], "structure");
    assert_eq!(json["photons"], 4000.0);
    assert_eq!(json["bins"][0]["theta_to_deg"], 90.0);
    assert_eq!(
        json["bins"][3]["albedo"],
        serde_json::json!([1.0, 0.5, 0.25])
    );
    assert_eq!(json["bins"][1]["ledger"][0]["emitted"], PHOTON * 1000);

    let dye = ["--absorption", "0,0.025,0.05"];
    let mut command = vair();
    command
        .args(["table", "dye"])
        .arg(at("even.exr"))
        .arg("-o")
        .arg(at("rgb.exr"))
        .args(dye);
    assert!(command.status().unwrap().success());
    let info = vair()
        .arg("table")
        .arg("info")
        .arg(at("rgb.exr"))
        .arg("--json")
        .output()
        .unwrap();
    let json: serde_json::Value = serde_json::from_slice(&info.stdout).unwrap();
    for (channel, expected) in [1.0, 0.5, 0.25].into_iter().enumerate() {
        let albedo = json["bins"][2]["albedo"][channel].as_f64().unwrap();
        assert!((albedo - expected).abs() < 1e-5, "{albedo}");
    }

    let mut command = vair();
    command
        .args(["table", "plot"])
        .arg(at("rgb.exr"))
        .arg("-o")
        .arg(at("rgb.png"));
    command.args(["--size", "640x400", "--incidence", "-30"]);
    assert!(command.status().unwrap().success());
    assert!(
        std::fs::read(at("rgb.png"))
            .unwrap()
            .starts_with(b"\x89PNG")
    );
}

#[test]
fn refusals_have_their_exit_code_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    even(&at("even.exr"));
    std::fs::write(at("noise.exr"), b"not a table at all").unwrap();
    let run = |what: &str, file: &str, rest: &[&str]| {
        let mut command = vair();
        command.args(["table", what]).arg(at(file)).args(rest);
        let output = command.output().unwrap();
        (
            output.status.code().unwrap(),
            String::from_utf8_lossy(&output.stderr).into_owned(),
        )
    };
    let out = at("out.exr").to_string_lossy().into_owned();
    let nowhere = at("no/such/folder/out.exr").to_string_lossy().into_owned();
    let png = at("out.png").to_string_lossy().into_owned();
    for (what, file, rest, code) in [
        ("info", "missing.exr", vec![], 1),
        ("info", "noise.exr", vec![], 1),
        ("dye", "even.exr", vec!["-o", &out], 1),
        (
            "dye",
            "even.exr",
            vec!["-o", &out, "--absorption", "1,2"],
            1,
        ),
        (
            "dye",
            "even.exr",
            vec!["-o", &out, "--absorption=-1,0,0"],
            1,
        ),
        ("dye", "even.exr", vec!["-o", &out, "--eumelanin", "nan"], 1),
        (
            "dye",
            "even.exr",
            vec!["-o", &out, "--species", "unicorn"],
            1,
        ),
        (
            "dye",
            "even.exr",
            vec!["-o", &nowhere, "--absorption", "0"],
            2,
        ),
        ("plot", "even.exr", vec!["-o", &png, "--size", "0x0"], 1),
        ("plot", "even.exr", vec!["-o", &png, "--level", "3"], 1),
        ("plot", "even.exr", vec!["-o", &png, "--incidence", "91"], 1),
    ] {
        let (found, stderr) = run(what, file, &rest);
        assert_eq!(found, code, "{what} {file} {rest:?}: {stderr}");
        assert!(
            !stderr.is_empty() && !stderr.contains("panicked"),
            "{stderr}"
        );
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn compare_pack_and_fit_work_together() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    even(&at("even.exr"));
    let json = |arguments: &[&str]| {
        let mut command = vair();
        command
            .current_dir(folder.path())
            .arg("table")
            .args(arguments);
        let output = command.output().unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{arguments:?}: {stderr}");
        serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()
    };
    let packed = json(&["pack", "even.exr", "-o", "small.exr", "--json"]);
    assert!(
        packed["channels"][2]["against_input"]["error"]
            .as_f64()
            .unwrap()
            < 0.05
    );
    let compared = json(&["compare", "small.exr", "even.exr", "--json", "-o", "d.png"]);
    assert_eq!(compared["method"], "texels");
    assert!(compared["channels"][0]["albedo_max"].as_f64().unwrap() < 1e-6);
    assert!(std::fs::read(at("d.png")).unwrap().starts_with(b"\x89PNG"));
    let fitted = json(&["fit", "small.exr", "--model", "chiang", "--json"]);
    assert_eq!(fitted["fits"][0]["lobes"].as_array().unwrap().len(), 4);
    let output = vair()
        .current_dir(folder.path())
        .args("table fit small.exr --level 0 --model double-cylinder".split(' '))
        .output()
        .unwrap();
    // What it prints can be pasted.
    let text = String::from_utf8(output.stdout).unwrap();
    let mut lines = text.lines().map(str::trim);
    let options = lines.find_map(|line| line.strip_prefix("vair render"));
    let mut render = vair();
    let rendered = render
        .current_dir(folder.path())
        .args("render human --skin ball --strands 300 --res 16x12 --spp 1 -o a.png".split(' '))
        .args(options.unwrap().split_whitespace())
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&rendered.stderr);
    assert!(rendered.status.success(), "{text} {stderr}");
    let info = json(&["info", "small.exr", "--json"]);
    assert_eq!(info["bins"][0]["ledger"][1]["emitted"], PHOTON * 1000);

    for arguments in [
        ["pack", "even.exr", "-o", "x.exr", "--budget", "10"],
        ["pack", "even.exr", "-o", "x.exr", "--budget", "many"],
        ["pack", "even.exr", "-o", "x.exr", "--rank", "0"],
        [
            "compare",
            "even.exr",
            "even.exr",
            "--theta-max",
            "91",
            "--quiet",
        ],
        ["fit", "even.exr", "--level", "9", "--model", "chiang"],
    ] {
        let mut command = vair();
        command
            .current_dir(folder.path())
            .arg("table")
            .args(arguments);
        let output = command.output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        assert!(!output.stderr.is_empty());
    }
    assert!(!at("x.exr").exists());
}
