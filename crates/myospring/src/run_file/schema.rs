//! JSON Schema of run files, generated from the table of settings.

use crate::cell;
use crate::mesh::built_in;
use crate::settings::{Setting, ValueKind, Word, tables};
use crate::units::Dimension;
use serde_json::{Map, Value, json};

/// Returns the JSON Schema of run files (Draft 2020-12) with each quantity's unit (`x-unit`) and
/// bounds (`x-bounds`).
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
        "$id": schema_id("run-file"),
        "title": "Myospring run file",
        "description": "A run file of Myospring; every key may be absent.",
        "type": "object",
        "additionalProperties": false,
        "properties": properties,
    })
}

/// Returns the identifier of a schema, made of its kind and the program's version.
pub fn schema_id(kind: &str) -> String {
    format!("urn:myospring:{kind}:{}", env!("CARGO_PKG_VERSION"))
}

/// Returns the pattern of a number with a unit: a symbol of the dimension, any common form of `µ`,
/// or a word such as `microns`.
fn pattern(dimension: Dimension) -> String {
    let number = r"^\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?\s*";
    if dimension == Dimension::Number {
        return format!("{number}%?\\s*$");
    }
    let symbol = |unit: &str| {
        let unit = unit.replace("^2", r"(\^?2|²)").replace("^3", r"(\^?3|³)");
        unit.split('/').map(micro).collect::<Vec<_>>().join(r"\s*/\s*")
    };
    let symbols: Vec<String> = dimension.symbols().map(symbol).collect();
    format!("{number}({}|[A-Za-z]{{4,}}[A-Za-z /]*)\\s*$", symbols.join("|"))
}

/// Returns `um` with each of the letters that stand for micro.
fn micro(unit: &str) -> String {
    match unit.strip_prefix('u').filter(|rest| !rest.is_empty()) {
        Some(rest) => format!("[u\u{b5}\u{3bc}]{rest}"),
        None => unit.to_owned(),
    }
}

/// Returns the names that a key accepts, if another list defines them.
fn names(setting: &Setting) -> Option<Vec<String>> {
    match setting.key {
        "cell.model" => Some(cell::models().iter().map(|it| it.name().to_owned()).collect()),
        "shape.built_in" => Some(built_in::CELLS.iter().map(|it| it.name.to_owned()).collect()),
        _ => None,
    }
}

fn of_setting(setting: &Setting) -> Value {
    let mut schema = Map::new();
    let mut insert = |name: &str, value: Value| schema.insert(name.to_owned(), value);
    insert("description", described(setting).into());
    insert("type", kind_of_value(setting));
    match setting.kind {
        ValueKind::Words { words, .. } => {
            insert("oneOf", list(words));
        }
        // The name of a file has a dot.
        ValueKind::File { words, .. } if !words.is_empty() => {
            insert("anyOf", json!([{"oneOf": list(words)}, {"pattern": "\\."}]));
        }
        ValueKind::Whole { bounds, .. } => {
            insert("minimum", bounds.minimum.into());
            insert("maximum", bounds.maximum.into());
        }
        ValueKind::Named { .. } => {
            insert("additionalProperties", json!({"type": ["number", "string"]}));
        }
        ValueKind::Quantity { .. } | ValueKind::Written { .. } => {
            if let Some(unit) = setting.unit() {
                insert("x-unit", unit.into());
            }
            if let Some(bounds) = setting.bounds_in_words() {
                insert("x-bounds", bounds.into());
            }
            if let ValueKind::Quantity { bounds, .. } = setting.kind {
                insert("pattern", pattern(bounds.dimension).into());
            }
        }
        ValueKind::NameOrFile { endings, .. } => {
            let file = format!("\\.({})$", endings.join("|"));
            let list = json!({"enum": names(setting)});
            insert("anyOf", json!([list, {"pattern": file}]));
        }
        ValueKind::Text { .. } | ValueKind::File { .. } | ValueKind::Flag { .. } => {}
    }
    if let (ValueKind::Text { .. }, Some(names)) = (setting.kind, names(setting)) {
        insert("enum", names.into());
    }
    if let Some(example) = setting.example() {
        insert("examples", json!([example]));
    }
    if let Some(default) = setting.default() {
        insert("default", json!(default));
    }
    schema.into()
}

/// Each word with its meaning.
fn list(words: &[Word]) -> Value {
    words.iter().map(|word| json!({"const": word.name, "description": word.doc})).collect()
}

/// Describes a setting and its default.
pub(super) fn described(setting: &Setting) -> String {
    match setting.otherwise {
        Some(otherwise) => format!("{} By default {otherwise}.", setting.doc),
        None => setting.doc.to_owned(),
    }
}

fn kind_of_value(setting: &Setting) -> Value {
    match setting.kind {
        ValueKind::Flag { .. } => "boolean".into(),
        ValueKind::Whole { .. } => "integer".into(),
        ValueKind::Named { .. } => "object".into(),
        ValueKind::Text { .. }
        | ValueKind::NameOrFile { .. }
        | ValueKind::File { .. }
        | ValueKind::Words { .. } => "string".into(),
        ValueKind::Quantity { .. } | ValueKind::Written { .. } if setting.takes_numbers() => {
            json!(["number", "string"])
        }
        ValueKind::Quantity { .. } | ValueKind::Written { .. } => json!(["string"]),
    }
}
