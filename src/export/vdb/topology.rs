//! The nodes above the leaves, which the file holds as a tree.

use super::pack::{Masks, Packer};
use super::tree::{Leaf, Tile, Tree, leaf_key};
use super::value::{Value, put};
use super::{LOWER, UPPER};
use glam::IVec3;

/// A node of 32 x 32 x 32 lower nodes, or one of 16 x 16 x 16 leaves: what it holds in the order of
/// the file.
struct Node<'a, C, T> {
    origin: IVec3,
    children: Vec<C>,
    tiles: &'a [Tile<T>],
}

type Lower<'a, T> = Node<'a, &'a Leaf<T>, T>;

/// Appends everything but the values of leaves.
pub(super) fn put_topology<T: Value>(
    tree: &Tree<T>,
    half: bool,
    packer: &mut Packer<T>,
    out: &mut Vec<u8>,
) {
    let background = if half {
        tree.background.to_half()
    } else {
        tree.background
    };
    out.extend(1u32.to_le_bytes()); // buffers a leaf
    put(background, false, out);
    let leaves = tree.leaves.iter().map(|leaf| (leaf.origin, leaf));
    let lowers = nodes(LOWER, leaves, &tree.small).into_iter();
    let uppers = nodes(UPPER, lowers.map(|l| (l.origin, l)), &tree.large);
    out.extend(0u32.to_le_bytes()); // tiles of the root
    out.extend((uppers.len() as u32).to_le_bytes());
    for upper in &uppers {
        for c in upper.origin.to_array() {
            out.extend(c.to_le_bytes());
        }
        let at = |lower: &Lower<'_, T>| lower.origin;
        put_node(upper, 5, 7, at, tree.background, packer, out);
        for lower in &upper.children {
            let at = |leaf: &&Leaf<T>| leaf.origin;
            put_node(lower, 4, 3, at, tree.background, packer, out);
            for leaf in &lower.children {
                put_mask(&leaf.active, out);
            }
        }
    }
}

/// Appends masks and tiles of a node of `2^log2` children along each edge, each of `2^child_log2`
/// voxels.
fn put_node<C, T: Value>(
    node: &Node<'_, C, T>,
    log2: u32,
    child_log2: u32,
    origin: impl Fn(&C) -> IVec3,
    background: T,
    packer: &mut Packer<T>,
    out: &mut Vec<u8>,
) {
    let count = 1usize << (3 * log2);
    let offset = |at: IVec3| {
        let local = (at - node.origin) >> child_log2;
        ((local.x << (2 * log2)) | (local.y << log2) | local.z) as usize
    };
    let mut child = vec![0u64; count / 64];
    let mut active = vec![0u64; count / 64];
    let mut values = vec![background; count];
    for c in &node.children {
        let i = offset(origin(c));
        child[i >> 6] |= 1 << (i & 63);
        values[i] = T::ZERO;
    }
    for tile in node.tiles {
        let i = offset(tile.origin);
        values[i] = tile.value;
        active[i >> 6] |= u64::from(tile.active) << (i & 63);
    }
    put_mask(&child, out);
    put_mask(&active, out);
    let masks = Masks {
        active: &active,
        child: &child,
    };
    packer.pack(&values, &masks, out);
}

/// Appends a mask as the file has it.
pub(super) fn put_mask(mask: &[u64], out: &mut Vec<u8>) {
    out.extend(mask.iter().flat_map(|word| word.to_le_bytes()));
}

/// Nodes of `edge` voxels with what is in them, in the order of the file: as `children` and `tiles` are.
fn nodes<'a, C, T>(
    edge: i32,
    children: impl Iterator<Item = (IVec3, C)>,
    tiles: &'a [Tile<T>],
) -> Vec<Node<'a, C, T>> {
    let home = |origin: IVec3| origin & !(edge - 1);
    let mut tiles = tiles
        .chunk_by(|a, b| home(a.origin) == home(b.origin))
        .peekable();
    let with = |tiles: &'a [Tile<T>]| Node {
        origin: home(tiles[0].origin),
        children: Vec::new(),
        tiles,
    };
    let mut nodes: Vec<Node<'a, C, T>> = Vec::new();
    for (origin, child) in children {
        let origin = home(origin);
        if nodes.last().is_none_or(|node| node.origin != origin) {
            // Nodes of tiles alone come in between.
            while let Some(before) =
                tiles.next_if(|t| leaf_key(home(t[0].origin)) < leaf_key(origin))
            {
                nodes.push(with(before));
            }
            let own = tiles.next_if(|t| home(t[0].origin) == origin);
            nodes.push(Node {
                origin,
                children: Vec::new(),
                tiles: own.unwrap_or(&[]),
            });
        }
        if let Some(node) = nodes.last_mut() {
            node.children.push(child);
        }
    }
    nodes.extend(tiles.map(with));
    nodes
}
