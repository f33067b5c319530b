//! From what a mesh file says to surfaces: points welded, ends joined one period apart.

use super::error::{MeshError, Places};
use super::{Screw, seam};
use crate::fiber::Part;
use crate::species::{FiberMesh, MeshEnds, MeshRole};
use glam::DVec3;
use std::collections::HashMap;

/// Most triangles of a fiber. A tracer of them takes about half a gigabyte.
const MAX_TRIANGLES: usize = 2_000_000;

/// A mesh may reach over its period by this factor, where its ends are slanted.
const LONGEST: f64 = 3.0;

/// Steps of coordinates from the axis to the far end of what touches a period. Coordinates and period
/// are whole steps, a power of two of the radius each: sums are exact, so that images of a point one period
/// apart are the same point wherever they are computed. Files hold single precision, which is coarser.
const STEPS: f64 = (1u64 << 30) as f64;

/// A mesh may lie beside its axis by this share of its radius before it is moved onto it.
const OFF_AXIS: f64 = 0.01;

/// What a surface bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Bound {
    /// Cuticle and risers.
    Outer,
    /// The cortex under a cuticle of its own.
    Cortex,
    /// The outline of a medulla that is a medium.
    Medulla,
    /// A void.
    Void,
}

impl Bound {
    /// All of them, the outermost first.
    pub(super) const ALL: [Self; 4] = [Self::Outer, Self::Cortex, Self::Medulla, Self::Void];

    /// For messages.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Outer => "cuticle",
            Self::Cortex => "cortex",
            Self::Medulla => "medulla",
            Self::Void => "void",
        }
    }
}

/// A triangle, counterclockwise seen from outside once it is oriented.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub(super) corners: [u32; 3],
    pub(super) bound: Bound,
    pub(super) part: Part,
}

/// All surfaces of one period, in units of the radius.
pub(super) struct Solid<'a> {
    source: &'a FiberMesh,
    pub(super) points: Vec<DVec3>,
    pub(super) faces: Vec<Face>,
    /// The point that each point is an image of, and how many periods above it.
    pub(super) images: Vec<(u32, i32)>,
    pub(super) screw: Screw,
    /// Smallest difference of coordinates, in radii.
    pub(super) step: f64,
    /// Largest distance from the axis, micrometers.
    pub(super) radius_um: f64,
    /// What was subtracted from the points, micrometers.
    shift_um: DVec3,
    pub(super) warnings: Vec<String>,
}

impl<'a> Solid<'a> {
    /// * `is_medium`: whether parts named medulla are a medium rather than voids.
    /// * `twist`: radians per micrometer by which images are turned about the axis.
    pub(super) fn new(
        source: &'a FiberMesh,
        is_medium: bool,
        twist: f64,
    ) -> Result<Self, MeshError> {
        let raw = source.content.mesh();
        let file = || source.file.clone();
        if raw.triangles.len() > MAX_TRIANGLES {
            return Err(MeshError::TooMany {
                file: file(),
                count: raw.triangles.len(),
                limit: MAX_TRIANGLES,
            });
        }
        let role = |part: u32| match source.roles.get(part as usize) {
            Some(MeshRole::Cuticle) => Some((Bound::Outer, Part::Scale)),
            Some(MeshRole::Riser) => Some((Bound::Outer, Part::Riser)),
            Some(MeshRole::Cortex) => Some((Bound::Cortex, Part::Cortex)),
            Some(MeshRole::Medulla) if is_medium => Some((Bound::Medulla, Part::Medulla)),
            Some(MeshRole::Medulla | MeshRole::Void) => Some((Bound::Void, Part::Void)),
            Some(MeshRole::Ignored) | None => None,
        };
        let used: Vec<([u32; 3], Bound, Part)> = (raw.triangles.iter().zip(&raw.part))
            .filter_map(|(t, &part)| role(part).map(|(bound, of)| (*t, bound, of)))
            .collect();
        let placed = |v: u32| source.place(raw.positions[v as usize]);
        let outer = || {
            let outer = used.iter().filter(|(_, bound, _)| *bound == Bound::Outer);
            outer.flat_map(|(t, ..)| *t).map(placed)
        };
        let Some(first) = outer().next() else {
            return Err(MeshError::Empty {
                file: file(),
                part: Bound::Outer.name(),
            });
        };
        let (lo, hi) = outer().fold((first, first), |(lo, hi), p| (lo.min(p), hi.max(p)));
        let length_um = hi.z - lo.z;
        let period_um = source.period_um.unwrap_or(length_um);
        if !(period_um > 0.0 && length_um <= LONGEST * period_um) {
            return Err(MeshError::Period {
                file: file(),
                length_um,
                period_um,
            });
        }
        let mut shift_um = 0.5 * (lo + hi);
        let size = 0.5 * (hi - lo).truncate().max_element();
        let mut warnings = Vec::new();
        if shift_um.truncate().length() < OFF_AXIS * size {
            (shift_um.x, shift_um.y) = (0.0, 0.0);
        } else {
            warnings.push(format!(
                "the mesh was moved onto the axis by ({:.4}, {:.4}) um",
                -shift_um.x, -shift_um.y
            ));
        }
        shift_um.z = period_um * (lo.z / period_um).floor();
        if twist != 0.0 {
            // What turns turns about the file's own axis, from where that has it.
            shift_um = DVec3::ZERO;
            warnings.clear();
        }
        let radius_um = outer()
            .map(|p| (p - shift_um).truncate().length())
            .fold(0.0, f64::max);
        let reach = (LONGEST + 1.0) * (1.0 + period_um / radius_um);
        let step = reach.log2().ceil().exp2() / STEPS;
        let quantized = |x: f64| (x / step).round() * step;
        let mut solid = Self {
            source,
            points: Vec::new(),
            faces: Vec::with_capacity(used.len()),
            images: Vec::new(),
            screw: Screw::new(quantized(period_um / radius_um), twist * period_um),
            step,
            radius_um,
            shift_um,
            warnings,
        };
        let mut known: HashMap<(Bound, [u64; 3]), u32> = HashMap::new();
        let mut flat = 0usize;
        for (t, bound, part) in used {
            let corners = t.map(|v| {
                let p = (placed(v) - shift_um) / radius_um;
                // Adding zero makes -0 and 0 one point.
                let p = DVec3::from_array(p.to_array().map(|x| quantized(x) + 0.0));
                *known
                    .entry((bound, p.to_array().map(f64::to_bits)))
                    .or_insert_with(|| {
                        solid.points.push(p);
                        solid.points.len() as u32 - 1
                    })
            });
            if corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0] {
                flat += 1;
                continue;
            }
            solid.faces.push(Face {
                corners,
                bound,
                part,
            });
        }
        if flat > 0 {
            solid
                .warnings
                .push(format!("{flat} faces without area were left out"));
        }
        solid.drop_doubles();
        if source.ends == MeshEnds::Capped {
            solid.take_caps_away(
                (lo.z - shift_um.z) / radius_um,
                (hi.z - shift_um.z) / radius_um,
            );
        }
        if !solid.faces.iter().any(|f| f.bound == Bound::Outer) {
            return Err(MeshError::Empty {
                file: file(),
                part: Bound::Outer.name(),
            });
        }
        solid.images = seam::match_ends(&solid);
        solid.snap();
        Ok(solid)
    }

    /// Of faces that are there more than once keeps one; of faces back to back, which have nothing
    /// between them, none: solids that touch there are one.
    fn drop_doubles(&mut self) {
        let mut known: Vec<(Bound, [u32; 3], bool, u32)> = (self.faces.iter().enumerate())
            .map(|(i, face)| {
                let [a, b, c] = face.corners;
                let mut corners = face.corners;
                corners.sort_unstable();
                let even = (a < b) ^ (b < c) ^ (a < c);
                (face.bound, corners, even, i as u32)
            })
            .collect();
        known.sort_unstable();
        let mut keep = vec![true; self.faces.len()];
        let mut repeated = 0;
        for same in known.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            if same.len() == 1 {
                continue;
            }
            let even = same.iter().filter(|f| f.2).count();
            let balanced = 2 * even == same.len();
            // The majority's winding is what is left.
            let kept = (!balanced).then_some(2 * even > same.len());
            let mut left = kept.is_some();
            for face in same {
                keep[face.3 as usize] = left && Some(face.2) == kept;
                left &= Some(face.2) != kept;
            }
            repeated += if balanced { 0 } else { same.len() - 1 };
        }
        if repeated > 0 {
            let message = format!("{repeated} repeated faces were left out");
            self.warnings.push(message);
        }
        let mut keep = keep.into_iter();
        self.faces.retain(|_| keep.next().unwrap_or(true));
    }

    /// Drops the faces in the planes of the two ends.
    fn take_caps_away(&mut self, lo: f64, hi: f64) {
        let points = &self.points;
        let tolerance = self.tolerance();
        self.faces.retain(|face| {
            let z = face.corners.map(|v| points[v as usize].z);
            ![lo, hi]
                .iter()
                .any(|end| z.iter().all(|z| (z - end).abs() <= tolerance))
        });
    }

    /// Moves images exactly to where what they are images of comes to.
    fn snap(&mut self) {
        for v in 0..self.points.len() as u32 {
            self.points[v as usize] = self.image(v, 0.0);
        }
    }

    /// A point so many periods up. Images of one point are the same to the bit, whichever they are
    /// images of.
    pub(super) fn image(&self, v: u32, periods: f64) -> DVec3 {
        let (base, up) = self.images[v as usize];
        self.screw
            .image(self.points[base as usize], periods + f64::from(up))
    }

    /// Distance within which two points are one: files hold single precision, and numbers rounded
    /// for people.
    pub(super) fn tolerance(&self) -> f64 {
        1e-4 + 1e-6 * self.screw.period
    }

    /// A point in units and axes of the file.
    pub(super) fn in_file(&self, p: DVec3) -> DVec3 {
        self.source.unplace(self.radius_um * p + self.shift_um)
    }

    /// The mesh file.
    pub(super) fn file(&self) -> String {
        self.source.file.clone()
    }

    /// Corners of a face.
    pub(super) fn corners(&self, face: &Face) -> [DVec3; 3] {
        face.corners.map(|v| self.points[v as usize])
    }

    /// Notes the middle of some points.
    pub(super) fn note(&self, places: &mut Places, points: &[DVec3]) {
        places.add(|| {
            let sum: DVec3 = points.iter().sum();
            self.in_file(sum / points.len() as f64)
        });
    }
}
