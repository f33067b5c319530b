//! Pixels of OpenEXR pictures.

use exr::meta::MetaData;
use exr::prelude::{ReadChannels, ReadLayers};
use std::io::Cursor;

/// Width, height and pixels, rows from the top, or what was wrong.
pub(crate) type Decoded<P> = Result<(usize, usize, Vec<P>), String>;

/// Decodes the first layer that has R, G and B.
///
/// * `most_pixels`: a header decides how much memory is taken, so one of more pixels is refused before
///   any is.
/// * `of`: makes a pixel of linear R, G, B and opacity, 1 where the file has none.
pub(crate) fn decode_exr<P: Clone + Default + 'static>(
    bytes: &[u8],
    most_pixels: usize,
    of: impl Fn([f32; 4]) -> P + 'static,
) -> Decoded<P> {
    let meta =
        MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|e| e.to_string())?;
    for header in &meta.headers {
        let colors = ["R", "G", "B"].map(Into::into);
        let has = |name| header.channels.find_index_of_channel(name).is_some();
        let size = header.layer_size;
        let pixels = size.width().checked_mul(size.height());
        if colors.iter().all(has) && pixels.is_none_or(|n| n > most_pixels) {
            let (width, height) = (size.width(), size.height());
            return Err(format!("{width} x {height} pixels are too many"));
        }
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            |size, _| (size.width(), vec![P::default(); size.area()]),
            move |(width, pixels): &mut (usize, Vec<P>), at, (r, g, b, a): (f32, f32, f32, f32)| {
                if let Some(pixel) = pixels.get_mut(at.y() * *width + at.x()) {
                    *pixel = of([r, g, b, a]);
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(|e| e.to_string())?;
    let size = image.layer_data.size;
    let (_, pixels) = image.layer_data.channel_data.pixels;
    Ok((size.width(), size.height(), pixels))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use exr::prelude::{Image, SpecificChannels, WritableImage};

    /// A picture of 2 x 1 pixels whose header says that it is larger.
    pub(crate) fn boastful(width: i32, height: i32) -> Vec<u8> {
        let pixel = |at: exr::math::Vec2<usize>| (at.x() as f32, 0.5f32, 0.25f32);
        let image = Image::from_channels((2, 1), SpecificChannels::rgb(pixel));
        let mut bytes = Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).unwrap();
        let mut bytes = bytes.into_inner();
        let name = b"dataWindow\0box2i\0";
        let at = bytes.windows(name.len()).position(|w| w == name).unwrap();
        let corner = at + name.len() + 4 + 8;
        for (i, last) in [width - 1, height - 1].into_iter().enumerate() {
            bytes[corner + 4 * i..][..4].copy_from_slice(&last.to_le_bytes());
        }
        bytes
    }

    #[test]
    fn pixels_come_with_their_opacity() {
        let (width, height, pixels) = decode_exr(&boastful(2, 1), 2, |p| p).unwrap();
        assert_eq!((width, height), (2, 1));
        assert_eq!(pixels, [[0.0, 0.5, 0.25, 1.0], [1.0, 0.5, 0.25, 1.0]]);
    }

    #[test]
    fn a_header_cannot_ask_for_more_than_the_limit() {
        let refused = |bytes: &[u8], most| decode_exr(bytes, most, |p| p).unwrap_err();
        assert!(refused(&boastful(2, 1), 1).contains("2 x 1 pixels are too many"));
        for side in [1 << 15, 1 << 20, 1 << 29] {
            let reason = refused(&boastful(side, side), 1 << 28);
            assert!(reason.contains("too many"), "{side}: {reason}");
        }
    }
}
