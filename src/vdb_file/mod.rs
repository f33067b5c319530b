//! Reads OpenVDB files that anyone wrote, as far as a check needs it: metadata, transforms, and what the
//! active values of `float` and `vec3s` trees are like.
//!
//! File versions 222 to 225, trees 5-4-3, zip, active values and halves as `export::vdb` and OpenVDB's own
//! library write them; values behind Blosc and of other types are passed over. Values are looked at node by
//! node and never held together, so a small file cannot ask for much memory.

mod grid;
mod nodes;

#[cfg(test)]
mod tests;

pub use grid::{GridFacts, Meta, Values};

use crate::cursor::{Cursor, Misread};

/// Most grids of a file.
const MOST_GRIDS: u32 = 10_000;

/// A file that is not OpenVDB, or a broken one.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VdbFileError {
    /// The first bytes are others.
    #[error("it is no OpenVDB file: it does not begin with its magic number")]
    NotVdb,
    /// The file does not say what it should.
    #[error("byte {at}: {reason}")]
    Invalid {
        /// Where.
        at: u64,
        /// What is wrong there.
        reason: String,
    },
}

impl From<Misread> for VdbFileError {
    fn from(Misread { at, reason }: Misread) -> Self {
        Self::Invalid { at, reason }
    }
}

/// What is in a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VdbFacts {
    /// Version of the format.
    pub version: u32,
    /// The grids; empty for versions that are not read.
    pub grids: Vec<GridFacts>,
    /// Whether the grids could be read at all.
    pub is_read: bool,
}

/// Reads the bytes of a file.
///
/// # Errors
/// [`VdbFileError`] with the place.
pub fn read(bytes: &[u8]) -> Result<VdbFacts, VdbFileError> {
    let mut stream = Cursor::new(bytes, 0);
    if stream.u64().ok() != Some(0x5644_4220) {
        return Err(VdbFileError::NotVdb);
    }
    let mut facts = VdbFacts {
        version: stream.u32()?,
        ..VdbFacts::default()
    };
    if !(222..=225).contains(&facts.version) {
        return Ok(facts);
    }
    stream.take(8)?;
    let has_offsets = stream.u8()? != 0;
    stream.take(36)?;
    grid::metadata(&mut stream)?;
    if !has_offsets {
        return Ok(facts);
    }
    facts.is_read = true;
    let count = stream.u32()?;
    if count > MOST_GRIDS {
        return Err(stream
            .error(format!(
                "{count} grids announced, at most {MOST_GRIDS} are read"
            ))
            .into());
    }
    for _ in 0..count {
        let name = stream.text()?;
        let type_name = stream.text()?;
        let parent = stream.text()?;
        let [grid_at, blocks_at, end] = [stream.u64()?, stream.u64()?, stream.u64()?];
        let is_instance = !parent.is_empty();
        // An instance has no blocks of its own, and says nothing of where they are.
        let blocks_at = if is_instance { grid_at } else { blocks_at };
        if !(stream.at() <= grid_at && grid_at <= blocks_at && blocks_at <= end) {
            return Err(stream.error("a grid ends before it begins").into());
        }
        // The part after a sign tells grids of the same name apart.
        let name = name.split('\u{1e}').next().unwrap_or_default().to_owned();
        // Each stands behind the one before, so that nothing is read twice.
        let own = &bytes[..usize::try_from(end).unwrap_or(usize::MAX).min(bytes.len())];
        let at = [grid_at, blocks_at];
        (facts.grids).push(grid::read(own, at, name, type_name, is_instance)?);
        stream = Cursor::new(bytes, end);
    }
    Ok(facts)
}
