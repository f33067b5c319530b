//! Parts of named channels and attributes, to and from the bytes of an OpenEXR file.

use super::attributes::{Attributes, Value};
use crate::io::sort_exr_attributes;
use crate::table::TableError;
use crate::table::check::{MAX_BINS, MAX_LEVELS, MAX_RES, MAX_SAMPLES};
use exr::meta::header::Header;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Compression, Encoding, FlatSamples, Image,
    ImageAttributes, IntegerBounds, Layer, LayerAttributes, LineOrder, ReadChannels, ReadLayers,
    SampleType, SmallVec, Text, Vec2, WritableImage,
};
use std::io::Cursor;
use std::path::Path;

/// Prefix of all attributes that are ours.
const PREFIX: &str = "vair:";

/// One part of a table file: a unicube a channel.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) name: String,
    pub(super) res: usize,
    pub(super) channels: Vec<(String, Vec<f32>)>,
    pub(super) attributes: Attributes,
}

/// The bytes of a file that holds `parts`.
pub(super) fn encode(parts: Vec<Part>, path: &Path) -> Result<Vec<u8>, TableError> {
    let res = parts.first().map_or(1, |p| p.res);
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: exr::image::Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let layers: Vec<_> = parts
        .into_iter()
        .map(|part| {
            let size = Vec2(part.res, 6 * part.res);
            let mut attributes = LayerAttributes::named(text(&part.name));
            attributes.software_name = Some(text("vair"));
            for (name, value) in &part.attributes.0 {
                let name = text(&format!("{PREFIX}{name}"));
                attributes.other.insert(name, to_exr(value));
            }
            let channels = part.channels.into_iter().map(|(name, samples)| {
                let samples = FlatSamples::F32(samples);
                AnyChannel::new(text(&name), samples)
            });
            Layer::new(
                size,
                attributes,
                encoding,
                AnyChannels::sort(channels.collect()),
            )
        })
        .collect();
    let window = IntegerBounds::new((0, 0), (res, 6 * res));
    let image = Image::from_layers(ImageAttributes::new(window), layers);
    let mut bytes = Cursor::new(Vec::new());
    image
        .write()
        .to_buffered(&mut bytes)
        .map_err(|e| TableError::Encode {
            path: path.to_owned(),
            reason: e.to_string(),
        })?;
    let mut bytes = bytes.into_inner();
    sort_exr_attributes(&mut bytes);
    Ok(bytes)
}

/// The parts of a file in their order, after a check of all headers against the limits.
pub(super) fn decode(bytes: &[u8], path: &Path) -> Result<Vec<Part>, TableError> {
    let not_exr = |e: exr::error::Error| TableError::NotExr {
        path: path.to_owned(),
        reason: e.to_string(),
    };
    let reader = exr::block::read(Cursor::new(bytes), true).map_err(not_exr)?;
    check_headers(reader.headers()).map_err(|e| e.of_file(path))?;
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .pedantic()
        .from_chunks(reader)
        .map_err(not_exr)?;
    image
        .layer_data
        .into_iter()
        .map(part)
        .collect::<Result<_, _>>()
        .map_err(|e: TableError| e.of_file(path))
}

/// Refuses what no table claims before memory is set aside for it.
fn check_headers(headers: &[Header]) -> Result<(), TableError> {
    let refuse = |what: String| Err(TableError::Inconsistent(what));
    if headers.len() > MAX_BINS {
        return refuse(format!(
            "it has {} parts; {MAX_BINS} are allowed",
            headers.len()
        ));
    }
    let mut samples = 0usize;
    for (i, header) in headers.iter().enumerate() {
        let Vec2(width, height) = header.layer_size;
        if header.deep || width == 0 || width > MAX_RES || height != 6 * width {
            return refuse(format!(
                "part {i} is {width} x {height}; a flat unicube is N x 6N with N up to {MAX_RES}"
            ));
        }
        let channels = header.channels.list.len();
        if channels > MAX_LEVELS + 1 {
            return refuse(format!("part {i} has {channels} channels"));
        }
        for channel in &header.channels.list {
            if channel.sample_type != SampleType::F32 || channel.sampling != Vec2(1, 1) {
                return refuse(format!(
                    "channel {} of part {i} is not 32-bit float",
                    channel.name
                ));
            }
        }
        samples += channels * width * height;
    }
    if samples > MAX_SAMPLES {
        return refuse(format!(
            "it claims {samples} numbers; {MAX_SAMPLES} are allowed"
        ));
    }
    Ok(())
}

fn part(layer: Layer<AnyChannels<FlatSamples>>) -> Result<Part, TableError> {
    let name = layer.attributes.layer_name.as_ref().map(Text::to_string);
    let mut attributes = Attributes::default();
    for (name, value) in &layer.attributes.other {
        if let (Some(name), Some(value)) = (name.to_string().strip_prefix(PREFIX), from_exr(value))
        {
            attributes.0.insert(name.to_owned(), value);
        }
    }
    let channels = layer.channel_data.list.into_iter().map(|channel| {
        let name = channel.name.to_string();
        match channel.sample_data {
            FlatSamples::F32(samples) => Ok((name, samples)),
            _ => Err(TableError::Inconsistent(format!(
                "channel {name} is not 32-bit float"
            ))),
        }
    });
    Ok(Part {
        name: name.unwrap_or_default(),
        res: layer.size.0,
        channels: channels.collect::<Result<_, _>>()?,
        attributes,
    })
}

/// UTF-8 bytes as they are: OpenEXR does not care, and Python decodes them.
fn text(value: &str) -> Text {
    Text::from_bytes_unchecked(SmallVec::from_slice(value.as_bytes()))
}

fn to_exr(value: &Value) -> AttributeValue {
    match value {
        Value::Int(value) => AttributeValue::I32(*value),
        Value::Double(value) => AttributeValue::F64(*value),
        Value::Text(value) => AttributeValue::Text(text(value)),
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
