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
    encode(&mut file, width, height, rgb, text).map_err(|e| {
        let source = match e {
            png::EncodingError::IoError(e) => e,
            other => std::io::Error::new(std::io::ErrorKind::InvalidInput, other),
        };
        FileError::new("write", path, source)
    })?;
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
