//! The tree of a grid, walked node by node.

use super::VdbFileError as Error;
use super::grid::Values;
use crate::cursor::Cursor;
use flate2::read::ZlibDecoder;
use glam::IVec3;
use half::f16;
use std::io::Read as _;

/// How values are stored: by zlib, active ones only, by Blosc.
const ZIP: u32 = 1;
const ACTIVE: u32 = 2;
const BLOSC: u32 = 4;

/// Number of the way to store values that has all of them.
const ALL: u8 = 6;

/// Walks a tree: first all nodes down to the masks of leaves, then the values of leaves.
pub(super) fn read(
    topology: &mut Cursor<'_>,
    blocks: Cursor<'_>,
    flags: u32,
    components: usize,
    half: bool,
) -> Result<Result<Values, &'static str>, Error> {
    let mut walk = Walk {
        flags,
        components,
        half,
        leaves: Vec::new(),
        values: Values::default(),
        is_hidden: false,
    };
    let buffers = topology.u32()?;
    if buffers != 1 {
        return Ok(Err("a leaf has several of them"));
    }
    topology.take(4 * components as u64)?; // background
    let (tiles, children) = (topology.u32()?, topology.u32()?);
    for _ in 0..tiles {
        let origin = topology.ivec()?;
        let value = walk.plain(topology)?;
        if topology.u8()? != 0 {
            walk.count(origin, 4096, &value);
        }
    }
    for _ in 0..children {
        let origin = topology.ivec()?;
        walk.node(topology, origin, 5)?;
    }
    let mut blocks = blocks;
    for origin in std::mem::take(&mut walk.leaves) {
        walk.leaf(&mut blocks, origin)?;
    }
    Ok(match walk.is_hidden {
        true => Err("they are packed by Blosc"),
        false => Ok(walk.values),
    })
}

struct Walk {
    flags: u32,
    components: usize,
    half: bool,
    /// First voxels.
    leaves: Vec<IVec3>,
    values: Values,
    /// Whether values were met that cannot be unpacked.
    is_hidden: bool,
}

impl Walk {
    /// A node of 2^log2 children along each edge: 5 and 4.
    fn node(&mut self, stream: &mut Cursor<'_>, origin: IVec3, log2: u32) -> Result<(), Error> {
        let count = 1usize << (3 * log2);
        let child = mask(stream, count)?;
        let active = mask(stream, count)?;
        let values = self.unpack(stream, &active, count)?;
        let edge = if log2 == 5 { 128 } else { 8 };
        let place = |i: usize| {
            let axis = |shift: u32| (i >> shift & ((1 << log2) - 1)) as i32;
            // Beyond the largest index is only what a broken file says.
            let local = IVec3::new(axis(2 * log2), axis(log2), axis(0)) * edge;
            origin.saturating_add(local)
        };
        for i in ones(&active).filter(|&i| !bit(&child, i)) {
            let value = values.get(i * self.components..(i + 1) * self.components);
            self.count(place(i), edge, value.unwrap_or_default());
        }
        for i in ones(&child) {
            match log2 {
                5 => self.node(stream, place(i), 4)?,
                _ => {
                    stream.take(64)?;
                    self.leaves.push(place(i));
                }
            }
        }
        Ok(())
    }

    fn leaf(&mut self, stream: &mut Cursor<'_>, origin: IVec3) -> Result<(), Error> {
        let active = mask(stream, 512)?;
        let values = self.unpack(stream, &active, 512)?;
        for i in ones(&active) {
            let local = IVec3::new((i >> 6) as i32, (i >> 3 & 7) as i32, (i & 7) as i32);
            let value = values.get(i * self.components..(i + 1) * self.components);
            self.count(origin.saturating_add(local), 1, value.unwrap_or_default());
        }
        Ok(())
    }

    /// Takes an active voxel or tile into account.
    fn count(&mut self, origin: IVec3, edge: i32, value: &[f32]) {
        let facts = &mut self.values;
        let last = origin.saturating_add(IVec3::splat(edge - 1));
        facts.active = facts.active.saturating_add((edge as u64).pow(3));
        facts.bounds = Some(match facts.bounds {
            Some((lo, hi)) => (lo.min(origin), hi.max(last)),
            None => (origin, last),
        });
        for &v in value {
            if v.is_finite() {
                let (least, most) = facts.range.unwrap_or((v, v));
                facts.range = Some((least.min(v), most.max(v)));
            } else {
                facts.not_finite += 1;
            }
        }
    }

    /// One value as it stands outside of nodes.
    fn plain(&self, stream: &mut Cursor<'_>) -> Result<Vec<f32>, Error> {
        let mut number = || Ok(f32::from_le_bytes(stream.array()?));
        (0..self.components).map(|_| number()).collect()
    }

    /// The values of a node, active ones at their places; empty if they cannot be unpacked.
    fn unpack(
        &mut self,
        stream: &mut Cursor<'_>,
        active: &[u8],
        count: usize,
    ) -> Result<Vec<f32>, Error> {
        let way = stream.u8()?;
        let given = match way {
            0 | 1 | 3 | ALL => 0,
            2 | 4 => 1,
            5 => 2,
            other => {
                return Err(stream
                    .error(format!("values are stored in an unknown way, {other}"))
                    .into());
            }
        };
        stream.take(4 * (given * self.components) as u64)?;
        if (3..=5).contains(&way) {
            stream.take(count as u64 / 8)?;
        }
        let all = self.flags & ACTIVE == 0 || way == ALL;
        let stored = if all { count } else { ones(active).count() };
        let width = if self.half { 2 } else { 4 };
        let size = stored * self.components * width;
        let bytes = match self.stored(stream, size)? {
            Some(bytes) => bytes,
            None => return Ok(Vec::new()),
        };
        let numbers: Vec<f32> = match self.half {
            true => bytes
                .chunks_exact(2)
                .map(|b| f16::from_le_bytes([b[0], b[1]]).to_f32())
                .collect(),
            false => bytes
                .chunks_exact(4)
                .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
                .collect(),
        };
        if all {
            return Ok(numbers);
        }
        let mut values = vec![0.0; count * self.components];
        for (value, i) in numbers.chunks_exact(self.components).zip(ones(active)) {
            values[i * self.components..][..self.components].copy_from_slice(value);
        }
        Ok(values)
    }

    /// So many bytes of values, unpacked; `None` behind Blosc.
    fn stored(&mut self, stream: &mut Cursor<'_>, size: usize) -> Result<Option<Vec<u8>>, Error> {
        if self.half && size == 0 {
            return Ok(Some(Vec::new()));
        }
        if self.flags & (ZIP | BLOSC) == 0 {
            return Ok(Some(stream.take(size as u64)?.to_vec()));
        }
        let length = stream.u64()? as i64;
        let packed = stream.take(length.unsigned_abs())?;
        if length <= 0 {
            return match packed.len() == size {
                true => Ok(Some(packed.to_vec())),
                false => Err(stream
                    .error("a node has another number of values than its mask")
                    .into()),
            };
        }
        if self.flags & BLOSC != 0 {
            self.is_hidden = true;
            return Ok(None);
        }
        let mut bytes = Vec::new();
        let read = ZlibDecoder::new(packed)
            .take(size as u64 + 1)
            .read_to_end(&mut bytes);
        match read.is_ok() && bytes.len() == size {
            true => Ok(Some(bytes)),
            false => Err(stream
                .error("the values of a node are not what zlib makes of them")
                .into()),
        }
    }
}

fn mask(stream: &mut Cursor<'_>, bits: usize) -> Result<Vec<u8>, Error> {
    Ok(stream.take(bits as u64 / 8)?.to_vec())
}

fn bit(mask: &[u8], i: usize) -> bool {
    mask[i >> 3] >> (i & 7) & 1 == 1
}

fn ones(mask: &[u8]) -> impl Iterator<Item = usize> {
    (0..8 * mask.len()).filter(|&i| bit(mask, i))
}
