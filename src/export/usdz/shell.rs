//! Fur as one surface: the skin, moved out to where its hairs end.

use crate::export::asset;
use crate::groom::Groom;
use crate::skin::Skin;
use crate::species::Species;
use glam::Vec3;
use std::collections::HashMap;

/// Hairs that a mean should be of, so that single ones make neither spikes nor specks.
const HAIRS: f32 = 12.0;
/// Most rounds in which neighbors share what they know.
const MOST_ROUNDS: usize = 24;
/// Share of a hair from its tip whose color is seen.
const SEEN: f32 = 0.5;

/// A closed coat as a mesh; all lengths in meters, Y up.
pub(super) struct Shell {
    /// A vertex for every place of the skin.
    pub(super) points: Vec<Vec3>,
    /// Unit, outward.
    pub(super) normals: Vec<Vec3>,
    /// Linear reflectance at each vertex.
    pub(super) colors: Vec<Vec3>,
    /// Counter-clockwise seen from outside.
    pub(super) triangles: Vec<[u32; 3]>,
}

/// What hairs leave at a vertex.
#[derive(Clone, Copy, Default)]
struct Sums {
    weight: f32,
    height: f32,
    color: Vec3,
}

impl Sums {
    fn add(&mut self, other: Self) {
        self.weight += other.weight;
        self.height += other.height;
        self.color += other.color;
    }
}

impl Shell {
    /// * `skin_color`: of the skin where no hair grows, linear.
    pub(super) fn new(groom: &Groom, skin: &Skin, species: &Species, skin_color: Vec3) -> Self {
        let (place, sources) = places(skin);
        let triangles: Vec<[u32; 3]> = (skin.triangles.iter())
            .map(|t| t.map(|v| place[v as usize]))
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect();
        let of_place = |of: &dyn Fn(usize) -> Vec3| -> Vec<Vec3> {
            sources.iter().map(|&v| of(v as usize)).collect()
        };
        let mut points = of_place(&|v| skin.positions[v]);
        let outward = normals(&points, &triangles);
        let mut sums = sums(groom, skin, species, &place, sources.len());
        let bare: Vec<bool> = sources
            .iter()
            .map(|&v| skin.density[v as usize] == 0.0)
            .collect();
        share(&mut sums, &triangles, &bare, groom.strands());
        let skin_colors = of_place(&|v| groom.skin_color(skin, v) * skin_color);
        let colors = (sums.iter().zip(skin_colors))
            .map(|(s, own)| {
                if s.weight > 0.0 {
                    s.color / s.weight
                } else {
                    own
                }
            })
            .collect();
        for ((point, normal), sums) in points.iter_mut().zip(&outward).zip(&sums) {
            if sums.weight > 0.0 {
                let lowest = skin.floor.map(|floor| floor.min(point.y));
                *point += *normal * (sums.height / sums.weight);
                // Hair lies on the ground and does not go through it.
                point.y = lowest.map_or(point.y, |lowest| point.y.max(lowest));
            }
        }
        Self {
            normals: normals(&points, &triangles),
            points,
            colors,
            triangles,
        }
    }
}

/// The place of each vertex, equal for vertices at equal positions, and a vertex of each place.
fn places(skin: &Skin) -> (Vec<u32>, Vec<u32>) {
    let mut known: HashMap<[u32; 3], u32> = HashMap::new();
    let mut sources = Vec::new();
    let place = (skin.positions.iter().zip(0u32..))
        .map(|(p, v)| {
            let key = (*p + 0.0).to_array().map(f32::to_bits);
            *known.entry(key).or_insert_with(|| {
                sources.push(v);
                sources.len() as u32 - 1
            })
        })
        .collect();
    (place, sources)
}

/// Mean height and color of the hairs around each place, weighted by their area.
fn sums(groom: &Groom, skin: &Skin, species: &Species, place: &[u32], count: usize) -> Vec<Sums> {
    let colors = asset::colors(groom, species);
    let mut sums = vec![Sums::default(); count];
    for strand in 0..groom.strands() {
        let range = groom.range(strand);
        let (points, widths) = (&groom.points[range.clone()], &groom.widths[range.clone()]);
        let corners = skin.triangles[groom.root_triangle[strand] as usize];
        let [u, v] = groom.root_barycentric[strand].to_array();
        let shares = [1.0 - u - v, u, v];
        let normal: Vec3 = (corners.iter().zip(shares))
            .map(|(&c, share)| skin.normals[c as usize] * share)
            .sum();
        let normal = normal.normalize_or_zero();
        let height = (points.iter())
            .map(|p| (*p - points[0]).dot(normal))
            .fold(0.0, f32::max);
        let area: f32 = (points.windows(2).zip(widths.windows(2)))
            .map(|(p, w)| p[0].distance(p[1]) * 0.5 * (w[0] + w[1]))
            .sum();
        let first = range.start + ((1.0 - SEEN) * points.len() as f32) as usize;
        let seen = &colors[first.min(range.end - 1)..range.end];
        let color = seen.iter().sum::<Vec3>() / seen.len() as f32;
        for (corner, share) in corners.into_iter().zip(shares) {
            let weight = area * share.max(0.0);
            sums[place[corner as usize] as usize].add(Sums {
                weight,
                height: weight * height,
                color: weight * color,
            });
        }
    }
    sums
}

/// Lets every place hear of the hairs around it, until there are enough for a mean; bare skin hears of none.
fn share(sums: &mut Vec<Sums>, triangles: &[[u32; 3]], bare: &[bool], strands: usize) {
    // A round doubles the places that a hair counts in, and then adds about three.
    let of_place = strands as f32 / sums.len().max(1) as f32;
    let rounds = ((HAIRS / (3.0 * of_place)).ceil() as usize).clamp(1, MOST_ROUNDS);
    for _ in 0..rounds {
        let mut next = sums.clone();
        for triangle in triangles {
            for k in 0..3 {
                let (to, from) = (triangle[k] as usize, triangle[(k + 1) % 3] as usize);
                if !bare[to] {
                    next[to].add(sums[from]);
                }
            }
        }
        // Means stay as they are, and no sum of many rounds overflows.
        for sum in &mut next {
            sum.weight *= 0.125;
            sum.height *= 0.125;
            sum.color *= 0.125;
        }
        *sums = next;
    }
}

/// Unit normals of vertices, of the triangles around each by area.
fn normals(points: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| points[v as usize]);
        let normal = (b - a).cross(c - a);
        for v in triangle {
            sums[*v as usize] += normal;
        }
    }
    sums.into_iter().map(|n| n.normalize_or(Vec3::Y)).collect()
}
