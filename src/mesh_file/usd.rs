//! Meshes of a USD layer, with the transforms above them: points, faces and texture coordinates. Normals
//! are not read: of subdivision surfaces there are none.
//!
//! The layer is taken by itself: what it refers to is not followed. What renderers do not show (guides,
//! proxies, invisible prims) is left out.

use super::{MAX_COUNT, MAX_PARTS, MeshFileError, RawMesh};
use crate::usd_file::{self, Prim, Property, Specifier, Value, placed, to_meters};
use glam::{DMat4, DVec3, Vec2};
use std::collections::HashMap;

/// Reads the bytes of a layer. `file` is for messages.
pub(super) fn read(file: &str, bytes: &[u8]) -> Result<RawMesh, MeshFileError> {
    let invalid = |place: String, reason: String| MeshFileError::Invalid {
        file: file.to_owned(),
        place,
        reason,
    };
    let layer = usd_file::parse(bytes).map_err(|e| invalid("as USD".to_owned(), e.to_string()))?;
    let mut reader = Reader {
        file,
        mesh: RawMesh::default(),
        lacks_uv: false,
    };
    for prim in &layer.prims {
        reader.visit(prim, "", to_meters(&layer))?;
    }
    let Reader {
        mut mesh, lacks_uv, ..
    } = reader;
    if mesh.faces == 0 {
        let reason = "there is no Mesh with faces in it; what it refers to is not read";
        return Err(invalid("as USD".to_owned(), reason.to_owned()));
    }
    if lacks_uv {
        mesh.uvs.clear();
    }
    Ok(mesh)
}

struct Reader<'a> {
    file: &'a str,
    mesh: RawMesh,
    lacks_uv: bool,
}

/// Texture coordinates of a mesh.
struct Coordinates<'a> {
    values: &'a [f32],
    indices: Option<&'a [i64]>,
    /// Whether each corner of a face has its own, not each point.
    by_corner: bool,
}

impl Reader<'_> {
    fn visit(&mut self, prim: &Prim, above: &str, outer: DMat4) -> Result<(), MeshFileError> {
        let is_hidden = prim.value("visibility").and_then(Value::text) == Some("invisible");
        let purpose = prim.value("purpose").and_then(Value::text);
        if prim.specifier != Specifier::Def
            || is_hidden
            || matches!(purpose, Some("guide" | "proxy"))
        {
            return Ok(());
        }
        let path = format!("{above}/{}", prim.name);
        let placed = placed(prim, outer).map_err(|reason| self.invalid(&path, reason))?;
        if prim.type_name == "Mesh" {
            self.add(prim, &path, placed)?;
        }
        for child in &prim.children {
            self.visit(child, &path, placed)?;
        }
        Ok(())
    }

    fn invalid(&self, place: &str, reason: String) -> MeshFileError {
        MeshFileError::Invalid {
            file: self.file.to_owned(),
            place: place.to_owned(),
            reason,
        }
    }

    fn add(&mut self, prim: &Prim, path: &str, placed: DMat4) -> Result<(), MeshFileError> {
        let points = floats(prim.value("points"), 3);
        let (counts, indices) = (
            ints(prim, "faceVertexCounts"),
            ints(prim, "faceVertexIndices"),
        );
        let wanted =
            (counts.iter()).try_fold(0i64, |sum, &n| (n >= 3).then(|| sum.saturating_add(n)));
        if wanted != Some(indices.len() as i64) {
            let counted = wanted.map_or_else(
                || "a face has fewer than three corners".to_owned(),
                |n| format!("faces have {n} corners"),
            );
            let reason = format!("{counted}, but there are {} indices", indices.len());
            return Err(self.invalid(path, reason));
        }
        let count = points.len() / 3;
        if let Some(bad) = indices.iter().find(|&&i| !(0..count as i64).contains(&i)) {
            let reason = format!("a face refers to point {bad} of {count}");
            return Err(self.invalid(path, reason));
        }
        let uvs = coordinates(prim);
        self.lacks_uv |= uvs.is_none();
        // Mirrored meshes turn the other way.
        let is_left = prim.value("orientation").and_then(Value::text) == Some("leftHanded");
        let is_turned = is_left != (placed.determinant() < 0.0);
        let part = self.mesh.part_named(path);
        self.limit("parts", self.mesh.names.len(), MAX_PARTS)?;

        let mut vertices: HashMap<(i64, [u32; 2]), u32> = HashMap::new();
        let mut face = Vec::new();
        let mut corner = 0;
        for &count in counts {
            face.clear();
            for _ in 0..count {
                let point = indices[corner];
                let uv = match &uvs {
                    Some(uvs) => uvs.at(corner, point as usize).ok_or_else(|| {
                        let reason = format!("corner {corner} has no texture coordinates");
                        self.invalid(path, reason)
                    })?,
                    None => Vec2::ZERO,
                };
                let next = self.mesh.positions.len() as u32;
                let key = (point, uv.to_array().map(f32::to_bits));
                let vertex = *vertices.entry(key).or_insert(next);
                if vertex == next {
                    let p = &points[3 * point as usize..][..3];
                    let p = DVec3::new(p[0].into(), p[1].into(), p[2].into());
                    self.mesh
                        .positions
                        .push(placed.transform_point3(p).as_vec3());
                    self.mesh.uvs.push(uv);
                }
                face.push(vertex);
                corner += 1;
            }
            if is_turned {
                face.reverse();
            }
            self.mesh.add_polygon(&face, part);
        }
        self.limit("vertices", self.mesh.positions.len(), MAX_COUNT)?;
        self.limit("triangles", self.mesh.triangles.len(), MAX_COUNT)
    }

    fn limit(&self, what: &'static str, count: usize, limit: u64) -> Result<(), MeshFileError> {
        MeshFileError::limit(self.file, what, count, limit)
    }
}

impl Coordinates<'_> {
    /// Of a corner of a face, which is at a point.
    fn at(&self, corner: usize, point: usize) -> Option<Vec2> {
        let element = if self.by_corner { corner } else { point };
        let index = match self.indices {
            Some(indices) => usize::try_from(*indices.get(element)?).ok()?,
            None => element,
        };
        let uv = self.values.get(index.checked_mul(2)?..)?.get(..2)?;
        Some(Vec2::new(uv[0], uv[1])).filter(|uv| uv.is_finite())
    }
}

/// The texture coordinates called `st`, else the first.
fn coordinates(prim: &Prim) -> Option<Coordinates<'_>> {
    let is_uv = |p: &&Property| p.name.starts_with("primvars:") && p.type_name == "texCoord2f[]";
    let property = (prim.property("primvars:st"))
        .filter(is_uv)
        .or_else(|| prim.properties.iter().find(is_uv))?;
    let by_corner = match property.word("interpolation") {
        "faceVarying" => true,
        "vertex" | "varying" => false,
        _ => return None,
    };
    let indices = prim.property(&format!("{}:indices", property.name));
    Some(Coordinates {
        values: floats(property.any_value(), 2),
        indices: indices.and_then(|p| match p.any_value() {
            Some(Value::Ints(indices)) => Some(&indices[..]),
            _ => None,
        }),
        by_corner,
    })
}

fn floats(value: Option<&Value>, wanted: usize) -> &[f32] {
    match value {
        Some(Value::Floats { values, width }) if *width == wanted => values,
        _ => &[],
    }
}

fn ints<'p>(prim: &'p Prim, name: &str) -> &'p [i64] {
    match prim.value(name) {
        Some(Value::Ints(values)) => values,
        _ => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Two squares of a strip, in centimeters with Z up, moved by a meter along Z.
    const STRIP: &str = r#"#usda 1.0
(
    metersPerUnit = 0.01
    upAxis = "Z"
)
def Xform "a"
{
    double3 xformOp:translate = (0, 0, 100)
    uniform token[] xformOpOrder = ["xformOp:translate"]

    def Mesh "strip"
    {
        int[] faceVertexCounts = [4, 4]
        int[] faceVertexIndices = [0, 1, 4, 3, 1, 2, 5, 4]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0), (1, 1, 0), (2, 1, 0)]
        texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (
            interpolation = "faceVarying"
        )
        int[] primvars:st:indices = [0, 1, 2, 3, 0, 1, 2, 3]
    }
}
"#;

    fn normals(mesh: &RawMesh) -> Vec<Vec3> {
        let corners = mesh
            .triangles
            .iter()
            .map(|t| t.map(|v| mesh.positions[v as usize]));
        corners
            .map(|[a, b, c]| (b - a).cross(c - a).normalize())
            .collect()
    }

    #[test]
    fn meshes_are_moved_into_meters_with_y_up() {
        let mesh = read("a.usda", STRIP.as_bytes()).unwrap();
        assert_eq!((mesh.faces, mesh.triangles.len()), (2, 4));
        // Both squares have all of the picture: the points between them are seams.
        assert_eq!(mesh.positions.len(), 8);
        assert_eq!(mesh.uvs[1], Vec2::new(1.0, 0.0));
        assert!(mesh.positions[2].distance(Vec3::new(0.01, 1.0, -0.01)) < 1e-6);
        assert!(normals(&mesh).iter().all(|n| n.distance(Vec3::Y) < 1e-4));
        assert_eq!(mesh.names, ["/a/strip"]);
        let shared = STRIP.replace("[0, 1, 2, 3, 0, 1, 2, 3]", "[0, 1, 2, 3, 1, 0, 3, 2]");
        assert_eq!(
            read("a.usda", shared.as_bytes()).unwrap().positions.len(),
            6
        );
    }

    #[test]
    fn mirrored_and_left_handed_meshes_face_as_they_are_seen() {
        let left =
            "    def Mesh \"strip\"\n    {\n        uniform token orientation = \"leftHanded\"";
        let left = STRIP.replace("    def Mesh \"strip\"\n    {", left);
        let mirrored = STRIP
            .replace(
                "double3 xformOp:translate = (0, 0, 100)",
                "double3 xformOp:scale = (-1, 1, 1)",
            )
            .replace("xformOp:translate", "xformOp:scale");
        for (text, normal) in [(&left, Vec3::NEG_Y), (&mirrored, Vec3::Y)] {
            let mesh = read("a.usda", text.as_bytes()).unwrap();
            assert!(
                normals(&mesh).iter().all(|n| n.distance(normal) < 1e-4),
                "{text}"
            );
        }
    }

    #[test]
    fn what_renderers_do_not_show_is_left_out() {
        for hidden in [
            "token visibility = \"invisible\"",
            "uniform token purpose = \"proxy\"",
        ] {
            let text = STRIP.replace(
                "    double3 xformOp",
                &format!("    {hidden}\n    double3 xformOp"),
            );
            let error = read("a.usda", text.as_bytes()).unwrap_err().to_string();
            assert!(error.contains("there is no Mesh with faces"), "{error}");
        }
    }

    #[test]
    fn meshes_that_do_not_fit_together_are_refused_with_their_path() {
        for (from, to, complaint) in [
            (
                "[4, 4]",
                "[4, 3]",
                "/a/strip: faces have 7 corners, but there are 8 indices",
            ),
            ("[4, 4]", "[4, -4]", "fewer than three corners"),
            (
                "[4, 4]",
                "[4, 9223372036854775807]",
                "faces have 9223372036854775807 corners",
            ),
            ("5, 4]", "6, 4]", "a face refers to point 6 of 6"),
            ("5, 4]", "-1, 4]", "a face refers to point -1 of 6"),
            (
                "0, 1, 2, 3]\n    }",
                "0, 1, 2, 4]\n    }",
                "corner 7 has no texture coordinates",
            ),
            (
                "0, 1, 2, 3]\n    }",
                "0, 1, 2]\n    }",
                "corner 7 has no texture coordinates",
            ),
            (
                "token[] xformOpOrder = [",
                "token[] xformOpOrder = [\"xformOp:shear\", ",
                "`xformOp:shear`",
            ),
        ] {
            assert!(STRIP.contains(from), "{from}");
            let error = read("a.usda", STRIP.replacen(from, to, 1).as_bytes()).unwrap_err();
            assert!(error.to_string().contains(complaint), "{error}");
        }
        assert!(read("a.usda", b"#usda 1.0\ndef Mesh \"m\" (").is_err());
    }
}
