//! Rules on the groom as a whole: ids, levels of detail, numbers of strands, roots.

use super::consumer::{Consumer, DRAWING};
use super::curves::Curves;
use super::finding::{Findings, Place, Severity};
use super::rule::Rule;
use super::stage::{Item, floats, ints, points};
use crate::usd_file::{Prim, Value};
use Consumer::{Blender, Houdini, Unreal};
use Severity::{Error, Note, Warning};
use glam::Vec3;
use std::collections::{BTreeMap, HashSet};

/// Names of the primvars that tell strands apart.
const IDS: [&str; 3] = ["primvars:curve_id", "primvars:groom_id", "primvars:id"];

/// How far a root may be off its place on the skin, as a share of the skin's size.
const ROOT_TOLERANCE: f32 = 1e-3;

/// Ids of the strands of every prim for pictures, by its path.
pub(super) type Ids = BTreeMap<String, HashSet<i64>>;

/// The curves that are for pictures.
fn shown<'c, 's>(all: &'c [Curves<'s>]) -> impl Iterator<Item = &'c Curves<'s>> {
    let is_guide = |c: &Curves<'_>| {
        let flags = ints(c.item.prim.value("primvars:groom_guide")).unwrap_or_default();
        c.item.purpose == "guide" || (!flags.is_empty() && flags.iter().all(|f| *f != 0))
    };
    all.iter()
        .filter(move |c| c.item.purpose != "proxy" && !is_guide(c))
}

/// That ids are unique in a prim; returns them.
pub(super) fn check_ids(all: &[Curves<'_>], findings: &mut Findings<'_>) -> Ids {
    let mut of_prims = Ids::new();
    for curves in all {
        for name in IDS {
            let Some(ids) = ints(curves.item.prim.value(name)) else {
                continue;
            };
            if ids.len() != curves.counts.len() {
                continue;
            }
            let unique: HashSet<i64> = ids.iter().copied().collect();
            if unique.len() < ids.len() {
                let message = format!("{} strands share {} ids", ids.len(), unique.len());
                let remedy = "give every strand an id of its own that it keeps in all levels";
                let consumers = [Unreal, Houdini, Blender];
                findings.add(
                    (Rule::C17, Error),
                    &consumers,
                    curves.place(name),
                    message,
                    remedy,
                );
            }
        }
    }
    for curves in shown(all) {
        let ids = IDS
            .iter()
            .find_map(|name| ints(curves.item.prim.value(name)));
        if let Some(ids) = ids.filter(|ids| ids.len() == curves.counts.len()) {
            of_prims.insert(curves.item.path.clone(), ids.iter().copied().collect());
        }
    }
    of_prims
}

/// That the strands of each level of a set of variants are among those of the next finer one.
///
/// * `levels`: name of the variant and its ids.
pub(super) fn check_nesting(set: &str, levels: &[(String, Ids)], findings: &mut Findings<'_>) {
    let mut prims: Vec<&String> = levels.iter().flat_map(|(_, ids)| ids.keys()).collect();
    prims.sort();
    prims.dedup();
    for prim in prims {
        let of_prim = levels
            .iter()
            .filter_map(|(name, ids)| Some((name, ids.get(prim)?)));
        let mut of_prim: Vec<_> = of_prim.collect();
        of_prim.sort_by_key(|(_, ids)| std::cmp::Reverse(ids.len()));
        for pair in of_prim.windows(2) {
            let [(finer, more), (coarser, fewer)] = [pair[0], pair[1]];
            let strange = fewer.difference(more).count();
            if strange > 0 {
                let message = format!(
                    "{strange} of {} strands of {set}={coarser} are not among those of {set}={finer}",
                    fewer.len()
                );
                let remedy = "thin the finer level, or hair pops when levels are switched";
                let place = Place {
                    prim,
                    attribute: IDS[0],
                };
                findings.add((Rule::C17, Error), DRAWING, place, message, remedy);
            }
        }
    }
}

/// Number of strands for pictures; `None` if there are no curves at all.
pub(super) fn strands(all: &[Curves<'_>]) -> Option<usize> {
    (!all.is_empty()).then(|| shown(all).map(|c| c.counts.len()).sum())
}

/// That as many strands are there as the file says, or as were expected.
///
/// * `found`: as [`strands`] tells, of the finest level.
pub(super) fn check_number(
    roots: &[Prim],
    found: Option<usize>,
    expected: Option<u64>,
    findings: &mut Findings<'_>,
) {
    if found == Some(0) {
        let message = "there are only guides and proxies, no strands for pictures";
        let remedy = "export the strands, not only what they are grown from";
        findings.add(
            (Rule::C18, Error),
            DRAWING,
            Place::default(),
            message,
            remedy,
        );
        return;
    }
    let said = roots.iter().find_map(|root| {
        let number = root
            .field("customData")?
            .get("vair")?
            .get("strands")?
            .number()?;
        Some((format!("/{}", root.name), number as u64))
    });
    // A file without curves is no broken promise: it may be an interface whose payload is missing.
    let said = said
        .filter(|_| found.is_some())
        .map(|(prim, number)| (prim, number, "customData says"));
    let expected = expected.map(|number| (String::new(), number, "expected were"));
    let found = found.unwrap_or(0);
    for (prim, number, who) in said.into_iter().chain(expected) {
        if number != found as u64 {
            let message = format!("{found} strands are there for pictures, {who} {number}");
            let remedy = "export again, and look for what was left out";
            let place = Place {
                prim: &prim,
                attribute: "",
            };
            findings.add((Rule::C18, Error), DRAWING, place, message, remedy);
        }
    }
}

/// That roots are where `skinprim` and `skinprimuv` say.
pub(super) fn check_roots(items: &[Item<'_>], all: &[Curves<'_>], findings: &mut Findings<'_>) {
    let mut meshes = items.iter().filter(|i| i.prim.type_name == "Mesh");
    let (Some(mesh), None) = (meshes.next(), meshes.next()) else {
        return;
    };
    let (Some(counts), Some(corners), Some(vertices)) = (
        ints(mesh.prim.value("faceVertexCounts")),
        ints(mesh.prim.value("faceVertexIndices")),
        floats(mesh.prim.value("points"), 3),
    ) else {
        return;
    };
    let vertices: Vec<Vec3> = points(vertices).collect();
    let (lo, hi) = vertices
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| {
            (a.min(*p), b.max(*p))
        });
    let tolerance = ROOT_TOLERANCE * (hi - lo).length();
    // Where the corners of each face begin.
    let starts: Vec<i64> = counts
        .iter()
        .scan(0i64, |sum, count| {
            let start = *sum;
            *sum = sum.saturating_add(*count);
            Some(start)
        })
        .collect();
    let corner = |face: usize, k: i64| {
        let at = usize::try_from(starts.get(face)?.checked_add(k)?).ok()?;
        vertices
            .get(usize::try_from(*corners.get(at)?).ok()?)
            .copied()
    };
    let on_face = |face: i64, u: f32, v: f32| -> Option<Vec3> {
        let face = usize::try_from(face).ok()?;
        let [a, b, c] = [corner(face, 0)?, corner(face, 1)?, corner(face, 2)?];
        (counts[face] == 3).then(|| a + u * (b - a) + v * (c - a))
    };
    let mut is_left_out = false;
    for curves in all {
        let prim = curves.item.prim;
        let faces = ints(prim.value("primvars:skinprim"));
        let Some(faces) = faces.filter(|f| curves.is_sound() && f.len() == curves.counts.len())
        else {
            continue;
        };
        let outside = faces
            .iter()
            .filter(|f| !(0..counts.len() as i64).contains(*f))
            .count();
        if outside > 0 {
            let message = format!(
                "{outside} strands name a face that {} does not have",
                mesh.path
            );
            let remedy = "write the face of the skin that each strand grows on";
            findings.add(
                (Rule::C19, Error),
                &[Houdini],
                curves.place("primvars:skinprim"),
                message,
                remedy,
            );
            continue;
        }
        let uvs = prim.value("primvars:skinprimuv");
        let width = match uvs {
            Some(Value::Floats { width, .. }) => *width,
            _ => continue,
        };
        let uvs = floats(uvs, width).unwrap_or_default();
        if width < 2 || uvs.len() != width * faces.len() {
            continue;
        }
        if curves.item.is_moved || mesh.is_moved {
            is_left_out = true;
            continue;
        }
        let (mut start, mut off, mut worst) = (0usize, 0, 0.0f32);
        for (i, &count) in curves.counts.iter().enumerate() {
            let root = curves
                .points
                .get(3 * (start + curves.root())..)
                .unwrap_or_default();
            start += count as usize;
            let (Some(root), Some(place)) = (
                points(root).next(),
                on_face(faces[i], uvs[width * i], uvs[width * i + 1]),
            ) else {
                continue;
            };
            let distance = root.distance(place);
            if distance > tolerance {
                off += 1;
                worst = worst.max(distance);
            }
        }
        if off > 0 {
            let message = format!(
                "{off} of {} roots are off their place on {}, by {worst} at most",
                faces.len(),
                mesh.path
            );
            let remedy = "write skinprim and skinprimuv of the skin that is in the file, or move the strands back";
            let severity = if curves.item.purpose == "guide" {
                Warning
            } else {
                Error
            };
            findings.add(
                (Rule::C19, severity),
                &[Houdini, Blender],
                curves.place("points"),
                message,
                remedy,
            );
        }
    }
    if is_left_out {
        let message =
            "strands or skin are moved by transforms: roots were not held against the skin";
        let place = Place {
            prim: &mesh.path,
            attribute: "",
        };
        findings.add(
            (Rule::C19, Note),
            &[Houdini, Blender],
            place,
            message,
            "nothing, if both move alike",
        );
    }
}
