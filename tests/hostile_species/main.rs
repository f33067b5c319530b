//! Twenty thousand damaged species files: no panic, and a report where the damage is.
//!
//! Every case is a built-in species with one fault, a function of its number alone. Where the fault
//! is certain to be one and its line is known, a report has to stand in that line.

#![allow(clippy::unwrap_used, clippy::panic)] // all of it is test

mod damage;

use damage::{Dice, KINDS, Source, Verdict};
use rayon::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use vair::species::{LIBRARY, Place, SpeciesError, SpeciesErrors, load, parse};

const CASES: u64 = 20_000;

/// Damages a species and reads it; says what is wrong with the answer.
fn case(index: u64) -> Result<bool, String> {
    let kind = (index % KINDS.len() as u64) as usize;
    let (id, text) = LIBRARY[(index / KINDS.len() as u64) as usize % LIBRARY.len()];
    let damaged = KINDS[kind](&Source::new(text), &mut Dice(index));
    let complain = |what: &str| format!("case {index}, kind {kind}, {id}: {what}");
    let answer = catch_unwind(AssertUnwindSafe(|| parse(&damaged.text, id, "file", &[])));
    let Ok(answer) = answer else {
        return Err(complain("panic"));
    };
    match (answer, damaged.verdict) {
        (Ok(_), Verdict::Any) => Ok(false),
        (Ok(_), _) => Err(complain("accepted")),
        (Err(errors), verdict) => {
            order(&errors, &damaged.text)
                .and_then(|()| place(&errors, &verdict))
                .map_err(|what| complain(&format!("{what}:\n{errors}")))?;
            Ok(true)
        }
    }
}

/// What holds for every report.
fn order(errors: &SpeciesErrors, text: &str) -> Result<(), String> {
    if errors.problems.is_empty() || errors.problems.len() > errors.count {
        return Err("no report".to_owned());
    }
    for problem in &errors.problems {
        let Place::File(span) = &problem.place else {
            return Err("a report on an override".to_owned());
        };
        if span.start > span.end || span.end > text.len() {
            return Err(format!("span {span:?} of {} bytes", text.len()));
        }
    }
    let shown = errors.to_string();
    match shown.chars().find(|c| c.is_control() && *c != '\n') {
        Some(control) => Err(format!("{control:?} goes to the terminal")),
        None if shown.contains("defect") => Err("unexplained".to_owned()),
        None => Ok(()),
    }
}

fn place(errors: &SpeciesErrors, verdict: &Verdict) -> Result<(), String> {
    let line = |place: &Place| match place {
        Place::File(span) => errors.line_column(span.start).0 - 1,
        Place::Set(_) => usize::MAX,
    };
    let mut lines = errors.problems.iter().map(|p| line(&p.place));
    match verdict {
        Verdict::Any => Ok(()),
        Verdict::Line(range) if lines.any(|l| range.contains(&l)) => Ok(()),
        Verdict::Only(wanted) if errors.count == 1 && lines.all(|l| l == *wanted) => Ok(()),
        Verdict::Line(range) => Err(format!(
            "no report in lines {}..={}",
            range.start() + 1,
            range.end() + 1
        )),
        Verdict::Only(wanted) => Err(format!("not one report, in line {}", wanted + 1)),
    }
}

#[test]
fn damaged_files_are_refused_at_the_damage() {
    let results: Vec<Result<bool, String>> = (0..CASES).into_par_iter().map(case).collect();
    let wrong: Vec<&String> = results.iter().filter_map(|r| r.as_ref().err()).collect();
    let shown: Vec<&&String> = wrong.iter().take(10).collect();
    assert!(wrong.is_empty(), "{} cases: {shown:#?}", wrong.len());
    let refused = results.iter().filter(|r| matches!(r, Ok(true))).count();
    assert!(refused as u64 > CASES * 9 / 10, "{refused} refused");
}

#[test]
fn sources_that_are_taken_away_are_missed() {
    let cases: Vec<(&str, &str)> = LIBRARY.to_vec();
    let wrong: Vec<String> = cases
        .par_iter()
        .flat_map_iter(|(id, text)| bare_numbers(id, text))
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Takes the origin of each number of a species away, one at a time.
fn bare_numbers(id: &str, text: &str) -> Vec<String> {
    let source = Source::new(text);
    let mut wrong = Vec::new();
    for line in source.entries(|_, value| value.starts_with("{ value = ")) {
        let entry = &source.lines[line];
        let key = entry.split_once(" = ").unwrap().0;
        let value = entry.split_once("value = ").unwrap().1;
        let end = if value.starts_with('[') {
            value.find(']').unwrap() + 1
        } else {
            value.find(',').unwrap()
        };
        let header = source.header_above(line);
        // A table's own estimate would take over.
        let next = (line..source.lines.len()).find(|l| source.lines[*l].starts_with('['));
        let table = &source.lines[header..next.unwrap_or(source.lines.len())];
        if table
            .iter()
            .any(|l| l.starts_with("estimate = ") || l.starts_with("source = "))
        {
            continue;
        }
        let bare = source.with(line, &format!("{key} = {}", &value[..end]));
        match parse(&bare, id, "file", &[]) {
            Err(e)
                if e.count == 1
                    && e.problems[0]
                        .message
                        .contains("does not say where it comes from") =>
            {
                if e.line_column(match &e.problems[0].place {
                    Place::File(s) => s.start,
                    Place::Set(_) => 0,
                })
                .0 != line + 1
                {
                    wrong.push(format!("{id}:{}: {e}", line + 1));
                }
            }
            Err(e) => wrong.push(format!("{id}:{}: {e}", line + 1)),
            Ok(_) => wrong.push(format!("{id}:{}: accepted", line + 1)),
        }
    }
    // And that of each table.
    let covers: Vec<usize> = (0..source.lines.len())
        .filter(|l| {
            source.lines[*l].starts_with("estimate = ") || source.lines[*l].starts_with("source = ")
        })
        .collect();
    for line in covers {
        if parse(&source.with(line, "# gone"), id, "file", &[]).is_ok() {
            wrong.push(format!("{id}:{}: accepted without", line + 1));
        }
    }
    wrong
}

#[test]
fn bytes_that_are_no_text_are_named() {
    let folder = tempfile::tempdir().unwrap();
    for index in 0..300_u64 {
        let dice = &mut Dice(index);
        let (id, text) = LIBRARY[dice.roll(LIBRARY.len())];
        let mut bytes = text.as_bytes().to_vec();
        let mut place = dice.roll(bytes.len());
        while !text.is_char_boundary(place) {
            place -= 1;
        }
        let put: &[u8] = dice.pick(&[
            &[0xff_u8][..],
            &[0xc3, 0x28],
            &[0xed, 0xa0, 0x80],
            &[0xf8, 0x88],
            &[0x80],
        ]);
        bytes.splice(place..place, put.iter().copied());
        let path = folder.path().join(format!("{id}-{index}.toml"));
        std::fs::write(&path, bytes).unwrap();
        let error = load(path.to_str().unwrap(), &[]).unwrap_err();
        assert!(matches!(error, SpeciesError::File(_)), "{index}: {error}");
        let said = error.to_string();
        assert!(
            said.contains(&format!("not UTF-8 text: byte {place} ")),
            "{index}: {said}"
        );
    }
}

#[test]
fn huge_files_are_read_in_bounded_time_and_reports() {
    let fox = LIBRARY.iter().find(|(id, _)| *id == "red-fox").unwrap().1;
    let tables = |n: usize| "[[guard.stations]]\nat = 0.5\n".repeat(n);
    let texts = [
        format!("{fox}\n#{}", "x".repeat(3 << 20)),
        format!(
            "{fox}\n{}",
            (0..100_000)
                .map(|i| format!("k{i} = 1\n"))
                .collect::<String>()
        ),
        format!(
            "{fox}\n{}",
            (0..50_000).map(|i| format!("[t{i}]\n")).collect::<String>()
        ),
        format!("{fox}\n{}", tables(50_000)),
        format!("x = \"{}\"\n{fox}", "y".repeat(3 << 20)),
        format!("x = [{}]\n{fox}", "1,".repeat(500_000)),
        fox.replace(
            "summary = \"",
            &format!("summary = \"{}", "z ".repeat(500_000)),
        ),
        fox.replace(
            "classes = [",
            &format!("classes = [{}", "\"g\", ".repeat(200_000)),
        ),
    ];
    let begin = std::time::Instant::now();
    for (index, text) in texts.iter().enumerate() {
        match parse(text, "huge", "file", &[]) {
            Ok(_) => assert_eq!(index, 0, "a long comment is no fault"),
            Err(errors) => {
                assert!(errors.problems.len() <= 200, "{index}");
                assert!(errors.to_string().len() < 1 << 20, "{index}");
            }
        }
    }
    // Ten times what it takes on a slow machine: quadratic reading would take minutes.
    assert!(begin.elapsed().as_secs() < 60, "{:?}", begin.elapsed());
}

#[test]
fn hostile_reports_can_be_shown() {
    for index in 0..640 {
        let kind = (index % KINDS.len() as u64) as usize;
        let (id, text) = LIBRARY[index as usize % LIBRARY.len()];
        let damaged = KINDS[kind](&Source::new(text), &mut Dice(index ^ 0xbeef));
        if let Err(errors) = parse(&damaged.text, id, "file\u{1b}[31m", &[]) {
            let failure = vair::cli::Failure::from(SpeciesError::from(errors));
            let shown = format!("{:?}", failure.report);
            assert!(!shown.contains("file\u{1b}[31m"), "case {index}");
        }
    }
}
