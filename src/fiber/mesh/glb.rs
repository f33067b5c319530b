//! Fiber meshes as binary glTF 2.0, which modeling programs open: one node, mesh and material a part.
//!
//! A unit of the file is a micrometer, so that programs made for meters show it; +Y, up in glTF,
//! points to the tip. Period and units are in `asset.extras`.
//!
//! Layout: Khronos Group, glTF 2.0 Specification, section 4 (GLB).

use super::MeshPart;
use glam::{DVec3, Vec3};
use serde_json::{Value, json};

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;

/// The bytes of a .glb file.
pub(super) fn encode(name: &str, period_um: f64, parts: &[MeshPart]) -> Vec<u8> {
    let mut binary = Vec::new();
    let (mut views, mut accessors) = (Vec::new(), Vec::new());
    let (mut meshes, mut nodes, mut materials) = (Vec::new(), Vec::new(), Vec::new());
    for (index, part) in parts.iter().enumerate() {
        let points: Vec<Vec3> = part.points.iter().map(|&p| upright(p).as_vec3()).collect();
        let begin = binary.len();
        for v in points.iter().flat_map(|p| p.to_array()) {
            binary.extend(v.to_le_bytes());
        }
        views.push(view(begin, binary.len() - begin, ARRAY_BUFFER));
        let lo = points.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let hi = points.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        accessors.push(json!({
            "bufferView": 2 * index, "componentType": FLOAT, "count": points.len(), "type": "VEC3",
            "min": lo.to_array(), "max": hi.to_array(),
        }));
        let begin = binary.len();
        for v in part.triangles.iter().flatten() {
            binary.extend(v.to_le_bytes());
        }
        views.push(view(begin, binary.len() - begin, ELEMENT_ARRAY_BUFFER));
        accessors.push(json!({
            "bufferView": 2 * index + 1, "componentType": UNSIGNED_INT,
            "count": 3 * part.triangles.len(), "type": "SCALAR",
        }));
        meshes.push(json!({
            "name": part.name,
            "primitives": [{
                "attributes": { "POSITION": 2 * index }, "indices": 2 * index + 1, "material": index,
            }],
        }));
        nodes.push(json!({ "name": part.name, "mesh": index }));
        materials.push(json!({
            "name": part.name,
            "pbrMetallicRoughness": {
                "baseColorFactor": color(part.name), "metallicFactor": 0.0, "roughnessFactor": 0.6,
            },
        }));
    }
    let document = json!({
        "asset": {
            "version": "2.0",
            "generator": crate::PROGRAM,
            "extras": { "period_um": period_um, "unit_um": 1.0, "axis": "y" },
        },
        "scene": 0,
        "scenes": [{ "name": name, "nodes": (0..parts.len()).collect::<Vec<_>>() }],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": binary.len() }],
    });
    container(&document, binary)
}

fn view(begin: usize, length: usize, target: u32) -> Value {
    json!({ "buffer": 0, "byteOffset": begin, "byteLength": length, "target": target })
}

/// +Z to +Y, keeping x.
fn upright(p: DVec3) -> DVec3 {
    DVec3::new(p.x, p.z, -p.y)
}

/// So that parts are told apart at first sight.
fn color(part: &str) -> [f32; 4] {
    match part {
        "riser" => [0.55, 0.36, 0.18, 1.0],
        "medulla" => [0.45, 0.30, 0.36, 1.0],
        "void" => [0.62, 0.74, 0.86, 1.0],
        _ => [0.78, 0.62, 0.42, 1.0],
    }
}

/// Header and the two chunks, each padded to words: spaces after the JSON, zeros after the buffer.
fn container(document: &Value, mut binary: Vec<u8>) -> Vec<u8> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let mut bytes = Vec::with_capacity(28 + text.len() + binary.len());
    let total = 28 + text.len() + binary.len();
    bytes.extend(b"glTF");
    for word in [2, total as u32, text.len() as u32] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(text);
    bytes.extend((binary.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(binary);
    bytes
}
