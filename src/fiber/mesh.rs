//! Triangles of one period, for other programs to look at and to model on.

mod glb;
mod hull;
mod shell;

use super::bodies::Bodies;
use super::medulla::Voids;
use super::surface::Surface;
use super::{Fiber, Region};
use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

/// A named part of a fiber as triangles, counterclockwise seen from outside. Micrometers.
#[derive(Clone, Debug)]
pub struct MeshPart {
    /// `cuticle`, `riser`, `medulla` (the outline of a medium) or `void`. Cuticle and risers are
    /// closed together.
    pub name: &'static str,
    /// Positions.
    pub points: Vec<DVec3>,
    /// Indices into `points`.
    pub triangles: Vec<[u32; 3]>,
}

/// Flat pieces round the fiber: half a degree each, far below the spread by roughness. Twice as many
/// double file and memory and change nothing that a bake shows.
const ROUND: usize = 720;
/// Triangles for all voids together, and most and fewest steps round one of them: many small voids
/// scatter by their number, a few large ones by their shape.
const VOID_TRIANGLES: usize = 400_000;
const VOID_ROUND: (usize, usize) = (24, 128);

impl Fiber {
    /// One period as triangles: the outer surface, whose two ends are open and alike, and closed
    /// voids, or the outline of a homogeneous medulla.
    pub fn mesh(&self) -> Vec<MeshPart> {
        if let Some(triangles) = &self.triangles {
            return triangles.parts.clone();
        }
        let mut parts = match &self.surface {
            Surface::Smooth => vec![cylinder("cuticle", |_| 1.0, self.period_um)],
            Surface::Scales(scales) => {
                // Scales may repeat several times in the period of the medulla.
                let count = (self.period_um / scales.period).round() as u32;
                let parts = shell::tessellate(scales, ROUND);
                let parts = parts.map(|part| part.repeated(scales.period, count));
                parts.into()
            }
        };
        if self.medulla.ratio > 0.0 {
            parts.push(self.medulla_part());
        }
        if let Some(fusi) = &self.fusi {
            if parts.last().is_none_or(|part| part.name != "void") {
                parts.push(Weld::new("void"));
            }
            if let Some(voids) = parts.last_mut() {
                self.bodies_part(voids, fusi, VOID_ROUND.0);
            }
        }
        let (a, b) = (self.section.a, self.section.b);
        parts
            .into_iter()
            .filter(|weld| !weld.triangles.is_empty())
            .map(|weld| MeshPart {
                points: weld
                    .points
                    .iter()
                    .map(|p| DVec3::new(a * p.x, b * p.y, p.z))
                    .collect(),
                name: weld.name,
                triangles: weld.triangles,
            })
            .collect()
    }

    /// [`Fiber::mesh`] as a binary glTF file: nodes, meshes and materials named like the parts, a
    /// unit a micrometer, +Y to the tip. A species whose `structure.mesh` names it is this fiber.
    ///
    /// * `name`: of the scene.
    pub fn to_glb(&self, name: &str) -> Vec<u8> {
        glb::encode(name, self.period_um, &self.mesh())
    }

    fn medulla_part(&self) -> Weld {
        let (a, b) = (self.section.a, self.section.b);
        let mut weld = Weld::new("void");
        // From pole to pole there are half as many steps, and two triangles to each.
        let round = ((VOID_TRIANGLES / self.void_count().max(1)) as f64).sqrt() as usize;
        let round = round.clamp(VOID_ROUND.0, VOID_ROUND.1) / 8 * 8;
        match &self.medulla.voids {
            Voids::None => {
                let ratio = self.medulla.ratio;
                let radius = |phi: f64| match &self.medulla.rim {
                    // At the polar angle: the section's outline in the small.
                    Some(_) => ratio * self.section.rho(phi),
                    None => ratio,
                };
                weld = cylinder("medulla", radius, self.period_um);
            }
            // Half as many steps: their edges are found wherever they are.
            Voids::Bodies(bodies) => {
                if self.medulla.fill() == Region::Medulla {
                    weld = Weld::new("medulla");
                }
                self.bodies_part(&mut weld, bodies, round / 2);
            }
            Voids::Ladder(ladder) => {
                for p in ladder.present() {
                    let half = |c: f64| c.abs().sqrt().copysign(c);
                    closed(&mut weld, round, |theta, phi| {
                        // The exponent 4 of the superellipsoid: square roots of sine and cosine.
                        let (r, z) = (p.radius * half(theta.sin()), p.half * half(theta.cos()));
                        DVec3::new(r * phi.cos(), r * phi.sin(), p.center + z)
                    });
                }
            }
            Voids::Froth(froth) => {
                for s in &froth.spheres {
                    closed(&mut weld, round, |theta, phi| {
                        let n = DVec3::new(
                            theta.sin() * phi.cos(),
                            theta.sin() * phi.sin(),
                            theta.cos(),
                        );
                        let p = s.center + s.radius * n;
                        DVec3::new(p.x / a, p.y / b, p.z)
                    });
                }
            }
        }
        weld
    }

    /// Convex bodies.
    fn bodies_part(&self, weld: &mut Weld, bodies: &Bodies, round: usize) {
        let (a, b) = (self.section.a, self.section.b);
        for shape in (0..bodies.len() as u32).filter_map(|index| bodies.shape(index)) {
            hull::add(weld, &shape, round, |p| DVec3::new(p.x / a, p.y / b, p.z));
        }
    }

    /// Wedges that the scaled surface is made of; 0 for a bare cylinder.
    pub fn sector_count(&self) -> usize {
        match &self.surface {
            Surface::Smooth => 0,
            Surface::Scales(scales) => scales.sectors.len(),
        }
    }

    /// Pieces of scales in all wedges.
    pub fn strip_count(&self) -> usize {
        match &self.surface {
            Surface::Smooth => 0,
            Surface::Scales(scales) => (0..scales.sectors.len()).map(|s| scales.count(s)).sum(),
        }
    }

    /// Voids in a period.
    pub fn void_count(&self) -> usize {
        if let Some(triangles) = self.modeled() {
            return triangles.void_count;
        }
        match &self.medulla.voids {
            Voids::None => 0,
            Voids::Ladder(ladder) => ladder.present().count(),
            Voids::Bodies(bodies) => bodies.len(),
            Voids::Froth(froth) => froth.spheres.len(),
        }
    }
}

/// * `radius`: at an angle, in the unit-circle frame.
fn cylinder(name: &'static str, radius: impl Fn(f64) -> f64, period: f64) -> Weld {
    let mut weld = Weld::new(name);
    for i in 0..ROUND {
        let [p, q] = [i, i + 1].map(|k| {
            let phi = TAU * (k % ROUND) as f64 / ROUND as f64;
            radius(phi) * DVec3::new(phi.cos(), phi.sin(), 0.0)
        });
        let up = DVec3::Z * period;
        weld.polygon(&[p, q, q + up, p + up]);
    }
    weld
}

/// A closed surface over polar and azimuthal angle.
fn closed(weld: &mut Weld, round: usize, at: impl Fn(f64, f64) -> DVec3) {
    let poles = round / 2;
    let point = |i: usize, j: usize| {
        // The poles are one point, not a rounding apart.
        let phi = if i == 0 || i == poles {
            0.0
        } else {
            TAU * (j % round) as f64 / round as f64
        };
        let theta = PI * i as f64 / poles as f64;
        at(if i == poles { PI } else { theta }, phi)
    };
    for i in 0..poles {
        for j in 0..round {
            weld.polygon(&[
                point(i + 1, j),
                point(i + 1, j + 1),
                point(i, j + 1),
                point(i, j),
            ]);
        }
    }
}

/// Points in one cell are one point; what is left of its size is for rounding.
const CELLS_PER_UNIT: f64 = 1e7;
const ROUNDING: f64 = 1e-3;

/// Triangles whose equal corners are one point.
pub(super) struct Weld {
    name: &'static str,
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    known: HashMap<[i64; 3], u32>,
}

impl Weld {
    pub(super) fn new(name: &'static str) -> Self {
        Self {
            name,
            points: Vec::new(),
            triangles: Vec::new(),
            known: HashMap::new(),
        }
    }

    /// The same several times, a period apart along z, joined where they meet.
    fn repeated(self, period: f64, count: u32) -> Self {
        if count <= 1 {
            return self;
        }
        let mut all = Self::new(self.name);
        for k in 0..count {
            let up = f64::from(k) * period * DVec3::Z;
            for t in &self.triangles {
                all.polygon(&t.map(|v| self.points[v as usize] + up));
            }
        }
        all
    }

    /// The index of a point: that of a known one no farther than rounding.
    fn point(&mut self, p: DVec3) -> u32 {
        let cell = p * CELLS_PER_UNIT;
        let [lo, hi] = [-ROUNDING, ROUNDING].map(|r| (cell + r).floor().as_i64vec3());
        // Near a cell's wall the known point may be in the next one.
        for z in lo.z..=hi.z {
            for y in lo.y..=hi.y {
                for x in lo.x..=hi.x {
                    if let Some(&known) = self.known.get(&[x, y, z]) {
                        return known;
                    }
                }
            }
        }
        let index = self.points.len() as u32;
        self.points.push(p);
        let key = cell.floor().as_i64vec3().to_array();
        self.known.insert(key, index);
        index
    }

    /// A fan of triangles; corners that coincide leave fewer.
    pub(super) fn polygon(&mut self, corners: &[DVec3]) {
        let corners: Vec<u32> = corners.iter().map(|&p| self.point(p)).collect();
        for i in 2..corners.len() {
            let t = [corners[0], corners[i - 1], corners[i]];
            if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
                self.triangles.push(t);
            }
        }
    }
}
