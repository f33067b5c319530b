//! Maps from the cells of a grid, by a hash that is quick: nobody chooses cells to make it collide.

use crate::sampling::hash64;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// A map from cells.
pub(crate) type CellMap<K, V> = HashMap<K, V, BuildHasherDefault<CellHasher>>;

/// Mixes numbers one after another.
#[derive(Default)]
pub(crate) struct CellHasher(u64);

impl Hasher for CellHasher {
    fn write(&mut self, bytes: &[u8]) {
        for part in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..part.len()].copy_from_slice(part);
            self.0 = hash64(self.0.wrapping_add(1) ^ u64::from_le_bytes(word));
        }
    }

    fn finish(&self) -> u64 {
        self.0
    }
}
