//! Grids as plain numbers, for other programs to compare with: a .raw file.
//!
//! A sequence of grids: name (length as u32, bytes), edge of a voxel (f64), components a value (u32), the
//! background, then the number of leaves (u32) and for each its origin (3 x i32), 512 bits of activity
//! and 512 values; then the number of tiles (u32) and for each origin, edge (i32), active (u32), value.
//! Floats throughout, already rounded where the file has halves.

use glam::IVec3;
use vair::export::vdb::{Grid, Value};

#[derive(Default)]
pub(crate) struct Raw(pub(crate) Vec<u8>);

impl Raw {
    fn value<T: Value>(&mut self, value: T, half: bool) {
        let value = if half { value.to_half() } else { value };
        for c in value.components() {
            self.0.extend(c.to_le_bytes());
        }
    }

    fn place(&mut self, at: IVec3) {
        for c in at.to_array() {
            self.0.extend(c.to_le_bytes());
        }
    }

    fn number(&mut self, n: usize) {
        self.0.extend((n as u32).to_le_bytes());
    }

    pub(crate) fn grid<T: Value>(&mut self, grid: &Grid<T>) {
        self.number(grid.name.len());
        self.0.extend(grid.name.as_bytes());
        self.0.extend(grid.voxel.to_le_bytes());
        self.number(T::ZERO.components().len());
        self.value(grid.tree.background(), grid.half);
        self.number(grid.tree.leaves().len());
        for leaf in grid.tree.leaves() {
            self.place(leaf.origin);
            self.0
                .extend(leaf.active.iter().flat_map(|w| w.to_le_bytes()));
            for &value in leaf.values.iter() {
                self.value(value, grid.half);
            }
        }
        self.number(grid.tree.tiles().count());
        for tile in grid.tree.tiles() {
            self.place(tile.origin);
            self.number(tile.size.edge() as usize);
            self.number(usize::from(tile.active));
            self.value(tile.value, grid.half);
        }
    }
}
