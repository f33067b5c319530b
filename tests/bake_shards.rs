//! Shards of a bake put together are the bake, to the bit; anything else is refused by name.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use vair::bake::{Bake, Ended, Goal, Settings, Shard, Sums, absorption_levels};
use vair::progress::{Cancel, Silent};
use vair::species::{Boundary, Material, Materials, Structure};
use vair::table::Provenance;

fn settings() -> Settings {
    Settings {
        photons: 100_003,
        bins: 5,
        face: 8,
        levels: absorption_levels(4),
        ..Settings::cone()
    }
}

fn colored() -> Structure {
    let gold = Material {
        boundary: Boundary::Metal {
            index: [0.18, 0.42, 1.37],
            extinction: [3.42, 2.35, 1.77],
        },
        ..Material::default()
    };
    Structure {
        materials: Materials {
            cuticle: gold,
            ..Materials::default()
        },
        ..Structure::default()
    }
}

fn origin() -> Provenance {
    Provenance {
        species: "test".to_owned(),
        ..Provenance::default()
    }
}

fn bake(structure: &Structure, settings: &Settings) -> Bake<'static> {
    Bake::new(structure, settings)
        .unwrap()
        .with_origin(origin(), Some([0.1, 0.2, 0.3]))
}

fn fly(bake: &Bake<'_>) {
    let ended = bake.run(&Goal::default(), &Silent, &Cancel::default());
    assert_eq!(ended, Ended::Photons);
}

/// The files of all shards.
fn shards(structure: &Structure, settings: &Settings, of: u64, folder: &Path) -> Vec<PathBuf> {
    (1..=of)
        .map(|index| {
            let bake = bake(structure, settings).with_shard(Shard::new(index, of).unwrap());
            fly(&bake);
            let path = folder.join(format!("{index}of{of}.safetensors"));
            bake.save(&path).unwrap();
            path
        })
        .collect()
}

/// All orders of some paths (Heap 1963).
fn orders(mut paths: Vec<PathBuf>) -> impl Iterator<Item = Vec<PathBuf>> {
    let mut counts = vec![0; paths.len()];
    let mut at = 0;
    let first = paths.clone();
    let others = std::iter::from_fn(move || {
        while at < counts.len() && counts[at] >= at {
            counts[at] = 0;
            at += 1;
        }
        if at == counts.len() {
            return None;
        }
        let with = if at % 2 == 0 { 0 } else { counts[at] };
        paths.swap(with, at);
        counts[at] += 1;
        at = 0;
        Some(paths.clone())
    });
    std::iter::once(first).chain(others)
}

#[test]
fn any_split_in_any_order_is_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let flat = Structure {
        aspect: 3.0,
        ..Structure::default()
    };
    let sides = Settings {
        azimuths: 3,
        ..settings()
    };
    for (structure, settings) in [
        (Structure::default(), settings()),
        (colored(), settings()),
        (flat, sides),
    ] {
        let whole = bake(&structure, &settings);
        fly(&whole);
        let whole = whole.snapshot().unwrap();
        assert_eq!(
            whole.tables().len(),
            if structure.is_colored() { 3 } else { 1 }
        );
        for of in [2, 3, 7] {
            let mut paths = shards(&structure, &settings, of, folder.path());
            // Heap's algorithm passes through all orders, of which seven have 5040: some are enough.
            for (turn, order) in orders(paths.clone()).enumerate() {
                if turn > 6 && turn % 397 != 0 {
                    continue;
                }
                let merged = Sums::merge(&order).unwrap();
                assert!(merged.tables().unwrap() == whole, "{of} shards: {order:?}");
                assert_eq!(merged.dye(), Some([0.1, 0.2, 0.3]));
            }
            // A part of a part: the ends first, the middle later.
            let part = folder.path().join("part.safetensors");
            let middle = paths.remove(1);
            Sums::merge(&paths).unwrap().write(&part).unwrap();
            assert!(
                Sums::merge(std::slice::from_ref(&part))
                    .unwrap()
                    .tables()
                    .is_err()
            );
            let merged = Sums::merge(&[part, middle]).unwrap();
            assert!(merged.tables().unwrap() == whole, "{of} shards");
        }
    }
}

#[test]
fn what_does_not_belong_together_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let fly_shard = |settings: &Settings, species: &str, shard: &str, name: &str| {
        let shard: Shard = shard.parse().unwrap();
        let bake = Bake::new(&Structure::default(), settings)
            .unwrap()
            .with_origin(
                Provenance {
                    species: species.to_owned(),
                    ..Provenance::default()
                },
                None,
            )
            .with_shard(shard);
        fly(&bake);
        // A table of its photons would have the name of a bake of other ones.
        let first = shard.span(settings.photons).start == 0;
        assert_eq!(bake.snapshot().is_ok(), first, "{shard}");
        bake.save(&at(name)).unwrap();
    };
    let base = settings();
    let seed = Settings {
        seed: 1,
        ..base.clone()
    };
    let more = Settings {
        photons: 200_000,
        ..base.clone()
    };
    fly_shard(&base, "a", "1/3", "a1");
    fly_shard(&base, "a", "2/3", "a2");
    fly_shard(&base, "a", "3/3", "a3");
    fly_shard(&base, "a", "1/2", "half");
    fly_shard(&seed, "a", "2/3", "seed");
    fly_shard(&more, "a", "2/3", "more");
    fly_shard(&base, "b", "2/3", "other");
    std::fs::write(at("no-sums"), "hello").unwrap();
    let refusal = |names: &[&str]| {
        let paths: Vec<PathBuf> = names.iter().map(|name| at(name)).collect();
        let tables = Sums::merge(&paths).and_then(|sums| sums.tables());
        tables.unwrap_err().to_string()
    };
    for (names, words) in [
        (&["a1", "a3"][..], &["shard 2/3", "100003"][..]),
        (&["a2"], &["shard 1/3, 3/3"]),
        (&["a3", "half"], &["photons 50001 to 66667"]),
        (&["a1", "a2", "a1"], &["a1", "both hold photons 0 to 33333"]),
        (
            &["a2", "half"],
            &["half", "a2", "both hold photons 33334 to 50000"],
        ),
        (
            &["a1", "seed", "a3"],
            &[
                "seed is of another",
                "a1",
                "recipe.settings.seed is 1, not 0",
            ],
        ),
        (
            &["a1", "more", "a3"],
            &["more is of another", "photons is 200000, not 100003"],
        ),
        (
            &["a1", "other", "a3"],
            &["other is of another", "origin.species is \"b\", not \"a\""],
        ),
        (&["a1", "missing"], &["missing", "No such file"]),
        (&["a1", "no-sums"], &["no-sums", "does not hold the sums"]),
    ] {
        let refusal = refusal(names);
        for word in words {
            assert!(refusal.contains(word), "{names:?}: {refusal}");
        }
    }
}

/// Every cut and every changed byte is noticed.
#[test]
fn damaged_sums_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sums");
    let settings = Settings {
        photons: 1000,
        bins: 2,
        face: 4,
        levels: absorption_levels(1),
        ..Settings::cone()
    };
    let whole = bake(&Structure::default(), &settings);
    fly(&whole);
    whole.save(&path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let fresh = bake(&Structure::default(), &settings);
    fresh.resume(&path).unwrap();
    assert!(fresh.snapshot().unwrap() == whole.snapshot().unwrap());
    let fresh = bake(&Structure::default(), &settings);
    let broken = folder.path().join("broken");
    for cut in (0..bytes.len()).step_by(13).chain([bytes.len() - 1]) {
        std::fs::write(&broken, &bytes[..cut]).unwrap();
        assert!(fresh.resume(&broken).is_err(), "cut at {cut}");
    }
    for at in (0..bytes.len()).step_by(3) {
        let mut bytes = bytes.clone();
        bytes[at] ^= 1 << (at % 8);
        std::fs::write(&broken, &bytes).unwrap();
        assert!(fresh.resume(&broken).is_err(), "changed at {at}");
    }
    std::fs::write(&broken, [&bytes[..], &[0]].concat()).unwrap();
    assert!(fresh.resume(&broken).is_err(), "longer");
    // A header that claims more than there is sets no memory aside.
    let lie = String::from_utf8_lossy(&bytes).replace("\\\"face\\\":4", "\\\"face\\\":512");
    std::fs::write(&broken, lie.as_bytes()).unwrap();
    assert!(fresh.resume(&broken).is_err(), "liar");
    assert_eq!(fresh.photons(), 0);
}

fn vair(folder: &Path, line: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_vair"))
        .current_dir(folder)
        .env("VAIR_CACHE", folder.join("cache"))
        .env("NO_COLOR", "1")
        .args(line.split_whitespace())
        .output()
        .unwrap()
}

fn said(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr);
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn the_commands_agree_to_the_byte() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let bake = "bake glass-cylinder --photons 30001 --face 16 --bins 4 --no-cache";
    assert!(
        vair(folder, &format!("{bake} -o whole.exr"))
            .status
            .success()
    );
    for shard in [3, 1, 2] {
        let line = format!("{bake} --shard {shard}/3 -o {shard}.safetensors");
        assert!(vair(folder, &line).status.success());
        // Asked again it is there.
        let again = vair(folder, &line);
        assert!(
            said(&again).contains("holds this shard"),
            "{}",
            said(&again)
        );
    }
    let part = "merge 3.safetensors 1.safetensors -o part.safetensors";
    assert!(vair(folder, part).status.success());
    let gap = vair(folder, "merge part.safetensors -o out.exr");
    assert_eq!(gap.status.code(), Some(1));
    assert!(said(&gap).contains("shard 2/3"), "{}", said(&gap));
    let merge = "merge 2.safetensors part.safetensors -o out.exr";
    assert!(vair(folder, merge).status.success());
    let read = |name: &str| std::fs::read(folder.join(name)).unwrap();
    assert!(read("whole.exr") == read("out.exr"));
    for (line, word) in [
        (format!("{bake} --shard 4/3 -o x.safetensors"), "4/3"),
        (format!("{bake} --shard 1/3 -o x.exr"), ".safetensors"),
        (format!("{bake} -o x.safetensors"), ".exr"),
        (
            format!("{bake} --shard 1/3 --time 3s -o x.safetensors"),
            "--time",
        ),
        (
            "merge whole.exr -o x.exr".to_owned(),
            "does not hold the sums",
        ),
        ("merge 1.safetensors -o x.png".to_owned(), ".safetensors"),
    ] {
        let refused = vair(folder, &line);
        assert_eq!(refused.status.code(), Some(1), "{line}: {}", said(&refused));
        assert!(said(&refused).contains(word), "{line}: {}", said(&refused));
    }
    let names = std::fs::read_dir(folder).unwrap();
    let litter: Vec<_> = names
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .filter(|name| {
            name.contains("checkpoint") || name.contains("part") && name != "part.safetensors"
        })
        .collect();
    assert!(litter.is_empty(), "{litter:?}");
}
