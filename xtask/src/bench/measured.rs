//! What our own programs print: JSON lines with numbers.

use crate::tools::root;
use serde_json::Value;
use std::process::Command;

/// A program of `verification/examples` as built for release.
pub(super) fn example(name: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(root().join("target/release/examples").join(name));
    command.args(arguments);
    command
}

/// The JSON lines that a program prints.
pub(super) fn lines(command: &mut Command) -> Result<Vec<Value>, String> {
    let output = command.output().map_err(|error| format!("{command:?}: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        return Err(format!("{command:?}: {}", String::from_utf8_lossy(&output.stderr)));
    }
    text.lines()
        .filter(|line| line.starts_with('{'))
        .map(|line| serde_json::from_str(line).map_err(|error| format!("{command:?}: {error}")))
        .collect()
}

/// A number of the last line that a program prints.
pub(super) fn rate(command: &mut Command, key: &str) -> Result<f64, String> {
    let lines = lines(command)?;
    let line = lines.last().ok_or_else(|| format!("{command:?} printed no numbers"))?;
    number(line, key)
}

/// A number of a line.
pub(super) fn number(line: &Value, key: &str) -> Result<f64, String> {
    line[key].as_f64().ok_or_else(|| format!("no number `{key}` in {line}"))
}
