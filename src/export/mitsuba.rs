//! A scene for Mitsuba 3.9 or later: the same strands, skin, light, camera and hair model, so that the
//! two pictures can be compared.
//!
//! A folder of `scene.xml`, `hair.txt` (B-spline control points in millimeters, `x y z radius` a line, an
//! empty line after each strand), `skin.ply` and `environment.exr`, and lamps. Floor and backdrop stay behind: they
//! are no part of the light transport, or not one that Mitsuba has.

use crate::bsdf::ChiangParameters;
use crate::color::Rgb;
use crate::groom::Groom;
use crate::io::{AtomicFile, FileError};
use crate::render::{Filter, GAUSSIAN_SIGMA, RenderJob};
use crate::scene::{Camera, Emitter, EmitterShape, Environment};
use crate::skin::Skin;
use exr::prelude::{Image, SpecificChannels, WritableImage};
use glam::{Vec3, Vec4};
use std::fmt::Write as _;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Scene units (millimeters) in a meter. In meters Mitsuba would start rays farther from a strand than
/// the strand is wide.
const UNITS: f32 = 1000.0;

/// What is written.
#[derive(Clone, Copy)]
pub struct MitsubaScene<'a> {
    /// The fur.
    pub groom: &'a Groom,
    /// Its hair model, the same for all strands.
    pub hair: &'a ChiangParameters,
    /// The skin and its linear diffuse reflectance.
    pub skin: Option<(&'a Skin, Rgb)>,
    /// The light.
    pub environment: &'a Environment,
    /// Lamps beside it. Mitsuba's hide what is behind them and are seen.
    pub lamps: &'a [Emitter],
    /// The place of the camera.
    pub camera: &'a Camera,
    /// Size, samples and filter of the picture.
    pub job: &'a RenderJob,
}

impl MitsubaScene<'_> {
    /// Writes the folder's files; the folder is made if need be.
    ///
    /// # Errors
    /// [`FileError`] for a folder or file that cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), FileError> {
        std::fs::create_dir_all(folder).map_err(|e| FileError::new("create", folder, e))?;
        write_with(&folder.join("hair.txt"), |out| self.write_hair(out))?;
        if let Some((skin, color)) = self.skin {
            let of = |vertex| self.groom.skin_color(skin, vertex) * color;
            write_with(&folder.join("skin.ply"), |out| write_skin(skin, of, out))?;
        }
        write_environment(self.environment, &folder.join("environment.exr"))?;
        AtomicFile::write_all_to(&folder.join("scene.xml"), self.xml().as_bytes())
    }

    fn write_hair(&self, out: &mut dyn Write) -> io::Result<()> {
        let groom = self.groom;
        for strand in 0..groom.strands() {
            let points: Vec<Vec4> = (groom.range(strand))
                .map(|i| groom.points[i].extend(0.5 * groom.widths[i]) * UNITS)
                .collect();
            write_strand(out, &points)?;
        }
        Ok(())
    }

    fn xml(&self) -> String {
        let mut xml = String::from("<scene version=\"3.0.0\">\n");
        let [width, height] = self.job.resolution;
        let (camera, hair) = (self.camera, self.hair);
        let (from, axes) = (camera.position(), camera.axes());
        let (at, up) = (from - 100.0 * axes.z_axis, axes.y_axis);
        let fov = 2.0 * camera.half_extent()[0].atan().to_degrees();
        let filter = match self.job.filter {
            Filter::Gaussian => format!(
                "<rfilter type=\"gaussian\"><float name=\"stddev\" value=\"{GAUSSIAN_SIGMA}\"/></rfilter>"
            ),
            Filter::Box => "<rfilter type=\"box\"/>".to_owned(),
            Filter::Tent => "<rfilter type=\"tent\"/>".to_owned(),
        };
        let turn = self.environment.turn_deg() + 180.0;
        // Where its frame runs from root to tip, Mitsuba counts tilt the other way; its default outside is
        // air of 1.000277.
        let _ = write!(
            xml,
            "<integrator type=\"path\"><integer name=\"max_depth\" value=\"-1\"/></integrator>
<sensor type=\"perspective\">
<string name=\"fov_axis\" value=\"x\"/><float name=\"fov\" value=\"{fov}\"/>
<float name=\"near_clip\" value=\"1\"/><float name=\"far_clip\" value=\"1e6\"/>
<transform name=\"to_world\"><lookat origin=\"{}\" target=\"{}\" up=\"{}\"/></transform>
<sampler type=\"independent\"><integer name=\"sample_count\" value=\"{}\"/></sampler>
<film type=\"hdrfilm\"><integer name=\"width\" value=\"{width}\"/><integer name=\"height\" value=\"{height}\"/>
{filter}<string name=\"component_format\" value=\"float32\"/></film>
</sensor>
<shape type=\"bsplinecurve\"><string name=\"filename\" value=\"hair.txt\"/>
<bsdf type=\"hair\"><rgb name=\"sigma_a\" value=\"{}\"/>
<float name=\"longitudinal_roughness\" value=\"{}\"/><float name=\"azimuthal_roughness\" value=\"{}\"/>
<float name=\"scale_tilt\" value=\"{}\"/><float name=\"int_ior\" value=\"{}\"/><float name=\"ext_ior\" value=\"1\"/>
</bsdf></shape>
",
            triple(from),
            triple(at),
            triple(up),
            self.job.spp,
            triple(hair.sigma_a),
            hair.beta_m,
            hair.beta_n,
            -hair.alpha_deg,
            hair.eta,
        );
        // Mitsuba cannot draw from a black picture.
        if self.environment.mean() != Rgb::ZERO {
            let _ = write!(
                xml,
                "<emitter type=\"envmap\"><string name=\"filename\" value=\"environment.exr\"/>
<transform name=\"to_world\"><rotate y=\"1\" angle=\"{turn}\"/></transform></emitter>\n"
            );
        }
        if self.skin.is_some() {
            xml += "<shape type=\"ply\"><string name=\"filename\" value=\"skin.ply\"/>
<bsdf type=\"twosided\"><bsdf type=\"diffuse\"><texture type=\"mesh_attribute\" name=\"reflectance\">
<string name=\"name\" value=\"vertex_color\"/></texture></bsdf></bsdf></shape>\n";
        }
        xml.extend(self.lamps.iter().map(lamp));
        xml + "</scene>\n"
    }
}

/// Mitsuba has no disks at infinity: the sun is so far away, millimeters.
const SUN_DISTANCE: f32 = 1e6;

/// A lamp as a black body that shines.
fn lamp(lamp: &Emitter) -> String {
    let (kind, place) = match lamp.shape() {
        EmitterShape::Rect {
            center,
            half: [across, up],
            facing,
        } => ("rectangle", matrix([across, up, facing, center])),
        EmitterShape::Sphere { center, radius } => {
            let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| axis * radius);
            ("sphere", matrix([axes[0], axes[1], axes[2], center]))
        }
        EmitterShape::Sun { toward, sin } => {
            let radius = SUN_DISTANCE * sin / (1.0 - sin * sin).sqrt();
            let (x, y) = (-toward).any_orthonormal_pair();
            let center = toward * SUN_DISTANCE;
            ("disk", matrix([x * radius, y * radius, -toward, center]))
        }
    };
    format!(
        "<shape type=\"{kind}\"><transform name=\"to_world\"><matrix value=\"{place}\"/></transform>
<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0\"/></bsdf>
<emitter type=\"area\"><rgb name=\"radiance\" value=\"{}\"/></emitter></shape>\n",
        triple(lamp.radiance())
    )
}

/// Four columns, written by rows.
fn matrix(columns: [Vec3; 4]) -> String {
    let row = |i: usize| {
        let numbers = columns.map(|c| c[i].to_string());
        numbers.join(" ")
    };
    format!("{} {} {} 0 0 0 1", row(0), row(1), row(2))
}

fn triple(v: Vec3) -> String {
    format!("{}, {}, {}", v.x, v.y, v.z)
}

fn write_with(
    path: &Path,
    body: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), FileError> {
    let mut out = BufWriter::new(AtomicFile::create(path)?);
    body(&mut out).map_err(|e| FileError::new("write", path, e))?;
    let file = out.into_inner();
    file.map_err(|e| FileError::new("write", path, e.into_error()))?
        .commit()
}

/// Writes a strand for a `bsplinecurve`: a control point and its radius a line, an empty line at the end.
///
/// * `points`: with their radii.
pub(super) fn write_strand(out: &mut (impl Write + ?Sized), points: &[Vec4]) -> io::Result<()> {
    for p in interpolating_b_spline(points) {
        writeln!(out, "{} {} {} {}", p.x, p.y, p.z, p.w.max(0.0))?;
    }
    writeln!(out)
}

/// Control points of the uniform cubic B-spline through all points whose ends run along the first and
/// last chords, as Vair's own splines do: two more than points.
fn interpolating_b_spline(points: &[Vec4]) -> Vec<Vec4> {
    let n = points.len();
    if n < 2 {
        return Vec::new();
    }
    // (c[i-1] + 4 c[i] + c[i+1]) / 6 = p[i], and c[1] - c[-1] = 2 (p[1] - p[0]) at the root, likewise at
    // the tip: a tridiagonal system for c[0..n], solved by elimination.
    let (first, last) = (points[1] - points[0], points[n - 1] - points[n - 2]);
    let (mut upper, mut right) = (vec![0.0f32; n], vec![Vec4::ZERO; n]);
    for i in 0..n {
        let mut value = 6.0 * points[i];
        let (mut below, mut above) = (1.0, 1.0);
        if i == 0 {
            value += 2.0 * first;
            (below, above) = (0.0, 2.0);
        } else if i == n - 1 {
            value -= 2.0 * last;
            (below, above) = (2.0, 0.0);
        }
        let before = i.checked_sub(1).map(|j| (upper[j], right[j]));
        let (u, r) = before.unwrap_or_default();
        let pivot = 4.0 - below * u;
        upper[i] = above / pivot;
        right[i] = (value - below * r) / pivot;
    }
    let mut inner = right;
    for i in (0..n - 1).rev() {
        let next = inner[i + 1];
        inner[i] -= upper[i] * next;
    }
    let mut all = Vec::with_capacity(n + 2);
    all.push(inner[1] - 2.0 * first);
    all.extend_from_slice(&inner);
    all.push(inner[n - 2] + 2.0 * last);
    all
}

fn write_skin(skin: &Skin, color: impl Fn(usize) -> Rgb, out: &mut dyn Write) -> io::Result<()> {
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\n",
        skin.positions.len()
    )?;
    for name in ["x", "y", "z", "nx", "ny", "nz", "r", "g", "b"] {
        writeln!(out, "property float {name}")?;
    }
    writeln!(
        out,
        "element face {}\nproperty list uchar int vertex_indices\nend_header",
        skin.triangles.len()
    )?;
    for i in 0..skin.positions.len() {
        for v in [skin.positions[i] * UNITS, skin.normals[i], color(i)] {
            for x in v.to_array() {
                out.write_all(&x.to_le_bytes())?;
            }
        }
    }
    for triangle in &skin.triangles {
        out.write_all(&[3])?;
        for index in triangle {
            out.write_all(&index.to_le_bytes())?;
        }
    }
    Ok(())
}

/// Mitsuba interpolates between texels where Vair holds them constant; small pictures are written larger
/// to keep the difference to the edges.
fn write_environment(environment: &Environment, path: &Path) -> Result<(), FileError> {
    let (width, height) = environment.size();
    let scale = 1024usize.div_ceil(width.max(2 * height)).max(1);
    let size = ((width * scale).max(2), height * scale);
    let image = Image::from_channels(
        size,
        SpecificChannels::rgb(|at: exr::math::Vec2<usize>| {
            let texel = environment.texel_at(at.0 / scale % width, at.1 / scale);
            (texel.x, texel.y, texel.z)
        }),
    );
    let mut bytes = io::Cursor::new(Vec::new());
    let broken = |e: exr::error::Error| {
        let reason = io::Error::new(io::ErrorKind::InvalidInput, e.to_string());
        FileError::new("write", path, reason)
    };
    image.write().to_buffered(&mut bytes).map_err(broken)?;
    AtomicFile::write_all_to(path, bytes.get_ref())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4Swizzles;

    /// Points of the curve where its pieces join, and its direction at both ends.
    #[test]
    fn the_b_spline_goes_through_all_points() {
        for n in [2, 3, 8] {
            let points: Vec<Vec4> = (0..n)
                .map(|i| i as f32)
                .map(|t| Vec4::new(t.sin(), t, 0.3 * t * t, 0.1 + 0.01 * t))
                .collect();
            let c = interpolating_b_spline(&points);
            assert_eq!(c.len(), n + 2);
            for (i, p) in points.iter().enumerate() {
                let on = (c[i] + 4.0 * c[i + 1] + c[i + 2]) / 6.0;
                assert!((on - *p).length() < 1e-4, "{on} is not {p}");
            }
            let slope = 0.5 * (c[2] - c[0]).xyz();
            let chord = (points[1] - points[0]).xyz();
            assert!((slope - chord).length() < 1e-4);
        }
    }
}
