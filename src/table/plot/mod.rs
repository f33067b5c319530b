//! Pictures of a scattering function for one inclination of the query direction: the sphere of
//! directions as a map, the lobe in space, the light by azimuth, and the albedo over inclination.

mod albedo;
mod azimuth;
mod colormap;
mod difference;
mod frame3d;
mod lobe;
mod sphere_map;
mod text;

pub use azimuth::SmoothCylinder;
pub use difference::DifferencePlot;

use super::{Mode, ScatterMaps, ScatterTable, TableError};
use crate::image::{Canvas, GLYPH_HEIGHT};
use crate::math::frame;
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use sphere_map::MapStyle;
use text::Pen;

/// Everything is drawn this many times larger in each direction and averaged down.
const SUPERSAMPLE: usize = 2;

/// Smallest picture in which the parts and labels still fit, and largest, pixels.
const WIDTHS: std::ops::RangeInclusive<usize> = 640..=8192;
const HEIGHTS: std::ops::RangeInclusive<usize> = 400..=8192;

const PAPER: Vec3 = Vec3::new(0.985, 0.98, 0.97);
const INK: Vec3 = Vec3::new(0.13, 0.14, 0.17);
const FAINT: Vec3 = Vec3::new(0.62, 0.63, 0.66);

/// Inks of R, G and B.
const CHANNELS: [Vec3; 3] = [
    Vec3::new(0.80, 0.20, 0.17),
    Vec3::new(0.16, 0.55, 0.24),
    Vec3::new(0.16, 0.33, 0.75),
];

/// What to draw.
#[derive(Clone, Debug)]
pub struct Plot<'a> {
    /// The table, dyed.
    pub maps: &'a ScatterMaps,
    /// Whether its three channels are one and the same absorption level.
    pub gray: bool,
    /// Inclination of the query direction, degrees in -90..=90, positive toward the tip.
    pub incidence_deg: f64,
    /// First line of the picture.
    pub title: String,
    /// Second line.
    pub subtitle: String,
    /// The closed form to draw beside the azimuthal cut, if the fiber has one.
    pub closed_form: Option<SmoothCylinder>,
    /// Width and height in pixels, at least 640 x 400.
    pub size: (usize, usize),
}

impl Plot<'_> {
    /// The picture.
    ///
    /// * Errors: inclination or size out of range.
    pub fn draw(&self) -> Result<Canvas, TableError> {
        let (width, height) = self.size;
        let request = |what: String| Err(TableError::Request(what));
        if !WIDTHS.contains(&width) || !HEIGHTS.contains(&height) {
            return request(format!(
                "a plot of {width}x{height} pixels; {}x{} to {}x{} are possible",
                WIDTHS.start(),
                HEIGHTS.start(),
                WIDTHS.end(),
                HEIGHTS.end()
            ));
        }
        check_incidence(self.incidence_deg)?;
        self.maps.nodes.only_averaged()?;
        let maps = self.maps;
        let table = ScatterTable::new(maps.nodes.clone(), maps.res, maps.rgb.clone());
        let theta = self.incidence_deg.to_radians();
        let field = Field::new(&table, theta, maps.photons() / maps.nodes.len() as f64);

        let (w, h) = (width * SUPERSAMPLE, height * SUPERSAMPLE);
        let mut canvas = Canvas::new(w, h, PAPER);
        let size = Vec2::new(w as f32, h as f32);
        let pen = Pen::new(letter_scale(size.x, size.y));
        let margin = 2.0 * pen.line();

        pen.left(
            &mut canvas,
            Vec2::new(margin, 0.7 * margin),
            &self.title,
            INK,
        );
        let below = Vec2::new(margin, 0.7 * margin + 1.3 * pen.line());
        pen.left(&mut canvas, below, &self.subtitle, FAINT);

        let top = 0.7 * margin + 4.0 * pen.line();
        let split = (0.56 * size.x).round();
        let floor = top + 0.66 * (size.y - top);
        let map_area = Area {
            min: Vec2::new(margin, top),
            max: Vec2::new(split - margin, floor),
        };
        let title = "S cos θ per steradian over all directions";
        sphere_map::draw(
            &mut canvas,
            &pen,
            map_area,
            &MapStyle::Density(&field),
            title,
        );
        let albedo_area = Area {
            min: Vec2::new(margin, floor + 1.5 * pen.line()),
            max: Vec2::new(split - margin, size.y - 0.5 * margin),
        };
        albedo::draw(&mut canvas, &pen, albedo_area, maps, self);
        let azimuth_area = Area {
            min: Vec2::new(split, floor + 1.5 * pen.line()),
            max: Vec2::new(size.x - 0.5 * margin, size.y - 0.5 * margin),
        };
        azimuth::draw(&mut canvas, &pen, azimuth_area, &field, self);
        let lobe_area = Area {
            min: Vec2::new(split, top),
            max: Vec2::new(size.x - 0.5 * margin, floor),
        };
        lobe::draw(&mut canvas, &pen, lobe_area, &field, self.gray);
        Ok(canvas.downsampled(SUPERSAMPLE))
    }
}

/// The lobe alone, in the color of its light, without letters.
///
/// * `incidence_deg`: inclination of the query direction, degrees in -90..=90.
/// * `size`: width and height in pixels, 32 to 4096.
/// * Errors: inclination or size out of range.
pub fn draw_lobe(
    maps: &ScatterMaps,
    incidence_deg: f64,
    (width, height): (usize, usize),
) -> Result<Canvas, TableError> {
    let possible = 32..=4096;
    if !possible.contains(&width) || !possible.contains(&height) {
        let what = format!("a lobe of {width}x{height} pixels; 32x32 to 4096x4096 are possible");
        return Err(TableError::Request(what));
    }
    check_incidence(incidence_deg)?;
    maps.nodes.only_averaged()?;
    let table = ScatterTable::new(maps.nodes.clone(), maps.res, maps.rgb.clone());
    let photons = maps.ledger.iter().map(|l| l.photons()).sum::<f64>();
    let field = Field::new(
        &table,
        incidence_deg.to_radians(),
        photons / maps.nodes.len() as f64,
    );
    let (w, h) = (width * SUPERSAMPLE, height * SUPERSAMPLE);
    let mut canvas = Canvas::new(w, h, PAPER);
    let area = Area {
        min: Vec2::ZERO,
        max: Vec2::new(w as f32, h as f32),
    };
    let steps = if height <= 400 {
        lobe::COARSE
    } else {
        lobe::FINE
    };
    lobe::solid(&mut canvas, &Pen::new(1.0), area, &field, false, steps);
    Ok(canvas.downsampled(SUPERSAMPLE))
}

/// Letters grow with the picture, `width` x `height` pixels: 1/75 of its height, in whole steps of the
/// bitmap font.
fn letter_scale(width: f32, height: f32) -> f32 {
    let step = (height / (75.0 * GLYPH_HEIGHT)).min(width / (120.0 * GLYPH_HEIGHT));
    step.max(1.0)
}

fn check_incidence(degrees: f64) -> Result<(), TableError> {
    if (-90.0..=90.0).contains(&degrees) {
        return Ok(());
    }
    Err(TableError::Request(format!(
        "an incidence of {degrees} degrees; -90 to 90 are possible"
    )))
}

/// A rectangle of the picture, pixels.
#[derive(Clone, Copy, Debug)]
struct Area {
    min: Vec2,
    max: Vec2,
}

impl Area {
    fn size(&self) -> Vec2 {
        self.max - self.min
    }
}

/// The scattering function for one query direction.
struct Field<'a> {
    table: &'a ScatterTable,
    theta: f64,
    query: Vec3,
    /// Largest density of the sphere but for a thousandth of the texels.
    peak: f32,
    /// Half the angle over which the lobe is averaged, radians.
    blur: f64,
    /// Caps about the poles, which are shown by their means: the density of a map that was shifted along
    /// its meridians has a singular point there, about which single photons stand out as spikes.
    caps: Caps,
}

/// Caps about both poles.
#[derive(Clone, Copy, Default)]
struct Caps {
    /// Their radius, radians; 0 if there are none.
    radius: f64,
    /// Mean density at the tip and at the root.
    means: [Vec3; 2],
}

impl<'a> Field<'a> {
    /// * `photons`: photons of a node, which say how noisy it is.
    fn new(table: &'a ScatterTable, theta: f64, photons: f64) -> Self {
        // Wide enough for a hundred photons of even light, which leaves 10 % of noise; from half a
        // texel (steps of texels vanish) to three (a highlight keeps its shape).
        let texels = 6.0 * (table.res() * table.res()) as f64;
        let width = 0.5 * (100.0 * texels / photons.max(1.0)).sqrt();
        let texel = std::f64::consts::FRAC_PI_2 / table.res() as f64;
        let mut field = Self {
            table,
            theta,
            query: frame::direction(theta, 0.0).as_vec3(),
            peak: 0.0,
            blur: texel * width.clamp(0.5, 3.0),
            caps: Caps::default(),
        };
        field.caps = field.find_caps(texel);
        // One direction a texel. The brightest few are noise or the poles, where a shifted map is
        // singular; they saturate rather than set the scale.
        let cube = crate::math::unicube::Unicube::new(table.res());
        let mut values: Vec<f32> = (0..cube.texels())
            .into_par_iter()
            .map(|t| field.gray(cube.direction(t, 0.5, 0.5).0))
            .collect();
        values.sort_by(f32::total_cmp);
        let at = values.len() - 1 - values.len() / 1000;
        field.peak = values[at].max(1e-12);
        field
    }

    /// `S cos(theta)` per steradian, linear RGB; about the poles its mean.
    fn rgb(&self, w: DVec3) -> Vec3 {
        /// Radius, in those of the cap, at which the density itself is shown again.
        const RIM: f64 = 1.5;
        let off = w.x.hypot(w.y) / self.caps.radius.sin();
        // A cap of radius 0 is infinitely far off.
        if off.is_nan() || off >= RIM {
            return self.density(w);
        }
        let mean = self.caps.means[usize::from(w.z < 0.0)];
        let t = ((off - 1.0) / (RIM - 1.0)).clamp(0.0, 1.0);
        mean.lerp(self.density(w), (t * t * (3.0 - 2.0 * t)) as f32)
    }

    fn density(&self, w: DVec3) -> Vec3 {
        self.table.lobe(self.query).density(w.as_vec3())
    }

    /// Caps of some texels and a part of the shift: outside of them the factor that a shift brings stays
    /// below 2; wider ones would hide what the table holds.
    fn find_caps(&self, texel: f64) -> Caps {
        let nodes = self.table.nodes();
        if nodes.mode == Mode::Paper {
            return Caps::default();
        }
        let (a, b, share) = nodes.bracket(self.theta);
        let shift = |node: usize| (self.theta - nodes.centers[node]).abs();
        let shift = if share > 0.0 {
            shift(a).max(shift(b))
        } else {
            shift(a)
        };
        if shift == 0.0 {
            return Caps::default();
        }
        let radius = 0.25 * shift + 2.5 * texel;
        let mean = |side: f64| {
            const RINGS: usize = 24;
            const SPOKES: usize = 72;
            let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
            for i in 0..RINGS * SPOKES {
                let polar = radius * ((i / SPOKES) as f64 + 0.5) / RINGS as f64;
                let phi = std::f64::consts::TAU * (i % SPOKES) as f64 / SPOKES as f64;
                let w = frame::direction(side * (std::f64::consts::FRAC_PI_2 - polar), phi);
                sum += self.density(w) * polar.sin() as f32;
                weights += polar.sin() as f32;
            }
            sum / weights
        };
        Caps {
            radius,
            means: [mean(1.0), mean(-1.0)],
        }
    }

    fn gray(&self, w: DVec3) -> f32 {
        self.rgb(w).element_sum() / 3.0
    }
}

#[cfg(test)]
mod tests;
