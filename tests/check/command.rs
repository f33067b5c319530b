//! `vair check` from outside: what it prints and how it ends.

use super::FUR;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn vair(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_vair"))
        .current_dir(folder)
        .arg("check")
        .args(arguments)
        .output()
        .unwrap()
}

#[test]
fn exit_codes_are_those_of_the_table() {
    let folder = tempfile::tempdir().unwrap();
    let fault = FUR.replacen(
        "float3[] primvars:groom_color",
        "color3f[] primvars:groom_color",
        1,
    );
    let remark = FUR.replacen("    kind = \"component\"\n", "", 1);
    for (name, text) in [
        ("good.usda", FUR),
        ("bad.usda", &fault),
        ("odd.usda", &remark),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    fs::write(folder.path().join("torn.usda"), "#usda 1.0\ndef {").unwrap();
    // Opening a folder works, reading it fails.
    fs::create_dir(folder.path().join("folder.usda")).unwrap();
    for (arguments, code) in [
        (&["good.usda"][..], 0),
        (&["odd.usda"], 0),
        (&["odd.usda", "--strict"], 1),
        (&["good.usda", "bad.usda"], 1),
        (&["bad.usda", "--profile", "blender"], 0),
        (&["torn.usda"], 1),
        (&["good.usda", "--profile", "maxwell"], 1),
        (&["gone.usda"], 1),
        (&["folder.usda"], 2),
        (&["--explain", "C07"], 0),
        (&["--explain", "C77"], 1),
    ] {
        let output = vair(folder.path(), arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
    }
}

#[test]
fn findings_are_printed_as_text_and_as_the_schema_says() {
    let folder = tempfile::tempdir().unwrap();
    let fault = FUR.replacen(
        "float3[] primvars:groom_color",
        "color3f[] primvars:groom_color",
        1,
    );
    fs::write(folder.path().join("fur.usda"), fault).unwrap();
    let output = vair(folder.path(), &["fur.usda", "--profile", "unreal"]);
    assert_eq!(
        String::from_utf8(output.stdout).unwrap(),
        "fur.usda: C07 error /fox/geo/render/guard.primvars:groom_color: groom_color is color3f[]: Unreal ignores it \
         and shades black. Remedy: write float3[]. [unreal]\n"
    );
    let output = vair(folder.path(), &["fur.usda", "--json"]);
    let printed: Value = serde_json::from_slice(&output.stdout).unwrap();
    let schema: Value =
        serde_json::from_str(include_str!("../../schemas/check.schema.json")).unwrap();
    let keys = |value: &Value| {
        value
            .as_object()
            .unwrap()
            .keys()
            .cloned()
            .collect::<Vec<_>>()
    };
    assert_eq!(keys(&printed), keys(&schema["properties"]));
    let finding = &schema["properties"]["findings"]["items"]["properties"];
    for found in printed["findings"].as_array().unwrap() {
        assert_eq!(keys(found), keys(finding));
        let rules = finding["rule"]["enum"].as_array().unwrap();
        assert!(rules.contains(&found["rule"]), "{found}");
    }
    assert_eq!(printed["errors"], 1);
}

/// A file that is broken does not hide what is in the others.
#[test]
fn broken_files_are_named_beside_the_findings_of_others() {
    let folder = tempfile::tempdir().unwrap();
    let fault = FUR.replacen("kind = \"component\"", "", 1);
    fs::write(folder.path().join("odd.usda"), fault).unwrap();
    fs::write(folder.path().join("torn.usda"), "#usda 1.0\ndef {").unwrap();
    let output = vair(
        folder.path(),
        &["gone.usda", "odd.usda", "torn.usda", "--json"],
    );
    assert_eq!(output.status.code(), Some(1));
    let printed: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(printed["warnings"], 1);
    let refused = printed["refused"].as_array().unwrap();
    let files: Vec<_> = refused
        .iter()
        .map(|r| r["file"].as_str().unwrap())
        .collect();
    assert_eq!(files, ["gone.usda", "torn.usda"]);
    let said = String::from_utf8(output.stderr).unwrap();
    for word in [
        "gone.usda",
        "torn.usda: line 2",
        "1 file: 0 errors, 1 warning",
    ] {
        assert!(said.contains(word), "{word}: {said}");
    }
}

/// Names in files cannot drive a terminal or forge a line.
#[test]
fn control_characters_are_spelled_out() {
    let folder = tempfile::tempdir().unwrap();
    let bad = "\u{1b}]0;x\u{7}\u{202e}\nfine.usda: all is well";
    let fault = FUR.replacen(
        "    kind = \"component\"\n",
        &format!("    kind = \"component\"\n    payload = @./{bad}.usdc@\n"),
        1,
    );
    fs::write(folder.path().join("fur.usda"), fault).unwrap();
    let output = vair(folder.path(), &["fur.usda"]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains(r"\u{1b}]0;x\u{7}\u{202e}\n"), "{said}");
    assert!(
        said.lines().all(|line| line.starts_with("fur.usda: ")),
        "{said}"
    );
    let worse = "torn\u{1b}[31m.usda";
    fs::write(folder.path().join(worse), "#usda 1.0\ndef {").unwrap();
    let output = vair(folder.path(), &[worse]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        said.contains(r"torn\u{1b}[31m.usda") && !said.contains('\u{1b}'),
        "{said}"
    );
}

/// Every rule is on the page that describes them, with its number.
#[test]
fn the_page_has_all_rules() {
    let page = include_str!("../../docs/check.md");
    for rule in &vair::check::RULES {
        assert!(page.contains(&format!("| {} | ", rule.id)), "{}", rule.id);
    }
}
