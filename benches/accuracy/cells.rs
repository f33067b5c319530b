//! S in cells of (inclination of the query, inclination, azimuth), and the reference there.

use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use vair::bake::{End, Photon, Sides, fly_all};
use vair::fiber::Fiber;
use vair::math::frame;
use vair::table::ScatterTable;

const QUERIES: usize = 96;
const THETAS: usize = 128;
const PHIS: usize = 64;
const LIMIT_DEG: f64 = 73.0;
/// Points a cell along each side at which a table is looked up: a cell is about two texels.
const POINTS: usize = 2;

/// Mean S of every cell, folded over azimuth.
pub(crate) struct Cells(Vec<f32>);

/// Two independent readings of the truth.
pub(crate) struct Reference {
    halves: [Cells; 2],
    norm: f64,
}

fn query(i: usize) -> f64 {
    let limit = LIMIT_DEG.to_radians();
    limit * (2.0 * (i as f64 + 0.5) / QUERIES as f64 - 1.0)
}

fn theta_edge(j: usize) -> f64 {
    PI * j as f64 / THETAS as f64 - FRAC_PI_2
}

impl Cells {
    pub(crate) fn of(table: &ScatterTable) -> Self {
        let row = |i: usize| -> Vec<f32> {
            let lobe = table.lobe(frame::direction(query(i), 0.0).as_vec3());
            let mut cells = Vec::with_capacity(THETAS * PHIS);
            for j in 0..THETAS {
                for k in 0..PHIS {
                    let (mut sum, mut weights) = (0.0, 0.0);
                    for point in 0..POINTS * POINTS {
                        let at = |i: usize| (i as f64 + 0.5) / POINTS as f64;
                        let (a, b) = (at(point % POINTS), at(point / POINTS));
                        let theta = theta_edge(0) + PI * (j as f64 + a) / THETAS as f64;
                        let phi = PI * (k as f64 + b) / PHIS as f64;
                        let wi = frame::direction(theta, phi).as_vec3();
                        // The mean of S over the area that light crosses: weights cos^2.
                        sum += f64::from(lobe.density(wi).x) * theta.cos();
                        weights += theta.cos().powi(2);
                    }
                    cells.push((sum / weights) as f32);
                }
            }
            cells
        };
        let rows: Vec<Vec<f32>> = (0..QUERIES).into_par_iter().map(row).collect();
        Self(rows.concat())
    }

    /// Counts photons: by chance at every boundary, in their own frame.
    fn count(fiber: &Fiber, absorption_per_um: f64, photons: u64, seed: u64) -> Self {
        let half = LIMIT_DEG.to_radians() / QUERIES as f64;
        let row = |i: usize| -> Vec<f32> {
            let mut cells = vec![0.0f64; THETAS * PHIS];
            let center = query(i);
            let each = photons / QUERIES as u64;
            let photons = (0..each).map(|index| Photon {
                seed,
                stream: ((i as u64) << 40) | index,
                sin_range: ((center - half).sin(), (center + half).sin()),
                sides: Sides::ALL,
            });
            fly_all(fiber, photons, false, 1000, |_, flight| {
                let End::Escaped(w) = flight.end else {
                    return;
                };
                let (sin, cos) = (flight.theta() - center).sin_cos();
                let w = frame::shift_inclination(w, sin, cos);
                let j = ((frame::theta_of(w) - theta_edge(0)) / PI * THETAS as f64) as usize;
                let k = (w.y.atan2(w.x).abs() / PI * PHIS as f64) as usize;
                cells[j.min(THETAS - 1) * PHIS + k.min(PHIS - 1)] +=
                    flight.share * (-absorption_per_um * flight.path_um).exp();
            });
            let mean = cells.iter().enumerate().map(|(cell, sum)| {
                let (lo, hi) = (theta_edge(cell / PHIS), theta_edge(cell / PHIS + 1));
                // Integral of cos over the solid angle, on both sides.
                let integral = |t: f64| 0.5 * t + 0.25 * (2.0 * t).sin();
                let projected = 2.0 * PI / PHIS as f64 * (integral(hi) - integral(lo));
                (sum / each as f64 / projected) as f32
            });
            mean.collect()
        };
        let rows: Vec<Vec<f32>> = (0..QUERIES).into_par_iter().map(row).collect();
        Self(rows.concat())
    }
}

impl Reference {
    /// Flies `photons`, half of them for each reading; kept in `target/accuracy` for the next time.
    pub(crate) fn of(
        name: &str,
        fiber: &Fiber,
        absorption_per_um: f64,
        photons: u64,
    ) -> std::io::Result<Self> {
        let text = format!("{:?} {absorption_per_um} {photons}", fiber.structure());
        let hash = text.bytes().fold(0, |h, b| {
            vair::sampling::hash64(h ^ u64::from(b).wrapping_add(0x9e37_79b9_7f4a_7c15))
        });
        let folder = std::path::Path::new("target/accuracy");
        let path = folder.join(format!("{name}-{hash:016x}.f32"));
        let count = QUERIES * THETAS * PHIS;
        let halves = match std::fs::read(&path) {
            Ok(bytes) if bytes.len() == 8 * count => {
                let all: Vec<f32> = bytes
                    .chunks_exact(4)
                    .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
                    .collect();
                [Cells(all[..count].to_vec()), Cells(all[count..].to_vec())]
            }
            _ => {
                let half = |seed| Cells::count(fiber, absorption_per_um, photons / 2, seed);
                let halves = [half(0xacc0), half(0xacc1)];
                std::fs::create_dir_all(folder)?;
                let all = halves.iter().flat_map(|h| &h.0);
                std::fs::write(path, all.flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>())?;
                halves
            }
        };
        let mut reference = Self { halves, norm: 1.0 };
        reference.norm = reference.sum(|cell| {
            f64::from(reference.halves[0].0[cell]) * f64::from(reference.halves[1].0[cell])
        });
        Ok(reference)
    }

    /// Squared relative error of a table.
    pub(crate) fn error(&self, table: &Cells) -> f64 {
        self.bias(table, table)
    }

    /// Squared relative error that two tables have in common.
    pub(crate) fn bias(&self, a: &Cells, b: &Cells) -> f64 {
        let [left, right] = &self.halves;
        let off = |t: &Cells, r: &Cells, cell: usize| f64::from(t.0[cell] - r.0[cell]);
        let one = self.sum(|cell| off(a, left, cell) * off(b, right, cell));
        let other = self.sum(|cell| off(b, left, cell) * off(a, right, cell));
        0.5 * (one + other)
    }

    /// Squared relative noise of two tables that differ in nothing else.
    pub(crate) fn variance(&self, a: &Cells, b: &Cells) -> f64 {
        0.5 * self.sum(|cell| f64::from(a.0[cell] - b.0[cell]).powi(2))
    }

    /// Relative noise of one half.
    pub(crate) fn noise(&self) -> f64 {
        self.variance(&self.halves[0], &self.halves[1]).sqrt()
    }

    /// Weighted sum over the cells within the limit, relative to that of S squared.
    fn sum(&self, of: impl Fn(usize) -> f64) -> f64 {
        let limit = LIMIT_DEG.to_radians();
        let cells = 0..QUERIES * THETAS * PHIS;
        let sum: f64 = cells
            .map(|cell| {
                let j = cell / PHIS % THETAS;
                let (lo, hi) = (theta_edge(j), theta_edge(j + 1));
                if (0.5 * (lo + hi)).abs() < limit {
                    (hi.sin() - lo.sin()) * of(cell)
                } else {
                    0.0
                }
            })
            .sum();
        sum / self.norm
    }
}
