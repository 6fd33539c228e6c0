//! The JSON Schema of run files, made from the table of settings.

use crate::settings::{Kind, Setting, tables};
use serde_json::{Map, Value, json};

/// JSON Schema of run files, Draft 2020-12, with each quantity's unit (`x-unit`) and bounds
/// (`x-bounds`).
///
/// # Example
/// ```
/// let schema = myospring::run_file::schema();
/// let thickness = &schema["properties"]["material"]["properties"]["thickness"];
/// assert_eq!(thickness["x-unit"], "um");
/// assert_eq!(thickness["default"], "10 um");
/// ```
pub fn schema() -> Value {
    let mut properties = Map::new();
    for table in tables() {
        let rows: Map<String, Value> =
            table.settings.iter().map(|row| (row.name().to_owned(), of_setting(row))).collect();
        if table.name.is_empty() {
            properties.extend(rows);
            continue;
        }
        let schema = json!({
            "description": table.doc,
            "type": "object",
            "additionalProperties": false,
            "properties": rows,
        });
        properties.insert(table.name.to_owned(), schema);
    }
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Myospring run file",
        "description": "A run file as it is written: every key may be absent.",
        "type": "object",
        "additionalProperties": false,
        "properties": properties,
    })
}

fn of_setting(setting: &Setting) -> Value {
    let mut schema = Map::new();
    let mut insert = |name: &str, value: Value| schema.insert(name.to_owned(), value);
    insert("description", described(setting).into());
    insert("type", kind_of_value(setting));
    match setting.kind {
        Kind::Words { words, .. } => {
            let word =
                |word: &crate::settings::Word| json!({"const": word.name, "description": word.doc});
            insert("oneOf", words.iter().map(word).collect());
        }
        Kind::Whole { bounds, .. } => {
            insert("minimum", bounds.minimum.into());
            insert("maximum", bounds.maximum.into());
        }
        Kind::Named { .. } => {
            insert("additionalProperties", json!({"type": ["number", "string"]}));
        }
        Kind::Quantity { .. } | Kind::Written { .. } => {
            if let Some(unit) = setting.unit() {
                insert("x-unit", unit.into());
            }
            if let Some(bounds) = setting.bounds_in_words() {
                insert("x-bounds", bounds.into());
            }
        }
        Kind::Text { .. } | Kind::File { .. } | Kind::Flag { .. } => {}
    }
    if let Some(example) = setting.example() {
        insert("examples", json!([example]));
    }
    if let Some(default) = setting.default() {
        insert("default", json!(default));
    }
    schema.into()
}

/// What it is, and what happens where it is left out.
pub(super) fn described(setting: &Setting) -> String {
    match setting.otherwise {
        Some(otherwise) => format!("{} By default {otherwise}.", setting.doc),
        None => setting.doc.to_owned(),
    }
}

fn kind_of_value(setting: &Setting) -> Value {
    match setting.kind {
        Kind::Flag { .. } => "boolean".into(),
        Kind::Whole { .. } => "integer".into(),
        Kind::Named { .. } => "object".into(),
        Kind::Text { .. } | Kind::File { .. } | Kind::Words { .. } => "string".into(),
        Kind::Quantity { .. } | Kind::Written { .. } if setting.takes_numbers() => {
            json!(["number", "string"])
        }
        Kind::Quantity { .. } | Kind::Written { .. } => json!(["string"]),
    }
}
