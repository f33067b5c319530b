//! The prims of a stage in a row, with what those above say of them.

use crate::usd_file::{Prim, Property, Specifier, Value};

/// A prim that is shown.
pub(super) struct Item<'s> {
    pub(super) path: String,
    pub(super) prim: &'s Prim,
    /// `default`, `render`, `proxy` or `guide`.
    pub(super) purpose: &'s str,
    /// Whether GroomAPI is applied here or above.
    pub(super) is_groom: bool,
    /// Whether a material is bound here or above.
    pub(super) is_bound: bool,
    /// Whether something above moves it.
    pub(super) is_moved: bool,
}

/// All prims of a stage, parents before children.
pub(super) fn items(roots: &[Prim]) -> Vec<Item<'_>> {
    let mut items = Vec::new();
    for root in roots {
        visit(root, None, &mut items);
    }
    items
}

/// * `above`: place of the parent among the items.
fn visit<'s>(prim: &'s Prim, above: Option<usize>, items: &mut Vec<Item<'s>>) {
    let is_pruned = matches!(prim.field("active").and_then(Value::number), Some(0.0));
    if prim.specifier != Specifier::Def || is_pruned {
        return;
    }
    let above = above.map(|parent| &items[parent]);
    let path = above.map_or("", |a| a.path.as_str());
    let purpose = prim.text("purpose");
    let moves = matches!(prim.value("xformOpOrder"), Some(Value::Texts(ops)) if !ops.is_empty());
    let item = Item {
        path: format!("{path}/{}", prim.name),
        prim,
        purpose: purpose.unwrap_or(above.map_or("default", |a| a.purpose)),
        is_groom: prim.has_api("GroomAPI") || above.is_some_and(|a| a.is_groom),
        is_bound: binding(prim).is_some() || above.is_some_and(|a| a.is_bound),
        is_moved: moves || above.is_some_and(|a| a.is_moved),
    };
    let place = items.len();
    items.push(item);
    for child in &prim.children {
        visit(child, Some(place), items);
    }
}

/// The relationship that binds a material.
pub(super) fn binding(prim: &Prim) -> Option<&Property> {
    let bound = |p: &&Property| p.name == "material:binding" && !p.targets.is_empty();
    prim.properties.iter().find(bound)
}

/// The numbers of an array of so many numbers an element.
pub(super) fn floats(value: Option<&Value>, wanted: usize) -> Option<&[f32]> {
    match value {
        Some(Value::Floats { values, width }) if *width == wanted || values.is_empty() => {
            Some(values)
        }
        _ => None,
    }
}

/// Whole numbers of an array.
pub(super) fn ints(value: Option<&Value>) -> Option<&[i64]> {
    match value {
        Some(Value::Ints(values)) => Some(values),
        _ => None,
    }
}

/// Places among three numbers each.
pub(super) fn points(values: &[f32]) -> impl Iterator<Item = glam::Vec3> {
    values.chunks_exact(3).map(glam::Vec3::from_slice)
}

/// Corners of the box around points; turned inside out if there are none.
pub(super) fn bounds(values: &[f32]) -> (glam::Vec3, glam::Vec3) {
    let empty = (glam::Vec3::INFINITY, glam::Vec3::NEG_INFINITY);
    points(values).fold(empty, |(lo, hi), p| (lo.min(p), hi.max(p)))
}
