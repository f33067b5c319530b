//! The polygons of a mesh with what each corner has.

use super::primvar::{Primvar, floats};
use crate::usd_file::{Prim, Value};
use glam::{DMat3, DMat4, DVec3, Vec2, Vec3};

/// Faces as the file has them, in meters.
pub(super) struct Polygons {
    pub(super) points: Vec<DVec3>,
    /// Corners of each face.
    pub(super) counts: Vec<u32>,
    /// The point at each corner.
    pub(super) corners: Vec<u32>,
    /// Texture coordinates of each corner.
    pub(super) uvs: Option<Vec<Vec2>>,
    /// Normals of each corner; subdivision surfaces have none but those of their limit.
    pub(super) normals: Option<Vec<Vec3>>,
    /// Whether each face is a hole, which subdivision surfaces can have.
    pub(super) is_hole: Vec<bool>,
}

impl Polygons {
    /// Of a prim that is placed in the world so. The error is a reason.
    pub(super) fn read(prim: &Prim, placed: DMat4) -> Result<Self, String> {
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
            return Err(format!(
                "{counted}, but there are {} indices",
                indices.len()
            ));
        }
        let count = points.len() / 3;
        if let Some(bad) = indices.iter().find(|&&i| !(0..count as i64).contains(&i)) {
            return Err(format!("a face refers to point {bad} of {count}"));
        }
        let corners: Vec<u32> = indices.iter().map(|&i| i as u32).collect();
        let turned = DMat3::from_mat4(placed).inverse().transpose();
        let lacks = |corner: usize, what: &str| format!("corner {corner} has no {what}");
        let uvs = (Primvar::coordinates(prim).map(|uvs| uvs.of_corners(&corners)))
            .transpose()
            .map_err(|corner| lacks(corner, "texture coordinates"))?;
        let normals = (Primvar::normals(prim).map(|normals| normals.of_corners(&corners)))
            .transpose()
            .map_err(|corner| lacks(corner, "normal"))?;
        let place = |p: &[f32]| placed.transform_point3(Vec3::from_slice(p).as_dvec3());
        Ok(Self {
            points: points.chunks_exact(3).map(place).collect(),
            counts: counts.iter().map(|&n| n as u32).collect(),
            uvs: uvs.map(|uvs| uvs.into_iter().map(Vec2::from_slice).collect()),
            normals: normals.map(|normals| {
                let normal = |n| (turned * Vec3::from_slice(n).as_dvec3()).normalize_or_zero();
                normals.into_iter().map(|n| normal(n).as_vec3()).collect()
            }),
            is_hole: vec![false; counts.len()],
            corners,
        })
    }
}

/// The whole numbers of an attribute.
pub(super) fn ints<'p>(prim: &'p Prim, name: &str) -> &'p [i64] {
    match prim.value(name) {
        Some(Value::Ints(values)) => values,
        _ => &[],
    }
}
