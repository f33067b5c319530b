//! One grid: metadata, transform, and the facts of its values.

use super::VdbFileError as Error;
use super::nodes;
use crate::cursor::Cursor;
use glam::{DMat4, DVec3, IVec3};

/// A value of metadata.
#[derive(Clone, Debug, PartialEq)]
pub enum Meta {
    /// Text.
    Text(String),
    /// Yes or no.
    Bool(bool),
    /// A whole number.
    Int(i64),
    /// A voxel.
    Voxel(IVec3),
    /// Of another type.
    Other,
}

/// What the active values of a grid are like.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Values {
    /// Number of active voxels, those of tiles included.
    pub active: u64,
    /// First and last active voxel.
    pub bounds: Option<(IVec3, IVec3)>,
    /// Least and greatest component of an active value.
    pub range: Option<(f32, f32)>,
    /// Components that are infinite or none.
    pub not_finite: u64,
}

/// What is known of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct GridFacts {
    /// Its name.
    pub name: String,
    /// Type of its tree, `Tree_float_5_4_3_HalfFloat`.
    pub type_name: String,
    /// Named values beside it.
    pub metadata: Vec<(String, Meta)>,
    /// From voxels to the world; `None` for a frustum.
    pub transform: Option<DMat4>,
    /// The values; why they could not be looked at otherwise.
    pub values: Result<Values, &'static str>,
}

impl GridFacts {
    /// A value of metadata.
    pub fn meta(&self, name: &str) -> Option<&Meta> {
        self.metadata
            .iter()
            .find(|(key, _)| key == name)
            .map(|(_, value)| value)
    }

    /// A text of metadata.
    pub fn text(&self, name: &str) -> Option<&str> {
        match self.meta(name) {
            Some(Meta::Text(text)) => Some(text),
            _ => None,
        }
    }

    /// First and last corner of the box around all active voxels, in the world.
    pub fn world_bounds(&self) -> Option<(DVec3, DVec3)> {
        let (lo, hi) = self.values.as_ref().ok()?.bounds?;
        let transform = self.transform?;
        let (lo, hi) = (lo.as_dvec3() - 0.5, hi.as_dvec3() + 0.5);
        let corner = |i: usize| {
            let pick = |axis: usize| {
                if i >> axis & 1 == 0 {
                    lo[axis]
                } else {
                    hi[axis]
                }
            };
            transform.transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
        };
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let bounds = (0..8)
            .map(corner)
            .fold(empty, |(a, b), p| (a.min(p), b.max(p)));
        (bounds.0.is_finite() && bounds.1.is_finite()).then_some(bounds)
    }
}

/// Named values.
pub(super) fn metadata(stream: &mut Cursor<'_>) -> Result<Vec<(String, Meta)>, Error> {
    let count = stream.u32()?;
    let mut entries = Vec::new();
    for _ in 0..count {
        let name = stream.text()?;
        let type_name = stream.text()?;
        let length = stream.u32()?;
        let bytes = stream.take(u64::from(length))?;
        let mut value = Cursor::new(bytes, 0);
        let value = match type_name.as_str() {
            "string" => Meta::Text(String::from_utf8_lossy(bytes).into_owned()),
            "bool" => Meta::Bool(value.u8()? != 0),
            "int32" => Meta::Int(i64::from(value.u32()? as i32)),
            "int64" => Meta::Int(value.u64()? as i64),
            "vec3i" => Meta::Voxel(value.ivec()?),
            _ => Meta::Other,
        };
        entries.push((name, value));
    }
    Ok(entries)
}

/// Reads a grid whose head and blocks stand at two places.
pub(super) fn read(
    bytes: &[u8],
    [grid_at, blocks_at]: [u64; 2],
    name: String,
    type_name: String,
    is_instance: bool,
) -> Result<GridFacts, Error> {
    let mut stream = Cursor::new(bytes, grid_at);
    let flags = stream.u32()?;
    let metadata = metadata(&mut stream)?;
    let transform = transform(&mut stream)?;
    let mut facts = GridFacts {
        name,
        type_name,
        metadata,
        transform: transform.ok(),
        values: Err("they are those of another grid"),
    };
    if is_instance {
        return Ok(facts);
    }
    let (plain, half) = match facts.type_name.strip_suffix("_HalfFloat") {
        Some(plain) => (plain, true),
        None => (facts.type_name.as_str(), false),
    };
    let components = match plain {
        "Tree_float_5_4_3" => 1,
        "Tree_vec3s_5_4_3" => 3,
        _ => {
            facts.values = Err("they are neither float nor vec3s");
            return Ok(facts);
        }
    };
    facts.values = match transform {
        // What follows a map of unknown length cannot be found.
        Err(()) => Err("the transform is not linear"),
        Ok(_) => nodes::read(
            &mut stream,
            Cursor::new(bytes, blocks_at),
            flags,
            components,
            half,
        )?,
    };
    Ok(facts)
}

/// A linear map, or that it is none.
fn transform(stream: &mut Cursor<'_>) -> Result<Result<DMat4, ()>, Error> {
    let kind = stream.text()?;
    let mut vector = || Ok::<_, Error>(DVec3::new(stream.f64()?, stream.f64()?, stream.f64()?));
    Ok(Ok(match kind.as_str() {
        "UniformScaleMap" | "ScaleMap" => {
            let scale = vector()?;
            for _ in 0..4 {
                vector()?;
            }
            DMat4::from_scale(scale)
        }
        "UniformScaleTranslateMap" | "ScaleTranslateMap" => {
            let (translation, scale) = (vector()?, vector()?);
            for _ in 0..4 {
                vector()?;
            }
            DMat4::from_translation(translation) * DMat4::from_scale(scale)
        }
        "TranslationMap" => DMat4::from_translation(vector()?),
        "AffineMap" | "UnitaryMap" => {
            // Points are rows there.
            let mut numbers = [0.0; 16];
            for number in &mut numbers {
                *number = stream.f64()?;
            }
            DMat4::from_cols_array(&numbers)
        }
        _ => return Ok(Err(())),
    }))
}
