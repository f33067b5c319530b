//! Rules on materials.

use super::consumer::{Consumer, DRAWING};
use super::finding::{Findings, Place, Severity};
use super::rule::Rule;
use super::stage::{Item, binding};
use Consumer::{Arnold, Houdini, RenderMan, Validators};
use Severity::{Error, Note, Warning};
use std::collections::HashMap;

/// MaterialX's helper nodes that are stubs in its OSL backend.
const HELPERS: [&str; 3] = [
    "ND_chiang_hair_roughness",
    "ND_chiang_hair_absorption_from_color",
    "ND_deon_hair_absorption_from_melanin",
];

/// All rules on bindings and shaders.
pub(super) fn check(items: &[Item<'_>], findings: &mut Findings<'_>) {
    let by_path: HashMap<&str, &Item<'_>> = items.iter().map(|i| (i.path.as_str(), i)).collect();
    for item in items {
        let place = |attribute| Place {
            prim: &item.path,
            attribute,
        };
        if let Some(bound) = binding(item.prim) {
            let attribute = place("material:binding");
            if !item.prim.has_api("MaterialBindingAPI") {
                let message = "a material is bound, but MaterialBindingAPI is not applied";
                let remedy = "prepend apiSchemas = [\"MaterialBindingAPI\"] on the prim";
                findings.add(
                    (Rule::C12, Error),
                    &with_validators(),
                    attribute,
                    message,
                    remedy,
                );
            }
            for target in &bound.targets {
                let found = by_path
                    .get(target.as_str())
                    .map(|i| i.prim.type_name.as_str());
                if found != Some("Material") {
                    let message = match found {
                        None => format!("the material {target} is not there"),
                        Some(other) => format!("{target} is a {other}, no Material"),
                    };
                    let remedy = "bind a material below the default prim";
                    findings.add(
                        (Rule::C12, Error),
                        &with_validators(),
                        attribute,
                        message,
                        remedy,
                    );
                }
            }
        } else if item.prim.type_name == "BasisCurves" && !item.is_bound && item.purpose != "guide"
        {
            let message = "the curves have no material";
            let remedy = "bind one, or choose it in the program that opens the file";
            findings.add((Rule::C12, Note), DRAWING, place(""), message, remedy);
        }
        let id = item.prim.text("info:id");
        if let Some(id) = id.filter(|id| HELPERS.iter().any(|helper| id.starts_with(helper))) {
            let message =
                format!("{id} is a stub in MaterialX's OSL: it gives 0 or 1 whatever goes in");
            let remedy = "write the numbers on the chiang_hair_bsdf itself";
            findings.add(
                (Rule::C12, Warning),
                &[Arnold, Houdini, RenderMan],
                place("info:id"),
                message,
                remedy,
            );
        }
    }
}

fn with_validators() -> Vec<Consumer> {
    DRAWING.iter().copied().chain([Validators]).collect()
}
