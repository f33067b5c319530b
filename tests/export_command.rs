//! `vair export` from outside: what it writes, what it refuses, what it leaves behind.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use vair::groom::{self, GroomSettings};
use vair::progress::{Cancel, Silent};
use vair::{skin, species};

fn export(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_vair"))
        .current_dir(folder)
        .args(["export", "red-fox", "--skin", "ball", "--no-material"])
        .args(arguments)
        .output()
        .unwrap()
}

fn refused(arguments: &[&str], words: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let output = export(folder.path(), arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {said}");
    for word in words {
        assert!(said.contains(word), "{arguments:?}: no {word:?} in {said}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// Fewer strands than classes: one level of what there is.
#[test]
fn a_single_strand_is_an_asset() {
    let folder = tempfile::tempdir().unwrap();
    let output = export(folder.path(), &["--strands", "1", "-o", "fox.usda"]);
    assert!(output.status.success(), "{output:?}");
    let text = fs::read_to_string(folder.path().join("fox.usda")).unwrap();
    // Once to render, once for viewports.
    assert_eq!(text.matches("def BasisCurves \"under\"").count(), 2);
}

#[test]
fn what_cannot_be_written_is_refused_with_a_remedy() {
    refused(&["-o", "fox.abc"], &["fox.abc", ".usdc"]);
    refused(
        &["--profile", "maxwell", "-o", "fox.usdc"],
        &["maxwell", "blender"],
    );
    refused(
        &["--levels", "9", "-o", "fox.usdc"],
        &["--levels", "1 to 4"],
    );
    refused(&["--strands", "0", "-o", "fox.usdc"], &["0 strands"]);
    refused(
        &["--strands", "5e6", "-o", "fox.usda"],
        &["of text", ".usdc"],
    );
}

#[test]
fn size_is_said_before_and_counts_after() {
    let folder = tempfile::tempdir().unwrap();
    let output = export(folder.path(), &["--strands", "4000", "-o", "fox.usdc"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    assert!(
        said.contains("4000 strands of 32000 points: about"),
        "{said}"
    );
    assert!(said.contains("fox.usdc: full"), "{said}");
    let size = fs::metadata(folder.path().join("fox.usdc")).unwrap().len() as f64;
    let (_, rest) = said.split_once("about ").unwrap();
    let foretold: f64 = rest.split_once(" MB").unwrap().0.parse().unwrap();
    // The viewport's curves come on top; here they are half as many as those for pictures.
    assert!(
        (0.5..1.1).contains(&(1e6 * foretold / size)),
        "{foretold} MB, {size} bytes"
    );
}

/// The numbers of the first array of that name in a text asset.
fn numbers(text: &str, name: &str) -> Vec<f32> {
    let (_, rest) = text.split_once(&format!("{name} = [")).unwrap();
    let (array, _) = rest.split_once(']').unwrap();
    let numbers = array.split([',', '(', ')', ' ']).filter(|n| !n.is_empty());
    numbers.map(|n| n.parse().unwrap()).collect()
}

/// The color of the skin at every corner of its triangles.
fn skin_colors(folder: &Path, coat: &str) -> Vec<[f32; 3]> {
    let arguments = ["--strands", "500", "--coat", coat, "-o", "fox.usda"];
    assert!(export(folder, &arguments).status.success());
    let text = fs::read_to_string(folder.join("fox.usda")).unwrap();
    let colors = numbers(&text, "primvars:displayColor");
    let corners = numbers(&text, "faceVertexIndices");
    let of = |corner: f32| std::array::from_fn(|channel| colors[3 * corner as usize + channel]);
    corners.into_iter().map(of).collect()
}

/// The skin under a coat of several colors is tinted as in pictures.
#[test]
fn the_skin_is_as_dark_as_the_coat_over_it() {
    let folder = tempfile::tempdir().unwrap();
    let coated = skin_colors(folder.path(), "zebra");
    let plain = skin_colors(folder.path(), "none");
    let ball = skin::load("ball").unwrap();
    let mut fox = species::load("red-fox", &[]).unwrap();
    fox.wear("zebra").unwrap();
    let settings = GroomSettings {
        strands: Some(500),
        seed: 0,
    };
    let fur = groom::grow(&ball, &fox, &settings, &Silent, &Cancel::default()).unwrap();
    let vertices: Vec<u32> = ball.triangles.iter().flatten().copied().collect();
    assert_eq!(coated.len(), vertices.len());
    let own = fox.skin_color.map(|c| c as f32);
    for (corner, &vertex) in vertices.iter().enumerate() {
        let vertex = vertex as usize;
        for (channel, own) in own.into_iter().enumerate() {
            let expected = ball.color[vertex][channel] * own;
            assert_eq!(plain[corner][channel], expected);
            let expected = expected * fur.skin_tint[vertex][channel];
            let found = coated[corner][channel];
            assert!(
                (found - expected).abs() <= 1e-6 * expected,
                "{found} for {expected}"
            );
        }
    }
    let changed = coated.iter().zip(&plain).filter(|(a, b)| a != b).count();
    assert!(changed > coated.len() / 2, "{changed} of {}", coated.len());
}

#[test]
fn layers_of_the_coat_that_are_left_out_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["--strands", "500", "--coat", "siamese", "-o", "fox.usdc"];
    let output = export(folder.path(), &arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    assert!(
        said.contains("layers of the coat are left out") && said.contains("paws"),
        "{said}"
    );
}

/// What a skin in other units or with another axis up is told to be, it is for exports too.
#[test]
fn skins_in_centimeters_are_exported() {
    let folder = tempfile::tempdir().unwrap();
    // 65 cm along the file's z, 20 along x.
    let tall = "v 0 0 0\nv 20 0 0\nv 0 0 65\nf 1 2 3\n";
    fs::write(folder.path().join("tall.obj"), tall).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_vair"))
        .current_dir(folder.path())
        .args(["export", "red-fox", "--skin", "tall.obj", "--no-material"])
        .args(["--skin-units", "cm", "--skin-up", "z", "--strands", "500"])
        .args(["-o", "fox.usda"])
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    assert!(!said.contains("m large"), "{said}");
    let text = fs::read_to_string(folder.path().join("fox.usda")).unwrap();
    let (_, mesh) = text.split_once("def Mesh \"skin\"").unwrap();
    let extent = numbers(mesh, "extent");
    for (found, expected) in extent.iter().zip([0.0, 0.0, 0.0, 0.2, 0.65, 0.0]) {
        assert!((found - expected).abs() < 1e-6, "{extent:?}");
    }
}

/// Files of USD say their units and axis, in which places on the skin are then given too.
#[test]
fn whorls_lie_where_the_skin_s_file_has_them() {
    let folder = tempfile::tempdir().unwrap();
    let square = "#usda 1.0\n(\n    metersPerUnit = 0.01\n    upAxis = \"Z\"\n)\ndef Mesh \"square\"\n{\n\
                  uniform token subdivisionScheme = \"none\"\nint[] faceVertexCounts = [4]\n\
                  int[] faceVertexIndices = [0, 1, 2, 3]\n\
                  point3f[] points = [(0, 30, 5), (40, 30, 5), (40, 60, 5), (0, 60, 5)]\n}\n";
    fs::write(folder.path().join("square.usda"), square).unwrap();
    let whorl = |center: &str| {
        let set = format!("groom.comb.whorl=[{{center=[{center}],radius_mm=40}}]");
        // The file's own word counts, however often it is repeated.
        let output = Command::new(env!("CARGO_BIN_EXE_vair"))
            .current_dir(folder.path())
            .args([
                "export",
                "red-fox",
                "--skin",
                "square.usda",
                "--skin-up",
                "z",
            ])
            .args(["--set", &set, "--strands", "200", "-o", "a.npz"])
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{said}");
        said
    };
    assert!(!whorl("10, 40, 5").contains("from the skin"));
    assert!(whorl("0.1, 0.05, -0.4").contains("from the skin"));
}

#[test]
fn files_that_would_be_written_over_each_other_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["-o", "x.usdc", "-o", "./x.usdc"][..],
        &[
            "-o",
            "a.usda",
            "-o",
            "a.payload.usdc",
            "--layout",
            "payload",
        ],
        &["-o", "a.usdc", "-o", "a.vdb", "--wrap", "a.usdc"],
        &[
            "-o",
            "a.usda",
            "-o",
            "a.vdb",
            "--wrap",
            "a.payload.usdc",
            "--layout",
            "payload",
        ],
    ] {
        let output = export(folder.path(), &[&["--strands", "100"], arguments].concat());
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains("would be written twice"), "{said}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

/// Whatever units an asset has that the same command writes.
#[test]
fn gltf_is_in_meters_with_y_up() {
    let folder = tempfile::tempdir().unwrap();
    let written = |name: &str, arguments: &[&str]| {
        let output = [&["--strands", "200", "-o", name], arguments].concat();
        assert!(export(folder.path(), &output).status.success());
        fs::read(folder.path().join(name)).unwrap()
    };
    let turned = written("turned.glb", &["--units", "cm", "--up", "z"]);
    assert_eq!(turned, written("plain.glb", &[]));
}

#[test]
fn a_payload_goes_beside_the_interface() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["--strands", "500", "--layout", "payload", "-o", "fox.usda"];
    assert!(export(folder.path(), &arguments).status.success());
    let interface = fs::read_to_string(folder.path().join("fox.usda")).unwrap();
    assert!(interface.contains("prepend payload = @./fox.payload.usdc@"));
    assert!(interface.contains("extentsHint") && interface.len() < 50_000);
    assert!(folder.path().join("fox.payload.usdc").exists());
}

#[test]
fn names_may_have_the_sign_that_ends_a_path() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [
        "--strands",
        "500",
        "--layout",
        "payload",
        "-o",
        "fox@2x.usda",
    ];
    assert!(export(folder.path(), &arguments).status.success());
    let interface = fs::read_to_string(folder.path().join("fox@2x.usda")).unwrap();
    assert!(interface.contains("identifier = @@@./fox@2x.usda@@@\n"));
    assert!(interface.contains("payload = @@@./fox@2x.payload.usdc@@@\n"));
}

#[test]
fn the_bytes_do_not_depend_on_threads() {
    let folder = tempfile::tempdir().unwrap();
    let written = |threads: &str| {
        let file = format!("{threads}/fox.usd");
        fs::create_dir(folder.path().join(threads)).unwrap();
        let arguments = ["--strands", "9000", "--threads", threads, "-o", &file];
        assert!(export(folder.path(), &arguments).status.success());
        fs::read(folder.path().join(file)).unwrap()
    };
    assert!(written("1") == written("4"));
}

/// The file says what became of the follicles of each class, as the console does.
#[test]
fn what_did_not_grow_stands_in_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let entry = "{what=\"density\",by=\"noise\",size_mm=20,from=0.3,to=0.6}";
    let vary = format!("under.groom.vary=[{entry}]");
    let arguments = ["--set", &vary, "--strands", "2000", "-o", "fox.usda"];
    let output = export(folder.path(), &arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    let text = fs::read_to_string(folder.path().join("fox.usda")).unwrap();
    let start = text.find("dictionary follicles").unwrap();
    let told = &text[start..start + text[start..].find("string program").unwrap()];
    let count = |class: &str, name: &str| -> usize {
        let of = told.split_once(&format!("dictionary {class} ")).unwrap().1;
        let of = of.split_once('}').unwrap().0;
        let line = of.split_once(&format!("int {name} = ")).map(|(_, n)| n);
        line.map_or(0, |n| n.lines().next().unwrap().parse().unwrap())
    };
    let (asked, lost) = (count("under", "asked"), count("under", "less_density"));
    assert!(
        lost > asked / 3 && asked == count("under", "grown") + lost,
        "{told}"
    );
    let sentence = format!("{lost} of {asked} strands of `under` did not grow: {lost} are where");
    assert!(said.contains(&sentence), "{said}");
    assert_eq!(count("guard", "less_density"), 0);
}
