//! Curves of a USD layer, with the transforms above them.
//!
//! The layer is taken by itself: what it refers to is not followed.

use super::Fault;
use crate::usd_file::{self, Prim, Specifier, Value};
use glam::{DMat4, DQuat, DVec3};

/// Kinds of curves; all have `points` and `curveVertexCounts`.
const CURVES: [&str; 3] = ["BasisCurves", "NurbsCurves", "HermiteCurves"];

pub(super) fn lines(bytes: &[u8]) -> Result<Vec<Vec<[f32; 3]>>, Fault> {
    let layer = usd_file::parse(bytes).map_err(|e| ("as USD".to_owned(), e.to_string()))?;
    // What Pixar's library takes where a layer says nothing.
    let meters = layer.field("metersPerUnit").and_then(Value::number);
    let meters = meters.filter(|m| *m > 0.0 && m.is_finite()).unwrap_or(0.01);
    let mut root = DMat4::from_scale(DVec3::splat(meters));
    if layer.field("upAxis").and_then(Value::text) == Some("Z") {
        root *= DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2);
    }
    let mut lines = Vec::new();
    for prim in &layer.prims {
        visit(prim, "", root, &mut lines)?;
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

/// The transform of a prim's own operations under that of its parent.
fn placed(prim: &Prim, outer: DMat4) -> Result<DMat4, String> {
    let Some(Value::Texts(order)) = prim.value("xformOpOrder") else {
        return Ok(outer);
    };
    let mut placed = outer;
    for operation in order {
        if operation == "!resetXformStack!" {
            return Err("it leaves the transforms above it: not followed".to_owned());
        }
        let (name, inverse) = match operation.strip_prefix("!invert!") {
            Some(name) => (name, true),
            None => (operation.as_str(), false),
        };
        let kind = name.split(':').nth(1).unwrap_or_default();
        let known = prim.value(name).and_then(|value| matrix(kind, value));
        let matrix = known.ok_or_else(|| format!("`{name}` is not understood"))?;
        placed *= if inverse { matrix.inverse() } else { matrix };
    }
    Ok(placed)
}

/// One operation; angles are in degrees, `rotateXYZ` turns about X first.
fn matrix(kind: &str, value: &Value) -> Option<DMat4> {
    if let (Value::Number(angle), Some(axis)) = (value, kind.strip_prefix("rotate")) {
        let axis = match axis {
            "X" => DVec3::X,
            "Y" => DVec3::Y,
            "Z" => DVec3::Z,
            _ => return None,
        };
        return Some(DMat4::from_axis_angle(axis, angle.to_radians()));
    }
    let Value::Tuple(numbers) = value else {
        return None;
    };
    match (kind, numbers.as_slice()) {
        ("translate", &[x, y, z]) => Some(DMat4::from_translation(DVec3::new(x, y, z))),
        ("scale", &[x, y, z]) => Some(DMat4::from_scale(DVec3::new(x, y, z))),
        // The real part comes first.
        ("orient", &[w, x, y, z]) => {
            Some(DMat4::from_quat(DQuat::from_xyzw(x, y, z, w).normalize()))
        }
        // Rows in the file are columns here: USD multiplies from the left.
        ("transform", numbers) => Some(DMat4::from_cols_array(numbers.try_into().ok()?)),
        (rotate, &[x, y, z]) => {
            let order = rotate.strip_prefix("rotate")?;
            let mut turned = DMat4::IDENTITY;
            if order.len() != 3 {
                return None;
            }
            for axis in order.chars() {
                let (axis, angle) = match axis {
                    'X' => (DVec3::X, x),
                    'Y' => (DVec3::Y, y),
                    'Z' => (DVec3::Z, z),
                    _ => return None,
                };
                turned = DMat4::from_axis_angle(axis, angle.to_radians()) * turned;
            }
            Some(turned)
        }
        _ => None,
    }
}
