//! Meshes from files: good ones come through unchanged, bad ones are refused with the place named.

use crate::blame::Blame;
use crate::mesh_file::{Format, parse};
use crate::sampling::Rng;
use crate::skin::{Placing, Skin, SkinError, Up, load, load_placed};
use glam::Vec3;

fn obj(file: &str, bytes: &[u8]) -> Result<Skin, SkinError> {
    parse(Format::Obj, file, bytes)?.into_skin(file)
}

fn ply(file: &str, bytes: &[u8]) -> Result<Skin, SkinError> {
    parse(Format::Ply, file, bytes)?.into_skin(file)
}

const CUBE: [[i32; 3]; 8] = [
    [0, 0, 0],
    [1, 0, 0],
    [1, 1, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 0, 1],
    [1, 1, 1],
    [0, 1, 1],
];
const SIDES: [[u32; 4]; 6] = [
    [0, 3, 2, 1],
    [4, 5, 6, 7],
    [0, 1, 5, 4],
    [1, 2, 6, 5],
    [2, 3, 7, 6],
    [3, 0, 4, 7],
];

fn cube_obj(corner: impl Fn(u32) -> String) -> String {
    let mut text = "# a unit cube\no cube\n".to_owned();
    for [x, y, z] in CUBE {
        text += &format!("v {x} {y} {z}\n");
    }
    for side in SIDES {
        let words: Vec<String> = side.iter().map(|&v| corner(v)).collect();
        text += &format!("f {}\n", words.join(" "));
    }
    text
}

fn ply_header(format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment a unit cube\nelement vertex 8\nproperty float x\n\
         property float y\nproperty float z\nelement face 6\n\
         property list uchar int vertex_indices\nend_header\n"
    )
}

fn cube_ply_ascii() -> Vec<u8> {
    let mut text = ply_header("ascii");
    for [x, y, z] in CUBE {
        text += &format!("{x} {y} {z}\n");
    }
    for [a, b, c, d] in SIDES {
        text += &format!("4 {a} {b} {c} {d}\n");
    }
    text.into_bytes()
}

fn cube_ply_binary(big: bool) -> Vec<u8> {
    let format = if big {
        "binary_big_endian"
    } else {
        "binary_little_endian"
    };
    let mut bytes = ply_header(format).into_bytes();
    let word = |bits: u32, out: &mut Vec<u8>| {
        out.extend(if big {
            bits.to_be_bytes()
        } else {
            bits.to_le_bytes()
        });
    };
    for v in CUBE.iter().flatten() {
        word((*v as f32).to_bits(), &mut bytes);
    }
    for side in SIDES {
        bytes.push(4);
        for v in side {
            word(v, &mut bytes);
        }
    }
    bytes
}

fn assert_is_the_cube(skin: &Skin) {
    assert_eq!((skin.positions.len(), skin.triangles.len()), (8, 12));
    // The cube is sound; only texture coordinates are made up.
    assert_eq!(skin.warnings.len(), 1, "{:?}", skin.warnings);
    assert!(skin.warnings[0].contains("no texture coordinates"));
    assert!((skin.area() - 6.0).abs() < 1e-6);
    assert!((super::volume(skin, 0..12) - 1.0).abs() < 1e-6);
    // Weighted by angle, a cube's corner normal is the diagonal however the sides are cut.
    for (p, n) in skin.positions.iter().zip(&skin.normals) {
        let diagonal = (*p - 0.5).normalize();
        assert!(n.distance(diagonal) < 1e-6, "{p} {n}");
    }
}

#[test]
fn the_cube_comes_through_in_every_format() {
    assert_is_the_cube(&obj("c.obj", cube_obj(|v| format!("{}", v + 1)).as_bytes()).unwrap());
    let from_end = cube_obj(|v| format!("{}", i64::from(v) - 8));
    assert_is_the_cube(&obj("c.obj", from_end.as_bytes()).unwrap());
    let windows = cube_obj(|v| format!("{}", v + 1)).replace('\n', "\r\n");
    assert_is_the_cube(&obj("c.obj", windows.as_bytes()).unwrap());
    assert_is_the_cube(&ply("c.ply", &cube_ply_ascii()).unwrap());
    assert_is_the_cube(&ply("c.ply", &cube_ply_binary(false)).unwrap());
    assert_is_the_cube(&ply("c.ply", &cube_ply_binary(true)).unwrap());
}

#[test]
fn normals_and_texture_coordinates_are_kept() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.5\nvt 1 0\nvt 0 1\nvn 0 0.6 0.8\n\
                f 1/1/1 2/2/1 3/3/1\n";
    let skin = obj("t.obj", text.as_bytes()).unwrap();
    assert_eq!(skin.uvs[0], glam::Vec2::new(0.25, 0.5));
    assert!(skin.normals[2].distance(Vec3::new(0.0, 0.6, 0.8)) < 1e-6);
}

#[test]
fn what_is_mended_is_counted() {
    let good = cube_obj(|v| format!("{}", v + 1));
    let messy = format!("{good}f 1 1 2\nf 1 2 1\nf 1 4 3\nf 2 6 5\nf 3 2 1\nv 9 9 9\n");
    let skin = obj("m.obj", messy.as_bytes()).unwrap();
    assert_eq!(skin.triangles.len(), 12 + 1, "{:?}", skin.warnings);
    assert_eq!(skin.positions.len(), 8, "the unused vertex is gone");
    assert!(skin.warnings[0].starts_with("2 faces without area"));
    assert!(
        skin.warnings[1].starts_with("2 repeated faces"),
        "{:?}",
        skin.warnings
    );

    let mut inward = cube_obj(|v| format!("{}", v + 1));
    inward = inward
        .lines()
        .map(|l| match l.strip_prefix("f ") {
            Some(f) => format!("f {}\n", f.split(' ').rev().collect::<Vec<_>>().join(" ")),
            None => format!("{l}\n"),
        })
        .collect();
    let skin = obj("i.obj", inward.as_bytes()).unwrap();
    assert!(
        skin.warnings[0].contains("inside out"),
        "{:?}",
        skin.warnings
    );
    assert!((super::volume(&skin, 0..12) - 1.0).abs() < 1e-6);

    let millimeters = "v 0 0 0\nv 65 0 0\nv 0 65 0\nf 1 2 3\n";
    let skin = obj("mm.obj", millimeters.as_bytes()).unwrap();
    assert!(
        skin.warnings[0].contains("65 m large"),
        "{:?}",
        skin.warnings
    );
}

#[test]
fn edges_of_three_faces_are_counted() {
    let cube = cube_obj(|v| format!("{}", v + 1));
    let fin = format!("{cube}v 0.5 0.5 9\nf 1 2 9\n");
    let said = obj("fin.obj", fin.as_bytes()).unwrap().warnings.join("; ");
    assert!(
        said.contains("1 edges belong to more than two faces"),
        "{said}"
    );
}

#[test]
fn units_and_the_axis_that_points_up_are_as_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tall.obj");
    // 650 mm along the file's z, 200 along x.
    std::fs::write(&path, "v 0 0 0\nv 200 0 0\nv 0 0 650\nf 1 2 3\n").unwrap();
    let path = path.to_str().unwrap();
    let placing = Placing {
        unit_m: 1e-3,
        up: Up::Z,
    };
    let skin = load_placed(path, placing).unwrap();
    let (lo, hi) = skin.bounds();
    assert!((skin.area() - 0.5 * 0.2 * 0.65).abs() < 1e-8);
    assert!((hi - lo).distance(Vec3::new(0.2, 0.65, 0.0)) < 1e-6);
    let nothing = Placing {
        unit_m: 0.0,
        up: Up::Y,
    };
    let refused = load_placed(path, nothing).unwrap_err().to_string();
    assert!(refused.contains("is 0 m"), "{refused}");
    // Built-in skins are in meters whatever is said.
    assert_eq!(load_placed("ball", placing).unwrap().name, "ball");
}

#[test]
fn bad_meshes_are_refused_with_the_place_named() {
    let v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let obj_cases: [(&str, String, &[&str]); 12] = [
        (
            "NaN",
            format!("{v}v 1 nan 0\nf 1 2 3\n"),
            &["line 4", "vertex 4", "NaN"],
        ),
        (
            "infinite",
            format!("{v}v 1 inf 0\nf 1 2 3\n"),
            &["line 4", "inf"],
        ),
        (
            "overflow",
            format!("{v}v 1 1e39 0\nf 1 2 3\n"),
            &["line 4", "not finite"],
        ),
        (
            "far away",
            format!("v 1e38 0 0\n{v}f 1 2 3\n"),
            &["line 1", "beyond"],
        ),
        (
            "index too large",
            format!("{v}f 1 2 4\n"),
            &["line 4", "vertex 4", "3 have"],
        ),
        (
            "index zero",
            format!("{v}f 0 1 2\n"),
            &["line 4", "vertex 0"],
        ),
        (
            "index before the first",
            format!("{v}\nf -4 1 2\n"),
            &["line 5", "vertex -4"],
        ),
        (
            "index overflow",
            format!("{v}f 1 2 99999999999999999999\n"),
            &["line 4", "corner"],
        ),
        (
            "two corners",
            format!("{v}f 1 2\n"),
            &["line 4", "2 corners"],
        ),
        ("a word", format!("{v}v 1 two 3\n"), &["line 4", "`two`"]),
        (
            "numbers missing",
            "v 1 2\n".to_owned(),
            &["line 1", "3 numbers"],
        ),
        (
            "flat only",
            format!("{v}f 1 1 2\nf 3 3 3\n"),
            &["no usable face among 2"],
        ),
    ];
    for (name, text, parts) in &obj_cases {
        assert_refused(name, obj("bad.obj", text.as_bytes()), parts);
    }
    assert_refused("empty", obj("bad.obj", b""), &["bad.obj", "no usable face"]);

    let ascii = String::from_utf8(cube_ply_ascii()).unwrap();
    let ply_cases: [(&str, String, &[&str]); 9] = [
        (
            "NaN",
            ascii.replace("\n1 0 0\n", "\n1 nan 0\n"),
            &["line 12", "1 nan 0"],
        ),
        (
            "index",
            ascii.replace("4 0 3 2 1", "4 0 3 2 8"),
            &["face 0", "8"],
        ),
        (
            "negative",
            ascii.replace("4 0 3 2 1", "4 0 3 2 -1"),
            &["face 0", "-1"],
        ),
        (
            "count 2^31",
            ascii.replace("vertex 8", "vertex 2147483648"),
            &["2147483648 vertices"],
        ),
        (
            "count 2^63",
            ascii.replace("face 6", "face 9223372036854775808"),
            &["faces"],
        ),
        (
            "negative count",
            ascii.replace("vertex 8", "vertex -1"),
            &["line 4"],
        ),
        ("cut", ascii[..ascii.len() - 30].to_owned(), &["face"]),
        ("no z", ascii.replace("float z", "float w"), &["`z`"]),
        ("not PLY", "hello\n".to_owned(), &["bad.ply", "line 1"]),
    ];
    for (name, text, parts) in &ply_cases {
        assert_refused(name, ply("bad.ply", text.as_bytes()), parts);
    }
    let mut binary = cube_ply_binary(false);
    let first = ply_header("binary_little_endian").len();
    binary[first + 12..first + 16].copy_from_slice(&f32::NAN.to_le_bytes());
    assert_refused("binary NaN", ply("bad.ply", &binary), &["vertex 1", "NaN"]);
    // Elements without properties take no room: a count alone must not keep the reader busy.
    let hollow = ascii.replace(
        "element face 6",
        "element nothing 1000000000000\nelement face 6",
    );
    assert_refused(
        "hollow",
        ply("bad.ply", hollow.as_bytes()),
        &["elements announced"],
    );
}

fn assert_refused(name: &str, result: Result<Skin, SkinError>, parts: &[&str]) {
    let error = result.err().unwrap_or_else(|| panic!("{name}: accepted"));
    let message = error.to_string();
    for part in parts {
        assert!(
            message.contains(part),
            "{name}: `{part}` is not in: {message}"
        );
    }
    assert!(
        message.contains("bad.") && message.len() < 400,
        "{name}: {message}"
    );
    assert_eq!(error.blame(), Blame::Input, "{name}");
}

#[test]
fn names_and_paths_are_told_apart() {
    let message = load("foxx").unwrap_err().to_string();
    assert!(
        message.contains("`foxx`") && message.contains("body"),
        "{message}"
    );
    let missing = load("no/such/mesh.obj").unwrap_err();
    assert!(missing.to_string().contains("no/such/mesh.obj"));
    assert_eq!(missing.blame(), Blame::Input);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("c.ply");
    std::fs::write(&path, cube_ply_ascii()).unwrap();
    let skin = load(path.to_str().unwrap()).unwrap();
    assert_eq!(skin.name, "c.ply");
    assert_is_the_cube(&skin);
}

/// A million equal triangles: all but one are dropped, in no time.
#[test]
fn coincident_faces_collapse() {
    let mut text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned();
    text += &"f 1 2 3\n".repeat(1_000_000);
    let skin = obj("same.obj", text.as_bytes()).unwrap();
    assert_eq!(skin.triangles.len(), 1);
    assert!(
        skin.warnings[0].starts_with("999999 repeated"),
        "{:?}",
        skin.warnings
    );
}

/// Cuts, flipped bits, overwritten numbers: nothing panics, what is accepted is sound.
#[test]
fn mutated_files_never_panic() {
    let words = [
        "nan",
        "-1",
        "1e39",
        "2147483648",
        "9223372036854775807",
        "0",
        "",
        "/",
        "//",
        "f",
    ];
    let originals = [
        cube_obj(|v| format!("{}/{}", v + 1, "")).into_bytes(),
        cube_ply_ascii(),
        cube_ply_binary(false),
        cube_ply_binary(true),
    ];
    let mut accepted = 0;
    for round in 0..6000 {
        let mut rng = Rng::new(11, round);
        let kind = round as usize % originals.len();
        let mut bytes = originals[kind].clone();
        for _ in 0..1 + rng.bits() % 3 {
            let at = rng.bits() as usize % bytes.len().max(1);
            match rng.bits() % 4 {
                0 => bytes.truncate(at.max(1)),
                1 => bytes[at] ^= 1 << (rng.bits() % 8),
                2 => bytes[at] = rng.bits() as u8,
                _ => {
                    let word = words[rng.bits() as usize % words.len()];
                    let end = (at + 1 + rng.bits() as usize % 3).min(bytes.len());
                    bytes.splice(at..end, word.bytes());
                }
            }
            if bytes.is_empty() {
                bytes.push(b' ');
            }
        }
        let result = if kind == 0 {
            obj("bad.obj", &bytes)
        } else {
            ply("bad.ply", &bytes)
        };
        if let Ok(skin) = result {
            accepted += 1;
            let n = skin.positions.len();
            assert!(skin.triangles.iter().flatten().all(|&v| (v as usize) < n));
            assert!(
                skin.positions
                    .iter()
                    .chain(&skin.normals)
                    .all(|p| p.is_finite())
            );
        }
    }
    assert!(
        (200..5500).contains(&accepted),
        "{accepted} of 6000 accepted"
    );
}
