//! The bytes behind a glTF document: chunks of a .glb, data URIs, files beside it.

use super::document::{Accessor, Document};
use crate::io::read_bounded;
use crate::mesh_file::{MAX_FILE, MeshFileError};
use glam::{Vec2, Vec3};
use std::borrow::Cow;
use std::path::{Component, Path};

/// Component types of the specification, section 3.6.2.2.
const UNSIGNED_BYTE: u64 = 5121;
const UNSIGNED_SHORT: u64 = 5123;
const UNSIGNED_INT: u64 = 5125;
const FLOAT: u64 = 5126;

/// `glTF`, `JSON` and `BIN\0`, little endian.
const MAGIC: u32 = 0x4654_6c67;
const JSON: u32 = 0x4e4f_534a;
const BIN: u32 = 0x004e_4942;

fn invalid(file: &str, place: &str, reason: impl Into<String>) -> MeshFileError {
    MeshFileError::Invalid {
        file: file.to_owned(),
        place: place.to_owned(),
        reason: reason.into(),
    }
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(four.try_into().ok()?))
}

/// JSON text and binary chunk of a file; a file that does not begin as a .glb is all text.
pub(super) fn split<'a>(
    file: &str,
    bytes: &'a [u8],
) -> Result<(&'a [u8], Option<&'a [u8]>), MeshFileError> {
    if word(bytes, 0) != Some(MAGIC) {
        return Ok((bytes, None));
    }
    match word(bytes, 4) {
        Some(2) => {}
        version => {
            let version = version.unwrap_or(0);
            let reason = format!("is of glTF version {version}, only 2 is read");
            return Err(invalid(file, "header", reason));
        }
    }
    let (mut text, mut binary) = (None, None);
    let mut at = 12;
    while let (Some(length), Some(kind)) = (word(bytes, at), word(bytes, at + 4)) {
        let chunk = (at + 8)
            .checked_add(length as usize)
            .and_then(|end| bytes.get(at + 8..end));
        let Some(chunk) = chunk else {
            let reason = format!("announces {length} bytes, the file ends before");
            return Err(invalid(file, &format!("chunk at byte {at}"), reason));
        };
        match kind {
            JSON if text.is_none() => text = Some(chunk),
            BIN if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        at += 8 + length as usize;
    }
    match text {
        Some(text) => Ok((text, binary)),
        None => Err(invalid(file, "header", "has no JSON chunk")),
    }
}

/// Bytes of all buffers of a document.
pub(super) struct Buffers<'a> {
    document: &'a Document,
    bytes: Vec<Cow<'a, [u8]>>,
}

impl<'a> Buffers<'a> {
    pub(super) fn open(
        file: &str,
        document: &'a Document,
        binary: Option<&'a [u8]>,
    ) -> Result<Self, MeshFileError> {
        let mut bytes: Vec<Cow<'a, [u8]>> = Vec::new();
        let mut room = MAX_FILE;
        for (index, buffer) in document.buffers.iter().enumerate() {
            let place = format!("buffer {index}");
            let found = match &buffer.uri {
                None => match binary {
                    Some(binary) if index == 0 => Cow::Borrowed(binary),
                    _ => return Err(invalid(file, &place, "has no bytes in this file")),
                },
                Some(uri) if uri.starts_with("data:") => {
                    Cow::Owned(data_uri(uri).map_err(|e| invalid(file, &place, e))?)
                }
                Some(uri) => {
                    let path = beside(file, uri).map_err(|e| invalid(file, &place, e))?;
                    Cow::Owned(read_bounded(&path, room)?)
                }
            };
            if (found.len() as u64) < buffer.byte_length {
                let reason = format!("has {} bytes of {}", found.len(), buffer.byte_length);
                return Err(invalid(file, &place, reason));
            }
            // Buffers of many files add up to one bounded size.
            room = room.saturating_sub(found.len() as u64);
            bytes.push(found);
        }
        Ok(Self { document, bytes })
    }

    /// Vectors of three floats.
    pub(super) fn positions(&self, accessor: usize) -> Result<Vec<Vec3>, String> {
        let (a, view, stride) = self.view(accessor, "VEC3", 12, |a| a.component_type == FLOAT)?;
        let float = |at: usize| word(view, at).map_or(0.0, f32::from_bits);
        Ok((0..a.count as usize)
            .map(|i| Vec3::from([0, 4, 8].map(|k| float(i * stride + k))))
            .collect())
    }

    /// Texture coordinates, from the upper left corner of a picture: pairs of floats, or of whole numbers of
    /// which the largest means 1.
    pub(super) fn coordinates(&self, accessor: usize) -> Result<Vec<Vec2>, String> {
        let (size, scale) = match self.accessor(accessor)?.component_type {
            UNSIGNED_BYTE => (1, 1.0 / 255.0),
            UNSIGNED_SHORT => (2, 1.0 / 65535.0),
            _ => (4, 1.0),
        };
        let fits = |a: &Accessor| a.component_type == FLOAT || size < 4;
        let (a, view, stride) = self.view(accessor, "VEC2", 2 * size, fits)?;
        let number = |at: usize| match size {
            4 => word(view, at).map_or(0.0, f32::from_bits),
            _ => {
                let bytes = view[at..at + size].iter().rev();
                bytes.fold(0, |n, b| n << 8 | u32::from(*b)) as f32 * scale
            }
        };
        Ok((0..a.count as usize)
            .map(|i| Vec2::new(number(i * stride), number(i * stride + size)))
            .collect())
    }

    /// Vertex indices.
    pub(super) fn indices(&self, accessor: usize) -> Result<Vec<u32>, String> {
        let kind = self.accessor(accessor)?.component_type;
        let size = match kind {
            UNSIGNED_BYTE => 1,
            UNSIGNED_SHORT => 2,
            UNSIGNED_INT => 4,
            _ => {
                return Err(format!(
                    "accessor {accessor}: component type {kind} for indices"
                ));
            }
        };
        let (a, view, stride) = self.view(accessor, "SCALAR", size, |_| true)?;
        let index = |at: usize| {
            let bytes = &view[at..at + size];
            bytes.iter().rev().fold(0, |n, b| n << 8 | u32::from(*b))
        };
        Ok((0..a.count as usize).map(|i| index(i * stride)).collect())
    }

    fn accessor(&self, index: usize) -> Result<&'a Accessor, String> {
        let all = &self.document.accessors;
        all.get(index)
            .ok_or_else(|| format!("refers to accessor {index}, but there are {}", all.len()))
    }

    /// The bytes of an accessor from its first element on, and the way between elements: long enough
    /// for all of them.
    fn view(
        &self,
        index: usize,
        kind: &str,
        size: usize,
        fits: impl Fn(&Accessor) -> bool,
    ) -> Result<(&'a Accessor, &[u8], usize), String> {
        let a = self.accessor(index)?;
        if a.kind != kind || !fits(a) {
            return Err(format!(
                "accessor {index} holds {} of component type {}, expected {kind}",
                a.kind, a.component_type
            ));
        }
        if a.sparse.is_some() {
            return Err(format!("accessor {index} is sparse, which is not read"));
        }
        let views = &self.document.buffer_views;
        let view = a.buffer_view.and_then(|v| views.get(v));
        let Some(view) = view else {
            return Err(format!("accessor {index} has no buffer view"));
        };
        let Some(buffer) = self.bytes.get(view.buffer) else {
            return Err(format!(
                "accessor {index} is in buffer {}, which is missing",
                view.buffer
            ));
        };
        let stride = view.byte_stride.unwrap_or(size as u64).max(size as u64);
        let short = || {
            format!(
                "accessor {index} announces {} elements, more than its buffer holds",
                a.count
            )
        };
        let begin = view.byte_offset.checked_add(a.byte_offset);
        let begin = begin.ok_or_else(short)?;
        let need = match a.count {
            0 => 0,
            count => (count - 1)
                .checked_mul(stride)
                .and_then(|n| n.checked_add(size as u64))
                .ok_or_else(short)?,
        };
        let end = begin.checked_add(need).ok_or_else(short)?;
        let view_end = view.byte_offset.checked_add(view.byte_length);
        if end > buffer.len() as u64 || view_end.is_none_or(|v| end > v) {
            return Err(short());
        }
        Ok((a, &buffer[begin as usize..end as usize], stride as usize))
    }
}

/// The path of a buffer's file: a plain relative one.
fn beside(file: &str, uri: &str) -> Result<std::path::PathBuf, String> {
    let name = percent_decoded(uri);
    let path = Path::new(&name);
    let is_inside = path.components().all(|c| matches!(c, Component::Normal(_)));
    if uri.contains("://") || !is_inside || name.contains('\0') {
        let uri: String = uri.chars().take(80).collect();
        return Err(format!(
            "is at `{uri}`: only files beside this one or in folders below are read"
        ));
    }
    Ok(Path::new(file).with_file_name(path))
}

fn percent_decoded(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        let pair = tail.get(..2).and_then(|p| std::str::from_utf8(p).ok());
        let code = pair.and_then(|p| u8::from_str_radix(p, 16).ok());
        match code {
            Some(code) if first == b'%' => {
                bytes.push(code);
                rest = &tail[2..];
            }
            _ => {
                bytes.push(first);
                rest = tail;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// The bytes of `data:...;base64,...`.
fn data_uri(uri: &str) -> Result<Vec<u8>, String> {
    let Some((_, text)) = uri.split_once(";base64,") else {
        return Err("has a data URI that is not base64".to_owned());
    };
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut buffer, mut bits) = (0u32, 0);
    for c in text.bytes().filter(|c| *c != b'=') {
        let value = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return Err("has a data URI with a character that is not base64".to_owned()),
        };
        buffer = buffer << 6 | u32::from(value);
        bits += 6;
        if bits >= 8 {
            bits -= 8;
            bytes.push((buffer >> bits) as u8);
        }
    }
    Ok(bytes)
}
