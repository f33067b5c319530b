//! Stripes, spots and nets: local activation and lateral inhibition on the skin.
//!
//! Turing's mechanism in the form of a kernel (Kondo 2017, "An updated kernel-based Turing model for
//! studying the mechanisms of biological pattern formation", Journal of Theoretical Biology 414; Young
//! 1984, "A local activator-inhibitor model of vertebrate skin patterns"): pigment cells are switched
//! on by others nearby and off by those farther away. The two Gaussians of the kernel are diffusion
//! along the skin, so that legs, ears and tail are what they are for a substance in the skin.

use super::net::Net;
use crate::groom::noise::Symmetry;
use crate::progress::Cancel;
use crate::sampling::hash64;
use rayon::prelude::*;
use std::f32::consts::TAU;

/// Spread of the inhibitor over that of the activator.
const RATIO: f32 = 2.0;
/// How steeply cells switch.
const GAIN: f32 = 6.0;
/// The switch's offset at a balance of 1.
const BIAS: f32 = 0.75;
/// Rounds until a pattern is settled.
const ROUNDS: usize = 48;
/// Cells listen to their mirror images by the symmetry to this power: what begins alike stays so, but only sides
/// that are to be almost equal are held together.
const BOND: i32 = 8;
/// Points in a wavelength: fewer and the kernel's center has no neighbors.
pub(super) const POINTS_A_WAVE: f32 = 6.5;

/// A pattern wanted.
pub(super) struct Wanted<'a> {
    /// Meters.
    pub(super) wavelength: f32,
    /// -1 spots .. 1 a net.
    pub(super) balance: f32,
    /// 0..1.
    pub(super) order: f32,
    /// Whether stripes run across the lay of the hair, else along it.
    pub(super) across: bool,
    /// Factor on the wavelength at each point, at most 1.
    pub(super) scale: &'a [f32],
    /// What pushes cells on (above 0) or off at each point; empty for nothing.
    pub(super) push: &'a [f32],
    /// How alike both sides of the body are.
    pub(super) symmetry: Symmetry<'a>,
    /// Of the noise it starts from.
    pub(super) seed: u64,
}

/// Activity of the cells at each point, -1 off .. 1 on. `None` if canceled.
pub(super) fn grow(net: &Net, wanted: &Wanted<'_>, cancel: &Cancel) -> Option<Vec<f32>> {
    let activator = Diffusion::new(net, wanted.order, wanted.across);
    let inhibitor = Diffusion::new(net, 0.0, true);
    // The kernel's preferred wave has k^2 = 2 ln(r^2) / (sigma^2 (r^2 - 1)).
    let square = RATIO * RATIO;
    let sigma = wanted.wavelength / TAU * (2.0 * square.ln() / (square - 1.0)).sqrt();
    let near = activator.plan(sigma, wanted.scale);
    let far = inhibitor.plan(RATIO * sigma, wanted.scale);
    let noise = |i: usize| {
        let bits = hash64(wanted.seed ^ hash64(i as u64 + 1));
        (bits >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    };
    let mut state: Vec<f32> = (0..net.len()).map(|i| 0.5 * noise(i)).collect();
    let (amount, images) = (wanted.symmetry.amount, net.images(wanted.symmetry));
    // Correlated by the amount, as strong as without.
    let own = (1.0 - amount * amount).max(0.0).sqrt();
    let shared = images.iter().map(|(i, image)| {
        let strength: f32 = image.iter().map(|(_, w)| w * w).sum();
        own * state[*i] + amount * at(image, &state) / strength.sqrt()
    });
    let shared: Vec<f32> = shared.collect();
    put(&images, &shared, &mut state);
    let bond = amount.powi(BOND);
    for _ in 0..ROUNDS {
        if cancel.is_cancelled() {
            return None;
        }
        let on = near.run(&activator, &state);
        let off = far.run(&inhibitor, &state);
        state
            .par_iter_mut()
            .with_min_len(1024)
            .enumerate()
            .for_each(|(i, s)| {
                let push = wanted.push.get(i).copied().unwrap_or(0.0);
                let drive = GAIN * (on[i] - off[i]) + BIAS * wanted.balance + push;
                *s = drive.tanh();
            });
        let alike = images.iter().map(|(i, image)| {
            let own = state[*i];
            own + bond * (at(image, &state) - own)
        });
        let alike: Vec<f32> = alike.collect();
        put(&images, &alike, &mut state);
    }
    // The grain of single points is not part of the pattern.
    Some(near.run(&activator, &state))
}

/// A value at weighted points.
fn at(points: &[(u32, f32)], values: &[f32]) -> f32 {
    points.iter().map(|&(j, w)| w * values[j as usize]).sum()
}

/// Replaces the values of points that have an image.
fn put<T>(images: &[(usize, T)], new: &[f32], values: &mut [f32]) {
    for ((i, _), value) in images.iter().zip(new) {
        values[*i] = *value;
    }
}

/// One step of diffusion: every point becomes a mean of itself and its neighbors.
pub(super) struct Diffusion<'a> {
    net: &'a Net,
    /// Per edge; those of a point sum to 1.
    weights: Vec<f32>,
    /// Variance of a step across the stripes, square meters, the mean over points.
    variance: f32,
}

impl<'a> Diffusion<'a> {
    /// * `order`: how much more goes along the stripes than across, 0..1.
    pub(super) fn new(net: &'a Net, order: f32, across: bool) -> Self {
        let width = 0.64 * net.spacing * net.spacing;
        let mut weights = vec![0.0; net.edge_count()];
        let (mut sum, mut known) = (0.0f64, 0u32);
        for i in 0..net.len() {
            let stripes = if across {
                net.lay[i].cross(net.normals[i])
            } else {
                net.lay[i]
            };
            let edges = net.edges(i);
            let (mut total, mut variance) = (0.0, 0.0);
            for (e, &j) in edges.clone().zip(net.neighbors(i)) {
                let d = net.positions[j as usize] - net.positions[i];
                let d = d - net.normals[i] * d.dot(net.normals[i]);
                let square = d.length_squared().max(1e-20);
                let along = d.dot(stripes).powi(2) / square;
                let weight = (-0.5 * square / width).exp() * (1.0 - order + order * along * along);
                weights[e] = weight;
                total += weight;
                variance += weight * square * (1.0 - along);
            }
            if total > 0.0 {
                for w in &mut weights[edges] {
                    *w /= total;
                }
                sum += f64::from(variance / total);
                known += 1;
            }
        }
        Self {
            net,
            weights,
            variance: (sum / f64::from(known.max(1))) as f32,
        }
    }

    /// Steps that spread by `sigma` meters times a factor at each point.
    pub(super) fn plan(&self, sigma: f32, scale: &[f32]) -> Steps {
        let wanted = sigma * sigma / self.variance.max(1e-20);
        let count = wanted.ceil().clamp(1.0, 400.0);
        let share = wanted / count;
        Steps {
            count: count as usize,
            shares: scale.iter().map(|s| (share * s * s).min(1.0)).collect(),
        }
    }
}

/// How often to diffuse, and how much of a step at each point.
pub(super) struct Steps {
    count: usize,
    shares: Vec<f32>,
}

impl Steps {
    /// Diffuses some values.
    pub(super) fn run(&self, by: &Diffusion<'_>, values: &[f32]) -> Vec<f32> {
        let mut now = values.to_vec();
        let mut next = vec![0.0; values.len()];
        for _ in 0..self.count {
            next.par_iter_mut()
                .with_min_len(1024)
                .enumerate()
                .for_each(|(i, out)| {
                    let near = by.net.neighbors(i).iter().zip(&by.weights[by.net.edges(i)]);
                    let mean: f32 = near.map(|(&j, w)| now[j as usize] * w).sum();
                    // A point without neighbors keeps what it has.
                    let share = if by.net.neighbors(i).is_empty() {
                        0.0
                    } else {
                        self.shares[i]
                    };
                    *out = now[i] + share * (mean - now[i]);
                });
            std::mem::swap(&mut now, &mut next);
        }
        now
    }
}
