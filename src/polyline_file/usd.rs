//! Curves of a USD layer, with the transforms above them.
//!
//! The layer is taken by itself: what it refers to is not followed.

use super::Fault;
use crate::usd_file::{self, Prim, Specifier, Value, placed, to_meters};
use glam::{DMat4, DVec3};

/// Kinds of curves; all have `points` and `curveVertexCounts`.
const CURVES: [&str; 3] = ["BasisCurves", "NurbsCurves", "HermiteCurves"];

pub(super) fn lines(bytes: &[u8]) -> Result<Vec<Vec<[f32; 3]>>, Fault> {
    let layer = usd_file::parse(bytes).map_err(|e| ("as USD".to_owned(), e.to_string()))?;
    let mut lines = Vec::new();
    for prim in &layer.prims {
        visit(prim, "", to_meters(&layer), &mut lines)?;
    }
    Ok(lines)
}

fn visit(
    prim: &Prim,
    above: &str,
    outer: DMat4,
    lines: &mut Vec<Vec<[f32; 3]>>,
) -> Result<(), Fault> {
    let path = format!("{above}/{}", prim.name);
    if prim.specifier != Specifier::Def {
        return Ok(());
    }
    let placed = placed(prim, outer).map_err(|reason| (path.clone(), reason))?;
    if CURVES.contains(&prim.type_name.as_str()) {
        let added = curves(prim, placed).map_err(|reason| (path.clone(), reason))?;
        lines.extend(added);
    }
    for child in &prim.children {
        visit(child, &path, placed, lines)?;
    }
    Ok(())
}

fn curves(prim: &Prim, placed: DMat4) -> Result<Vec<Vec<[f32; 3]>>, String> {
    let points: &[f32] = match prim.value("points") {
        Some(Value::Floats { values, width: 3 }) => values,
        _ => &[],
    };
    let counts: &[i64] = match prim.value("curveVertexCounts") {
        Some(Value::Ints(counts)) => counts,
        _ => &[],
    };
    let wanted = (counts.iter()).try_fold(0i64, |sum, &n| (n >= 0).then(|| sum.checked_add(n))?);
    let here = points.len() / 3;
    if wanted != Some(here as i64) {
        let wanted = wanted.map_or_else(|| "no".to_owned(), |n| n.to_string());
        return Err(format!("{here} points, but curves of {wanted}"));
    }
    let mut rest = points;
    let mut lines = Vec::with_capacity(counts.len());
    for &count in counts {
        let (these, others) = rest.split_at(3 * count as usize);
        rest = others;
        let moved = |p: &[f32]| {
            let p = placed.transform_point3(DVec3::new(p[0].into(), p[1].into(), p[2].into()));
            let p = p.as_vec3();
            p.is_finite()
                .then(|| p.to_array())
                .ok_or_else(|| "a point that is not finite".to_owned())
        };
        lines.push(these.chunks_exact(3).map(moved).collect::<Result<_, _>>()?);
    }
    Ok(lines)
}
