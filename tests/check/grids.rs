//! Faults in grids, in what shows them, and in packages.

use super::{FUR, found};
use glam::IVec3;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use vair::check::Severity::{Error, Note, Warning};
use vair::check::{CheckSettings, Consumer, Finding, Rule, Severity, check};
use vair::export::vdb::{Class, Compression, Grid, Leaf, Tree, Writer};

const VOLUME: &str = r#"#usda 1.0
(
    defaultPrim = "grids"
    metersPerUnit = 1
    upAxis = "Y"
)

def Xform "grids" (
    kind = "component"
)
{
    def Volume "volume"
    {
        float3[] extent = [(0.245, -0.005, 0.245), (0.505, 0.025, 0.755)]
        rel field:density = </grids/volume/density>

        def OpenVDBAsset "density"
        {
            token fieldClass = "fogVolume"
            token fieldDataType = "float"
            token fieldName = "density"
            asset filePath = @./fur.vdb@
        }
    }
}
"#;

/// Fog where the strands of the sound file are.
pub(super) fn fog(values: [f32; 2], voxel: f64, half: bool) -> Vec<u8> {
    stored(values, voxel, half, Compression::Zip)
}

fn stored(values: [f32; 2], voxel: f64, half: bool, how: Compression) -> Vec<u8> {
    let leaf = |origin: [i32; 3], at: [i32; 3], value| {
        let mut leaf = Leaf::new(IVec3::from(origin), 0.0f32);
        leaf.set(IVec3::from(at), value);
        leaf
    };
    let leaves = vec![
        leaf([24, 0, 24], [25, 0, 25], values[0]),
        leaf([48, 0, 72], [50, 2, 75], values[1]),
    ];
    let grid = Grid {
        name: "density".into(),
        class: Class::FogVolume,
        voxel,
        half,
        metadata: Vec::new(),
        tree: Tree::new(0.0, leaves, Vec::new()).unwrap(),
    };
    let mut writer = Writer::new(Cursor::new(Vec::new()), how, "test").unwrap();
    writer.grid(&grid).unwrap();
    writer.finish().unwrap().into_inner()
}

fn sound() -> Vec<u8> {
    fog([1.0, 2.0], 0.01, false)
}

/// What is found in some files, notes left out.
fn in_files(files: &[(&str, &[u8])], checked: &[&str], profile: &[Consumer]) -> Vec<Finding> {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    let paths: Vec<PathBuf> = checked
        .iter()
        .map(|name| folder.path().join(name))
        .collect();
    let settings = CheckSettings {
        profile: profile.to_vec(),
        ..CheckSettings::default()
    };
    let all = check(&paths, &settings).findings;
    all.into_iter().filter(|f| f.severity > Note).collect()
}

fn only(all: &[Finding], rule: Rule, severity: Severity) {
    assert!(
        !all.is_empty() && all.iter().all(|f| f.rule == rule),
        "{rule:?}: {all:#?}"
    );
    assert_eq!(
        all.iter().map(|f| f.severity).max(),
        Some(severity),
        "{all:#?}"
    );
}

fn in_grids(bytes: &[u8]) -> Vec<Finding> {
    in_files(&[("fur.vdb", bytes)], &["fur.vdb"], &[])
}

fn in_volume(from: &str, to: &str) -> Vec<Finding> {
    assert!(VOLUME.contains(from));
    let text = VOLUME.replacen(from, to, 1);
    in_files(
        &[("fur.vdb", &sound()), ("grids.usda", text.as_bytes())],
        &["grids.usda"],
        &[],
    )
}

/// With a word in the bytes changed for another of the same length.
fn patched(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    let at = bytes.windows(from.len()).position(|w| w == from).unwrap();
    let mut bytes = bytes.to_vec();
    bytes[at..at + to.len()].copy_from_slice(to);
    bytes
}

#[test]
fn sound_grids_are_clean() {
    assert_eq!(in_grids(&sound()), []);
    assert_eq!(in_grids(&fog([1.0, 2.0], 0.01, true)), []);
    assert_eq!(in_volume("grids", "grids"), []);
    let all: [(&str, &[u8]); 3] = [
        ("fur.usda", FUR.as_bytes()),
        ("fur.vdb", &sound()),
        ("grids.usda", VOLUME.as_bytes()),
    ];
    assert_eq!(
        in_files(&all, &["fur.usda", "fur.vdb", "grids.usda"], &[]),
        []
    );
}

#[test]
fn c13_grids() {
    only(&in_grids(&fog([1.0, -2.0], 0.01, false)), Rule::C13, Error);
    let plain = stored([1.0, 1234.5], 0.01, false, Compression::None);
    let bad = patched(&plain, &1234.5f32.to_le_bytes(), &f32::NAN.to_le_bytes());
    only(&in_grids(&bad), Rule::C03, Error);
    let mut old = sound();
    old[8] = 219;
    only(&in_grids(&old), Rule::C13, Error);
    for (version, severity) in [(225, Warning), (226, Error)] {
        let mut new = sound();
        new[8] = version;
        only(&in_grids(&new), Rule::C13, severity);
    }
    only(
        &in_grids(&patched(&sound(), b"file_bbox_min", b"file_bbox_mim")),
        Rule::C13,
        Warning,
    );
    only(
        &in_grids(&patched(&sound(), b"class", b"klass")),
        Rule::C13,
        Warning,
    );
    only(
        &in_grids(&patched(
            &fog([1.0; 2], 0.01, true),
            b"is_saved",
            b"is_waved",
        )),
        Rule::C13,
        Error,
    );
    // A box that is not that of the voxels: its number stands behind two words and two lengths.
    let mut other = sound();
    let name = b"file_bbox_min";
    let at = other.windows(name.len()).position(|w| w == name).unwrap();
    other[at + name.len() + 13] ^= 1;
    only(&in_grids(&other), Rule::C13, Error);
    // What is no fog may be below zero.
    let signed = fog([1.0, -2.0], 0.01, false);
    assert_eq!(
        in_grids(&patched(&signed, b"fog volume", b"level sets")),
        []
    );
    // Grids of one volume in two files.
    let two = VOLUME.replace(
        "        rel field:density",
        "        rel field:color = </grids/volume/color>\n        def OpenVDBAsset \"color\" { token fieldClass = \"fogVolume\" token fieldDataType = \"float\" token fieldName = \"density\" asset filePath = @./other.vdb@ }\n        rel field:density",
    );
    let files: [(&str, &[u8]); 3] = [
        ("fur.vdb", &sound()),
        ("other.vdb", &sound()),
        ("grids.usda", two.as_bytes()),
    ];
    let all = in_files(&files, &["grids.usda"], &[]);
    only(&all, Rule::C13, Error);
    assert_eq!(all[0].consumers, [Consumer::Arnold]);
    only(&in_volume("./fur.vdb", "./gone.vdb"), Rule::C13, Error);
}

#[test]
fn c14_fields() {
    for line in [
        "fieldDataType = \"float\"",
        "fieldClass = \"fogVolume\"",
        "fieldName = \"density\"",
    ] {
        only(
            &in_volume(&format!("            token {line}\n"), ""),
            Rule::C14,
            Error,
        );
    }
    only(&in_volume("\"float\"", "\"float3\""), Rule::C14, Error);
    only(
        &in_volume("            asset filePath = @./fur.vdb@\n", ""),
        Rule::C14,
        Error,
    );
    only(
        &in_volume("\"fogVolume\"", "\"levelSet\""),
        Rule::C14,
        Error,
    );
    only(
        &in_volume("fieldName = \"density\"", "fieldName = \"fur\""),
        Rule::C14,
        Error,
    );
    only(
        &in_volume("</grids/volume/density>", "</grids/volume/fur>"),
        Rule::C14,
        Error,
    );
}

/// A package whose members are stored, each at a multiple of 64 bytes or one byte off.
fn package(members: &[(&str, &[u8])], off: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (name, data) in members {
        let start = (bytes.len() + 30 + name.len() + 4).next_multiple_of(64) + off;
        let extra = start - bytes.len() - 30 - name.len();
        bytes.extend(b"PK\x03\x04\x14\0\0\0\0\0\0\0\0\0\0\0\0\0");
        bytes.extend((data.len() as u32).to_le_bytes());
        bytes.extend((data.len() as u32).to_le_bytes());
        bytes.extend((name.len() as u16).to_le_bytes());
        bytes.extend((extra as u16).to_le_bytes());
        bytes.extend(name.as_bytes());
        bytes.resize(start, 0);
        bytes.extend(*data);
    }
    bytes.extend(b"PK\x01\x02");
    bytes
}

#[test]
fn c15_packages() {
    let fur = ("fur.usda", FUR.as_bytes());
    let pack = |members: &[(&str, &[u8])], off| {
        in_files(&[("fur.usdz", &package(members, off))], &["fur.usdz"], &[])
    };
    assert_eq!(pack(&[fur], 0), []);
    only(&pack(&[fur, ("fur.vdb", &sound())], 0), Rule::C15, Error);
    only(&pack(&[fur], 1), Rule::C15, Error);
    only(&found(FUR, &[Consumer::Ar]), Rule::C15, Error);
    let volume = [("fur.vdb", &sound()[..]), ("grids.usda", VOLUME.as_bytes())];
    only(
        &in_files(&volume, &["grids.usda"], &[Consumer::Ar]),
        Rule::C15,
        Error,
    );
    // What is deflated cannot be looked into, but that is said.
    let mut deflated = package(&[fur], 0);
    deflated[8] = 8;
    only(
        &in_files(&[("fur.usdz", &deflated)], &["fur.usdz"], &[]),
        Rule::C15,
        Error,
    );
}

#[test]
fn c20_frames() {
    let with = |grids: &[u8], volume: &str| {
        let files: [(&str, &[u8]); 3] = [
            ("fur.usda", FUR.as_bytes()),
            ("fur.vdb", grids),
            ("grids.usda", volume.as_bytes()),
        ];
        in_files(&files, &["fur.usda", "grids.usda"], &[])
    };
    // Grids in centimeters under a layer in meters, and the layer in centimeters under grids in meters.
    let in_cm = fog([1.0, 2.0], 1.0, false);
    let all = with(&in_cm, VOLUME);
    only(&all, Rule::C20, Error);
    assert!(all[0].message.contains("times as large"), "{all:?}");
    let in_cm = VOLUME.replace("metersPerUnit = 1", "metersPerUnit = 0.01");
    only(&with(&sound(), &in_cm), Rule::C20, Error);
    // The same numbers with another axis up: fur that lies elsewhere.
    let z_up = VOLUME.replace("upAxis = \"Y\"", "upAxis = \"Z\"");
    only(&with(&sound(), &z_up), Rule::C20, Error);
    let files: [(&str, &[u8]); 2] = [
        ("fur.usda", FUR.as_bytes()),
        ("far.vdb", &fog([1.0, 2.0], 0.2, false)),
    ];
    only(
        &in_files(&files, &["fur.usda", "far.vdb"], &[]),
        Rule::C20,
        Error,
    );
}

#[test]
fn c20_boxes() {
    // A sixth of their room in common.
    let large = fog([1.0, 2.0], 0.013, false);
    let files: [(&str, &[u8]); 2] = [("fur.usda", FUR.as_bytes()), ("fur.vdb", &large)];
    only(
        &in_files(&files, &["fur.usda", "fur.vdb"], &[]),
        Rule::C20,
        Warning,
    );
    // The extent of the volume that shows the grids.
    let far = "[(5.245, -0.005, 0.245), (5.505, 0.025, 0.755)]";
    let near = "[(0.245, -0.005, 0.245), (0.505, 0.025, 0.755)]";
    only(&in_volume(near, far), Rule::C20, Error);
    assert_eq!(
        in_volume("extent = [(0.245", "extend = [(0.245")[0].rule,
        Rule::C11
    );
    // Grids that are moved are left out.
    let moved = VOLUME.replace(
        "        rel field",
        "        uniform token[] xformOpOrder = [\"xformOp:scale\"]\n        rel field",
    );
    let files: [(&str, &[u8]); 3] = [
        ("fur.usda", FUR.as_bytes()),
        ("fur.vdb", &fog([1.0, 2.0], 1.0, false)),
        ("grids.usda", moved.as_bytes()),
    ];
    assert_eq!(in_files(&files, &["fur.usda", "grids.usda"], &[]), []);
}

/// Grids that cannot be looked at are a note that says why.
#[test]
fn c13_unread_grids() {
    let noted = |at: usize, value: u8| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fur.vdb");
        let mut bytes = sound();
        bytes[at] = value;
        fs::write(&path, bytes).unwrap();
        let all = check(&[path], &CheckSettings::default()).findings;
        let notes = all.into_iter().filter(|f| f.severity == Note);
        notes.map(|f| f.message).collect::<String>()
    };
    assert_eq!(noted(8, 224), "");
    assert!(noted(8, 221).contains("version 221"));
    // Whether the file says where its grids are.
    assert!(noted(20, 0).contains("as a stream"));
}

#[test]
fn files_that_are_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |name: &str, bytes: &[u8]| {
        let path: &Path = &folder.path().join(name);
        fs::write(path, bytes).unwrap();
        let refused = check(&[path], &CheckSettings::default()).refused;
        assert_eq!(refused.len(), 1);
        refused[0].error.to_string()
    };
    assert!(refused("fur.obj", b"").contains("must end in"));
    assert!(refused("fur.usda", b"#usda 1.0\ndef \"a\" {").contains("ends within a prim"));
    assert!(refused("fur.usdc", b"").contains("no USD file"));
    assert!(refused("fur.vdb", &sound()[..200]).contains("ends too early"));
    assert!(refused("fur.usdz", FUR.as_bytes()).contains("is a zip archive"));
}
