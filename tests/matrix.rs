//! Eight animals on three skins, for `tests/clients/matrix.sh` to have them read by other software: in
//! target/tmp/matrix NAME.usda and .usdc with NAME.raw (`raw/arrays.rs`), NAME-grids.vdb with .raw
//! (`raw/grids.rs`), and in `list.txt` for each NAME the arguments of `vair render`, run there, for the same fur.

#![allow(clippy::unwrap_used)]

#[path = "raw/arrays.rs"]
mod arrays;
#[path = "raw/grids.rs"]
mod grids;
#[path = "matrix/skins.rs"]
mod skins;

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use vair::assembly::looks;
use vair::bake::Settings;
use vair::export::asset::{self, AssetSettings, ClassLook, Frame, Parts, Units, Up};
use vair::export::volume::{self, CoatGrid, Curves, Field, Mesh, VolumeSettings};
use vair::groom::{Groom, GroomSettings, grow};
use vair::progress::{Cancel, Silent};
use vair::skin::{self, Placing, Skin};
use vair::species::{self, Species};

/// Animals, each with its own kind of coat, and the pattern that it wears.
const ANIMALS: [(&str, &str); 8] = [
    ("red-fox", ""),
    ("mink", ""),
    ("cat", "leopard"),
    ("polar-bear", ""),
    ("chinchilla", ""),
    ("harbor-seal", ""),
    ("sheep", ""),
    ("cow", "cow"),
];
const STRANDS: usize = 2000;

/// A skin, the frame of the files with fur on it, and the arguments of `vair render` for it.
struct Ground {
    name: &'static str,
    skin: Skin,
    frame: Frame,
    arguments: &'static str,
}

fn grounds(folder: &Path) -> Vec<Ground> {
    let placed = |path: &Path, placing| skin::load_placed(path.to_str().unwrap(), placing).unwrap();
    let (ring, limb) = (skins::torus(folder), skins::limb(folder));
    let centimeters = Placing {
        unit_m: 0.01,
        up: skin::Up::Z,
    };
    vec![
        Ground {
            name: "body",
            skin: skin::load("body").unwrap(),
            frame: Frame::default(),
            arguments: "--skin body",
        },
        Ground {
            name: "ring",
            skin: placed(&ring, centimeters),
            // That of the skin's own file.
            frame: Frame {
                units: Units::Centimeters,
                up: Up::Z,
            },
            arguments: "--skin ring.obj --skin-units cm --skin-up z",
        },
        Ground {
            name: "limb",
            skin: placed(&limb, Placing::default()),
            frame: Frame::default(),
            arguments: "--skin limb.gltf",
        },
    ]
}

fn asset(path: &Path, groom: &Groom, species: &Species, ground: &Ground, looks: &[ClassLook]) {
    let levels = asset::levels(groom, &ground.skin, species, 1).unwrap();
    let parts = Parts {
        groom,
        skin: &ground.skin,
        species,
        levels: &levels,
        looks,
        coats: &[],
        seed: 0,
    };
    let settings = AssetSettings {
        frame: ground.frame,
        ..AssetSettings::default()
    };
    for suffix in ["usda", "usdc"] {
        let path = path.with_extension(suffix);
        asset::write(&path, &parts, &settings, &Silent, &Cancel::default()).unwrap();
    }
    let in_meters = ground.frame == Frame::default();
    let turn = |[x, y, z]: [f32; 3]| match in_meters {
        true => [x, y, z],
        false => [x * 100.0, -z * 100.0, y * 100.0],
    };
    let scale = if in_meters { 1.0 } else { 100.0 };
    let mut raw = arrays::Raw::default();
    for (class, name) in groom.classes.iter().enumerate() {
        if groom.class.iter().any(|&c| usize::from(c) == class) {
            let root = species.id.replace('-', "_");
            let prim = format!("/{root}/geo/render/{name}");
            raw.class(groom, class, &prim, turn, scale);
        }
    }
    fs::write(path.with_extension("raw"), raw.0).unwrap();
}

fn volumes(path: &Path, groom: &Groom, species: &Species, skin: &Skin) {
    let colors = asset::colors(groom, species);
    let curves = Curves {
        points: &groom.points,
        widths: &groom.widths,
        offsets: &groom.offsets,
        colors: &colors,
    };
    let (positions, _) = volume::weld(&skin.positions);
    let mesh = Mesh {
        name: &skin.name,
        positions: &positions,
        triangles: &skin.triangles,
    };
    let size = |axis: usize| {
        let all = || skin.positions.iter().map(|p| p[axis]);
        all().fold(f32::MIN, f32::max) - all().fold(f32::MAX, f32::min)
    };
    let settings = VolumeSettings {
        fields: Field::ALL.to_vec(),
        // Some forty voxels across.
        voxel: Some(f64::from(size(0).max(size(1)).max(size(2))) / 40.0),
        ..VolumeSettings::default()
    };
    let (progress, cancel) = (&Silent, &Cancel::default());
    let plan = volume::plan(&curves, &settings, progress, cancel).unwrap();
    let out = BufWriter::new(File::create(path.with_extension("vdb")).unwrap());
    volume::write(out, &curves, &mesh, &plan, &settings, progress, cancel).unwrap();
    let mut raw = grids::Raw::default();
    let put = &mut |_, grid: CoatGrid| {
        match grid {
            CoatGrid::Scalar(grid) => raw.grid(&grid),
            CoatGrid::Vector(grid) => raw.grid(&grid),
        }
        Ok(())
    };
    volume::fill(&curves, &mesh, &plan, &settings, progress, cancel, put).unwrap();
    fs::write(path.with_extension("raw"), raw.0).unwrap();
}

#[test]
fn eight_animals_on_three_skins() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("matrix");
    fs::create_dir_all(&folder).unwrap();
    let grounds = grounds(&folder);
    let mut list = String::new();
    for (animal, coat) in ANIMALS {
        let mut species = species::load(animal, &[]).unwrap();
        let mut wears = String::new();
        if !coat.is_empty() {
            species.wear(coat).unwrap();
            wears = format!("--coat {coat}");
        }
        // One fit for all skins. Its error is of no interest here.
        let bake = Settings {
            photons: 20_000,
            face: 16,
            ..Settings::cone()
        };
        let looks = looks(&species, None, &bake, None, &Silent, &Cancel::default()).unwrap();
        for ground in &grounds {
            let settings = GroomSettings {
                strands: Some(STRANDS),
                seed: 0,
            };
            let cancel = Cancel::default();
            let groom = grow(&ground.skin, &species, &settings, &Silent, &cancel).unwrap();
            let name = format!("{animal}-{}", ground.name);
            asset(&folder.join(&name), &groom, &species, ground, &looks);
            let path = folder.join(format!("{name}-grids"));
            volumes(&path, &groom, &species, &ground.skin);
            let arguments = ground.arguments;
            list += &format!("{name} {animal} {wears} {arguments} --strands {STRANDS}\n");
        }
    }
    fs::write(folder.join("list.txt"), list).unwrap();
}
