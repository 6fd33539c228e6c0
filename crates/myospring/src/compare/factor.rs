//! Factors on numbers of a run.

use crate::settings::{NumberError, NumericSetting, Problem, Run};
use serde::Serialize;

/// Name of a number of a run, and the factor on it.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    /// A parameter of the cell model (`tau_si`) or a setting with a number (`peak_tension`, `material.thickness`).
    pub name: String,
    /// Factor, finite; 1 changes nothing.
    pub factor: f64,
}

/// A number of a run that was multiplied.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scaled {
    /// Key in a run file: `cell.parameters.tau_si`.
    pub key: String,
    /// Unit of both values; empty for a pure number.
    pub unit: String,
    /// Factor that was applied.
    pub factor: f64,
    /// The value before.
    pub before: f64,
    /// The value after.
    pub after: f64,
}

/// Why a factor was not read or not applied.
#[derive(Debug, thiserror::Error)]
pub enum FactorError {
    /// The text is not of the form name=factor.
    #[error("`{text}` is not a factor; write a name and a number, like tau_si=1.2")]
    Syntax {
        /// The text.
        text: String,
    },
    /// A number has two factors.
    #[error("`{name}` has two factors; give one, their product")]
    Twice {
        /// Name of the number.
        name: String,
    },
    /// The value is 0, which no factor changes.
    #[error("`{key}` is 0 in this run, so a factor has no effect; give it a value instead")]
    Zero {
        /// The key.
        key: String,
    },
    /// No number of the run has that name, or several numbers have it.
    #[error(transparent)]
    Name(#[from] NumberError),
    /// The run chooses the value itself.
    #[error("`{key}` has no value in this run that a factor could multiply; give it a value")]
    NoValue {
        /// The key.
        key: String,
    },
    /// The product is not a valid value.
    #[error("{key} times {factor}: {problem}")]
    Refused {
        /// The key.
        key: String,
        /// The factor.
        factor: f64,
        /// What is wrong with the product.
        problem: Problem,
    },
}

/// Reads factors from the text of a command line.
///
/// # Errors
/// A text that is not `name=number`, and a repeated name.
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
    let factors: Vec<Factor> = text
        .split(',')
        .map(|part| one(part).ok_or_else(|| syntax(part)))
        .collect::<Result<_, _>>()?;
    let last = |factor: &'_ Factor| factor.name.rsplit('.').next().map(str::to_owned);
    for (index, factor) in factors.iter().enumerate() {
        if factors[..index].iter().any(|before| last(before) == last(factor)) {
            return Err(FactorError::Twice { name: factor.name.clone() });
        }
    }
    Ok(factors)
}

/// Multiplies numbers of a run, one after the other, and returns their values before and after.
///
/// # Errors
/// An unknown or ambiguous name; a product outside the bounds.
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
    let number = NumericSetting::named(run, name)?;
    let key = || number.key.clone();
    let before = number.get(run).ok_or_else(|| FactorError::NoValue { key: key() })?;
    if before == 0.0 && factor != 1.0 {
        return Err(FactorError::Zero { key: key() });
    }
    let after = before * factor;
    let refused = |problem| FactorError::Refused { key: key(), factor, problem };
    number.set(run, after).map_err(refused)?;
    Ok(Scaled { key: number.key, unit: number.unit, factor, before, after })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_of_a_run_can_be_multiplied_by_one_and_stays_what_it_is() {
        let mut run = Run::default_run();
        // A tolerance that was multiplied is stated.
        run.numerics.cell = Some(run.cell_settings());
        let before = run.to_run_file();
        for NumericSetting { key, .. } in NumericSetting::all(&run) {
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
            ("beats=2", "`stimulus.beats` is a setting, but not a number"),
            ("rotate=2", "`shape.rotate` is 0 in this run"),
            ("u_rest=2", "`cell.parameters.u_rest` is 0 in this run"),
            ("peak_tension=0.5,cell.peak_tension=0.6", "`cell.peak_tension` has two factors"),
            ("numerics.time_step=2", "has no value in this run"),
        ] {
            assert!(said(text).contains(expected), "{text}: {}", said(text));
        }
    }
}
