//! The command line as a user meets it: exit codes, messages, and no file left by a failure.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;
use vair::table::TableFile;

struct Desk(TempDir);

impl Desk {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn file(&self, name: &str, text: &str) -> &Self {
        std::fs::write(self.0.path().join(name), text).unwrap();
        self
    }

    fn command(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_vair"));
        command
            .current_dir(self.0.path())
            .env("VAIR_CACHE", self.0.path().join("cache"));
        command.env("NO_COLOR", "1");
        command
    }

    fn run(&self, line: &str) -> Output {
        self.command()
            .args(line.split_whitespace())
            .output()
            .unwrap()
    }

    /// Runs a command that must fail with `code`, say all of `words` and leave no file `out.*`.
    fn refuses(&self, line: &str, code: i32, words: &[&str]) {
        let output = self.run(line);
        let said = String::from_utf8_lossy(&output.stderr).replace(['\n', '│', '|'], " ");
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(code), "`{line}` said: {said}");
        for word in words {
            assert!(
                said.contains(word),
                "`{line}` does not say `{word}`: {said}"
            );
        }
        assert_eq!(
            outputs(self.0.path()),
            Vec::<String>::new(),
            "`{line}` left a file"
        );
    }
}

/// Names of files in a folder that a command may have written.
fn outputs(folder: &Path) -> Vec<String> {
    let names = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().file_name());
    names
        .map(|name| name.to_string_lossy().into_owned())
        .filter(|name| name.starts_with("out") || name.contains(".part"))
        .collect()
}

const TRIANGLE: &str = "v 0 0 0\nv 0.1 0 0\nv 0 0 0.1\n";

#[test]
fn species_files() {
    let desk = Desk::new();
    let fox = include_str!("../procedural/species/red-fox.toml");
    desk.file("broken.toml", "name = \"Cat\"\nclasses = [\"guard\"");
    desk.file(
        "key.toml",
        &fox.replace("riser_roughness", "riser_rougness"),
    );
    desk.file(
        "range.toml",
        &fox.replace("ior = { value = 1.55", "ior = { value = 155"),
    );
    let bake = |name: &str| format!("bake {name} --photons 1e4 -o out.exr");
    desk.refuses(&bake("no-such.toml"), 1, &["no-such.toml"]);
    desk.refuses(&bake("red-fix"), 1, &["red-fix", "red-fox"]);
    desk.refuses(
        &bake("broken.toml"),
        1,
        &["broken.toml:2", "unclosed array"],
    );
    desk.refuses(
        &bake("key.toml"),
        1,
        &["key.toml", "riser_rougness", "riser_roughness"],
    );
    desk.refuses(&bake("range.toml"), 1, &["range.toml", "155", "ior"]);
    desk.refuses(
        &format!("{} --set guard.nose=1", bake("red-fox")),
        1,
        &["nose"],
    );
    desk.refuses(
        &format!("{} --set structure.ior=9", bake("red-fox")),
        1,
        &["ior", "9"],
    );
}

#[test]
fn numbers_out_of_range() {
    let desk = Desk::new();
    let render = "render glass-cylinder --skin ball --bake-photons 1e4 -o out.png";
    desk.refuses(&format!("{render} --res 0x0"), 1, &["0 x 0"]);
    desk.refuses(&format!("{render} --res wide"), 1, &["wide"]);
    desk.refuses(&format!("{render} --strands 0"), 1, &["strand"]);
    desk.refuses(&format!("{render} --crop 900,0,100,100"), 1, &["crop"]);
    desk.refuses("gallery --coats 0 -o out.png", 1, &["--coats", "1 to 9"]);
    desk.refuses("render red-fox -o out.jpg", 1, &["out.jpg", ".png"]);
    desk.refuses(
        "bake red-fox --face 63 -o out.exr",
        1,
        &["face", "63", "power of two"],
    );
    desk.refuses("bake red-fox --photons 3 -o out.exr", 1, &["photons"]);
    desk.refuses(
        "bake red-fox --class whisker -o out.exr",
        1,
        &["whisker", "guard, under"],
    );
    desk.refuses("bake red-fox --photons many -o out.exr", 1, &["many"]);
    desk.refuses("bake red-fox --station 2 -o out.exr", 1, &["--station"]);
}

#[test]
fn meshes() {
    let desk = Desk::new();
    desk.file("nan.obj", &format!("{TRIANGLE}v nan 0 0\nf 1 2 4\n"));
    desk.file("index.obj", &format!("{TRIANGLE}f 1 2 9\n"));
    desk.file("empty.obj", "# nothing\n");
    for (mesh, words) in [
        ("missing.obj", &["missing.obj"][..]),
        ("nan.obj", &["nan.obj"][..]),
        ("index.obj", &["index.obj"][..]),
        ("empty.obj", &["empty.obj"][..]),
    ] {
        let line = format!("render glass-cylinder --skin {mesh} --bake-photons 1e4 -o out.png");
        desk.refuses(&line, 1, words);
    }
}

#[test]
fn environments_and_tables() {
    let desk = Desk::new();
    desk.file("broken.exr", "not an EXR file");
    let render = "render glass-cylinder --skin ball --bake-photons 1e4 -o out.png";
    desk.refuses(&format!("{render} --env missing.hdr"), 1, &["missing.hdr"]);
    desk.refuses(&format!("{render} --env broken.exr"), 1, &["broken.exr"]);
    desk.refuses("table info broken.exr", 1, &["broken.exr"]);
    desk.refuses("table info missing.exr", 1, &["missing.exr"]);
}

#[test]
fn places_that_cannot_be_written() {
    let desk = Desk::new();
    std::fs::create_dir(desk.0.path().join("folder.exr")).unwrap();
    desk.refuses(
        "bake red-fox -o no/such/folder/out.exr",
        2,
        &["no/such/folder/out.exr"],
    );
    desk.refuses("bake red-fox -o folder.exr", 2, &["folder.exr", "folder"]);
    desk.refuses("render red-fox -o no/such/out.png", 2, &["no/such/out.png"]);
}

/// A limit on file size fails a write in its middle as a full disk does.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_old_file() {
    let desk = Desk::new();
    desk.file("table.exr", "old");
    let line = format!(
        "trap '' XFSZ; ulimit -f 40; exec {} --quiet bake glass-cylinder --photons 1e4 --no-cache -o table.exr",
        env!("CARGO_BIN_EXE_vair")
    );
    let output = Command::new("bash")
        .args(["-c", &line])
        .current_dir(desk.0.path())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("table.exr"), "{said}");
    assert_eq!(
        std::fs::read_to_string(desk.0.path().join("table.exr")).unwrap(),
        "old"
    );
    assert_eq!(outputs(desk.0.path()), Vec::<String>::new());
}

/// Ctrl-C in the middle of a bake: the passes so far are a valid table, and the exit code says so.
#[cfg(unix)]
#[test]
fn signals_keep_the_work() {
    let desk = Desk::new();
    let mut bake = desk
        .command()
        .args([
            "bake",
            "glass-cylinder",
            "--photons",
            "4e9",
            "-o",
            "out.exr",
            "--face",
            "8",
        ])
        .args(["--threads", "1", "--quiet"])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(600));
    let kill = Command::new("kill")
        .args(["-TERM", &bake.id().to_string()])
        .status()
        .unwrap();
    assert!(kill.success());
    let started = std::time::Instant::now();
    assert_eq!(bake.wait().unwrap().code(), Some(143));
    assert!(started.elapsed().as_secs() < 10);
    assert_eq!(outputs(desk.0.path()), ["out.exr"]);
    let table = TableFile::read(&desk.0.path().join("out.exr")).unwrap();
    assert!(table.provenance().program.starts_with("vair"));
}

#[test]
fn same_bytes_on_any_number_of_threads_and_in_a_crop() {
    let desk = Desk::new();
    let still = "render mink --skin ball --strands 2000 --res 64x48 --spp 4 --bake-photons 5e4";
    for threads in [1, 2, 7] {
        let line =
            format!("{still} --threads {threads} --no-cache -o {threads}.exr -o {threads}.png");
        let output = desk.run(&line);
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        let bake =
            format!("bake human --photons 1e5 --threads {threads} --no-cache -o t{threads}.exr");
        assert!(desk.run(&bake).status.success());
    }
    let bytes = |name: &str| std::fs::read(desk.0.path().join(name)).unwrap();
    for kind in [".exr", ".png"] {
        assert!(bytes(&format!("1{kind}")) == bytes(&format!("2{kind}")));
        assert!(bytes(&format!("1{kind}")) == bytes(&format!("7{kind}")));
    }
    assert!(bytes("t1.exr") == bytes("t2.exr") && bytes("t1.exr") == bytes("t7.exr"));
}

/// What was mended in a mesh is said when it is baked, not only when it is looked at.
#[test]
fn baking_a_mended_mesh_says_what_was_mended() {
    let mut prism = "o cuticle\n".to_owned();
    for z in [0, 100] {
        for (x, y) in [(40, 0), (0, 40), (-40, 0), (0, -40)] {
            prism += &format!("v {x} {y} {z}\n");
        }
    }
    // The first side is wound against the others.
    prism += "f 5 6 2 1\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    let desk = Desk::new();
    desk.file("prism.obj", &prism);
    let line = "bake glass-cylinder --set structure.mesh.file=prism.obj --photons 1e4 --face 8 \
                --bins 2 -o prism.exr";
    for _ in 0..2 {
        let output = desk.run(line);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{said}");
        assert!(said.contains("2 faces were wound against"), "{said}");
    }
}
