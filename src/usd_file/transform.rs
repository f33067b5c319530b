//! Where prims are: the operations of their transforms.

use super::{Layer, Prim, Value};
use glam::{DMat4, DQuat, DVec3};

/// Meters in a unit of a layer.
pub(crate) fn meters_per_unit(layer: &Layer) -> f64 {
    // What Pixar's library takes where a layer says nothing.
    let meters = layer.field("metersPerUnit").and_then(Value::number);
    meters.filter(|m| *m > 0.0 && m.is_finite()).unwrap_or(0.01)
}

/// Whether Z points up and not Y, if a layer says.
pub(crate) fn is_z_up(layer: &Layer) -> Option<bool> {
    (layer.field("upAxis").and_then(Value::text)).map(|axis| axis == "Z")
}

/// From the units of a layer to meters with Y up.
pub(crate) fn to_meters(layer: &Layer) -> DMat4 {
    let mut root = DMat4::from_scale(DVec3::splat(meters_per_unit(layer)));
    if is_z_up(layer) == Some(true) {
        root *= DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2);
    }
    root
}

/// The transform of a prim's own operations under that of its parent.
///
/// # Errors
/// An operation that is not understood, or one that leaves the transforms above.
pub(crate) fn placed(prim: &Prim, outer: DMat4) -> Result<DMat4, String> {
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
