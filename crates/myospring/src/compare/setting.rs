//! Settings in which runs differ, and warnings about their comparison.

use crate::run_file::RunFile;
use crate::settings::{Value, table};
use serde::Serialize;

/// A key in which runs differ, and its value in each run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Different {
    /// Key in a run file: `stimulus.cycle_length`, `cell.parameters.tau_si`.
    pub key: String,
    /// Value in each run as text; `None` if a run does not state one, such as a parameter with its
    /// published value.
    pub values: Vec<Option<String>>,
}

/// Returns the keys in which resolved runs ([`crate::settings::Run::settled`]) differ, in the order
/// of the settings. Titles are ignored.
///
/// # Example
/// ```
/// use myospring::compare::setting;
/// use myospring::run_file::RunFile;
/// let run = |text: &str| Ok::<_, myospring::run_file::RunFileError>(RunFile::from_text(text)?.resolve()?.to_run_file());
/// let (weak, strong) = (run("title = \"a\"\n[cell]\npeak_tension = \"30 kPa\"")?, run("title = \"b\"")?);
/// let different = setting::different(&[&weak, &strong]);
/// assert_eq!(different.len(), 1);
/// assert_eq!(different[0].key, "cell.peak_tension");
/// assert_eq!(different[0].values, [Some("30 kPa".to_owned()), Some("50 kPa".to_owned())]);
/// # Ok::<(), myospring::run_file::RunFileError>(())
/// ```
pub fn different(runs: &[&RunFile]) -> Vec<Different> {
    let mut found = Vec::new();
    for setting in table().filter(|setting| setting.key != "title") {
        let values: Vec<Option<&Value>> = runs.iter().map(|run| run.get(setting.key)).collect();
        let names: Vec<&String> = values
            .iter()
            .filter_map(|value| match value {
                Some(Value::Named(rows)) => Some(rows.keys()),
                _ => None,
            })
            .flatten()
            .collect();
        if names.is_empty() {
            add(&mut found, setting.key.to_owned(), &values);
            continue;
        }
        let mut names = names;
        names.sort();
        names.dedup();
        for name in names {
            let inner: Vec<Option<&Value>> = values
                .iter()
                .map(|value| match value {
                    Some(Value::Named(rows)) => rows.get(name),
                    _ => None,
                })
                .collect();
            add(&mut found, format!("{}.{name}", setting.key), &inner);
        }
    }
    found
}

fn add(found: &mut Vec<Different>, key: String, values: &[Option<&Value>]) {
    if values.windows(2).any(|pair| pair[0] != pair[1]) {
        let written = |value: Option<&Value>| value.map(Value::written);
        found.push(Different { key, values: values.iter().copied().map(written).collect() });
    }
}

/// What runs should have in common, with the keys that determine it.
const COMMON: [(&str, &[&str]); 5] = [
    ("pacing", &["stimulus.", "run.duration"]),
    ("cell or mesh", &["shape.", "segmentation."]),
    ("cell model", &["cell.model"]),
    (
        "support",
        &[
            "mechanics.support",
            "mechanics.end_stretch",
            "mechanics.afterload",
            "mechanics.end_stiffness",
            "mechanics.bed_stiffness",
        ],
    ),
    ("numerics", &["numerics.", "cell.integrator", "cell.step", "cell.tolerance"]),
];

/// Largest number of settings of a kind that a warning lists; the table has all.
const SAID: usize = 4;

/// Key that is ignored: it follows from the material, and a converged run does not depend on it.
const CONSEQUENCE: &str = "numerics.time_step";

/// Returns warnings for users who compare metrics: runs that differ in pacing, cell, model, support
/// or numerics, with the keys and values.
pub fn warnings(different: &[Different], labels: &[&str]) -> Vec<String> {
    let mut warnings = Vec::new();
    for (what, prefixes) in COMMON {
        let of_kind = different.iter().filter(|different| {
            let key = different.key.as_str();
            key != CONSEQUENCE
                && prefixes.iter().any(|prefix| {
                    key == *prefix || prefix.ends_with('.') && key.starts_with(prefix)
                })
        });
        let mut said: Vec<String> = of_kind.map(|different| in_words(different, labels)).collect();
        if said.len() > SAID {
            let more = said.split_off(SAID - 1).len();
            said.push(format!("and {more} more settings"));
        }
        if !said.is_empty() {
            warnings.push(format!("the runs differ in their {what}: {}", said.join("; ")));
        }
    }
    warnings
}

/// Returns a value as text for users: numbers with at most six digits, and `none` for a missing
/// value.
///
/// # Example
/// ```
/// use myospring::compare::setting::shown;
/// assert_eq!(shown(Some("38.46153846153847 kPa")), "38.4615 kPa");
/// assert_eq!(shown(Some("long axis")), "long axis");
/// assert_eq!(shown(None), "none");
/// ```
pub fn shown(value: Option<&str>) -> String {
    let Some(value) = value else { return "none".to_owned() };
    let (number, unit) = value.split_once(' ').map_or((value, ""), |(number, unit)| (number, unit));
    let rounded = number.parse::<f64>().ok().filter(|number| number.is_finite());
    match rounded.and_then(|number| format!("{number:.5e}").parse::<f64>().ok()) {
        Some(number) => format!("{number} {unit}").trim_end().to_owned(),
        None => value.to_owned(),
    }
}

/// Returns a sentence such as `run.duration is 600 ms in A and 900 ms in B`.
fn in_words(different: &Different, labels: &[&str]) -> String {
    let mut parts: Vec<(String, Vec<&str>)> = Vec::new();
    for (value, label) in different.values.iter().zip(labels) {
        let value = shown(value.as_deref());
        match parts.iter_mut().find(|(other, _)| *other == value) {
            Some((_, with)) => with.push(label),
            None => parts.push((value, vec![label])),
        }
    }
    let parts: Vec<String> = parts
        .into_iter()
        .map(|(value, labels)| format!("{value} in {}", labels.join(", ")))
        .collect();
    format!("{} is {}", different.key, parts.join(" and "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settled(text: &str) -> RunFile {
        RunFile::from_text(text).unwrap().resolve().unwrap().to_run_file()
    }

    #[test]
    fn parameters_are_told_one_by_one_and_what_is_asked_for_is_no_warning() {
        let (control, changed) = (
            settled(""),
            settled("[cell]\npeak_tension = \"40 kPa\"\n[cell.parameters]\ntau_si = 1.8\n"),
        );
        let different = different(&[&control, &changed]);
        let keys: Vec<&str> = different.iter().map(|different| different.key.as_str()).collect();
        assert_eq!(keys, ["cell.peak_tension", "cell.parameters.tau_si"]);
        assert_eq!(different[1].values[0], None);
        assert_eq!(warnings(&different, &["a", "b"]), [""; 0]);
    }

    #[test]
    fn another_pacing_and_another_mesh_are_warned_about_with_what_else_differs() {
        let (one, other) = (
            settled(""),
            settled(
                "[stimulus]\nbeats = 2\ncycle_length = \"500 ms\"\n[shape]\nspacing = \"2 um\"\n",
            ),
        );
        let warnings = warnings(&different(&[&one, &other]), &["one", "<script>"]);
        assert_eq!(warnings.len(), 2, "{warnings:?}");
        assert!(warnings[0].starts_with("the runs differ in their pacing: "), "{}", warnings[0]);
        let said = "run.duration is 600 ms in one and 1100 ms in <script>";
        assert!(warnings[0].contains(said), "{}", warnings[0]);
        assert!(warnings[1].contains("shape.spacing is none in one and 2 um in <script>"));
    }
}
