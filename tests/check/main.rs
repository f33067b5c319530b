//! `vair check` finds each fault that is planted in a sound file, and nothing else; what `vair export` writes
//! has no errors.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may panic")]

mod command;
mod files;
mod grids;
mod hair;
mod more;

use Severity::{Error, Warning};
use std::fs;
use std::path::Path;
use vair::check::{CheckSettings, Consumer, Finding, Rule, Severity, check};
use vair::export::asset::{
    AssetSettings, Curves, Frame, Layout, Parts, Profile, READERS, Reader, Units, Up, levels, write,
};
use vair::groom::{GroomSettings, grow};
use vair::progress::{Cancel, Silent};
use vair::{skin, species};

const FUR: &str = include_str!("fur.usda");

fn findings(file: &Path, profile: &[Consumer]) -> Vec<Finding> {
    let settings = CheckSettings {
        profile: profile.to_vec(),
        ..CheckSettings::default()
    };
    let checked = check(&[file], &settings);
    assert!(checked.refused.is_empty(), "{:?}", checked.refused);
    checked.findings
}

/// What is found in a text, notes left out.
fn found(text: &str, profile: &[Consumer]) -> Vec<Finding> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("fur.usda");
    fs::write(&file, text).unwrap();
    let all = findings(&file, profile);
    all.into_iter()
        .filter(|f| f.severity > Severity::Note)
        .collect()
}

/// The sound file with something else in one place.
fn edited(from: &str, to: &str) -> String {
    assert!(FUR.contains(from), "{from}");
    FUR.replacen(from, to, 1)
}

/// That a fault is found, by this rule alone, and returns what was found.
fn planted(rule: Rule, severity: Severity, from: &str, to: &str) -> Finding {
    let all = found(&edited(from, to), &[]);
    let said = format!("{from} -> {to}: {all:#?}");
    assert!(
        !all.is_empty() && all.iter().all(|f| f.rule == rule),
        "{said}"
    );
    let worst = all.iter().max_by_key(|f| f.severity).unwrap();
    assert_eq!(worst.severity, severity, "{said}");
    worst.clone()
}

#[test]
fn a_sound_file_is_clean() {
    assert_eq!(found(FUR, &[]), []);
}

#[test]
fn c01_widths() {
    let nine = "[0.0001, 0.0001, 0.0001, 0.0001, 0.0001, 0.0001, 0.0001, 0.0001, 0.0001] (\n                            interpolation = \"vertex\"";
    let with = |values: &str, interpolation: &str| {
        format!("[{values}] (\n                            interpolation = \"{interpolation}\"")
    };
    let all = "0.0001, 0.0001, 0.0001, 0.0001, 0.0001, 0.0001, 0.0001, 0.0001, 0.0001";
    let plant = |severity, to: &str| planted(Rule::C01, severity, nine, to);
    let few = plant(Error, &with("0.0001, 0.0001", "vertex"));
    assert_eq!(few.message, "2 vertex widths, 9 are wanted");
    assert_eq!(few.prim, "/fox/geo/render/guard");
    let uniform = plant(Error, &with("0.0001, 0.0001, 0.0001", "uniform"));
    assert_eq!(uniform.consumers, [Consumer::Blender]);
    let varying = plant(Error, &with(all, "varying"));
    let refusing = [Consumer::Cycles, Consumer::Unreal, Consumer::Storm];
    assert_eq!(varying.consumers, refusing);
    plant(
        Error,
        &with(&all.replacen("0.0001", "-0.0001", 1), "vertex"),
    );
    plant(Warning, &with(&all.replacen("0.0001", "0", 1), "vertex"));
    planted(Rule::C01, Error, "float[] widths", "float[] thickness");
}

#[test]
fn c02_diameters() {
    // A hair of 10 cm. Extents follow the widest width.
    let nine = |width: &str| [width; 9].join(", ");
    let wide = edited(&nine("0.0001"), &nine("0.1"));
    let wide = wide.replace(
        "[(0.24995, -0.00005, 0.24995), (0.50005, 0.02005, 0.75005)]",
        "[(0.2, -0.05, 0.2), (0.55, 0.07, 0.8)]",
    );
    let all = found(&wide, &[]);
    assert!(
        all.iter()
            .all(|f| f.rule == Rule::C02 && f.severity == Error),
        "{all:?}"
    );
    assert!(!all.is_empty());
    // The same numbers in millimeters are hair, but the file says meters; in centimeters they are thin.
    planted(
        Rule::C02,
        Error,
        "metersPerUnit = 1",
        "metersPerUnit = 0.001",
    );
}

#[test]
fn c03_numbers() {
    let nan = planted(
        Rule::C03,
        Error,
        "[(0.5, 0.75), (0.25",
        "[(nan, 0.75), (0.25",
    );
    assert_eq!(nan.attribute, "primvars:st");
    planted(
        Rule::C03,
        Error,
        "(1, 0, 0), (1, 0, 0)]",
        "(1, 0, 0), (1, 0, -inf)]",
    );
}

#[test]
fn c04_counts() {
    let sum = planted(Rule::C04, Error, "[3, 3, 3]", "[3, 3, 4]");
    assert_eq!(sum.message, "the counts sum to 10, but there are 9 points");
    planted(Rule::C04, Error, "[3, 3, 3]", "[7, 1, 1]");
    planted(
        Rule::C04,
        Warning,
        "(0.25, 0, 0.75), (0.25, 0.01, 0.75), (0.25, 0.02, 0.75)",
        "(0.25, 0, 0.75), (0.25, 0, 0.75), (0.25, 0, 0.75)",
    );
    // Three points are too few where the ends are not pinned.
    planted(Rule::C04, Error, "\"pinned\"", "\"nonperiodic\"");
}

#[test]
fn c05_limits() {
    let line = |i: usize| format!("(0.5, {}, 0.75)", 0.0001 * i as f32);
    let points: Vec<String> = (0..256).map(line).collect();
    let text = edited(
        "[(0.5, 0, 0.75), (0.5, 0.01, 0.75), (0.5, 0.02, 0.75)]",
        &format!("[{}]", points.join(", ")),
    );
    let text = text.replace("curveVertexCounts = [3]", "curveVertexCounts = [256]");
    let text = text.replace(
        "[0.0002, 0.0002, 0.0002]",
        &format!("[{}]", vec!["0.0002"; 256].join(",")),
    );
    let text = text.replace("(0.5001, 0.0201, 0.7501)", "(0.5001, 0.0256, 0.7501)");
    let all = found(&text, &[]);
    assert_eq!(all.len(), 1, "{all:?}");
    assert_eq!(
        (all[0].rule, all[0].consumers.as_slice()),
        (Rule::C05, &[Consumer::Unreal][..])
    );
    // The variant that has the fault is named.
    assert_eq!(all[0].prim, "/fox{lod=low}/geo/render/guard");
    assert_eq!(found(&text, &[Consumer::Blender]), []);
}

#[test]
fn c06_texture_coordinates() {
    planted(
        Rule::C06,
        Error,
        "texCoord2f[] primvars:st",
        "float2[] primvars:st",
    );
    let three = "texCoord3f[] primvars:st = [(0.5, 0.75, 0), (0.25, 0.75, 0), (0.5, 0.25, 0)]";
    let two = "texCoord2f[] primvars:st = [(0.5, 0.75), (0.25, 0.75), (0.5, 0.25)]";
    planted(Rule::C06, Error, two, three);
}

#[test]
fn c07_groom_color() {
    let fault = planted(
        Rule::C07,
        Error,
        "float3[] primvars:groom_color",
        "color3f[] primvars:groom_color",
    );
    assert_eq!(fault.consumers, [Consumer::Unreal]);
}

#[test]
fn c08_groom_api() {
    planted(
        Rule::C08,
        Error,
        "    prepend apiSchemas = [\"GroomAPI\"]\n",
        "",
    );
    // A file without anything for Unreal is none of its business, until someone asks.
    let plain = edited("    prepend apiSchemas = [\"GroomAPI\"]\n", "");
    let plain = plain.replace("primvars:groom_color", "primvars:tint");
    assert_eq!(found(&plain, &[]), []);
    assert_eq!(found(&plain, &[Consumer::Unreal])[0].rule, Rule::C08);
}

#[test]
fn c09_kinds_of_curves() {
    planted(Rule::C09, Warning, "\"catmullRom\"", "\"bspline\"");
    // Points beyond the ends are hair to most readers, and rings are hair to none.
    planted(Rule::C09, Warning, "\"pinned\"", "\"periodic\"");
    let phantom = edited("\"pinned\"", "\"nonperiodic\"").replacen("[3, 3, 3]", "[9]", 1);
    let is_longer = |f: &Finding| f.rule == Rule::C09 && f.message.contains("beyond both ends");
    assert!(found(&phantom, &[]).iter().any(is_longer));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("fur.usda");
    fs::write(&file, FUR).unwrap();
    let all = findings(&file, &[Consumer::RenderMan]);
    let pinned = all.iter().find(|f| f.rule == Rule::C09).unwrap();
    assert_eq!(pinned.severity, Warning, "{pinned:?}");
}

#[test]
fn c10_primvars() {
    planted(
        Rule::C10,
        Warning,
        "color3f[] primvars:displayColor = [(0.5, 0.25, 0.125)]",
        "color3f primvars:displayColor = (0.5, 0.25, 0.125)",
    );
    planted(
        Rule::C10,
        Error,
        "int[] primvars:curve_id = [7, 8, 9] (\n                            interpolation = \"uniform\"",
        "int[] primvars:curve_id = [7, 8, 9] (\n                            interpolation = \"faceVarying\"",
    );
    planted(Rule::C10, Error, "primvars:displayColor", "primvars:id");
    planted(
        Rule::C10,
        Error,
        "[(0.5, 0.75), (0.25, 0.75), (0.5, 0.25)]",
        "[(0.5, 0.75), (0.25, 0.75)]",
    );
    // Two numbers a strand that belong together.
    let pairs = "float[] primvars:pair = [1, 2, 3, 4, 5, 6] (\n elementSize = 2\n interpolation = \"uniform\"\n)\n";
    let before = "color3f[] primvars:displayColor";
    let paired = edited(before, &format!("{pairs}{before}"));
    assert_eq!(found(&paired, &[]), []);
    let short = paired.replace("4, 5, 6]", "4, 5]");
    let all = found(&short, &[]);
    assert_eq!(all.len(), 1, "{all:?}");
    assert!(all[0].message.contains("6 are wanted"), "{all:?}");
}

#[test]
fn c11_extent() {
    planted(
        Rule::C11,
        Error,
        "(0.50005, 0.02005, 0.75005)",
        "(0.50005, 0.01, 0.75005)",
    );
    planted(
        Rule::C11,
        Warning,
        "(0.24995, -0.00005, 0.24995), (0.50005, 0.02005, 0.75005)",
        "(0.25, 0, 0.25), (0.5, 0.02, 0.75)",
    );
    planted(
        Rule::C11,
        Warning,
        "float3[] extent = [(0.24995",
        "float3[] extend = [(0.24995",
    );
    // For each time.
    let points = "point3f[] points = [(0.5, 0, 0.75), (0.5, 0.01, 0.75), (0.5, 0.02, 0.75)]";
    let moved = "point3f[] points.timeSamples = { 1: [(0.5, 0, 0.75), (0.5, 0.01, 0.75), (0.5, 0.02, 0.75)], 2: [(0.5, 0, 0.75), (0.5, 0.01, 0.75), (0.5, 0.09, 0.75)] }";
    let fault = planted(Rule::C11, Error, points, moved);
    assert!(fault.message.contains("at time 2"), "{fault:?}");
}

#[test]
fn c12_materials() {
    let api = "            def BasisCurves \"guard\" (\n                prepend apiSchemas = [\"MaterialBindingAPI\"]\n            )\n";
    planted(
        Rule::C12,
        Error,
        api,
        "            def BasisCurves \"guard\"\n",
    );
    planted(Rule::C12, Error, "</fox/mtl/guard>", "</fox/mtl/gard>");
    planted(
        Rule::C12,
        Warning,
        "ND_chiang_hair_bsdf",
        "ND_chiang_hair_roughness",
    );
}

#[test]
fn c16_layers() {
    planted(Rule::C16, Error, "    defaultPrim = \"fox\"\n", "");
    planted(
        Rule::C16,
        Error,
        "defaultPrim = \"fox\"",
        "defaultPrim = \"ox\"",
    );
    planted(
        Rule::C16,
        Error,
        "    metersPerUnit = 1\n",
        "    metersPerUnit = -1\n",
    );
    planted(Rule::C16, Error, "    upAxis = \"Y\"\n", "");
    planted(Rule::C16, Warning, "    kind = \"component\"\n", "");
    planted(
        Rule::C16,
        Warning,
        "    kind = \"component\"\n",
        "    kind = \"component\"\n    assetInfo = { asset identifier = @/home/me/fox.usda@ }\n",
    );
    planted(
        Rule::C16,
        Error,
        "    kind = \"component\"\n",
        "    kind = \"component\"\n    payload = @./gone.usdc@\n",
    );
}

#[test]
fn c17_ids_and_levels() {
    planted(Rule::C17, Error, "[7, 8, 9]", "[7, 8, 8]");
    let fault = planted(Rule::C17, Error, "curve_id = [7] ", "curve_id = [6] ");
    assert!(fault.message.contains("lod=low"), "{fault:?}");
}

#[test]
fn c18_numbers_of_strands() {
    planted(Rule::C18, Error, "int strands = 3", "int strands = 4000");
    planted(
        Rule::C18,
        Error,
        "purpose = \"render\"",
        "purpose = \"guide\"",
    );
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("fur.usda");
    fs::write(&file, FUR).unwrap();
    for (strands, errors) in [(3, 0), (5, 1)] {
        let settings = CheckSettings {
            strands: Some(strands),
            ..CheckSettings::default()
        };
        let all = check(&[&file], &settings).findings;
        let number = all
            .iter()
            .filter(|f| f.rule == Rule::C18 && f.severity == Error)
            .count();
        assert_eq!(number, errors, "{all:?}");
    }
}

#[test]
fn c19_roots() {
    planted(
        Rule::C19,
        Error,
        "skinprim = [0, 0, 1]",
        "skinprim = [0, 0, 2]",
    );
    planted(
        Rule::C19,
        Error,
        "skinprimuv = [(0.25, 0.5, 0)",
        "skinprimuv = [(0.5, 0.5, 0)",
    );
    // The skin was moved after the fur had grown.
    let moved = FUR.replace("[(0, 0, 0), (1, 0, 1)]", "[(0, 0, 0.1), (1, 0, 1.1)]");
    let moved = moved.replace(
        "[(0, 0, 0), (0, 0, 1), (1, 0, 1), (1, 0, 0)]",
        "[(0, 0, 0.1), (0, 0, 1.1), (1, 0, 1.1), (1, 0, 0.1)]",
    );
    let all = found(&moved, &[]);
    assert!(
        !all.is_empty() && all.iter().all(|f| f.rule == Rule::C19),
        "{all:?}"
    );
}

/// That roots were not held against the skin is only said where they would have been.
#[test]
fn c19_is_left_out_where_things_move() {
    let notes = |text: &str| {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("fur.usda");
        fs::write(&file, text).unwrap();
        let all = findings(&file, &[]);
        assert!(all.iter().all(|f| f.severity == Severity::Note), "{all:?}");
        all.iter().filter(|f| f.rule == Rule::C19).count()
    };
    let before = "    def Scope \"geo\"\n    {\n";
    let moved = edited(
        before,
        &format!(
            "{before}        uniform token[] xformOpOrder = [\"xformOp:translate\"]\n        double3 xformOp:translate = (0, 0, 1)\n"
        ),
    );
    assert_eq!(notes(&moved), 1);
    assert_eq!(
        notes(&moved.replace("primvars:skinprim ", "primvars:face ")),
        0
    );
}

/// What the program exports has no fault of its own, whoever it is for.
#[test]
fn exports_have_no_errors() {
    let folder = tempfile::tempdir().unwrap();
    let cancel = Cancel::default();
    let kinds = [
        Curves::Pinned,
        Curves::Phantom,
        Curves::Bezier,
        Curves::Linear,
    ];
    let readers = READERS.iter().map(|(name, reader)| (Some(*name), *reader));
    for (i, (name, reader)) in readers.chain([(None, Reader::Storm)]).enumerate() {
        let (species, skin) = [("red-fox", "ball"), ("human", "tress"), ("lynx", "swatch")][i % 3];
        let (species, skin) = (
            species::load(species, &[]).unwrap(),
            skin::load(skin).unwrap(),
        );
        let grown = GroomSettings {
            strands: Some(800),
            seed: 1,
        };
        let groom = grow(&skin, &species, &grown, &Silent, &cancel).unwrap();
        let parts = Parts {
            groom: &groom,
            skin: &skin,
            species: &species,
            levels: &levels(&groom, &skin, &species, 1 + i % 3).unwrap(),
            looks: &[],
            coats: &[],
            seed: 1,
        };
        let settings = AssetSettings {
            curves: kinds[i % 4],
            profile: Profile::of(name.map(|_| reader).as_slice()),
            layout: if i % 2 == 0 {
                Layout::Single
            } else {
                Layout::Payload
            },
            frame: Frame {
                units: if i % 3 == 0 {
                    Units::Centimeters
                } else {
                    Units::Meters
                },
                up: if i % 2 == 0 { Up::Z } else { Up::Y },
            },
            ..AssetSettings::default()
        };
        let consumer: Vec<Consumer> = name.and_then(Consumer::of_name).into_iter().collect();
        let mut both = Vec::new();
        for suffix in ["usda", "usdc"] {
            let path = folder.path().join(format!("fur{i}.{suffix}"));
            write(&path, &parts, &settings, &Silent, &cancel).unwrap();
            let all = findings(&path, &consumer);
            assert!(
                all.iter().all(|f| f.severity < Error),
                "{name:?} {suffix}: {all:#?}"
            );
            println!(
                "{name:?} {suffix}: {:?}",
                all.iter().map(|f| (f.rule, f.severity)).collect::<Vec<_>>()
            );
            both.push(
                all.into_iter()
                    .map(|f| (f.rule, f.prim, f.message))
                    .collect::<Vec<_>>(),
            );
        }
        assert_eq!(both[0], both[1], "{name:?}");
    }
}
