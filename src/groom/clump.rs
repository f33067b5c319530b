//! Tufts: hairs lean toward the nearest of a jittered grid of centers.

use crate::sampling::hash64;
use glam::{IVec3, Vec3};

/// The cells around a cell, itself being (1, 1, 1): it, those across its faces, its edges, its corners.
const NEAREST_FIRST: [[usize; 3]; 27] = {
    let mut cells = [[0; 3]; 27];
    let (mut filled, mut apart) = (0, 0);
    while apart <= 3 {
        let mut i = 0;
        while i < 27 {
            let cell = [i % 3, i / 3 % 3, i / 9];
            let same = (cell[0] == 1) as usize + (cell[1] == 1) as usize + (cell[2] == 1) as usize;
            if same == 3 - apart {
                cells[filled] = cell;
                filled += 1;
            }
            i += 1;
        }
        apart += 1;
    }
    cells
};

/// A tuft of hair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clump {
    /// Center, meters; near the skin but not on it.
    pub(super) center: Vec3,
    /// Four numbers in [-1, 1), the tuft's own.
    pub(super) random: [f32; 4],
}

/// Distance over which tufts are laid out, and the seed of their jitter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clumps {
    /// Mean size of a tuft, meters.
    pub(super) size: f32,
    /// Seed.
    pub(super) seed: u64,
}

impl Clumps {
    /// The tuft that owns a point: the nearest center among those of the 27 cells around it.
    pub(super) fn at(&self, position: Vec3) -> Clump {
        let place = position / self.size;
        let home = place.floor();
        let within = place - home;
        let home = home.as_ivec3();
        // The least that a center in the cell before, the same and the next can be away along each axis.
        let away = |x: f32| [x * x, 0.0, (1.0 - x) * (1.0 - x)];
        let away = within.to_array().map(away);
        let mut best = (f32::INFINITY, Vec3::ZERO, 0);
        for [x, y, z] in NEAREST_FIRST {
            let least = away[0][x] + away[1][y] + away[2][z];
            // In cells, and with room for rounding.
            if least * (self.size * self.size) * 0.999 > best.0 {
                continue;
            }
            let cell = home + IVec3::new(x as i32 - 1, y as i32 - 1, z as i32 - 1);
            let bits = self.bits(cell);
            let center = (cell.as_vec3() + 0.5 + 0.5 * signed(bits).truncate()) * self.size;
            let distance = center.distance_squared(position);
            if distance < best.0 {
                best = (distance, center, bits);
            }
        }
        Clump {
            center: best.1,
            random: signed(hash64(best.2 ^ 0x5bd1_e995)).to_array(),
        }
    }

    fn bits(&self, cell: IVec3) -> u64 {
        let xy = u64::from(cell.x as u32) << 32 | u64::from(cell.y as u32);
        hash64(hash64(xy ^ self.seed) ^ u64::from(cell.z as u32))
    }
}

/// Tufts whose size varies over the skin.
///
/// One grid of a size that changes from place to place would tear its tufts. So there is a grid for each of
/// some sizes between the smallest and the largest, and a hair belongs to one of the two next to the size
/// at its root, by chance: the sizes of tufts pass into each other hair by hair.
pub(super) struct Tufts {
    levels: Vec<Clumps>,
}

/// Sizes of neighboring grids are to each other as this at most.
const STEP: f32 = 2.0;
/// Most grids less one.
const MAX_STEPS: f32 = 16.0;

impl Tufts {
    /// * `sizes`: the smallest and the largest that there are, meters.
    pub(super) fn new([least, most]: [f32; 2], seed: u64) -> Self {
        let steps = (most / least).log(STEP).ceil().clamp(0.0, MAX_STEPS);
        let size = |k: usize| match k as f32 {
            k if k == steps => most,
            k => least * (most / least).powf(k / steps),
        };
        let level = |k| Clumps {
            size: size(k),
            seed,
        };
        Self {
            levels: (0..=steps as usize).map(level).collect(),
        }
    }

    /// The tuft that owns a hair.
    ///
    /// * `size`: of tufts there, meters. * `luck`: any bits, of the hair.
    pub(super) fn at(&self, position: Vec3, size: f32, luck: u64) -> Clump {
        let after = self.levels.partition_point(|level| level.size < size);
        let after = after.min(self.levels.len() - 1);
        let before = after.saturating_sub(1);
        let [small, large] = [before, after].map(|k| self.levels[k].size);
        let share = if large > small {
            (size / small).ln() / (large / small).ln()
        } else {
            1.0
        };
        let luck = (luck >> 40) as f32 / (1u32 << 24) as f32;
        let level = if luck < share { after } else { before };
        self.levels[level].at(position)
    }
}

/// Four numbers in [-1, 1) from 64 bits.
fn signed(bits: u64) -> glam::Vec4 {
    let at = |shift: u32| ((bits >> shift) as u16) as f32 / 32_768.0 - 1.0;
    glam::Vec4::new(at(0), at(16), at(32), at(48))
}
