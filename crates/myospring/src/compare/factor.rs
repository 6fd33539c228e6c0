//! Factors on the numbers of a run.

use crate::settings::{Kind, Named, Problem, Run, Value, find, table};
use crate::units;
use serde::Serialize;

const PARAMETERS: &str = "cell.parameters";
/// How many names are offered for one that does not exist, and how alike they have to be.
const OFFERED: usize = 3;
const ALIKE: f64 = 0.7;

/// A number of a run by its name, and what it is multiplied by.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    /// A parameter of the cell model (`tau_si`) or a setting with a number (`peak_tension`, `material.thickness`).
    pub name: String,
    /// Finite; 1 changes nothing.
    pub factor: f64,
}

/// A number of a run that was multiplied.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scaled {
    /// Its key in a run file: `cell.parameters.tau_si`.
    pub key: String,
    /// Unit of both values; empty for a pure number.
    pub unit: String,
    /// What it was multiplied by.
    pub factor: f64,
    /// The value before.
    pub before: f64,
    /// The value after.
    pub after: f64,
}

/// Why a factor was not read or not applied.
#[derive(Debug, thiserror::Error)]
pub enum FactorError {
    /// Not of the form name=factor.
    #[error("`{text}` is no factor; write a name and a number, like tau_si=1.2")]
    Syntax {
        /// What was written.
        text: String,
    },
    /// No number of the run has that name.
    #[error(
        "`{name}` is neither a parameter of the cell model {model} nor a setting with a number{}",
        offered(nearest)
    )]
    Unknown {
        /// What was asked for.
        name: String,
        /// The model whose parameters were looked at.
        model: String,
        /// The names most like it, the likest first.
        nearest: Vec<String>,
    },
    /// Several numbers have that name.
    #[error("`{name}` may be any of: {}; write which", keys.join(", "))]
    Several {
        /// What was asked for.
        name: String,
        /// Their keys.
        keys: Vec<String>,
    },
    /// The run decides the value itself.
    #[error("`{key}` has no value in this run that could be multiplied; give it one")]
    NoValue {
        /// The key.
        key: String,
    },
    /// The product is none of its values.
    #[error("{key} times {factor}: {problem}")]
    Refused {
        /// The key.
        key: String,
        /// The factor.
        factor: f64,
        /// What is wrong with it.
        problem: Problem,
    },
}

fn offered(nearest: &[String]) -> String {
    if nearest.is_empty() {
        String::new()
    } else {
        format!("; the nearest are {}", nearest.join(", "))
    }
}

/// Reads factors as they are written on a command line.
///
/// # Errors
/// What is not `name=number`.
///
/// # Example
/// ```
/// use myospring::compare::factor;
/// let factors = factor::parse("peak_tension=0.7, tau_si=1.2")?;
/// assert_eq!((factors[1].name.as_str(), factors[1].factor), ("tau_si", 1.2));
/// # Ok::<(), factor::FactorError>(())
/// ```
pub fn parse(text: &str) -> Result<Vec<Factor>, FactorError> {
    let one = |part: &str| {
        let (name, factor) = part.split_once('=')?;
        let factor = factor.trim().parse::<f64>().ok().filter(|factor| factor.is_finite())?;
        let name = name.trim().to_owned();
        (!name.is_empty()).then_some(Factor { name, factor })
    };
    let syntax = |part: &str| FactorError::Syntax { text: part.trim().to_owned() };
    text.split(',').map(|part| one(part).ok_or_else(|| syntax(part))).collect()
}

/// Multiplies numbers of a run, one after the other, and says what became of each.
///
/// # Errors
/// A name that is none, or several; a product outside the bounds.
///
/// # Example
/// ```
/// use myospring::compare::factor;
/// use myospring::settings::Run;
/// let mut run = Run::default_run();
/// factor::scale(&mut run, &factor::parse("peak_tension=0.6,tau_si=1.02")?)?;
/// assert_eq!(run.peak_tension, 30.0);
///
/// let unknown = factor::scale(&mut run, &factor::parse("tau_sii=2")?).unwrap_err().to_string();
/// assert!(unknown.contains("the nearest are tau_si"), "{unknown}");
/// # Ok::<(), factor::FactorError>(())
/// ```
pub fn scale(run: &mut Run, factors: &[Factor]) -> Result<Vec<Scaled>, FactorError> {
    factors.iter().map(|Factor { name, factor }| scale_one(run, name, *factor)).collect()
}

fn scale_one(run: &mut Run, name: &str, factor: f64) -> Result<Scaled, FactorError> {
    let key = key_of(run, name)?;
    let refused = |problem| FactorError::Refused { key: key.clone(), factor, problem };
    let no_value = || FactorError::NoValue { key: key.clone() };
    if let Some(parameter) = key.strip_prefix(PARAMETERS).and_then(|rest| rest.strip_prefix('.')) {
        let rows = run.cell.parameters().rows();
        let row = rows.iter().find(|row| row.name == parameter).ok_or_else(no_value)?;
        let (before, unit) = (row.value, row.unit.to_string());
        let after = before * factor;
        let value = Value::Named(Named::from([(parameter.to_owned(), Value::Number(after))]));
        let setting = find(PARAMETERS).ok_or_else(no_value)?;
        setting.set(run, &value).map_err(|(_, problem)| refused(problem))?;
        return Ok(Scaled { key, unit, factor, before, after });
    }
    let setting = find(&key).ok_or_else(no_value)?;
    let Kind::Quantity { bounds, get, .. } = setting.kind else { return Err(no_value()) };
    let before = get(run).ok_or_else(no_value)?;
    let after = before * factor;
    let value = Value::Text(units::format(after, bounds.dimension));
    setting.set(run, &value).map_err(|(_, problem)| refused(problem))?;
    Ok(Scaled { unit: bounds.dimension.unit().to_owned(), key, factor, before, after })
}

/// The key of a number by its name, or by its key.
fn key_of(run: &Run, name: &str) -> Result<String, FactorError> {
    let keys = keys(run);
    if keys.iter().any(|key| key == name) {
        return Ok(name.to_owned());
    }
    let mut found: Vec<String> = keys.iter().filter(|key| last(key) == name).cloned().collect();
    match found.len() {
        1 => Ok(found.remove(0)),
        0 => {
            let mut likest: Vec<(f64, &str)> = keys
                .iter()
                .map(|key| (strsim::jaro_winkler(&name.to_lowercase(), last(key)), last(key)))
                .filter(|(likeness, _)| *likeness > ALIKE)
                .collect();
            likest.sort_by(|a, b| b.0.total_cmp(&a.0));
            likest.dedup_by_key(|(_, name)| *name);
            let nearest = likest.into_iter().take(OFFERED).map(|(_, name)| name.to_owned());
            let model = run.cell.name().to_owned();
            Err(FactorError::Unknown { name: name.to_owned(), model, nearest: nearest.collect() })
        }
        _ => Err(FactorError::Several { name: name.to_owned(), keys: found }),
    }
}

/// Keys of all numbers of a run.
fn keys(run: &Run) -> Vec<String> {
    let settings = table().filter(|setting| matches!(setting.kind, Kind::Quantity { .. }));
    let rows = run.cell.parameters().rows().iter();
    let parameters = rows.map(|row| format!("{PARAMETERS}.{}", row.name));
    parameters.chain(settings.map(|setting| setting.key.to_owned())).collect()
}

fn last(key: &str) -> &str {
    key.rsplit_once('.').map_or(key, |(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_of_a_run_can_be_multiplied_by_one_and_stays_what_it_is() {
        let mut run = Run::default_run();
        let before = run.to_run_file();
        for key in keys(&run) {
            match scale(&mut run, &[Factor { name: key.clone(), factor: 1.0 }]) {
                Ok(scaled) => assert_eq!(scaled[0].before, scaled[0].after, "{key}"),
                Err(FactorError::NoValue { .. }) => {}
                Err(error) => panic!("{key}: {error}"),
            }
        }
        assert_eq!(run.to_run_file(), before);
    }

    #[test]
    fn what_cannot_be_says_why() {
        let mut run = Run::default_run();
        let mut said = |text: &str| {
            parse(text).and_then(|factors| scale(&mut run, &factors)).unwrap_err().to_string()
        };
        for (text, expected) in [
            ("peak_tension", "like tau_si=1.2"),
            ("peak_tension=many", "like tau_si=1.2"),
            ("peak_tension=inf", "like tau_si=1.2"),
            ("peak_tension=1000", "0 kPa to 500 kPa"),
            ("tau_s=1.1", "the nearest are tau_s"),
            ("peek_tension=0.5", "peak_tension"),
            ("zzz=1", "nor a setting with a number"),
            ("numerics.time_step=2", "has no value in this run"),
        ] {
            assert!(said(text).contains(expected), "{text}: {}", said(text));
        }
    }
}
