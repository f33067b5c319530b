//! Fiber meshes as Wavefront OBJ and as PLY. Micrometers, z from root to tip.

use crate::fiber::{Fiber, MeshPart, Region};
use crate::io::{AtomicFile, FileError};
use std::fmt::Write as _;
use std::path::Path;

/// One object a part.
pub(super) fn write_obj(path: &Path, parts: &[MeshPart]) -> Result<(), FileError> {
    let mut text = String::from("# one period of a fiber, micrometers, z from root to tip\n");
    let mut base = 1;
    for part in parts {
        let _ = writeln!(text, "o {}", part.name);
        for p in &part.points {
            let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
        }
        for t in &part.triangles {
            let [a, b, c] = t.map(|i| i as usize + base);
            let _ = writeln!(text, "f {a} {b} {c}");
        }
        base += part.points.len();
    }
    AtomicFile::write_all_to(path, text.as_bytes())
}

/// All parts in one mesh; the face property `part` counts them in the order of the comments.
pub(super) fn write_ply(path: &Path, parts: &[MeshPart]) -> Result<(), FileError> {
    let points: usize = parts.iter().map(|p| p.points.len()).sum();
    let faces: usize = parts.iter().map(|p| p.triangles.len()).sum();
    let mut header = String::from("ply\nformat binary_little_endian 1.0\n");
    header.push_str("comment one period of a fiber, micrometers, z from root to tip\n");
    for (i, part) in parts.iter().enumerate() {
        let _ = writeln!(header, "comment part {i} {}", part.name);
    }
    let _ = write!(
        header,
        "element vertex {points}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {faces}\nproperty list uchar int vertex_indices\nproperty uchar part\n\
         end_header\n"
    );
    let mut bytes = header.into_bytes();
    for p in parts.iter().flat_map(|part| &part.points) {
        for v in p.as_vec3().to_array() {
            bytes.extend(v.to_le_bytes());
        }
    }
    let mut base = 0;
    for (i, part) in parts.iter().enumerate() {
        for t in &part.triangles {
            bytes.push(3);
            for v in t {
                bytes.extend((*v as i32 + base).to_le_bytes());
            }
            bytes.push(i as u8);
        }
        base += part.points.len() as i32;
    }
    AtomicFile::write_all_to(path, &bytes)
}

/// What to write into a species file to bake a mesh of ours.
pub(super) fn how_to_use(path: &Path, fiber: &Fiber) -> String {
    // To a millionth of a micrometer: the ends are matched less closely than that.
    let period_um = (fiber.period_um() * 1e6).round() / 1e6;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let mut text = format!(
        "to bake it, with a species file beside it or --set:\n[structure.mesh]\nfile = {name:?}\n\
         period_um = {period_um}"
    );
    let medium = fiber.medium(Region::Medulla);
    if medium.scattering_per_um > 0.0 {
        let _ = write!(
            text,
            "\n[structure.medulla]\nkind = \"medium\"\nscattering_per_um = {}\nasymmetry = {}\n\
             pigment = {}",
            medium.scattering_per_um, medium.asymmetry, medium.pigment
        );
    }
    let twist = fiber.structure().twist_turns_per_cm;
    if twist != 0.0 {
        let _ = write!(text, "\n[structure]\ntwist_turns_per_cm = {twist}");
    }
    text
}
