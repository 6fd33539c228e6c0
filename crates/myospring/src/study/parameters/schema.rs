//! The JSON Schema of descriptions of studies.

use crate::analysis::beats::known;
use crate::run_file;
use crate::study::sampling::Sampler;
use serde_json::{Map, Value, json};

/// JSON Schema of descriptions of studies, Draft 2020-12; `[run]` has that of run files.
///
/// # Example
/// ```
/// let schema = myospring::study::parameters::schema();
/// assert_eq!(schema["required"], serde_json::json!(["sampling"]));
/// assert!(schema["$defs"]["run"]["properties"]["cell"].is_object());
/// ```
pub fn schema() -> Value {
    let mut run = run_file::schema();
    // It is part of this one.
    if let Some(run) = run.as_object_mut() {
        for key in ["$schema", "$id"] {
            run.remove(key);
        }
    }
    let metrics: Vec<&str> = known(true).iter().map(|metric| metric.name).collect();
    // Cells have further metrics, such as the peak of calcium of ToR-ORd.
    let metric = json!({"type": "string", "examples": metrics});
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": run_file::schema_id("study"),
        "title": "Myospring study",
        "description": "The description of a study, as `myospring study run` takes it.",
        "type": "object",
        "additionalProperties": false,
        "required": ["sampling"],
        "properties": {
            "title": {"type": "string", "description": "For people."},
            "kind": {
                "description": "What every member is.",
                "oneOf": [
                    {"const": "beat", "description": "A cell that beats: electrical activity, tension and shape."},
                    {"const": "cell", "description": "Action potential and tension only, many cells side by side."},
                ],
                "default": "beat",
            },
            "metrics": {
                "type": "array",
                "items": metric,
                "description": "Which metrics are wanted; left out, the usual ones.",
            },
            "beat": {
                "enum": ["first", "last", "mean"],
                "default": "last",
                "description": "Which beat's metrics count, where a run has several.",
            },
            "run": {
                "description": "What all members have in common: the name of a run file, or its tables.",
                "type": ["string", "object"],
                // Not `oneOf`, so that errors are reported at their place.
                "if": {"type": "object"},
                "then": {"$ref": "#/$defs/run"},
            },
            "parameters": {
                "type": "object",
                "description": "What varies: parameters of the cell model by name, settings by name or key.",
                "additionalProperties": {"$ref": "#/$defs/distribution"},
            },
            "sampling": sampling(),
            "keep": {
                "type": "object",
                "description": "Which members are kept, by bands of metrics.",
                "additionalProperties": {
                    "type": "array",
                    "items": {"type": "number"},
                    "minItems": 2,
                    "maxItems": 2,
                },
            },
            "traces": {"type": "boolean", "description": "Whether the curves of each member are kept."},
        },
        "$defs": {"run": run, "distribution": distribution()},
    })
}

/// One of several tables, distinguished by the word under `key`; each has required and optional
/// numbers.
fn one_of(key: &str, rows: &[(&str, &[&str], &[&str])], number: &Value, common: &Value) -> Value {
    let table = |(word, needs, may): &(&str, &[&str], &[&str])| {
        let mut properties: Map<String, Value> = common.as_object().cloned().unwrap_or_default();
        properties.insert(key.to_owned(), json!({"const": word}));
        for name in needs.iter().chain(*may) {
            properties.entry((*name).to_owned()).or_insert_with(|| number.clone());
        }
        let required: Vec<&str> = std::iter::once(key).chain(needs.iter().copied()).collect();
        json!({"properties": properties, "required": required, "additionalProperties": false})
    };
    json!({"type": "object", "oneOf": rows.iter().map(table).collect::<Vec<_>>()})
}

fn distribution() -> Value {
    let number = json!({
        "type": ["number", "string"],
        "description": "In the parameter's own unit, or with one: \"45 kPa\".",
    });
    let common = json!({
        "relative": {"type": "boolean", "description": "Whether numbers are factors of the usual value."},
    });
    let rows: [(&str, &[&str], &[&str]); 5] = [
        ("fixed", &["value"], &[]),
        ("uniform", &["low", "high"], &[]),
        ("log-uniform", &["low", "high"], &[]),
        ("normal", &["mean", "standard_deviation"], &[]),
        ("lognormal", &["median", "log_standard_deviation"], &[]),
    ];
    one_of("distribution", &rows, &number, &common)
}

fn sampling() -> Value {
    let whole = json!({"type": "integer", "minimum": 1});
    let own = json!({
        "seed": {"type": "integer", "minimum": 0, "description": "Decides everything random."},
        "pairs": {"type": "boolean", "description": "Whether interactions of pairs are wanted, too."},
        "file": {"type": "string", "description": "A CSV with a column for each parameter."},
    });
    let more = Sampler::KEYS.map(|(_, _, more)| [more, &["seed"][..]].concat());
    let samplers =
        Sampler::KEYS.iter().zip(&more).map(|((word, keys, _), more)| (*word, *keys, &**more));
    let rows: Vec<(&str, &[&str], &[&str])> =
        samplers.chain([("table", &["file"] as &[&str], &[] as &[&str])]).collect();
    let mut tables = one_of("sampler", &rows, &whole, &json!({}));
    for (row, table) in rows.iter().zip(tables["oneOf"].as_array_mut().into_iter().flatten()) {
        for name in row.1.iter().chain(row.2).filter(|name| own[**name].is_object()) {
            table["properties"][*name] = own[*name].clone();
        }
    }
    tables["description"] = "The number of members, and how their values are chosen.".into();
    tables
}
