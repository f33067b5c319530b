//! Wavefront OBJ: `v`, `vt`, `vn`, `f`, and the names of `o` and `g`; everything else (materials,
//! lines) is passed over. Read line by line here so that every refusal can name its line.

use super::{MAX_COUNT, MAX_PARTS, MeshFileError, Places, RawMesh};
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// Reads the text of an OBJ file. `file` is for messages.
pub(super) fn read(file: &str, bytes: &[u8]) -> Result<RawMesh, MeshFileError> {
    let mut reader = Reader {
        file,
        ..Reader::default()
    };
    for (number, line) in bytes.split(|&b| b == b'\n').enumerate() {
        reader.line = number + 1;
        // Comments and names may be in any encoding; numbers are ASCII.
        reader.take(&String::from_utf8_lossy(line))?;
    }
    let Reader {
        mut mesh,
        corner_lines,
        face_lines,
        lacks_normal,
        lacks_uv,
        ..
    } = reader;
    if lacks_normal {
        mesh.normals.clear();
    }
    if lacks_uv {
        mesh.uvs.clear();
    }
    mesh.places = Places::Lines {
        vertex: corner_lines,
        face: face_lines,
    };
    Ok(mesh)
}

#[derive(Default)]
struct Reader<'a> {
    file: &'a str,
    line: usize,
    positions: Vec<(Vec3, usize)>,
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
    /// Corners that share position, uv and normal are one vertex.
    vertices: HashMap<[usize; 3], u32>,
    mesh: RawMesh,
    /// Line of the position of each vertex.
    corner_lines: Vec<usize>,
    face_lines: Vec<usize>,
    lacks_normal: bool,
    lacks_uv: bool,
    /// Part that faces belong to, and the name of the one that begins with the next face.
    part: u32,
    pending: Option<String>,
}

/// A missing texture coordinate or normal.
const NONE: usize = usize::MAX;

impl Reader<'_> {
    fn error(&self, reason: String) -> MeshFileError {
        MeshFileError::Invalid {
            file: self.file.to_owned(),
            place: format!("line {}", self.line),
            reason,
        }
    }

    fn take(&mut self, line: &str) -> Result<(), MeshFileError> {
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                let [x, y, z] = self.numbers(words, "v")?;
                let position = Vec3::new(x, y, z);
                if !position.is_finite() {
                    let number = self.positions.len() + 1;
                    return Err(
                        self.error(format!("vertex {number} is ({x}, {y}, {z}): not finite"))
                    );
                }
                self.positions.push((position, self.line));
                self.limit("vertices", self.positions.len(), MAX_COUNT)
            }
            Some("vt") => {
                // One number is legal; a missing second one is 0.
                let [u, v] = self.numbers(words.chain(["0"]), "vt")?;
                self.uvs.push(Vec2::new(u, v));
                self.limit("texture coordinates", self.uvs.len(), MAX_COUNT)
            }
            Some("vn") => {
                let [x, y, z] = self.numbers(words, "vn")?;
                self.normals.push(Vec3::new(x, y, z));
                self.limit("normals", self.normals.len(), MAX_COUNT)
            }
            Some("f") => self.face(words),
            // Groups of several names belong to the first.
            Some("o" | "g") => {
                self.pending = words.next().map(clip);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn limit(&self, what: &'static str, count: usize, limit: u64) -> Result<(), MeshFileError> {
        MeshFileError::limit(self.file, what, count, limit)
    }

    fn numbers<'w, const N: usize>(
        &self,
        mut words: impl Iterator<Item = &'w str>,
        what: &str,
    ) -> Result<[f32; N], MeshFileError> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            let word = words
                .next()
                .ok_or_else(|| self.error(format!("`{what}` needs {N} numbers")))?;
            *number = word
                .parse()
                .map_err(|_| self.error(format!("`{}` is not a number", clip(word))))?;
        }
        Ok(numbers)
    }

    fn face<'w>(&mut self, words: impl Iterator<Item = &'w str>) -> Result<(), MeshFileError> {
        let mut corners = Vec::new();
        for word in words {
            let corner = self.corner(word)?;
            corners.push(corner);
        }
        if corners.len() < 3 {
            let count = corners.len();
            return Err(self.error(format!("a face of {count} corners: at least 3 are needed")));
        }
        if let Some(name) = self.pending.take() {
            self.part = self.mesh.part_named(&name);
        } else if self.mesh.names.is_empty() {
            self.part = self.mesh.part_named("");
        }
        self.limit("parts", self.mesh.names.len(), MAX_PARTS)?;
        self.mesh.add_polygon(&corners, self.part);
        self.face_lines.push(self.line);
        self.limit("triangles", self.mesh.triangles.len(), MAX_COUNT)
    }

    /// `position`, `position/uv`, `position//normal` or `position/uv/normal`.
    fn corner(&mut self, word: &str) -> Result<u32, MeshFileError> {
        let mut parts = word.split('/');
        let position = self.index(parts.next(), word, "vertex", self.positions.len())?;
        let uv = self.index(parts.next(), word, "texture coordinate", self.uvs.len())?;
        let normal = self.index(parts.next(), word, "normal", self.normals.len())?;
        if position == NONE || parts.next().is_some() {
            return Err(self.error(format!("`{}` is not a face corner", clip(word))));
        }
        self.lacks_uv |= uv == NONE;
        self.lacks_normal |= normal == NONE;
        let next = self.mesh.positions.len() as u32;
        let key = [position, uv, normal];
        let vertex = *self.vertices.entry(key).or_insert(next);
        if vertex == next {
            let (point, line) = self.positions[position];
            self.mesh.positions.push(point);
            self.corner_lines.push(line);
            let at = |i: usize| self.uvs.get(i).copied().unwrap_or_default();
            self.mesh.uvs.push(at(uv));
            let at = |i: usize| self.normals.get(i).copied().unwrap_or_default();
            self.mesh.normals.push(at(normal));
        }
        Ok(vertex)
    }

    /// Indices count from 1; negative ones count back from the last line read.
    fn index(
        &self,
        text: Option<&str>,
        word: &str,
        what: &str,
        count: usize,
    ) -> Result<usize, MeshFileError> {
        let Some(text) = text.filter(|t| !t.is_empty()) else {
            return Ok(NONE);
        };
        let number: i64 = text
            .parse()
            .map_err(|_| self.error(format!("`{}` is not a face corner", clip(word))))?;
        let index = if number < 0 {
            count as i64 + number
        } else {
            number - 1
        };
        if (0..count as i64).contains(&index) {
            return Ok(index as usize);
        }
        Err(self.error(format!(
            "face refers to {what} {number}, but {count} have been defined so far"
        )))
    }
}

/// The beginning of a word, for messages.
fn clip(word: &str) -> String {
    word.chars().take(40).collect()
}
