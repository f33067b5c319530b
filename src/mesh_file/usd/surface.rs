//! Meshes that are cages of subdivision surfaces, as they are where the file says nothing else.

use super::polygons::{Polygons, ints};
use super::primvar::floats;
use crate::mesh_file::catmull_clark::{Cage, Rule, key};
use crate::usd_file::Prim;
use glam::{DVec3, Vec2};
use std::collections::HashMap;

/// Cages are split until more faces than these would come of it, but for a first time: coarser, and hair
/// stands visibly off the smooth surface; finer, and nothing is seen of it.
const FACES: usize = 200_000;
const MOST_LEVELS: usize = 4;

/// A cage of which a first time makes more is as good as its surface.
const MOST_FACES: usize = 2_000_000;

/// The surface that a mesh stands for, and what is to be said about it.
pub(super) fn of(prim: &Prim, cage: Polygons) -> (Polygons, Option<String>) {
    match prim.text("subdivisionScheme").unwrap_or("catmullClark") {
        "catmullClark" => {}
        "loop" => {
            return (
                cage,
                Some("is taken without its subdivision, which is by Loop's scheme".to_owned()),
            );
        }
        _ => return (cage, None),
    }
    // Each corner of a face becomes a face.
    let corners = cage.corners.len();
    if corners > MOST_FACES {
        let faces = cage.counts.len();
        let remark = format!("has {faces} faces and is taken without its subdivision");
        return (cage, Some(remark));
    }
    let mut levels = 1;
    while levels < MOST_LEVELS && corners << (2 * levels) <= FACES {
        levels += 1;
    }
    (split(prim, &cage, levels), None)
}

fn split(prim: &Prim, polygons: &Polygons, levels: usize) -> Polygons {
    let mut cage = Cage {
        counts: polygons.counts.clone(),
        corners: polygons.corners.clone(),
        creases: creases(prim),
        peaks: peaks(prim),
        keeps_corners: !matches!(prim.text("interpolateBoundary"), Some("edgeOnly" | "none")),
    };
    let mut points = polygons.points.clone();
    let seams = prim
        .text("faceVaryingLinearInterpolation")
        .unwrap_or("cornersPlus1");
    let rule = match seams {
        "all" => Rule::Linear,
        _ => Rule::Smooth,
    };
    let mut picture = polygons.uvs.as_deref().map(|uvs| flat(&cage, uvs, seams));
    let mut is_hole = polygons.is_hole.clone();
    for &hole in ints(prim, "holeIndices") {
        if let Some(is_hole) = usize::try_from(hole).ok().and_then(|i| is_hole.get_mut(i)) {
            *is_hole = true;
        }
    }
    for _ in 0..levels {
        is_hole = (is_hole.iter().zip(&cage.counts))
            .flat_map(|(&is_hole, &count)| std::iter::repeat_n(is_hole, count as usize))
            .collect();
        (cage, points) = cage.split(&points, Rule::Smooth);
        picture = picture.map(|(flat, uvs)| flat.split(&uvs, rule));
    }
    Polygons {
        points: cage.limit(&points),
        uvs: picture.map(|(flat, uvs)| {
            let uvs = match rule {
                Rule::Smooth => flat.limit(&uvs),
                Rule::Linear => uvs,
            };
            (flat.corners.iter())
                .map(|&i| uvs[i as usize].truncate().as_vec2())
                .collect()
        }),
        normals: None,
        is_hole,
        counts: cage.counts,
        corners: cage.corners,
    }
}

/// The cage in the plane of a picture: corners at one point with the same coordinates are one there, so that
/// seams are borders. What of them stays where it is, `seams` says with a word of USD's.
fn flat(cage: &Cage, uvs: &[Vec2], seams: &str) -> (Cage, Vec<DVec3>) {
    let mut numbers: HashMap<(u32, [u32; 2]), u32> = HashMap::new();
    let mut values = Vec::new();
    // Of each point those that it has become.
    let mut copies: HashMap<u32, Vec<u32>> = HashMap::new();
    let corners = (cage.corners.iter().zip(uvs))
        .map(|(&point, uv)| {
            *(numbers.entry((point, uv.to_array().map(f32::to_bits)))).or_insert_with(|| {
                values.push(uv.as_dvec2().extend(0.0));
                let number = values.len() as u32 - 1;
                copies.entry(point).or_default().push(number);
                number
            })
        })
        .collect();
    let of = |point: &u32| copies.get(point).map_or(&[][..], Vec::as_slice);
    let mut flat = Cage {
        counts: cage.counts.clone(),
        corners,
        keeps_corners: seams != "none",
        ..Cage::default()
    };
    for ([a, b], &sharp) in &cage.creases {
        for &a in of(a) {
            flat.creases
                .extend(of(b).iter().map(|&b| (key(a, b), sharp)));
        }
    }
    for (point, &sharp) in &cage.peaks {
        flat.peaks
            .extend(of(point).iter().map(|&copy| (copy, sharp)));
    }
    match seams {
        "boundaries" => flat
            .peaks
            .extend(flat.border().into_iter().map(|v| (v, f64::INFINITY))),
        // Where three and more pieces of the picture meet.
        "cornersPlus1" | "cornersPlus2" => {
            let meeting = copies.values().filter(|copies| copies.len() > 2);
            flat.peaks
                .extend(meeting.flatten().map(|&v| (v, f64::INFINITY)));
        }
        _ => {}
    }
    (flat, values)
}

/// Chains of edges, with a sharpness a chain or an edge.
fn creases(prim: &Prim) -> HashMap<[u32; 2], f64> {
    let indices = ints(prim, "creaseIndices");
    let lengths = ints(prim, "creaseLengths");
    let sharpness = floats(prim.value("creaseSharpnesses"), 1);
    let is_by_chain = sharpness.len() == lengths.len();
    let mut creases = HashMap::new();
    let (mut begin, mut edge) = (0usize, 0);
    for (chain, &length) in lengths.iter().enumerate() {
        let points = usize::try_from(length)
            .ok()
            .and_then(|n| indices.get(begin..begin.checked_add(n)?));
        let Some(points) = points else { break };
        begin += points.len();
        for pair in points.windows(2) {
            let sharp = sharpness.get(if is_by_chain { chain } else { edge });
            edge += 1;
            if let Some(sharp) = sharp.copied().and_then(sharp_for) {
                creases.insert(key(pair[0] as u32, pair[1] as u32), sharp);
            }
        }
    }
    creases
}

fn peaks(prim: &Prim) -> HashMap<u32, f64> {
    let sharpness = floats(prim.value("cornerSharpnesses"), 1);
    (ints(prim, "cornerIndices").iter().zip(sharpness))
        .filter_map(|(&point, &sharp)| Some((u32::try_from(point).ok()?, sharp_for(sharp)?)))
        .collect()
}

/// Levels that a sharpness lasts; ten and more are for ever.
fn sharp_for(sharpness: f32) -> Option<f64> {
    match f64::from(sharpness) {
        sharp if sharp >= 10.0 => Some(f64::INFINITY),
        sharp => (sharp > 0.0).then_some(sharp),
    }
}

#[cfg(test)]
mod tests {
    use crate::mesh_file::RawMesh;
    use crate::mesh_file::usd::read;
    use glam::{Vec2, Vec3};

    /// A cube of two meters whose faces lie side by side in the picture, which has seams along all edges.
    const CUBE: &str = r#"#usda 1.0
(
    metersPerUnit = 1
)
def Mesh "cube"
{
    int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]
    int[] faceVertexIndices = [0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5]
    point3f[] points = [(-1, -1, -1), (1, -1, -1), (-1, 1, -1), (1, 1, -1), (-1, -1, 1), (1, -1, 1), (-1, 1, 1), (1, 1, 1)]
    texCoord2f[] primvars:st = [PICTURE] (
        interpolation = "faceVarying"
    )
}
"#;

    fn cube(line: &str) -> RawMesh {
        let side = |i| format!("({0}, 0), ({1}, 0), ({1}, 1), ({0}, 1)", 2 * i, 2 * i + 1);
        let picture = (0..6).map(side).collect::<Vec<_>>().join(", ");
        let text = CUBE.replace("PICTURE", &picture).replace(
            "    int[] faceVertexCounts",
            &format!("    {line}\n    int[] faceVertexCounts"),
        );
        read("a.usda", text.as_bytes()).unwrap()
    }

    fn farthest(mesh: &RawMesh) -> f32 {
        mesh.positions
            .iter()
            .map(|p| p.length())
            .fold(0.0, f32::max)
    }

    /// As renderers show it, and not as its cage.
    #[test]
    fn cages_become_their_surfaces() {
        let mesh = cube("");
        assert_eq!(mesh.faces, 6 << 8);
        // A corner of the cube ends halfway.
        assert!(
            (farthest(&mesh) - 0.75f32.sqrt()).abs() < 1e-6,
            "{}",
            farthest(&mesh)
        );
        let outward = mesh.triangles.iter().all(|t| {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
            (b - a).cross(c - a).dot(a + b + c) > 0.0
        });
        assert!(outward);
        assert!(mesh.normals.is_empty());
        // Corners of the sides stay in the picture, and nothing leaves them.
        let corners = |uv: &&Vec2| uv.fract() == Vec2::ZERO;
        assert_eq!(mesh.uvs.iter().filter(corners).count(), 6 * 4);
        let is_inside = |uv: &Vec2| uv.x % 2.0 <= 1.0 && (0.0..=1.0).contains(&uv.y);
        assert!(mesh.uvs.iter().all(is_inside) && mesh.remarks.is_empty());

        assert_eq!(
            cube("uniform token subdivisionScheme = \"bilinear\"").faces,
            6
        );
        let other = cube("uniform token subdivisionScheme = \"loop\"");
        assert_eq!(other.faces, 6);
        assert!(
            other.remarks[0].starts_with("/cube is taken without"),
            "{:?}",
            other.remarks
        );
    }

    /// However many corners a single face has.
    #[test]
    fn cages_are_split_as_far_as_it_serves() {
        let faces = |corners: usize| {
            let list = |item: &dyn Fn(usize) -> String| {
                (0..corners).map(item).collect::<Vec<_>>().join(", ")
            };
            let text = format!(
                "#usda 1.0\ndef Mesh \"disc\"\n{{\nint[] faceVertexCounts = [{corners}]\n\
                 int[] faceVertexIndices = [{}]\npoint3f[] points = [{}]\n}}\n",
                list(&|i| i.to_string()),
                list(&|i| {
                    let (sin, cos) = (i as f64 / corners as f64 * std::f64::consts::TAU).sin_cos();
                    format!("({cos}, {sin}, 0)")
                }),
            );
            let mesh = read("a.usda", text.as_bytes()).unwrap();
            (mesh.faces, mesh.remarks.len())
        };
        assert_eq!(faces(4), (4 << 6, 0));
        assert_eq!(faces(1000), (1000 << 6, 0));
        assert_eq!(faces(20_000), (20_000 << 2, 0));
        assert_eq!(faces(100_000), (100_000, 0));
        assert_eq!(faces(2_000_001), (1, 1));
    }

    #[test]
    fn creases_corners_and_holes_are_heard() {
        let chain = "int[] creaseIndices = [4, 5, 7, 6, 4]\n    int[] creaseLengths = [5]";
        for sharpness in ["[10]", "[10, 10, 10, 10]"] {
            let mesh = cube(&format!(
                "{chain}\n    float[] creaseSharpnesses = {sharpness}"
            ));
            let corner = Vec3::new(2.0 / 3.0, 2.0 / 3.0, 1.0);
            assert!(
                (farthest(&mesh) - corner.length()).abs() < 1e-6,
                "{}",
                farthest(&mesh)
            );
        }
        let peak = cube("int[] cornerIndices = [7]\n    float[] cornerSharpnesses = [10]");
        assert!((farthest(&peak) - 3f32.sqrt()).abs() < 1e-6);
        assert_eq!(cube("int[] holeIndices = [1, 77, -1]").faces, 5 << 8);
        // Chains that end too early, or name points that are not there, change nothing.
        for broken in ["[3]", "[-1]", "[9223372036854775807]"] {
            let line = format!(
                "int[] creaseIndices = [4, 55]\n    int[] creaseLengths = {broken}\n    float[] creaseSharpnesses = [10]"
            );
            assert_eq!(farthest(&cube(&line)), farthest(&cube("")));
        }
    }

    #[test]
    fn seams_of_pictures_stay_as_far_as_the_file_says() {
        let with = |seams: &str| {
            cube(&format!(
                "uniform token faceVaryingLinearInterpolation = \"{seams}\""
            ))
        };
        let is_straight =
            |mesh: RawMesh| (mesh.uvs.iter()).all(|uv| (*uv * 16.0).fract() == Vec2::ZERO);
        assert!(is_straight(with("all")) && is_straight(with("boundaries")));
        assert!(!is_straight(with("none")));
        // Corners of single faces go inward where nothing keeps them.
        let corners = |mesh: &RawMesh| mesh.uvs.iter().filter(|uv| **uv == Vec2::ZERO).count();
        assert_eq!(
            (corners(&with("cornersOnly")), corners(&with("none"))),
            (1, 0)
        );
    }
}
