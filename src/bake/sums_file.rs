//! The file of exact sums, for checkpoints and shards: safetensors with a checksum.
//!
//! Layout: the length of the header (u64, little-endian), the header (JSON), the arrays (u64,
//! little-endian, without gaps). The header's `__metadata__` has two strings: `vair`, the [`Header`] as
//! JSON, and `sha256`, the checksum of that string followed by the arrays.

use super::SumsError;
use super::content::Recipe;
use super::plan::Plan;
use super::settings::check;
use super::tally::Tally;
use crate::hex::hex;
use crate::io::{AtomicFile, FileError};
use crate::table::Provenance;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::ops::Range;
use std::path::Path;

/// Raised when the layout or the meaning of an array changes.
const VERSION: u32 = 2;
/// Recipe and species text are some ten kilobytes; a species file may be four megabytes.
const LONGEST_HEADER: u64 = 32 << 20;

/// What sums are of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Header {
    pub(super) version: u32,
    pub(super) recipe: Recipe,
    pub(super) plan: Plan,
    /// Origin of the tables to be.
    pub(super) provenance: Provenance,
    /// Absorption that three channels are dyed with, per micrometer. `None` for one channel.
    pub(super) dye: Option<[f64; 3]>,
    /// Photons of the bake that are in the sums: ascending and apart.
    pub(super) spans: Vec<Range<u64>>,
    /// Into how many shards the bake was split, 1 if it was not.
    pub(super) shards: u64,
    /// Where an error goal is looked at next.
    pub(super) check: u64,
}

impl Header {
    pub(super) fn new(recipe: Recipe, plan: Plan) -> Self {
        Self {
            version: VERSION,
            recipe,
            plan,
            provenance: Provenance::default(),
            dye: None,
            spans: Vec::new(),
            shards: 1,
            check: 0,
        }
    }

    /// Photons in the sums, of each channel.
    pub(super) fn photons(&self) -> u64 {
        self.spans.iter().map(|span| span.end - span.start).sum()
    }

    /// The arrays of a file with this header: name, shape and place.
    fn arrays(&self) -> (Map<String, Value>, u64) {
        let head = [self.plan.recipes.len(), self.plan.settings.nodes()];
        let (mut map, mut at) = (Map::new(), 0u64);
        for (name, shape) in Tally::shapes(self.plan.settings.face, self.plan.settings.levels.len())
        {
            let shape: Vec<usize> = head.into_iter().chain(shape).collect();
            let end = at + 8 * shape.iter().map(|&n| n as u64).product::<u64>();
            let entry = json!({"dtype": "U64", "shape": shape, "data_offsets": [at, end]});
            map.insert(name.to_owned(), entry);
            at = end;
        }
        (map, at)
    }

    fn check(&self) -> Result<(), String> {
        check(&self.plan.settings).map_err(|e| e.to_string())?;
        if !matches!(self.plan.recipes.len(), 1 | 3) {
            return Err(format!("it has {} channels", self.plan.recipes.len()));
        }
        let mut least = 0;
        for span in &self.spans {
            if span.start < least || span.end < span.start {
                return Err(format!("its photons {span:?} are out of order"));
            }
            least = span.end;
        }
        if least > self.plan.settings.photons {
            return Err(format!(
                "it has photon {least} of {}",
                self.plan.settings.photons
            ));
        }
        Ok(())
    }
}

/// Writes sums: whole under their name, or not at all.
pub(super) fn write(path: &Path, header: &Header, tallies: &[Tally]) -> Result<(), FileError> {
    let fail = |e: io::Error| FileError::new("write", path, e);
    let text = serde_json::to_string(header).map_err(|e| fail(e.into()))?;
    let mut hasher = Sha256::new_with_prefix(text.as_bytes());
    each_block(tallies, |bytes| {
        hasher.update(bytes);
        Ok(())
    })
    .map_err(fail)?;
    let (mut map, _) = header.arrays();
    map.insert(
        "__metadata__".to_owned(),
        json!({"vair": text, "sha256": hex(&hasher.finalize())}),
    );
    let mut head = Value::Object(map).to_string();
    // The format wants arrays to begin at a multiple of their number's size.
    while !head.len().is_multiple_of(8) {
        head.push(' ');
    }
    let mut file = AtomicFile::create(path)?;
    file.write_all(&(head.len() as u64).to_le_bytes())
        .map_err(fail)?;
    file.write_all(head.as_bytes()).map_err(fail)?;
    each_block(tallies, |bytes| file.write_all(bytes)).map_err(fail)?;
    file.commit()
}

/// The arrays as bytes, array by array, in blocks.
fn each_block(tallies: &[Tally], mut f: impl FnMut(&[u8]) -> io::Result<()>) -> io::Result<()> {
    let mut block = Vec::with_capacity(8 * BLOCK);
    for array in 0..Tally::ARRAYS {
        for tally in tallies {
            for words in tally.arrays()[array].chunks(BLOCK) {
                block.clear();
                block.extend(words.iter().flat_map(|word| word.to_le_bytes()));
                f(&block)?;
            }
        }
    }
    Ok(())
}

/// Numbers converted at a time.
const BLOCK: usize = 8192;

/// Reads only what the sums are of.
pub(super) fn read_header(path: &Path) -> Result<Header, SumsError> {
    open(path).map(|opened| opened.header)
}

/// Reads sums.
///
/// # Errors
/// A file that cannot be read, that holds no sums, or of which a single bit is not as it was written.
pub(super) fn read(path: &Path) -> Result<(Header, Vec<Tally>), SumsError> {
    let mut opened = open(path)?;
    let plan = &opened.header.plan;
    let mut tallies: Vec<Tally> = (0..plan.units()).map(|_| plan.empty_tally()).collect();
    let mut hasher = Sha256::new_with_prefix(opened.text.as_bytes());
    let mut block = vec![0; 8 * BLOCK];
    for array in 0..Tally::ARRAYS {
        for tally in &mut tallies {
            for words in tally.arrays_mut()[array].chunks_mut(BLOCK) {
                let bytes = &mut block[..8 * words.len()];
                opened
                    .file
                    .read_exact(bytes)
                    .map_err(|e| FileError::new("read", path, e))?;
                hasher.update(&*bytes);
                for (word, bytes) in words.iter_mut().zip(bytes.as_chunks().0) {
                    *word = u64::from_le_bytes(*bytes);
                }
            }
        }
    }
    if hex(&hasher.finalize()) != opened.checksum {
        return Err(damaged(path, "its checksum is wrong"));
    }
    Ok((opened.header, tallies))
}

struct Opened {
    file: BufReader<File>,
    header: Header,
    /// The header as it stands in the file.
    text: String,
    checksum: String,
}

fn open(path: &Path) -> Result<Opened, SumsError> {
    let fail = |e| FileError::new("read", path, e);
    let file = File::open(path).map_err(fail)?;
    let size = file.metadata().map_err(fail)?.len();
    let mut file = BufReader::with_capacity(1 << 20, file);
    let mut length = [0; 8];
    let short = |_| damaged(path, "it ends within its header");
    file.read_exact(&mut length).map_err(short)?;
    let length = u64::from_le_bytes(length);
    if length > LONGEST_HEADER || length + 8 > size {
        return Err(damaged(path, "it has no header"));
    }
    let mut head = vec![0; length as usize];
    file.read_exact(&mut head).map_err(short)?;
    let mut map: Map<String, Value> =
        serde_json::from_slice(&head).map_err(|_| damaged(path, "its header is no JSON"))?;
    let metadata = map.remove("__metadata__").unwrap_or_default();
    let text = |key: &str| {
        let found = metadata[key].as_str().map(str::to_owned);
        found.ok_or_else(|| damaged(path, &format!("its header has no text {key:?}")))
    };
    let (text, checksum) = (text("vair")?, text("sha256")?);
    let header: Header = serde_json::from_str(&text)
        .map_err(|e| damaged(path, &format!("its header is of another kind: {e}")))?;
    if header.version != VERSION {
        let what = format!("it is of version {}, not {VERSION}", header.version);
        return Err(damaged(path, &what));
    }
    header.check().map_err(|what| damaged(path, &what))?;
    let (arrays, bytes) = header.arrays();
    // Before memory is set aside: what is claimed is there.
    if map != arrays || size != 8 + length + bytes {
        return Err(damaged(path, "its arrays are not those of its settings"));
    }
    Ok(Opened {
        file,
        header,
        text,
        checksum,
    })
}

fn damaged(path: &Path, what: &str) -> SumsError {
    SumsError::Damaged {
        path: path.to_owned(),
        what: what.to_owned(),
    }
}
