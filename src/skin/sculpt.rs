//! Sculpting with signed distances: parts that melt into each other, each with its own fur.
//!
//! Negative inside, meters. Distances are exact for round cones and first-order for the rest, which
//! is enough for meshing and for walking onto the surface.

use glam::{Mat3, Vec3};

/// A solid.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shape {
    /// The hull of two balls.
    RoundCone {
        /// Centers of the balls.
        ends: [Vec3; 2],
        /// Their radii.
        radii: [f32; 2],
    },
    /// An ellipsoid; `turn` takes sculpture axes to its own axes.
    Ellipsoid {
        center: Vec3,
        radii: Vec3,
        turn: Mat3,
    },
    /// A pointed shell, open to the front: an ear.
    Ear {
        /// Middle of the base.
        base: Vec3,
        /// The tip.
        tip: Vec3,
        /// Where the opening looks; made orthogonal to the ear's axis.
        facing: Vec3,
        /// Half the width at the base.
        radius: f32,
    },
}

/// A solid with its fur.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) shape: Shape,
    /// Width of the seam to the parts before it, meters: 0 a crease, large a melt.
    pub(super) melt: f32,
    /// Direction in which its fur lies, unit.
    pub(super) lay: Vec3,
    /// Factor on hair length.
    pub(super) length: f32,
}

/// Fur at a point of the sculpture.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Fur {
    pub(super) lay: Vec3,
    pub(super) length: f32,
}

/// Parts in a frame of their own, possibly mirrored in the frame's plane z = 0.
#[derive(Clone, Debug)]
pub(super) struct Group {
    pub(super) parts: Vec<Part>,
    /// Whether the other side is a mirror image.
    pub(super) mirrored: bool,
    /// Origin of the frame in the sculpture.
    pub(super) origin: Vec3,
    /// Columns are the frame's axes in the sculpture.
    pub(super) axes: Mat3,
    /// Seam to the groups before this one, meters.
    pub(super) melt: f32,
    /// Center and radius of a ball around the group, in the sculpture: spares far points the parts.
    pub(super) ball: (Vec3, f32),
}

/// Everything.
#[derive(Clone, Debug)]
pub(super) struct Sculpture {
    pub(super) groups: Vec<Group>,
    /// Distance over which neighboring parts share their fur, meters.
    pub(super) fur_blend: f32,
}

impl Sculpture {
    /// Signed distance, negative inside.
    pub(super) fn distance(&self, p: Vec3) -> f32 {
        let mut d = 1e3;
        for group in &self.groups {
            if p.distance(group.ball.0) - group.ball.1 > d + group.melt {
                continue;
            }
            let q = group.local(p);
            let mut own = 1e3;
            for part in &group.parts {
                own = melt(own, part.shape.distance(q), part.melt);
            }
            d = melt(d, own, group.melt);
        }
        d
    }

    /// Unit gradient by differences along the corners of a tetrahedron.
    pub(super) fn normal(&self, p: Vec3) -> Vec3 {
        const H: f32 = 4e-4;
        const CORNERS: [Vec3; 4] = [
            Vec3::new(1.0, -1.0, -1.0),
            Vec3::new(-1.0, -1.0, 1.0),
            Vec3::new(-1.0, 1.0, -1.0),
            Vec3::ONE,
        ];
        let slope = CORNERS.map(|c| c * self.distance(p + H * c));
        slope.iter().sum::<Vec3>().normalize_or(Vec3::Y)
    }

    /// Fur of the parts around a point, weighted by closeness.
    pub(super) fn fur(&self, p: Vec3) -> Fur {
        // Weights fall off from the nearest part, which is found as the loop goes: when a nearer
        // one turns up, what was summed so far shrinks.
        let (mut closest, mut sum, mut fur) = (1e3, 0.0, Fur::default());
        for group in &self.groups {
            if p.distance(group.ball.0) - group.ball.1 > closest + 10.0 * self.fur_blend {
                continue;
            }
            let q = group.local(p);
            let flipped = group.mirrored && group.unfolded(p).z < 0.0;
            for part in &group.parts {
                let distance = part.shape.distance(q);
                if distance < closest {
                    let shrink = ((distance - closest) / self.fur_blend).exp();
                    (sum, fur.lay, fur.length) =
                        (sum * shrink, fur.lay * shrink, fur.length * shrink);
                    closest = distance;
                }
                let weight = ((closest - distance) / self.fur_blend).exp();
                let mut lay = part.lay;
                if flipped {
                    lay.z = -lay.z;
                }
                sum += weight;
                fur.lay += weight * (group.axes * lay);
                fur.length += weight * part.length;
            }
        }
        Fur {
            lay: fur.lay / sum,
            length: fur.length / sum,
        }
    }
}

impl Group {
    fn unfolded(&self, p: Vec3) -> Vec3 {
        self.axes.transpose() * (p - self.origin)
    }

    fn local(&self, p: Vec3) -> Vec3 {
        let q = self.unfolded(p);
        if self.mirrored {
            Vec3::new(q.x, q.y, q.z.abs())
        } else {
            q
        }
    }
}

impl Shape {
    fn distance(&self, p: Vec3) -> f32 {
        match *self {
            Self::RoundCone { ends, radii } => round_cone(p, ends, radii),
            Self::Ellipsoid {
                center,
                radii,
                turn,
            } => {
                let q = turn.transpose() * (p - center);
                let scaled = (q / radii).length();
                // First-order distance: value over gradient length of |q / radii|.
                let slope = (q / (radii * radii)).length().max(1e-9);
                if scaled < 1e-6 {
                    -radii.min_element()
                } else {
                    scaled * (scaled - 1.0) / slope
                }
            }
            Self::Ear {
                base,
                tip,
                facing,
                radius,
            } => ear(p, base, tip, facing, radius),
        }
    }
}

/// Polynomial smooth minimum of width `k` (Quilez).
fn melt(a: f32, b: f32, k: f32) -> f32 {
    if k <= 0.0 {
        return a.min(b);
    }
    let h = (1.0 - (a - b).abs() / k).max(0.0);
    a.min(b) - 0.25 * k * h * h
}

/// Exact distance to the hull of two balls: in the half plane of the axis the surface is two arcs
/// and their common tangent.
fn round_cone(p: Vec3, [a, b]: [Vec3; 2], [ra, rb]: [f32; 2]) -> f32 {
    let axis = b - a;
    let length = axis.length().max(1e-9);
    let x = (p - a).dot(axis) / length;
    let y = ((p - a).length_squared() - x * x).max(0.0).sqrt();
    // The tangent leans by the angle of this sine.
    let sin = ((ra - rb) / length).clamp(-1.0, 1.0);
    let cos = (1.0 - sin * sin).sqrt();
    let along = x * cos - y * sin;
    if along <= 0.0 {
        x.hypot(y) - ra
    } else if along >= length * cos {
        (x - length).hypot(y) - rb
    } else {
        x * sin + y * cos - ra
    }
}

/// A flattened cone with a hollow front.
fn ear(p: Vec3, base: Vec3, tip: Vec3, facing: Vec3, radius: f32) -> f32 {
    const FLAT: f32 = 0.42;
    let up = (tip - base).normalize();
    let front = (facing - up * facing.dot(up)).normalize();
    let side = up.cross(front);
    let q = p - base;
    let height = (tip - base).length();
    let local = |forward: f32| Vec3::new(q.dot(side), q.dot(up), (q.dot(front) - forward) / FLAT);
    let outer = FLAT * round_cone(local(0.0), [Vec3::ZERO, Vec3::Y * height], [radius, 0.0092]);
    let hollow = FLAT
        * round_cone(
            local(0.42 * radius),
            [Vec3::Y * (0.22 * height), Vec3::Y * (0.86 * height)],
            [0.70 * radius, 0.003],
        );
    -melt(-outer, hollow, 0.007)
}
