//! Fibers modeled elsewhere: the mesh file is read with the species, so that what is wrong with it is
//! reported at the line that names it.

use super::structure::{AIR, Layers};
use super::{Reader, number_of};
use crate::mesh_file::LoadedMesh;
use crate::species::check::{Value, join};
use crate::species::error::closest;
use crate::species::model::{
    Cortex, Cuticle, FiberMesh, Medulla, MedullaKind, MeshAxis, MeshEnds, MeshRole, Section,
    Structure,
};

/// Thinnest and thickest fiber, micrometers, as for fibers that are described by numbers.
const DIAMETERS: std::ops::RangeInclusive<f64> = 1.0..=1000.0;
/// Widest section, major over minor axis.
const WIDEST: f64 = 5.0;

impl Reader<'_> {
    /// A structure whose shape is a mesh. Of cuticle and medulla only materials are read, all of
    /// which may be left out.
    pub(super) fn modeled(&mut self, layers: &Layers<'_>) -> Option<Structure> {
        let ior = self.layered(layers, "ior");
        let mesh = self.mesh(&layers.inner("mesh"));
        let surface = layers.inner("cuticle");
        let roughness = surface.number_or("roughness", 0.0);
        let core = layers.inner("medulla");
        let kind = match core.word("kind") {
            Some("medium") => self.medium(&core),
            _ => Some(MedullaKind::None),
        };
        let medulla = kind.map(|kind| Medulla {
            kind,
            void_ior: core.number_or("void_ior", AIR),
            pigment: core.number_or("pigment", 1.0),
            ..Medulla::default()
        });
        let materials = ior
            .zip(medulla.as_ref())
            .and_then(|(ior, medulla)| self.materials(&layers.inner("materials"), ior, medulla));
        let (mesh, [width, depth]) = mesh?;
        Some(Structure {
            diameter_um: (width * depth).sqrt(),
            aspect: width.max(depth) / width.min(depth),
            section: Section::Ellipse,
            twist_turns_per_cm: layers.number_or("twist_turns_per_cm", 0.0),
            ior: ior?,
            cuticle: Cuticle {
                roughness,
                riser_roughness: surface.number_or("riser_roughness", roughness),
                ..Cuticle::default()
            },
            cortex: Cortex::default(),
            medulla: medulla?,
            materials: materials?,
            mesh: Some(mesh),
        })
    }

    /// The mesh and its extents across, micrometers.
    fn mesh(&mut self, layers: &Layers<'_>) -> Option<(FiberMesh, [f64; 2])> {
        let Some(item) = layers.find("file") else {
            self.missing(layers, "file");
            return None;
        };
        let Value::Text(name) = &item.value else {
            return None;
        };
        let path = self.folder.join(name);
        let content = match LoadedMesh::read(&path) {
            Ok(content) => content,
            Err(error) => {
                let message = format!("`{}`: {error}", join(&layers.path, "file"));
                self.problems.push(&item.place, message, None);
                return None;
            }
        };
        let roles = self.roles(layers, content.names())?;
        let axis = match layers.word("axis") {
            Some("x") => MeshAxis::X,
            Some("y") => MeshAxis::Y,
            Some(_) => MeshAxis::Z,
            None if content.is_gltf() => MeshAxis::Y,
            None => MeshAxis::Z,
        };
        let mesh = FiberMesh {
            file: path.to_string_lossy().into_owned(),
            period_um: layers.find("period_um").and_then(number_of),
            ends: match layers.word("ends") {
                Some("capped") => MeshEnds::Capped,
                _ => MeshEnds::Open,
            },
            unit_um: layers.number_or("unit_um", 1.0),
            axis,
            roles,
            content,
        };
        let extent = mesh.extent_um();
        let [width, depth, _] = extent;
        let diameter = (width * depth).sqrt();
        if !(DIAMETERS.contains(&diameter) && width.max(depth) <= WIDEST * width.min(depth)) {
            let message = format!(
                "`{}`: the fiber is {:.4} um by {:.4} um across and {:.4} um long, expected 1 to \
                 1000 um and a section at most {WIDEST} times as wide as thick",
                layers.path, extent[0], extent[1], extent[2]
            );
            let hint = "`unit_um` is the length of a unit of the file, `axis` the one that points \
                        to the tip";
            self.conflict(&item.place, message, hint);
            return None;
        }
        Some((mesh, [width, depth]))
    }

    /// The role of each part of the file: by the table `parts`, else by its name.
    fn roles(&mut self, layers: &Layers<'_>, names: &[String]) -> Option<Vec<MeshRole>> {
        let words: &[(String, &str)] = match layers.find("parts").map(|i| &i.value) {
            Some(Value::Words(words)) => words,
            Some(_) => return None,
            None => &[],
        };
        let place = layers.place("parts");
        let listed = || names.iter().take(20).map(|n| format!("`{n}`"));
        for (key, _) in words {
            if !names.contains(key) {
                let path = join(&join(&layers.path, "parts"), key);
                let message = format!("`{path}`: the mesh has no part of that name");
                let hint = match closest(key, names.iter().map(String::as_str)) {
                    Some(name) => format!("did you mean `{name}`?"),
                    None => format!("it has {}", listed().collect::<Vec<_>>().join(", ")),
                };
                self.conflict(place, message, &hint);
                return None;
            }
        }
        let mut roles = Vec::with_capacity(names.len());
        let mut unknown = Vec::new();
        for name in names {
            let word = words.iter().find(|(key, _)| key == name).map(|(_, w)| *w);
            match role_of(word.unwrap_or(name)) {
                Some(role) => roles.push(role),
                // A mesh of one nameless part is all cuticle.
                None if names.len() == 1 && name.is_empty() => roles.push(MeshRole::Cuticle),
                None => unknown.push(format!("`{name}`")),
            }
        }
        if !unknown.is_empty() {
            let more = unknown.len().saturating_sub(20);
            unknown.truncate(20);
            let mut listed = unknown.join(", ");
            if more > 0 {
                listed += &format!(" and {more} more");
            }
            let message = format!(
                "`{}`: the mesh has parts of unknown role: {listed}",
                layers.path
            );
            let hint = "name each in a table `parts`, for instance [structure.mesh.parts] \
                        pCube1 = \"cuticle\"; roles are cuticle, riser, cortex, medulla, void, \
                        ignored";
            self.conflict(place, message, hint);
            return None;
        }
        if !roles.contains(&MeshRole::Cuticle) {
            let message = format!("`{}`: no part of the mesh is the cuticle", layers.path);
            let listed: Vec<_> = listed().collect();
            let hint = format!("it has {}", listed.join(", "));
            self.conflict(place, message, &hint);
            return None;
        }
        Some(roles)
    }
}

/// The role of that name; modeling programs append `.001` to a name that is taken.
fn role_of(name: &str) -> Option<MeshRole> {
    let stem = match name.rsplit_once('.') {
        Some((stem, digits)) if digits.bytes().all(|b| b.is_ascii_digit()) => stem,
        _ => name,
    };
    match stem.to_ascii_lowercase().as_str() {
        "cuticle" => Some(MeshRole::Cuticle),
        "riser" | "risers" => Some(MeshRole::Riser),
        "cortex" => Some(MeshRole::Cortex),
        "medulla" => Some(MeshRole::Medulla),
        "void" | "voids" => Some(MeshRole::Void),
        "ignored" => Some(MeshRole::Ignored),
        _ => None,
    }
}

impl FiberMesh {
    /// A point of the file in the fiber's frame, micrometers.
    pub(crate) fn place(&self, p: glam::Vec3) -> glam::DVec3 {
        let [x, y, z] = p.as_dvec3().to_array();
        let p = match self.axis {
            MeshAxis::X => [y, z, x],
            MeshAxis::Y => [x, -z, y],
            MeshAxis::Z => [x, y, z],
        };
        self.unit_um * glam::DVec3::from(p)
    }

    /// A point of the fiber's frame as the file says it.
    pub(crate) fn unplace(&self, p: glam::DVec3) -> glam::DVec3 {
        let [x, y, z] = (p / self.unit_um).to_array();
        glam::DVec3::from(match self.axis {
            MeshAxis::X => [z, x, y],
            MeshAxis::Y => [x, z, -y],
            MeshAxis::Z => [x, y, z],
        })
    }

    /// Size of the box around the outer surface, micrometers; zeros without one.
    fn extent_um(&self) -> [f64; 3] {
        let mesh = self.content.mesh();
        let is_outer = |part: u32| {
            matches!(
                self.roles.get(part as usize),
                Some(MeshRole::Cuticle | MeshRole::Riser)
            )
        };
        let mut range: Option<(glam::DVec3, glam::DVec3)> = None;
        for (t, _) in mesh
            .triangles
            .iter()
            .zip(&mesh.part)
            .filter(|(_, part)| is_outer(**part))
        {
            for p in t.map(|v| self.place(mesh.positions[v as usize])) {
                let (lo, hi) = range.unwrap_or((p, p));
                range = Some((lo.min(p), hi.max(p)));
            }
        }
        range.map_or([0.0; 3], |(lo, hi)| (hi - lo).to_array())
    }
}
