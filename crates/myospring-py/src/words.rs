//! Messages in the words of Python: what the library says of run files and of the program's options, as arguments.

use crate::name::name;
use myospring::experiment::legible;
use myospring::settings::{Setting, ValueKind, table};
use myospring::units;
use pyo3::prelude::*;

/// Options of the program that are no settings: name, argument here, and words that may follow as a value. Those of an
/// empty argument have no counterpart: what they say is done by arrays.
const OF_TABLES: [(&str, &str, &[&str]); 38] = [
    ("--columns", "columns", &[]),
    ("--time", "time", &[]),
    ("--kind", "kind", &["contraction"]),
    ("--unit", "unit", &["%", "px"]),
    ("--time-unit", "time_unit", &["s", "ms", "us"]),
    ("--frame-rate", "frame_rate_per_s", &[]),
    ("--sheet", "sheets", &[]),
    ("--from", "from_ms", &[]),
    ("--to", "until_ms", &[]),
    ("--until", "until_ms", &[]),
    ("--stimulus-times", "stimulus_times_ms", &[]),
    ("--stimulus-period", "stimulus_period_ms", &[]),
    ("--stimulus-start", "stimulus_start_ms", &[]),
    ("--ignore-marks", "ignore_marks=True", &[]),
    ("--skip-gaps", "skip_gaps=True", &[]),
    ("--mean", "mean=True", &[]),
    ("--free", "free", &[]),
    ("--fix", "fix", &[]),
    ("--bounds", "bounds", &[]),
    ("--loaded", "loaded", &[]),
    ("--reference", "reference", &[]),
    ("--traction-error", "traction_error", &[]),
    ("--traction", "traction", &[]),
    ("--peak-shortening", "peak_shortening_pct", &[]),
    ("--recorded-calcium", "recorded_calcium", &[]),
    ("--calcium-rest", "calcium_rest_um", &[]),
    ("--calcium-peak", "calcium_peak_um", &[]),
    ("--force", "force=True", &[]),
    ("--outputs", "outputs", &["frames", "gif"]),
    ("--scale", "scale", &[]),
    ("--doses", "doses", &[]),
    ("--pattern", "pattern", &[]),
    ("--whole-frame", "whole_frame", &[]),
    ("--shard", "shard", &[]),
    ("--subset", "subset_um", &[]),
    ("--post-places", "posts", &[]),
    ("--layout", "", &["columns", "rows"]),
    ("--decimal", "", &["comma", "point"]),
];

/// What Python says otherwise of the folder of results, and of numbers, which have no unit there.
const OTHERWISE: [(&str, &str); 7] = [
    ("`myospring track --cell all`", "`track(..., cell=\"all\")`"),
    (" with --output DIR", ""),
    ("--output DIR names", "choose"),
    ("--output ", ""),
    ("give it with its unit, like --stimulus-period \"1 s\"", "give it in ms"),
    ("--smooth is", "smoothing_ms is"),
    (
        "--calcium-rest \"0.1 uM\" --calcium-peak \"0.6 uM\"",
        "calcium_rest_um=0.1, calcium_peak_um=0.6",
    ),
];

/// A message with the names of Python instead of those of run files and options.
pub(crate) fn in_python(message: &str) -> String {
    let mut message = legible::with_powers(message);
    for (said, in_python) in OTHERWISE {
        message = message.replace(said, in_python);
    }
    for setting in table() {
        message = message.replace(&format!("`{}`", setting.key), &format!("`{}`", name(setting)));
    }
    let mut text = String::new();
    let mut rest = message.as_str();
    while let Some(at) = rest.find("--") {
        let (before, from) = rest.split_at(at);
        let end =
            from[2..].find(|c: char| !(c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'));
        let (option, after) = from.split_at(end.map_or(from.len(), |end| 2 + end));
        text.push_str(before);
        let (argument, length) = argument(option, after);
        text.push_str(&argument);
        rest = &after[length..];
    }
    text + rest
}

/// An option with what follows it as an argument, and the length of the value that was taken.
fn argument(option: &str, after: &str) -> (String, usize) {
    let value = value_of(after);
    let none = |text: &str| (text.to_owned(), 0);
    if let Some(setting) = table().find(|it| it.option.is_some_and(|own| own.name == option)) {
        let name = name(setting);
        if matches!(setting.kind, ValueKind::Flag { .. }) {
            return (format!("{name}=True"), 0);
        }
        let Some((value, length)) = value else { return (name, 0) };
        return match in_its_unit(setting, value) {
            Some(value) => (format!("{name}={value}"), length),
            // A placeholder, such as N, or prose.
            None if value.chars().all(|c| c.is_ascii_uppercase() || c == ',') => (name, length),
            None => (name, 0),
        };
    }
    let Some((_, argument, words)) = OF_TABLES.iter().find(|(own, ..)| *own == option) else {
        return none(option);
    };
    let known = value.filter(|(value, _)| words.contains(&value.trim_matches('"')));
    match (argument.is_empty(), known, value) {
        (true, known, _) => ("give arrays".to_owned(), known.map_or(0, |(_, length)| length)),
        (false, Some((value, length)), _) => {
            (format!("{argument}=\"{}\"", value.trim_matches('"')), length)
        }
        (false, None, Some((value, length))) if value.parse::<f64>().is_ok() => {
            (format!("{argument}={value}"), length)
        }
        (false, None, Some((value, length))) if value.starts_with('"') => {
            (format!("{argument}={value}"), length)
        }
        _ => none(argument),
    }
}

/// The word or the quoted text after a blank, and its length with the blank.
fn value_of(after: &str) -> Option<(&str, usize)> {
    let text = after.strip_prefix(' ')?;
    let length = if let Some(quoted) = text.strip_prefix('"') {
        quoted.find('"')? + 2
    } else {
        let word = text.find([' ', ')', ';', '`', '\n']).unwrap_or(text.len());
        text[..word].trim_end_matches(['.', ',', ':']).len()
    };
    (length > 0).then(|| (&text[..length], length + 1))
}

/// A value as Python writes it; `None` for what is none.
fn in_its_unit(setting: &Setting, value: &str) -> Option<String> {
    let bare = value.trim_matches('"');
    match setting.kind {
        ValueKind::Quantity { bounds, .. } => {
            units::parse(bare, bounds.dimension).ok().map(|number| number.to_string())
        }
        ValueKind::Whole { .. } => bare.parse::<i64>().ok().map(|number| number.to_string()),
        ValueKind::Words { words, .. } => {
            words.iter().any(|word| word.name == bare).then(|| format!("\"{bare}\""))
        }
        _ if bare.parse::<f64>().is_ok() => Some(bare.to_owned()),
        _ if value.starts_with('"') || myospring::cell::model(bare).is_ok() => {
            Some(format!("\"{bare}\""))
        }
        _ => None,
    }
}

/// The same for Python, which passes on what its own layer and its tests say.
#[pyfunction]
#[pyo3(name = "in_python")]
pub(crate) fn said(message: &str) -> String {
    in_python(message)
}
