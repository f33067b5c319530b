//! Values at the corners of faces: texture coordinates and normals.

use crate::usd_file::{Prim, Property, Value};

/// An attribute that has a value for each corner of a face or each point.
pub(super) struct Primvar<'a> {
    values: &'a [f32],
    width: usize,
    indices: Option<&'a [i64]>,
    /// Whether each corner of a face has its own, not each point.
    by_corner: bool,
}

impl<'a> Primvar<'a> {
    /// The texture coordinates called `st`, else the first.
    pub(super) fn coordinates(prim: &'a Prim) -> Option<Self> {
        let is_uv =
            |p: &&Property| p.name.starts_with("primvars:") && p.type_name == "texCoord2f[]";
        let property = (prim.property("primvars:st"))
            .filter(is_uv)
            .or_else(|| prim.properties.iter().find(is_uv))?;
        Self::new(prim, property, 2, property.word("interpolation"))
    }

    /// Normals; subdivision surfaces have none but those of their limit.
    pub(super) fn normals(prim: &'a Prim) -> Option<Self> {
        if prim.text("subdivisionScheme") != Some("none") {
            return None;
        }
        if let Some(property) = prim.property("primvars:normals") {
            return Self::new(prim, property, 3, property.word("interpolation"));
        }
        let property = prim.property("normals")?;
        let interpolation = match property.word("interpolation") {
            "" => "vertex",
            word => word,
        };
        Self::new(prim, property, 3, interpolation)
    }

    fn new(
        prim: &'a Prim,
        property: &'a Property,
        width: usize,
        interpolation: &str,
    ) -> Option<Self> {
        let by_corner = match interpolation {
            "faceVarying" => true,
            "vertex" | "varying" => false,
            _ => return None,
        };
        let indices = prim.property(&format!("{}:indices", property.name));
        Some(Self {
            values: floats(property.any_value(), width),
            width,
            indices: indices.and_then(|p| match p.any_value() {
                Some(Value::Ints(indices)) => Some(&indices[..]),
                _ => None,
            }),
            by_corner,
        })
    }

    /// Of all corners of faces, which are at these points; else the first corner that has none.
    pub(super) fn of_corners(&self, points: &[u32]) -> Result<Vec<&'a [f32]>, usize> {
        (points.iter().enumerate())
            .map(|(corner, &point)| self.at(corner, point as usize).ok_or(corner))
            .collect()
    }

    /// Of a corner of a face, which is at a point; finite.
    fn at(&self, corner: usize, point: usize) -> Option<&'a [f32]> {
        let element = if self.by_corner { corner } else { point };
        let index = match self.indices {
            Some(indices) => usize::try_from(*indices.get(element)?).ok()?,
            None => element,
        };
        let value = (self.values.get(index.checked_mul(self.width)?..)?).get(..self.width)?;
        value.iter().all(|x| x.is_finite()).then_some(value)
    }
}

/// The numbers of an array of so many an element.
pub(super) fn floats(value: Option<&Value>, wanted: usize) -> &[f32] {
    match value {
        Some(Value::Floats { values, width }) if *width == wanted => values,
        _ => &[],
    }
}
