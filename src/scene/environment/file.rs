//! Environment files: latitude-longitude EXR and Radiance pictures.

use super::{Environment, radiance_hdr};
use crate::blame::Blame;
use crate::color::Rgb;
use crate::io::{Decoded, FileError, decode_exr, read_bounded};
use std::path::{Path, PathBuf};

/// Largest file read, bytes: 16384 x 8192 in 32-bit floats, uncompressed, is 1.6e9.
const FILE_LIMIT: u64 = 2 << 30;

/// Widest picture taken.
const WIDTH_LIMIT: usize = 16_384;

/// An environment that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum EnvironmentError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The name ends in something else than `.exr` or `.hdr`.
    #[error("{} is no environment: a latitude-longitude .exr or .hdr file is needed", path.display())]
    Kind {
        /// The file.
        path: PathBuf,
    },
    /// The bytes are not what the name says.
    #[error("cannot read {} as an environment: {reason}", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// What the decoder met.
        reason: String,
    },
    /// Not twice as wide as high, or too large.
    #[error(
        "{} has {width} x {height} pixels; a latitude-longitude picture is twice as wide as high and \
         at most {WIDTH_LIMIT} wide",
        path.display()
    )]
    Size {
        /// The file.
        path: PathBuf,
        /// Pixels across.
        width: usize,
        /// Pixels down.
        height: usize,
    },
    /// A NaN or infinity.
    #[error("{} holds {value} at pixel ({x}, {y})", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// From the left.
        x: usize,
        /// From the top.
        y: usize,
        /// The radiance found.
        value: Rgb,
    },
}

impl EnvironmentError {
    /// Bad pictures are the user's to mend, failing disks are not.
    pub fn blame(&self) -> Blame {
        match self {
            Self::File(error) => error.blame(),
            _ => Blame::Input,
        }
    }
}

/// Reads an environment. Negative values, left by resampling filters, become 0.
pub fn load(path: &Path) -> Result<Environment, EnvironmentError> {
    let extension = path.extension().map(|e| e.to_ascii_lowercase());
    let decode = match extension.as_deref().and_then(|e| e.to_str()) {
        Some("exr") => exr,
        Some("hdr" | "pic" | "rgbe") => radiance_hdr::decode,
        _ => return Err(EnvironmentError::Kind { path: path.into() }),
    };
    let bytes = read_bounded(path, FILE_LIMIT)?;
    let (width, height, mut texels) =
        decode(&bytes).map_err(|reason| EnvironmentError::Broken {
            path: path.into(),
            reason,
        })?;
    if width != 2 * height || width > WIDTH_LIMIT || texels.len() != width * height {
        return Err(EnvironmentError::Size {
            path: path.into(),
            width,
            height,
        });
    }
    if let Some(i) = texels.iter().position(|t| !t.is_finite()) {
        return Err(EnvironmentError::Value {
            path: path.into(),
            x: i % width,
            y: i / width,
            value: texels[i],
        });
    }
    for texel in &mut texels {
        *texel = texel.max(Rgb::ZERO);
    }
    Ok(Environment::from_texels(width, height, texels))
}

fn exr(bytes: &[u8]) -> Decoded<Rgb> {
    let most = WIDTH_LIMIT * WIDTH_LIMIT / 2;
    decode_exr(bytes, most, |[r, g, b, _]| Rgb::new(r, g, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_that_announces_too_much_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.exr");
        let bytes = crate::io::boastful_exr(1 << 20, 1 << 19);
        std::fs::write(&path, bytes).unwrap();
        let reason = load(&path).unwrap_err().to_string();
        assert!(reason.contains("too many"), "{reason}");
    }
}
