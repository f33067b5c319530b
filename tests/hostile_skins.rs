//! Broken skins through the commands: refused with the file named, or mended with a count; never a panic,
//! nothing left behind.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// What grows fur on `skin` and writes one file.
const COMMANDS: [&[&str]; 2] = [
    &["export", "red-fox", "--no-material", "-o", "out.usdc"],
    &[
        "render", "red-fox", "--model", "chiang", "--res", "16x12", "--spp", "1", "-o", "out.png",
    ],
];

fn run(folder: &Path, command: &[&str], skin: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_vair"))
        .current_dir(folder)
        .args(command)
        .args(["--strands", "300", "--skin", skin])
        .output()
        .unwrap()
}

/// Runs all commands on a skin; the exit code and what each says.
fn all(name: &str, bytes: &[u8]) -> Vec<(Option<i32>, String)> {
    let run = |command: &&[&str]| {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(name), bytes).unwrap();
        let output = run(folder.path(), command, name);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(!said.contains("panicked"), "{name}: {said}");
        let files = fs::read_dir(folder.path()).unwrap().count();
        let code = output.status.code();
        // The skin, and what was asked for if it could be made.
        assert_eq!(files, 1 + usize::from(code == Some(0)), "{name}: {said}");
        (code, said)
    };
    COMMANDS.iter().map(run).collect()
}

fn refused(name: &str, bytes: &[u8], words: &[&str]) {
    for (code, said) in all(name, bytes) {
        assert_eq!(code, Some(1), "{name}: {said}");
        for word in [name].iter().chain(words) {
            assert!(said.contains(word), "{name}: no {word:?} in {said}");
        }
    }
}

fn mended(name: &str, bytes: &[u8], words: &[&str]) {
    for (code, said) in all(name, bytes) {
        assert_eq!(code, Some(0), "{name}: {said}");
        for word in words {
            assert!(said.contains(word), "{name}: no {word:?} in {said}");
        }
    }
}

/// A square of 10 cm in two triangles, and more lines.
fn square(more: &str) -> String {
    format!("v 0 0 0\nv 0.1 0 0\nv 0.1 0 -0.1\nv 0 0 -0.1\nf 1 2 3\nf 1 3 4\n{more}")
}

fn ply(vertices: &str, faces: &str, body: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
         property float z\nelement face {faces}\nproperty list uchar int vertex_indices\n\
         end_header\n{body}"
    )
}

/// A triangle of three corners, of which a glTF claims `count` corner indices.
fn gltf(corners: [[f32; 3]; 3], count: u64) -> String {
    let mut bytes: Vec<u8> = Vec::new();
    bytes.extend(corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend([0u32, 1, 2].iter().flat_map(|i| i.to_le_bytes()));
    let digits = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let encoded: String = (bytes.chunks(3))
        .flat_map(|three| {
            let bits = u32::from_be_bytes([0, three[0], three[1], three[2]]);
            [18, 12, 6, 0].map(|shift| char::from(digits[(bits >> shift & 63) as usize]))
        })
        .collect();
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},
        {{"bufferView":1,"componentType":5125,"count":{count},"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":12}}],
        "buffers":[{{"byteLength":48,"uri":"data:application/octet-stream;base64,{encoded}"}}]}}"#
    )
}

const CORNERS: [[f32; 3]; 3] = [[0.0; 3], [0.1, 0.0, 0.0], [0.0, 0.0, -0.1]];

fn of_corner(x: f32) -> [[f32; 3]; 3] {
    [CORNERS[0], [x, 0.0, 0.0], CORNERS[2]]
}

#[test]
fn numbers_that_are_none_are_refused() {
    let obj = square("v nan 0 0\n");
    refused("skin.obj", obj.as_bytes(), &["line 7"]);
    let text = ply("3", "1", "0 0 0\n0.1 nan 0\n0 0 -0.1\n3 0 1 2\n");
    refused("skin.ply", text.as_bytes(), &["nan"]);
    refused("skin.gltf", gltf(of_corner(f32::NAN), 3).as_bytes(), &[]);
}

#[test]
fn counts_beyond_the_file_are_refused() {
    let many = "100000000";
    let text = ply("3", many, "0 0 0\n0.1 0 0\n0 0 -0.1\n3 0 1 2\n");
    assert!(text.len() < 1024);
    refused("skin.ply", text.as_bytes(), &["announced"]);
    let binary = text.replace("ascii", "binary_little_endian");
    refused("skin.ply", binary.as_bytes(), &["announced"]);
    refused("skin.gltf", gltf(CORNERS, 300_000_000).as_bytes(), &[]);
    refused("skin.obj", square("f 1 2 100000000\n").as_bytes(), &[many]);
}

#[test]
fn skins_without_area_are_refused() {
    let words = &["no usable face"];
    refused("skin.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", words);
    let text = ply("3", "1", "0 0 0\n0 0 0\n0 0 0\n3 0 1 2\n");
    refused("skin.ply", text.as_bytes(), words);
    refused("skin.gltf", gltf(of_corner(0.0), 3).as_bytes(), words);
    refused("skin.obj", b"", words);
}

#[test]
fn skins_beyond_all_measure_are_refused() {
    let words = &["beyond"];
    refused(
        "skin.obj",
        square("v 1e30 0 0\nf 1 2 5\n").as_bytes(),
        words,
    );
    let text = ply("3", "1", "0 0 0\n1e30 0 0\n0 0 -0.1\n3 0 1 2\n");
    refused("skin.ply", text.as_bytes(), words);
    refused("skin.gltf", gltf(of_corner(1e30), 3).as_bytes(), words);
}

#[test]
fn what_can_be_mended_is_counted() {
    let plain = "no texture coordinates";
    // A face of a line, one twice, and three faces at an edge.
    let more = "v 0 0.1 0\nv 0.05 0 0\nv 0 -0.1 0\nf 1 2 6\nf 2 3 1\nf 1 2 5\nf 1 2 7\n";
    let words = &[
        plain,
        "1 faces without area",
        "1 repeated faces",
        "1 edges belong to more than two",
    ];
    mended("skin.obj", square(more).as_bytes(), words);
    let body = "0 0 0\n0.1 0 0\n0 0 -0.1\n3 0 1 2\n3 0 0 1\n";
    mended(
        "skin.ply",
        ply("3", "2", body).as_bytes(),
        &[plain, "1 faces without area"],
    );
    mended("skin.gltf", gltf(CORNERS, 3).as_bytes(), &[plain]);
    // A kilometer.
    let text = ply("3", "1", "0 0 0\n1000 0 0\n0 0 -0.1\n3 0 1 2\n");
    mended(
        "skin.ply",
        text.as_bytes(),
        &["1000 m large", "--skin-units"],
    );
}
