//! Rules on attributes: numbers, types, interpolations, names.

use super::consumer::{Consumer, DRAWING};
use super::curves::Curves;
use super::finding::{Findings, Place, Severity};
use super::rule::Rule;
use super::stage::Item;
use crate::usd_file::{Property, Value};
use Consumer::{Arnold, Blender, Cycles, Unreal};
use Severity::{Error, Note, Warning};

/// Types of arrays that Blender imports as attributes.
const OF_BLENDER: [&str; 14] = [
    "bool[]",
    "uchar[]",
    "int[]",
    "float[]",
    "float2[]",
    "float3[]",
    "vector3f[]",
    "normal3f[]",
    "point3f[]",
    "color3f[]",
    "color4f[]",
    "color3h[]",
    "quatf[]",
    "texCoord2f[]",
];

/// That no number of a prim is infinite or none.
pub(super) fn check_numbers(item: &Item<'_>, findings: &mut Findings<'_>) {
    // Physics has infinities that mean something, and nobody draws them.
    let is_drawn = |name: &str| !name.starts_with("physics:") && !name.starts_with("physx");
    for property in item.prim.properties.iter().filter(|p| is_drawn(&p.name)) {
        let values = property
            .value
            .iter()
            .chain(property.samples.iter().map(|(_, v)| v));
        let bad: usize = values.map(not_finite).sum();
        if bad == 0 {
            continue;
        }
        let place = Place {
            prim: &item.path,
            attribute: &property.name,
        };
        let message = format!("{bad} numbers are infinite or none: Arnold drops the whole prim");
        let remedy = "leave out the strands that they belong to";
        findings.add((Rule::C03, Error), DRAWING, place, message, remedy);
    }
}

fn not_finite(value: &Value) -> usize {
    match value {
        Value::Floats { values, .. } => values.iter().filter(|v| !v.is_finite()).count(),
        Value::Tuple(values) => values.iter().filter(|v| !v.is_finite()).count(),
        Value::Number(value) => usize::from(!value.is_finite()),
        _ => 0,
    }
}

/// All rules on the primvars of curves.
pub(super) fn check(curves: &Curves<'_>, findings: &mut Findings<'_>) {
    for property in &curves.item.prim.properties {
        let Some(name) = property.name.strip_prefix("primvars:") else {
            continue;
        };
        if name.ends_with(":indices") || name == "widths" || property.type_name.is_empty() {
            continue;
        }
        let place = Place {
            prim: &curves.item.path,
            attribute: &property.name,
        };
        check_uv(name, property, place, findings);
        check_color(name, property, place, findings);
        check_primvar(name, property, curves, place, findings);
    }
    check_groom(curves, findings);
}

fn check_uv(name: &str, property: &Property, place: Place<'_>, findings: &mut Findings<'_>) {
    // `st`, `st1`, `uv`, `uvs`, `groom_root_uv`, `surface_uv_coordinate`, but not a place on a face of the skin.
    let is_uv = name.trim_end_matches(|c: char| c.is_ascii_digit()) == "st"
        || name
            .split('_')
            .any(|word| matches!(word, "uv" | "uvs" | "uv0" | "uv1"));
    if !is_uv {
        return;
    }
    let found = property.type_name.as_str();
    if found != "texCoord2f[]" {
        let (what, consumers): (_, &[Consumer]) = match found {
            _ if found.starts_with("texCoord3") || found.starts_with("float3") => (
                "Blender makes zeros of three numbers, others drop the third",
                &[Blender, Cycles, Arnold],
            ),
            _ => ("Cycles sees no texture coordinates in it", &[Cycles]),
        };
        let message = format!("{name} is {found}: {what}");
        findings.add(
            (Rule::C06, Error),
            consumers,
            place,
            message,
            "write texCoord2f[]",
        );
    }
    if property.word("interpolation") == "vertex" {
        let message = format!("{name} is one a point: Arnold before 2023 wants one a strand");
        findings.add(
            (Rule::C06, Note),
            &[Arnold],
            place,
            message,
            "write it `uniform`",
        );
    }
}

fn check_color(name: &str, property: &Property, place: Place<'_>, findings: &mut Findings<'_>) {
    if name == "groom_color" && property.type_name != "float3[]" {
        let message = format!(
            "groom_color is {}: Unreal ignores it and shades black",
            property.type_name
        );
        findings.add(
            (Rule::C07, Error),
            &[Unreal],
            place,
            message,
            "write float3[]",
        );
    }
}

fn check_primvar(
    name: &str,
    property: &Property,
    curves: &Curves<'_>,
    place: Place<'_>,
    findings: &mut Findings<'_>,
) {
    let mut add = |severity, consumers: &[Consumer], message: String, remedy: &str| {
        findings.add((Rule::C10, severity), consumers, place, message, remedy);
    };
    if name == "id" {
        let message = "Arnold takes a primvar called id for a parameter of its own".to_owned();
        add(Error, &[Arnold], message, "call it curve_id");
    }
    let found = property.type_name.as_str();
    // What is for Unreal alone needs no place in Blender.
    let is_for_unreal = name.starts_with("groom_");
    if !found.ends_with("[]") {
        let message = format!("{name} is one {found}, no array: Blender drops it in silence");
        add(Warning, &[Blender], message, "write an array of one value");
    } else if !is_for_unreal && !OF_BLENDER.contains(&found) && !found.starts_with("texCoord3") {
        let message = format!("Blender does not import {found}");
        add(
            Note,
            &[Blender],
            message,
            "write float[], int[], float3[] or another type that arrives",
        );
    }
    let interpolation = match property.word("interpolation") {
        "" => "constant",
        authored => authored,
    };
    if interpolation == "faceVarying" {
        let message = format!("{name} is faceVarying: curves have no faces, Blender refuses it");
        add(Error, &[Blender], message, "write it vertex or uniform");
        return;
    }
    let indices = curves
        .item
        .prim
        .value(&format!("{}:indices", place.attribute));
    let elements = indices.or(property.any_value()).and_then(Value::elements);
    let (Some(elements), Some(places)) = (elements, curves.expected(interpolation)) else {
        return;
    };
    // Several values may belong together; indices name all of them at once.
    let together = property.field("elementSize").and_then(Value::number);
    let together = together.filter(|_| indices.is_none()).unwrap_or(1.0);
    let wanted = places.saturating_mul(together.max(1.0) as usize);
    if elements != wanted {
        let message =
            format!("{name} is {interpolation} and has {elements} values, {wanted} are wanted");
        add(
            Error,
            DRAWING,
            message,
            "write as many values as the interpolation asks for",
        );
    } else if interpolation == "varying" && curves.wrap == "pinned" {
        let message =
            format!("{name} is varying on pinned curves: Storm wants another number of values");
        add(Warning, &[Consumer::Storm], message, "write it vertex");
    }
}

/// That Unreal sees a groom, where the file is for it.
fn check_groom(curves: &Curves<'_>, findings: &mut Findings<'_>) {
    let item = curves.item;
    let is_meant = |p: &Property| p.name.starts_with("primvars:groom_");
    let asked = findings.names(Unreal);
    if item.is_groom || !(asked || item.prim.properties.iter().any(is_meant)) {
        return;
    }
    let message = "no GroomAPI here or above: Unreal does not import the curves";
    let remedy = "prepend apiSchemas = [\"GroomAPI\"] on the root prim";
    findings.add(
        (Rule::C08, Error),
        &[Unreal],
        curves.place(""),
        message,
        remedy,
    );
}
