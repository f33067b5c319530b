//! The table the renderer reads: flux per linear RGB, with exact sampling.
//!
//! Inside a texel the flux is spread evenly over texture area, so the density at a direction is
//! `F_t / (d omega / d area)`. A look-up blends the two nodes that bracket the query inclination,
//! each in its own cone frame (see [`Mode::Cone`]). Sampling descends a pyramid of the mean of the
//! channels, so `pdf = mean(density) / mean(albedo)` holds identically and a gray table has
//! throughput exactly `albedo`. Where azimuths are told apart, one of the two bins that bracket the
//! query's is drawn by chance: on average that is the blend, at half of its cost.

use super::{Mode, Nodes, Provenance, ScatterMaps};
use crate::color::Rgb;
use crate::math::frame;
use crate::math::unicube::Unicube;
use glam::{DVec3, Vec3};

/// S for linear RGB on unicubes.
#[derive(Clone, Debug)]
pub struct ScatterTable {
    nodes: Nodes,
    cube: Unicube,
    /// `flux[node * texels + texel]`.
    flux: Vec<[f32; 3]>,
    /// Per node, the sums of the mean flux: 6 faces, then 4 times as many cells at each finer level.
    pyramid: Vec<f32>,
    /// Offset of each pyramid level inside a node's part.
    levels: Vec<usize>,
    /// Per node.
    albedo: Vec<Rgb>,
}

/// The scattering for one query direction: the two nodes that take part and their shares.
#[derive(Clone, Copy, Debug)]
pub struct Lobe<'a> {
    table: &'a ScatterTable,
    parts: [Part; 2],
    albedo: Rgb,
    /// -1 where the map is the mirror image of what is asked for, else 1.
    flip: f64,
}

#[derive(Clone, Copy, Debug)]
struct Part {
    node: usize,
    weight: f32,
    /// Sine and cosine of `theta_q - theta_node`; (0, 1) in paper mode.
    sin: f64,
    cos: f64,
}

impl ScatterTable {
    /// * `res`: texels along a face edge, a power of two.
    /// * `flux`: flux fractions `[node * 6 res^2 + texel]`, finite and not negative.
    ///
    /// # Panics
    /// Another `res`, or not so many fractions. Tables that were read or baked are never like that.
    pub fn new(nodes: Nodes, res: usize, flux: Vec<[f32; 3]>) -> Self {
        assert!(res.is_power_of_two() && flux.len() == nodes.len() * 6 * res * res);
        let cube = Unicube::new(res);
        let depth = res.trailing_zeros() as usize;
        let levels: Vec<usize> = (0..=depth)
            .scan(0, |at, l| Some(std::mem::replace(at, *at + (6 << (2 * l)))))
            .collect();
        let stride = levels[depth] + 6 * res * res;
        let mut pyramid = vec![0.0f32; stride * nodes.len()];
        let mut albedo = Vec::with_capacity(nodes.len());
        for (part, maps) in pyramid.chunks_mut(stride).zip(flux.chunks(cube.texels())) {
            for (cell, f) in part[levels[depth]..].iter_mut().zip(maps) {
                *cell = (f[0] + f[1] + f[2]) / 3.0;
            }
            for level in (0..depth).rev() {
                let (coarse, fine) = part[levels[level]..].split_at_mut(6 << (2 * level));
                sum_quads(coarse, fine, 1 << level);
            }
            let sum = maps.iter().fold([0.0f64; 3], |s, f| {
                std::array::from_fn(|c| s[c] + f64::from(f[c]))
            });
            albedo.push(Rgb::from_array(sum.map(|v| v as f32)));
        }
        Self {
            nodes,
            cube,
            flux,
            pyramid,
            levels,
            albedo,
        }
    }

    /// The nodes of the table.
    pub fn nodes(&self) -> &Nodes {
        &self.nodes
    }

    /// The flux as plain data, without ledger, errors and provenance, which look-ups do not need.
    pub fn maps(&self) -> ScatterMaps {
        ScatterMaps {
            nodes: self.nodes.clone(),
            res: self.res(),
            rgb: self.flux.clone(),
            error: vec![[0.0; 3]; self.flux.len()],
            absorption_per_um: [0.0; 3],
            radius_um: 1.0,
            ledger: Vec::new(),
            provenance: Provenance::default(),
        }
    }

    /// Texels along a face edge.
    pub fn res(&self) -> usize {
        self.cube.res()
    }

    /// The scattering for a query direction, strand frame (`wo.y = 0`), of a table that averages over
    /// azimuths; of others that at azimuth 0.
    pub fn lobe(&self, wo: Vec3) -> Lobe<'_> {
        self.lobe_at(wo, 0.0, 1.0)
    }

    /// The scattering for a query direction, strand frame (`wo.y = 0`).
    ///
    /// * `azimuth`: of the query, radians around the fiber from the major axis of its section.
    /// * `u`: a number in `[0, 1]` that chooses between bins of azimuth; of no effect without.
    pub fn lobe_at(&self, wo: Vec3, azimuth: f32, u: f32) -> Lobe<'_> {
        let theta = f64::from(wo.z.atan2(wo.x.hypot(wo.y)));
        let (first, second, share) = self.nodes.azimuths.bracket(f64::from(azimuth));
        let side = if f64::from(u) < share { second } else { first };
        let of_side = side.bin * self.nodes.inclinations();
        let (a, b, f) = self.nodes.bracket(theta);
        let part = |bin: usize, weight: f64| {
            let (sin, cos) = match self.nodes.mode {
                Mode::Paper => (0.0, 1.0),
                Mode::Cone => (theta - self.nodes.centers[bin]).sin_cos(),
            };
            Part {
                node: of_side + bin,
                weight: weight as f32,
                sin,
                cos,
            }
        };
        let parts = [part(a, 1.0 - f), part(b, f)];
        let albedo = parts.iter().map(|p| self.albedo[p.node] * p.weight).sum();
        Lobe {
            table: self,
            parts,
            albedo,
            flip: if side.mirrored { -1.0 } else { 1.0 },
        }
    }

    /// Density of one node at `wi`. Sampling shifts node directions back by the angle, over the pole
    /// if need be; up to two node directions arrive at one `wi`, and each adds its share.
    fn part_density(&self, part: &Part, wi: DVec3) -> Rgb {
        if part.weight == 0.0 {
            return Rgb::ZERO;
        }
        let maps = &self.flux[part.node * self.cube.texels()..];
        let at = |w: DVec3| {
            let f = maps[self.cube.texel(w)];
            Rgb::from_array(f) / self.cube.jacobian(w) as f32
        };
        if part.sin == 0.0 {
            return at(wi);
        }
        // At the pole itself the density of a shifted map is infinite; the pole has no measure.
        let c = wi.x.hypot(wi.y).max(1e-6);
        let mut sum = Rgb::ZERO;
        for side in [1.0, -1.0] {
            let shifted = side * c * part.cos - wi.z * part.sin;
            if shifted > 0.0 {
                let k = side * shifted / c;
                let z = wi.z * part.cos + side * c * part.sin;
                sum += at(DVec3::new(wi.x * k, wi.y * k, z)) * (shifted / c) as f32;
            }
        }
        sum
    }

    fn pick_texel(&self, node: usize, pick: f32, u: f32, v: f32) -> Option<(usize, f32, f32)> {
        let depth = self.levels.len() - 1;
        let stride = self.levels[depth] + self.cube.texels();
        let part = &self.pyramid[node * stride..(node + 1) * stride];
        let faces = &part[..6];
        let mut rest = pick * faces.iter().sum::<f32>();
        let mut face = None;
        for (i, &f) in faces.iter().enumerate().filter(|(_, f)| **f > 0.0) {
            face = Some(i);
            if rest < f {
                break;
            }
            rest -= f;
        }
        let face = face?;
        let (mut x, mut y, mut u, mut v) = (0, 0, u, v);
        for level in 1..=depth {
            let res = 1 << level;
            let cell = |x: usize, y: usize| part[self.levels[level] + (face * res + y) * res + x];
            (x, y) = (2 * x, 2 * y);
            let q = [
                cell(x, y),
                cell(x + 1, y),
                cell(x, y + 1),
                cell(x + 1, y + 1),
            ];
            let (low, high) = (q[0] + q[1], q[2] + q[3]);
            let (down, v2) = split(v, low / (low + high));
            let row = if down { &q[2..] } else { &q[..2] };
            let (right, u2) = split(u, row[0] / (row[0] + row[1]));
            (x, y, u, v) = (x + usize::from(right), y + usize::from(down), u2, v2);
        }
        let res = self.cube.res();
        Some(((face * res + y) * res + x, u, v))
    }
}

impl Lobe<'_> {
    /// Share of light leaving along the query direction under even illumination.
    pub fn albedo(&self) -> Rgb {
        self.albedo
    }

    /// `S(wi, wo) cos(theta_i)` per steradian.
    pub fn density(&self, wi: Vec3) -> Rgb {
        let mut wi = wi.as_dvec3();
        wi.y *= self.flip;
        self.parts
            .iter()
            .map(|p| self.table.part_density(p, wi) * p.weight)
            .sum()
    }

    /// Draws `wi` with density `mean(density) / mean(albedo)`.
    ///
    /// * `u`: the first two numbers place the direction and keep their stratification, the third
    ///   picks node and face.
    /// * `None` where nothing is scattered.
    pub fn sample(&self, u: [f32; 3]) -> Option<Vec3> {
        let total = self.albedo.element_sum();
        if total <= 0.0 {
            return None;
        }
        let first = self.parts[0].weight * self.table.albedo[self.parts[0].node].element_sum();
        let (second, pick) = split(u[2], first / total);
        let part = &self.parts[usize::from(second)];
        let (texel, a, b) = self.table.pick_texel(part.node, pick, u[0], u[1])?;
        // Clear of the texel's rim by some units of the last place of `wi`, or its density would be
        // looked up next door, where it may be zero.
        let inside = |v: f32| f64::from(v.clamp(2e-5, 1.0 - 2e-5));
        let (w, _) = self.table.cube.direction(texel, inside(a), inside(b));
        let mut wi = frame::shift_inclination(w, -part.sin, part.cos);
        wi.y *= self.flip;
        Some(wi.as_vec3().normalize())
    }
}

/// Chooses the second of two outcomes unless `u` is below the share of the first; returns `u`
/// stretched back to `[0, 1)`.
fn split(u: f32, first: f32) -> (bool, f32) {
    const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;
    if u < first {
        (false, (u / first).min(BELOW_ONE))
    } else if first < 1.0 {
        (true, ((u - first) / (1.0 - first)).min(BELOW_ONE))
    } else {
        (false, BELOW_ONE)
    }
}

fn sum_quads(coarse: &mut [f32], fine: &[f32], res: usize) {
    for (i, sum) in coarse.iter_mut().enumerate() {
        let (face, y, x) = (i / (res * res), i / res % res, i % res);
        let at = |dy: usize, dx: usize| fine[(face * 2 * res + 2 * y + dy) * 2 * res + 2 * x + dx];
        *sum = at(0, 0) + at(0, 1) + at(1, 0) + at(1, 1);
    }
}

impl From<ScatterMaps> for ScatterTable {
    fn from(maps: ScatterMaps) -> Self {
        Self::new(maps.nodes, maps.res, maps.rgb)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::symmetry::Symmetry;
    use crate::sampling::Rng;
    use crate::table::{Azimuths, Ledger};

    /// A lopsided table with empty regions and colored lobes.
    fn lumpy(mode: Mode) -> ScatterTable {
        let nodes = Nodes::new(mode, 16);
        let cube = Unicube::new(16);
        let mut rng = Rng::new(4, 2);
        let mut flux = Vec::new();
        for &center in &nodes.centers {
            for texel in 0..cube.texels() {
                let (w, _) = cube.direction(texel, 0.5, 0.5);
                let cone = (-40.0 * (frame::theta_of(w) + center).powi(2)).exp();
                let base = (0.02 + cone * (1.2 + w.x)) * rng.uniform();
                let f = if w.y > 0.95 {
                    0.0
                } else {
                    base * cube.solid_angle(texel) * 0.2
                };
                flux.push([f as f32, (f * 0.7) as f32, (f * (0.5 + 0.4 * w.y)) as f32]);
            }
        }
        ScatterTable::new(nodes, 16, flux)
    }

    fn wo(theta: f64) -> Vec3 {
        frame::direction(theta, 0.0).as_vec3()
    }

    #[test]
    fn density_integrates_to_the_albedo() {
        for mode in [Mode::Paper, Mode::Cone] {
            let table = lumpy(mode);
            for theta in [-1.54, -1.2, -0.3, 0.0, 0.41, 1.0, 1.5] {
                let fine = Unicube::new(128);
                let mut sum = Rgb::ZERO;
                for texel in 0..fine.texels() {
                    let (w, _) = fine.direction(texel, 0.5, 0.5);
                    let solid = fine.solid_angle(texel) as f32;
                    sum += table.lobe(wo(theta)).density(w.as_vec3()) * solid;
                }
                // Midpoint quadrature is poor at the pole of a shifted map, where the density is
                // singular; a factor forgotten anywhere is far larger than this.
                let error = (sum / table.lobe(wo(theta)).albedo() - 1.0)
                    .abs()
                    .max_element();
                assert!(error < 0.03, "{mode:?} {theta}: {error}");
            }
        }
    }

    /// Rounding takes no direction over the rim of its texel into an empty one. (That directions are as frequent as the
    /// density says is tested with all species.)
    #[test]
    fn directions_drawn_have_a_density() {
        let lit = lumpy(Mode::Cone).flux.into_iter().map(|f| [f[0]; 3]);
        let table = ScatterTable::new(Nodes::new(Mode::Cone, 16), 16, lit.collect());
        let mut rng = Rng::new(1, 1);
        for _ in 0..20_000 {
            let lobe = table.lobe(wo(3.1 * (rng.uniform() - 0.5)));
            let u = [rng.uniform_f32(), rng.uniform_f32(), rng.uniform_f32()];
            let wi = lobe.sample(u).unwrap();
            assert!(lobe.density(wi).min_element() > 0.0, "{wi}");
        }
    }

    #[test]
    fn empty_tables_scatter_nothing() {
        let nodes = Nodes::new(Mode::Cone, 4);
        let table = ScatterTable::new(nodes, 8, vec![[0.0; 3]; 4 * 6 * 64]);
        assert!(table.lobe(wo(0.2)).sample([0.3, 0.4, 0.5]).is_none());
        assert_eq!(table.lobe(wo(0.2)).density(Vec3::X), Rgb::ZERO);
    }

    /// Over all azimuths a table that tells them apart is its own mean.
    #[test]
    fn azimuths_average_to_the_averaged_table() {
        for symmetry in [Symmetry::None, Symmetry::MinorAxis, Symmetry::BothAxes] {
            let azimuths = Azimuths { count: 3, symmetry };
            let nodes = Nodes::new(Mode::Cone, 4).at_azimuths(azimuths);
            let mut rng = Rng::new(8, 1);
            let texels = 6 * 4 * 4;
            let rgb = (0..nodes.len() * texels)
                .map(|_| std::array::from_fn(|_| rng.uniform_f32() / texels as f32))
                .collect();
            let maps = ScatterMaps {
                res: 4,
                rgb,
                error: vec![[0.1; 3]; nodes.len() * texels],
                absorption_per_um: [0.0; 3],
                radius_um: 1.0,
                ledger: vec![Ledger::default(); nodes.len()],
                provenance: Provenance::default(),
                nodes,
            };
            let averaged = ScatterTable::from(maps.averaged().unwrap());
            let table = ScatterTable::from(maps);
            let wo = wo(0.4);
            for wi in [Vec3::new(0.3, 0.8, -0.2), Vec3::new(-0.9, -0.3, 0.1)] {
                let wi = wi.normalize();
                let (mut mean, n) = (Rgb::ZERO, 240);
                for i in 0..n {
                    let azimuth = 2.0 * std::f32::consts::PI * (i as f32 + 0.5) / n as f32;
                    for j in 0..200 {
                        let lobe = table.lobe_at(wo, azimuth, (j as f32 + 0.5) / 200.0);
                        mean += lobe.density(wi) / (n * 200) as f32;
                    }
                }
                let expected = averaged.lobe(wo).density(wi);
                let off = (mean / expected - 1.0).abs().max_element();
                assert!(off < 1e-3, "{symmetry:?}: {mean} for {expected}");
            }
        }
    }
}
