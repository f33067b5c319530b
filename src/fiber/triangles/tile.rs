//! From surfaces to the tile that rays are traced through, and the checks that need all of it.

use super::error::{MeshError, Places};
use super::overlap::crossing_pairs;
use super::solid::{Bound, Solid};
use super::topology::{Shell, close};
use super::tree::{Label, Tree};
use super::{Maker, OVERLAP, Screw, Triangles};
use crate::accel::AccelError;
use crate::fiber::{MeshPart, Part, Region};
use crate::species::FiberMesh;
use glam::DVec3;
use std::collections::HashMap;

/// A triangle of a tile, counterclockwise seen from outside.
#[derive(Clone, Debug)]
struct Triangle {
    corners: [DVec3; 3],
    label: Label,
    /// The closed surface that it belongs to.
    shell: u32,
}

/// Checks a mesh and prepares it for tracing.
pub(super) fn build(
    mesh: &FiberMesh,
    is_medium: bool,
    twist: f64,
    maker: Maker,
) -> Result<Triangles, MeshError> {
    let mut solid = Solid::new(mesh, is_medium, twist)?;
    let (mut shells, shell_of) = close(&mut solid)?;
    let mut tile = images(&solid, &shell_of);
    let overlap = match maker {
        Maker::Designer => refuse_crossings(&solid, &tile)?,
        Maker::Own { overlap } => overlap,
    };
    let corners: Vec<[DVec3; 3]> = tile.iter().map(|t| t.corners).collect();
    let (mut tree, places) =
        Tree::new(&corners, solid.step, solid.screw.period).map_err(|error| {
            let at = match error {
                AccelError::Coordinates { at } | AccelError::Coincident { at, .. } => at,
            };
            let mut places = Places::default();
            solid.note(&mut places, &[at.as_dvec3()]);
            MeshError::Crowded {
                file: solid.file(),
                places,
            }
        })?;
    // From here on by place, some of them more than once.
    tile = (places.iter()).map(|&i| tile[i as usize].clone()).collect();
    tree.label(|place| tile[place].label);
    let (lo, hi) = tile
        .iter()
        .filter(|t| t.label.bound == Bound::Outer)
        .flat_map(|t| t.corners)
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| {
            (lo.min(p), hi.max(p))
        });
    let half = 0.5 * solid.radius_um * (hi - lo);
    let mut triangles = Triangles {
        shells: tile.iter().map(|t| t.shell).collect(),
        tree,
        screw: solid.screw,
        layered: overlap,
        radius_um: solid.radius_um,
        air_fraction: 0.0,
        void_count: 0,
        semi_axes_um: [half.x, half.y],
        parts: Vec::new(),
        warnings: Vec::new(),
    };
    find_islands(&mut solid, &mut shells, &shell_of, &mut triangles);
    nest(&solid, &shells, &shell_of, &triangles, &mut tile)?;
    let voids = || shells.iter().filter(|s| s.bound == Bound::Void);
    triangles.tree.label(|place| tile[place].label);
    triangles.void_count = voids().filter(|s| !s.inward).count();
    triangles.air_fraction = air_fraction(&solid, &triangles, voids().map(|s| s.volume).sum());
    triangles.parts = parts(&solid);
    triangles.warnings = std::mem::take(&mut solid.warnings);
    Ok(triangles)
}

/// Surfaces wound inward of which it is found out whether they are islands; a fiber has some dozens.
const MOST_ISLANDS: usize = 20_000;

/// Which of the surfaces that were wound inward are islands in others of their kind: those stay as
/// they were. The others were turned, which is said.
fn find_islands(
    solid: &mut Solid<'_>,
    shells: &mut [Shell],
    shell_of: &[u32],
    triangles: &mut Triangles,
) {
    let mut turned = 0usize;
    let inward = shells.iter_mut().enumerate().filter(|(_, s)| s.inward);
    for (count, (index, shell)) in inward.enumerate() {
        let corner = solid.points[shell.corner as usize];
        let around = match shell.bound {
            Bound::Void if count < MOST_ISLANDS => {
                triangles.layers_of_others(corner, shell.bound, index as u32)
            }
            _ => 0,
        };
        shell.inward = around > 0;
        turned += usize::from(!shell.inward);
        shell.volume *= if shell.inward { -1.0 } else { 1.0 };
    }
    if turned > 0 {
        let what = if turned == 1 { "surface" } else { "surfaces" };
        let message = format!("{turned} closed {what} faced inward: turned inside out");
        solid.warnings.push(message);
    }
    let is_island = |shell: u32| shells[shell as usize].inward;
    triangles.layered |= shells.iter().any(|s| s.inward);
    let Triangles {
        tree,
        shells: shell_at,
        ..
    } = triangles;
    tree.turn(|place| is_island(shell_at[place]));
    for (face, _) in (solid.faces.iter_mut().zip(shell_of)).filter(|(_, s)| is_island(**s)) {
        face.corners.swap(1, 2);
    }
}

/// All triangles and their images that touch the tile.
fn images(solid: &Solid<'_>, shell_of: &[u32]) -> Vec<Triangle> {
    let mut tile = Vec::with_capacity(solid.faces.len() * 5 / 4);
    let has_cortex = solid.faces.iter().any(|f| f.bound == Bound::Cortex);
    let under_cuticle = if has_cortex {
        Region::Cuticle
    } else {
        Region::Cortex
    };
    let inside_of = [under_cuticle, Region::Cortex, Region::Medulla, Region::Void];
    let Screw { period, .. } = solid.screw;
    let (lo, hi) = (-2.0 * OVERLAP, period + 2.0 * OVERLAP);
    for (source, face) in solid.faces.iter().enumerate() {
        let z = solid.corners(face).map(|p| p.z);
        let (least, most) = (z[0].min(z[1]).min(z[2]), z[0].max(z[1]).max(z[2]));
        let first = ((lo - most) / period).ceil();
        let last = ((hi - least) / period).floor();
        let mut image = first;
        while image <= last {
            // A twist turns points off their steps.
            let snapped = |p: DVec3| (p / solid.step).round() * solid.step;
            let corners = face.corners.map(|v| snapped(solid.image(v, image)));
            let [a, b, c] = corners;
            // Nothing can be hit where there is no area; the edge belongs to both neighbors.
            if (b - a).cross(c - a).try_normalize().is_some() {
                tile.push(Triangle {
                    corners,
                    label: Label {
                        source: source as u32,
                        sides: [Region::Outside, inside_of[face.bound as usize]],
                        bound: face.bound,
                        part: face.part,
                    },
                    shell: shell_of[source],
                });
            }
            image += 1.0;
        }
    }
    tile
}

/// Depth below which surfaces only touch, in radii: some roundings of single precision.
const TOUCH: f64 = 1e-6;

/// Whether different surfaces of one kind, voids or pieces of a medium, go through each other; what
/// is in any of them is inside.
///
/// # Errors
/// Any other surfaces that do, and ones that go through themselves.
fn refuse_crossings(solid: &Solid<'_>, tile: &[Triangle]) -> Result<bool, MeshError> {
    let mut overlap = false;
    let corners: Vec<[DVec3; 3]> = tile.iter().map(|t| t.corners).collect();
    let mut found: HashMap<(Bound, Bound), (usize, Places)> = HashMap::new();
    let tolerance = TOUCH * (1.0 + solid.screw.period);
    let counted = crossing_pairs(&corners, tolerance, |a, b| {
        let bounds = [tile[a].label.bound, tile[b].label.bound];
        let may = matches!(bounds[0], Bound::Void | Bound::Medulla) && bounds[0] == bounds[1];
        if may && tile[a].shell != tile[b].shell {
            overlap = true;
            return;
        }
        let key = (bounds[0].max(bounds[1]), bounds[0].min(bounds[1]));
        let (count, places) = found.entry(key).or_default();
        *count += 1;
        solid.note(places, &[corners[a], corners[b]].concat());
    });
    if let Err(crowded) = counted {
        let mut places = Places::default();
        solid.note(&mut places, &corners[crowded.triangle]);
        return Err(MeshError::Crowded {
            file: solid.file(),
            places,
        });
    }
    let first = found.into_iter().min_by_key(|(key, _)| *key);
    match first {
        None => Ok(overlap),
        Some(((part, other), (count, places))) => Err(MeshError::Crossing {
            file: solid.file(),
            part: part.name(),
            other: other.name(),
            count,
            places,
        }),
    }
}

/// Finds the region around each shell, from the outermost kind inward: what is inside of a kind that
/// was placed before.
fn nest(
    solid: &Solid<'_>,
    shells: &[Shell],
    shell_of: &[u32],
    triangles: &Triangles,
    tile: &mut [Triangle],
) -> Result<(), MeshError> {
    let mut around = vec![Region::Outside; shells.len()];
    for bound in [Bound::Cortex, Bound::Medulla, Bound::Void] {
        for (index, shell) in shells.iter().enumerate() {
            if shell.bound != bound {
                continue;
            }
            let corner = solid.points[shell.corner as usize];
            around[index] = triangles.region_by(corner, &|other| other < bound);
            if around[index] == Region::Outside {
                let mut places = Places::default();
                solid.note(&mut places, &[corner]);
                return Err(MeshError::Outside {
                    file: solid.file(),
                    part: bound.name(),
                    places,
                });
            }
        }
        let of_bound = tile.iter_mut().map(|t| &mut t.label);
        for label in of_bound.filter(|label| label.bound == bound) {
            label.sides[0] = around[shell_of[label.source as usize] as usize];
        }
    }
    Ok(())
}

/// Volume of the voids over that of the least cylinder about the axis that holds them.
///
/// * `volume`: of all voids, those that overlap counted twice.
fn air_fraction(solid: &Solid<'_>, triangles: &Triangles, volume: f64) -> f64 {
    let voids = solid.faces.iter().filter(|f| f.bound == Bound::Void);
    let reach = voids
        .flat_map(|f| solid.corners(f))
        .map(|p| p.truncate().length_squared())
        .fold(0.0, f64::max);
    let period = solid.screw.period;
    if reach == 0.0 {
        0.0
    } else if triangles.layered {
        const POINTS: u32 = 5000;
        let at = |i: u32| {
            let i = f64::from(i) + 0.5;
            // Steps of a rank-1 lattice (Roberts 2018).
            let [u, v, w] = [0.819_172_513, 0.671_043_607, 0.549_700_478].map(|s| (i * s).fract());
            let (sin, cos) = (std::f64::consts::TAU * u).sin_cos();
            let r = (v * reach).sqrt();
            DVec3::new(r * cos, r * sin, w * period)
        };
        let is_void = |i: &u32| triangles.region_by(at(*i), &|_| true) == Region::Void;
        (0..POINTS).filter(is_void).count() as f64 / f64::from(POINTS)
    } else {
        volume / (std::f64::consts::PI * reach * period)
    }
}

fn parts(solid: &Solid<'_>) -> Vec<MeshPart> {
    let kinds = [
        ("cuticle", Part::Scale),
        ("riser", Part::Riser),
        ("cortex", Part::Cortex),
        ("medulla", Part::Medulla),
        ("void", Part::Void),
    ];
    let part = |(name, of)| {
        let mut index = HashMap::new();
        let mut part = MeshPart {
            name,
            points: Vec::new(),
            triangles: Vec::new(),
        };
        let faces = solid.faces.iter();
        for face in faces.filter(|f| f.part == of) {
            let corners = face.corners.map(|v| {
                *index.entry(v).or_insert_with(|| {
                    part.points.push(solid.radius_um * solid.points[v as usize]);
                    part.points.len() as u32 - 1
                })
            });
            part.triangles.push(corners);
        }
        part
    };
    kinds
        .map(part)
        .into_iter()
        .filter(|part| !part.triangles.is_empty())
        .collect()
}
