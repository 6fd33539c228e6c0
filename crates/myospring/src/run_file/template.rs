//! Template: a commented run file with every key and its default.

use super::file::written;
use super::rules::INTEGRATION;
use super::schema::described;
use crate::settings::{Run, Setting, tables};
use std::fmt::Write;

/// Returns a run file with every key, each with its meaning, unit and bounds. Keys with a default
/// have that value; the others are comments. Reading the template gives exactly the default run.
///
/// # Example
/// ```
/// use myospring::run_file::{RunFile, template};
/// let text = template();
/// assert!(text.contains("thickness = \"10 um\""));
/// let defaults = RunFile::default().resolve()?.to_run_file();
/// assert_eq!(RunFile::from_text(&text)?.resolve()?.to_run_file(), defaults);
/// # Ok::<(), myospring::run_file::RunFileError>(())
/// ```
pub fn template() -> String {
    let mut usual = Run::default_run().to_run_file();
    // Each model has its own way, also one that is put in.
    for key in INTEGRATION {
        usual.remove(key);
    }
    let mut text = String::from(
        "# Run file of Myospring: myospring run FILE.toml\n\
         # Every key may be left out; the values here are the defaults. Values carry their unit.\n",
    );
    for table in tables() {
        text.push('\n');
        if !table.name.is_empty() {
            let _ = writeln!(text, "{}[{}]", comment(table.doc), table.name);
        }
        for setting in table.settings {
            text.push_str(&comment(&about(setting)));
            let name = setting.name();
            let line = match (usual.get(setting.key), setting.example()) {
                (Some(default), _) => format!("{name} = {}\n", written(default)),
                (None, Some(example)) => format!("# {name} = {}\n", written(&example)),
                (None, None) => format!("# {name} = \"\"\n"),
            };
            text.push_str(&line);
        }
    }
    text
}

/// Returns the meaning, bounds and words of a key.
fn about(setting: &Setting) -> String {
    let mut about = described(setting);
    if let Some(bounds) = setting.bounds_in_words() {
        let _ = write!(about, " Bounds: {bounds}.");
    }
    let words = setting.words();
    if !words.is_empty() {
        let words: Vec<String> = words.iter().map(|word| format!("\"{}\"", word.name)).collect();
        let _ = write!(about, " One of {}.", words.join(", "));
    }
    about
}

/// Returns a text as comment lines of at most 100 characters.
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
