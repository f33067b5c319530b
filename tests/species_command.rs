//! `vair species`: the library, one's own files, and what goes wrong with them.

#![allow(clippy::unwrap_used)] // all of it is test

use std::path::Path;
use std::process::Output;

struct Desk(tempfile::TempDir);

impl Desk {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn run(&self, arguments: &[&str]) -> Output {
        std::process::Command::new(env!("CARGO_BIN_EXE_vair"))
            .current_dir(self.path())
            .arg("species")
            .args(arguments)
            .output()
            .unwrap()
    }

    /// What a command that must succeed says on stdout.
    fn says(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{arguments:?}: {}",
            stderr(&output)
        );
        String::from_utf8(output.stdout).unwrap()
    }

    /// Stderr of a command that must be refused.
    fn refuses(&self, arguments: &[&str], code: i32) -> String {
        let output = self.run(arguments);
        assert_eq!(
            output.status.code(),
            Some(code),
            "{arguments:?}: {}",
            stderr(&output)
        );
        stderr(&output)
    }
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn the_list_goes_by_family() {
    let desk = Desk::new();
    let list = desk.says(&[]);
    assert_eq!(list, desk.says(&["list"]));
    let place = |text: &str| list.find(text).unwrap();
    assert!(place("DOGS AND FOXES  Canidae") < place("  red-fox "));
    assert!(place("  red-fox ") < place("BEARS  Ursidae"));
    let rows: serde_json::Value = serde_json::from_str(&desk.says(&["list", "--json"])).unwrap();
    let ids: Vec<&str> = vair::species::ids().collect();
    let listed: Vec<&str> = rows
        .as_array()
        .unwrap()
        .iter()
        .map(|r| r["id"].as_str().unwrap())
        .collect();
    assert_eq!(listed, ids);
    for row in rows.as_array().unwrap() {
        let counts = [&row["sourced"], &row["estimated"]].map(|n| n.as_u64().unwrap());
        assert!(counts.iter().sum::<u64>() > 20, "{row}");
        assert!(list.contains(&format!(
            "{} of {} numbers",
            counts[0],
            counts[0] + counts[1]
        )));
    }
}

#[test]
fn a_page_reads_from_root_to_tip_and_names_its_sources() {
    let desk = Desk::new();
    let page = desk.says(&["show", "Vulpes vulpes"]);
    assert_eq!(page, desk.says(&["show", "red-fox"]));
    for line in page.lines() {
        assert!(line.chars().count() <= 100, "{line}");
    }
    let order = [
        "RED FOX",
        "long pointed petals",
        "jittered polygonal tiles",
        "NUMBERS",
        "SOURCES",
        "Carrlee",
    ];
    let places: Vec<usize> = order.iter().map(|text| page.find(text).unwrap()).collect();
    assert!(places.is_sorted(), "{places:?}");
    assert!(page.contains("[AF]") && page.contains("estimate: "));
    let json = desk.says(&["show", "fox", "--json", "--set", "guard.groom.length_mm=44"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["species"]["id"], "red-fox");
    assert_eq!(json["species"]["classes"][0]["groom"]["length_mm"], 44.0);
    let bears = desk.refuses(&["show", "bear"], 1);
    assert!(bears.contains("brown-bear or polar-bear"), "{bears}");
}

/// The JSON of a coat says which place of the body a layer is near.
#[test]
fn landmarks_of_a_coat_are_named() {
    let desk = Desk::new();
    let json = desk.says(&["show", "cat", "--json", "--set", "coat=siamese"]);
    let value: serde_json::Value = serde_json::from_str(&json).unwrap();
    let limits = &value["species"]["coat"]["layers"][1]["limits"];
    assert_eq!(limits[0]["extent"]["near"]["landmark"], "paws", "{limits}");
}

#[test]
fn a_new_file_is_good_and_never_replaces_another() {
    let desk = Desk::new();
    for id in vair::species::ids() {
        let name = format!("my-{id}");
        desk.says(&["new", &name, "--from", id]);
        let text = std::fs::read_to_string(desk.path().join(format!("{name}.toml"))).unwrap();
        assert!(text.starts_with("#:schema species.schema.json\n"), "{text}");
        assert!(!text.contains("synonyms"), "the other animal's names");
        let (mine, origins) = vair::species::parse(&text, &name, "new", &[]).unwrap();
        let (base, base_origins) = vair::species::load_with_origins(id, &[]).unwrap();
        assert_eq!(
            format!("{:?}", mine.classes),
            format!("{:?}", base.classes),
            "{id}"
        );
        assert_eq!(origins, base_origins, "{id}");
        assert_eq!(mine.name, name.replace('-', " ").replacen('m', "M", 1));
    }
    let file = desk.path().join("my-cat.toml");
    std::fs::write(&file, "mine").unwrap();
    let report = desk.refuses(&["new", "my-cat", "--from", "cat"], 1);
    assert!(report.contains("my-cat.toml is there already"), "{report}");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "mine");
    desk.says(&["new", "my-cat", "--from", "cat", "--force"]);
    assert!(std::fs::read_to_string(&file).unwrap().len() > 1000);
    // From one's own file, into a folder.
    std::fs::create_dir(desk.path().join("animals")).unwrap();
    desk.says(&[
        "new",
        "tom",
        "--from",
        "my-cat.toml",
        "-o",
        "animals/tom.toml",
    ]);
    desk.says(&["check", "animals/tom.toml"]);
    for (arguments, expected) in [
        (
            &["new", "My Cat", "--from", "cat"][..],
            "no name of a species",
        ),
        (&["new", "../cat", "--from", "cat"], "no name of a species"),
        (&["new", "my--cat", "--from", "cat"], "no name of a species"),
        (&["new", "cat", "--from", "cat"], "choose a name of its own"),
        (&["new", "mine", "--from", "kat"], "did you mean cat?"),
        (&["new", "mine", "--from", "cat", "-o", "mine.txt"], ".toml"),
    ] {
        let report = desk.refuses(arguments, 1);
        assert!(report.contains(expected), "{arguments:?}: {report}");
    }
    desk.refuses(
        &[
            "new",
            "mine",
            "--from",
            "cat",
            "-o",
            "no/such/folder/mine.toml",
        ],
        2,
    );
}

#[test]
fn several_files_are_checked_in_one_go() {
    let desk = Desk::new();
    let fox = vair::species::load("red-fox", &[]).unwrap().text;
    let write = |name: &str, text: &str| std::fs::write(desk.path().join(name), text).unwrap();
    write("good.toml", &fox);
    write("one.toml", &fox.replace("jitter", "jiter"));
    write(
        "two.toml",
        &fox.replace("length_mm = { value = 50,", "length_mm = { value = 50000,"),
    );
    desk.says(&["check", "good.toml", "cat"]);
    let files = ["check", "one.toml", "good.toml", "two.toml"];
    let output = desk.run(&files);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stdout).starts_with("good.toml: good."));
    let report = stderr(&output);
    for expected in [
        "one.toml is refused: 1 problem",
        "did you mean `jitter`?",
        "two.toml is refused: 1 problem",
        "expected a number from 0.5 to 2000 mm",
        "2 of 3 files are refused",
    ] {
        assert!(report.contains(expected), "{expected}: {report}");
    }
    let output = desk.run(&[&files[..], &["--json"]].concat());
    assert_eq!(output.status.code(), Some(1));
    let rows: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let good: Vec<bool> = rows
        .as_array()
        .unwrap()
        .iter()
        .map(|r| r["good"].as_bool().unwrap())
        .collect();
    assert_eq!(good, [false, true, false]);
    let line = rows[0]["problems"][0]["line"].as_u64().unwrap() as usize;
    assert!(fox.lines().nth(line - 1).unwrap().starts_with("jitter"));
    desk.refuses(&["check", "one.toml", "missing.toml"], 1);
}
