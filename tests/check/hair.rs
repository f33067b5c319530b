//! Faults in Cem Yuksel's hair files.

use super::FUR;
use std::fs;
use vair::check::Severity::{Error, Note, Warning};
use vair::check::{CheckSettings, Checked, Consumer, Finding, Rule, Severity, check};
use vair::export::lines::{LineFormat, LineSet, write};

/// Two strands of four points, with colors.
fn set() -> LineSet {
    let point = |i: usize| glam::Vec3::new(0.25, 0.01 * (i % 4) as f32, 0.25 * (1 + i / 4) as f32);
    LineSet {
        points: (0..8).map(point).collect(),
        widths: vec![1e-4; 8],
        offsets: vec![0, 4, 8],
        colors: vec![glam::Vec3::new(0.5, 0.25, 0.125); 8],
    }
}

fn bytes() -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fur.hair");
    write(&path, LineFormat::Hair, &set().lines("test")).unwrap();
    fs::read(path).unwrap()
}

fn checked(bytes: &[u8], settings: &CheckSettings) -> Checked {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fur.hair");
    fs::write(&path, bytes).unwrap();
    check(&[path], settings)
}

fn found(bytes: &[u8]) -> Vec<Finding> {
    let checked = checked(bytes, &CheckSettings::default());
    assert!(checked.refused.is_empty(), "{:?}", checked.refused);
    let all = checked.findings.into_iter();
    all.filter(|f| f.severity > Note).collect()
}

/// The sound file with other bytes at some places.
fn planted(rule: Rule, severity: Severity, edits: &[(usize, &[u8])]) -> Finding {
    let mut bytes = bytes();
    for (at, new) in edits {
        bytes[*at..*at + new.len()].copy_from_slice(new);
    }
    let all = found(&bytes);
    assert_eq!(all.len(), 1, "{all:#?}");
    assert_eq!((all[0].rule, all[0].severity), (rule, severity), "{all:#?}");
    all[0].clone()
}

/// Where the arrays of the sound file begin.
const SEGMENTS: usize = 128;
const POINTS: usize = SEGMENTS + 2 * 2;
const THICKNESS: usize = POINTS + 8 * 12;
const COLORS: usize = THICKNESS + 8 * 4;

#[test]
fn what_is_written_is_clean() {
    assert_eq!(found(&bytes()), []);
    // What the converter of pbrt leaves out is good to know.
    let all = checked(&bytes(), &CheckSettings::default()).findings;
    assert_eq!(all.len(), 1, "{all:?}");
    assert_eq!(all[0].consumers, [Consumer::Pbrt]);
    assert!(all[0].message.contains("colors"), "{all:?}");
}

#[test]
fn faults_are_found() {
    let nan = f32::NAN.to_le_bytes();
    planted(Rule::C03, Error, &[(THICKNESS, &nan)]);
    planted(Rule::C03, Error, &[(POINTS + 8, &nan)]);
    planted(Rule::C03, Error, &[(COLORS + 4, &nan)]);
    planted(Rule::C01, Error, &[(THICKNESS, &(-1f32).to_le_bytes())]);
    planted(Rule::C01, Warning, &[(THICKNESS, &[0; 4])]);
    let header = planted(Rule::C01, Warning, &[(20, &[0; 4])]);
    assert_eq!(header.consumers, [Consumer::Pbrt]);
    // Counts that are not those of the points, or leave nothing.
    planted(Rule::C04, Error, &[(SEGMENTS, &[4, 0])]);
    planted(Rule::C04, Error, &[(SEGMENTS, &[0, 0, 6, 0])]);
    planted(Rule::C04, Warning, &[(SEGMENTS, &[2, 0, 4, 0])]);
    let same = [0.25f32, 0.0, 0.25]
        .map(f32::to_le_bytes)
        .concat()
        .repeat(4);
    planted(Rule::C04, Warning, &[(POINTS, &same)]);
    // An array that nobody knows, and bytes that belong to none.
    planted(Rule::C10, Error, &[(12, &[0x57])]);
    let more = [bytes(), vec![0; 3]].concat();
    assert_eq!(found(&more)[0].rule, Rule::C04);
    // Texture coordinates, as LuxCore has them, are no such bytes.
    let mut with_uvs = [bytes(), vec![0; 8 * 8]].concat();
    with_uvs[12] |= 32;
    assert_eq!(found(&with_uvs), []);
    assert_eq!(found(&with_uvs[..with_uvs.len() - 1])[0].rule, Rule::C04);
}

/// A header may stand for the arrays, and say nothing.
#[test]
fn headers_without_arrays() {
    let whole = bytes();
    let mut head = whole[..128].to_vec();
    head[12] = 2;
    let points = &whole[POINTS..THICKNESS];
    head[16] = 3;
    assert_eq!(found(&[&head[..], points].concat()), []);
    head[20..24].copy_from_slice(&[0; 4]);
    let all = found(&[&head[..], points].concat());
    assert_eq!(
        (all.len(), all[0].rule, all[0].severity),
        (1, Rule::C01, Error)
    );
    head[20..24].copy_from_slice(&1e-4f32.to_le_bytes());
    head[12] = 0;
    assert_eq!(found(&head)[0].rule, Rule::C04);
    // Four billion strands without any bytes.
    head[12] = 2;
    head[4..8].copy_from_slice(&[255; 4]);
    assert_eq!(found(&[&head[..], points].concat())[0].rule, Rule::C04);
}

#[test]
fn numbers_of_strands_places_and_files_that_are_none() {
    for (strands, errors) in [(2, 0), (3, 1)] {
        let settings = CheckSettings {
            strands: Some(strands),
            ..CheckSettings::default()
        };
        let all = checked(&bytes(), &settings).findings;
        let number = all.iter().filter(|f| f.rule == Rule::C18).count();
        assert_eq!(number, errors, "{all:?}");
    }
    for (bytes, word) in [
        (&bytes()[..100], "too few"),
        (&bytes()[..200], "but the file has 200"),
        (FUR.as_bytes(), "no hair file"),
    ] {
        let refused = checked(bytes, &CheckSettings::default()).refused;
        assert_eq!(refused.len(), 1);
        let said = refused[0].error.to_string();
        assert!(said.contains("fur.hair: ") && said.contains(word), "{said}");
    }
    for name in ["fur.npz", "fur.PLY", "fur.glb", "fur.pbrt"] {
        let refused = check(&[name], &CheckSettings::default()).refused;
        let said = refused[0].error.to_string();
        assert!(said.contains("no rules") && said.contains(name), "{said}");
    }
    // Against grids that lie elsewhere.
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("fur.hair"), bytes()).unwrap();
    fs::write(at("fur.vdb"), super::grids::fog([1.0, 2.0], 10.0, false)).unwrap();
    let all = check(&[at("fur.hair"), at("fur.vdb")], &CheckSettings::default()).findings;
    let frames = all.iter().filter(|f| f.rule == Rule::C20).count();
    assert_eq!(frames, 1, "{all:?}");
}
