//! Rules on what a layer says of itself.

use super::consumer::Consumer;
use super::finding::{Findings, Place, Severity};
use super::rule::Rule;
use super::stage::Item;
use crate::usd_file::{Fields, Layer, Prim, Value, is_resolved_elsewhere};
use Consumer::{Blender, Houdini, Omniverse, Unreal, Validators};
use Severity::{Error, Note, Warning};

/// All rules on a layer; `items` are those of its stage.
pub(super) fn check(layer: &Layer, items: &[Item<'_>], findings: &mut Findings<'_>) {
    let mut add = |severity, consumers: &[Consumer], attribute, message: String, remedy: &str| {
        let place = Place {
            prim: "",
            attribute,
        };
        findings.add((Rule::C16, severity), consumers, place, message, remedy);
    };
    let readers = [Blender, Unreal, Houdini, Omniverse, Validators];
    match layer.field("defaultPrim").and_then(Value::text) {
        None => {
            let message = "no defaultPrim: a reference to the file means nothing".to_owned();
            add(
                Error,
                &readers,
                "defaultPrim",
                message,
                "name the root prim",
            );
        }
        Some(name) => match items
            .iter()
            .find(|i| i.path[1..] == *name.trim_start_matches('/'))
        {
            None => {
                let message = format!("defaultPrim is {name}, which is not there");
                add(Error, &readers, "defaultPrim", message, "name a root prim");
            }
            Some(root) if root.prim.field("kind").is_none() => {
                let message = "the default prim has no kind".to_owned();
                let remedy = "kind = \"component\"";
                add(Warning, &[Omniverse, Validators], "kind", message, remedy);
            }
            Some(_) => {}
        },
    }
    match layer
        .field("metersPerUnit")
        .map(|v| v.number().unwrap_or(f64::NAN))
    {
        None => {
            let message = "no metersPerUnit: readers take centimeters, or meters".to_owned();
            add(
                Error,
                &readers,
                "metersPerUnit",
                message,
                "write 1 for meters, 0.01 for centimeters",
            );
        }
        Some(meters) if !(meters > 0.0 && meters.is_finite()) => {
            let message = format!("metersPerUnit is {meters}");
            add(
                Error,
                &readers,
                "metersPerUnit",
                message,
                "write 1 for meters, 0.01 for centimeters",
            );
        }
        Some(_) => {}
    }
    match layer.field("upAxis").map(|v| v.text().unwrap_or("")) {
        None => {
            let message = "no upAxis: readers take Y, or Z".to_owned();
            add(Error, &readers, "upAxis", message, "write \"Y\" or \"Z\"");
        }
        Some("Y" | "Z") => {}
        Some(other) => {
            let message = format!("upAxis is {other:?}");
            add(Error, &readers, "upAxis", message, "write \"Y\" or \"Z\"");
        }
    }
    let mut paths = Vec::new();
    paths_of_fields("", &layer.metadata, &mut paths);
    for prim in &layer.prims {
        paths_of_prim(&format!("/{}", prim.name), prim, &mut paths);
    }
    for (prim, attribute, path) in paths {
        // What a resolver makes of URIs and expressions is its own business.
        if is_resolved_elsewhere(&path) || path.starts_with("./") || path.starts_with("../") {
            continue;
        }
        let (severity, message) = match path.starts_with('/') || path.contains(":\\") {
            true => (Warning, format!("{path} is found on this machine only")),
            false => (
                Note,
                format!("{path} is looked for in more places than beside the file"),
            ),
        };
        let place = Place {
            prim: &prim,
            attribute: &attribute,
        };
        findings.add(
            (Rule::C16, severity),
            &[Omniverse, Validators],
            place,
            message,
            "begin the path with ./",
        );
    }
}

/// Prim, field and path of every file that something names.
type Paths = Vec<(String, String, String)>;

fn paths_of_prim(at: &str, prim: &Prim, out: &mut Paths) {
    paths_of_fields(at, &prim.metadata, out);
    for property in &prim.properties {
        if let Some(value) = property.any_value() {
            paths_of_value(at, &property.name, value, out);
        }
    }
    for child in &prim.children {
        paths_of_prim(&format!("{at}/{}", child.name), child, out);
    }
    for set in &prim.variant_sets {
        for variant in &set.variants {
            paths_of_prim(
                &format!("{at}{{{}={}}}", set.name, variant.name),
                variant,
                out,
            );
        }
    }
}

fn paths_of_fields(at: &str, fields: &Fields, out: &mut Paths) {
    for (name, value) in fields {
        paths_of_value(at, name, value, out);
    }
}

fn paths_of_value(at: &str, name: &str, value: &Value, out: &mut Paths) {
    let mut push = |path: &String| {
        if !path.is_empty() {
            out.push((at.to_owned(), name.to_owned(), path.clone()));
        }
    };
    match value {
        Value::Asset(path) => push(path),
        Value::Texts(all) if name == "subLayers" => all.iter().for_each(push),
        Value::References(references) => references.iter().for_each(|r| push(&r.asset)),
        Value::Dictionary(entries) => {
            for (_, value) in entries {
                paths_of_value(at, name, value, out);
            }
        }
        _ => {}
    }
}
