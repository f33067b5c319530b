//! Writes OpenVDB files of every kind with their voxels beside them, for `tests/clients/vdb.sh` to
//! have them read by OpenVDB: target/tmp/vdb/NAME.vdb and, as plain numbers, NAME.raw (`raw/grids.rs`).

#![allow(clippy::unwrap_used)]

#[path = "raw/grids.rs"]
mod grids;

use glam::{IVec3, Vec3};
use grids::Raw;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::PathBuf;
use vair::export::vdb::{
    Class, Compression, Grid, Leaf, Meta, Tile, TileSize, Tree, Value, VectorKind, Writer,
};

/// A number in [0, 1) from a place, different everywhere.
fn noise(at: IVec3, salt: u32) -> f32 {
    let [x, y, z] = at.to_array().map(|v| v as u32);
    let mut h =
        x.wrapping_mul(0x8da6_b343) ^ y.wrapping_mul(0xd816_3841) ^ z.wrapping_mul(0xcb1a_b31f);
    h = (h ^ salt.wrapping_mul(0x9e37_79b9)).wrapping_mul(0x85eb_ca6b);
    h ^= h >> 13;
    h = h.wrapping_mul(0xc2b2_ae35);
    ((h ^ (h >> 16)) >> 8) as f32 / (1 << 24) as f32
}

/// Leaves on both sides of all borders of nodes, with few, many and all voxels active, and with none,
/// one, two and many different inactive values.
fn leaves<T: Value>(background: T, value: impl Fn(IVec3, u32) -> T) -> Vec<Leaf<T>> {
    let edges = [-4104, -4096, -136, -128, -8, 0, 8, 120, 128, 4088, 4096];
    let mut leaves = Vec::new();
    for (i, &x) in edges.iter().enumerate() {
        for (j, &y) in edges.iter().enumerate() {
            let origin = IVec3::new(x, y, edges[(3 * i + 7 * j) % edges.len()]);
            let mut leaf = Leaf::new(origin, background);
            let kind = (i + 5 * j) % 7;
            let share = [0.02, 0.3, 0.9, 1.1][(i + j) % 4];
            for k in 0..512 {
                let at = leaf.voxel(k);
                leaf.values[k] = match kind {
                    0 => background,
                    1 => background.negated(),
                    2 => value(origin, 9),
                    3 => [background, background.negated()][k % 2],
                    4 => [background, value(origin, 9)][k / 3 % 2],
                    5 => [value(origin, 8), value(origin, 9)][k / 5 % 2],
                    _ => value(at, 7),
                };
                if noise(at, 1) < share {
                    leaf.set(at, value(at, 2));
                }
            }
            leaves.push(leaf);
        }
    }
    leaves
}

fn tiles<T: Value>(background: T, value: impl Fn(IVec3, u32) -> T) -> Vec<Tile<T>> {
    let tile = |at: [i32; 3], size, value, active| Tile {
        origin: IVec3::from(at),
        size,
        value,
        active,
    };
    let at = IVec3::ZERO;
    vec![
        tile([16, 16, 16], TileSize::Leaf, value(at, 3), true),
        tile([16, 16, 24], TileSize::Leaf, background.negated(), false),
        tile([-512, 0, 0], TileSize::Leaf, value(at, 4), true),
        tile(
            [256, 256, -256],
            TileSize::Lower,
            background.negated(),
            false,
        ),
        tile([256, 256, 256], TileSize::Lower, value(at, 5), true),
        tile([8192, 0, 0], TileSize::Lower, value(at, 6), true),
    ]
}

fn write(name: &str, half: bool, compression: Compression) {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("vdb");
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    let out = BufWriter::new(File::create(path.with_extension("vdb")).unwrap());
    let mut writer = Writer::new(out, compression, "vair test").unwrap();
    let mut raw = Raw::default();

    let scalar = |at: IVec3, salt: u32| 3.0 * noise(at, salt) - 1.0;
    let vector = |at: IVec3, salt: u32| {
        Vec3::new(
            scalar(at, salt),
            scalar(at, salt + 20),
            scalar(at, salt + 40),
        )
    };
    for (name, class, background) in [
        ("density", Class::FogVolume, 0.0f32),
        ("surface", Class::LevelSet, 0.3),
    ] {
        let tiles = tiles(background, scalar);
        let grid = Grid {
            name: name.into(),
            class,
            voxel: 0.25,
            half,
            metadata: vec![("unit".into(), Meta::Text("1/m".into()))],
            tree: Tree::new(background, leaves(background, scalar), tiles).unwrap(),
        };
        writer.grid(&grid).unwrap();
        raw.grid(&grid);
    }
    let background = Vec3::new(0.1, 0.0, -0.7);
    let tiles = tiles(background, vector);
    let grid = Grid {
        name: "color".into(),
        class: Class::Unknown,
        voxel: 0.001,
        half,
        metadata: vec![
            VectorKind::Invariant.meta(),
            ("gain".into(), Meta::Double(0.1)),
        ],
        tree: Tree::new(background, leaves(background, vector), tiles).unwrap(),
    };
    writer.grid(&grid).unwrap();
    raw.grid(&grid);
    let empty = Grid {
        name: "empty".into(),
        class: Class::FogVolume,
        voxel: 1e6,
        half,
        metadata: Vec::new(),
        tree: Tree::new(0.0f32, Vec::new(), Vec::new()).unwrap(),
    };
    writer.grid(&empty).unwrap();
    raw.grid(&empty);
    writer.finish().unwrap();
    fs::write(path.with_extension("raw"), raw.0).unwrap();
}

#[test]
fn files_for_the_library_to_read() {
    write("float_zip", false, Compression::Zip);
    write("float_plain", false, Compression::None);
    write("half_zip", true, Compression::Zip);
    write("half_plain", true, Compression::None);
}
