//! Simple built-in skins: each is a grid that is bent into shape.

use super::{Mirror, Skin};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// What a bent grid has at one of its vertices.
struct Vertex {
    position: Vec3,
    normal: Vec3,
    combing: Vec3,
    length: f32,
    density: f32,
}

/// A grid of `columns` x `rows` quads over `u, v` in `[0, 1]`, bent by `shape`. `d/du x d/dv` has
/// to point outward. Triangles that the bending collapses (poles) are left out.
fn bent_grid(columns: u32, rows: u32, shape: impl Fn(f32, f32) -> Vertex) -> Skin {
    let mut skin = Skin::default();
    for j in 0..=rows {
        for i in 0..=columns {
            let uv = Vec2::new(i as f32 / columns as f32, j as f32 / rows as f32);
            let vertex = shape(uv.x, uv.y);
            skin.positions.push(vertex.position);
            skin.normals.push(vertex.normal);
            skin.combing.push(tangent(vertex.combing, vertex.normal));
            skin.length.push(vertex.length);
            skin.density.push(vertex.density);
            skin.uvs.push(uv);
            skin.color.push(Vec3::ONE);
        }
    }
    let at = |i: u32, j: u32| j * (columns + 1) + i;
    for j in 0..rows {
        for i in 0..columns {
            let (a, b) = (at(i, j), at(i + 1, j));
            let (c, d) = (at(i + 1, j + 1), at(i, j + 1));
            for triangle in [[a, b, c], [a, c, d]] {
                let [p, q, r] = triangle.map(|v| skin.positions[v as usize]);
                if (q - p).cross(r - p).length_squared() > 1e-20 {
                    skin.triangles.push(triangle);
                }
            }
        }
    }
    skin
}

/// `direction` made a unit tangent of the surface with that normal; any tangent where it vanishes.
pub(super) fn tangent(direction: Vec3, normal: Vec3) -> Vec3 {
    (direction - normal * direction.dot(normal))
        .try_normalize()
        .unwrap_or_else(|| normal.any_orthonormal_vector())
}

/// A ball of 8 cm radius, combed down and a little to the back, with a whorl near the top.
pub(super) fn ball() -> Skin {
    let flow = Vec3::new(0.3, -1.0, -0.25);
    let mut skin = bent_grid(96, 48, |u, v| {
        let (sin_p, cos_p) = (u * TAU).sin_cos();
        let (sin_t, cos_t) = ((1.0 - v) * PI).sin_cos();
        let normal = Vec3::new(sin_t * sin_p, cos_t, sin_t * cos_p).normalize();
        Vertex {
            position: 0.08 * normal,
            normal,
            combing: flow,
            length: 1.0,
            density: 1.0,
        }
    });
    skin.name = "ball".to_owned();
    skin.front = Vec3::Z;
    skin.mirror = Some(Mirror::new(Vec3::ZERO, Vec3::X));
    skin.view = Vec3::new(0.0, 0.25, 1.0).normalize();
    skin
}

/// A patch of 6 x 6 cm cut from a slightly curved flank, leaning back by 50 degrees so that a
/// camera in front sees the lay of the fur from above and in profile at its edges.
pub(super) fn swatch() -> Skin {
    const EDGE: f32 = 0.06;
    const RADIUS: f32 = 0.12;
    let lean = glam::Quat::from_rotation_x(40f32.to_radians());
    let mut skin = bent_grid(48, 48, |u, v| {
        // The patch of a sphere around -RADIUS * Y; v runs toward -Z so that the outside is up.
        let (x, z) = ((u - 0.5) * EDGE, (0.5 - v) * EDGE);
        let normal = Vec3::new(x, (RADIUS * RADIUS - x * x - z * z).sqrt(), z) / RADIUS;
        Vertex {
            position: lean * (normal * RADIUS - Vec3::Y * RADIUS),
            normal: lean * normal,
            combing: lean * Vec3::new(0.35, 0.0, 1.0),
            length: 1.0,
            density: 1.0,
        }
    });
    skin.name = "swatch".to_owned();
    skin.front = Vec3::NEG_Z;
    skin.mirror = Some(Mirror::new(Vec3::ZERO, Vec3::X));
    skin.view = Vec3::new(0.0, 0.2, 1.0).normalize();
    skin
}

/// The band that holds a hair tress: a horizontal half round of 6 cm, seen from the front, from
/// which the hair falls. Bound hair is packed far more densely than on a scalp: the density factor
/// makes a bundle of the hairs of a whole patch.
pub(super) fn tress() -> Skin {
    const WIDTH: f32 = 0.06;
    const RADIUS: f32 = 0.004;
    const PACKING: f32 = 60.0;
    let mut skin = bent_grid(48, 12, |u, v| {
        // v goes round from below the front to the top.
        let (sin, cos) = ((v - 0.5) * 0.9 * PI).sin_cos();
        let normal = Vec3::new(0.0, sin, cos);
        Vertex {
            position: RADIUS * normal + Vec3::X * ((u - 0.5) * WIDTH),
            normal,
            combing: Vec3::new(0.0, -normal.z, normal.y),
            length: 1.0,
            density: PACKING,
        }
    });
    skin.name = "tress".to_owned();
    skin.front = Vec3::Z;
    skin.view = Vec3::new(0.0, 0.0, 1.0);
    skin.gravity = 1.0;
    skin
}
