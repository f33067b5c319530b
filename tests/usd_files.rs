//! Writes assets of every kind with their numbers beside them, for `tests/clients/usd.sh` to have them
//! read by Pixar's library: target/tmp/usd/NAME.usda and .usdc and, as plain numbers, NAME.raw.
//! What .raw holds: `raw/arrays.rs`. Numbers of a coarser level are of a groom that was grown with fewer
//! strands, but for their widths, which are those of the full one times what the level says.

#![allow(clippy::unwrap_used)]

#[path = "raw/arrays.rs"]
mod arrays;

use arrays::Raw;
use std::fs;
use std::path::PathBuf;
use vair::assembly::looks;
use vair::bake::Settings;
use vair::export::asset::{
    AssetSettings, Curves, Frame, Level, Parts, Profile, Reader, Units, Up, Wear, levels, write,
};
use vair::groom::{Groom, GroomSettings, grow};
use vair::progress::{Cancel, Silent};
use vair::skin::{self, Skin};
use vair::species::{self, Species};

/// Strands of the full level.
const STRANDS: usize = 1600;

fn folder() -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("usd");
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn grown(skin: &Skin, species: &Species, strands: usize) -> Groom {
    let settings = GroomSettings {
        strands: Some(strands),
        seed: 5,
    };
    grow(skin, species, &settings, &Silent, &Cancel::default()).unwrap()
}

/// A groom of fewer strands with the widths of a level of the full one.
fn widened(mut groom: Groom, full: &Groom, level: &Level) -> Groom {
    for (class, part) in level.classes.iter().enumerate() {
        let own = (0..groom.strands()).filter(|&s| usize::from(groom.class[s]) == class);
        for (few, &many) in own.collect::<Vec<_>>().into_iter().zip(part.strands.iter()) {
            for (to, from) in groom.range(few).zip(full.range(many as usize)) {
                groom.widths[to] = full.widths[from] * part.widening;
            }
        }
    }
    groom
}

fn export(name: &str, species: &str, skin: &str, count: usize, settings: &AssetSettings) {
    let (species, skin) = (
        species::load(species, &[]).unwrap(),
        skin::load(skin).unwrap(),
    );
    let groom = grown(&skin, &species, STRANDS);
    let levels = levels(&groom, &skin, &species, count).unwrap();
    assert_eq!(levels.len(), count);
    let bake = Settings {
        photons: 20_000,
        face: 16,
        ..Settings::cone()
    };
    // Materials are the same whatever the strands: once is enough.
    let looks = match name {
        "fox" => looks(&species, None, &bake, None, &Silent, &Cancel::default()).unwrap(),
        _ => Vec::new(),
    };
    let parts = Parts {
        groom: &groom,
        skin: &skin,
        species: &species,
        levels: &levels,
        looks: &looks,
        coats: &[],
        seed: 5,
    };
    let folder = folder();
    let mut bytes = Vec::new();
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().unwrap();
        for suffix in ["usda", "usdc"] {
            let path = folder.join(name).with_extension(suffix);
            let job = || write(&path, &parts, settings, &Silent, &Cancel::default());
            pool.install(job).unwrap();
            bytes.push(fs::read(path).unwrap());
        }
    }
    assert!(bytes[0] == bytes[2] && bytes[1] == bytes[3], "{name}");
    if !matches!(settings.curves, Curves::Pinned | Curves::Linear) {
        return;
    }
    let in_meters = settings.frame.units == Units::Meters;
    let scale = if in_meters { 1.0 } else { 100.0 };
    let turn = |[x, y, z]: [f32; 3]| match in_meters {
        true => [x, y, z],
        false => [x * 100.0, -z * 100.0, y * 100.0],
    };
    let mut numbers = Raw::default();
    for (level, share) in levels.iter().zip([1, 4, 16]) {
        let groom = widened(grown(&skin, &species, STRANDS / share), &groom, level);
        for (class, class_name) in groom.classes.iter().enumerate() {
            let lod = match count {
                1 => String::new(),
                _ => format!("{}:", level.name),
            };
            let root = species.id.replace('-', "_");
            let prim = format!("{lod}/{root}/geo/render/{class_name}");
            numbers.class(&groom, class, &prim, turn, scale);
        }
    }
    fs::write(folder.join(name).with_extension("raw"), numbers.0).unwrap();
}

#[test]
fn meters_with_levels() {
    export("fox", "red-fox", "body", 3, &AssetSettings::default());
}

#[test]
fn centimeters_with_z_up() {
    let settings = AssetSettings {
        frame: Frame {
            units: Units::Centimeters,
            up: Up::Z,
        },
        ..AssetSettings::default()
    };
    export("mink", "mink", "ball", 1, &settings);
}

#[test]
fn all_kinds_of_curves() {
    for (name, curves) in [
        ("phantom", Curves::Phantom),
        ("bezier", Curves::Bezier),
        ("linear", Curves::Linear),
    ] {
        let settings = AssetSettings {
            curves,
            ..AssetSettings::default()
        };
        export(name, "human", "tress", 2, &settings);
    }
}

/// A choice of coats beside each coat by itself, which it must equal: two that are of one shape, and one
/// whose hair is longer.
#[test]
fn coats_to_choose_from() {
    let skin = skin::load("ball").unwrap();
    let bake = Settings {
        photons: 20_000,
        face: 16,
        ..Settings::cone()
    };
    let (progress, cancel) = (&Silent, &Cancel::default());
    let folder = folder();
    for (file, names) in [
        ("coats", &["tabby", "siamese", "none"][..]),
        ("shape", &["siamese", "tortoiseshell"]),
    ] {
        let dressed: Vec<_> = (names.iter())
            .map(|name| {
                let mut cat = species::load("cat", &[]).unwrap();
                cat.wear(name).unwrap();
                let groom = grown(&skin, &cat, STRANDS);
                let looks = looks(&cat, None, &bake, None, progress, cancel).unwrap();
                let levels = levels(&groom, &skin, &cat, 2).unwrap();
                (cat, groom, looks, levels)
            })
            .collect();
        let wears: Vec<Wear<'_>> = (names.iter().zip(&dressed))
            .map(|(name, (species, groom, looks, levels))| Wear {
                name,
                species,
                groom,
                levels,
                looks,
            })
            .collect();
        let parts = |i: usize, coats| Parts {
            groom: wears[i].groom,
            skin: &skin,
            species: wears[i].species,
            levels: wears[i].levels,
            looks: wears[i].looks,
            coats,
            seed: 5,
        };
        let write = |name: &str, parts: &Parts<'_>| {
            for suffix in ["usda", "usdc"] {
                let path = folder.join(format!("{name}.{suffix}"));
                write(&path, parts, &AssetSettings::default(), progress, cancel).unwrap();
            }
        };
        write(file, &parts(0, &wears));
        for (i, name) in names.iter().enumerate() {
            write(&format!("{file}-{name}"), &parts(i, &[]));
        }
    }
}

#[test]
fn a_profile_leaves_out_what_its_readers_do_not_read() {
    let all = AssetSettings::default();
    let few = AssetSettings {
        profile: Profile::of(&[Reader::Storm]),
        no_proxy: true,
        no_guides: true,
        ..AssetSettings::default()
    };
    export("all", "lynx", "swatch", 1, &all);
    export("few", "lynx", "swatch", 1, &few);
    // A file's own name stands in it, and this one has the sign that ends a path.
    export("few@2x", "lynx", "swatch", 1, &few);
    for name in ["few.raw", "few@2x.raw"] {
        fs::remove_file(folder().join(name)).unwrap();
    }
    let text = fs::read_to_string(folder().join("few.usda")).unwrap();
    for gone in [
        "primvars:groom_",
        "GroomAPI",
        "skinprim",
        "primvars:eumelanin",
        "Scope \"proxy\"",
        "Scope \"guide\"",
    ] {
        assert!(!text.contains(gone), "{gone}");
    }
    assert!(text.contains("displayColor"));
}
