//! Sums of a picture as files.
//!
//! A file is safetensors: the length of the header (u64, little-endian), the header (JSON), an array
//! `pixels` of 64-bit words, pixel by pixel, tile by tile, and for mattes one of counts, `mattes`. The header's
//! `__metadata__` has `vair_film`, the [`Header`] as JSON, and `sha256`, the checksum of that text followed by
//! the arrays.

use super::Crop;
use super::film::{PixelSums, WORDS};
use super::mattes::MatteNames;
use super::sums::{FilmSums, FilmSumsError, Header};
use crate::hex::hex;
use crate::io::{AtomicFile, FileError, read_bounded};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;

/// Where the header says what the sums are of.
const MARK: &str = "vair_film";
/// Bytes at the start of a file that have the mark in them, if any: nothing long comes before it.
const MARK_WITHIN: u64 = 4096;
/// Largest file read, bytes.
const FILE_LIMIT: u64 = 64 << 30;

impl FilmSums {
    /// Writes a file: whole under its name, or not at all.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), FileError> {
        let fail = |e: std::io::Error| FileError::new("write", path, e);
        let text = serde_json::to_string(&self.header).map_err(|e| fail(e.into()))?;
        let mut hasher = Sha256::new_with_prefix(text.as_bytes());
        for sums in &self.pixels {
            hasher.update(bytes_of(sums));
        }
        let mattes: Vec<u8> = self.mattes.iter().flat_map(|n| n.to_le_bytes()).collect();
        hasher.update(&mattes);
        let size = self.pixels.len() * WORDS * 8;
        let mut head = json!({
            "pixels": {
                "dtype": "U64", "shape": [self.pixels.len(), WORDS], "data_offsets": [0, size],
            },
            "__metadata__": {MARK: text, "sha256": hex(&hasher.finalize())},
        });
        if let Some(names) = &self.header.mattes {
            head["mattes"] = json!({
                "dtype": "U32", "shape": [self.pixels.len(), names.columns()],
                "data_offsets": [size, size + mattes.len()],
            });
        }
        let mut head = head.to_string();
        while !head.len().is_multiple_of(8) {
            head.push(' ');
        }
        let mut out = AtomicFile::create(path)?;
        out.write_all(&(head.len() as u64).to_le_bytes())
            .and_then(|()| out.write_all(head.as_bytes()))
            .map_err(fail)?;
        for sums in &self.pixels {
            out.write_all(&bytes_of(sums)).map_err(fail)?;
        }
        out.write_all(&mattes).map_err(fail)?;
        out.commit()
    }

    /// Whether a file says that it holds the sums of a picture; damaged ones do so too.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn are_in(path: &Path) -> Result<bool, FileError> {
        let fail = |e| FileError::new("read", path, e);
        let mut head = Vec::new();
        let file = File::open(path).map_err(fail)?;
        file.take(MARK_WITHIN)
            .read_to_end(&mut head)
            .map_err(fail)?;
        Ok(head.windows(MARK.len()).any(|part| part == MARK.as_bytes()))
    }

    /// Reads a file.
    ///
    /// # Errors
    /// A file that cannot be read, that holds no sums of a picture, or of which a single bit is not as it
    /// was written.
    pub fn read(path: &Path) -> Result<Self, FilmSumsError> {
        let bytes = read_bounded(path, FILE_LIMIT)?;
        Self::decode(&bytes).map_err(|what| FilmSumsError::Damaged {
            path: path.to_owned(),
            what,
        })
    }

    fn decode(bytes: &[u8]) -> Result<Self, String> {
        let short = || "it is too short".to_owned();
        let (length, rest) = bytes.split_first_chunk().ok_or_else(short)?;
        let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|e| e.to_string())?;
        let (head, array) = rest.split_at_checked(length).ok_or_else(short)?;
        let head: Value = serde_json::from_slice(head).map_err(|e| format!("its header: {e}"))?;
        let metadata = &head["__metadata__"];
        let text = metadata[MARK].as_str();
        let text = text.ok_or("its header says nothing of a picture")?;
        let mut hasher = Sha256::new_with_prefix(text.as_bytes());
        hasher.update(array);
        if metadata["sha256"].as_str() != Some(hex(&hasher.finalize()).as_str()) {
            return Err("its checksum is wrong".to_owned());
        }
        let header: Header = serde_json::from_str(text).map_err(|e| format!("its header: {e}"))?;
        let tiles = header.check()?;
        let count: usize = tiles.iter().map(Crop::pixels).sum();
        let columns = header.mattes.as_ref().map_or(0, MatteNames::columns);
        if array.len() != count * (8 * WORDS + 4 * columns) {
            return Err(format!("its size is not that of {count} pixels"));
        }
        let (array, mattes) = array.split_at(count * 8 * WORDS);
        let (words, _) = array.as_chunks::<{ 8 * WORDS }>();
        let (mattes, _) = mattes.as_chunks::<4>();
        let pixels = words.iter().map(|bytes| {
            let (words, _) = bytes.as_chunks::<8>();
            PixelSums::from_words(&std::array::from_fn(|i| u64::from_le_bytes(words[i])))
        });
        Ok(Self {
            pixels: pixels.collect(),
            mattes: mattes.iter().map(|n| u32::from_le_bytes(*n)).collect(),
            header,
        })
    }
}

fn bytes_of(sums: &PixelSums) -> [u8; 8 * WORDS] {
    let mut bytes = [0; 8 * WORDS];
    for (bytes, word) in bytes.chunks_exact_mut(8).zip(sums.words()) {
        bytes.copy_from_slice(&word.to_le_bytes());
    }
    bytes
}
