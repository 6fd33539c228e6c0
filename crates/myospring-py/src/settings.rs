//! The table of settings, as Python names them: whole words with the unit at the end, `peak_tension_kpa`.

use crate::errors;
use crate::name::name;
use myospring::cell;
use myospring::run_file::RunFile;
use myospring::settings::{FromFile, Models, Run, Setting, Value, ValueKind, table, tables};
use myospring::units;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString, PyTuple};
use std::collections::BTreeMap;

/// The setting of a name in Python, among those of some tables.
pub(crate) fn find(name_in_python: &str) -> Option<&'static Setting> {
    // Where two tables have one name, that of the beat comes first.
    let mut found: Vec<&Setting> =
        table().filter(|setting| name(setting) == name_in_python).collect();
    found.sort_by_key(|setting| is_of_cell(setting));
    found.first().copied()
}

/// Whether a setting says what the cell is, and not how it beats.
pub(crate) fn is_of_cell(setting: &Setting) -> bool {
    ["shape.", "segmentation."].iter().any(|table| setting.key.starts_with(table))
}

/// The settings that Python gave, by key.
///
/// # Errors
/// A name that does not exist, or a value of the wrong kind.
pub(crate) fn list(given: &Bound<'_, PyDict>) -> PyResult<Vec<(&'static Setting, Value)>> {
    let py = given.py();
    let one = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let key: String = key.extract()?;
        let Some(setting) = table().find(|setting| setting.key == key) else {
            return Err(errors::unknown(py, format!("there is no setting `{key}`")));
        };
        Ok((setting, read(setting, &value)?))
    };
    given.iter().map(one).collect()
}

/// Puts what Python gave into a run file, by key.
///
/// # Errors
/// Those of [`list`], and a value that is not possible.
pub(crate) fn put(file: &mut RunFile, given: &Bound<'_, PyDict>) -> PyResult<()> {
    put_all(given.py(), file, list(given)?)
}

/// Writes settings into a run file.
pub(crate) fn put_all(
    py: Python<'_>,
    file: &mut RunFile,
    settings: Vec<(&'static Setting, Value)>,
) -> PyResult<()> {
    for (setting, value) in settings {
        file.set(setting.key, value).map_err(|error| errors::of_settings(py, &error))?;
    }
    Ok(())
}

/// A number in the setting's own unit, as it is written in a run file.
pub(crate) fn number(setting: &Setting, number: f64) -> Value {
    match setting.kind {
        ValueKind::Quantity { bounds, .. } if bounds.dimension != units::Dimension::Number => {
            Value::Text(units::format(number, bounds.dimension))
        }
        ValueKind::Whole { .. } if number.fract() == 0.0 => Value::Whole(number as i64),
        _ => Value::Number(number),
    }
}

/// Whether a value is True or False, of Python or NumPy, which Python takes for 1 and 0.
fn is_truth(value: &Bound<'_, PyAny>) -> bool {
    let named = |name: &Bound<'_, PyString>| {
        name.to_str().is_ok_and(|name| matches!(name, "bool" | "bool_"))
    };
    value.get_type().name().is_ok_and(|name| named(&name))
}

/// A number.
fn float(value: &Bound<'_, PyAny>) -> Option<f64> {
    value.extract().ok().filter(|_| !is_truth(value))
}

fn read(setting: &Setting, value: &Bound<'_, PyAny>) -> PyResult<Value> {
    let wrong = |wanted: &str| {
        let found = value.get_type().name().map_or_else(|_| String::new(), |name| name.to_string());
        Err(PyTypeError::new_err(format!("`{}` is of type {found}; give {wanted}", name(setting))))
    };
    Ok(match setting.kind {
        ValueKind::Flag { .. } => match value.extract() {
            Ok(flag) => Value::Flag(flag),
            Err(_) => return wrong("True or False"),
        },
        ValueKind::Whole { .. } => match value.extract() {
            Ok(whole) if !is_truth(value) => Value::Whole(whole),
            _ => return wrong("a whole number"),
        },
        ValueKind::Quantity { .. } => {
            let Some(given) = float(value) else {
                let unit = setting.unit().filter(|unit| !unit.is_empty());
                return wrong(
                    &unit.map_or("a number".to_owned(), |unit| format!("a number in {unit}")),
                );
            };
            // As text it could not be told from a unit.
            if !given.is_finite() {
                let message = format!("`{}` = {given} is not a finite number", name(setting));
                return Err(errors::value(message));
            }
            number(setting, given)
        }
        ValueKind::Named { .. } => {
            let Ok(rows) = value.cast::<PyDict>() else { return wrong("a dict of name to number") };
            let mut named = BTreeMap::new();
            for (name, value) in rows {
                let value = match float(&value) {
                    Some(number) => Value::Number(number),
                    None => match value.extract() {
                        Ok(text) => Value::Text(text),
                        Err(_) => return wrong("a dict of name to number"),
                    },
                };
                named.insert(name.extract()?, value);
            }
            Value::Named(named)
        }
        ValueKind::Text { .. }
        | ValueKind::NameOrFile { .. }
        | ValueKind::File { .. }
        | ValueKind::Words { .. }
        | ValueKind::Written { .. } => {
            if let Ok(text) = value.extract::<String>() {
                Value::Text(text)
            } else if let Ok(place) = value.extract::<(f64, f64)>() {
                Value::Text(format!("{}, {}", place.0, place.1))
            } else if is_truth(value) {
                return wrong("text");
            } else if let Ok(whole) = value.extract::<i64>() {
                if setting.takes_numbers() && setting.bounds().is_some() {
                    Value::Number(whole as f64)
                } else {
                    Value::Text(whole.to_string())
                }
            } else if let Some(number) = float(value) {
                Value::Number(number)
            } else {
                return wrong("text");
            }
        }
    })
}

/// A value of a setting as Python has it: a number in the unit of its name, text, or a flag.
fn to_python<'py>(
    py: Python<'py>,
    setting: &Setting,
    value: &Value,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    Ok(Some(match (setting.kind, value) {
        (ValueKind::Quantity { bounds, .. }, value) => {
            let text = match value {
                Value::Text(text) => text.clone(),
                other => other.to_string(),
            };
            let number = units::parse(&text, bounds.dimension).map_err(errors::value)?;
            PyFloat::new(py, number).into_any()
        }
        (_, Value::Flag(flag)) => PyBool::new(py, *flag).to_owned().into_any(),
        (_, Value::Whole(number)) => PyInt::new(py, *number).into_any(),
        (_, Value::Number(number)) => PyFloat::new(py, *number).into_any(),
        (_, Value::Text(text)) => PyString::new(py, text).into_any(),
        (_, Value::Named(_)) => return Ok(None),
    }))
}

/// Whether a setting's default hangs on other settings, so that leaving it out is not the same as giving what it
/// is by default.
fn depends(setting: &Setting) -> bool {
    let Some(default) = setting.default() else { return true };
    let written = |file: &RunFile| Some(file.resolve().ok()?.to_run_file());
    table().any(|other| {
        let words = other.words().iter().map(|word| Value::from(word.name));
        let models = cell::models().into_iter().map(|model| Value::from(model.name()));
        let models = models.filter(|_| other.key == "cell.model");
        let values = other.example().into_iter().chain(words).chain(models);
        other.key != setting.key
            && !is_of_cell(other)
            && values.into_iter().any(|value| {
                let mut without = RunFile::default();
                if without.set(other.key, value).is_err() {
                    return false;
                }
                let mut with = without.clone();
                if with.set(setting.key, default.clone()).is_err() {
                    return false;
                }
                matches!((written(&without), written(&with)), (Some(a), Some(b)) if a != b)
            })
    })
}

/// Every setting, in the order in which it is shown: a dict each.
#[pyfunction]
pub(crate) fn settings(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let rows = tables().iter().flat_map(|table| table.settings.iter().map(move |row| (table, row)));
    let usual = Run::default_run();
    rows.map(|(table, setting)| {
        let row = PyDict::new(py);
        row.set_item("key", setting.key)?;
        row.set_item("table", table.name)?;
        row.set_item("name", name(setting))?;
        row.set_item("doc", setting.doc)?;
        row.set_item("otherwise", setting.otherwise)?;
        row.set_item("bounds", setting.bounds_in_words())?;
        row.set_item("words", PyTuple::new(py, setting.words().iter().map(|word| word.name))?)?;
        row.set_item("kind", kind(setting))?;
        row.set_item("unit", setting.unit())?;
        let default = match setting.kind {
            ValueKind::Flag { .. } => Some(Value::Flag(false)),
            _ if setting.otherwise.is_some() || depends(setting) => None,
            _ => setting.get(&usual),
        };
        let default = default.map(|value| to_python(py, setting, &value)).transpose()?.flatten();
        row.set_item("default", default)?;
        Ok(row)
    })
    .collect()
}

fn kind(setting: &Setting) -> &'static str {
    match setting.kind {
        ValueKind::Text { .. } => "text",
        ValueKind::NameOrFile { .. } => "name-or-file",
        ValueKind::File { .. } => "file",
        ValueKind::Words { .. } => "words",
        ValueKind::Flag { .. } => "flag",
        ValueKind::Whole { .. } => "whole",
        ValueKind::Quantity { .. } => "quantity",
        ValueKind::Written { .. } => "written",
        ValueKind::Named { .. } => "named",
    }
}

/// Names of the cell models.
#[pyfunction]
pub(crate) fn models() -> Vec<String> {
    cell::models().iter().map(|model| model.name().to_owned()).collect()
}

/// A parameter: name, value, unit, lowest and highest value, meaning, source.
type Row = (String, f64, String, f64, f64, String, String);

/// The parameters of a cell model: name, value, unit, lowest and highest value, meaning, source.
#[pyfunction]
#[pyo3(signature = (model, variables=None))]
pub(crate) fn parameters(
    py: Python<'_>,
    model: &str,
    variables: Option<&str>,
) -> PyResult<Vec<Row>> {
    let variables =
        variables.unwrap_or_default().parse().map_err(PyValueError::new_err::<String>)?;
    let how = FromFile { variables, myofilaments: None };
    let model = Models::default()
        .model(model, &how)
        .map_err(|problem| errors::of_problem(py, &problem.to_string(), &problem))?;
    let rows = model.parameters().rows().iter().map(|row| {
        (
            row.name.to_string(),
            row.value,
            row.unit.to_string(),
            row.minimum,
            row.maximum,
            row.meaning.to_string(),
            row.source.to_string(),
        )
    });
    Ok(rows.collect())
}
