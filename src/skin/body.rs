//! The sculpted animal: a fox-like mammal lying at rest, head up, tail round its side.
//!
//! X is forward, Y up, the ground is y = 0. Proportions follow a red fox of about 65 cm (Larivière
//! and Pasitschniak-Arts 1996, "Vulpes vulpes", Mammalian Species 537) without its fur.

use super::landmarks::{Landmark, along};
use super::sculpt::{Group, Part, Sculpture, Shape};
use super::{Mirror, Skin, builtin, surface_nets};
use crate::math::ease::smoothstep;
use glam::{EulerRot, Mat3, Quat, Vec2, Vec3};
use rayon::prelude::*;

/// Edge of a meshing cell, meters: the ears are about three cells thick.
const CELL: f32 = 0.0032;

/// Builds the animal.
pub(super) fn body() -> Skin {
    let sculpture = Sculpture {
        groups: vec![trunk(), head(), tail()],
        fur_blend: 0.012,
    };
    let (lo, hi) = (
        Vec3::new(-0.4611, -0.0207, -0.2013),
        Vec3::new(0.44, 0.50, 0.30),
    );
    let (net, triangles) = surface_nets::mesh(lo, hi, CELL, |p| sculpture.distance(p));
    let vertices: Vec<Vertex> = net
        .par_iter()
        .map(|&p| Vertex::new(&sculpture, p))
        .collect();
    let mut skin = Skin {
        name: "body".to_owned(),
        triangles,
        floor: Some(0.0),
        view: Vec3::new(0.62, 0.22, 0.75).normalize(),
        front: Vec3::X,
        landmarks: landmarks(),
        mirror: Some(mirror()),
        body: Some(BODY),
        ..Skin::default()
    };
    for vertex in vertices {
        vertex.push_to(&mut skin, lo, hi);
    }
    add_eyes_and_nose(&mut skin);
    skin
}

struct Vertex {
    position: Vec3,
    normal: Vec3,
    combing: Vec3,
    length: f32,
    density: f32,
    color: Vec3,
}

impl Vertex {
    fn new(sculpture: &Sculpture, near: Vec3) -> Self {
        // The net is within half a cell; a step along the gradient lands on the surface. Seams bend
        // the gradient: a wild step keeps the net's point.
        let gradient = sculpture.normal(near);
        let mut position = near - sculpture.distance(near) * gradient;
        if position.distance(near) > CELL {
            position = near;
        }
        let normal = sculpture.normal(position);
        let fur = sculpture.fur(position);
        let bare = bareness(position);
        // Under the resting body fur is pressed flat.
        let pressed = smoothstep(0.3, 0.9, -normal.y) * smoothstep(0.06, 0.03, position.y);
        Self {
            position,
            normal,
            combing: builtin::tangent(fur.lay, normal),
            length: fur.length * (1.0 - 0.7 * pressed) * (1.0 - 0.5 * bare),
            density: (SHORT / fur.length).clamp(1.0, DENSEST) * (1.0 - bare),
            color: Vec3::splat(1.0 - 0.94 * bare),
        }
    }

    fn push_to(self, skin: &mut Skin, lo: Vec3, hi: Vec3) {
        skin.positions.push(self.position);
        skin.normals.push(self.normal);
        skin.combing.push(self.combing);
        skin.length.push(self.length);
        skin.density.push(self.density);
        skin.color.push(self.color);
        let at = (self.position - lo) / (hi - lo);
        skin.uvs.push(Vec2::new(at.x, at.y));
    }
}

/// Short fur stands denser, or the skin would show between hairs of a few millimeters: below this
/// length factor as much as hairs are shorter, up to a limit that leaves strands for the trunk.
const SHORT: f32 = 0.6;
const DENSEST: f32 = 5.0;

/// 1 on and at the rims of eyes and nose, falling to 0 around them.
fn bareness(p: Vec3) -> f32 {
    let q = head_axes().transpose() * (p - HEAD);
    BARE.iter().fold(0.0, |most, (center, radii)| {
        let scaled = ((q - *center) / *radii).length();
        most.max(smoothstep(1.45, 1.1, scaled))
    })
}

/// Shorthands for the lists below; lengths in centimeters there.
fn cm(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z) * 0.01
}

fn cone(a: Vec3, ra: f32, b: Vec3, rb: f32, melt: f32, lay: Vec3, length: f32) -> Part {
    Part {
        shape: Shape::RoundCone {
            ends: [a, b],
            radii: [ra * 0.01, rb * 0.01],
        },
        melt: melt * 0.01,
        lay: lay.normalize(),
        length,
    }
}

fn egg(center: Vec3, radii: Vec3, pitch_deg: f32, melt: f32, lay: Vec3, length: f32) -> Part {
    Part {
        shape: Shape::Ellipsoid {
            center,
            radii,
            turn: Mat3::from_rotation_z(pitch_deg.to_radians()),
        },
        melt: melt * 0.01,
        lay: lay.normalize(),
        length,
    }
}

// One part a line: the tables are read and tuned as tables.
#[rustfmt::skip]
fn trunk() -> Group {
    let v = Vec3::new;
    let (back, flank, paw) = (v(-1.0, -0.12, 0.0), v(-1.0, -0.55, 0.0), v(1.0, -0.2, 0.0));
    let parts = vec![
        // Chest, belly, loin, rump.
        egg(cm(8.0, 11.8, 0.0), cm(10.5, 8.0, 6.3), -12.0, 0.0, flank, 0.95),
        egg(cm(-6.0, 11.0, 0.0), cm(13.0, 6.9, 6.3), 0.0, 6.0, flank, 1.0),
        cone(cm(4.0, 14.2, 0.0), 5.0, cm(-15.0, 12.8, 0.0), 5.4, 4.0, back, 0.9),
        egg(cm(-17.5, 11.2, 0.0), cm(8.6, 7.6, 6.9), 8.0, 5.0, back, 0.95),
        // Breast, with the bib of long fur.
        egg(cm(13.6, 12.2, 0.0), cm(5.0, 7.2, 5.2), 10.0, 4.0, v(0.35, -1.0, 0.1), 1.0),
        // Shoulder blade and upper arm.
        cone(cm(10.5, 15.0, 4.3), 4.4, cm(8.0, 5.6, 6.4), 2.9, 3.0, v(-0.55, -1.0, 0.2), 0.7),
        // Forearm, paw.
        cone(cm(8.0, 4.5, 6.4), 2.8, cm(22.0, 2.3, 5.2), 1.7, 2.2, v(1.0, -0.15, 0.0), 0.32),
        egg(cm(25.2, 1.9, 5.1), cm(3.6, 1.75, 2.15), 0.0, 1.6, paw, 0.18),
        // Thigh, shank, hind foot.
        egg(cm(-15.5, 9.0, 5.8), cm(8.6, 7.4, 4.0), 18.0, 3.0, v(-0.75, -0.8, 0.0), 0.8),
        cone(cm(-8.5, 6.4, 8.2), 3.2, cm(-15.0, 3.2, 8.8), 2.2, 2.4, v(-0.5, -1.0, 0.0), 0.5),
        cone(cm(-14.5, 2.0, 9.2), 1.9, cm(-4.0, 1.7, 9.6), 1.6, 1.6, v(1.0, -0.1, 0.0), 0.25),
        egg(cm(-2.0, 1.8, 9.7), cm(3.4, 1.6, 2.0), 0.0, 1.2, paw, 0.18),
        // Neck: nape and throat.
        cone(cm(10.5, 15.5, 0.0), 5.4, cm(19.2, 25.5, 0.0), 3.6, 4.5, v(-0.6, -1.0, 0.0), 0.85),
        cone(cm(14.0, 14.5, 0.0), 4.8, cm(21.0, 24.5, 0.0), 3.0, 3.5, v(0.05, -1.0, 0.0), 0.95),
    ];
    Group {
        parts,
        mirrored: true,
        origin: Vec3::ZERO,
        axes: Mat3::IDENTITY,
        melt: 0.0,
        ball: (Vec3::ZERO, 10.0),
    }
}

/// Where the head sits: between the ears, inside the skull.
const HEAD: Vec3 = Vec3::new(0.222, 0.288, 0.006);

/// The head looks to the right of the animal's way and a little down.
fn head_axes() -> Mat3 {
    Mat3::from_quat(Quat::from_euler(
        EulerRot::YZX,
        -36f32.to_radians(),
        -7f32.to_radians(),
        -4f32.to_radians(),
    ))
}

/// The head in its own frame: x to the nose.
#[rustfmt::skip]
fn head() -> Group {
    let v = Vec3::new;
    let (back, cheek) = (v(-1.0, 0.15, 0.0), v(-0.75, -0.35, 0.7));
    let parts = vec![
        // Cranium, brow, ridges above the eyes.
        egg(cm(-0.6, 0.8, 0.0), cm(5.2, 3.9, 4.1), 0.0, 0.0, back, 0.32),
        egg(cm(2.2, 1.1, 0.0), cm(3.3, 2.5, 2.9), -18.0, 1.6, back, 0.19),
        cone(cm(2.4, 2.0, 2.3), 0.8, cm(4.6, 1.35, 1.45), 0.6, 1.4, back, 0.12),
        // Cheeks: wide, with the long hair at the sides that makes a fox's face a triangle.
        egg(cm(-0.4, -1.4, 2.6), cm(3.4, 2.4, 2.2), 0.0, 1.8, cheek, 0.55),
        // Muzzle, nose bridge, lower jaw.
        cone(cm(3.0, -0.9, 0.0), 2.3, cm(9.2, -1.9, 0.0), 1.0, 2.0, back, 0.10),
        cone(cm(3.5, 0.1, 0.0), 1.3, cm(9.4, -1.35, 0.0), 0.72, 1.0, back, 0.09),
        cone(cm(0.5, -2.6, 0.0), 1.9, cm(7.8, -2.75, 0.0), 0.75, 1.2, v(-1.0, -0.2, 0.0), 0.14),
        // Ears.
        Part {
            shape: Shape::Ear {
                base: cm(-1.6, 2.8, 3.15),
                tip: cm(-2.3, 10.0, 5.0),
                facing: v(1.0, 0.1, 0.45),
                radius: 0.0285,
            },
            melt: 0.012,
            lay: v(-0.1, 1.0, 0.25).normalize(),
            length: 0.17,
        },
    ];
    Group {
        parts,
        mirrored: true,
        origin: HEAD,
        axes: head_axes(),
        melt: 0.03,
        ball: (HEAD, 0.13),
    }
}

/// Points of the tail's axis and radii there, centimeters.
fn tail_path() -> [(Vec3, f32); 8] {
    [
        (cm(-22.0, 11.0, 0.0), 2.2),
        (cm(-30.0, 7.0, 2.0), 1.9),
        (cm(-34.5, 4.6, 9.5), 1.9),
        (cm(-30.0, 3.9, 17.0), 2.1),
        (cm(-21.0, 3.8, 20.5), 2.2),
        (cm(-11.0, 3.6, 21.0), 1.9),
        (cm(-3.0, 3.1, 19.8), 1.2),
        (cm(2.0, 2.7, 18.2), 0.5),
    ]
}

/// The tail goes out behind and comes forward along the right side.
fn tail() -> Group {
    let path = tail_path();
    const PIECES: usize = 5;
    let mut line: Vec<(Vec3, f32)> = Vec::new();
    for k in 0..path.len() - 1 {
        let around = [k.saturating_sub(1), k, k + 1, (k + 2).min(path.len() - 1)].map(|i| path[i]);
        for piece in 0..PIECES {
            let t = piece as f32 / PIECES as f32;
            let center = catmull_rom(around.map(|p| p.0), t);
            line.push((center, around[1].1 * (1.0 - t) + around[2].1 * t));
        }
    }
    line.push(path[path.len() - 1]);
    let parts = line
        .windows(2)
        .map(|p| cone(p[0].0, p[0].1, p[1].0, p[1].1, 0.0, p[1].0 - p[0].0, 1.45))
        .collect();
    Group {
        parts,
        mirrored: false,
        origin: Vec3::ZERO,
        axes: Mat3::IDENTITY,
        melt: 0.03,
        ball: (cm(-17.0, 6.0, 10.0), 0.25),
    }
}

fn catmull_rom([a, b, c, d]: [Vec3; 4], t: f32) -> Vec3 {
    let linear = c - a;
    let square = 2.0 * a - 5.0 * b + 4.0 * c - d;
    let cube = 3.0 * (b - c) + d - a;
    b + 0.5 * t * (linear + t * (square + t * cube))
}

/// Eyes and nose in the head's frame: centers and radii.
const BARE: [(Vec3, Vec3); 3] = [
    (
        Vec3::new(0.0405, 0.0075, 0.0232),
        Vec3::new(0.0092, 0.0082, 0.0080),
    ),
    (
        Vec3::new(0.0405, 0.0075, -0.0232),
        Vec3::new(0.0092, 0.0082, 0.0080),
    ),
    (
        Vec3::new(0.1005, -0.0150, 0.0),
        Vec3::new(0.0075, 0.0072, 0.0090),
    ),
];

/// From nose to root of the tail over crown and back, meters.
const BODY: f32 = 0.62;

/// The trunk and the head have two sides each; the tail lies to the right and has no mirror image.
fn mirror() -> Mirror {
    let neck = cm(8.7, 10.0, 0.0).normalize();
    Mirror::new(Vec3::ZERO, Vec3::Z).with_head(HEAD, head_axes() * Vec3::Z, neck, [-0.06, -0.03])
}

/// Where named places are, near the skin.
fn landmarks() -> Vec<(Landmark, Vec<Vec3>)> {
    let head = |x, y, z| HEAD + head_axes() * cm(x, y, z);
    let both = |at: &dyn Fn(f32) -> Vec3| vec![at(1.0), at(-1.0)];
    let eye_line = |side: f32| {
        along(&[
            head(8.6, -1.4, 0.9 * side),
            head(4.3, 0.9, 2.3 * side),
            head(1.0, 2.0, 3.2 * side),
            head(-1.0, 3.2, 3.2 * side),
        ])
    };
    vec![
        (Landmark::Nose, vec![head(10.3, -1.0, 0.0)]),
        (
            Landmark::Chin,
            along(&[
                head(8.2, -3.6, 0.0),
                head(4.0, -4.0, 0.0),
                head(0.5, -4.6, 0.0),
            ]),
        ),
        (Landmark::Cheeks, both(&|side| head(0.2, -2.0, 4.9 * side))),
        (Landmark::Eyes, both(&|side| head(4.3, 0.75, 2.6 * side))),
        (Landmark::EyeLine, [eye_line(1.0), eye_line(-1.0)].concat()),
        (Landmark::Crown, vec![head(0.0, 4.5, 0.0)]),
        (Landmark::Ears, both(&|side| head(-2.3, 10.4, 5.0 * side))),
        (
            Landmark::Bib,
            along(&[
                cm(21.5, 22.5, 0.4),
                cm(19.3, 17.0, 0.0),
                cm(18.6, 11.5, 0.0),
                cm(17.0, 6.0, 0.0),
            ]),
        ),
        (
            Landmark::Belly,
            along(&[cm(10.0, 4.0, 0.0), cm(-6.0, 4.0, 0.0), cm(-18.0, 4.2, 0.0)]),
        ),
        (
            Landmark::Spine,
            along(&[
                head(-1.0, 4.6, 0.0),
                head(-5.5, 1.0, 0.0),
                cm(13.0, 23.0, 0.0),
                cm(6.0, 19.6, 0.0),
                cm(-4.0, 18.6, 0.0),
                cm(-15.0, 18.4, 0.0),
                cm(-22.5, 14.5, 0.0),
            ]),
        ),
        (Landmark::Shoulders, both(&|side| cm(9.5, 11.0, 8.5 * side))),
        (Landmark::Rump, both(&|side| cm(-17.0, 11.0, 9.8 * side))),
        (
            Landmark::Tail,
            along(&tail_path().map(|(center, radius)| center + 0.01 * radius * Vec3::Y)),
        ),
        (Landmark::TailTip, vec![tail_path()[7].0]),
        (
            Landmark::Paws,
            [
                both(&|side| cm(28.5, 1.9, 5.1 * side)),
                both(&|side| cm(1.2, 1.8, 9.7 * side)),
            ]
            .concat(),
        ),
    ]
}

/// Bare, dark, shiny places: balls of their own that stick out of the skin.
fn add_eyes_and_nose(skin: &mut Skin) {
    let axes = head_axes();
    for (center, radii) in BARE {
        let first = skin.positions.len() as u32;
        let mut ball = builtin::ball();
        for n in &mut ball.normals {
            let local = *n;
            skin.positions.push(HEAD + axes * (center + local * radii));
            *n = axes * (local / radii).normalize();
        }
        let count = ball.normals.len();
        skin.normals.append(&mut ball.normals);
        skin.combing.extend(std::iter::repeat_n(Vec3::X, count));
        skin.uvs.append(&mut ball.uvs);
        skin.length.extend(std::iter::repeat_n(0.0, count));
        skin.density.extend(std::iter::repeat_n(0.0, count));
        skin.color
            .extend(std::iter::repeat_n(Vec3::splat(0.03), count));
        skin.triangles
            .extend(ball.triangles.iter().map(|t| t.map(|v| v + first)));
    }
}
