//! The skin as a mesh.

use super::frame::Frame;
use crate::export::usd::{Array, Attribute, Prim, Rows, Value};
use crate::groom::Groom;
use crate::skin::Skin;
use glam::Vec3;
use std::sync::Arc;

/// The skin's triangles; face `i` is the triangle that `skinprim` means.
///
/// * `groom`: the fur on it, `None` for a mesh whose colors are said elsewhere; `color`: the species'
///   skin, linear reflectance.
pub(super) fn mesh<'a>(
    skin: &'a Skin,
    groom: Option<&'a Groom>,
    frame: Frame,
    color: Vec3,
) -> Prim<'a> {
    let Vertices { source, corners } = vertices(skin);
    let source: Arc<[u32]> = source.into();
    let each = |of: fn(&Skin, usize) -> Vec3, turn: fn(Frame, Vec3) -> Vec3| {
        let source = Arc::clone(&source);
        Array::Vec3(Rows::each(source.len(), move |i| {
            turn(frame, of(skin, source[i] as usize)).to_array()
        }))
    };
    let (lo, hi) = extent(skin, frame);
    let mut mesh = Prim::new("Mesh", "skin");
    let extent = Rows::of(vec![lo.to_array(), hi.to_array()]);
    mesh.set("float3[]", "extent", Array::Vec3(extent).into());
    let threes = Rows::each(corners.len(), |_| 3);
    mesh.set("int[]", "faceVertexCounts", Array::Int(threes).into());
    let corners = Rows::new(corners.len(), 3 * corners.len(), move |rows, out| {
        out.extend(corners[rows].iter().flatten().map(|&v| v as i32));
    });
    mesh.set("int[]", "faceVertexIndices", Array::Int(corners).into());
    let points = each(|skin, v| skin.positions[v], Frame::point);
    mesh.set("point3f[]", "points", points.into());
    mesh.add(Attribute {
        name: "normals".to_owned(),
        type_name: "normal3f[]",
        interpolation: "vertex",
        value: Some(each(|skin, v| skin.normals[v], Frame::direction).into()),
        ..Attribute::default()
    });
    if let Some(groom) = groom {
        put_colors(&mut mesh, skin, groom, color, Arc::clone(&source));
    }
    let places = Arc::clone(&source);
    let uvs = Rows::each(source.len(), move |i| {
        skin.uvs[places[i] as usize].to_array()
    });
    mesh.primvar("texCoord2f[]", "st", "vertex", Array::Vec2(uvs).into());
    mesh.set_uniform("token", "subdivisionScheme", Value::token("none"));
    mesh
}

/// Gives a mesh that is there the colors of a groom's skin.
pub(super) fn paint<'a>(mesh: &mut Prim<'a>, skin: &'a Skin, groom: &'a Groom, color: Vec3) {
    put_colors(mesh, skin, groom, color, vertices(skin).source.into());
}

fn put_colors<'a>(
    mesh: &mut Prim<'a>,
    skin: &'a Skin,
    groom: &'a Groom,
    color: Vec3,
    source: Arc<[u32]>,
) {
    let colors = Rows::each(source.len(), move |i| {
        (groom.skin_color(skin, source[i] as usize) * color).to_array()
    });
    let colors = Array::Vec3(colors);
    mesh.primvar("color3f[]", "displayColor", "vertex", colors.into());
}

/// Corners of the box around all triangles.
pub(super) fn extent(skin: &Skin, frame: Frame) -> (Vec3, Vec3) {
    let corners = skin.triangles.iter().flatten();
    let points = corners.map(|&v| frame.point(skin.positions[v as usize]));
    points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| {
        (lo.min(p), hi.max(p))
    })
}

/// The vertices that a file has.
struct Vertices {
    /// The skin's vertex that each is.
    source: Vec<u32>,
    /// Of every triangle.
    corners: Vec<[u32; 3]>,
}

/// A vertex for every fan of triangles around one of the skin's: where two fans touch in a point each has
/// its own, and what no triangle has is left out. Readers refuse either.
fn vertices(skin: &Skin) -> Vertices {
    let triangles = &skin.triangles;
    // Corners at the same end of a shared edge are of the same fan.
    let mut fans = Fans((0..3 * triangles.len() as u32).collect());
    let mut edges: Vec<([u32; 2], [u32; 2])> = Vec::with_capacity(3 * triangles.len());
    for (index, triangle) in (0u32..).zip(triangles) {
        for (k, next) in [(0, 1), (1, 2), (2, 0)] {
            let (a, b) = (triangle[k], triangle[next]);
            let places = [3 * index + k as u32, 3 * index + next as u32];
            if a <= b {
                edges.push(([a, b], places));
            } else {
                edges.push(([b, a], [places[1], places[0]]));
            }
        }
    }
    edges.sort_unstable();
    for pair in edges.windows(2) {
        if pair[0].0 == pair[1].0 {
            for end in 0..2 {
                fans.join(pair[0].1[end], pair[1].1[end]);
            }
        }
    }
    let mut made = vec![u32::MAX; 3 * triangles.len()];
    let mut source = Vec::new();
    let mut corners = Vec::with_capacity(triangles.len());
    for (index, triangle) in triangles.iter().enumerate() {
        corners.push(std::array::from_fn(|k| {
            let fan = fans.root((3 * index + k) as u32) as usize;
            if made[fan] == u32::MAX {
                made[fan] = source.len() as u32;
                source.push(triangle[k]);
            }
            made[fan]
        }));
    }
    Vertices { source, corners }
}

/// Sets that grow together; each is known by its least member.
struct Fans(Vec<u32>);

impl Fans {
    fn root(&mut self, mut member: u32) -> u32 {
        while self.0[member as usize] != member {
            let next = self.0[self.0[member as usize] as usize];
            self.0[member as usize] = next;
            member = next;
        }
        member
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        let (least, other) = (a.min(b), a.max(b));
        self.0[other as usize] = least;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles that share an edge, one that touches them in a point only, and a lone vertex.
    #[test]
    fn fans_that_touch_in_a_point_get_vertices_of_their_own() {
        let skin = Skin {
            positions: vec![Vec3::ZERO; 7],
            triangles: vec![[0, 1, 2], [2, 1, 3], [3, 5, 6]],
            ..Skin::default()
        };
        let vertices = vertices(&skin);
        assert_eq!(vertices.corners, [[0, 1, 2], [2, 1, 3], [4, 5, 6]]);
        assert_eq!(vertices.source, [0, 1, 2, 3, 3, 5, 6]);
    }
}
