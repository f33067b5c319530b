//! Sparse voxels: leaves of 8 x 8 x 8 with a mask of active ones, constant tiles between them, a
//! background everywhere else.

use super::value::Value;
use super::{LEAF, LOWER, UPPER, VdbError};
use glam::IVec3;

/// Largest index of a voxel.
const LIMIT: i32 = 1 << 30;
/// Voxels of a leaf.
const VOXELS: usize = 512;

/// A block of 8 x 8 x 8 voxels.
#[derive(Clone, Debug)]
pub struct Leaf<T> {
    /// Index of its first voxel; multiples of 8.
    pub origin: IVec3,
    /// One bit a voxel, whether it is active; voxel (x, y, z) of the leaf is bit `64 x + 8 y + z`.
    pub active: [u64; 8],
    /// Values of all voxels in the order of the bits.
    pub values: Box<[T; VOXELS]>,
}

impl<T: Value> Leaf<T> {
    /// A leaf without active voxels.
    pub fn new(origin: IVec3, background: T) -> Self {
        Self {
            origin,
            active: [0; 8],
            values: Box::new([background; VOXELS]),
        }
    }

    /// Place of a voxel among the values; only the voxel's place in its leaf matters.
    pub fn offset(voxel: IVec3) -> usize {
        let local = voxel & (LEAF - 1);
        (local.x << 6 | local.y << 3 | local.z) as usize
    }

    /// Index of the voxel at an offset.
    pub fn voxel(&self, offset: usize) -> IVec3 {
        let i = offset as i32;
        self.origin + IVec3::new(i >> 6, i >> 3 & 7, i & 7)
    }

    /// Sets a voxel of this leaf and makes it active.
    pub fn set(&mut self, voxel: IVec3, value: T) {
        let offset = Self::offset(voxel);
        self.values[offset] = value;
        self.active[offset >> 6] |= 1 << (offset & 63);
    }

    /// Whether the voxel at an offset is active.
    pub fn is_active(&self, offset: usize) -> bool {
        self.active[offset >> 6] >> (offset & 63) & 1 == 1
    }

    /// Number of active voxels.
    pub fn active_count(&self) -> u64 {
        self.active.iter().map(|w| u64::from(w.count_ones())).sum()
    }
}

/// How much a tile covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TileSize {
    /// 8 x 8 x 8 voxels, in place of a leaf.
    Leaf,
    /// 128 x 128 x 128 voxels, in place of a node of leaves.
    Lower,
}

impl TileSize {
    /// Voxels along its edge.
    pub fn edge(self) -> i32 {
        match self {
            Self::Leaf => LEAF,
            Self::Lower => LOWER,
        }
    }
}

/// A block of equal voxels.
#[derive(Clone, Copy, Debug)]
pub struct Tile<T> {
    /// Index of its first voxel; multiples of its edge.
    pub origin: IVec3,
    /// Its edge.
    pub size: TileSize,
    /// The value of all its voxels.
    pub value: T,
    /// Whether they are active.
    pub active: bool,
}

/// All voxels of a grid. Blocks are kept in the order of the file.
#[derive(Clone, Debug)]
pub struct Tree<T> {
    pub(super) background: T,
    pub(super) leaves: Vec<Leaf<T>>,
    /// Tiles of leaf size.
    pub(super) small: Vec<Tile<T>>,
    /// Tiles of the size of a lower node.
    pub(super) large: Vec<Tile<T>>,
}

/// Order of leaves in the file: by upper node, lower node, place in it; x before y before z.
pub(super) fn leaf_key(origin: IVec3) -> [i32; 9] {
    let [a, b, c]: [IVec3; 3] = [12, 7, 3].map(|shift| origin >> shift);
    [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z]
}

impl<T: Value> Tree<T> {
    /// Puts blocks in order; they may come in any.
    ///
    /// # Errors
    /// Blocks that overlap, are not aligned or too far from the origin.
    pub fn new(
        background: T,
        mut leaves: Vec<Leaf<T>>,
        tiles: Vec<Tile<T>>,
    ) -> Result<Self, VdbError> {
        leaves.sort_by_cached_key(|leaf| leaf_key(leaf.origin));
        let (mut small, mut large): (Vec<_>, Vec<_>) = tiles
            .into_iter()
            .partition(|tile| tile.size == TileSize::Leaf);
        small.sort_by_cached_key(|tile| leaf_key(tile.origin));
        large.sort_by_cached_key(|tile| leaf_key(tile.origin));
        let tree = Self {
            background,
            leaves,
            small,
            large,
        };
        tree.check()?;
        Ok(tree)
    }

    fn check(&self) -> Result<(), VdbError> {
        let blocks = (self.leaves.iter().map(|l| (l.origin, LEAF)))
            .chain(self.small.iter().map(|t| (t.origin, LEAF)))
            .chain(self.large.iter().map(|t| (t.origin, LOWER)));
        let mut keys = Vec::with_capacity(self.leaves.len() + self.small.len());
        for (at, size) in blocks {
            if at & (size - 1) != IVec3::ZERO {
                return Err(VdbError::Misaligned { at, size });
            }
            if at.cmplt(IVec3::splat(-LIMIT)).any() || at.cmpgt(IVec3::splat(LIMIT - size)).any() {
                return Err(VdbError::TooFar { at, limit: LIMIT });
            }
            if size == LEAF {
                keys.push(at.to_array());
            }
        }
        keys.sort_unstable();
        if let Some(pair) = keys.windows(2).find(|pair| pair[0] == pair[1]) {
            let at = IVec3::from_array(pair[0]);
            return Err(VdbError::Overlap { at });
        }
        let large: Vec<[i32; 9]> = self.large.iter().map(|t| leaf_key(t.origin)).collect();
        if let Some(i) = (1..large.len()).find(|&i| large[i] == large[i - 1]) {
            let at = self.large[i].origin;
            return Err(VdbError::Overlap { at });
        }
        for key in keys {
            let at = IVec3::from_array(key);
            let node = leaf_key(at & !(LOWER - 1));
            if large.binary_search(&node).is_ok() {
                return Err(VdbError::Overlap { at });
            }
        }
        Ok(())
    }

    /// Value of all voxels that no block covers.
    pub fn background(&self) -> T {
        self.background
    }

    /// The leaves in the order of the file.
    pub fn leaves(&self) -> &[Leaf<T>] {
        &self.leaves
    }

    /// Leaves out leaves without active voxels that hold nothing but the background.
    pub fn drop_empty(&mut self) {
        let background = self.background;
        self.leaves
            .retain(|leaf| leaf.active != [0; 8] || leaf.values.iter().any(|v| *v != background));
    }

    /// Number of active voxels, tiles included.
    pub fn active_count(&self) -> u64 {
        let leaves: u64 = self.leaves.iter().map(Leaf::active_count).sum();
        let tiles = self.active_tiles();
        leaves + tiles.map(|t| (t.size.edge() as u64).pow(3)).sum::<u64>()
    }

    /// First and last active voxel along each axis, or `None` if there is none.
    pub fn active_bounds(&self) -> Option<(IVec3, IVec3)> {
        let of_leaf = |leaf: &Leaf<T>| {
            let active = (0..VOXELS).filter(|&i| leaf.is_active(i));
            active.fold(None, |bounds, i| {
                let at = leaf.voxel(i);
                Some(join(bounds, (at, at)))
            })
        };
        let tiles = self
            .active_tiles()
            .map(|t| (t.origin, t.origin + (t.size.edge() - 1)));
        let mut bounds = tiles.fold(None, |sum, b| Some(join(sum, b)));
        for leaf in &self.leaves {
            // Leaves inside what is known already are passed over.
            let known = bounds.is_some_and(|(lo, hi): (IVec3, IVec3)| {
                leaf.origin.cmpge(lo).all() && (leaf.origin + (LEAF - 1)).cmple(hi).all()
            });
            if !known && let Some(b) = of_leaf(leaf) {
                bounds = Some(join(bounds, b));
            }
        }
        bounds
    }

    /// Bytes that OpenVDB 10 needs for the tree in memory, on a 64-bit machine.
    pub fn memory(&self) -> u64 {
        let (lowers, uppers) = self.node_counts();
        let size = T::SIZE as u64;
        // A leaf: values, mask, origin and the handle of the buffer. A node: a value or a pointer for
        // each child, and two masks. The root by itself: measured.
        let slot = size.next_multiple_of(8);
        let leaf = 512 * size + 96;
        let lower = 4096 * slot + 2 * 512 + 16;
        let upper = 32768 * slot + 2 * 4096 + 16;
        self.leaves.len() as u64 * leaf + lowers * lower + uppers * upper + 1304
    }

    fn node_counts(&self) -> (u64, u64) {
        let mut lowers: Vec<[i32; 3]> = (self.leaves.iter().map(|l| l.origin))
            .chain(self.small.iter().map(|t| t.origin))
            .map(|o| (o & !(LOWER - 1)).to_array())
            .collect();
        lowers.sort_unstable();
        lowers.dedup();
        let mut uppers: Vec<[i32; 3]> = (lowers.iter().map(|&o| IVec3::from_array(o)))
            .chain(self.large.iter().map(|t| t.origin))
            .map(|o| (o & !(UPPER - 1)).to_array())
            .collect();
        uppers.sort_unstable();
        uppers.dedup();
        (lowers.len() as u64, uppers.len() as u64)
    }

    /// All tiles.
    pub fn tiles(&self) -> impl Iterator<Item = &Tile<T>> {
        self.small.iter().chain(&self.large)
    }

    fn active_tiles(&self) -> impl Iterator<Item = &Tile<T>> {
        self.tiles().filter(|tile| tile.active)
    }
}

fn join(sum: Option<(IVec3, IVec3)>, (lo, hi): (IVec3, IVec3)) -> (IVec3, IVec3) {
    sum.map_or((lo, hi), |(a, b)| (a.min(lo), b.max(hi)))
}
