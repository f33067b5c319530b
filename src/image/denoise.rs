//! Noise out, hair in: non-local means steered by the measured variance of each pixel.
//!
//! A pixel becomes the mean of the pixels around it whose surroundings look the same *within their
//! noise* (Buades, Coll and Morel 2005; the variance-normalized distance of Rousselle, Knaus and
//! Zwicker 2012). Detail above the noise stays; below it, it cannot be told from noise.

use crate::color::{Rgb, luminance};
use crate::render::{Film, Pixel};
use rayon::prelude::*;

/// Pixels are compared with others up to this far away. Larger finds more of a kind and costs the
/// square of it; beyond 8 little is gained.
const REACH: i64 = 6;

/// Half the side of the patches compared, pixels: 1 leaves specks, 3 smears single hairs.
const PATCH: i64 = 2;

/// Differences of this many standard deviations are still the same thing: 0.3 leaves noise, 0.7
/// turns fur to felt.
const STRICTNESS: f32 = 0.45;

/// The picture with less noise; everything but the radiance is kept.
pub fn denoise(film: &Film) -> Film {
    let picture = Picture::new(film);
    let height = picture.height;
    let rows: Vec<Vec<Pixel>> = (0..height)
        .into_par_iter()
        .map(|y| picture.row(film, y))
        .collect();
    Film {
        pixels: rows.concat(),
        ..film.clone()
    }
}

struct Picture {
    width: i64,
    height: i64,
    luminance: Vec<f32>,
    variance: Vec<f32>,
}

impl Picture {
    fn new(film: &Film) -> Self {
        let (width, height) = (i64::from(film.crop.width), i64::from(film.crop.height));
        let luminance = film.pixels.iter().map(|p| luminance(p.radiance)).collect();
        let raw: Vec<f32> = film.pixels.iter().map(|p| p.variance).collect();
        // A variance from few samples is itself noisy: the mean of 3 x 3 is steadier.
        let variance = (0..width * height)
            .map(|i| {
                let (x, y) = (i % width, i / width);
                let (mut sum, mut count) = (0.0, 0.0f32);
                for v in (y - 1).max(0)..=(y + 1).min(height - 1) {
                    for u in (x - 1).max(0)..=(x + 1).min(width - 1) {
                        sum += raw[(v * width + u) as usize];
                        count += 1.0;
                    }
                }
                sum / count
            })
            .collect();
        Self {
            width,
            height,
            luminance,
            variance,
        }
    }

    fn row(&self, film: &Film, y: i64) -> Vec<Pixel> {
        (0..self.width)
            .map(|x| {
                let (mut sum, mut total) = (Rgb::ZERO, 0.0);
                for v in (y - REACH).max(0)..=(y + REACH).min(self.height - 1) {
                    for u in (x - REACH).max(0)..=(x + REACH).min(self.width - 1) {
                        let weight = (-self.distance(x, y, u, v)).exp();
                        sum += weight * film.pixels[(v * self.width + u) as usize].radiance;
                        total += weight;
                    }
                }
                let pixel = film.pixels[(y * self.width + x) as usize];
                Pixel {
                    radiance: sum / total,
                    ..pixel
                }
            })
            .collect()
    }

    /// Mean squared difference of two patches in units of the noise, 0 where it explains them.
    fn distance(&self, x: i64, y: i64, u: i64, v: i64) -> f32 {
        let (mut sum, mut count) = (0.0, 0.0f32);
        for dy in -PATCH..=PATCH {
            for dx in -PATCH..=PATCH {
                let (Some(p), Some(q)) = (self.index(x + dx, y + dy), self.index(u + dx, v + dy))
                else {
                    continue;
                };
                let (a, b) = (self.variance[p], self.variance[q]);
                let difference = self.luminance[p] - self.luminance[q];
                sum += (difference * difference - (a + a.min(b)))
                    / (STRICTNESS * STRICTNESS * (a + b) + 1e-8);
                count += 1.0;
            }
        }
        (sum / count).max(0.0)
    }

    fn index(&self, x: i64, y: i64) -> Option<usize> {
        let inside = (0..self.width).contains(&x) && (0..self.height).contains(&y);
        inside.then(|| (y * self.width + x) as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{Crop, NO_STRAND, Report};
    use crate::sampling::Rng;
    use glam::{Vec2, Vec3};

    /// Two gray halves with a sharp edge and noise of a known variance.
    fn noisy_halves(sigma: f64) -> Film {
        let (width, height) = (48, 32);
        let mut rng = Rng::new(1, 2);
        let pixels = (0..width * height)
            .map(|i| {
                let truth = if i % width < width / 2 { 0.3 } else { 0.6 };
                let value = truth + sigma * rng.normal_pair().0;
                Pixel {
                    radiance: Rgb::splat(value as f32),
                    alpha: 1.0,
                    variance: (sigma * sigma) as f32,
                    samples: 16,
                    depth: 1.0,
                    albedo: Rgb::ONE,
                    normal: Vec3::Z,
                    tangent: Vec3::X,
                    strand: NO_STRAND,
                    root_uv: Vec2::ZERO,
                }
            })
            .collect();
        let crop = Crop {
            x: 0,
            y: 0,
            width,
            height,
        };
        Film {
            crop,
            resolution: [width, height],
            pixels,
            mattes: None,
            report: Report::default(),
        }
    }

    #[test]
    fn noise_shrinks_and_edges_stay() {
        let film = noisy_halves(0.05);
        let clean = denoise(&film);
        let error = |film: &Film| {
            let square = |(i, p): (usize, &Pixel)| {
                let truth = if i % 48 < 24 { 0.3 } else { 0.6 };
                f64::from(p.radiance.x - truth).powi(2)
            };
            (film.pixels.iter().enumerate().map(square).sum::<f64>() / 1536.0).sqrt()
        };
        assert!(
            error(&clean) < 0.25 * error(&film),
            "{} {}",
            error(&clean),
            error(&film)
        );
        let step = clean.pixels[16 * 48 + 25].radiance.x - clean.pixels[16 * 48 + 22].radiance.x;
        assert!(step > 0.27, "the edge is {step} high");
    }

    #[test]
    fn a_clean_picture_is_kept() {
        let film = noisy_halves(0.0);
        let clean = denoise(&film);
        for (a, b) in film.pixels.iter().zip(&clean.pixels) {
            assert!((a.radiance - b.radiance).abs().max_element() < 1e-6);
        }
    }
}
