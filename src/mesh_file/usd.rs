//! Meshes of a USD stage, with the transforms above them: points, faces, texture coordinates and normals.
//! Cages of subdivision surfaces become those surfaces.
//!
//! What the file refers to beside it is followed. What renderers do not show (guides, proxies, invisible and
//! inactive prims) is left out.

mod polygons;
mod primvar;
mod stage;
mod surface;
mod unread;

use super::{MAX_COUNT, MAX_PARTS, MeshFileError, RawMesh, Said};
use crate::usd_file::{Prim, Specifier, Value, is_z_up, meters_per_unit, placed, to_meters};
use glam::{DMat4, Vec2, Vec3};
use polygons::Polygons;
use std::collections::HashMap;
use unread::{Reason, Unread};

/// Reads the bytes of a file. `file` is its path: for messages, and to find what lies beside it.
pub(super) fn read(file: &str, bytes: &[u8]) -> Result<RawMesh, MeshFileError> {
    let invalid = |place: String, reason: String| MeshFileError::Invalid {
        file: file.to_owned(),
        place,
        reason,
    };
    let stage =
        stage::open(file, bytes).map_err(|e| invalid("as USD".to_owned(), e.to_string()))?;
    let mut reader = Reader {
        file,
        mesh: RawMesh::default(),
        lacks_uv: false,
        has_normals: false,
        remarks: Vec::new(),
        unread: Unread::default(),
    };
    for prim in &stage.roots {
        reader.visit(prim, "", to_meters(&stage.layer))?;
    }
    reader.remarks.extend(reader.unread.remarks());
    let mut mesh = reader.mesh;
    if mesh.faces == 0 {
        let mut reasons = vec!["there is no Mesh with faces in it".to_owned()];
        reasons.extend(stage.remarks);
        reasons.extend(reader.remarks);
        return Err(invalid("as USD".to_owned(), reasons.join("; ")));
    }
    if reader.lacks_uv {
        mesh.uvs.clear();
    }
    if !reader.has_normals {
        mesh.normals.clear();
    }
    mesh.said = Some(Said {
        unit_m: meters_per_unit(&stage.layer),
        is_z_up: is_z_up(&stage.layer),
    });
    mesh.remarks = stage.remarks;
    mesh.remarks.extend(reader.remarks);
    Ok(mesh)
}

struct Reader<'a> {
    file: &'a str,
    mesh: RawMesh,
    lacks_uv: bool,
    has_normals: bool,
    /// What is not taken, or otherwise than it is meant, a sentence each.
    remarks: Vec<String>,
    unread: Unread,
}

impl Reader<'_> {
    fn visit(&mut self, prim: &Prim, above: &str, outer: DMat4) -> Result<(), MeshFileError> {
        let is_hidden = prim.text("visibility") == Some("invisible");
        let purpose = prim.text("purpose");
        let is_inactive = prim.field("active").and_then(Value::number) == Some(0.0);
        if prim.specifier != Specifier::Def
            || is_hidden
            || is_inactive
            || matches!(purpose, Some("guide" | "proxy"))
        {
            return Ok(());
        }
        let path = format!("{above}/{}", prim.name);
        for reason in Reason::of(prim) {
            self.unread.add(reason, &path);
            if reason == Reason::Instancer {
                // What it multiplies is below it, and shown nowhere else.
                return Ok(());
            }
        }
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
        let cage = Polygons::read(prim, placed).map_err(|reason| self.invalid(path, reason))?;
        let (polygons, remark) = surface::of(prim, cage);
        self.remarks
            .extend(remark.map(|remark| format!("{path} {remark}")));
        self.lacks_uv |= polygons.uvs.is_none();
        self.has_normals |= polygons.normals.is_some();
        // Mirrored meshes turn the other way.
        let is_left = prim.text("orientation") == Some("leftHanded");
        let is_turned = is_left != (placed.determinant() < 0.0);
        let part = self.mesh.part_named(path);
        self.limit("parts", self.mesh.names.len(), MAX_PARTS)?;

        let mut vertices: HashMap<(u32, [u32; 2], [u32; 3]), u32> = HashMap::new();
        let mut face = Vec::new();
        let mut corner = 0;
        for (&count, &is_hole) in polygons.counts.iter().zip(&polygons.is_hole) {
            face.clear();
            for _ in 0..count {
                let point = polygons.corners[corner];
                let uv = polygons.uvs.as_ref().map_or(Vec2::ZERO, |uvs| uvs[corner]);
                let normal = (polygons.normals.as_ref()).map_or(Vec3::ZERO, |n| n[corner]);
                let next = self.mesh.positions.len() as u32;
                let bits = (
                    uv.to_array().map(f32::to_bits),
                    normal.to_array().map(f32::to_bits),
                );
                let vertex = *vertices.entry((point, bits.0, bits.1)).or_insert(next);
                if vertex == next {
                    let position = polygons.points[point as usize];
                    self.mesh.positions.push(position.as_vec3());
                    self.mesh.uvs.push(uv);
                    self.mesh.normals.push(normal);
                }
                face.push(vertex);
                corner += 1;
            }
            if is_hole {
                continue;
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

#[cfg(test)]
mod tests {
    use super::*;

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
        uniform token subdivisionScheme = "none"
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
    fn normals_are_those_of_polygons_and_turn_with_them() {
        let text = STRIP
            .replace(
                "def Mesh \"strip\"\n    {",
                "def Mesh \"strip\"\n    {\n        \
                 normal3f[] normals = [(0, 0, 1), (0, 0, 1), (3, 0, 4), (0, 0, 1), (0, 0, 1), (3, 0, 4)]",
            )
            .replace("xformOp:translate = (0, 0, 100)", "xformOp:scale = (0.5, 1, 1)")
            .replace("xformOp:translate", "xformOp:scale");
        let mesh = read("a.usda", text.as_bytes()).unwrap();
        assert_eq!(mesh.normals.len(), mesh.positions.len());
        let right = mesh.positions.iter().position(|p| p.x > 0.009).unwrap();
        let (expected, left) = (Vec3::new(6.0, 4.0, 0.0).normalize(), mesh.normals[0]);
        assert!(
            mesh.normals[right].distance(expected) < 1e-5,
            "{:?}",
            mesh.normals
        );
        assert!(left.distance(Vec3::Y) < 1e-5, "{left}");

        let corners = text.replace(
            "(3, 0, 4)]",
            "(3, 0, 4), (0, 0, 1), (0, 1, 0)] (\n interpolation = \"faceVarying\"\n)",
        );
        assert!(corners.contains("faceVarying\"\n)\n"), "{corners}");
        let mesh = read("a.usda", corners.as_bytes()).unwrap();
        assert!(
            mesh.normals.iter().any(|n| n.distance(Vec3::NEG_Z) < 1e-5),
            "{:?}",
            mesh.normals
        );

        // A subdivision surface has those of its limit.
        let smooth = text.replace("\"none\"", "\"catmullClark\"");
        assert!(
            read("a.usda", smooth.as_bytes())
                .unwrap()
                .normals
                .is_empty()
        );
        let short = text.replace(", (3, 0, 4)]", "]");
        let error = read("a.usda", short.as_bytes()).unwrap_err().to_string();
        assert!(
            error.contains("/a/strip: corner 6 has no normal"),
            "{error}"
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
    fn what_is_shown_but_not_read_is_named() {
        let shapes = format!(
            "{STRIP}\ndef Sphere \"ball\"\n{{\n}}\ndef \"other\" (\n    inherits = </a>\n)\n{{\n}}\n\
             def PointInstancer \"many\"\n{{\n    def Mesh \"one\"\n    {{\n    }}\n}}\n"
        );
        let mesh = read("a.usda", shapes.as_bytes()).unwrap();
        assert_eq!(mesh.faces, 2);
        let named = [
            "/ball is a Sphere",
            "what /other inherits",
            "/many is a PointInstancer",
        ];
        assert_eq!(mesh.remarks.len(), named.len(), "{:?}", mesh.remarks);
        for (remark, name) in mesh.remarks.iter().zip(named) {
            assert!(remark.starts_with(name), "{remark}");
        }
        // Many of a kind are one remark.
        let more = format!("{shapes}def Sphere \"other_ball\"\n{{\n}}\n");
        let mesh = read("a.usda", more.as_bytes()).unwrap();
        assert!(mesh.remarks[0].starts_with("/ball (and 1 more) is a Sphere"));
        assert_eq!(mesh.remarks.len(), named.len());
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
