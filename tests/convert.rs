//! `vair convert` from outside: what comes out, and files that lie about themselves.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fs;
use std::path::Path;
use std::process::Command;

/// A hair file with these numbers in its header and these bytes behind it.
fn hair(strands: u32, points: u32, flags: u32, segments: u32, rest: &[u8]) -> Vec<u8> {
    let mut file = b"HAIR".to_vec();
    for word in [strands, points, flags, segments] {
        file.extend(word.to_le_bytes());
    }
    for number in [1e-4f32, 0.0, 0.5, 0.4, 0.3] {
        file.extend(number.to_le_bytes());
    }
    file.resize(128, 0);
    file.extend(rest);
    file
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// Exit code and messages of the program, which may not take a gigabyte of memory.
fn convert(folder: &Path, file: &[u8], output: &str) -> (Option<i32>, String) {
    convert_under("ulimit -v 1000000", folder, file, output)
}

/// The same under limits of a shell. `output` may have more arguments after it.
fn convert_under(limits: &str, folder: &Path, file: &[u8], output: &str) -> (Option<i32>, String) {
    let input = folder.join("in.hair");
    fs::write(&input, file).unwrap();
    let program = env!("CARGO_BIN_EXE_vair");
    let line = format!("{limits}; exec '{program}' convert in.hair -o {output}");
    let run = Command::new("sh")
        .args(["-c", &line])
        .current_dir(folder)
        .env("RAYON_NUM_THREADS", "2")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&run.stderr);
    // Messages are broken into lines.
    let words: Vec<&str> = said.split_whitespace().filter(|w| *w != "│").collect();
    (run.status.code(), words.join(" "))
}

#[cfg(unix)]
#[test]
fn a_sound_file_becomes_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let points: Vec<f32> = (0..30)
        .map(|i| 0.001 * i as f32 + 0.0003 * (i % 7) as f32)
        .collect();
    let file = hair(2, 10, 2, 4, &floats(&points));
    for name in [
        "x.npz", "x.ply", "x.glb", "x.pbrt", "x.txt", "x.vdb", "x.hair",
    ] {
        let (code, said) = convert(folder.path(), &file, name);
        assert_eq!(code, Some(0), "{name}: {said}");
        assert!(fs::metadata(folder.path().join(name)).unwrap().len() > 100);
    }
}

#[cfg(unix)]
#[test]
fn files_that_lie_are_refused_in_words_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let kilobyte = [0u8; 896];
    let nan = floats(&[0.0, 0.0, 0.0, 1.0, f32::NAN, 0.0]);
    let far = floats(&[0.0, 0.0, 0.0, 1e30, 0.0, 0.0]);
    let cases: [(&str, Vec<u8>, &str, &str); 10] = [
        ("nothing", Vec::new(), "x.npz", "too few"),
        ("text", vec![b'x'; 500], "x.npz", "no hair file"),
        (
            "many strands",
            hair(100_000_000, 0, 3, 0, &kilobyte),
            "x.npz",
            "100000000 strands",
        ),
        (
            "many points",
            hair(1, u32::MAX, 3, 0, &kilobyte),
            "x.npz",
            "4294967295 points",
        ),
        (
            "strands without bytes",
            hair(u32::MAX, 74, 2, 0, &kilobyte),
            "x.npz",
            "need",
        ),
        (
            "more points than strands",
            hair(1, 74, 2, 1, &kilobyte),
            "x.npz",
            "need",
        ),
        (
            "unknown arrays",
            hair(1, 2, 0xf2, 1, &kilobyte),
            "x.npz",
            "unknown kind",
        ),
        (
            "a number that is none",
            hair(1, 2, 2, 1, &nan),
            "x.npz",
            "point 1 of strand 0",
        ),
        (
            "a point without end",
            hair(1, 2, 2, 1, &far),
            "x.vdb",
            "units apart",
        ),
        (
            "a format that is none",
            hair(1, 2, 2, 1, &kilobyte),
            "x.abc",
            ".npz",
        ),
    ];
    for (what, file, output, word) in cases {
        let (code, said) = convert(folder.path(), &file, output);
        assert_eq!(code, Some(1), "{what}: {said}");
        assert!(said.contains(word), "{what}: {said}");
        let left: Vec<_> = fs::read_dir(folder.path()).unwrap().collect();
        assert_eq!(left.len(), 1, "{what}");
    }
}

#[cfg(unix)]
#[test]
fn a_scale_that_makes_widths_infinite_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    // Points and a thickness for each.
    let file = hair(
        1,
        2,
        6,
        1,
        &floats(&[0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 1e30, 1e30]),
    );
    let (code, said) = convert(folder.path(), &file, "x.npz --scale 1e20");
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("makes widths infinite"), "{said}");
    assert!(!folder.path().join("x.npz").exists());
}

/// Where no more can be written, with grids and with strands alike.
#[cfg(unix)]
#[test]
fn a_full_disk_is_told_with_the_name_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let points: Vec<f32> = (0..3000)
        .flat_map(|i| [0.02 * (i / 2) as f32, 0.1 * (i % 2) as f32, 0.0])
        .collect();
    let file = hair(1500, 3000, 2, 1, &floats(&points));
    for name in ["x.vdb", "x.npz"] {
        let limits = "trap '' XFSZ; ulimit -f 16";
        let (code, said) = convert_under(limits, folder.path(), &file, name);
        assert_eq!(code, Some(2), "{name}: {said}");
        assert!(said.contains(&format!("cannot write {name}")), "{said}");
        let left: Vec<_> = fs::read_dir(folder.path()).unwrap().collect();
        assert_eq!(left.len(), 1, "{name}");
    }
}
