//! 8-bit sRGB PNG files.

use crate::io::{AtomicFile, FileError};
use std::path::Path;

/// Writes an 8-bit sRGB PNG.
///
/// * `rgb`: `width * height * 3` bytes, rows from the top.
/// * `text`: keyword and value pairs stored as text chunks (keywords of 1..=79 Latin-1 characters).
pub fn write_png(
    path: &Path,
    width: u32,
    height: u32,
    rgb: &[u8],
    text: &[(&str, &str)],
) -> Result<(), FileError> {
    let mut file = AtomicFile::create(path)?;
    encode(&mut file, width, height, rgb, text).map_err(|e| file_error(path, e))?;
    file.commit()
}

fn encode(
    out: &mut AtomicFile,
    width: u32,
    height: u32,
    rgb: &[u8],
    text: &[(&str, &str)],
) -> Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    for (key, value) in text {
        encoder.add_itxt_chunk((*key).to_owned(), (*value).to_owned())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgb)?;
    writer.finish()
}

/// Writes picture data of any 8-bit kind, compressed as well as it goes.
///
/// * `kind`: sets color type, palette and filter.
pub(super) fn write_encoded(
    path: &Path,
    (width, height): (u32, u32),
    data: &[u8],
    kind: impl FnOnce(&mut png::Encoder<'_, &mut AtomicFile>),
) -> Result<(), FileError> {
    let mut file = AtomicFile::create(path)?;
    let encoded = (|| {
        let mut encoder = png::Encoder::new(&mut file, width, height);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::High);
        kind(&mut encoder);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(data)?;
        writer.finish()
    })();
    encoded.map_err(|e| file_error(path, e))?;
    file.commit()
}

fn file_error(path: &Path, error: png::EncodingError) -> FileError {
    let source = match error {
        png::EncodingError::IoError(e) => e,
        other => std::io::Error::new(std::io::ErrorKind::InvalidInput, other),
    };
    FileError::new("write", path, source)
}
