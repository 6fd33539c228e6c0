//! Keys, words and kinds of values against the JSON Schema of run files.

use super::error::Problem;
use super::reading::join;
use serde_json::Value as Schema;
use toml::{Table, Value};

type Failure = (String, Problem);

/// Checks a table and all below it; the failure names the key with its tables.
pub(super) fn table(schema: &Schema, table: &Table, path: &str) -> Result<(), Failure> {
    let properties = schema.get("properties").and_then(Schema::as_object);
    for (key, value) in table {
        let full = join(path, key);
        let known = properties.and_then(|rows| rows.get(key));
        let any = schema.get("additionalProperties").filter(|any| any.is_object());
        let Some(row) = known.or(any) else {
            let known: Vec<String> =
                properties.into_iter().flatten().map(|(name, _)| name.clone()).collect();
            let suggestion = nearest(key, known.iter().map(String::as_str)).map(str::to_owned);
            let (key, table) = (key.clone(), path.to_owned());
            return Err((full, Problem::UnknownKey { key, table, suggestion, known }));
        };
        check_value(row, value, &full)?;
    }
    Ok(())
}

fn check_value(schema: &Schema, value: &Value, path: &str) -> Result<(), Failure> {
    let fail = |problem| Err((path.to_owned(), problem));
    let key = path.to_owned();
    let kinds = kinds(schema);
    let wants = |kind: &str| kinds.contains(&kind);
    match value {
        Value::Float(value) if !value.is_finite() => {
            fail(Problem::NotFinite { key, value: *value })
        }
        Value::Table(inner) if wants("object") => table(schema, inner, path),
        Value::String(word) if wants("string") => {
            let words = words(schema);
            if words.is_empty() || words.contains(&word.as_str()) {
                return Ok(());
            }
            let suggestion = nearest(word, words.iter().copied()).map(str::to_owned);
            let known = words.into_iter().map(str::to_owned).collect();
            fail(Problem::UnknownWord { key, word: word.clone(), suggestion, known })
        }
        Value::Integer(number) if wants("integer") => {
            let bound = |name: &str| schema.get(name).and_then(Schema::as_i64);
            let (low, high) = (bound("minimum"), bound("maximum"));
            if low.is_some_and(|low| *number < low) || high.is_some_and(|high| *number > high) {
                let (low, high) = (low.unwrap_or(0), high.unwrap_or(i64::MAX));
                let wanted = format!("a whole number from {low} to {high}");
                return fail(Problem::Kind { key, found: number.to_string(), wanted });
            }
            Ok(())
        }
        // A bare number where a unit is needed goes on to the reader of units, which says so.
        Value::Float(_) | Value::Integer(_) if wants("number") || is_quantity(schema) => Ok(()),
        Value::Boolean(_) if wants("boolean") => Ok(()),
        other => {
            let wanted = match kinds.first().copied() {
                Some("object") => "a table",
                Some("integer") => "a whole number",
                Some("boolean") => "true or false",
                Some("number") => "a number",
                _ => "text in quotes",
            };
            let found = match other {
                Value::String(text) => format!("the text \"{text}\""),
                Value::Integer(number) => number.to_string(),
                Value::Float(number) => number.to_string(),
                Value::Boolean(truth) => truth.to_string(),
                Value::Datetime(date) => format!("the date {date}"),
                Value::Array(_) => "a list".to_owned(),
                Value::Table(_) => "a table".to_owned(),
            };
            fail(Problem::Kind { key, found, wanted: wanted.to_owned() })
        }
    }
}

fn is_quantity(schema: &Schema) -> bool {
    schema.get("x-unit").is_some()
}

/// The schema itself and the alternatives it offers.
fn branches(schema: &Schema) -> impl Iterator<Item = &Schema> {
    let offered = ["anyOf", "oneOf"].into_iter().filter_map(|name| schema.get(name)?.as_array());
    std::iter::once(schema).chain(offered.flatten().flat_map(|branch| {
        let deeper = ["anyOf", "oneOf"].into_iter().filter_map(|name| branch.get(name)?.as_array());
        std::iter::once(branch).chain(deeper.flatten())
    }))
}

/// The kinds of JSON value that a schema allows.
fn kinds(schema: &Schema) -> Vec<&str> {
    let mut kinds = Vec::new();
    for branch in branches(schema) {
        match branch.get("type") {
            Some(Schema::String(kind)) => kinds.push(kind.as_str()),
            Some(Schema::Array(several)) => kinds.extend(several.iter().filter_map(Schema::as_str)),
            _ => {}
        }
    }
    kinds.retain(|kind| *kind != "null");
    kinds
}

/// The words that a schema allows; none where it allows any text.
pub(super) fn words(schema: &Schema) -> Vec<&str> {
    let mut words = Vec::new();
    for branch in branches(schema) {
        words.extend(branch.get("const").and_then(Schema::as_str));
        let listed = branch.get("enum").and_then(Schema::as_array);
        words.extend(listed.into_iter().flatten().filter_map(Schema::as_str));
    }
    words
}

/// The known word that is most like a written one, if any is alike.
pub(super) fn nearest<'a>(written: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    known
        .map(|word| (strsim::jaro_winkler(&written.to_lowercase(), word), word))
        .filter(|(likeness, _)| *likeness > 0.8)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, word)| word)
}
