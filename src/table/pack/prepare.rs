//! A table as rows of numbers of comparable size.

use super::Layout;
use crate::math::frame;
use crate::math::unicube::Unicube;
use crate::table::compare::{Side, TableRef};

/// Beyond this inclination errors of S count no more than at it: toward grazing S grows without bound.
const COS_MIN: f64 = 0.292;

/// How far a map may be from its mirror image, above noise, to be folded: relative L2.
const SYMMETRIC: f64 = 0.01;

/// Densities `S cos(theta)` of all maps in units of their channel's root mean square.
pub(super) struct Prepared {
    pub(super) layout: Layout,
    pub(super) thetas: Vec<f64>,
    pub(super) channels: usize,
    /// Per channel, density of one unit.
    pub(super) scale: Vec<f64>,
    /// `maps[node * channels + channel]`.
    pub(super) maps: Vec<Vec<f32>>,
    /// Variance of their noise.
    pub(super) variance: Vec<Vec<f32>>,
    /// Solid angle of each place.
    pub(super) measure: Vec<f32>,
    /// What squared errors count at each place. Over a channel and all nodes these times the squares of
    /// the values and the node's weight sum to 1.
    pub(super) cost: Vec<f32>,
    /// Per node.
    pub(super) node_weight: Vec<f64>,
}

impl Prepared {
    pub(super) fn new(table: TableRef<'_>) -> Self {
        let nodes = table.nodes();
        let side = Side::new(table, (0..table.channels()).collect());
        let cube = &side.cube;
        let folded = cube.res() >= 2 && symmetric(&side);
        let layout = Layout {
            res: cube.res(),
            folded,
        };
        let places: Vec<usize> = (0..layout.len()).map(|i| layout.texel(i)).collect();
        let measure: Vec<f32> = places.iter().map(|&t| cube.solid_angle(t) as f32).collect();
        let cost: Vec<f32> = places.iter().map(|&t| texel_cost(cube, t) as f32).collect();
        let node_weight: Vec<f64> = nodes
            .edges
            .windows(2)
            .map(|e| e[1].sin() - e[0].sin())
            .collect();
        let channels = table.channels();
        let mut prepared = Self {
            layout,
            thetas: nodes.centers.clone(),
            channels,
            scale: vec![0.0; channels],
            maps: Vec::new(),
            variance: Vec::new(),
            measure,
            cost,
            node_weight,
        };
        for node in 0..nodes.len() {
            for channel in 0..channels {
                let at = |texel: usize| {
                    let (flux, variance) = side.flux(channel, node, texel);
                    let solid = cube.solid_angle(texel);
                    (flux / solid, variance / (solid * solid))
                };
                let (map, variance) = places
                    .iter()
                    .map(|&texel| {
                        let (a, va) = at(texel);
                        if !folded {
                            return (a as f32, va as f32);
                        }
                        let (b, vb) = at(cube.mirrored(texel));
                        ((0.5 * (a + b)) as f32, (0.25 * (va + vb)) as f32)
                    })
                    .unzip();
                prepared.maps.push(map);
                prepared.variance.push(variance);
            }
        }
        prepared.normalize();
        prepared
    }

    fn normalize(&mut self) {
        for channel in 0..self.channels {
            let squares = self.maps.iter().skip(channel).step_by(self.channels);
            let energy: f64 = squares
                .zip(&self.node_weight)
                .map(|(map, weight)| {
                    let terms = map.iter().zip(&self.cost);
                    weight
                        * terms
                            .map(|(&x, &c)| f64::from(c) * f64::from(x).powi(2))
                            .sum::<f64>()
                })
                .sum();
            let scale = if energy > 0.0 { energy.sqrt() } else { 1.0 };
            self.scale[channel] = scale;
            for map in self.maps.iter_mut().skip(channel).step_by(self.channels) {
                map.iter_mut()
                    .for_each(|x| *x = (f64::from(*x) / scale) as f32);
            }
            for map in self
                .variance
                .iter_mut()
                .skip(channel)
                .step_by(self.channels)
            {
                map.iter_mut()
                    .for_each(|v| *v = (f64::from(*v) / (scale * scale)) as f32);
            }
        }
    }
}

/// Squared errors of the density count so much that those of S count the same everywhere.
fn texel_cost(cube: &Unicube, texel: usize) -> f64 {
    let (w, _) = cube.direction(texel, 0.5, 0.5);
    let cosine = frame::theta_of(w).cos().max(COS_MIN);
    cube.solid_angle(texel) / (cosine * cosine)
}

fn symmetric(side: &Side<'_>) -> bool {
    let cube = &side.cube;
    (0..side.channels.len()).all(|channel| {
        let (mut apart, mut noise, mut square) = (0.0, 0.0, 0.0);
        for node in 0..side.table.nodes().len() {
            for texel in 0..cube.texels() {
                let cost = texel_cost(cube, texel) / cube.solid_angle(texel).powi(2);
                let (a, va) = side.flux(channel, node, texel);
                let (b, vb) = side.flux(channel, node, cube.mirrored(texel));
                apart += cost * (a - b) * (a - b);
                noise += cost * (va + vb);
                square += cost * a * a;
            }
        }
        // The errors of files are estimates themselves; some percent of them are no asymmetry.
        apart - 1.05 * noise <= SYMMETRIC * SYMMETRIC * square
    })
}
