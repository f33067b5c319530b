//! glTF 2.0, text (.gltf) and binary (.glb): triangles of the meshes in the scene, placed by the
//! transforms of their nodes. Parts are named by node, else by mesh. Buffers may be in the file or
//! beside it. Texture coordinates are the first set. Materials, skins and animations are passed over.
//!
//! Members and formulas: Khronos Group, glTF 2.0 Specification, sections 3 (concepts) and 4 (GLB).

mod buffers;
mod document;

use super::{MAX_COUNT, MAX_PARTS, MeshFileError, RawMesh};
use buffers::Buffers;
use document::{Document, Node, Primitive};
use glam::{Mat4, Quat, Vec2, Vec3};

/// Deepest tree of nodes; also what ends a tree that bites its tail.
const MAX_DEPTH: usize = 64;
/// Most nodes visited, meshes used repeatedly included.
const MAX_NODES: usize = 100_000;

/// Triangle lists, the only mode that is read.
const TRIANGLES: u64 = 4;

/// Reads the bytes of a glTF file. `file` is its path.
pub(super) fn read(file: &str, bytes: &[u8]) -> Result<RawMesh, MeshFileError> {
    let (text, binary) = buffers::split(file, bytes)?;
    let document: Document = serde_json::from_slice(text).map_err(|e| MeshFileError::Invalid {
        file: file.to_owned(),
        place: format!("JSON line {} column {}", e.line(), e.column()),
        reason: e.to_string().chars().take(200).collect(),
    })?;
    let buffers = Buffers::open(file, &document, binary)?;
    let mut reader = Reader {
        file,
        document: &document,
        buffers,
        mesh: RawMesh::default(),
        visited: 0,
        lacks_uv: false,
    };
    reader.scene()?;
    if reader.lacks_uv {
        reader.mesh.uvs.clear();
    }
    Ok(reader.mesh)
}

struct Reader<'a> {
    file: &'a str,
    document: &'a Document,
    buffers: Buffers<'a>,
    mesh: RawMesh,
    visited: usize,
    /// Whether a mesh has no texture coordinates.
    lacks_uv: bool,
}

impl Reader<'_> {
    fn invalid(&self, place: String, reason: impl Into<String>) -> MeshFileError {
        MeshFileError::Invalid {
            file: self.file.to_owned(),
            place,
            reason: reason.into(),
        }
    }

    fn scene(&mut self) -> Result<(), MeshFileError> {
        let document = self.document;
        if let Some(name) = (document.extensions_required.iter()).find(|name| hides_geometry(name))
        {
            let reason = format!("needs the extension {name}: export without compression");
            return Err(self.invalid("extensionsRequired".to_owned(), reason));
        }
        let scene = document.scenes.get(document.scene.unwrap_or(0));
        let roots: Vec<usize> = match scene {
            Some(scene) => scene.nodes.clone(),
            // A file without scenes shows all nodes that are nobody's child.
            None => {
                let mut is_child = vec![false; document.nodes.len()];
                for &child in document.nodes.iter().flat_map(|n| &n.children) {
                    if let Some(slot) = is_child.get_mut(child) {
                        *slot = true;
                    }
                }
                (0..is_child.len()).filter(|&i| !is_child[i]).collect()
            }
        };
        for root in roots {
            self.node(root, Mat4::IDENTITY, 0)?;
        }
        Ok(())
    }

    fn node(&mut self, index: usize, parent: Mat4, depth: usize) -> Result<(), MeshFileError> {
        let document = self.document;
        let place = || format!("node {index}");
        let Some(node) = document.nodes.get(index) else {
            let reason = format!("referred to, but there are {}", document.nodes.len());
            return Err(self.invalid(place(), reason));
        };
        self.visited += 1;
        if depth > MAX_DEPTH || self.visited > MAX_NODES {
            return Err(self.invalid(
                place(),
                "nodes nest too deeply: probably a node is its own descendant",
            ));
        }
        let transform = parent * local_transform(node);
        if let Some(mesh) = node.mesh {
            let Some(mesh) = document.meshes.get(mesh) else {
                let reason = format!(
                    "refers to mesh {mesh}, but there are {}",
                    document.meshes.len()
                );
                return Err(self.invalid(place(), reason));
            };
            let name = node.name.as_ref().or(mesh.name.as_ref());
            let name: String = name.map_or("", |n| n.as_str()).chars().take(100).collect();
            let part = self.mesh.part_named(&name);
            if self.mesh.names.len() as u64 > MAX_PARTS {
                return Err(self.too_large("parts", self.mesh.names.len() as u64, MAX_PARTS));
            }
            for (i, primitive) in mesh.primitives.iter().enumerate() {
                let place = format!("node {index} ({name}), primitive {i}");
                self.primitive(primitive, transform, part, &place)?;
            }
        }
        for &child in &node.children {
            self.node(child, transform, depth + 1)?;
        }
        Ok(())
    }

    fn too_large(&self, what: &'static str, count: u64, limit: u64) -> MeshFileError {
        MeshFileError::TooLarge {
            file: self.file.to_owned(),
            what,
            count,
            limit,
        }
    }

    fn primitive(
        &mut self,
        primitive: &Primitive,
        transform: Mat4,
        part: u32,
        place: &str,
    ) -> Result<(), MeshFileError> {
        let mode = primitive.mode.unwrap_or(TRIANGLES);
        if mode < TRIANGLES {
            // Points and lines have no area.
            return Ok(());
        }
        let named = |e: String| self.invalid(place.to_owned(), e);
        if mode != TRIANGLES {
            return Err(named(format!(
                "is of mode {mode}: only triangle lists (4) are read, export triangulated"
            )));
        }
        let Some(&accessor) = primitive.attributes.get("POSITION") else {
            return Ok(());
        };
        let corners = self.buffers.positions(accessor).map_err(named)?;
        let indices = match primitive.indices {
            Some(accessor) => self.buffers.indices(accessor).map_err(named)?,
            None => (0..corners.len() as u32).collect(),
        };
        if indices.len() % 3 != 0 {
            let reason = format!("has {} indices, no multiple of 3", indices.len());
            return Err(named(reason));
        }
        let vertices = (self.mesh.positions.len() + corners.len()) as u64;
        let triangles = (self.mesh.triangles.len() + indices.len() / 3) as u64;
        if vertices > MAX_COUNT || triangles > MAX_COUNT {
            return Err(self.too_large("vertices", vertices.max(triangles), MAX_COUNT));
        }
        if let Some(bad) = indices.iter().find(|&&i| i as usize >= corners.len()) {
            let reason = format!("refers to vertex {bad}, but there are {}", corners.len());
            return Err(named(reason));
        }
        if let Some(i) = corners.iter().position(|p| !p.is_finite()) {
            let p = corners[i];
            let reason = format!("vertex {i} is ({}, {}, {}): not finite", p.x, p.y, p.z);
            return Err(named(reason));
        }
        match primitive.attributes.get("TEXCOORD_0") {
            None => self.lacks_uv = true,
            Some(&accessor) => {
                let uvs = self.buffers.coordinates(accessor).map_err(named)?;
                if uvs.len() != corners.len() || !uvs.iter().all(|uv| uv.is_finite()) {
                    let (found, wanted) = (uvs.len(), corners.len());
                    let reason = format!(
                        "has {found} texture coordinates for {wanted} vertices, or some that are not finite"
                    );
                    return Err(named(reason));
                }
                // Elsewhere pictures begin at their lower left corner.
                let uvs = uvs.iter().map(|uv| Vec2::new(uv.x, 1.0 - uv.y));
                self.mesh.uvs.extend(uvs);
            }
        }
        let base = self.mesh.positions.len() as u32;
        let placed = corners.iter().map(|&p| transform.transform_point3(p));
        self.mesh.positions.extend(placed);
        // A mirroring transform turns triangles inside out (specification, section 3.7.4).
        let mirrored = transform.determinant() < 0.0;
        for t in indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| i + base);
            let corners = if mirrored { [a, c, b] } else { [a, b, c] };
            self.mesh.add_polygon(&corners, part);
        }
        Ok(())
    }
}

/// Extensions without which positions cannot be read.
fn hides_geometry(name: &str) -> bool {
    matches!(
        name,
        "KHR_draco_mesh_compression" | "EXT_meshopt_compression" | "KHR_mesh_quantization"
    )
}

fn local_transform(node: &Node) -> Mat4 {
    if let Some(matrix) = &node.matrix {
        return Mat4::from_cols_array(matrix);
    }
    let scale = node.scale.map_or(Vec3::ONE, Vec3::from);
    let rotation = node.rotation.map_or(Quat::IDENTITY, Quat::from_array);
    let rotation = if rotation.length_squared() > 0.0 {
        rotation.normalize()
    } else {
        Quat::IDENTITY
    };
    let translation = node.translation.map_or(Vec3::ZERO, Vec3::from);
    Mat4::from_scale_rotation_translation(scale, rotation, translation)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle with texture coordinates of one kind, as bytes in hexadecimal.
    fn triangle(component: u32, uvs: &[u8]) -> Result<RawMesh, MeshFileError> {
        let floats = [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        let bytes: Vec<u8> = floats.iter().flat_map(|x| x.to_le_bytes()).collect();
        let bytes = [&bytes, uvs].concat();
        let text = format!(
            r#"{{"asset": {{"version": "2.0"}}, "nodes": [{{"mesh": 0}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "TEXCOORD_0": 1}}}}]}}],
            "accessors": [
                {{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}},
                {{"bufferView": 1, "componentType": {component}, "normalized": true, "count": 3, "type": "VEC2"}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 36}},
                {{"buffer": 0, "byteOffset": 36, "byteLength": {}}}],
            "buffers": [{{"byteLength": {}}}]}}"#,
            uvs.len(),
            bytes.len(),
        );
        let pad = |bytes: &[u8]| [bytes, &b"   "[..bytes.len().wrapping_neg() % 4]].concat();
        let chunk = |kind: &[u8; 4], bytes: &[u8]| {
            [&(bytes.len() as u32).to_le_bytes()[..], kind, bytes].concat()
        };
        let chunks = [
            chunk(b"JSON", &pad(text.as_bytes())),
            chunk(b"BIN\0", &pad(&bytes)),
        ]
        .concat();
        let length = 12 + chunks.len() as u32;
        let header = [*b"glTF", 2u32.to_le_bytes(), length.to_le_bytes()].concat();
        read("a.glb", &[header, chunks].concat())
    }

    /// They go down in glTF and up in all other files.
    #[test]
    fn texture_coordinates_are_read_and_turned_up() {
        let floats = [0f32, 0.25, 1.0, 0.0, 0.5, 1.0];
        let floats: Vec<u8> = floats.iter().flat_map(|x| x.to_le_bytes()).collect();
        let expected = [
            Vec2::new(0.0, 0.75),
            Vec2::new(1.0, 1.0),
            Vec2::new(0.5, 0.0),
        ];
        assert_eq!(triangle(5126, &floats).unwrap().uvs, expected);
        let bytes = triangle(5121, &[0, 51, 255, 0, 102, 255]).unwrap().uvs;
        assert!(
            bytes[0].distance(Vec2::new(0.0, 0.8)) < 1e-6 && bytes[2].y == 0.0,
            "{bytes:?}"
        );
        let shorts = triangle(5123, &[0, 0, 255, 255, 0, 0, 0, 0, 0, 0, 0, 0])
            .unwrap()
            .uvs;
        assert_eq!(shorts[..2], [Vec2::ZERO, Vec2::Y]);
        let error = triangle(5125, &floats).unwrap_err().to_string();
        assert!(error.contains("component type 5125"), "{error}");
    }
}
