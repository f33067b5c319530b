//! The JSON Schema of what `vair check --json` prints.

use super::consumer::Consumer;
use super::rule::RULES;
use serde_json::{Value, json};

/// The schema (draft 2020-12).
pub fn json_schema() -> Value {
    let rules: Vec<&str> = RULES.iter().map(|r| r.id).collect();
    let consumers = Consumer::ALL.map(Consumer::name);
    let text = |what: &str| json!({ "type": "string", "description": what });
    let count = json!({ "type": "integer", "minimum": 0 });
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Findings of vair check",
        "type": "object",
        "additionalProperties": false,
        "required": ["files", "errors", "warnings", "notes", "findings", "refused"],
        "properties": {
            "files": { "type": "array", "items": text("a path as it was given") },
            "errors": count,
            "warnings": count,
            "notes": count,
            "findings": {
                "type": "array",
                "items": {
                    "type": "object",
                    "additionalProperties": false,
                    "required": ["rule", "severity", "consumers", "file", "prim", "attribute", "message", "remedy"],
                    "properties": {
                        "rule": { "enum": rules },
                        "severity": { "enum": ["error", "warning", "note"] },
                        "consumers": { "type": "array", "minItems": 1, "items": { "enum": consumers } },
                        "file": text("one of `files`"),
                        "prim": text("path of the prim, with the variants that are shown, or name of the grid; empty for the file itself"),
                        "attribute": text("attribute or field; empty for the prim itself"),
                        "message": text("what is wrong"),
                        "remedy": text("what to do"),
                    },
                },
            },
            "refused": {
                "type": "array",
                "items": {
                    "type": "object",
                    "additionalProperties": false,
                    "required": ["file", "message"],
                    "properties": {
                        "file": text("one of `files` that could not be looked at"),
                        "message": text("why"),
                    },
                },
            },
        },
    })
}

#[cfg(test)]
mod tests {
    /// To renew the file: `cargo run --release -- schema check > schemas/check.schema.json`.
    #[test]
    fn committed_file_is_the_schema() {
        let committed = include_str!("../../schemas/check.schema.json");
        assert_eq!(committed, format!("{:#}\n", super::json_schema()));
    }
}
