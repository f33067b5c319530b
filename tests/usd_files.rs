//! Writes assets of every kind with their numbers beside them, for `tests/clients/usd.sh` to have them
//! read by Pixar's library: target/tmp/usd/NAME.usda and .usdc and, as plain numbers, NAME.raw.
//!
//! A .raw file is a sequence of arrays: path of the attribute (length as u32, bytes), `f` or `i`, the
//! number of numbers (u32), the numbers (4 bytes each). They are taken from grooms here, not from what
//! the writer was given: those of a coarser level are of a groom that was grown with fewer strands.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::PathBuf;
use vair::assembly::looks;
use vair::bake::Settings;
use vair::export::asset::{
    AssetSettings, Curves, Frame, Parts, Profile, Reader, Units, Up, levels, write,
};
use vair::groom::{Groom, GroomSettings, grow};
use vair::progress::{Cancel, Silent};
use vair::skin::{self, Skin};
use vair::species::{self, Species};

/// Strands of the full level.
const STRANDS: usize = 1600;

#[derive(Default)]
struct Raw(Vec<u8>);

impl Raw {
    fn head(&mut self, path: &str, kind: u8, count: usize) {
        self.0.extend((path.len() as u32).to_le_bytes());
        self.0.extend(path.as_bytes());
        self.0.push(kind);
        self.0.extend((count as u32).to_le_bytes());
    }

    fn floats(&mut self, path: &str, values: &[f32]) {
        self.head(path, b'f', values.len());
        self.0.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    }

    fn ints(&mut self, path: &str, values: &[i32]) {
        self.head(path, b'i', values.len());
        self.0.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    }
}

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

/// The numbers of one class of a groom, with `turn` from its frame to that of the file.
fn raw(
    raw: &mut Raw,
    groom: &Groom,
    class: usize,
    prim: &str,
    turn: impl Fn([f32; 3]) -> [f32; 3],
    scale: f32,
) {
    let (mut points, mut widths, mut counts) = (Vec::new(), Vec::new(), Vec::new());
    let (mut ids, mut uvs, mut triangles, mut places) = (vec![], vec![], vec![], vec![]);
    for strand in (0..groom.strands()).filter(|&i| usize::from(groom.class[i]) == class) {
        for i in groom.offsets[strand] as usize..groom.offsets[strand + 1] as usize {
            points.extend(turn(groom.points[i].to_array()));
            widths.push(groom.widths[i] * scale);
        }
        counts.push((groom.offsets[strand + 1] - groom.offsets[strand]) as i32);
        ids.push(groom.id[strand] as i32);
        uvs.extend(groom.root_uv[strand].to_array());
        triangles.push(groom.root_triangle[strand] as i32);
        let [u, v] = groom.root_barycentric[strand].to_array();
        places.extend([u, v, 0.0]);
    }
    raw.floats(&format!("{prim}.points"), &points);
    raw.floats(&format!("{prim}.widths"), &widths);
    raw.ints(&format!("{prim}.curveVertexCounts"), &counts);
    for name in ["curve_id", "groom_id"] {
        raw.ints(&format!("{prim}.primvars:{name}"), &ids);
    }
    for name in ["st", "groom_root_uv", "surface_uv_coordinate"] {
        raw.floats(&format!("{prim}.primvars:{name}"), &uvs);
    }
    raw.ints(&format!("{prim}.primvars:skinprim"), &triangles);
    raw.floats(&format!("{prim}.primvars:skinprimuv"), &places);
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
        "fox" => looks(&species, &bake, None, &Silent, &Cancel::default()).unwrap(),
        _ => Vec::new(),
    };
    let parts = Parts {
        groom: &groom,
        skin: &skin,
        species: &species,
        levels: &levels,
        looks: &looks,
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
        let groom = grown(&skin, &species, STRANDS / share);
        for (class, class_name) in groom.classes.iter().enumerate() {
            let lod = match count {
                1 => String::new(),
                _ => format!("{}:", level.name),
            };
            let root = species.id.replace('-', "_");
            let prim = format!("{lod}/{root}/geo/render/{class_name}");
            raw(&mut numbers, &groom, class, &prim, turn, scale);
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
