//! Two skins that are no built-in ones, as users bring them.

use std::f32::consts::{PI, TAU};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// An OBJ: a ring with lumps, quads with texture coordinates that end at seams, in centimeters, Z up.
pub(crate) fn torus(folder: &Path) -> PathBuf {
    const AROUND: usize = 48;
    const ACROSS: usize = 24;
    let mut text = String::from("# a ring with lumps, centimeters, Z up\no ring\n");
    for i in 0..AROUND {
        for j in 0..ACROSS {
            let (u, v) = (i as f32 / AROUND as f32, j as f32 / ACROSS as f32);
            let thick = 2.4 + 0.4 * (3.0 * TAU * u).sin();
            let (s, c) = (TAU * u).sin_cos();
            let radius = 6.5 + thick * (TAU * v).cos();
            let up = thick * (TAU * v).sin();
            let _ = writeln!(text, "v {} {} {}", radius * c, radius * s, up);
        }
    }
    for i in 0..=AROUND {
        for j in 0..=ACROSS {
            let (u, v) = (i as f32 / AROUND as f32, j as f32 / ACROSS as f32);
            let _ = writeln!(text, "vt {u} {v}");
        }
    }
    for i in 0..AROUND {
        for j in 0..ACROSS {
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            let corner = |(i, j): (usize, usize)| {
                let place = i % AROUND * ACROSS + j % ACROSS + 1;
                format!("{place}/{}", i * (ACROSS + 1) + j + 1)
            };
            let _ = writeln!(text, "f {}", corners.map(corner).join(" "));
        }
    }
    let path = folder.join("ring.obj");
    fs::write(&path, text).unwrap();
    path
}

/// A glTF with its buffer beside it: a bent limb with a knee, normals and texture coordinates, in
/// millimeters below a node that scales, turns and moves it to meters, Y up.
pub(crate) fn limb(folder: &Path) -> PathBuf {
    const RINGS: usize = 40;
    const SIDES: usize = 28;
    let (mut positions, mut normals, mut uvs) = (vec![], vec![], vec![]);
    for i in 0..=RINGS {
        // Both ends are round: the radius falls to zero along a quarter circle.
        let t = i as f32 / RINGS as f32;
        let along = 300.0 * t;
        let cap = (t / 0.12).min((1.0 - t) / 0.09).min(1.0);
        let cap = (1.0 - (1.0 - cap) * (1.0 - cap)).max(0.0).sqrt();
        let knee = 10.0 * (-((t - 0.55) / 0.08).powi(2)).exp();
        let radius = cap * (42.0 - 20.0 * t + knee);
        let bend = 60.0 * (PI * t).sin();
        for j in 0..=SIDES {
            let v = j as f32 / SIDES as f32;
            // The last column is the first one again, to the bit, with other texture coordinates.
            let (s, c) = (TAU * (j % SIDES) as f32 / SIDES as f32).sin_cos();
            positions.push([along, bend + radius * c, radius * s]);
            let axial = (1.0 - cap * cap).sqrt() * if t < 0.5 { -1.0 } else { 1.0 };
            normals.push([axial, cap * c, cap * s]);
            uvs.push([t, v]);
        }
    }
    let mut indices: Vec<u32> = Vec::new();
    let at = |i: usize, j: usize| (i * (SIDES + 1) + j) as u32;
    for i in 0..RINGS {
        for j in 0..SIDES {
            let quad = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            // Where a ring is a point one half of the quad has no area.
            if i > 0 {
                indices.extend([quad[0], quad[3], quad[1]]);
            }
            if i + 1 < RINGS {
                indices.extend([quad[1], quad[3], quad[2]]);
            }
        }
    }
    let mut buffer: Vec<u8> = Vec::new();
    let floats = [positions.concat(), normals.concat(), uvs.concat()];
    let mut views = Vec::new();
    for values in floats {
        views.push(format!(
            r#"{{"buffer":0,"byteOffset":{},"byteLength":{}}}"#,
            buffer.len(),
            4 * values.len()
        ));
        buffer.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    }
    views.push(format!(
        r#"{{"buffer":0,"byteOffset":{},"byteLength":{}}}"#,
        buffer.len(),
        4 * indices.len()
    ));
    buffer.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
    let n = positions.len();
    let bound = |pick: fn(f32, f32) -> f32, of: f32| {
        [0, 1, 2].map(|k| positions.iter().map(|p| p[k]).fold(of, pick))
    };
    let (lo, hi) = (bound(f32::min, f32::MAX), bound(f32::max, f32::MIN));
    let document = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
"nodes":[{{"name":"limb","mesh":0,"scale":[0.001,0.001,0.001],"rotation":[0,0,0.7071068,0.7071068],"translation":[0,0.02,0]}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2}},"indices":3}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":{n},"type":"VEC3","min":{lo:?},"max":{hi:?}}},
{{"bufferView":1,"componentType":5126,"count":{n},"type":"VEC3"}},
{{"bufferView":2,"componentType":5126,"count":{n},"type":"VEC2"}},
{{"bufferView":3,"componentType":5125,"count":{},"type":"SCALAR"}}],
"bufferViews":[{}],
"buffers":[{{"uri":"limb.bin","byteLength":{}}}]}}"#,
        indices.len(),
        views.join(","),
        buffer.len()
    );
    fs::write(folder.join("limb.bin"), buffer).unwrap();
    let path = folder.join("limb.gltf");
    fs::write(&path, document).unwrap();
    path
}
