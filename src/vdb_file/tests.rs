//! What the writer writes is read, and broken files are refused.

#![allow(clippy::unwrap_used)]

use super::*;
use crate::export::vdb::{Class, Compression, Grid, Leaf, Tile, TileSize, Tree, Writer};
use glam::{DVec3, IVec3, Vec3};
use std::io::Cursor;

fn written(compression: Compression, half: bool) -> Vec<u8> {
    let mut leaf = Leaf::new(IVec3::new(-8, 0, 8), 0.0f32);
    leaf.set(IVec3::new(-7, 2, 9), 0.5);
    leaf.set(IVec3::new(-1, 7, 15), -2.0);
    let tile = Tile {
        origin: IVec3::new(256, 0, 0),
        size: TileSize::Lower,
        value: 3.0f32,
        active: true,
    };
    let density = Grid {
        name: "density".into(),
        class: Class::FogVolume,
        voxel: 0.5,
        half,
        metadata: Vec::new(),
        tree: Tree::new(0.0, vec![leaf], vec![tile]).unwrap(),
    };
    let mut leaf = Leaf::new(IVec3::splat(16), Vec3::ZERO);
    for i in 0..8 {
        leaf.set(IVec3::splat(16 + i), Vec3::new(i as f32, 0.0, 1.0));
    }
    let color = Grid {
        name: "color".into(),
        class: Class::Unknown,
        voxel: 0.5,
        half,
        metadata: Vec::new(),
        tree: Tree::new(Vec3::ZERO, vec![leaf], Vec::new()).unwrap(),
    };
    let mut writer = Writer::new(Cursor::new(Vec::new()), compression, "test").unwrap();
    writer.grid(&density).unwrap();
    writer.grid(&color).unwrap();
    writer.finish().unwrap().into_inner()
}

#[test]
fn values_and_places_are_those_that_were_written() {
    for compression in [Compression::None, Compression::Zip] {
        for half in [false, true] {
            let facts = read(&written(compression, half)).unwrap();
            assert_eq!((facts.version, facts.grids.len()), (224, 2));
            let density = &facts.grids[0];
            assert_eq!(density.text("class"), Some("fog volume"));
            assert_eq!(
                density.meta("is_saved_as_half_float"),
                Some(&Meta::Bool(half))
            );
            let values = density.values.as_ref().unwrap();
            assert_eq!(values.active, 2 + 128 * 128 * 128);
            assert_eq!(values.range, Some((-2.0, 3.0)));
            assert_eq!(
                values.bounds,
                Some((IVec3::new(-7, 0, 0), IVec3::new(383, 127, 127)))
            );
            let (lo, hi) = density.world_bounds().unwrap();
            assert_eq!(
                (lo, hi),
                (
                    DVec3::new(-3.75, -0.25, -0.25),
                    DVec3::new(191.75, 63.75, 63.75)
                )
            );
            let color = facts.grids[1].values.as_ref().unwrap();
            assert_eq!(
                (color.active, color.range, color.not_finite),
                (8, Some((0.0, 7.0)), 0)
            );
        }
    }
}

#[test]
fn broken_files_are_refused() {
    assert_eq!(read(b"HAIR"), Err(VdbFileError::NotVdb));
    for compression in [Compression::None, Compression::Zip] {
        let whole = written(compression, false);
        // Nodes are long; every seventh length is enough.
        for length in (0..whole.len()).step_by(7) {
            assert!(
                read(&whole[..length]).is_err(),
                "{length} of {}",
                whole.len()
            );
        }
        let mut state = 7u32;
        for _ in 0..2000 {
            let mut bytes = whole.clone();
            for _ in 0..3 {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let at = (state >> 8) as usize % bytes.len();
                bytes[at] ^= 1 << (state & 7);
            }
            // Half of the changes are near the head, where most is decided.
            bytes[(state >> 16) as usize % 2000] ^= 1 << (state >> 4 & 7);
            let _ = read(&bytes);
        }
    }
}
