//! glTF: all strands as lines of one mesh. glTF has no curves and no widths. Strips would be a primitive
//! each, and so a draw call each; pairs of indices make one primitive of all strands.

use super::{Lines, WriteError, put_floats};
use glam::Vec3;
use serde_json::json;
use std::io::Write;

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
/// Mode of pairs of points.
const LINES: u32 = 1;

pub(super) fn write(out: &mut impl Write, lines: &Lines<'_>) -> Result<(), WriteError> {
    let points = lines.points.len() as u64;
    let segments = points - lines.strands() as u64;
    let colored = !lines.colors.is_empty();
    // Positions, indices, colors.
    let sizes = [
        12 * points,
        8 * segments,
        if colored { 12 * points } else { 0 },
    ];
    let size: u64 = sizes.iter().sum();
    if size + (1 << 16) > u64::from(u32::MAX) {
        return Err(WriteError::Format(
            "it would be larger than 4 GB, the most of a .glb",
        ));
    }
    let bounds = |pick: fn(Vec3, Vec3) -> Vec3| {
        let all = lines.points.iter().copied();
        all.reduce(pick).unwrap_or_default().to_array()
    };
    let (lo, hi) = (bounds(Vec3::min), bounds(Vec3::max));
    let view = |offset: u64, length: u64, target: u32| json!({ "buffer": 0, "byteOffset": offset, "byteLength": length, "target": target });
    let mut views = vec![
        view(0, sizes[0], ARRAY_BUFFER),
        view(sizes[0], sizes[1], ELEMENT_ARRAY_BUFFER),
    ];
    let mut accessors = vec![
        json!({ "bufferView": 0, "componentType": FLOAT, "count": points, "type": "VEC3", "min": lo, "max": hi }),
        json!({ "bufferView": 1, "componentType": UNSIGNED_INT, "count": 2 * segments, "type": "SCALAR" }),
    ];
    let mut attributes = json!({ "POSITION": 0 });
    if colored {
        views.push(view(sizes[0] + sizes[1], sizes[2], ARRAY_BUFFER));
        accessors.push(
            json!({ "bufferView": 2, "componentType": FLOAT, "count": points, "type": "VEC3" }),
        );
        attributes["COLOR_0"] = json!(2);
    }
    let document = json!({
        "asset": { "version": "2.0", "generator": crate::PROGRAM },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": "strands", "extras": { "origin": lines.origin } }],
        "meshes": [{ "primitives": [{ "attributes": attributes, "indices": 1, "mode": LINES }] }],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": size }],
    });
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + text.len() as u64 + 8 + size;
    out.write_all(b"glTF")?;
    for word in [2, total as u32, text.len() as u32] {
        out.write_all(&word.to_le_bytes())?;
    }
    out.write_all(b"JSON")?;
    out.write_all(&text)?;
    out.write_all(&(size as u32).to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    put_floats(out, lines.points.iter().flat_map(|p| p.to_array()))?;
    for strand in 0..lines.strands() {
        let range = lines.range(strand);
        let pairs = range.start..range.end.saturating_sub(1);
        let indices = pairs.flat_map(|i| [i as u32, i as u32 + 1]);
        let bytes: Vec<u8> = indices.flat_map(u32::to_le_bytes).collect();
        out.write_all(&bytes)?;
    }
    // Readers multiply what is beyond 0 .. 1 as they like.
    let colors = lines.colors.iter().map(|c| c.clamp(Vec3::ZERO, Vec3::ONE));
    put_floats(out, colors.flat_map(|c| c.to_array()))?;
    Ok(())
}
