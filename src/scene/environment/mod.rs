//! Light from far away: a latitude-longitude picture of radiance, sampled exactly.
//!
//! The middle of the picture is -Z, +X is to the right of it, +Y at the top. To the integrator a
//! texel is a constant patch of sky: texels are chosen by luminance times exact solid angle and
//! evenly inside, so the density of a direction is its luminance over the integral of luminance,
//! and it is zero only where there is no light.

mod bins;
mod builtin;
mod distribution;
mod file;
mod radiance_hdr;
mod sky;

pub use bins::BINS;
pub use file::{EnvironmentError, load};
pub use sky::Sun;

use crate::color::{Rgb, luminance};
use crate::math::quick::{sin_cos_of_turns, turns};
use crate::pages::Table;
use bins::Bins;
use distribution::{CELL, Distribution, Row};
use glam::Vec3;
use std::f64::consts::{PI, TAU};

/// Radiance from every direction.
#[derive(Clone, Debug)]
pub struct Environment {
    width: usize,
    height: usize,
    /// Rows from the top, linear radiance.
    texels: Table<Rgb>,
    /// Texels by luminance times solid angle.
    choice: Distribution,
    /// The same light in few bins.
    bins: Bins,
    /// Height (sine of elevation) of the upper edges of the rows, and of the lower of the last.
    edges: Vec<f64>,
    /// One over the integral of luminance over the sphere; 0 if all is black.
    inverse_power: f32,
    mean: Rgb,
    /// Cosine and sine of the turn about +Y.
    turn: [f32; 2],
}

/// A texel of an [`Environment`] that is about to be read.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    row: usize,
    column: usize,
}

/// A direction that is about to be drawn from an [`Environment`].
#[derive(Clone, Copy, Debug)]
pub struct Aim(Row);

/// A direction drawn from an [`Environment`].
#[derive(Clone, Copy, Debug)]
pub struct EnvironmentSample {
    /// Unit direction to the light.
    pub dir: Vec3,
    /// Radiance from there.
    pub radiance: Rgb,
    /// Density per steradian, > 0.
    pub pdf: f32,
}

impl Environment {
    /// An environment of given texels.
    ///
    /// * `texels`: `width * height` radiances, finite and not negative, rows from the top; rows are
    ///   equally high in angle. Any proportion of width and height will do.
    pub fn from_texels(width: usize, height: usize, texels: Vec<Rgb>) -> Self {
        debug_assert_eq!(texels.len(), width * height);
        let edges: Vec<f64> = (0..=height).map(|y| edge(y, height)).collect();
        let solid_angle = |y: usize| (edges[y] - edges[y + 1]) * TAU / width as f64;
        let mut mean = glam::DVec3::ZERO;
        for (y, row) in texels.chunks_exact(width).enumerate() {
            mean += row.iter().map(|t| t.as_dvec3()).sum::<glam::DVec3>() * solid_angle(y);
        }
        let choice = Distribution::new(width, height, |x, y| {
            f64::from(luminance(texels[y * width + x])) * solid_angle(y)
        });
        let power = choice.total();
        Self {
            width,
            height,
            texels: Table::new(texels),
            bins: Bins::new(choice.across(), &choice.shares()),
            choice,
            edges,
            inverse_power: if power > 0.0 {
                (1.0 / power) as f32
            } else {
                0.0
            },
            mean: (mean / (4.0 * PI)).as_vec3(),
            turn: [1.0, 0.0],
        }
    }

    /// The same light turned about +Y, counter-clockwise seen from above.
    #[must_use]
    pub fn turned(mut self, degrees: f32) -> Self {
        let (sin, cos) = degrees.to_radians().sin_cos();
        self.turn = [cos, sin];
        self
    }

    /// The same light, brighter by a factor >= 0.
    #[must_use]
    pub fn scaled(self, factor: f32) -> Self {
        let texels = self.texels.entries().iter().map(|t| *t * factor).collect();
        Self {
            turn: self.turn,
            ..Self::from_texels(self.width, self.height, texels)
        }
    }

    /// Texels across and down.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Radiance of a texel, before turning; columns from the left, rows from the top.
    pub fn texel_at(&self, column: usize, row: usize) -> Rgb {
        self.texels[row * self.width + column]
    }

    /// The turn about +Y, degrees.
    pub fn turn_deg(&self) -> f32 {
        self.turn[1].atan2(self.turn[0]).to_degrees()
    }

    /// Mean radiance over the sphere.
    pub fn mean(&self) -> Rgb {
        self.mean
    }

    /// Irradiance on a level plane that sees nothing but this environment: the integral of radiance
    /// times height over the upper half.
    pub fn irradiance_up(&self) -> Rgb {
        let mut sum = glam::DVec3::ZERO;
        for (y, row) in self.texels.entries().chunks_exact(self.width).enumerate() {
            let (top, bottom) = (edge(y, self.height), edge(y + 1, self.height));
            let (top, bottom) = (top.max(0.0), bottom.max(0.0));
            let weight = 0.5 * (top * top - bottom * bottom) * TAU / self.width as f64;
            sum += weight * row.iter().map(|t| t.as_dvec3()).sum::<glam::DVec3>();
        }
        sum.as_vec3()
    }

    /// This light weighted with its height above the horizon, which is what a level plane sees of
    /// it: sampling it draws directions by the product of light and cosine.
    pub fn above_horizon(&self) -> Self {
        let mut texels = self.texels.entries().to_vec();
        for (y, row) in texels.chunks_exact_mut(self.width).enumerate() {
            let (top, bottom) = (edge(y, self.height), edge(y + 1, self.height));
            let (above, over) = (top.max(0.0), bottom.max(0.0));
            let mean = 0.5 * (above * above - over * over) / (top - bottom);
            row.iter_mut().for_each(|texel| *texel *= mean as f32);
        }
        Self {
            turn: self.turn,
            ..Self::from_texels(self.width, self.height, texels)
        }
    }

    /// Radiance from a unit direction and the density with which [`Environment::sample`] draws it.
    pub fn eval(&self, dir: Vec3) -> (Rgb, f32) {
        self.eval_at(self.spot(dir))
    }

    /// Where light from a unit direction is looked up; has it brought near, since reading it takes a while.
    #[inline]
    pub fn spot(&self, dir: Vec3) -> Spot {
        let [c, s] = self.turn;
        let (x, z) = (c * dir.x - s * dir.z, c * dir.z + s * dir.x);
        // Turns, to the 24 bits that a direction has.
        let across = 0.5 + turns(x, -z);
        let down = 2.0 * turns((x * x + z * z).sqrt(), dir.y);
        let column = ((across * self.width as f32) as usize).min(self.width - 1);
        let row = ((down * self.height as f32) as usize).min(self.height - 1);
        self.texels.fetch(row * self.width + column);
        Spot { row, column }
    }

    /// As [`Self::eval`].
    #[inline]
    pub fn eval_at(&self, spot: Spot) -> (Rgb, f32) {
        let radiance = self.texels[spot.row * self.width + spot.column];
        (radiance, luminance(radiance) * self.inverse_power)
    }

    /// Share of all light in each bin of directions, > 0; at most [`BINS`].
    pub fn bins(&self) -> &[f32] {
        self.bins.shares()
    }

    /// The bin of a spot that has light.
    #[inline]
    pub fn bin_of(&self, spot: Spot) -> usize {
        let cell = spot.row / CELL * self.choice.across() + spot.column / CELL;
        self.bins.of_cell(cell)
    }

    /// Radiance interpolated between texels, for eyes only: light transport uses [`Self::eval`].
    pub fn smooth(&self, dir: Vec3) -> Rgb {
        let (x, y) = self.locate(dir);
        let (x, y) = (x - 0.5, (y - 0.5).clamp(0.0, (self.height - 1) as f64));
        let (fx, fy) = ((x - x.floor()) as f32, (y - y.floor()) as f32);
        let x0 = (x.floor() as i64).rem_euclid(self.width as i64) as usize;
        let (x1, y0) = ((x0 + 1) % self.width, y as usize);
        let y1 = (y0 + 1).min(self.height - 1);
        let at = |row: usize, column: usize| self.texels[row * self.width + column];
        let upper = at(y0, x0).lerp(at(y0, x1), fx);
        let lower = at(y1, x0).lerp(at(y1, x1), fx);
        upper.lerp(lower, fy)
    }

    /// Draws a direction by luminance from two numbers in `[0, 1)`; `None` if all is black.
    pub fn sample(&self, u: [f32; 2]) -> Option<EnvironmentSample> {
        self.draw(self.aim(u)?)
    }

    /// The same within a bin. The density is that of all bins.
    pub fn sample_in(&self, bin: usize, u: [f32; 2]) -> Option<EnvironmentSample> {
        self.draw(self.aim_in(bin, u))
    }

    /// The first half of [`Self::sample`]; has what the second one reads brought near.
    #[inline]
    pub fn aim(&self, u: [f32; 2]) -> Option<Aim> {
        if self.inverse_power <= 0.0 {
            return None;
        }
        let (cell, rest) = self.choice.cell(u);
        Some(self.aim_at(cell, rest))
    }

    /// The first half of [`Self::sample_in`].
    #[inline]
    pub fn aim_in(&self, bin: usize, u: [f32; 2]) -> Aim {
        let (cell, rest) = self.bins.cell(bin, u[0]);
        self.aim_at(cell, [rest, u[1]])
    }

    #[inline]
    fn aim_at(&self, cell: usize, rest: [f32; 2]) -> Aim {
        let row = self.choice.row(cell, rest);
        let first = row.row * self.width + row.column;
        self.texels.fetch(first);
        self.texels
            .fetch((first + CELL - 1).min(self.width * self.height - 1));
        Aim(row)
    }

    /// The second half of [`Self::sample`].
    #[inline]
    pub fn draw(&self, Aim(row): Aim) -> Option<EnvironmentSample> {
        let first = row.row * self.width;
        let weights = std::array::from_fn(|i| {
            let column = row.column + i;
            if column < self.width {
                luminance(self.texels[first + column])
            } else {
                0.0
            }
        });
        let (column, [s, v]) = row.texel(weights);
        let (radiance, pdf) = self.eval_at(Spot {
            row: row.row,
            column,
        });
        let [top, bottom] = [self.edges[row.row], self.edges[row.row + 1]];
        let up = top - f64::from(v) * (top - bottom);
        let across = ((column as f64 + f64::from(s)) / self.width as f64 - 0.5) as f32;
        let flat = (1.0 - up * up).max(0.0).sqrt() as f32;
        let (sin, cos) = sin_cos_of_turns(across);
        let d = Vec3::new(flat * sin, up as f32, -flat * cos);
        let [c, s] = self.turn;
        let dir = Vec3::new(c * d.x + s * d.z, d.y, c * d.z - s * d.x);
        (pdf > 0.0).then_some(EnvironmentSample { dir, radiance, pdf })
    }

    /// Picture coordinates in texels.
    fn locate(&self, dir: Vec3) -> (f64, f64) {
        let [c, s] = self.turn;
        let (x, z) = (c * dir.x - s * dir.z, c * dir.z + s * dir.x);
        let azimuth = f64::from(x).atan2(-f64::from(z));
        let polar = f64::from(x).hypot(f64::from(z)).atan2(f64::from(dir.y));
        (
            (0.5 + azimuth / TAU) * self.width as f64,
            polar / PI * self.height as f64,
        )
    }
}

/// Height (sine of elevation) of the upper edge of a row.
fn edge(row: usize, height: usize) -> f64 {
    (PI * row as f64 / height as f64).cos()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Sobol;

    /// Direction of the middle of a texel, before turning.
    fn texel_direction(x: f64, y: f64) -> Vec3 {
        let (sin_p, cos_p) = ((x - 0.5) * TAU).sin_cos();
        let (sin_t, cos_t) = (y * PI).sin_cos();
        glam::DVec3::new(sin_t * sin_p, cos_t, -sin_t * cos_p).as_vec3()
    }

    /// Height of a row's band: its solid angle over 2 pi.
    fn band(row: usize, height: usize) -> f64 {
        edge(row, height) - edge(row + 1, height)
    }

    fn environments() -> Vec<Environment> {
        let half = |i: usize| if i % 64 < 32 { Rgb::ONE } else { Rgb::ZERO };
        vec![
            Environment::white(),
            Environment::studio().turned(30.0),
            Environment::sky(&Sun::default()).turned(-70.0),
            Environment::from_texels(64, 32, (0..64 * 32).map(half).collect()),
        ]
    }

    #[test]
    fn density_integrates_to_one() {
        for env in environments() {
            let (nx, ny) = (2 * env.width, 2 * env.height);
            let mut sum = 0.0;
            for y in 0..ny {
                for x in 0..nx {
                    let u = (x as f64 + 0.5) / nx as f64;
                    let d = texel_direction(u, (y as f64 + 0.5) / ny as f64);
                    sum += f64::from(env.eval(d).1) * band(y, ny) * TAU / nx as f64;
                }
            }
            assert!((sum - 1.0).abs() < 1e-4, "{sum}");
        }
    }

    /// Samples fall into 16 x 8 cells as often as the density says (chi-squared, 4 sigma of its
    /// normal approximation).
    #[test]
    fn samples_follow_the_density() {
        for env in environments() {
            let (nx, ny) = (16, 8);
            // Cells and this grid have texel edges as theirs: all sizes are powers of two.
            let (fx, fy) = (env.width.max(nx), env.height.max(ny));
            let mut expected = vec![0.0; nx * ny];
            for y in 0..fy {
                for x in 0..fx {
                    let (row, column) = (y * env.height / fy, x * env.width / fx);
                    let (_, pdf) = env.eval_at(Spot { row, column });
                    let cell = y * ny / fy * nx + x * nx / fx;
                    expected[cell] += f64::from(pdf) * band(y, fy) * TAU / fx as f64;
                }
            }
            let n = 1 << 17;
            let mut seen = vec![0.0; nx * ny];
            for i in 0..n {
                let mut rng = crate::sampling::Rng::new(4, i);
                let sample = env.sample([rng.uniform_f32(), rng.uniform_f32()]).unwrap();
                let (radiance, pdf) = env.eval(sample.dir);
                // Rounding may carry a direction over a texel's edge, rarely.
                assert!(pdf == sample.pdf || radiance != sample.radiance);
                let (x, y) = env.locate(sample.dir);
                let column = (x * nx as f64) as usize / env.width;
                let row = (y * ny as f64) as usize / env.height;
                seen[row.min(ny - 1) * nx + column.min(nx - 1)] += 1.0;
            }
            let (mut chi2, mut cells) = (0.0, 0.0);
            for (e, s) in expected.iter().zip(&seen) {
                let e = e * n as f64;
                if e > 5.0 {
                    chi2 += (s - e) * (s - e) / e;
                    cells += 1.0;
                } else {
                    assert!(*s < 25.0);
                }
            }
            let z = (chi2 - (cells - 1.0)) / (2.0f64 * (cells - 1.0)).sqrt().max(1.0);
            assert!(z < 4.0, "z = {z} of {cells} cells");
        }
    }

    #[test]
    fn sampled_mean_is_the_mean() {
        for env in environments() {
            let net = Sobol::new(7);
            let (n, mut sum) = (4096, glam::DVec3::ZERO);
            for i in 0..n {
                let u = net.point(i);
                let s = env.sample([u[0], u[1]]).unwrap();
                sum += (s.radiance / s.pdf).as_dvec3();
            }
            let mean = (sum / f64::from(n) / (4.0 * PI)).as_vec3();
            let error = (luminance(mean) / luminance(env.mean()) - 1.0).abs();
            assert!(error < 1e-3, "{error}");
        }
    }

    #[test]
    fn turning_moves_the_light() {
        let mut texels = vec![Rgb::ZERO; 8 * 4];
        texels[8 + 4] = Rgb::ONE;
        let env = Environment::from_texels(8, 4, texels);
        let from = env.sample([0.5, 0.5]).unwrap().dir;
        let turned = env.turned(90.0).sample([0.5, 0.5]).unwrap().dir;
        let expected = glam::Quat::from_rotation_y(90f32.to_radians()) * from;
        assert!((turned - expected).length() < 1e-5);
    }

    #[test]
    fn black_has_no_samples() {
        assert!(
            Environment::from_texels(2, 1, vec![Rgb::ZERO; 2])
                .sample([0.3, 0.3])
                .is_none()
        );
    }
}
