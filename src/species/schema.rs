//! The JSON Schema of species files, from the same field descriptions that the reader uses. Editors
//! complete and check with it; the rules that join several values are the reader's alone.

use super::coat::COAT;
use super::fields;
use super::pattern::PATTERN;
use super::shape::{Choice, Field, Kind, Presence, Range, Shape};
use crate::scene_file::SCENE;
use serde_json::{Map, Value, json};

/// The schema (draft 2020-12).
pub fn json_schema() -> Value {
    let mut definitions = Map::new();
    let class = reference(&fields::CLASS, &mut definitions);
    let mut root = root_schema(&fields::SPECIES, "Vair species", definitions);
    // Every key that is not of the root is a hair class.
    root["additionalProperties"] = class;
    root
}

/// The schema of pattern recipes (draft 2020-12).
pub fn pattern_schema() -> Value {
    root_schema(&PATTERN, "Vair scale pattern", Map::new())
}

/// The schema of coat recipes (draft 2020-12).
pub fn coat_schema() -> Value {
    root_schema(&COAT, "Vair coat", Map::new())
}

/// The schema of scene files (draft 2020-12).
pub fn scene_schema() -> Value {
    root_schema(&SCENE, "Vair scene", Map::new())
}

fn root_schema(shape: &Shape, title: &str, mut definitions: Map<String, Value>) -> Value {
    let mut root = table(shape, &mut definitions);
    root["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    root["title"] = json!(title);
    definitions.insert("source".to_owned(), source());
    root["$defs"] = Value::Object(definitions);
    root
}

fn table(shape: &Shape, definitions: &mut Map<String, Value>) -> Value {
    let mut properties = Map::new();
    for field in shape.fields {
        properties.insert(field.key.to_owned(), property(field, definitions));
    }
    let required: Vec<&str> = shape
        .fields
        .iter()
        .filter(|f| f.presence == Presence::Required)
        .map(|f| f.key)
        .collect();
    let mut table = json!({
        "type": "object",
        "description": shape.doc,
        "required": required,
        "additionalProperties": false,
    });
    if shape.cited {
        cite(&mut properties);
        table["not"] = json!({ "required": ["source", "estimate"] });
    }
    table["properties"] = Value::Object(properties);
    table
}

fn property(field: &Field, definitions: &mut Map<String, Value>) -> Value {
    let mut value = match &field.kind {
        Kind::Text(limit) => text(*limit),
        Kind::Texts(most, limit) => json!({
            "type": "array",
            "maxItems": most,
            "uniqueItems": true,
            "items": text(*limit),
        }),
        Kind::Names => json!({
            "type": "array",
            "minItems": 1,
            "maxItems": 8,
            "uniqueItems": true,
            "items": { "type": "string", "pattern": "^[a-z][a-z0-9-]{0,31}$" },
        }),
        Kind::Sources => json!({ "type": "object", "additionalProperties": text(1000) }),
        Kind::Number(range) => cited(number("number", *range)),
        Kind::Whole(range) => cited(number("integer", *range)),
        Kind::Numbers(count, range) => cited(numbers(*count, *range)),
        Kind::Settings(count, range) => numbers(*count, *range),
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Setting(range) => number("number", *range),
        Kind::Count(range) => number("integer", *range),
        Kind::Points(most, range) => json!({
            "type": "array",
            "minItems": 2,
            "maxItems": most,
            "items": numbers(3, *range),
        }),
        Kind::Words(choices) => {
            json!({ "type": "object", "additionalProperties": one_of(choices) })
        }
        Kind::Choice(choices) => one_of(choices),
        Kind::ChoiceOrFile(choices) => json!({
            "anyOf": [one_of(choices), { "type": "string", "pattern": "\\.toml$" }],
        }),
        Kind::Color(range) => {
            let number = number("number", *range);
            let three =
                json!({ "type": "array", "minItems": 3, "maxItems": 3, "items": number.clone() });
            cited(json!({ "anyOf": [number, three] }))
        }
        Kind::Table(shape) => reference(shape, definitions),
        Kind::Tables(shape, most) => json!({
            "type": "array",
            "minItems": 1,
            "maxItems": most,
            "items": reference(shape, definitions),
        }),
    };
    value["description"] = json!(field.doc);
    value
}

fn one_of(choices: &[Choice]) -> Value {
    let of = |c: &Choice| json!({ "const": c.name, "description": c.doc });
    json!({ "oneOf": choices.iter().map(of).collect::<Vec<_>>() })
}

fn reference(shape: &Shape, definitions: &mut Map<String, Value>) -> Value {
    if !definitions.contains_key(shape.name) {
        let definition = table(shape, definitions);
        definitions.insert(shape.name.to_owned(), definition);
    }
    json!({ "$ref": format!("#/$defs/{}", shape.name) })
}

fn numbers(count: usize, range: Range) -> Value {
    json!({
        "type": "array",
        "minItems": count,
        "maxItems": count,
        "items": number("number", range),
    })
}

fn number(kind: &str, range: Range) -> Value {
    let mut number = json!({ "type": kind, "minimum": range.min, "maximum": range.max });
    if !range.unit.is_empty() {
        number["$comment"] = json!(range.unit);
    }
    number
}

/// A value by itself, or with its origin beside it.
fn cited(bare: Value) -> Value {
    let mut properties = Map::new();
    properties.insert("value".to_owned(), bare.clone());
    cite(&mut properties);
    json!({
        "anyOf": [
            bare,
            {
                "type": "object",
                "required": ["value"],
                "not": { "required": ["source", "estimate"] },
                "additionalProperties": false,
                "properties": properties,
            },
        ],
    })
}

fn cite(properties: &mut Map<String, Value>) {
    properties.insert("source".to_owned(), json!({ "$ref": "#/$defs/source" }));
    properties.insert("estimate".to_owned(), text(1000));
    properties.insert("note".to_owned(), text(1000));
}

fn source() -> Value {
    let key = json!({ "type": "string", "description": "a key of `sources`" });
    json!({ "anyOf": [key, { "type": "array", "minItems": 1, "items": key }] })
}

fn text(limit: usize) -> Value {
    json!({ "type": "string", "minLength": 1, "maxLength": limit })
}

#[cfg(test)]
mod tests {
    /// To renew the file: `cargo run --release -- schema species > schemas/species.schema.json`.
    #[test]
    fn committed_file_is_the_schema() {
        let committed = include_str!("../../schemas/species.schema.json");
        assert_eq!(committed, format!("{:#}\n", super::json_schema()));
    }

    /// To renew the file: `cargo run --release -- schema pattern > schemas/pattern.schema.json`.
    #[test]
    fn committed_pattern_file_is_the_schema() {
        let committed = include_str!("../../schemas/pattern.schema.json");
        assert_eq!(committed, format!("{:#}\n", super::pattern_schema()));
    }

    /// To renew the file: `cargo run --release -- schema coat > schemas/coat.schema.json`.
    #[test]
    fn committed_coat_file_is_the_schema() {
        let committed = include_str!("../../schemas/coat.schema.json");
        assert_eq!(committed, format!("{:#}\n", super::coat_schema()));
    }

    /// To renew the file: `cargo run --release -- schema scene > schemas/scene.schema.json`.
    #[test]
    fn committed_scene_file_is_the_schema() {
        let committed = include_str!("../../schemas/scene.schema.json");
        assert_eq!(committed, format!("{:#}\n", super::scene_schema()));
    }
}
