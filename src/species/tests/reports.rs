//! One fault, one report, the right hint; no text crashes the reader.

use super::super::*;
use super::{read, refusals, text_of};
use crate::blame::Blame;

/// Independent faults, each one line of the red fox.
const FAULTS: [(&str, &str); 12] = [
    ("latin = \"Vulpes vulpes\"", "latn = \"Vulpes vulpes\""),
    ("summary = \"Rufous", "sumary = \"Rufous"),
    ("color = [0.10, 0.05, 0.028]", "color = [0.10, 0.05]"),
    (
        "ior = { value = 1.55, source = \"ML\" }",
        "ior = { value = 1.55, source = \"MLL\" }",
    ),
    (
        "jitter = { value = 1, estimate",
        "jitter = { valu = 1, estimate",
    ),
    ("height_um = 0.5\naround = 4", "hieght_um = 0.5\naround = 4"),
    ("pattern = \"mosaic\"", "pattern = \"mosiac\""),
    ("around = 7\nestimate =", "around = 7\nestimte ="),
    ("ratio = { value = 0.70,", "ratio = { value = 7.0,"),
    ("to_mm = 16\n", ""),
    ("clump = 0.3\n", "clump = true\n"),
    ("stray_deg = 6\n", ""),
];

#[test]
fn as_many_reports_as_faults() {
    let text = text_of("fox");
    // All subsets of three neighbors and all prefixes: faults meet in every combination that could
    // hide one another.
    let all: Vec<usize> = (0..FAULTS.len()).collect();
    let prefixes = (0..=all.len()).map(|k| all[..k].to_vec());
    let triples = all
        .windows(3)
        .flat_map(|w| [vec![w[0]], vec![w[0], w[2]], w.to_vec()]);
    for chosen in prefixes.chain(triples) {
        let mut faulty = text.to_owned();
        for index in &chosen {
            let (find, put) = FAULTS[*index];
            assert!(faulty.contains(find), "{find}");
            faulty = faulty.replacen(find, put, 1);
        }
        let lines = refusals(read(&faulty));
        assert_eq!(
            lines.len(),
            chosen.len(),
            "{chosen:?}:\n{}",
            lines.join("\n")
        );
    }
}

#[test]
fn a_misspelt_key_suggests_the_right_one() {
    for id in ["every-key", "fox"] {
        let text = text_of(id);
        let mut start = 0;
        for line in text.lines() {
            let begin = start;
            start += line.len() + 1;
            let Some((key, _)) = line.split_once(" = ") else {
                continue;
            };
            let header = text[..begin].lines().rev().find(|l| l.starts_with('['));
            // Short keys keep too few letters; free keys of [sources] mean themselves.
            if header == Some("[sources]") || key.len() < 4 || key.starts_with('#') {
                continue;
            }
            for cut in [1, key.len() / 2, key.len() - 1] {
                let wrong = format!("{}{}", &key[..cut], &key[cut + 1..]);
                let faulty = format!("{}{wrong}{}", &text[..begin], &text[begin + key.len()..]);
                let lines = refusals(read(&faulty));
                assert_eq!(lines.len(), 1, "{id} {wrong}: {lines:?}");
                let hint = format!("did you mean `{key}`?");
                assert!(lines[0].contains(&hint), "{id} {wrong}: {lines:?}");
            }
        }
    }
}

#[test]
fn hostile_texts_are_refused_without_a_crash() {
    let deep = |open: &str, n: usize| format!("a = {}", open.repeat(n));
    let texts = [
        String::new(),
        "\0".to_owned(),
        "\u{feff}name = 1".to_owned(),
        "é = \"ü".to_owned(),
        deep("[", 100_000),
        deep("{a=", 100_000),
        format!("{} = 1", vec!["a"; 100_000].join(".")),
        format!("[{}]", vec!["a"; 100_000].join(".")),
        (0..20_000).map(|i| format!("k{i} = 1\n")).collect(),
        format!("classes = [{}]", "\"x\",".repeat(10_000)),
        "classes = [\"skin\", \"Guard\", \"\", 3]".to_owned(),
        "classes = []\r\nname = 1\r\n".to_owned(),
    ];
    for text in texts {
        let errors = read(&text).unwrap_err();
        assert!(!errors.problems.is_empty() && errors.problems.len() <= 200);
        assert!(errors.count >= errors.problems.len());
        let shown = errors.to_string();
        assert!(
            !shown.contains('\0') && !shown.contains("defect"),
            "{shown}"
        );
    }
    for cut in (0..text_of("fox").len()).step_by(97) {
        assert!(read(&text_of("fox")[..cut]).is_err());
    }
}

#[test]
fn columns_count_characters_and_lines_any_ending() {
    let errors = read("# é\r\nname = \"\u{e9}\" # x\r\n\"\u{e9}\u{e9}\" = 1").unwrap_err();
    let lines: Vec<String> = errors.problems.iter().map(|p| errors.line(p)).collect();
    assert!(
        lines
            .iter()
            .any(|l| l.starts_with("test.toml:3:1: unknown key `éé`")),
        "{lines:?}"
    );
    let errors = read("a = { é = 1, b = ] }").unwrap_err();
    assert_eq!(errors.problems.len(), 1);
    assert_eq!(errors.line_column(0), (1, 1));
    assert_eq!(errors.line_column("a = { é".len()), (1, 8));
}

#[test]
fn unknown_names_suggest_and_blame_the_input() {
    for (name, hint) in [
        ("red-fix", "did you mean red-fox?"),
        ("zebra", "built in are cat"),
    ] {
        match load(name, &[]) {
            Err(SpeciesError::UnknownName { hint: said, .. }) => assert!(said.contains(hint)),
            other => panic!("{other:?}"),
        }
    }
    let missing = load("no/such/file.toml", &[]).unwrap_err();
    assert!(matches!(missing, SpeciesError::File(_)));
    assert_eq!(missing.blame(), Blame::Input);
}

#[test]
fn files_are_bounded_and_text() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let good = write("my-fox.toml", text_of("fox").as_bytes());
    assert_eq!(load(&good, &[]).unwrap().id, "my-fox");
    let latin = write("latin.toml", b"name = \"\xe9\"");
    assert!(
        load(&latin, &[])
            .unwrap_err()
            .to_string()
            .contains("not UTF-8 text: byte 8")
    );
    let long = write("long.toml", &vec![b'#'; (FILE_LIMIT + 1) as usize]);
    assert!(
        load(&long, &[])
            .unwrap_err()
            .to_string()
            .contains("longer than the limit")
    );
}
