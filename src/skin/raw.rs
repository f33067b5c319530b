//! From what a mesh file says to a skin that keeps its promises.

use super::builtin::tangent;
use super::landmarks;
use super::{Mirror, Skin, SkinError};
use crate::mesh_file::RawMesh;
use glam::{Vec2, Vec3};
use std::collections::{HashMap, HashSet};
use std::f32::consts::{PI, TAU};

/// Boxes beyond these are most likely in other units, meters.
const SMALL: f32 = 1e-3;
const LARGE: f32 = 20.0;

impl RawMesh {
    /// Completes the mesh.
    ///
    /// Degenerate and repeated triangles are dropped, unused vertices too, normals are computed
    /// where missing (weighted by angle), texture coordinates go round the vertical axis, the fur
    /// lies along the longest horizontal axis toward -X or -Z, and down.
    pub(super) fn into_skin(mut self, file: &str) -> Result<Skin, SkinError> {
        let mut warnings = std::mem::take(&mut self.remarks);
        let mut triangles = self.sound_triangles(&mut warnings);
        if triangles.is_empty() {
            return Err(SkinError::Empty {
                file: file.to_owned(),
                faces: self.faces,
            });
        }
        let edges = edges(&triangles);
        let closed = edges.values().all(|edge| edge.balance == 0);
        if closed && is_negative(&self.positions, &triangles) {
            for t in &mut triangles {
                t.swap(1, 2);
            }
            warnings.push("the mesh is closed but faces inward: turned inside out".to_owned());
        }
        let shared = edges.values().filter(|edge| edge.faces > 2).count();
        if shared > 0 {
            warnings.push(format!(
                "{shared} edges belong to more than two faces: hair grows on all of them"
            ));
        }
        let mut skin = self.compact(triangles);
        skin.name = std::path::Path::new(file)
            .file_name()
            .map_or_else(|| file.to_owned(), |n| n.to_string_lossy().into_owned());
        skin.view = Vec3::new(0.6, 0.3, 0.75).normalize();
        let (lo, hi) = skin.bounds();
        let size = (hi - lo).max_element();
        if !(SMALL..=LARGE).contains(&size) {
            warnings.push(format!(
                "the mesh is {size} m large: if the file is not in meters, say so by --skin-units"
            ));
        }
        if self.uvs.is_empty() {
            warnings.push(
                "the file has no texture coordinates: they go round the vertical axis".to_owned(),
            );
        }
        comb(&mut skin, hi - lo);
        skin.warnings = warnings;
        Ok(skin)
    }

    /// Triangles with an area, each once.
    fn sound_triangles(&self, warnings: &mut Vec<String>) -> Vec<[u32; 3]> {
        let (mut flat, mut twice) = (0usize, 0usize);
        let mut seen = HashSet::with_capacity(self.triangles.len().min(1 << 20));
        let mut sound = Vec::with_capacity(self.triangles.len());
        for t in &self.triangles {
            let [a, b, c] = t.map(|v| self.positions[v as usize]);
            let longest = (b - a)
                .length_squared()
                .max((c - b).length_squared())
                .max((a - c).length_squared());
            let doubled = (b - a).as_dvec3().cross((c - a).as_dvec3()).length();
            if doubled <= 1e-7 * f64::from(longest) || doubled < 1e-24 {
                flat += 1;
                continue;
            }
            // Equal positions, not equal indices: copies often have vertices of their own.
            let mut key = [a, b, c].map(|p| (p + 0.0).to_array().map(f32::to_bits));
            key.sort_unstable();
            if seen.insert(key) {
                sound.push(*t);
            } else {
                twice += 1;
            }
        }
        if flat > 0 {
            warnings.push(format!("{flat} faces without area were left out"));
        }
        if twice > 0 {
            warnings.push(format!("{twice} repeated faces were left out"));
        }
        sound
    }

    /// Keeps the vertices that triangles use, with normals and texture coordinates.
    fn compact(&self, mut triangles: Vec<[u32; 3]>) -> Skin {
        let mut new_index = vec![u32::MAX; self.positions.len()];
        let mut used = Vec::new();
        for v in triangles.iter_mut().flatten() {
            let slot = &mut new_index[*v as usize];
            if *slot == u32::MAX {
                *slot = used.len() as u32;
                used.push(*v as usize);
            }
            *v = *slot;
        }
        let mut skin = Skin {
            positions: used.iter().map(|&v| self.positions[v]).collect(),
            triangles,
            ..Skin::default()
        };
        let computed = angle_weighted_normals(&skin);
        skin.normals = (computed.into_iter().enumerate())
            .map(|(i, computed)| {
                let given = self.normals.get(used[i]).and_then(|n| n.try_normalize());
                let normal = given.unwrap_or(computed);
                if normal.dot(computed) < 0.0 {
                    -normal
                } else {
                    normal
                }
            })
            .collect();
        let (lo, hi) = skin.bounds();
        let given = |v: usize| self.uvs.get(v).copied().filter(|uv| uv.is_finite());
        skin.uvs = (used.iter().enumerate())
            .map(|(i, &v)| given(v).unwrap_or_else(|| round_uv(skin.positions[i], lo, hi)))
            .collect();
        skin
    }
}

/// Direction from the axis of the box, and height.
fn round_uv(p: Vec3, lo: Vec3, hi: Vec3) -> Vec2 {
    let q = p - 0.5 * (lo + hi);
    let height = (hi.y - lo.y).max(f32::MIN_POSITIVE);
    Vec2::new((q.x.atan2(q.z) + PI) / TAU, (p.y - lo.y) / height)
}

/// Normals weighted by the angle of each corner (Thuermer and Wuethrich 1998): independent of how a
/// flat face is cut.
fn angle_weighted_normals(skin: &Skin) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; skin.positions.len()];
    for (i, t) in skin.triangles.iter().enumerate() {
        let corners = skin.corners(i);
        let [a, b, c] = corners;
        let face = (b - a).as_dvec3().cross((c - a).as_dvec3());
        let face = face.normalize_or_zero().as_vec3();
        for k in 0..3 {
            let (p, q, r) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
            let angle = (q - p).normalize_or_zero().dot((r - p).normalize_or_zero());
            sums[t[k] as usize] += face * angle.clamp(-1.0, 1.0).acos();
        }
    }
    sums.into_iter().map(|n| n.normalize_or(Vec3::Y)).collect()
}

/// An edge of a mesh.
#[derive(Clone, Copy, Default)]
struct Edge {
    /// Faces that have it.
    faces: u32,
    /// Of these, how many more run from its lower to its higher vertex than back: 0 on a closed mesh.
    balance: i32,
}

/// All edges by their vertices, the lower first.
fn edges(triangles: &[[u32; 3]]) -> HashMap<(u32, u32), Edge> {
    let mut edges: HashMap<_, Edge> = HashMap::with_capacity(2 * triangles.len());
    for t in triangles {
        for (from, to) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            let edge = edges.entry((from.min(to), from.max(to))).or_default();
            edge.faces += 1;
            edge.balance += if from < to { 1 } else { -1 };
        }
    }
    edges
}

/// Whether the volume that a closed mesh encloses is negative.
fn is_negative(positions: &[Vec3], triangles: &[[u32; 3]]) -> bool {
    let origin = positions[triangles[0][0] as usize].as_dvec3();
    let volume: f64 = (triangles.iter())
        .map(|t| t.map(|v| positions[v as usize].as_dvec3() - origin))
        .map(|[a, b, c]| a.dot(b.cross(c)))
        .sum();
    volume < 0.0
}

/// Head to tail is unknown: along the longest horizontal axis, and down.
fn comb(skin: &mut Skin, size: Vec3) {
    let back = if size.x >= size.z {
        Vec3::NEG_X
    } else {
        Vec3::NEG_Z
    };
    skin.front = -back;
    skin.landmarks = landmarks::guess(skin, -back);
    let (lo, hi) = skin.bounds();
    skin.mirror = Some(Mirror::new(0.5 * (lo + hi), back.cross(Vec3::Y)));
    let flow = back + 0.5 * Vec3::NEG_Y;
    let count = skin.positions.len();
    skin.combing = skin.normals.iter().map(|&n| tangent(flow, n)).collect();
    skin.length = vec![1.0; count];
    skin.density = vec![1.0; count];
    skin.color = vec![Vec3::ONE; count];
}
