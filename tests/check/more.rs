//! Faults of kinds that a rule tells apart, what is only a note, and what is none.

use super::{FUR, edited, findings, found, planted};
use std::fs;
use vair::check::Severity::{Error, Note, Warning};
use vair::check::{Consumer, Finding, Rule};

/// Notes of a text of which nothing worse is found.
fn noted(text: &str) -> Vec<Finding> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("fur.usda");
    fs::write(&file, text).unwrap();
    let all = findings(&file, &[]);
    assert!(all.iter().all(|f| f.severity == Note), "{all:#?}");
    all
}

/// That one more note is found than in the sound file, by this rule.
fn remarked(rule: Rule, text: &str, word: &str) {
    let is_meant = |f: &Finding| f.rule == rule && f.message.contains(word);
    assert!(!noted(FUR).iter().any(is_meant));
    let all = noted(text);
    assert!(all.iter().any(is_meant), "{all:#?}");
}

/// The sound file with a line before one of the skin or of the fur.
fn with_line(line: &str, before: &str) -> String {
    edited(before, &format!("{line}\n{before}"))
}

const IN_SKIN: &str = "            int[] faceVertexCounts";
const IN_GUARD: &str = "                rel material:binding = </fox/mtl/guard>";
const IN_FULL: &str = "                        int[] primvars:curve_id = [7, 8, 9]";

#[test]
fn widths_of_all_kinds() {
    let nine = "widths = [0.0001,";
    planted(Rule::C01, Error, nine, "widths = [0.0001, 0.0001,");
}

#[test]
fn numbers_of_all_kinds() {
    for line in [
        "float x.timeSamples = { 1: 0, 2: nan }",
        "float x = nan",
        "double3 x = (0, inf, 0)",
    ] {
        planted(Rule::C03, Error, IN_SKIN, &format!("{line}\n{IN_SKIN}"));
    }
    assert_eq!(found(&with_line("float physics:x = inf", IN_SKIN), &[]), []);
}

#[test]
fn empty_curves() {
    let all = found(
        &edited("curveVertexCounts = [3, 3, 3]", "curveVertexCounts = []"),
        &[],
    );
    assert!(
        all.iter()
            .any(|f| f.rule == Rule::C04 && f.severity == Warning),
        "{all:?}"
    );
}

#[test]
fn texture_coordinates_of_all_kinds() {
    planted(
        Rule::C06,
        Error,
        "texCoord2f[] primvars:st",
        "float2[] primvars:groom_root_uv",
    );
    let three = edited(
        "texCoord2f[] primvars:st = [(0.5, 0.75), (0.25, 0.75), (0.5, 0.25)]",
        "texCoord3f[] primvars:st = [(0.5, 0.75, 0), (0.25, 0.75, 0), (0.5, 0.25, 0)]",
    );
    assert!(found(&three, &[])[0].consumers.contains(&Consumer::Blender));
    let nine = ["(0.5, 0.75)"; 9].join(", ");
    let of_points = edited(
        "[(0.5, 0.75), (0.25, 0.75), (0.5, 0.25)] (\n                            interpolation = \"uniform\"",
        &format!("[{nine}] (\n                            interpolation = \"vertex\""),
    );
    remarked(Rule::C06, &of_points, "one a point");
}

#[test]
fn curves_of_all_kinds() {
    let bezier = found(&edited("\"catmullRom\"", "\"bezier\""), &[]);
    assert!(
        bezier
            .iter()
            .any(|f| f.rule == Rule::C09 && f.message.contains("handles"))
    );
    remarked(
        Rule::C09,
        &edited("\"cubic\"", "\"linear\""),
        "straight pieces",
    );
    let normals = format!("normal3f[] normals = [(0, 1, 0)]\n{IN_GUARD}");
    planted(Rule::C09, Warning, IN_GUARD, &normals);
}

#[test]
fn primvars_of_all_kinds() {
    planted(
        Rule::C10,
        Error,
        "[(0.5, 0.75), (0.25, 0.75), (0.5, 0.25)]",
        "[(0.5, 0.75), (0.25, 0.75), (0.5, 0.25), (0, 0)]",
    );
    let varying = planted(
        Rule::C10,
        Warning,
        "(1, 0, 0)] (\n                            interpolation = \"vertex\"",
        "(1, 0, 0)] (\n                            interpolation = \"varying\"",
    );
    assert_eq!(varying.consumers, [Consumer::Storm]);
    let double = "double[] primvars:x = [1] (interpolation = \"constant\")";
    remarked(
        Rule::C10,
        &with_line(double, IN_FULL),
        "does not import double[]",
    );
    let pairs = "float[] primvars:x = [1, 2, 3, 4] ( elementSize = 2\n interpolation = \"uniform\" )\n\
                 int[] primvars:x:indices = [0, 1, 0]";
    assert_eq!(found(&with_line(pairs, IN_FULL), &[]), []);
}

#[test]
fn extents_of_all_kinds() {
    let box_of_fur = "[(0.24995, -0.00005, 0.24995), (0.50005, 0.02005, 0.75005)]";
    planted(Rule::C11, Error, box_of_fur, "[(0, 0, 0)]");
    planted(
        Rule::C11,
        Error,
        "[(0, 0, 0), (1, 0, 1)]",
        "[(0, 0, 0), (1, 0, 0.5)]",
    );
}

#[test]
fn materials_of_all_kinds() {
    let scope = planted(Rule::C12, Error, "</fox/mtl/guard>", "</fox/mtl>");
    assert!(scope.message.contains("is a Scope"), "{scope:?}");
    remarked(
        Rule::C12,
        &edited(&format!("{IN_GUARD}\n"), ""),
        "have no material",
    );
}

#[test]
fn layers_of_all_kinds() {
    planted(Rule::C16, Error, "upAxis = \"Y\"", "upAxis = \"X\"");
    planted(Rule::C16, Error, "    metersPerUnit = 1\n", "");
    let kind = "    kind = \"component\"\n";
    let asset = |path: &str| format!("{kind}    assetInfo = {{ asset identifier = @{path}@ }}\n");
    remarked(Rule::C16, &edited(kind, &asset("fox.usda")), "more places");
    let uri = noted(&edited(kind, &asset("http://a/fox.usda")));
    assert_eq!(uri.len(), noted(FUR).len(), "{uri:?}");
}

/// Levels are held against one another by their size, in whatever order they stand.
#[test]
fn levels_in_another_order() {
    let at = |word: &str| FUR.find(word).unwrap();
    let (full, low) = (at("        \"full\" {"), at("        \"low\" {"));
    let end = FUR.len() - "    }\n}\n".len();
    let turned = [&FUR[..full], &FUR[low..end], &FUR[full..low], &FUR[end..]].concat();
    assert_eq!(found(&turned, &[]), []);
}

#[test]
fn strands_of_all_kinds() {
    planted(Rule::C18, Error, "int strands = 3", "int strands = 2");
    planted(
        Rule::C18,
        Error,
        "purpose = \"render\"",
        "purpose = \"proxy\"",
    );
    let flag = "int[] primvars:groom_guide = [1] (interpolation = \"constant\")";
    let guides = planted(Rule::C18, Error, IN_GUARD, &format!("{flag}\n{IN_GUARD}"));
    assert!(guides.message.contains("only guides"), "{guides:?}");
}

#[test]
fn roots_of_all_kinds() {
    // Seven millimeters off on a skin of 1.4 m.
    let off = [
        "skinprimuv = [(0.25, 0.5, 0)",
        "skinprimuv = [(0.255, 0.505, 0)",
    ];
    planted(Rule::C19, Error, off[0], off[1]);
    // Guides may be a little off.
    let guides = edited(off[0], off[1]).replace("purpose = \"render\"", "purpose = \"guide\"");
    let all = found(&guides, &[]);
    let roots = all.iter().find(|f| f.rule == Rule::C19).unwrap();
    assert_eq!(roots.severity, Warning);
}

/// Strands that stand for many others may be wider than hair.
#[test]
fn proxies_may_be_wide() {
    let wide = FUR.replace("metersPerUnit = 1", "metersPerUnit = 100");
    let of = |text: &str| {
        found(text, &[])
            .iter()
            .filter(|f| f.rule == Rule::C02)
            .count()
    };
    assert!(of(&wide) > 0);
    assert_eq!(
        of(&wide.replace("purpose = \"render\"", "purpose = \"proxy\"")),
        0
    );
    // So may some of a coarser level, but not all of it.
    for (widths, faults) in [("0.0002, 0.0002, 0.008", 0), ("0.08, 0.08, 0.08", 1)] {
        let low = edited("[0.0002, 0.0002, 0.0002]", &format!("[{widths}]"));
        assert_eq!(of(&low), faults);
    }
    // A few that are too wide or too thin are less than all.
    for width in ["0.008", "0.0000001"] {
        let one = edited("widths = [0.0001,", &format!("widths = [{width},"));
        let all = found(&one, &[]);
        let width = all.iter().find(|f| f.rule == Rule::C02).unwrap();
        assert_eq!(width.severity, Warning, "{all:?}");
    }
}
