//! The two models: parameters, ranges and lobes.
//!
//! Both are taken as far-field models: means over the width of the fiber, as a table is.

use super::data::COLUMNS;
use super::lobes::{
    Entry, Lobe, OFFSETS, add_logistic, along, entries, exit_azimuth, logistic_scale, variance,
};
use crate::math::{crossings, fresnel};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// A model of hair or fur that can be fitted to a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// Chiang, Bitterli, Tappan, Burley 2016: R, TT, TRT and the rest, longitudinal lobes of d'Eon et al.
    /// 2011, logistic azimuths. What pbrt, Mitsuba, Cycles and MaterialX call (principled) hair.
    Chiang,
    /// The double cylinder after Yan, Tseng, Jensen, Ramamoorthi 2015 and 2017: a cuticle of layers, a
    /// cortex, and a medulla that scatters. Their tabulated profiles of scattered light are replaced by
    /// two lobes in closed form, one about straight through (TTs) and one about straight back (TRTs):
    /// each a longitudinal lobe of its own width times a wrapped Cauchy in azimuth.
    DoubleCylinder,
}

/// A parameter that all channels share: name, range, start.
pub(super) struct Shared {
    pub(super) name: &'static str,
    pub(super) range: [f64; 2],
    pub(super) start: f64,
}

const fn shared(name: &'static str, range: [f64; 2], start: f64) -> Shared {
    Shared { name, range, start }
}

const CHIANG: [Shared; 4] = [
    shared("eta", [1.1, 2.2], 1.5),
    shared("beta_m", [0.04, 1.0], 0.3),
    shared("beta_n", [0.05, 1.0], 0.3),
    shared("alpha_deg", [-12.0, 12.0], 1.0),
];

const DOUBLE_CYLINDER: [Shared; 13] = [
    shared("eta", [1.1, 2.2], 1.5),
    shared("beta_m", [0.04, 1.0], 0.3),
    shared("beta_n", [0.05, 1.0], 0.3),
    shared("alpha_deg", [-12.0, 12.0], 1.0),
    shared("layers", [0.2, 5.0], 1.0),
    shared("kappa", [0.02, 0.98], 0.6),
    shared("sigma_m_s", [0.0, 20.0], 1.0),
    shared("beta_m_s", [0.1, 1.0], 0.6),
    shared("rho_s", [0.0, 0.95], 0.3),
    shared("path_s", [0.0, 12.0], 3.0),
    shared("back_s", [0.0, 1.0], 0.4),
    shared("beta_m_b", [0.1, 1.0], 0.6),
    shared("rho_b", [0.0, 0.95], 0.3),
];

/// Most absorption of a channel, per radius: what crosses the fiber then is gone.
const MOST_ABSORPTION: f64 = 30.0;

impl Model {
    /// What it is called on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Chiang => "chiang",
            Self::DoubleCylinder => "double-cylinder",
        }
    }

    /// Its lobes, in order.
    pub fn lobes(self) -> &'static [&'static str] {
        match self {
            Self::Chiang => &["R", "TT", "TRT", "TRRT+"],
            Self::DoubleCylinder => &["R", "TT", "TRT", "TRRT+", "TTs", "TRTs"],
        }
    }

    /// Names of the parameters that all channels share, in order.
    pub fn parameters(self) -> Vec<&'static str> {
        self.shared().iter().map(|shared| shared.name).collect()
    }

    pub(super) fn shared(self) -> &'static [Shared] {
        match self {
            Self::Chiang => &CHIANG,
            Self::DoubleCylinder => &DOUBLE_CYLINDER,
        }
    }

    /// The absorption with which even light is scattered by the given shares; the most or none where no
    /// absorption does that.
    ///
    /// * `queries`: inclinations, radians, each with its share of the light. * `p`: the shared parameters.
    pub(super) fn absorption(self, queries: &[(f64, f64)], p: &[f64], albedo: &[f64]) -> Vec<f64> {
        let medulla = self.medulla(p);
        let rays: Vec<(Crossing, f64)> = queries
            .iter()
            .flat_map(|&(theta, share)| entries(p[0], theta).map(move |entry| (entry, share)))
            .map(|(entry, share)| {
                let crossing = Crossing::new(&entry, p[0], medulla.as_ref());
                (crossing, share / OFFSETS as f64)
            })
            .collect();
        let scattered = |sigma: f64| -> f64 {
            let of =
                |(ray, share): &(Crossing, f64)| share * ray.energies(sigma).iter().sum::<f64>();
            rays.iter().map(of).sum()
        };
        let solve = |&albedo: &f64| {
            let [mut lo, mut hi] = [0.0, MOST_ABSORPTION];
            // Down to 1e-9: derivatives of the fit are differences.
            for _ in 0..35 {
                let middle = 0.5 * (lo + hi);
                match scattered(middle) > albedo {
                    true => lo = middle,
                    false => hi = middle,
                }
            }
            0.5 * (lo + hi)
        };
        albedo.par_iter().map(solve).collect()
    }

    fn medulla(self, p: &[f64]) -> Option<Medulla> {
        match self {
            Self::Chiang => None,
            Self::DoubleCylinder => Some(Medulla {
                layers: p[4],
                kappa: p[5],
                scattering: p[6],
                path: p[9],
            }),
        }
    }

    /// The lobes for one query.
    ///
    /// * `edges`: of the rows of inclinations. * `p`: the shared parameters in their order.
    /// * `absorption`: per channel.
    pub(super) fn evaluate(
        self,
        theta_q: f64,
        edges: &[f64],
        p: &[f64],
        absorption: &[f64],
    ) -> Vec<Lobe> {
        let medulla = self.medulla(p);
        let v = variance(p[1]);
        let scale = logistic_scale(p[2]);
        let alpha = p[3].to_radians();
        // Scales tilt R toward the root and TT and TRT toward the tip; the rest is not tilted.
        let tilted = [
            theta_q + 2.0 * alpha,
            theta_q - alpha,
            theta_q - 4.0 * alpha,
            theta_q,
        ];
        let mut lobes: Vec<Lobe> = tilted
            .iter()
            .zip([v, 0.25 * v, 4.0 * v, 4.0 * v])
            .map(|(&theta, v)| Lobe {
                along: along(edges, theta, v),
                around: vec![[0.0; COLUMNS]; absorption.len()],
            })
            .collect();
        let mut scattered = vec![0.0; absorption.len()];
        for entry in entries(p[0], theta_q) {
            let crossing = Crossing::new(&entry, p[0], medulla.as_ref());
            let energies: Vec<[f64; 5]> =
                (absorption.iter().map(|&sigma| crossing.energies(sigma))).collect();
            let of = |lobe: usize| {
                energies
                    .iter()
                    .map(|e| e[lobe] / OFFSETS as f64)
                    .collect::<Vec<_>>()
            };
            for (order, lobe) in lobes.iter_mut().take(3).enumerate() {
                add_logistic(
                    &mut lobe.around,
                    exit_azimuth(order, &entry),
                    scale,
                    &of(order),
                );
            }
            for (around, energy) in lobes[3].around.iter_mut().zip(of(3)) {
                around.iter_mut().for_each(|a| *a += energy / TAU);
            }
            scattered.iter_mut().zip(of(4)).for_each(|(s, e)| *s += e);
        }
        if self == Self::DoubleCylinder {
            let (back, forth) = (p[10], 1.0 - p[10]);
            for (share, beta, rho) in [(forth, p[7], p[8]), (back, p[11], -p[12])] {
                let cauchy = wrapped_cauchy(rho).map(|c| share * c);
                lobes.push(Lobe {
                    along: along(edges, theta_q, variance(beta)),
                    around: scattered.iter().map(|s| cauchy.map(|c| c * s)).collect(),
                });
            }
        }
        lobes
    }
}

struct Medulla {
    layers: f64,
    kappa: f64,
    scattering: f64,
    path: f64,
}

/// What a ray meets, whatever the absorption.
struct Crossing {
    reflectance: f64,
    /// Lengths in the cortex, radii: of a crossing, and of what the medulla scatters.
    cortex: f64,
    path: f64,
    /// What scattering leaves of light that crosses the medulla.
    straight: f64,
}

impl Crossing {
    fn new(entry: &Entry, eta: f64, medulla: Option<&Medulla>) -> Self {
        let crossing = 2.0 * entry.gamma_t.cos() / entry.cos_theta_t;
        let Some(medulla) = medulla else {
            return Self {
                reflectance: fresnel::dielectric(entry.cosine, eta).0,
                cortex: crossing,
                path: 0.0,
                straight: 1.0,
            };
        };
        let inside = (medulla.kappa.powi(2) - entry.gamma_t.sin().powi(2)).max(0.0);
        let in_medulla = 2.0 * inside.sqrt() / entry.cos_theta_t;
        Self {
            reflectance: fresnel::layered(entry.cosine, eta, medulla.layers).0,
            cortex: crossing - in_medulla,
            path: medulla.path,
            straight: (-medulla.scattering * in_medulla).exp(),
        }
    }

    /// Of R, TT, TRT, all the rest, and light scattered in the medulla.
    fn energies(&self, sigma: f64) -> [f64; 5] {
        let f = self.reflectance;
        let t = (-sigma * self.cortex).exp() * self.straight;
        let [r, tt, trt, rest] = crossings::straight(f, t);
        // What leaves the straight path comes out after a path of its own.
        let out = (-sigma * self.path).exp();
        let scattered = crossings::scattered(f, t, 1.0 - self.straight) * out;
        [r, tt, trt, rest, scattered]
    }
}

/// Per radian, about straight through; `rho` below zero scatters back. Means over the columns.
fn wrapped_cauchy(rho: f64) -> [f64; COLUMNS] {
    std::array::from_fn(|column| {
        const POINTS: usize = 4;
        let at = |i: usize| {
            let phi = PI * (column as f64 + (i as f64 + 0.5) / POINTS as f64) / COLUMNS as f64;
            (1.0 - rho * rho) / (1.0 + rho * rho + 2.0 * rho * phi.cos()) / TAU
        };
        (0..POINTS).map(at).sum::<f64>() / POINTS as f64
    })
}
