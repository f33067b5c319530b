//! Pictures as maps: one number a pixel, looked up by texture coordinates.

use super::{Decoded, FileError, decode_exr, read_bounded};
use crate::blame::Blame;
use crate::color::{Rgb, luminance};
use glam::Vec2;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Largest file read, bytes, and most pixels.
const FILE_LIMIT: u64 = 1 << 30;
const PIXEL_LIMIT: usize = 1 << 28;

/// What of a picture counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Luminance of linear Rec.709.
    Luminance,
    /// Red.
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
    /// Opacity, 1 where the file has none.
    Alpha,
}

impl Channel {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Luminance,
        Self::Red,
        Self::Green,
        Self::Blue,
        Self::Alpha,
    ];

    fn of(self, [r, g, b, a]: [f32; 4]) -> f32 {
        match self {
            Self::Luminance => luminance(Rgb::new(r, g, b)),
            Self::Red => r,
            Self::Green => g,
            Self::Blue => b,
            Self::Alpha => a,
        }
    }
}

/// How the numbers of a PNG are read; those of an EXR are linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// Colors encoded by the sRGB curve (IEC 61966-2-1); opacity never is.
    Srgb,
    /// As they are.
    Linear,
}

/// A picture that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The name ends in something else.
    #[error("{} is no map: the name must end in .png or .exr", path.display())]
    Kind {
        /// The file.
        path: PathBuf,
    },
    /// The bytes are not what the name says.
    #[error("cannot read {} as a picture: {reason}", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// What the decoder met.
        reason: String,
    },
    /// Not a number.
    #[error("{} holds {value} at pixel ({x}, {y})", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// From the left.
        x: usize,
        /// From the top.
        y: usize,
        /// What is there.
        value: f32,
    },
}

impl PictureError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::File(error) => error.blame(),
            _ => Blame::Input,
        }
    }
}

/// One number a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: usize,
    height: usize,
    /// Rows from the top, finite.
    values: Vec<f32>,
}

impl Picture {
    /// Reads one channel of a PNG or EXR file.
    ///
    /// # Errors
    /// A file that is missing, too large, broken, or holds what is not finite.
    pub fn read(path: &Path, channel: Channel, space: Space) -> Result<Self, PictureError> {
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        let decode = match ending.to_ascii_lowercase().as_str() {
            "png" => png,
            "exr" => |bytes: &[u8], _| decode_exr(bytes, PIXEL_LIMIT, |rgba| rgba),
            _ => return Err(PictureError::Kind { path: path.into() }),
        };
        let bytes = read_bounded(path, FILE_LIMIT)?;
        let (width, height, pixels) =
            decode(&bytes, space).map_err(|reason| PictureError::Broken {
                path: path.into(),
                reason,
            })?;
        let values: Vec<f32> = pixels.into_iter().map(|p| channel.of(p)).collect();
        if let Some(i) = values.iter().position(|v| !v.is_finite()) {
            return Err(PictureError::Value {
                path: path.into(),
                x: i % width,
                y: i / width,
                value: values[i],
            });
        }
        Ok(Self {
            width,
            height,
            values,
        })
    }

    /// A picture of given numbers, rows from the top. `None` if they are not as many as pixels.
    pub fn new(width: usize, height: usize, values: Vec<f32>) -> Option<Self> {
        let whole = width > 0 && width.checked_mul(height) == Some(values.len());
        (whole && values.iter().all(|v| v.is_finite())).then_some(Self {
            width,
            height,
            values,
        })
    }

    /// The number at texture coordinates, (0, 0) at the lower left: bilinear, repeating beyond 0..1.
    pub fn at(&self, uv: Vec2) -> f32 {
        let place = |t: f32, n: usize| {
            let x = (t - t.floor()) * n as f32 - 0.5;
            let low = x.floor();
            let at = |i: f32| (i as i64).rem_euclid(n as i64) as usize;
            (at(low), at(low + 1.0), x - low)
        };
        let (x0, x1, fx) = place(uv.x, self.width);
        let (y0, y1, fy) = place(1.0 - uv.y, self.height);
        let value = |x: usize, y: usize| self.values[y * self.width + x];
        let row = |y: usize| value(x0, y) * (1.0 - fx) + value(x1, y) * fx;
        row(y0) * (1.0 - fy) + row(y1) * fy
    }
}

/// Linear RGBA of a PNG.
fn png(bytes: &[u8], space: Space) -> Decoded<[f32; 4]> {
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(|e| e.to_string())?;
    let (width, height) = (reader.info().width, reader.info().height);
    if u64::from(width) * u64::from(height) > PIXEL_LIMIT as u64 {
        return Err(format!("{width} x {height} pixels are too many"));
    }
    let size = reader.output_buffer_size().ok_or("it is too large")?;
    let mut data = vec![0; size];
    let frame = reader.next_frame(&mut data).map_err(|e| e.to_string())?;
    let deep = frame.bit_depth == png::BitDepth::Sixteen;
    let samples = frame.color_type.samples();
    let sample = |pixel: &[u8], i: usize| {
        if deep {
            f32::from(u16::from_be_bytes([pixel[2 * i], pixel[2 * i + 1]])) / 65_535.0
        } else {
            f32::from(pixel[i]) / 255.0
        }
    };
    let color = |v: f32| match space {
        Space::Linear => v,
        Space::Srgb if v <= 0.040_45 => v / 12.92,
        Space::Srgb => ((v + 0.055) / 1.055).powf(2.4),
    };
    let bytes_a_pixel = samples * if deep { 2 } else { 1 };
    let pixels = data[..frame.buffer_size()]
        .chunks_exact(bytes_a_pixel)
        .map(|p| {
            let v = |i| color(sample(p, i));
            match samples {
                1 => [v(0), v(0), v(0), 1.0],
                2 => [v(0), v(0), v(0), sample(p, 1)],
                3 => [v(0), v(1), v(2), 1.0],
                _ => [v(0), v(1), v(2), sample(p, 3)],
            }
        })
        .collect();
    Ok((width as usize, height as usize, pixels))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_and_linear_maps_are_read_the_right_way_up() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.png");
        // White above, middle gray below.
        let rgb = [[255u8; 6], [128; 6]].concat();
        let mut encoder = png::Encoder::new(std::fs::File::create(&path).unwrap(), 2, 2);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&rgb).unwrap();
        writer.finish().unwrap();
        let read = |space| Picture::read(&path, Channel::Luminance, space).unwrap();
        let (top, bottom) = (Vec2::new(0.5, 0.75), Vec2::new(0.5, 0.25));
        let (srgb, linear) = (read(Space::Srgb), read(Space::Linear));
        assert!((srgb.at(top) - 1.0).abs() < 1e-6 && (linear.at(top) - 1.0).abs() < 1e-6);
        assert!((srgb.at(bottom) - 0.21586).abs() < 1e-4);
        assert!((linear.at(bottom) - 128.0 / 255.0).abs() < 1e-6);
        // Alpha of an opaque picture.
        let opaque = Picture::read(&path, Channel::Alpha, Space::Srgb).unwrap();
        assert_eq!(opaque.at(top), 1.0);
    }

    #[test]
    fn lookups_are_bilinear_and_repeat() {
        let picture = Picture::new(2, 1, vec![0.0, 1.0]).unwrap();
        let at = |u: f32| picture.at(Vec2::new(u, 0.3));
        assert!((at(0.25)).abs() < 1e-6 && (at(0.5) - 0.5).abs() < 1e-6);
        assert!((at(0.75) - 1.0).abs() < 1e-6 && (at(1.0) - 0.5).abs() < 1e-6);
        assert!((at(-1.5) - at(0.5)).abs() < 1e-6);
    }

    #[test]
    fn a_picture_that_announces_too_much_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.exr");
        let bytes = crate::io::boastful_exr(1 << 20, 1 << 20);
        std::fs::write(&path, bytes).unwrap();
        let error = Picture::read(&path, Channel::Red, Space::Linear).unwrap_err();
        assert!(error.to_string().contains("too many"), "{error}");
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.png", "a.exr", "a.jpg", "missing.png"] {
            let path = folder.path().join(name);
            if !name.starts_with("missing") {
                std::fs::write(&path, b"no picture at all").unwrap();
            }
            let error = Picture::read(&path, Channel::Red, Space::Linear).unwrap_err();
            assert!(error.to_string().contains(name), "{error}");
        }
    }
}
