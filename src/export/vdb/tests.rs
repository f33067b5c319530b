//! What can be known without the library; whether it reads the files is for `tests/vdb_files.rs` and
//! the script beside it.

use super::*;
use glam::{IVec3, Vec3};
use std::io::Cursor;

fn bytes<T: Value>(grid: &Grid<T>) -> Result<Vec<u8>, VdbError> {
    let mut writer = Writer::new(Cursor::new(Vec::new()), Compression::Zip, "test")?;
    writer.grid(grid)?;
    Ok(writer.finish()?.into_inner())
}

fn grid<T: Value>(tree: Tree<T>) -> Grid<T> {
    Grid {
        name: "a".into(),
        class: Class::Unknown,
        voxel: 0.5,
        half: false,
        metadata: Vec::new(),
        tree,
    }
}

fn leaf(at: [i32; 3]) -> Leaf<f32> {
    let mut leaf = Leaf::new(IVec3::from(at), 0.0);
    leaf.set(IVec3::from(at) + 1, 1.0);
    leaf
}

fn small(at: [i32; 3]) -> Tile<f32> {
    Tile {
        origin: IVec3::from(at),
        size: TileSize::Leaf,
        value: 2.0,
        active: true,
    }
}

#[test]
fn order_of_blocks_does_not_matter() {
    let blocks = [
        [8, 0, 0],
        [-4096, 8, 0],
        [0, 0, 128],
        [0, 120, 0],
        [0, 128, 0],
    ];
    let forth = Tree::new(
        0.0,
        blocks.map(leaf).into(),
        vec![small([0, 0, 8]), small([4096, 0, 0])],
    );
    let mut back: Vec<_> = blocks.map(leaf).into();
    back.reverse();
    let back = Tree::new(0.0, back, vec![small([4096, 0, 0]), small([0, 0, 8])]);
    let (forth, back) = (forth.unwrap(), back.unwrap());
    assert_eq!(forth.active_count(), 5 + 2 * 512);
    let bounds = (IVec3::new(-4095, 0, 0), IVec3::new(4103, 129, 129));
    assert_eq!(forth.active_bounds(), Some(bounds));
    assert_eq!(bytes(&grid(forth)).unwrap(), bytes(&grid(back)).unwrap());
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let leaves: Vec<_> = (0..5000)
        .map(|i| {
            let mut leaf = leaf([8 * (i % 70), 8 * (i / 70), -8 * (i % 3)]);
            leaf.set(IVec3::new(0, i % 8, 3), i as f32);
            leaf
        })
        .collect();
    let grid = grid(Tree::new(0.0, leaves, Vec::new()).unwrap());
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| bytes(&grid).unwrap())
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn what_cannot_be_stored_is_refused_with_its_place() {
    let two = Tree::new(0.0, vec![leaf([0; 3]), leaf([0; 3])], Vec::new());
    assert!(matches!(two, Err(VdbError::Overlap { .. })));
    let covered = Tree::new(0.0, vec![leaf([8; 3])], vec![small([8; 3])]);
    assert!(matches!(covered, Err(VdbError::Overlap { .. })));
    let large = Tile {
        size: TileSize::Lower,
        ..small([-128, 0, 0])
    };
    let covered = Tree::new(0.0, vec![leaf([-8, 16, 24])], vec![large]);
    assert!(matches!(covered, Err(VdbError::Overlap { .. })));
    let crooked = Tree::new(0.0, vec![leaf([4, 0, 0])], Vec::new());
    assert!(matches!(crooked, Err(VdbError::Misaligned { .. })));
    let far = Tree::new(0.0, vec![leaf([1 << 30, 0, 0])], Vec::new());
    assert!(matches!(far, Err(VdbError::TooFar { .. })));

    let with = |value: f32| {
        let mut leaf = leaf([8, 0, 0]);
        leaf.set(IVec3::new(9, 2, 3), value);
        grid(Tree::new(0.0, vec![leaf], Vec::new()).unwrap())
    };
    let error = bytes(&with(f32::NAN)).unwrap_err().to_string();
    assert!(
        error.contains("`a`") && error.contains("[9, 2, 3]"),
        "{error}"
    );
    let half = Grid {
        half: true,
        ..with(65520.0)
    };
    assert!(matches!(bytes(&half), Err(VdbError::BeyondHalf { .. })));
    assert!(bytes(&with(65520.0)).is_ok());
    for voxel in [1e-6, -1.0, f64::NAN, f64::INFINITY] {
        let grid = Grid { voxel, ..with(1.0) };
        assert!(matches!(bytes(&grid), Err(VdbError::Voxel { .. })));
    }
    let mut writer = Writer::new(Cursor::new(Vec::new()), Compression::None, "test").unwrap();
    writer.grid(&with(1.0)).unwrap();
    assert!(matches!(writer.grid(&with(2.0)), Err(VdbError::Name(_))));
}

#[test]
fn vectors_count_too() {
    let mut leaf = Leaf::new(IVec3::splat(-8), Vec3::ZERO);
    leaf.set(IVec3::splat(-1), Vec3::ONE);
    let tree = Tree::new(Vec3::ZERO, vec![leaf], Vec::new()).unwrap();
    assert_eq!(
        tree.active_bounds(),
        Some((IVec3::splat(-1), IVec3::splat(-1)))
    );
    let file = bytes(&grid(tree)).unwrap();
    let has = |text: &str| file.windows(text.len()).any(|w| w == text.as_bytes());
    assert!(has("Tree_vec3s_5_4_3") && has("file_bbox_min") && !has("HalfFloat"));
}
