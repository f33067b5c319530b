//! Broken mesh files: refused with the file named, never a panic, in bounded time.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::path::Path;
use std::time::Duration;
use vair::fiber::Fiber;
use vair::species;

/// Whether the mesh at `path` makes a fiber; the refusal otherwise.
fn build(path: &Path, more: &[&str]) -> Result<Fiber, String> {
    let mut set = vec![format!("structure.mesh.file={}", path.display())];
    set.extend(more.iter().map(|s| (*s).to_owned()));
    let species = species::load("glass-cylinder", &set).map_err(|e| e.to_string())?;
    let station = species.classes[0].stations.last().unwrap();
    Fiber::build(&station.structure, 0).map_err(|e| e.to_string())
}

/// A prism of eight sides and 100 um, open at both ends, with faces left out or added.
fn prism(extra: &str, sides: usize) -> String {
    let mut text = "o cuticle\n".to_owned();
    for z in [0, 100] {
        for k in 0..8 {
            let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_4).sin_cos();
            text += &format!("v {} {} {z}\n", 40.0 * cos, 40.0 * sin);
        }
    }
    for k in 0..sides {
        let (a, b) = (k + 1, (k + 1) % 8 + 1);
        text += &format!("f {a} {b} {} {}\n", b + 8, a + 8);
    }
    text + extra
}

fn refusal(name: &str, bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let start = worked();
    let message = build(&path, &[]).err().unwrap_or_default();
    let took = worked() - start;
    assert!(took < Duration::from_secs(5), "{name}: {took:?}: {message}");
    message
}

/// How long this thread has been working: a busy machine makes it wait, not work. Meshes are read and
/// built on the thread that asks.
#[cfg(target_os = "linux")]
fn worked() -> Duration {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    let nanoseconds = text.split_whitespace().next().unwrap();
    Duration::from_nanos(nanoseconds.parse().unwrap())
}

/// Where the system does not say how long a thread works: the time since the first call.
#[cfg(not(target_os = "linux"))]
fn worked() -> Duration {
    static FIRST: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    FIRST.get_or_init(std::time::Instant::now).elapsed()
}

#[test]
fn a_prism_is_a_fiber_and_what_is_wrong_with_it_is_said_with_the_place() {
    assert_eq!(refusal("good.obj", prism("", 8).as_bytes()), "");
    let cases = [
        (
            "hole",
            prism("", 7),
            "the cuticle is open along 2 edges, at (",
        ),
        (
            "fin",
            prism("v 0 0 50\nf 1 2 17\n", 8),
            "three faces or more",
        ),
        (
            "flat",
            "o cuticle\nv 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n".to_owned(),
            "across",
        ),
        ("nan", prism("v nan 0 0\n", 8), "not finite"),
        (
            "huge",
            prism("v 1e30 0 0\nf 1 2 17\n", 8),
            "not finite or beyond",
        ),
        (
            "index",
            prism("f 1 2 4294967297\n", 8),
            "have been defined so far",
        ),
        (
            "name",
            prism("o lid\nf 1 2 3\n", 8),
            "parts of unknown role: `lid`",
        ),
        (
            "void",
            prism(
                "o void\nv 90 0 40\nv 95 0 40\nv 90 5 40\nv 90 0 45\nf 17 19 18\nf 17 18 20\nf 17 20 19\nf 18 19 20\n",
                8,
            ),
            "the void lies outside of the cuticle, at (",
        ),
        (
            "sticks-out",
            prism(
                "o void\nv 30 0 40\nv 60 1 40\nv 30 5 40\nv 30 0 45\nf 17 19 18\nf 17 18 20\nf 17 20 19\nf 18 19 20\n",
                8,
            ),
            "goes through the cuticle",
        ),
    ];
    for (name, text, expected) in cases {
        let message = refusal(&format!("{name}.obj"), text.as_bytes());
        assert!(message.contains(expected), "{name}: {message}");
        assert!(message.contains(&format!("{name}.obj")) || name == "name" || name == "flat");
    }
}

#[test]
fn wound_wrong_is_mended_and_caps_are_taken_away() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("capped.obj");
    let text = prism("f 8 7 6 5 4 3 2 1\nf 9 10 11 12 13 14 15 16\n", 8);
    let turned = text.replacen("f 1 2 10 9", "f 9 10 2 1", 1);
    std::fs::write(&path, turned).unwrap();
    let fiber = build(&path, &["structure.mesh.ends=capped"]).unwrap();
    assert!((fiber.period_um() - 100.0).abs() < 1e-6);
    assert_eq!(fiber.warnings().len(), 1);
    assert!(
        fiber.warnings()[0].contains("2 faces were wound against"),
        "{:?}",
        fiber.warnings()
    );
}

/// Counts that the files have no room for are refused before anything is allocated.
#[test]
fn counts_that_lie() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 2147483648\nproperty float x\n\
               property float y\nproperty float z\nelement face 1\n\
               property list uchar int vertex_indices\nend_header\n0 0 0\n";
    assert!(refusal("count.ply", ply.as_bytes()).contains("announced"));
    for count in ["2147483648", "18446744073709551615"] {
        let gltf = format!(
            r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0,"name":"cuticle"}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":{count},"type":"VEC3"}}],
            "bufferViews":[{{"buffer":0,"byteLength":12}}],
            "buffers":[{{"byteLength":12,"uri":"data:;base64,AAAAAAAAAAAAAAAA"}}]}}"#
        );
        assert!(refusal("count.gltf", gltf.as_bytes()).contains("more than its buffer holds"));
    }
    let remote = r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":1,"uri":"../../etc/x"}]}"#;
    assert!(refusal("remote.gltf", remote.as_bytes()).contains("only files beside this one"));
    let ring = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"children":[0]}]}"#;
    assert!(refusal("ring.gltf", ring.as_bytes()).contains("nest too deeply"));
}

/// A .glb cut anywhere or with any byte changed: no panic.
#[test]
fn mutated_glb_files_never_panic() {
    let species = species::load("glass-cylinder", &[]).unwrap();
    let fiber = Fiber::build(&species.classes[0].stations[0].structure, 0).unwrap();
    let bytes = fiber.to_glb("glass");
    let mut state = 1u64;
    let mut random = |n: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as usize % n
    };
    let mut refused = 0;
    for round in 0..300 {
        let mut bad = bytes.clone();
        if round % 3 == 0 {
            bad.truncate(random(bytes.len()));
        } else {
            // The text, and what follows it.
            for _ in 0..3 {
                bad[random(2400)] = random(256) as u8;
            }
        }
        refused += usize::from(!refusal("bad.glb", &bad).is_empty());
    }
    assert!(refused > 200, "{refused}");
}

/// Very many faces in one place end in bounded time.
#[test]
fn crowds_of_faces() {
    let mut text = prism("o void\n", 8);
    for k in 0..60_000 {
        let (sin, cos) = f64::from(k).sin_cos();
        text += &format!(
            "v {} {} 40\nv {} {} 60\nv {} {} 51\n",
            cos, sin, -cos, sin, sin, -cos
        );
        text += "f -1 -2 -3\n";
    }
    assert!(refusal("crowd.obj", text.as_bytes()).contains("crowd.obj"));
}
