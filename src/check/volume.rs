//! Rules on grids: files of OpenVDB, the fields that show them, and where they lie.

use super::beside::{Grids, unfollowed};
use super::consumer::Consumer;
use super::finding::{Findings, Place, Severity};
use super::rule::Rule;
use super::stage::Item;
use crate::usd_file::Value;
use crate::vdb_file::{GridFacts, Meta, VdbFacts};
use Consumer::{Arnold, Blender, Cycles, Houdini, Omniverse, OpenVdb, RenderMan, Storm};
use Severity::{Error, Note, Warning};
use std::collections::{BTreeMap, BTreeSet};

/// All that draw volumes.
pub(super) const DRAWING: &[Consumer] = &[
    Blender, Cycles, Houdini, Arnold, RenderMan, Omniverse, Storm, OpenVdb,
];

/// All rules on a file of grids.
pub(super) fn check_file(facts: &VdbFacts, findings: &mut Findings<'_>) {
    let mut add = |severity, consumers: &[Consumer], message: String, remedy: &str| {
        findings.add(
            (Rule::C13, severity),
            consumers,
            Place::default(),
            message,
            remedy,
        );
    };
    let version = facts.version;
    match version {
        0..=220 => add(
            Error,
            &[OpenVdb],
            format!("the file has version {version}: OpenVDB 13 does not read it"),
            "write it again with a newer library",
        ),
        225 => add(
            Warning,
            DRAWING,
            "the file has version 225: libraries before OpenVDB 12 may refuse it".to_owned(),
            "write version 224",
        ),
        226.. => add(
            Error,
            DRAWING,
            format!("the file has version {version}; the newest that is known is 225"),
            "write version 224",
        ),
        _ => {}
    }
    if !facts.is_read {
        let (message, remedy) = match version {
            222..=225 => (
                "grids were not looked at: the file was written as a stream and does not say where they are".to_owned(),
                "nothing, if readers know it; OpenVDB's io::File writes the places",
            ),
            _ => (
                format!("grids were not looked at: files of version {version} are not read here"),
                "write version 224",
            ),
        };
        add(Note, DRAWING, message, remedy);
    }
    for grid in &facts.grids {
        check_grid(grid, findings);
    }
}

fn check_grid(grid: &GridFacts, findings: &mut Findings<'_>) {
    let mut add = |severity, consumers: &[Consumer], attribute, message: String, remedy: &str| {
        let place = Place {
            prim: &grid.name,
            attribute,
        };
        findings.add((Rule::C13, severity), consumers, place, message, remedy);
    };
    let class = grid.text("class");
    if class.is_none() {
        let message = "there is no class: readers guess it from the name".to_owned();
        add(
            Warning,
            &[RenderMan, Arnold, Houdini],
            "class",
            message,
            "write fog volume, level set or unknown",
        );
    }
    let is_half = grid.type_name.ends_with("_HalfFloat");
    let says_half = grid.meta("is_saved_as_half_float") == Some(&Meta::Bool(true));
    if is_half != says_half {
        let message = format!(
            "is_saved_as_half_float is {says_half}, but the tree is {}",
            grid.type_name
        );
        add(
            Error,
            &[OpenVdb],
            "is_saved_as_half_float",
            message,
            "let both say the same",
        );
    }
    let corner = |name| match grid.meta(name) {
        Some(Meta::Voxel(voxel)) => Some(*voxel),
        _ => None,
    };
    let said = corner("file_bbox_min").zip(corner("file_bbox_max"));
    if said.is_none() {
        let message =
            "there is no file_bbox_min and file_bbox_max: RenderMan shows nothing".to_owned();
        add(
            Warning,
            &[RenderMan],
            "file_bbox_min",
            message,
            "write both with the grid",
        );
    }
    let values = match &grid.values {
        Ok(values) => values,
        Err(why) => {
            let message = format!("values were not looked at: {why}");
            add(
                Note,
                &[OpenVdb],
                "",
                message,
                "nothing, if readers know them",
            );
            return;
        }
    };
    if let (Some(said), Some(found)) = (said, values.bounds)
        && said != found
    {
        let message = format!(
            "file_bbox is {} to {}, voxels are active from {} to {}",
            said.0, said.1, found.0, found.1
        );
        add(
            Error,
            &[RenderMan],
            "file_bbox_min",
            message,
            "write the box around the active voxels",
        );
    }
    if values.not_finite > 0 {
        let message = format!("{} values are infinite or none", values.not_finite);
        let place = Place {
            prim: &grid.name,
            attribute: "",
        };
        findings.add((Rule::C03, Error), DRAWING, place, message, "write numbers");
    } else if let Some((least, _)) = values
        .range
        .filter(|r| class == Some("fog volume") && r.0 < 0.0)
    {
        let message = format!("the fog has negative density, {least} at least");
        add(
            Error,
            DRAWING,
            "",
            message,
            "write 0 where there is nothing",
        );
    }
}

/// All rules on the volumes of a stage.
///
/// * `grids`: the OpenVDB files that fields name.
pub(super) fn check_fields(items: &[Item<'_>], grids: &Grids, findings: &mut Findings<'_>) {
    let by_path: BTreeMap<&str, &Item<'_>> = items.iter().map(|i| (i.path.as_str(), i)).collect();
    for volume in items.iter().filter(|i| i.prim.type_name == "Volume") {
        let place = |attribute| Place {
            prim: volume.path.as_str(),
            attribute,
        };
        let fields = volume
            .prim
            .properties
            .iter()
            .filter(|p| p.name.starts_with("field:"));
        let mut files = BTreeSet::new();
        for field in fields {
            for target in &field.targets {
                match by_path.get(target.as_str()) {
                    Some(asset) => {
                        if let Some(Value::Asset(file)) = asset.prim.value("filePath") {
                            files.insert(file.clone());
                        }
                        check_field(asset, grids, findings);
                    }
                    None => {
                        let message = format!("the field {target} is not there");
                        let remedy = "name a prim below the volume";
                        findings.add(
                            (Rule::C14, Error),
                            DRAWING,
                            place(&field.name),
                            message,
                            remedy,
                        );
                    }
                }
            }
        }
        if files.len() > 1 {
            let files: Vec<String> = files.into_iter().collect();
            let message = format!("fields are in {} files: {}", files.len(), files.join(", "));
            let remedy = "write all grids of a volume into one file: Arnold reads one";
            findings.add((Rule::C13, Error), &[Arnold], place(""), message, remedy);
        }
    }
}

fn check_field(asset: &Item<'_>, grids: &Grids, findings: &mut Findings<'_>) {
    let mut add = |rule, severity, attribute, message: String, remedy: &str| {
        let place = Place {
            prim: &asset.path,
            attribute,
        };
        findings.add((rule, severity), DRAWING, place, message, remedy);
    };
    let word = |name| asset.prim.text(name);
    let Some(Value::Asset(file)) = asset.prim.value("filePath") else {
        let message = "there is no filePath: nothing is shown".to_owned();
        add(
            Rule::C14,
            Error,
            "filePath",
            message,
            "name the .vdb file, with ./ before it",
        );
        return;
    };
    for (name, remedy) in [
        ("fieldDataType", "write float or float3"),
        ("fieldClass", "write fogVolume, levelSet or unknown"),
    ] {
        if word(name).is_none() {
            let message = format!("there is no {name}: readers guess, or report an error");
            add(Rule::C14, Error, name, message, remedy);
        }
    }
    let Some(name) = word("fieldName") else {
        let message = "there is no fieldName: nothing is shown".to_owned();
        add(
            Rule::C14,
            Error,
            "fieldName",
            message,
            "name the grid in the file",
        );
        return;
    };
    let facts = match grids.open(file) {
        Ok(facts) => facts,
        Err(why) => {
            let (severity, message, remedy) = unfollowed(file, &why);
            add(Rule::C13, severity, "filePath", message, remedy);
            return;
        }
    };
    let Some(grid) = facts.grids.iter().find(|g| g.name == name) else {
        if facts.is_read {
            let message = format!("{file} has no grid called {name}");
            add(
                Rule::C14,
                Error,
                "fieldName",
                message,
                "name a grid of the file",
            );
        }
        return;
    };
    let is_vector = grid.type_name.contains("vec3");
    if word("fieldDataType").is_some_and(|kind| kind.ends_with('3') != is_vector) {
        let message = format!("fieldDataType is not that of the grid, {}", grid.type_name);
        add(
            Rule::C14,
            Error,
            "fieldDataType",
            message,
            "write float for numbers, float3 for vectors",
        );
    }
    let class = match grid.text("class") {
        Some("fog volume") => "fogVolume",
        Some("level set") => "levelSet",
        _ => return,
    };
    if word("fieldClass").is_some_and(|said| said != class) {
        let message = format!("fieldClass is not that of the grid, {class}");
        add(
            Rule::C14,
            Error,
            "fieldClass",
            message,
            "write the class of the grid",
        );
    }
}
