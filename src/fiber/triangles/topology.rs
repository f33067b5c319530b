//! Whether surfaces are closed and have an inside, and which side it is.

use super::error::{MeshError, Places};
use super::solid::{Bound, Solid};
use glam::DVec3;

/// A directed side of a face. Sides of equal bound and key are one edge.
#[derive(Clone, Copy)]
struct Side {
    bound: Bound,
    /// Two points and the periods from the one to the other; points of images are those that they
    /// are images of.
    key: (u32, u32, i32),
    /// From the first point to the second.
    forward: bool,
    face: u32,
    index: u8,
}

/// A connected surface of one period.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shell {
    pub(super) bound: Bound,
    /// Enclosed volume of a period, in cubed radii; negative for islands.
    pub(super) volume: f64,
    /// Whether the file winds it inward.
    pub(super) inward: bool,
    /// A corner of it.
    pub(super) corner: u32,
}

/// The face across an edge and whether it is wound alike.
type Neighbor = (u32, bool);

/// Checks that every edge has two faces, orients all faces outward, and finds the shells.
///
/// Gives the shell of each face too.
pub(super) fn close(solid: &mut Solid<'_>) -> Result<(Vec<Shell>, Vec<u32>), MeshError> {
    let neighbors = neighbors(solid)?;
    let mut shells = Vec::new();
    let mut shell_of = vec![u32::MAX; solid.faces.len()];
    let mut is_turned = vec![false; solid.faces.len()];
    let mut turned = 0usize;
    for start in 0..solid.faces.len() {
        if shell_of[start] != u32::MAX {
            continue;
        }
        let shell = shells.len() as u32;
        shell_of[start] = shell;
        let mut members = vec![start as u32];
        let mut at = 0;
        while at < members.len() {
            let face = members[at] as usize;
            at += 1;
            for &(next, alike) in &neighbors[face] {
                let turn = is_turned[face] == alike;
                let next = next as usize;
                if shell_of[next] == u32::MAX {
                    shell_of[next] = shell;
                    is_turned[next] = turn;
                    members.push(next as u32);
                } else if is_turned[next] != turn {
                    let mut places = Places::default();
                    solid.note(&mut places, &solid.corners(&solid.faces[next]));
                    return Err(MeshError::OneSided {
                        file: solid.file(),
                        part: solid.faces[next].bound.name(),
                        places,
                    });
                }
            }
        }
        // The fewer are the ones that are wound wrong.
        let turns = members.iter().filter(|&&f| is_turned[f as usize]).count();
        turned += turns.min(members.len() - turns);
        for &face in &members {
            if is_turned[face as usize] {
                solid.faces[face as usize].corners.swap(1, 2);
            }
        }
        let mut volume: f64 = (members.iter())
            .map(|&f| volume_under(solid.corners(&solid.faces[f as usize])))
            .sum();
        let mut inward = false;
        if volume < 0.0 {
            volume = -volume;
            for &face in &members {
                solid.faces[face as usize].corners.swap(1, 2);
            }
            inward = 2 * turns < members.len();
        }
        let face = solid.faces[start];
        shells.push(Shell {
            bound: face.bound,
            volume,
            inward,
            corner: face.corners[0],
        });
    }
    if turned > 0 {
        let message = format!("{turned} faces were wound against their neighbors: turned");
        solid.warnings.push(message);
    }
    Ok((shells, shell_of))
}

/// Share of a triangle in the volume, by the flux of (x, y, 0) / 2: whatever would close the two ends
/// of a period adds nothing, as its images cancel.
fn volume_under([a, b, c]: [DVec3; 3]) -> f64 {
    let area = 0.5 * (b - a).cross(c - a);
    let center = (a + b + c) / 3.0;
    0.5 * (center.x * area.x + center.y * area.y)
}

/// The faces across the sides of each face; an error where an edge has not just two.
fn neighbors(solid: &Solid<'_>) -> Result<Vec<[Neighbor; 3]>, MeshError> {
    let sides = sorted_sides(solid);
    for bound in Bound::ALL {
        let (mut open, mut crowded) = (Places::default(), Places::default());
        let mut at_ends = true;
        let (lo, hi) = solid.range_z(bound);
        let is_at_end = |z: f64| (z - lo).min(hi - z) <= 0.02 * (hi - lo);
        let edges = sides.chunk_by(|a, b| a.bound == b.bound && a.key == b.key);
        for edge in edges.filter(|edge| edge[0].bound == bound) {
            let ends = solid.ends(edge[0]);
            match edge.len() {
                1 => {
                    at_ends &= is_at_end(0.5 * (ends[0].z + ends[1].z));
                    solid.note(&mut open, &ends);
                }
                2 => {}
                // Solids that touch along an edge: as many faces on the one side as on the other.
                n if 2 * edge.iter().filter(|s| s.forward).count() == n => {}
                _ => solid.note(&mut crowded, &ends),
            }
        }
        let (file, part) = (solid.file(), bound.name());
        if crowded.count() > 0 {
            return Err(MeshError::NonManifold {
                file,
                part,
                count: crowded.count(),
                places: crowded,
            });
        }
        if open.count() > 0 {
            return Err(MeshError::Open {
                file,
                part,
                count: open.count(),
                places: open,
                at_ends,
            });
        }
    }
    let mut neighbors = vec![[(0, true); 3]; solid.faces.len()];
    for edge in sides.chunk_by(|a, b| a.bound == b.bound && a.key == b.key) {
        let mut link = |a: Side, b: Side| {
            let alike = a.forward != b.forward;
            neighbors[a.face as usize][usize::from(a.index)] = (b.face, alike);
            neighbors[b.face as usize][usize::from(b.index)] = (a.face, alike);
        };
        if let [a, b] = edge {
            link(*a, *b);
        } else {
            let of = |forward| edge.iter().filter(move |s| s.forward == forward);
            of(true).zip(of(false)).for_each(|(a, b)| link(*a, *b));
        }
    }
    Ok(neighbors)
}

fn sorted_sides(solid: &Solid<'_>) -> Vec<Side> {
    let mut sides = Vec::with_capacity(3 * solid.faces.len());
    for (f, face) in solid.faces.iter().enumerate() {
        for index in 0..3u8 {
            let from = face.corners[usize::from(index)];
            let to = face.corners[usize::from(index + 1) % 3];
            let [(a, below), (b, above)] = [from, to].map(|v| solid.images[v as usize]);
            let rise = above - below;
            let forward = (a, 0) < (b, rise);
            let key = if forward { (a, b, rise) } else { (b, a, -rise) };
            sides.push(Side {
                bound: face.bound,
                key,
                forward,
                face: f as u32,
                index,
            });
        }
    }
    sides.sort_unstable_by_key(|s| (s.bound, s.key, s.face, s.index));
    sides
}

impl Solid<'_> {
    fn ends(&self, side: Side) -> [DVec3; 2] {
        let face = &self.faces[side.face as usize];
        let index = usize::from(side.index);
        [index, (index + 1) % 3].map(|i| self.points[face.corners[i] as usize])
    }

    fn range_z(&self, bound: Bound) -> (f64, f64) {
        let faces = self.faces.iter().filter(|f| f.bound == bound);
        faces
            .flat_map(|f| self.corners(f))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), p| {
                (lo.min(p.z), hi.max(p.z))
            })
    }
}
