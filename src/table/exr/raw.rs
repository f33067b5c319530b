//! Parts of named channels of any type and size, to and from the bytes of an OpenEXR file.

use super::attributes::{Attributes, Value};
use super::parts::Part;
use crate::io::{exr_text, sort_exr_attributes};
use crate::table::TableError;
use exr::block::chunk::{Chunk, CompressedBlock, CompressedScanLineBlock};
use exr::block::writer::ChunksWriter;
use exr::image::write::layers::WritableLayers;
use exr::meta::header::Header;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Compression, Encoding, FlatSamples, Image,
    ImageAttributes, IntegerBounds, Layer, LayerAttributes, LineOrder, ReadChannels, ReadLayers,
    Text, Vec2, WritableImage,
};
use std::io::{Cursor, Seek, Write};
use std::path::Path;

/// Prefix of all attributes that are ours.
const PREFIX: &str = "vair:";

/// One part of a file.
#[derive(Clone, Debug)]
pub(super) struct RawPart {
    pub(super) name: String,
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) channels: Vec<(String, FlatSamples)>,
    pub(super) attributes: Attributes,
}

/// The bytes of a file that holds `parts`.
pub(super) fn encode(
    parts: Vec<RawPart>,
    compression: Compression,
    path: &Path,
) -> Result<Vec<u8>, TableError> {
    let samples = parts.iter().flat_map(|p| &p.channels);
    let most_bytes =
        4 * samples.map(|(_, samples)| samples.len()).sum::<usize>() + ROOM_FOR_HEADERS;
    let window = window(parts.first().map(|p| (p.width, p.height)));
    let layers: Vec<_> = parts
        .into_iter()
        .map(|part| {
            let size = Vec2(part.width, part.height);
            layer(
                &part.name,
                size,
                &part.attributes,
                compression,
                part.channels,
            )
        })
        .collect();
    let image = Image::from_layers(window, layers);
    let mut bytes = Cursor::new(Vec::with_capacity(most_bytes));
    let written = image.write().to_buffered(&mut bytes);
    written.map_err(|e| TableError::Encode {
        path: path.to_owned(),
        reason: e.to_string(),
    })?;
    let mut bytes = bytes.into_inner();
    sort_exr_attributes(&mut bytes);
    Ok(bytes)
}

/// Writes `parts` as they are: lines are copied from where the numbers lie.
pub(super) fn write_plain(
    parts: &[Part<'_>],
    to: &mut (impl Write + Seek),
) -> exr::error::UnitResult {
    let window = window(parts.first().map(|p| (p.res, 6 * p.res)));
    // Headers tell of names and types only.
    let layers = parts.iter().map(|part| {
        let names = part.channels.iter().map(|(name, _)| name.clone());
        let channels = names.map(|name| (name, FlatSamples::F32(Vec::new())));
        let size = Vec2(part.res, 6 * part.res);
        let plain = Compression::Uncompressed;
        layer(
            &part.name,
            size,
            &part.attributes,
            plain,
            channels.collect(),
        )
    });
    let headers = layers.flat_map(|layer| layer.infer_headers(&window));
    exr::block::write(to, headers.collect(), true, |_, writer| {
        for (layer_index, part) in parts.iter().enumerate() {
            // In the order that the format wants.
            let mut channels: Vec<_> = part.channels.iter().collect();
            channels.sort_by(|a, b| a.0.cmp(&b.0));
            for y in 0..6 * part.res {
                let mut line = Vec::with_capacity(4 * part.res * channels.len());
                for (_, samples) in &channels {
                    let samples = &samples[y * part.res..(y + 1) * part.res];
                    line.extend(samples.iter().flat_map(|v| v.to_le_bytes()));
                }
                let compressed_block = CompressedBlock::ScanLine(CompressedScanLineBlock {
                    y_coordinate: y as i32,
                    compressed_pixels_le: line,
                });
                let chunk = Chunk {
                    layer_index,
                    compressed_block,
                };
                writer.write_chunk(y, chunk)?;
            }
        }
        Ok(())
    })
}

fn window(size: Option<(usize, usize)>) -> ImageAttributes {
    ImageAttributes::new(IntegerBounds::new((0, 0), size.unwrap_or((1, 1))))
}

fn layer(
    name: &str,
    size: Vec2<usize>,
    values: &Attributes,
    compression: Compression,
    channels: Vec<(String, FlatSamples)>,
) -> Layer<AnyChannels<FlatSamples>> {
    let mut attributes = LayerAttributes::named(exr_text(name));
    attributes.software_name = Some(exr_text("vair"));
    for (name, value) in &values.0 {
        let name = exr_text(&format!("{PREFIX}{name}"));
        attributes.other.insert(name, to_exr(value));
    }
    let encoding = Encoding {
        compression,
        blocks: exr::image::Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let channels = channels.into_iter();
    let channels = channels.map(|(name, samples)| AnyChannel::new(exr_text(&name), samples));
    Layer::new(
        size,
        attributes,
        encoding,
        AnyChannels::sort(channels.collect()),
    )
}

/// For headers and offsets of usual files, so that their bytes need not be moved as they grow.
const ROOM_FOR_HEADERS: usize = 1 << 18;

/// The parts of a file in their order, after `check` has seen all headers: nothing is set aside for
/// samples before that.
pub(super) fn decode(
    bytes: &[u8],
    path: &Path,
    check: impl Fn(&[Header]) -> Result<(), TableError>,
) -> Result<Vec<RawPart>, TableError> {
    let not_exr = |e: exr::error::Error| TableError::NotExr {
        path: path.to_owned(),
        reason: e.to_string(),
    };
    let reader = exr::block::read(Cursor::new(bytes), true).map_err(not_exr)?;
    check(reader.headers()).map_err(|e| e.of_file(path))?;
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .pedantic()
        .from_chunks(reader)
        .map_err(not_exr)?;
    Ok(image.layer_data.into_iter().map(part).collect())
}

/// The format version that the first header claims, if any.
pub(super) fn format(headers: &[Header]) -> Option<i32> {
    let name = exr_text(&format!("{PREFIX}format"));
    match headers.first()?.own_attributes.other.get(&name)? {
        AttributeValue::I32(format) => Some(*format),
        _ => None,
    }
}

fn part(layer: Layer<AnyChannels<FlatSamples>>) -> RawPart {
    let name = layer.attributes.layer_name.as_ref().map(Text::to_string);
    let mut attributes = Attributes::default();
    for (name, value) in &layer.attributes.other {
        if let (Some(name), Some(value)) = (name.to_string().strip_prefix(PREFIX), from_exr(value))
        {
            attributes.0.insert(name.to_owned(), value);
        }
    }
    let channels = layer.channel_data.list.into_iter();
    RawPart {
        name: name.unwrap_or_default(),
        width: layer.size.0,
        height: layer.size.1,
        channels: channels
            .map(|channel| (channel.name.to_string(), channel.sample_data))
            .collect(),
        attributes,
    }
}

fn to_exr(value: &Value) -> AttributeValue {
    match value {
        Value::Int(value) => AttributeValue::I32(*value),
        Value::Double(value) => AttributeValue::F64(*value),
        Value::Text(value) => AttributeValue::Text(exr_text(value)),
    }
}

fn from_exr(value: &AttributeValue) -> Option<Value> {
    match value {
        AttributeValue::I32(value) => Some(Value::Int(*value)),
        AttributeValue::F64(value) => Some(Value::Double(*value)),
        AttributeValue::Text(value) => {
            let value = String::from_utf8(value.as_slice().to_vec()).ok()?;
            Some(Value::Text(value))
        }
        _ => None,
    }
}
