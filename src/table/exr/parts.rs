//! Unicubes of 32-bit floats as parts of a file.

use super::attributes::{Attributes, Value};
use super::headed::Headed;
use super::packed;
use super::raw::{self, RawPart};
use crate::io::{AtomicFile, FileError};
use crate::table::TableError;
use crate::table::check::{MAX_BINS, MAX_LEVELS, MAX_RES, MAX_SAMPLES};
use exr::meta::header::Header;
use exr::prelude::{Compression, FlatSamples, SampleType, Vec2};
use rayon::prelude::*;
use std::borrow::Cow;
use std::path::Path;

/// One part of a table file: a unicube a channel.
#[derive(Clone, Debug)]
pub(super) struct Part<'a> {
    pub(super) name: String,
    pub(super) res: usize,
    pub(super) channels: Vec<(String, Cow<'a, [f32]>)>,
    pub(super) attributes: Attributes,
}

/// Writes a file that holds `parts`.
///
/// ZIP where it gains something. Maps of smooth densities are 32 bits of mantissa noise each: it would
/// take 2 % off their size and most of the time that a first table takes. Maps of holes shrink to a fraction.
pub(super) fn write(parts: Vec<Part<'_>>, path: &Path) -> Result<(), TableError> {
    if !is_smooth(&parts) {
        let bytes = raw::encode(owned(parts), Compression::ZIP16, path)?;
        return Ok(AtomicFile::write_all_to(path, &bytes)?);
    }
    let head = parts.iter().map(head_bytes).sum();
    let mut file = Headed::new(AtomicFile::create(path)?, head);
    raw::write_plain(&parts, &mut file).map_err(|error| match error {
        exr::error::Error::Io(error) => FileError::new("write", path, error).into(),
        other => TableError::Encode {
            path: path.to_owned(),
            reason: other.to_string(),
        },
    })?;
    let file = file.finish();
    Ok(file
        .map_err(|e| FileError::new("write", path, e))?
        .commit()?)
}

/// The bytes of such a file.
#[cfg(test)]
pub(super) fn encode(
    parts: Vec<Part<'_>>,
    compression: Compression,
    path: &Path,
) -> Result<Vec<u8>, TableError> {
    raw::encode(owned(parts), compression, path)
}

/// Bytes of a part's header, at most.
fn head_bytes(part: &Part<'_>) -> usize {
    /// What the format wants of every part, and what stands beside the values and names of the others.
    const OWN: usize = 1024;
    const BESIDE: usize = 64;
    let values = part.attributes.0.iter().map(|(name, value)| match value {
        Value::Text(text) => name.len() + text.len() + BESIDE,
        Value::Int(_) | Value::Double(_) => name.len() + BESIDE,
    });
    let channels = part.channels.iter().map(|(name, _)| name.len() + BESIDE);
    OWN + part.name.len() + values.chain(channels).sum::<usize>()
}

fn is_smooth(parts: &[Part<'_>]) -> bool {
    let counts = parts.par_iter().map(|part| {
        let counts = part.channels.iter().map(|(_, samples)| {
            let zeros = samples.iter().filter(|v| **v == 0.0).count();
            [zeros, samples.len()]
        });
        counts.fold([0; 2], |[a, b], [c, d]| [a + c, b + d])
    });
    let [zeros, all] = counts.reduce(|| [0; 2], |[a, b], [c, d]| [a + c, b + d]);
    2 * zeros < all
}

fn owned(parts: Vec<Part<'_>>) -> Vec<RawPart> {
    let raw = parts.into_iter().map(|part| RawPart {
        name: part.name,
        width: part.res,
        height: 6 * part.res,
        channels: part
            .channels
            .into_iter()
            .map(|(name, samples)| (name, FlatSamples::F32(samples.into_owned())))
            .collect(),
        attributes: part.attributes,
    });
    raw.collect()
}

/// The parts of a file of any kind, after a check of all headers against the limits.
pub(super) fn decode_raw(bytes: &[u8], path: &Path) -> Result<Vec<RawPart>, TableError> {
    raw::decode(bytes, path, |headers| {
        if raw::format(headers) == Some(packed::FORMAT) {
            packed::check_headers(headers)
        } else {
            check_headers(headers)
        }
    })
}

/// The parts of a file that is not packed.
#[cfg(test)]
pub(super) fn decode(bytes: &[u8], path: &Path) -> Result<Vec<Part<'static>>, TableError> {
    let raw = decode_raw(bytes, path)?;
    from_raw(raw).map_err(|e| e.of_file(path))
}

pub(super) fn from_raw(raw: Vec<RawPart>) -> Result<Vec<Part<'static>>, TableError> {
    raw.into_iter().map(part).collect()
}

/// Refuses what no table claims before memory is set aside for it.
fn check_headers(headers: &[Header]) -> Result<(), TableError> {
    let refuse = |what: String| Err(TableError::Inconsistent(what));
    if headers.len() > MAX_BINS {
        return refuse(format!(
            "it has {} parts; {MAX_BINS} are allowed",
            headers.len()
        ));
    }
    let mut samples = 0usize;
    for (i, header) in headers.iter().enumerate() {
        let Vec2(width, height) = header.layer_size;
        if header.deep || width == 0 || width > MAX_RES || height != 6 * width {
            return refuse(format!(
                "part {i} is {width} x {height}; a flat unicube is N x 6N with N up to {MAX_RES}"
            ));
        }
        let channels = header.channels.list.len();
        if channels > MAX_LEVELS + 1 {
            return refuse(format!("part {i} has {channels} channels"));
        }
        for channel in &header.channels.list {
            if channel.sample_type != SampleType::F32 || channel.sampling != Vec2(1, 1) {
                return refuse(format!(
                    "channel {} of part {i} is not 32-bit float",
                    channel.name
                ));
            }
        }
        samples += channels * width * height;
    }
    if samples > MAX_SAMPLES {
        return refuse(format!(
            "it claims {samples} numbers; {MAX_SAMPLES} are allowed"
        ));
    }
    Ok(())
}

fn part(raw: RawPart) -> Result<Part<'static>, TableError> {
    let channels = raw
        .channels
        .into_iter()
        .map(|(name, samples)| match samples {
            FlatSamples::F32(samples) => Ok((name, Cow::Owned(samples))),
            _ => Err(TableError::Inconsistent(format!(
                "channel {name} is not 32-bit float"
            ))),
        });
    Ok(Part {
        name: raw.name,
        res: raw.width,
        channels: channels.collect::<Result<_, _>>()?,
        attributes: raw.attributes,
    })
}
