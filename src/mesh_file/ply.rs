//! Stanford PLY, ASCII and binary: element `vertex` (x y z, optional nx ny nz, s t or u v) and
//! element `face` (list `vertex_indices` or `vertex_index`); other elements are read over. A face property
//! `part` counts parts, which comments `part 0 cuticle` name.

use super::{MAX_COUNT, MAX_PARTS, MeshFileError, RawMesh};
use glam::{Vec2, Vec3};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};
use std::io::Cursor;

/// Reads the bytes of a PLY file. `file` is for messages.
pub(super) fn read(file: &str, bytes: &[u8]) -> Result<RawMesh, MeshFileError> {
    let fail = |error: ParseError| MeshFileError::Invalid {
        file: file.to_owned(),
        place: error.line().map_or_else(
            || "header or data".to_owned(),
            |line| format!("line {line}"),
        ),
        reason: one_line(&error.to_string()),
    };
    let parser = Parser::<Row>::new();
    let mut reader = Reader::new(Cursor::new(bytes));
    let header = parser.read_header(&mut reader).map_err(fail)?;
    let mut room = bytes.len() as u64 - reader.get_ref().position().min(bytes.len() as u64);
    for element in header.elements.values() {
        // Nothing is allocated for a count before the file is known to be long enough for it.
        let least = element.count as u64;
        let per_element = smallest(element, header.encoding);
        let limit = MAX_COUNT.min(room / per_element);
        if least > limit {
            return Err(MeshFileError::TooLarge {
                file: file.to_owned(),
                what: match element.name.as_str() {
                    "vertex" => "vertices",
                    "face" => "faces",
                    _ => "elements",
                },
                count: least,
                limit,
            });
        }
        room -= least * per_element;
    }

    let mut mesh = RawMesh {
        names: part_names(&header.comments),
        ..RawMesh::default()
    };
    let (mut has_normals, mut has_uvs) = (false, false);
    for element in header.elements.values() {
        let has = |name: &str| element.properties.contains_key(name);
        let rows = parser
            .read_payload_for_element(&mut reader, element, &header)
            .map_err(|error| named(file, element, fail(error)))?;
        match element.name.as_str() {
            "vertex" => {
                for axis in ["x", "y", "z"] {
                    if !has(axis) {
                        return Err(MeshFileError::Invalid {
                            file: file.to_owned(),
                            place: "header".to_owned(),
                            reason: format!("element `vertex` has no property `{axis}`"),
                        });
                    }
                }
                has_normals = has("nx") && has("ny") && has("nz");
                has_uvs = (has("s") && has("t")) || (has("u") && has("v"));
                for row in &rows {
                    let [x, y, z, nx, ny, nz, u, v] = row.numbers;
                    mesh.positions.push(Vec3::new(x, y, z));
                    mesh.normals.push(Vec3::new(nx, ny, nz));
                    mesh.uvs.push(Vec2::new(u, v));
                }
            }
            "face" => {
                for row in &rows {
                    add_face(file, &mut mesh, row)?;
                }
            }
            _ => {}
        }
    }
    if !has_normals {
        mesh.normals.clear();
    }
    if !has_uvs {
        mesh.uvs.clear();
    }
    Ok(mesh)
}

fn add_face(file: &str, mesh: &mut RawMesh, row: &Row) -> Result<(), MeshFileError> {
    let invalid = |reason: String| MeshFileError::Invalid {
        file: file.to_owned(),
        place: format!("face {}", mesh.faces),
        reason,
    };
    let corners: Result<Vec<u32>, i64> = row
        .corners
        .iter()
        .map(|&corner| u32::try_from(corner).map_err(|_| corner))
        .collect();
    let corners = corners.map_err(|c| invalid(format!("refers to vertex index {c}")))?;
    if corners.len() < 3 {
        return Err(invalid(format!(
            "has {} corners: at least 3 are needed",
            corners.len()
        )));
    }
    if (mesh.triangles.len() + corners.len()) as u64 > MAX_COUNT {
        return Err(MeshFileError::TooLarge {
            file: file.to_owned(),
            what: "triangles",
            count: (mesh.triangles.len() + corners.len()) as u64,
            limit: MAX_COUNT,
        });
    }
    if mesh.names.is_empty() {
        mesh.names.push(String::new());
    }
    let part = u32::try_from(row.part)
        .ok()
        .filter(|p| (*p as usize) < mesh.names.len());
    let Some(part) = part else {
        let reason = format!("belongs to part {}, which no comment names", row.part);
        return Err(invalid(reason));
    };
    mesh.add_polygon(&corners, part);
    Ok(())
}

/// The names in comments `part 0 cuticle`, in order from 0.
fn part_names(comments: &[String]) -> Vec<String> {
    let mut names = Vec::new();
    for comment in comments {
        let mut words = comment.split_ascii_whitespace();
        let is_next = words.next() == Some("part")
            && words.next().and_then(|n| n.parse().ok()) == Some(names.len());
        if is_next
            && (names.len() as u64) < MAX_PARTS
            && let Some(name) = words.next()
        {
            names.push(name.chars().take(100).collect());
        }
    }
    names
}

/// Bytes that an element takes at least, never 0.
fn smallest(element: &ElementDef, encoding: Encoding) -> u64 {
    let size = |scalar: &ScalarType| match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    };
    let properties = element.properties.values();
    let sum: u64 = match encoding {
        // A digit and a separator, the last of which the end of the file may stand in for.
        Encoding::Ascii => properties.count() as u64 * 2 - u64::from(element.count == 1),
        _ => properties
            .map(|p| match &p.data_type {
                PropertyType::Scalar(scalar) => size(scalar),
                PropertyType::List(count, _) => size(count),
            })
            .sum(),
    };
    sum.max(1)
}

/// Says which element was being read.
fn named(file: &str, element: &ElementDef, error: MeshFileError) -> MeshFileError {
    match error {
        MeshFileError::Invalid { place, reason, .. } => MeshFileError::Invalid {
            file: file.to_owned(),
            place: format!("element `{}`, {place}", element.name),
            reason,
        },
        other => other,
    }
}

/// The reader's message without what the place says already and without its grammar.
fn one_line(text: &str) -> String {
    let text = text.split("\tError:").next().unwrap_or(text);
    let text = match text.split_once(": ") {
        Some((line, rest)) if line.starts_with("Line ") => rest,
        _ => text,
    };
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ").chars().take(200).collect()
}

/// One vertex or face.
#[derive(Default)]
struct Row {
    /// x y z nx ny nz u v.
    numbers: [f32; 8],
    corners: Vec<i64>,
    part: i64,
}

impl PropertyAccess for Row {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let slot = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            "nx" => 3,
            "ny" => 4,
            "nz" => 5,
            "s" | "u" => 6,
            "t" | "v" => 7,
            "part" => {
                // Numbers beyond are told apart from every part just as well.
                self.part = property.to_f32_lossy().map_or(-1, |value| value as i64);
                return PropertyAccessResult::Set;
            }
            "vertex_indices" | "vertex_index" => {
                let Some(corners) = indices(property) else {
                    return PropertyAccessResult::UnsupportedType;
                };
                self.corners = corners;
                return PropertyAccessResult::Set;
            }
            _ => return PropertyAccessResult::Ignored,
        };
        match property.to_f32_lossy() {
            Some(value) => {
                self.numbers[slot] = value;
                PropertyAccessResult::Set
            }
            None => PropertyAccessResult::UnsupportedType,
        }
    }
}

fn indices(property: Property) -> Option<Vec<i64>> {
    fn wide<T: Into<i64>>(list: Vec<T>) -> Option<Vec<i64>> {
        Some(list.into_iter().map(Into::into).collect())
    }
    match property {
        Property::ListChar(list) => wide(list),
        Property::ListUChar(list) => wide(list),
        Property::ListShort(list) => wide(list),
        Property::ListUShort(list) => wide(list),
        Property::ListInt(list) => wide(list),
        Property::ListUInt(list) => wide(list),
        _ => None,
    }
}
