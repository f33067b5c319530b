//! Where in a table the scattering for a pair of directions is found: texels and weights that are
//! the same for all channels.

use super::{Mode, Nodes};
use crate::math::frame;
use crate::math::unicube::Unicube;
use glam::DVec3;

/// Texels of a table and the weights with which their flux fractions sum to the density
/// `S cos(theta_i)` per steradian for one query inclination and one direction.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Taps {
    taps: [Tap; 4],
    count: usize,
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tap {
    pub(super) node: usize,
    pub(super) texel: usize,
    pub(super) weight: f64,
}

impl Taps {
    /// The look-up of the renderer: two nodes that bracket `theta_q`, each in its own cone frame, in
    /// each at most two texels (one arrives over the pole). See [`Mode::Cone`].
    pub(super) fn new(nodes: &Nodes, cube: &Unicube, theta_q: f64, wi: DVec3) -> Self {
        let (a, b, share) = nodes.bracket(theta_q);
        let mut taps = Self::default();
        taps.look_up(nodes, cube, (theta_q, wi), (a, 1.0 - share));
        if share > 0.0 {
            taps.look_up(nodes, cube, (theta_q, wi), (b, share));
        }
        taps
    }

    fn look_up(
        &mut self,
        nodes: &Nodes,
        cube: &Unicube,
        (theta_q, wi): (f64, DVec3),
        (node, share): (usize, f64),
    ) {
        let (sin, cos) = match nodes.mode {
            Mode::Paper => (0.0, 1.0),
            Mode::Cone => (theta_q - nodes.centers[node]).sin_cos(),
        };
        if sin == 0.0 {
            return self.push(cube, node, wi, share);
        }
        let c = wi.x.hypot(wi.y).max(1e-6);
        for side in [1.0, -1.0] {
            let shifted = side * c * cos - wi.z * sin;
            if shifted > 0.0 {
                let k = side * shifted / c;
                let z = wi.z * cos + side * c * sin;
                let w = DVec3::new(wi.x * k, wi.y * k, z);
                self.push(cube, node, w, share * shifted / c);
            }
        }
    }

    fn push(&mut self, cube: &Unicube, node: usize, w: DVec3, weight: f64) {
        if let Some(tap) = self.taps.get_mut(self.count) {
            *tap = Tap {
                node,
                texel: cube.texel(w),
                weight: weight / cube.jacobian(w),
            };
            self.count += 1;
        }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Tap> {
        self.taps[..self.count].iter()
    }
}

/// For every texel the integral of `cos(theta)` over its solid angle: the divisor that turns flux
/// fractions into the scattering function, `S = F / C`.
pub(super) fn cosine_integrals(cube: &Unicube) -> Vec<f64> {
    /// Points along each axis of a texel; 4 leave 1e-4 beside the pole of a 64-texel face.
    const POINTS: usize = 4;
    let at = |i: usize| (i as f64 + 0.5) / POINTS as f64;
    (0..cube.texels())
        .map(|texel| {
            let points = (0..POINTS * POINTS).map(|i| {
                let (w, jacobian) = cube.direction(texel, at(i % POINTS), at(i / POINTS));
                frame::theta_of(w).cos() * jacobian
            });
            points.sum::<f64>() / (POINTS * POINTS) as f64
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;
    use crate::table::ScatterTable;

    #[test]
    fn taps_are_the_look_up_of_the_renderer() {
        let mut rng = Rng::new(3, 9);
        for mode in [Mode::Cone, Mode::Paper] {
            let nodes = Nodes::new(mode, 7);
            let cube = Unicube::new(8);
            let flux: Vec<[f32; 3]> = (0..7 * cube.texels())
                .map(|_| std::array::from_fn(|_| rng.uniform_f32()))
                .collect();
            let table = ScatterTable::new(nodes.clone(), 8, flux.clone());
            for _ in 0..2000 {
                let theta = 3.1 * (rng.uniform() - 0.5);
                let (texel, a, b) = (rng.uniform() * 384.0, rng.uniform(), rng.uniform());
                let (wi, _) = cube.direction(texel as usize, a, b);
                // As the renderer's single precision sees them.
                let wi = wi.as_vec3();
                let wo = frame::direction(theta, 0.0).as_vec3();
                let theta = f64::from(wo.z.atan2(wo.x.hypot(wo.y)));
                let expected = table.lobe(wo).density(wi);
                let taps = Taps::new(&nodes, &cube, theta, wi.as_dvec3());
                for c in 0..3 {
                    let found: f64 = taps
                        .iter()
                        .map(|t| t.weight * f64::from(flux[t.node * cube.texels() + t.texel][c]))
                        .sum();
                    let expected = f64::from(expected[c]);
                    let off = (found - expected).abs();
                    assert!(off <= 1e-4 * expected, "{found} against {expected}");
                }
            }
        }
    }

    #[test]
    fn cosines_integrate_to_the_sphere() {
        let cube = Unicube::new(16);
        let sum: f64 = cosine_integrals(&cube).iter().sum();
        // The integral of cos(theta) over the sphere is pi^2.
        let exact = std::f64::consts::PI.powi(2);
        assert!((sum / exact - 1.0).abs() < 1e-4, "{sum}");
    }
}
