//! The smooth dielectric cylinder in closed form: the truth that bakes are held against.
//!
//! Written from the literature alone and independent of the program: it shares no code with it, not
//! even the cube map. Bravais' law reduces the inclined cylinder to a circle of effective index
//! `eta'`; a ray at offset `h` meets the same angles at every internal hit, so with the
//! unpolarized Fresnel reflectance `F` and the transmittance `T` of one crossing
//!
//! ```text
//! A_0 = F      A_p = (1 - F)^2 F^(p-1) T^p      exit azimuth Phi_p = 2 p gamma_t - 2 gamma_i + p pi
//! ```
//!
//! and all of it leaves on the cone `theta_o = -theta` (Marschner et al. 2003; d'Eon et al. 2011).
//! Angles are radians, absorption is optical depth per radius.

#![allow(dead_code, reason = "each test uses its own part of the truth")]

use std::f64::consts::{FRAC_PI_2, PI};

/// What a ray that enters at offset `h` meets.
pub(crate) struct Ray {
    /// Fresnel reflectance, the same at every hit.
    pub(crate) reflectance: f64,
    /// Length of one crossing, in radii.
    pub(crate) crossing: f64,
    gamma_i: f64,
    gamma_t: f64,
}

impl Ray {
    /// * `eta`: index of the cylinder; `theta`: inclination; `h`: offset in radii, -1..1.
    pub(crate) fn new(eta: f64, theta: f64, h: f64) -> Self {
        let (sin_theta, cos_theta) = theta.sin_cos();
        let bravais = (eta * eta - sin_theta * sin_theta).sqrt() / cos_theta;
        let (gamma_i, gamma_t) = (h.asin(), (h / bravais).asin());
        let cos_theta_t = (1.0 - (sin_theta / eta).powi(2)).sqrt();
        Self {
            reflectance: unpolarized(cos_theta * gamma_i.cos(), cos_theta_t * gamma_t.cos(), eta),
            crossing: 2.0 * gamma_t.cos() / cos_theta_t,
            gamma_i,
            gamma_t,
        }
    }

    /// Share of the ray that leaves after `p` crossings.
    pub(crate) fn attenuation(&self, p: u32, tau: f64) -> f64 {
        let f = self.reflectance;
        match p {
            0 => f,
            _ => {
                let transmittance = (-tau * self.crossing * f64::from(p)).exp();
                (1.0 - f).powi(2) * f.powi(p as i32 - 1) * transmittance
            }
        }
    }

    /// Azimuth at which it leaves after `p` crossings.
    pub(crate) fn azimuth(&self, p: u32) -> f64 {
        let p = f64::from(p);
        2.0 * p * self.gamma_t - 2.0 * self.gamma_i + p * PI
    }

    /// Share still inside after `events` reflections and refractions.
    pub(crate) fn inside_after(&self, events: u32) -> f64 {
        (1.0 - self.reflectance) * self.reflectance.powi(events as i32 - 1)
    }
}

/// Fresnel's equations for unpolarized light, from both cosines.
fn unpolarized(cos_i: f64, cos_t: f64, eta: f64) -> f64 {
    let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    0.5 * (s * s + p * p)
}

/// Mean of `f(ray)` over the width of the cylinder. `h = sin x` takes out the roots at the rim.
pub(crate) fn over_width(eta: f64, theta: f64, mut f: impl FnMut(&Ray) -> f64) -> f64 {
    integrate(0.0, FRAC_PI_2, 40, |x| {
        f(&Ray::new(eta, theta, x.sin())) * x.cos()
    })
}

/// Energies of R, TT, TRT and all the rest at one inclination.
pub(crate) fn energies(eta: f64, theta: f64, tau: f64) -> [f64; 4] {
    let lobe = |p| over_width(eta, theta, |ray| ray.attenuation(p, tau));
    let rest = over_width(eta, theta, |ray| {
        let (f, t) = (ray.reflectance, (-tau * ray.crossing).exp());
        (1.0 - f).powi(2) * f * f * t.powi(3) / (1.0 - f * t)
    });
    [lobe(0), lobe(1), lobe(2), rest]
}

/// Azimuth of the caustic of lobe `p >= 2`, where it exists (`eta' < p`).
pub(crate) fn caustic(eta: f64, theta: f64, p: u32) -> Option<f64> {
    let bravais2 = (eta * eta - theta.sin().powi(2)) / theta.cos().powi(2);
    let p2 = f64::from(p * p);
    let h2 = (p2 - bravais2) / (p2 - 1.0);
    if h2 < 0.0 {
        return None;
    }
    let azimuth = Ray::new(eta, theta, h2.sqrt()).azimuth(p);
    Some(((azimuth + PI).rem_euclid(2.0 * PI) - PI).abs())
}

/// Mean of `f(theta)` over a bin of inclinations, evenly in solid angle (in `sin theta`).
pub(crate) fn over_bin(from: f64, to: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    // sin(theta) = sin(from) + range * (3 v^2 - 2 v^3): the steps shrink at both ends, where the
    // reflectance has a root if the bin touches a pole.
    let (lo, hi) = (from.sin(), to.sin());
    integrate(0.0, 1.0, 12, |v| {
        let s = lo + (hi - lo) * v * v * (3.0 - 2.0 * v);
        f(s.asin()) * 6.0 * v * (1.0 - v)
    })
}

/// Composite Gauss-Legendre quadrature, five points a panel.
fn integrate(a: f64, b: f64, panels: usize, mut f: impl FnMut(f64) -> f64) -> f64 {
    const NODES: [(f64, f64); 5] = [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.906_179_845_938_664, 0.236_926_885_056_189_08),
        (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    ];
    let half = 0.5 * (b - a) / panels as f64;
    let mut sum = 0.0;
    for panel in 0..panels {
        let center = a + half * (2 * panel + 1) as f64;
        for (x, w) in NODES {
            sum += w * f(center + half * x);
        }
    }
    sum * half
}

/// Expected flux per texel of a unicube, one map a lobe: R, TT, TRT, the rest.
pub(crate) struct LobeMaps {
    pub(crate) maps: [Vec<f64>; 4],
}

impl LobeMaps {
    /// * `from`, `to`: inclinations of the query direction.
    /// * `n`: texels along a face edge.
    /// * `crossings`: most crossings after which light still leaves (events less one).
    /// * `rays`: points of a lattice over (inclination, offset); each stands for both signs of `h`.
    pub(crate) fn new(
        eta: f64,
        tau: f64,
        from: f64,
        to: f64,
        n: usize,
        crossings: u32,
        rays: u32,
    ) -> Self {
        // Fibonacci lattice: the irrational step spreads inclinations evenly at any count.
        const STEP: f64 = 0.618_033_988_749_894_9;
        let mut maps = std::array::from_fn(|_| vec![0.0; 6 * n * n]);
        let (lo, hi) = (from.sin(), to.sin());
        for i in 0..rays {
            let h = (f64::from(i) + 0.5) / f64::from(rays);
            let sin_theta = lo + (hi - lo) * (f64::from(i) * STEP).fract();
            let theta = sin_theta.asin();
            let ray = Ray::new(eta, theta, h);
            for p in 0..=crossings {
                let share = ray.attenuation(p, tau) / (2.0 * f64::from(rays));
                if share < 1e-15 {
                    break;
                }
                let (sin, cos) = ray.azimuth(p).sin_cos();
                let (x, y) = (cos * theta.cos(), sin * theta.cos());
                let map: &mut Vec<f64> = &mut maps[p.min(3) as usize];
                map[texel(n, [x, y, -sin_theta])] += share;
                map[texel(n, [x, -y, -sin_theta])] += share;
            }
        }
        Self { maps }
    }

    /// The sum of all lobes.
    pub(crate) fn total(&self) -> Vec<f64> {
        let at = |i: usize| self.maps.iter().map(|m| m[i]).sum();
        (0..self.maps[0].len()).map(at).collect()
    }
}

/// The texel of a unit direction: faces +X -X +Y -Y +Z -Z, `s = (6/pi) atan(x / sqrt(x^2 + 2))`.
pub(crate) fn texel(n: usize, w: [f64; 3]) -> usize {
    let axis = (0..3).fold(0, |a, b| if w[b].abs() > w[a].abs() { b } else { a });
    let others = [[1, 2], [0, 2], [0, 1]][axis];
    let [u, v] = others.map(|k| {
        let x = w[k] / w[axis].abs();
        let s = 6.0 / PI * (x / (x * x + 2.0).sqrt()).atan();
        ((0.5 * (s + 1.0) * n as f64) as usize).min(n - 1)
    });
    let face = 2 * axis + usize::from(w[axis] < 0.0);
    (face * n + v) * n + u
}

/// Unit direction at a place inside a texel, `a` and `b` in 0..1 along column and row.
pub(crate) fn direction(n: usize, texel: usize, a: f64, b: f64) -> [f64; 3] {
    let (face, v, u) = (texel / (n * n), texel / n % n, texel % n);
    let plane = |i: usize, f: f64| {
        let s = PI / 6.0 * (2.0 * (i as f64 + f) / n as f64 - 1.0);
        2f64.sqrt() * s.sin() / (2.0 * s).cos().sqrt()
    };
    let (x, y) = (plane(u, a), plane(v, b));
    let one = if face & 1 == 0 { 1.0 } else { -1.0 };
    let w = [[one, x, y], [x, one, y], [x, y, one]][face / 2];
    let length = (1.0 + x * x + y * y).sqrt();
    w.map(|c| c / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    type Known = (f64, [f64; 4], Option<f64>, Option<f64>);

    /// Known values for eta = 1.55, angles and energies, caustics of TRT and of the next lobe in degrees.
    const TABLE: [Known; 7] = [
        (
            0.0,
            [0.074955, 0.861791, 0.055672, 0.007582],
            Some(18.62),
            Some(95.30),
        ),
        (
            15.0,
            [0.077274, 0.857879, 0.056836, 0.008012],
            Some(16.19),
            None,
        ),
        (
            30.0,
            [0.086181, 0.842768, 0.061419, 0.009632],
            Some(9.24),
            Some(115.50),
        ),
        (
            45.0,
            [0.109841, 0.802600, 0.073589, 0.013970],
            Some(0.50),
            Some(140.98),
        ),
        (
            60.0,
            [0.173474, 0.697349, 0.102011, 0.027166],
            None,
            Some(172.62),
        ),
        (75.0, [0.360239, 0.425014, 0.136671, 0.078076], None, None),
        (85.0, [0.687590, 0.103656, 0.068140, 0.140613], None, None),
    ];

    #[test]
    fn energies_and_caustics_are_the_known_ones() {
        for (degrees, expected, trt, trrt) in TABLE {
            let theta = f64::to_radians(degrees);
            let found = energies(1.55, theta, 0.0);
            assert!((found.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            for (a, b) in found.iter().zip(expected) {
                assert!((a - b).abs() < 1e-6, "{degrees} degrees: {found:?}");
            }
            for (p, angle) in [(2, trt), (3, trrt)] {
                if let Some(angle) = angle {
                    let found = caustic(1.55, theta, p).map_or(f64::NAN, f64::to_degrees);
                    assert!((found - angle).abs() < 0.006, "{degrees}, p {p}: {found}");
                }
            }
            if degrees >= 60.0 {
                assert_eq!(caustic(1.55, theta, 2), None);
            }
        }
        for (degrees, total) in [(0.0, 0.698385), (30.0, 0.682760), (60.0, 0.654173)] {
            let found: f64 = energies(1.55, f64::to_radians(degrees), 0.2).iter().sum();
            assert!((found - total).abs() < 1e-6, "{found}");
        }
    }

    #[test]
    fn texels_hold_their_directions() {
        for i in 0..6 * 8 * 8 {
            assert_eq!(texel(8, direction(8, i, 0.3, 0.9)), i);
        }
    }

    #[test]
    fn maps_hold_the_energies() {
        let (from, to) = (0.3f64, 0.5f64);
        let maps = LobeMaps::new(1.55, 0.2, from, to, 8, 60, 20_000);
        for (p, map) in maps.maps.iter().enumerate() {
            let expected = over_bin(from, to, |theta| energies(1.55, theta, 0.2)[p]);
            let sum: f64 = map.iter().sum();
            assert!((sum - expected).abs() < 1e-5, "{p}: {sum} {expected}");
        }
    }
}
