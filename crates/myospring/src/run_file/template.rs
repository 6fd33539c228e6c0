//! A commented run file with every key and its default.

use super::check::words;
use super::{RunFile, RunFileError, schema};
use serde_json::Value;
use std::fmt::Write;

/// A run file with every key: those with a default set to it, the others as a comment, each with
/// its meaning, unit and bounds. Read, it gives exactly the default run.
///
/// # Errors
/// None: it is made from the defaults.
///
/// # Example
/// ```
/// use myospring::run_file::{RunFile, template};
/// let text = template()?;
/// assert!(text.contains("thickness = \"10 um\""));
/// let defaults = RunFile::default().resolve()?.to_run_file();
/// assert_eq!(RunFile::from_text(&text)?.resolve()?.to_run_file(), defaults);
/// # Ok::<(), myospring::run_file::RunFileError>(())
/// ```
pub fn template() -> Result<String, RunFileError> {
    let defaults = RunFile::default().resolve()?.to_run_file();
    let defaults = serde_json::to_value(defaults).unwrap_or_default();
    let schema = schema();
    let mut text = String::from(
        "# Run file of Myospring: myospring run FILE.toml\n\
         # Every key may be left out; the values here are the defaults. Values carry their unit.\n",
    );
    for (name, row) in properties(&schema) {
        let values = &defaults[name];
        if properties(row).next().is_none() {
            text.push('\n');
            key(&mut text, name, row, values);
            continue;
        }
        let _ = write!(text, "\n{}[{name}]\n", comment(&describe(row)));
        for (key_name, row) in properties(row) {
            key(&mut text, key_name, row, &values[key_name]);
        }
    }
    Ok(text)
}

fn properties(schema: &Value) -> impl Iterator<Item = (&String, &Value)> {
    schema.get("properties").and_then(Value::as_object).into_iter().flatten()
}

/// One key: a comment, then the key with its default, or in a comment with an example.
fn key(text: &mut String, name: &str, schema: &Value, default: &Value) {
    let about = describe(schema);
    if !about.is_empty() {
        text.push_str(&comment(&about));
    }
    let example = schema.get("examples").and_then(|examples| examples.get(0));
    let line = match (default, example) {
        (Value::Null, Some(example)) => format!("# {name} = {example}"),
        (Value::Null, None) if name == "parameters" => {
            format!("# {name} = {{ tau_si = \"1.9 ms\" }}")
        }
        (Value::Null, None) if name == "authors_step" => format!("# {name} = true"),
        (Value::Null, None) => format!("# {name} = \"\""),
        (value, _) => format!("{name} = {value}"),
    };
    text.push_str(&line);
    text.push('\n');
}

/// Meaning, bounds and words of a key.
fn describe(schema: &Value) -> String {
    let mut about =
        schema.get("description").and_then(Value::as_str).unwrap_or_default().replace('\n', " ");
    if let Some(bounds) = schema.get("x-bounds").and_then(Value::as_str) {
        let _ = write!(about, " Bounds: {bounds}.");
    } else if let (Some(low), Some(high)) = (schema.get("minimum"), schema.get("maximum")) {
        let _ = write!(about, " Bounds: {low} to {high}.");
    }
    let words = words(schema);
    if !words.is_empty() {
        let words: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
        let _ = write!(about, " One of {}.", words.join(", "));
    }
    about
}

/// Text as comment lines of at most 100 characters.
fn comment(text: &str) -> String {
    let mut lines = String::new();
    let mut line = String::from("#");
    for word in text.split_whitespace() {
        if line.chars().count() + word.chars().count() >= 100 {
            lines.push_str(&line);
            lines.push('\n');
            line = String::from("#");
        }
        line.push(' ');
        line.push_str(word);
    }
    lines + &line + "\n"
}
