//! A clear sky with its sun (Preetham, Shirley and Smits 1999).

use super::{Environment, builtin::raster};
use crate::color::Rgb;
use glam::Vec3;

/// Where the sun stands and how clear the air is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Above the horizon, degrees, 1..90.
    pub elevation_deg: f32,
    /// Around +Y, 0 at +Z, 90 at +X.
    pub azimuth_deg: f32,
    /// Haze: 2 very clear .. 10 misty; the fit of the sky is made for this range.
    pub turbidity: f32,
    /// Apparent diameter. The true 0.53 degrees gives the same light but harder shadows than a
    /// picture of this resolution can hold; total power does not depend on it.
    pub diameter_deg: f32,
}

impl Default for Sun {
    fn default() -> Self {
        Self {
            elevation_deg: 32.0,
            azimuth_deg: -50.0,
            turbidity: 3.0,
            diameter_deg: 1.0,
        }
    }
}

/// Units of radiance per kilocandela per square meter: a white card in the sun is about 1.
const EXPOSURE: f32 = 1.0 / 32.0;

/// Reflectance of the ground that is seen below the horizon.
const GROUND: Rgb = Rgb::new(0.2, 0.18, 0.15);

impl Environment {
    /// A sky with sun over a plain.
    pub fn sky(sun: &Sun) -> Self {
        let (azimuth, elevation) = (sun.azimuth_deg.to_radians(), sun.elevation_deg.to_radians());
        let toward = Vec3::new(
            azimuth.sin() * elevation.cos(),
            elevation.sin(),
            azimuth.cos() * elevation.cos(),
        );
        let perez = Perez::new(sun.turbidity, toward.y.clamp(0.0, 1.0).acos());
        let sunlight = direct_illuminance(elevation, sun.turbidity);
        let cos_edge = (0.5 * sun.diameter_deg.to_radians()).cos();
        let disk = sunlight / (std::f32::consts::TAU * (1.0 - cos_edge));
        // Skylight on the ground, roughly pi times the zenith, joins the sun's.
        let lit =
            sunlight * toward.y.max(0.0) + std::f32::consts::PI * perez.radiance(Vec3::Y, toward);
        let plain = GROUND * lit / std::f32::consts::PI;
        raster(2048, 1024, |dir| {
            let sky = if dir.y <= 0.0 {
                plain
            } else {
                perez.radiance(dir, toward)
            };
            let sunlit = if dir.dot(toward) > cos_edge {
                disk
            } else {
                Rgb::ZERO
            };
            (sky + sunlit) * EXPOSURE
        })
    }
}

/// Illuminance of the sun across its rays, kilolux, as a color: 128 klx above the air, thinned by
/// molecules (optical depth 0.1 at 550 nm, falling with the fourth power of the wavelength) and by
/// haze (Angstrom's law with exponent 1.3), over Kasten's air mass.
fn direct_illuminance(elevation: f32, turbidity: f32) -> Rgb {
    let degrees = elevation.to_degrees().max(0.1);
    let air_mass = 1.0 / (elevation.sin().max(0.0) + 0.15 * (degrees + 3.885).powf(-1.253));
    let haze = 0.046 * turbidity - 0.04586;
    let through = |wavelength_um: f32| {
        let molecules = 0.0088 * wavelength_um.powf(-4.08);
        let particles = haze.max(0.0) * wavelength_um.powf(-1.3);
        (-(molecules + particles) * air_mass).exp()
    };
    128.0 * Rgb::new(through(0.61), through(0.55), through(0.465))
}

/// The five-parameter sky of Perez for luminance and chromaticity x, y.
struct Perez {
    terms: [[f32; 5]; 3],
    zenith: [f32; 3],
    at_zenith: [f32; 3],
}

impl Perez {
    fn new(turbidity: f32, sun_polar: f32) -> Self {
        let t = turbidity;
        let line = |slope: [f32; 5], base: [f32; 5]| -> [f32; 5] {
            std::array::from_fn(|i| slope[i] * t + base[i])
        };
        let terms = [
            line(
                [0.1787, -0.3554, -0.0227, 0.1206, -0.0670],
                [-1.4630, 0.4275, 5.3251, -2.5771, 0.3703],
            ),
            line(
                [-0.0193, -0.0665, -0.0004, -0.0641, -0.0033],
                [-0.2592, 0.0008, 0.2125, -0.8989, 0.0452],
            ),
            line(
                [-0.0167, -0.0950, -0.0079, -0.0441, -0.0109],
                [-0.2608, 0.0092, 0.2102, -1.6537, 0.0529],
            ),
        ];
        let s = sun_polar;
        let cubic = |c: [f32; 4]| ((c[0] * s + c[1]) * s + c[2]) * s + c[3];
        let chroma =
            |a: [f32; 4], b: [f32; 4], c: [f32; 4]| (cubic(a) * t + cubic(b)) * t + cubic(c);
        let chi = (4.0 / 9.0 - t / 120.0) * (std::f32::consts::PI - 2.0 * s);
        let zenith = [
            ((4.0453 * t - 4.9710) * chi.tan() - 0.2155 * t + 2.4192).max(0.0),
            chroma(
                [0.00166, -0.00375, 0.00209, 0.0],
                [-0.02903, 0.06377, -0.03202, 0.00394],
                [0.11693, -0.21196, 0.06052, 0.25886],
            ),
            chroma(
                [0.00275, -0.00610, 0.00317, 0.0],
                [-0.04214, 0.08970, -0.04153, 0.00516],
                [0.15346, -0.26756, 0.06670, 0.26688],
            ),
        ];
        let at_zenith = terms.map(|k| perez(&k, 1.0, s, s.cos()));
        Self {
            terms,
            zenith,
            at_zenith,
        }
    }

    /// Kilocandela per square meter as linear Rec.709.
    fn radiance(&self, dir: Vec3, toward_sun: Vec3) -> Rgb {
        let cos_gamma = dir.dot(toward_sun).clamp(-1.0, 1.0);
        // At the horizon itself the fit divides by zero.
        let up = dir.y.max(0.01);
        let [luminance, x, y] = std::array::from_fn(|i| {
            self.zenith[i] * perez(&self.terms[i], up, cos_gamma.acos(), cos_gamma)
                / self.at_zenith[i]
        });
        let (cie_x, cie_z) = (luminance * x / y, luminance * (1.0 - x - y) / y);
        Rgb::new(
            3.2406 * cie_x - 1.5372 * luminance - 0.4986 * cie_z,
            -0.9689 * cie_x + 1.8758 * luminance + 0.0415 * cie_z,
            0.0557 * cie_x - 0.2040 * luminance + 1.0570 * cie_z,
        )
        .max(Rgb::ZERO)
    }
}

fn perez([a, b, c, d, e]: &[f32; 5], up: f32, gamma: f32, cos_gamma: f32) -> f32 {
    (1.0 + a * (b / up).exp()) * (1.0 + c * (d * gamma).exp() + e * cos_gamma * cos_gamma)
}
