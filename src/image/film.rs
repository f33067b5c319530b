//! Rendered pictures as files.

use super::cryptomatte::Cryptomatte;
use super::view::ViewTransform;
use super::write_png;
use crate::io::{AtomicFile, FileError, exr_text, sort_exr_attributes};
use crate::render::{Film, Pixel};
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Compression, Encoding, FlatSamples, Image,
    ImageAttributes, IntegerBounds, Layer, LayerAttributes, LineOrder, SmallVec, Text, Vec2,
    WritableImage, f16,
};
use std::io::{self, Write};
use std::path::Path;

/// Where a picture comes from: pairs of names and texts.
pub type Provenance<'a> = [(&'a str, &'a str)];

/// Name of the EXR attribute that holds the provenance as a JSON object.
pub const PROVENANCE_ATTRIBUTE: &str = "vair:provenance";

/// Writes an 8-bit sRGB PNG of the beauty pass, provenance in text chunks.
pub fn write_film_png(
    path: &Path,
    film: &Film,
    view: &ViewTransform,
    provenance: &Provenance<'_>,
) -> Result<(), FileError> {
    let bytes: Vec<u8> = film
        .pixels
        .iter()
        .flat_map(|p| view.bytes(p.radiance))
        .collect();
    write_png(path, film.crop.width, film.crop.height, &bytes, provenance)
}

/// Writes an EXR with all passes: `R G B A`, `Z` (millimeters from the camera), `albedo.RGB`,
/// `normal.XYZ`, `tangent.XYZ` (world, the mean over the hits of a pixel), `strand.id` (the stable id,
/// 4294967295 for none), `root.UV`, `samples` and `variance.Y` (of the mean luminance); of a film with mattes
/// the Cryptomatte layers `CryptoClass00` and `CryptoZone00` on.
///
/// The data window is the crop, the display window the full frame. Same film, same bytes.
pub fn write_film_exr(
    path: &Path,
    film: &Film,
    provenance: &Provenance<'_>,
) -> Result<(), FileError> {
    let mut bytes = io::Cursor::new(Vec::new());
    encode(film, provenance)
        .write()
        .to_buffered(&mut bytes)
        .map_err(|e| {
            let reason = io::Error::new(io::ErrorKind::InvalidInput, e.to_string());
            FileError::new("write", path, reason)
        })?;
    let mut bytes = bytes.into_inner();
    sort_exr_attributes(&mut bytes);
    let mut file = AtomicFile::create(path)?;
    file.write_all(&bytes)
        .map_err(|e| FileError::new("write", path, e))?;
    file.commit()
}

fn encode(film: &Film, provenance: &Provenance<'_>) -> Image<Layer<AnyChannels<FlatSamples>>> {
    let (crop, [width, height]) = (film.crop, film.resolution);
    let text: serde_json::Map<String, serde_json::Value> = provenance
        .iter()
        .map(|(k, v)| ((*k).to_owned(), (*v).into()))
        .collect();
    let mut layer = LayerAttributes {
        layer_position: Vec2(crop.x as i32, crop.y as i32),
        software_name: Some(Text::from(crate::PROGRAM)),
        ..LayerAttributes::named("film")
    };
    let json = serde_json::Value::Object(text).to_string();
    layer.other.insert(
        Text::new_or_panic(PROVENANCE_ATTRIBUTE),
        AttributeValue::Text(exr_text(&json)),
    );
    let mut channels = channels(film);
    if let Some(mattes) = &film.mattes {
        for set in Cryptomatte::of(mattes) {
            let attributes = set.attributes().into_iter();
            let text = |text: String| AttributeValue::Text(exr_text(&text));
            (layer.other).extend(attributes.map(|(name, value)| (name, text(value))));
            channels.extend(set.channels(film, mattes));
        }
    }
    let encoding = Encoding {
        compression: Compression::ZIP16,
        line_order: LineOrder::Increasing,
        ..Encoding::SMALL_LOSSLESS
    };
    let size = Vec2(crop.width as usize, crop.height as usize);
    let image = ImageAttributes::new(IntegerBounds::new(
        Vec2(0, 0),
        Vec2(width as usize, height as usize),
    ));
    Image {
        attributes: image,
        layer_data: Layer::new(size, layer, encoding, AnyChannels::sort(channels)),
    }
}

fn channels(film: &Film) -> SmallVec<[AnyChannel<FlatSamples>; 4]> {
    let each = |name: &str, samples| AnyChannel::new(name, samples);
    let float = |get: fn(&Pixel) -> f32| FlatSamples::F32(film.pixels.iter().map(get).collect());
    let half = |get: fn(&Pixel) -> f32| {
        FlatSamples::F16(film.pixels.iter().map(|p| f16::from_f32(get(p))).collect())
    };
    let whole = |get: fn(&Pixel) -> u32| FlatSamples::U32(film.pixels.iter().map(get).collect());
    [
        each("R", float(|p| p.radiance.x)),
        each("G", float(|p| p.radiance.y)),
        each("B", float(|p| p.radiance.z)),
        each("A", float(|p| p.alpha)),
        each("Z", float(|p| p.depth)),
        each("albedo.R", half(|p| p.albedo.x)),
        each("albedo.G", half(|p| p.albedo.y)),
        each("albedo.B", half(|p| p.albedo.z)),
        each("normal.X", half(|p| p.normal.x)),
        each("normal.Y", half(|p| p.normal.y)),
        each("normal.Z", half(|p| p.normal.z)),
        each("tangent.X", half(|p| p.tangent.x)),
        each("tangent.Y", half(|p| p.tangent.y)),
        each("tangent.Z", half(|p| p.tangent.z)),
        each("strand.id", whole(|p| p.strand)),
        each("root.U", float(|p| p.root_uv.x)),
        each("root.V", float(|p| p.root_uv.y)),
        each("samples", whole(|p| p.samples)),
        each("variance.Y", float(|p| p.variance)),
    ]
    .into_iter()
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{Crop, NO_STRAND, Report};
    use exr::prelude::{ReadChannels, ReadLayers, read};

    fn film() -> Film {
        let pixel = |i: u32| Pixel {
            radiance: glam::Vec3::new(0.1 * i as f32, 1.0, 2.0),
            alpha: 0.5,
            variance: 1e-3,
            samples: 4,
            depth: if i == 0 { f32::INFINITY } else { 900.0 },
            albedo: glam::Vec3::splat(0.25),
            normal: glam::Vec3::Y,
            tangent: glam::Vec3::Z,
            strand: if i == 0 { NO_STRAND } else { 70_000 + i },
            root_uv: glam::Vec2::new(0.75, 0.125),
        };
        Film {
            crop: Crop {
                x: 5,
                y: 2,
                width: 3,
                height: 2,
            },
            resolution: [20, 10],
            pixels: (0..6).map(pixel).collect(),
            mattes: None,
            report: Report::default(),
        }
    }

    #[test]
    fn all_passes_come_back_and_the_bytes_repeat() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let provenance = [
            ("species", "name = \"λ–白é\""),
            ("seed", "3"),
            ("settings", ""),
        ];
        write_film_exr(&path, &film(), &provenance).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        for _ in 0..8 {
            write_film_exr(&path, &film(), &provenance).unwrap();
            assert_eq!(std::fs::read(&path).unwrap(), bytes);
        }
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_buffered(io::Cursor::new(bytes))
            .unwrap();
        let layer = &image.layer_data;
        assert_eq!(layer.attributes.layer_position, Vec2(5, 2));
        assert_eq!(image.attributes.display_window.size, Vec2(20, 10));
        let attribute = &layer.attributes.other[&Text::new_or_panic(PROVENANCE_ATTRIBUTE)];
        let AttributeValue::Text(json) = attribute else {
            panic!("{attribute:?}")
        };
        let json: serde_json::Value = serde_json::from_slice(json.as_slice()).unwrap();
        assert_eq!(json["species"], "name = \"λ–白é\"");
        let channel = |name: &str| {
            let found = layer.channel_data.list.iter().find(|c| c.name.eq(name));
            found
                .unwrap()
                .sample_data
                .values_as_f32()
                .collect::<Vec<f32>>()
        };
        assert_eq!(channel("R")[3], 0.3);
        assert_eq!(channel("Z")[0], f32::INFINITY);
        assert_eq!(channel("normal.Y"), vec![1.0; 6]);
        assert_eq!(channel("strand.id")[2], 70_002.0);
        assert_eq!(layer.channel_data.list.len(), 19);
    }

    #[test]
    fn an_unwritable_place_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let error = write_film_exr(folder.path(), &film(), &[]).unwrap_err();
        assert_eq!(error.blame(), crate::blame::Blame::Environment);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
