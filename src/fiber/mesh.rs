//! Triangles of one period, for other programs to look at.

use super::Fiber;
use super::medulla::Voids;
use super::scales::{Cell, Scales};
use super::surface::Surface;
use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

/// A named part of a fiber as triangles, counterclockwise seen from outside. Micrometers.
#[derive(Clone, Debug)]
pub struct MeshPart {
    /// `cuticle` or `medulla`.
    pub name: &'static str,
    /// Positions.
    pub points: Vec<DVec3>,
    /// Indices into `points`.
    pub triangles: Vec<[u32; 3]>,
}

/// Steps round and from pole to pole of a void.
const ROUND: u32 = 24;
const POLES: u32 = 12;
/// Steps round a bare cylinder.
const CYLINDER: u32 = 96;

impl Fiber {
    /// One period as triangles: the outer surface, open at both ends, and the voids, closed.
    pub fn mesh(&self) -> Vec<MeshPart> {
        let mut cuticle = Weld::new("cuticle");
        match &self.surface {
            Surface::Smooth => cylinder(&mut cuticle, 1.0, self.period_um),
            Surface::Scales(scales) => {
                for sector in 0..scales.sectors.len() {
                    self.sector(scales, sector, &mut cuticle);
                }
            }
        }
        let mut parts = vec![cuticle];
        if self.medulla.ratio > 0.0 {
            parts.push(self.medulla_part());
        }
        let (a, b) = (self.section.a, self.section.b);
        parts
            .into_iter()
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

    /// Faces of a sector and the risers between them.
    fn sector(&self, scales: &Scales, sector: usize, weld: &mut Weld) {
        let planes = scales.sectors[sector].planes;
        let corner = |strip: usize, side: usize, upper: bool| {
            let s = scales.strip(Cell {
                sector,
                strip,
                shift: 0.0,
            });
            let z = if upper { s.end[side] } else { s.begin[side] };
            let rho = 1.0 + s.height[side] + s.slope[side] * z;
            DVec3::new(rho * planes[side].cos, rho * planes[side].sin, z)
        };
        let count = scales.count(sector);
        for strip in 0..count {
            let at = |side, upper| corner(strip, side, upper);
            weld.quad([at(0, false), at(1, false), at(1, true), at(0, true)]);
            let (next, up) = if strip + 1 == count {
                (0, DVec3::Z * scales.period)
            } else {
                (strip + 1, DVec3::ZERO)
            };
            let above = |side| corner(next, side, false) + up;
            weld.quad([at(0, true), at(1, true), above(1), above(0)]);
        }
    }

    fn medulla_part(&self) -> Weld {
        let mut weld = Weld::new("medulla");
        let (a, b) = (self.section.a, self.section.b);
        match &self.medulla.voids {
            Voids::None => cylinder(&mut weld, self.medulla.ratio, self.period_um),
            Voids::Bodies(bodies) => {
                // Convex: from the center out to the boundary in every direction.
                for body in 0..bodies.len() as u32 {
                    closed(&mut weld, |theta, phi| {
                        let (sin, cos) = theta.sin_cos();
                        let dir = DVec3::new(sin * phi.cos(), sin * phi.sin(), cos);
                        let p = bodies.boundary(body, dir);
                        DVec3::new(p.x / a, p.y / b, p.z)
                    });
                }
            }
            Voids::Ladder(ladder) => {
                for p in ladder.present() {
                    let half = |c: f64| c.abs().sqrt().copysign(c);
                    closed(&mut weld, |theta, phi| {
                        // The exponent 4 of the superellipsoid: square roots of sine and cosine.
                        let (r, z) = (p.radius * half(theta.sin()), p.half * half(theta.cos()));
                        DVec3::new(r * phi.cos(), r * phi.sin(), p.center + z)
                    });
                }
            }
            Voids::Froth(froth) => {
                for s in &froth.spheres {
                    closed(&mut weld, |theta, phi| {
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
        match &self.medulla.voids {
            Voids::None => 0,
            Voids::Ladder(ladder) => ladder.present().count(),
            Voids::Bodies(bodies) => bodies.len(),
            Voids::Froth(froth) => froth.spheres.len(),
        }
    }
}

fn cylinder(weld: &mut Weld, radius: f64, period: f64) {
    for i in 0..CYLINDER {
        let [p, q] = [i, i + 1].map(|k| {
            let phi = TAU * f64::from(k % CYLINDER) / f64::from(CYLINDER);
            radius * DVec3::new(phi.cos(), phi.sin(), 0.0)
        });
        let up = DVec3::Z * period;
        weld.quad([p, q, q + up, p + up]);
    }
}

/// A closed surface over polar and azimuthal angle.
fn closed(weld: &mut Weld, at: impl Fn(f64, f64) -> DVec3) {
    let point = |i: u32, j: u32| {
        // The poles are one point, not a rounding apart.
        let phi = if i == 0 || i == POLES {
            0.0
        } else {
            TAU * f64::from(j % ROUND) / f64::from(ROUND)
        };
        let theta = PI * f64::from(i) / f64::from(POLES);
        at(if i == POLES { PI } else { theta }, phi)
    };
    for i in 0..POLES {
        for j in 0..ROUND {
            weld.quad([
                point(i + 1, j),
                point(i + 1, j + 1),
                point(i, j + 1),
                point(i, j),
            ]);
        }
    }
}

/// Triangles whose equal corners are one point.
struct Weld {
    name: &'static str,
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    known: HashMap<[i64; 3], u32>,
}

impl Weld {
    fn new(name: &'static str) -> Self {
        Self {
            name,
            points: Vec::new(),
            triangles: Vec::new(),
            known: HashMap::new(),
        }
    }

    fn point(&mut self, p: DVec3) -> u32 {
        let key = (p * 1e7).round().as_i64vec3().to_array();
        *self.known.entry(key).or_insert_with(|| {
            self.points.push(p);
            self.points.len() as u32 - 1
        })
    }

    /// Two triangles; corners that coincide leave one or none.
    fn quad(&mut self, corners: [DVec3; 4]) {
        let [a, b, c, d] = corners.map(|p| self.point(p));
        for t in [[a, b, c], [a, c, d]] {
            if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
                self.triangles.push(t);
            }
        }
    }
}
