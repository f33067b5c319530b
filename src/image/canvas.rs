//! A canvas in display values (sRGB-encoded, 0..1) for plots, labels and scale bars.
//!
//! Coordinates are pixels, x to the right, y down; pixel centers are at half-integers.

use super::write_png;
use crate::io::{FileError, read_bounded};
use font8x8::UnicodeFonts;
use glam::{Vec2, Vec3};
use std::path::Path;

/// Largest file read, bytes.
const FILE_LIMIT: u64 = 1 << 30;

/// Height of a line of text at scale 1, pixels.
pub const GLYPH_HEIGHT: f32 = 8.0;

/// Width of a text at a scale, pixels.
pub fn text_width(text: &str, scale: f32) -> f32 {
    text.chars().count() as f32 * 8.0 * scale
}

/// A picture being drawn.
#[derive(Clone, Debug)]
pub struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<Vec3>,
}

impl Canvas {
    /// A canvas filled with one color.
    pub fn new(width: usize, height: usize, color: Vec3) -> Self {
        Self {
            width,
            height,
            pixels: vec![color; width * height],
        }
    }

    /// Reads an 8-bit PNG with three channels, as [`Canvas::write_png`] writes it.
    ///
    /// # Errors
    /// A file that cannot be read, or of another kind.
    pub fn read_png(path: &Path) -> Result<Self, FileError> {
        let bytes = read_bounded(path, FILE_LIMIT)?;
        let fail = |what: String| {
            let reason = std::io::Error::new(std::io::ErrorKind::InvalidData, what);
            FileError::new("read", path, reason)
        };
        let decode = |bytes: &[u8]| {
            let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info()?;
            let mut data = vec![0; reader.output_buffer_size().unwrap_or(0)];
            Ok::<_, png::DecodingError>((reader.next_frame(&mut data)?, data))
        };
        let (info, data) = decode(&bytes).map_err(|e| fail(e.to_string()))?;
        if (info.color_type, info.bit_depth) != (png::ColorType::Rgb, png::BitDepth::Eight) {
            return Err(fail("it is not of three channels of 8 bits".to_owned()));
        }
        let pixels = data[..info.buffer_size()].as_chunks::<3>().0;
        Ok(Self {
            width: info.width as usize,
            height: info.height as usize,
            pixels: (pixels.iter())
                .map(|rgb| Vec3::from_array(rgb.map(|v| f32::from(v) / 255.0)))
                .collect(),
        })
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The color of a pixel.
    pub fn get(&self, x: usize, y: usize) -> Vec3 {
        self.pixels[y * self.width + x]
    }

    /// Sets a pixel; outside the canvas nothing happens.
    pub fn set(&mut self, x: usize, y: usize, color: Vec3) {
        if x < self.width && y < self.height {
            self.pixels[y * self.width + x] = color;
        }
    }

    /// Mixes `color` into a pixel by `coverage` 0..1.
    pub fn blend(&mut self, x: i64, y: i64, color: Vec3, coverage: f32) {
        if x >= 0 && y >= 0 && (x as usize) < self.width && (y as usize) < self.height {
            let pixel = &mut self.pixels[y as usize * self.width + x as usize];
            *pixel = pixel.lerp(color, coverage.clamp(0.0, 1.0));
        }
    }

    /// Fills an axis-aligned rectangle; fractional edges are smooth.
    pub fn fill_rect(&mut self, min: Vec2, max: Vec2, color: Vec3) {
        let cover = |lo: f32, hi: f32, i: i64| (hi.min(i as f32 + 1.0) - lo.max(i as f32)).max(0.0);
        for y in min.y.floor() as i64..max.y.ceil() as i64 {
            for x in min.x.floor() as i64..max.x.ceil() as i64 {
                self.blend(x, y, color, cover(min.x, max.x, x) * cover(min.y, max.y, y));
            }
        }
    }

    /// A smooth line with round ends.
    pub fn line(&mut self, a: Vec2, b: Vec2, width: f32, color: Vec3) {
        let r = 0.5 * width;
        let lo = a.min(b) - (r + 1.0);
        let hi = a.max(b) + (r + 1.0);
        let axis = b - a;
        let inv = 1.0 / axis.length_squared().max(1e-12);
        let size = Vec2::new(self.width as f32, self.height as f32);
        for y in lo.y.max(0.0) as i64..=hi.y.min(size.y) as i64 {
            for x in lo.x.max(0.0) as i64..=hi.x.min(size.x) as i64 {
                let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let along = ((p - a).dot(axis) * inv).clamp(0.0, 1.0);
                let distance = p.distance(a + axis * along);
                self.blend(x, y, color, r + 0.5 - distance);
            }
        }
    }

    /// A chain of smooth lines.
    pub fn polyline(&mut self, points: &[Vec2], width: f32, color: Vec3) {
        for pair in points.windows(2) {
            self.line(pair[0], pair[1], width, color);
        }
    }

    /// Draws text with its upper left corner at `at`; characters that the font lacks are left blank.
    pub fn text(&mut self, at: Vec2, text: &str, scale: f32, color: Vec3) {
        for (i, c) in text.chars().enumerate() {
            let glyph = font8x8::BASIC_FONTS
                .get(c)
                .or_else(|| font8x8::LATIN_FONTS.get(c))
                .or_else(|| font8x8::GREEK_FONTS.get(c));
            for (row, bits) in glyph.unwrap_or_default().iter().enumerate() {
                for column in (0..8).filter(|column| bits >> column & 1 == 1) {
                    let cell = Vec2::new((8 * i + column) as f32, row as f32);
                    let min = at + cell * scale;
                    self.fill_rect(min, min + scale, color);
                }
            }
        }
    }

    /// A smaller canvas, each pixel the mean of `factor` x `factor` in linear light.
    pub fn downsampled(&self, factor: usize) -> Self {
        let (width, height) = (self.width / factor, self.height / factor);
        let mut out = Self::new(width, height, Vec3::ZERO);
        for y in 0..height {
            for x in 0..width {
                let mut sum = Vec3::ZERO;
                for (dy, dx) in (0..factor).flat_map(|dy| (0..factor).map(move |dx| (dy, dx))) {
                    let pixel = self.get(x * factor + dx, y * factor + dy);
                    sum += pixel.map(crate::color::linear_from_srgb);
                }
                let mean = sum / (factor * factor) as f32;
                out.set(x, y, mean.map(crate::color::srgb_from_linear));
            }
        }
        out
    }

    /// Copies another canvas with its upper left corner at `(x, y)`.
    pub fn paste(&mut self, other: &Self, x: usize, y: usize) {
        for row in 0..other.height {
            for column in 0..other.width {
                self.set(x + column, y + row, other.get(column, row));
            }
        }
    }

    /// The picture as 8-bit RGB bytes, rows from the top.
    pub fn to_rgb8(&self) -> Vec<u8> {
        let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        self.pixels
            .iter()
            .flat_map(|p| p.to_array().map(byte))
            .collect()
    }

    /// Writes the picture as PNG.
    pub fn write_png(&self, path: &Path) -> Result<(), FileError> {
        write_png(
            path,
            self.width as u32,
            self.height as u32,
            &self.to_rgb8(),
            &[],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_cover_their_area() {
        let mut canvas = Canvas::new(20, 20, Vec3::ZERO);
        canvas.fill_rect(Vec2::new(2.25, 3.5), Vec2::new(10.75, 7.25), Vec3::ONE);
        let sum: f32 = (0..400).map(|i| canvas.get(i % 20, i / 20).x).sum();
        assert!((sum - 8.5 * 3.75).abs() < 1e-3);
    }

    #[test]
    fn a_picture_comes_back_from_its_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let mut canvas = Canvas::new(5, 3, Vec3::new(0.2, 0.4, 1.0));
        canvas.set(4, 0, Vec3::X);
        canvas.write_png(&path).unwrap();
        let back = Canvas::read_png(&path).unwrap();
        assert_eq!((back.width(), back.to_rgb8()), (5, canvas.to_rgb8()));
        canvas.write_small_png(&path, 16).unwrap();
        assert!(Canvas::read_png(&path).is_err());
        std::fs::write(&path, b"no picture").unwrap();
        assert!(Canvas::read_png(&path).is_err());
    }

    #[test]
    fn text_draws_and_stays_inside() {
        let mut canvas = Canvas::new(40, 12, Vec3::ONE);
        canvas.text(Vec2::new(1.0, 2.0), "µm θ", 1.0, Vec3::ZERO);
        let dark = (0..480)
            .filter(|i| canvas.get(i % 40, i / 40).x < 0.5)
            .count();
        assert!(dark > 30, "{dark}");
    }
}
