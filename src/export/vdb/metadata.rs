//! Named values beside a grid or a file.

use glam::IVec3;

/// A value of metadata, of the types that readers know.
#[derive(Clone, Debug, PartialEq)]
pub enum Meta {
    /// Text.
    Text(String),
    /// Yes or no.
    Bool(bool),
    /// A whole number.
    Int64(i64),
    /// A number.
    Double(f64),
    /// A voxel.
    Vec3i(IVec3),
}

impl Meta {
    fn type_name(&self) -> &'static str {
        match self {
            Self::Text(_) => "string",
            Self::Bool(_) => "bool",
            Self::Int64(_) => "int64",
            Self::Double(_) => "double",
            Self::Vec3i(_) => "vec3i",
        }
    }

    fn bytes(&self) -> Vec<u8> {
        match self {
            Self::Text(text) => text.as_bytes().to_vec(),
            Self::Bool(yes) => vec![u8::from(*yes)],
            Self::Int64(number) => number.to_le_bytes().to_vec(),
            Self::Double(number) => number.to_le_bytes().to_vec(),
            Self::Vec3i(v) => v
                .to_array()
                .into_iter()
                .flat_map(i32::to_le_bytes)
                .collect(),
        }
    }
}

/// Appends text with its length before it.
pub(super) fn put_text(text: &str, out: &mut Vec<u8>) {
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(text.as_bytes());
}

/// Appends all entries, sorted by name as the library does.
pub(super) fn put(mut entries: Vec<(String, Meta)>, out: &mut Vec<u8>) {
    entries.sort_by(|a, b| a.0.cmp(&b.0));
    out.extend((entries.len() as u32).to_le_bytes());
    for (name, value) in entries {
        put_text(&name, out);
        put_text(value.type_name(), out);
        let bytes = value.bytes();
        out.extend((bytes.len() as u32).to_le_bytes());
        out.extend(bytes);
    }
}
