//! Twist: the period that repeats is turned about the axis, image by image.

use crate::fiber::MeshPart;
use crate::mesh_file::{LoadedMesh, RawMesh};
use crate::species::{FiberMesh, MeshAxis, MeshEnds, MeshRole};
use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// The motion that takes a period to the next one: along the axis and about it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Screw {
    /// Length of a period.
    pub(super) period: f64,
    /// Radians, counterclockwise seen from the tip.
    angle: f64,
}

impl Screw {
    pub(super) fn new(period: f64, angle: f64) -> Self {
        Self { period, angle }
    }

    /// A direction turned as it is so many periods up.
    #[inline]
    pub(super) fn turn(&self, v: DVec3, periods: f64) -> DVec3 {
        if self.angle == 0.0 || periods == 0.0 {
            return v;
        }
        turned(v, periods * self.angle)
    }

    /// The image of a point so many periods up.
    #[inline]
    pub(super) fn image(&self, p: DVec3, periods: f64) -> DVec3 {
        self.turn(p, periods) + periods * self.period * DVec3::Z
    }
}

/// A vector turned about the axis, counterclockwise seen from the tip.
#[inline]
pub(crate) fn turned(v: DVec3, angle: f64) -> DVec3 {
    let (sin, cos) = angle.sin_cos();
    DVec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
}

/// Largest turn along an edge of a triangle, radians: as the pieces round a fiber, half a degree.
const STEP: f64 = TAU / 720.0;
/// Shortest of them along the axis, micrometers: below, triangles would only grow in number.
const LEAST_STEP_UM: f64 = 0.5;

/// A straight fiber turned about its axis, so many radians per micrometer.
///
/// * `parts`: triangles of one period, whose two ends match, micrometers.
pub(crate) fn twisted(parts: &[MeshPart], period_um: f64, twist: f64) -> FiberMesh {
    let step = (STEP / twist.abs()).max(LEAST_STEP_UM);
    // The ends of the period are among the planes, or their rims would not match.
    let step = period_um / (period_um / step).ceil();
    let parts: Vec<MeshPart> = (parts.iter())
        .map(|part| {
            let mut part = sliced(part, step);
            for p in &mut part.points {
                *p = turned(*p, twist * p.z);
            }
            part
        })
        .collect();
    mesh_of(&parts, period_um, "the twisted fiber")
}

/// The parts of a fiber as if read from a file of single precision.
pub(super) fn mesh_of(parts: &[MeshPart], period_um: f64, file: &str) -> FiberMesh {
    let mut raw = RawMesh::default();
    let mut roles = Vec::new();
    for part in parts {
        let index = raw.part_named(part.name);
        roles.push(match part.name {
            "cuticle" => MeshRole::Cuticle,
            "riser" => MeshRole::Riser,
            "cortex" => MeshRole::Cortex,
            "medulla" => MeshRole::Medulla,
            _ => MeshRole::Void,
        });
        let base = raw.positions.len() as u32;
        raw.positions
            .extend(part.points.iter().map(|p| p.as_vec3()));
        for t in &part.triangles {
            raw.add_polygon(&t.map(|v| v + base), index);
        }
    }
    FiberMesh {
        file: file.to_owned(),
        period_um: Some(period_um),
        ends: MeshEnds::Open,
        unit_um: 1.0,
        axis: MeshAxis::Z,
        roles,
        content: LoadedMesh::new(raw, false),
    }
}

/// A part cut at planes across the axis, `step` apart, so that turning it bends no triangle.
fn sliced(part: &MeshPart, step: f64) -> MeshPart {
    let mut cut = MeshPart {
        name: part.name,
        points: part.points.clone(),
        triangles: Vec::with_capacity(part.triangles.len()),
    };
    // Where an edge meets a plane: one point for all triangles of the edge.
    let mut known: HashMap<(u32, u32, i64), u32> = HashMap::new();
    for t in &part.triangles {
        let z = t.map(|v| part.points[v as usize].z / step);
        let (least, most) = (z[0].min(z[1]).min(z[2]), z[0].max(z[1]).max(z[2]));
        // What reaches over a plane by less than rounding ends there.
        let (first, last) = ((least + NEAR).floor() as i64, (most - NEAR).ceil() as i64);
        for slab in first..last.max(first + 1) {
            let polygon = slab_of(t, z, slab, last - first <= 1, |a, b, plane| {
                *known.entry((a.min(b), a.max(b), plane)).or_insert_with(|| {
                    // From the lower one up, so that parts agree on their common edges to the bit.
                    let [mut p, mut q] = [a, b].map(|v| part.points[v as usize]);
                    if q.z < p.z {
                        std::mem::swap(&mut p, &mut q);
                    }
                    let height = plane as f64 * step;
                    let at = p.lerp(q, (height - p.z) / (q.z - p.z)).with_z(height);
                    cut.points.push(at);
                    cut.points.len() as u32 - 1
                })
            });
            for i in 2..polygon.len() {
                let t = [polygon[0], polygon[i - 1], polygon[i]];
                if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
                    cut.triangles.push(t);
                }
            }
        }
    }
    cut
}

/// In steps: points nearer to a plane are on it.
const NEAR: f64 = 1e-6;

/// The part of a triangle between planes number `slab` and the next.
///
/// * `z`: heights of its corners in steps.
/// * `whole`: that is all of it.
/// * `cross`: the point where an edge meets a plane.
fn slab_of(
    t: &[u32; 3],
    z: [f64; 3],
    slab: i64,
    whole: bool,
    mut cross: impl FnMut(u32, u32, i64) -> u32,
) -> Vec<u32> {
    if whole {
        return t.to_vec();
    }
    let (lo, hi) = (slab as f64, (slab + 1) as f64);
    let mut polygon = Vec::with_capacity(7);
    for i in 0..3 {
        let j = (i + 1) % 3;
        if z[i] >= lo - NEAR && z[i] <= hi + NEAR {
            polygon.push(t[i]);
        }
        let mut planes = [(lo, slab), (hi, slab + 1)];
        if z[j] < z[i] {
            planes.reverse();
        }
        for (height, plane) in planes {
            let (below, above) = (z[i].min(z[j]), z[i].max(z[j]));
            if below < height - NEAR && above > height + NEAR {
                polygon.push(cross(t[i], t[j], plane));
            }
        }
    }
    polygon
}
