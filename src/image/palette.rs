//! Small PNG files for documents: gray pictures as gray, others with a palette.

use super::Canvas;
use super::png::write_encoded;
use crate::io::FileError;
use std::collections::HashMap;
use std::path::Path;

/// A color of a picture and how many pixels have it.
type Counted = ([u8; 3], u64);

impl Canvas {
    /// Writes the picture as a small PNG: 8-bit gray if it is gray, else with a palette of `colors`
    /// colors by median cut (Heckbert 1982), without dithering, which would not compress.
    ///
    /// * `colors`: 2..=256; below 64 skies and shafts show steps.
    pub fn write_small_png(&self, path: &Path, colors: usize) -> Result<(), FileError> {
        let rgb = self.to_rgb8();
        let pixels: Vec<[u8; 3]> = rgb.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
        let size = (self.width() as u32, self.height() as u32);
        if pixels
            .iter()
            .all(|p| p[0].abs_diff(p[1]) < 4 && p[1].abs_diff(p[2]) < 8)
        {
            let gray: Vec<u8> = pixels.iter().map(|p| p[1]).collect();
            return write_encoded(path, size, &gray, |encoder| {
                encoder.set_color(png::ColorType::Grayscale);
                encoder.set_filter(png::Filter::Adaptive);
            });
        }
        let (palette, index) = palette(&pixels, colors.clamp(2, 256));
        let indices: Vec<u8> = pixels.iter().map(|p| index[p]).collect();
        write_encoded(path, size, &indices, |encoder| {
            encoder.set_color(png::ColorType::Indexed);
            encoder.set_palette(palette.concat());
            encoder.set_filter(png::Filter::NoFilter);
        })
    }
}

/// Colors, and which of them stands for each color of the picture.
fn palette(pixels: &[[u8; 3]], colors: usize) -> (Vec<[u8; 3]>, HashMap<[u8; 3], u8>) {
    let mut counts: HashMap<[u8; 3], u64> = HashMap::new();
    for pixel in pixels {
        *counts.entry(*pixel).or_default() += 1;
    }
    let mut all: Vec<Counted> = counts.into_iter().collect();
    // The map's order is random, the file must not be.
    all.sort_unstable();
    let mut boxes = vec![all];
    while boxes.len() < colors {
        // Split where it helps most: many pixels over a wide range.
        let widest = boxes
            .iter()
            .enumerate()
            .map(|(i, b)| (worth(b), i))
            .max()
            .filter(|(worth, _)| *worth > 0);
        let Some((_, i)) = widest else { break };
        let mut one = boxes.swap_remove(i);
        let (axis, _) = extent(&one);
        one.sort_unstable_by_key(|(color, _)| (color[axis], *color));
        let half = one.iter().map(|(_, n)| n).sum::<u64>() / 2;
        let mut below = 0;
        let cut = one
            .iter()
            .position(|(_, n)| {
                below += n;
                below > half
            })
            .unwrap_or(1)
            .clamp(1, one.len() - 1);
        let other = one.split_off(cut);
        boxes.extend([one, other]);
    }
    let mut index = HashMap::new();
    let mean = |colors: &[Counted], axis: usize| {
        let total: u64 = colors.iter().map(|(_, n)| n).sum();
        let sum: u64 = colors.iter().map(|(c, n)| u64::from(c[axis]) * n).sum();
        ((sum + total / 2) / total.max(1)) as u8
    };
    let mut palette = Vec::with_capacity(boxes.len());
    for (i, colors) in boxes.iter().enumerate() {
        palette.push([0, 1, 2].map(|axis| mean(colors, axis)));
        index.extend(colors.iter().map(|(color, _)| (*color, i as u8)));
    }
    (palette, index)
}

/// The channel that varies most, and by how much.
fn extent(colors: &[Counted]) -> (usize, u64) {
    let range = |axis: usize| {
        let values = colors.iter().map(|(c, _)| c[axis]);
        let (lo, hi) = values.fold((255, 0), |(lo, hi): (u8, u8), v| (lo.min(v), hi.max(v)));
        (u64::from(hi.saturating_sub(lo)), axis)
    };
    let (width, axis) = [0, 1, 2].map(range).into_iter().max().unwrap_or_default();
    (axis, width)
}

fn worth(colors: &[Counted]) -> u64 {
    let total: u64 = colors.iter().map(|(_, n)| n).sum();
    let (_, width) = extent(colors);
    total * width * width
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Vec2, Vec3};

    #[test]
    fn few_colors_stay_exact_and_many_come_close() {
        let few: Vec<[u8; 3]> = (0..100).map(|i| [i % 4 * 60, 10, 200]).collect();
        let (palette_of_few, index) = palette(&few, 16);
        assert_eq!(palette_of_few.len(), 4);
        assert!(
            few.iter()
                .all(|p| palette_of_few[usize::from(index[p])] == *p)
        );
        let many: Vec<[u8; 3]> = (0..=255).map(|i| [i, i / 2, 255 - i]).collect();
        let (palette_of_many, index) = palette(&many, 64);
        assert_eq!(palette_of_many.len(), 64);
        let off = |p: &[u8; 3]| palette_of_many[usize::from(index[p])][0].abs_diff(p[0]);
        assert!(many.iter().all(|p| off(p) <= 4));
    }

    #[test]
    fn small_files_read_back() {
        let folder = tempfile::tempdir().unwrap();
        for color in [Vec3::splat(0.5), Vec3::new(0.9, 0.5, 0.1)] {
            let mut canvas = Canvas::new(40, 30, Vec3::ONE);
            canvas.fill_rect(Vec2::new(5.0, 5.0), Vec2::new(20.0, 20.0), color);
            let path = folder.path().join("small.png");
            canvas.write_small_png(&path, 64).unwrap();
            let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
            let mut decoder = png::Decoder::new(file);
            decoder.set_transformations(png::Transformations::EXPAND);
            let mut reader = decoder.read_info().unwrap();
            let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
            let info = reader.next_frame(&mut bytes).unwrap();
            assert_eq!((info.width, info.height), (40, 30));
            let channels = info.color_type.samples();
            let at = (10 * 40 + 10) * channels;
            assert_eq!(bytes[at], (color.x * 255.0 + 0.5) as u8);
            assert!(std::fs::metadata(&path).unwrap().len() < 400);
        }
    }
}
