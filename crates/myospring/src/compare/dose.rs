//! Drugs and their doses: reads a file of `[[drug]]` blocks into a control and a series of doses.
//!
//! A block states which number of the run a drug changes, and how the change depends on the
//! concentration c, by the Hill equation (`mirams_2011`, there for the block of a channel):
//!
//! ```text
//! factor = 1 + maximal_effect c^hill / (ic50^hill + c^hill)
//! ```
//!
//! A maximal effect of -1 reduces the number to 0, one of 0.5 increases it by half. Blocks with the
//! same name describe one drug with several effects; `[[together]]` blocks give several drugs at
//! once, whose factors are multiplied.

use super::factor::Factor;
use crate::settings::read_toml;
use crate::units::{self, Dimension, UnitError};
use serde::Deserialize;
use std::fmt::Write as _;

/// Example of such a file.
pub const EXAMPLE: &str = "\
# A drug that weakens the cell by up to 80 %, half of that at 1 uM.
[[drug]]
name = \"blocker\"
parameter = \"peak_tension\"
concentration = [\"0.3 uM\", \"1 uM\", \"10 uM\"]
ic50 = \"1 uM\"
hill = 1.0               # 1 unless stated
maximal_effect = -0.8    # -1 unless stated: the parameter goes to 0
";

/// Example for ToR-ORd: two drugs that block channels, alone and together; one of them blocks two.
/// The numbers are invented.
pub const CHANNELS_EXAMPLE: &str = "[[drug]]
name = \"calcium blocker\"
parameter = \"P_Ca\"
concentration = [\"0.1 uM\", \"1 uM\"]
ic50 = \"1 uM\"

[[drug]]
name = \"calcium blocker\"
parameter = \"G_Kr\"
concentration = [\"0.1 uM\", \"1 uM\"]
ic50 = \"5 uM\"
hill = 1.2

[[drug]]
name = \"potassium blocker\"
parameter = \"G_Kr\"
concentration = \"10 nM\"
ic50 = \"10 nM\"

[[together]]
doses = [\"calcium blocker 1 uM\", \"potassium blocker 10 nM\"]
";

/// One dose, or the control: the factors on numbers of the run.
#[derive(Debug, Clone, PartialEq)]
pub struct Dose {
    /// Label for users: `blocker 1 uM`, `control`.
    pub label: String,
    /// Factors; empty for the control.
    pub factors: Vec<Factor>,
}

/// Why a file of doses was not read.
#[derive(Debug, thiserror::Error)]
pub enum DoseError {
    /// The text is not TOML.
    #[error("line {line}: {reason}")]
    Syntax {
        /// Line, counted from 1.
        line: usize,
        /// Message of the TOML reader.
        reason: String,
    },
    /// There is no `[drug]` or `[[drug]]` block, or there is anything else.
    #[error(
        "{found}; a file of doses has [[drug]] blocks, optionally [[together]] blocks, and nothing else, like\n\
         {EXAMPLE}"
    )]
    Blocks {
        /// What is wrong.
        found: String,
    },
    /// A block lacks a key or has an unknown one.
    #[error("drug {number}: {reason}")]
    Block {
        /// Number of the block, from 1.
        number: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// A concentration without its unit.
    #[error("drug {number}: `{key}`: {cause}; write it like \"1 uM\"")]
    Unit {
        /// Number of the block, from 1.
        number: usize,
        /// `concentration` or `ic50`.
        key: &'static str,
        /// What is wrong.
        cause: UnitError,
    },
    /// A number is outside its bounds.
    #[error("drug {number}: `{key}` = {value} is outside its bounds, {bounds}")]
    OutOfBounds {
        /// Number of the block, from 1.
        number: usize,
        /// The key.
        key: &'static str,
        /// The given value.
        value: String,
        /// The bounds in words.
        bounds: &'static str,
    },
    /// A dose of several drugs names a drug that the file does not have.
    #[error(
        "together {number}: `{text}` is not a dose of {known}; write the drug and a concentration, like \
         \"blocker 1 uM\""
    )]
    Together {
        /// Number of the block, from 1.
        number: usize,
        /// The text of the dose.
        text: String,
        /// Drugs of the file.
        known: String,
    },
    /// Blocks of one drug have different concentrations.
    #[error(
        "the blocks of `{name}` differ in their concentrations; give all blocks of a drug the same ones"
    )]
    Concentrations {
        /// The drug.
        name: String,
    },
}

/// A block of the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Block {
    name: Option<String>,
    parameter: String,
    /// One concentration or several.
    concentration: toml::Value,
    ic50: toml::Value,
    #[serde(default = "one")]
    hill: f64,
    #[serde(default = "minus_one")]
    maximal_effect: f64,
}

/// A block of several drugs at once.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Together {
    doses: Vec<String>,
}

fn one() -> f64 {
    1.0
}

fn minus_one() -> f64 {
    -1.0
}

/// A drug: its name, its concentrations in uM and its effects.
struct Drug {
    name: String,
    concentrations: Vec<f64>,
    effects: Vec<Effect>,
}

struct Effect {
    parameter: String,
    ic50: f64,
    hill: f64,
    maximal: f64,
}

impl Effect {
    /// Returns the factor on the number at a concentration in uM.
    fn factor(&self, concentration: f64) -> f64 {
        if concentration <= 0.0 {
            return 1.0;
        }
        // c^h/(i^h + c^h), rearranged so that powers do not overflow.
        1.0 + self.maximal / (1.0 + (self.ic50 / concentration).powf(self.hill))
    }
}

impl Drug {
    /// Returns the factors of all effects at a concentration in uM.
    fn factors(&self, concentration: f64) -> Vec<Factor> {
        let factor = |effect: &Effect| Factor {
            name: effect.parameter.clone(),
            factor: effect.factor(concentration),
        };
        self.effects.iter().map(factor).collect()
    }
}

/// Reads a file of doses. Returns the control, then each dose of each drug in the order of the
/// file, then the combinations of drugs; blocks with the same name are one drug.
///
/// # Errors
/// Anything that is not such a file, with the block and the key.
///
/// # Example
/// ```
/// use myospring::compare::dose;
/// let doses = dose::read(dose::EXAMPLE)?;
/// let labels: Vec<&str> = doses.iter().map(|dose| dose.label.as_str()).collect();
/// assert_eq!(labels, ["control", "blocker 0.3 uM", "blocker 1 uM", "blocker 10 uM"]);
/// assert_eq!(doses[2].factors[0].factor, 0.6);
/// # Ok::<(), dose::DoseError>(())
/// ```
pub fn read(text: &str) -> Result<Vec<Dose>, DoseError> {
    let mut doses = vec![Dose { label: "control".to_owned(), factors: Vec::new() }];
    let table = table(text)?;
    let drugs = drugs(&table)?;
    for drug in &drugs {
        for &concentration in &drug.concentrations {
            let mut label = drug.name.clone();
            let _ = write!(label, " {}", units::format(concentration, Dimension::Concentration));
            doses.push(Dose { label, factors: drug.factors(concentration) });
        }
    }
    let together = match table.get("together") {
        Some(toml::Value::Array(blocks)) => blocks.clone(),
        Some(one) => vec![one.clone()],
        None => Vec::new(),
    };
    for (number, block) in (1..).zip(together) {
        doses.push(several(number, block, &drugs)?);
    }
    Ok(doses)
}

/// Returns a dose of several drugs at once: factors on the same number are multiplied.
fn several(number: usize, block: toml::Value, drugs: &[Drug]) -> Result<Dose, DoseError> {
    let Together { doses } = block.try_into().map_err(|error: toml::de::Error| {
        DoseError::Blocks { found: format!("together {number}: {}", error.message()) }
    })?;
    let mut factors: Vec<Factor> = Vec::new();
    for text in &doses {
        let unknown = || DoseError::Together {
            number,
            text: text.clone(),
            known: drugs.iter().map(|drug| drug.name.as_str()).collect::<Vec<_>>().join(", "),
        };
        // If several names of drugs match, the longest one counts.
        let named = drugs.iter().filter(|drug| text.starts_with(&drug.name));
        let drug = named.max_by_key(|drug| drug.name.len()).ok_or_else(unknown)?;
        let rest = text[drug.name.len()..].trim();
        let concentration = units::parse(rest, Dimension::Concentration).map_err(|_| unknown())?;
        if concentration.is_nan() || concentration < 0.0 {
            return Err(unknown());
        }
        for factor in drug.factors(concentration) {
            match factors.iter_mut().find(|other| other.name == factor.name) {
                Some(other) => other.factor *= factor.factor,
                None => factors.push(factor),
            }
        }
    }
    Ok(Dose { label: doses.join(" + "), factors })
}

fn table(text: &str) -> Result<toml::Table, DoseError> {
    read_toml(text).map_err(|error| {
        let before = error.span().map_or(0, |span| span.start).min(text.len());
        let line = text.get(..before).unwrap_or_default().matches('\n').count() + 1;
        DoseError::Syntax { line, reason: error.message().to_owned() }
    })
}

fn drugs(table: &toml::Table) -> Result<Vec<Drug>, DoseError> {
    let wrong = |found: String| DoseError::Blocks { found };
    if let Some(other) = table.keys().find(|key| *key != "drug" && *key != "together") {
        return Err(wrong(format!("`{other}` is not known")));
    }
    let blocks = match table.get("drug") {
        Some(toml::Value::Array(blocks)) if !blocks.is_empty() => blocks.clone(),
        Some(block @ toml::Value::Table(_)) => vec![block.clone()],
        _ => return Err(wrong("there is no drug".to_owned())),
    };
    let mut drugs: Vec<Drug> = Vec::new();
    for (number, block) in (1..).zip(blocks) {
        let drug = drug(number, block)?;
        match drugs.iter_mut().find(|other| other.name == drug.name) {
            Some(other) if other.concentrations == drug.concentrations => {
                other.effects.extend(drug.effects);
            }
            Some(_) => return Err(DoseError::Concentrations { name: drug.name }),
            None => drugs.push(drug),
        }
    }
    Ok(drugs)
}

fn drug(number: usize, block: toml::Value) -> Result<Drug, DoseError> {
    let Block { name, parameter, concentration, ic50, hill, maximal_effect } =
        block.try_into().map_err(|error: toml::de::Error| DoseError::Block {
            number,
            reason: error.message().to_owned(),
        })?;
    let out = |key, value: String, bounds| DoseError::OutOfBounds { number, key, value, bounds };
    let read = |key, text: &str| {
        units::parse(text, Dimension::Concentration).map_err(|cause| DoseError::Unit {
            number,
            key,
            cause,
        })
    };
    // A bare number is a text without a unit.
    let text = |value: toml::Value| match value {
        toml::Value::String(text) => text,
        other => other.to_string(),
    };
    let written = match concentration {
        toml::Value::Array(values) => values,
        one => vec![one],
    };
    let mut concentrations = Vec::new();
    for text in written.into_iter().map(text) {
        let value = read("concentration", &text)?;
        if value.is_nan() || value < 0.0 {
            return Err(out("concentration", text, "0 uM or more"));
        }
        concentrations.push(value);
    }
    let ic50 = text(ic50);
    let half = read("ic50", &ic50)?;
    if half.is_nan() || half <= 0.0 {
        return Err(out("ic50", ic50, "above 0 uM"));
    }
    if !(hill > 0.0 && hill <= 20.0) {
        return Err(out("hill", hill.to_string(), "above 0, at most 20"));
    }
    if !(-1.0..=100.0).contains(&maximal_effect) {
        return Err(out("maximal_effect", maximal_effect.to_string(), "-1 to 100"));
    }
    let effect = Effect { parameter: parameter.clone(), ic50: half, hill, maximal: maximal_effect };
    Ok(Drug { name: name.unwrap_or(parameter), concentrations, effects: vec![effect] })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn effect(hill: f64, maximal: f64) -> Effect {
        Effect { parameter: "tau_si".to_owned(), ic50: 2.0, hill, maximal }
    }

    #[test]
    fn half_of_the_effect_is_there_at_the_ic50_whatever_the_slope() {
        for hill in [0.5, 1.0, 4.0] {
            assert!((effect(hill, -0.8).factor(2.0) - 0.6).abs() < 1e-12);
            assert_eq!(effect(hill, -0.8).factor(0.0), 1.0);
            assert!((effect(hill, -0.8).factor(1e300) - 0.2).abs() < 1e-12);
        }
        // By hand: 1 + 0.5 (6/2)^2/(1 + (6/2)^2) = 1.45.
        assert!((effect(2.0, 0.5).factor(6.0) - 1.45).abs() < 1e-12);
    }

    #[test]
    fn blocks_of_one_name_are_one_drug() {
        let block = |parameter: &str| {
            format!(
                "[[drug]]\nname = \"x\"\nparameter = \"{parameter}\"\nconcentration = \"1 uM\"\nic50 = \"1 uM\"\n"
            )
        };
        let doses = read(&(block("tau_si") + &block("peak_tension"))).unwrap();
        assert_eq!(doses.len(), 2);
        let factors = &doses[1].factors;
        assert_eq!((factors.len(), factors[0].factor, factors[1].factor), (2, 0.5, 0.5));
    }

    #[test]
    fn drugs_given_together_multiply() {
        let doses = read(CHANNELS_EXAMPLE).unwrap();
        let labels: Vec<&str> = doses.iter().map(|dose| dose.label.as_str()).collect();
        let alone = ["control", "calcium blocker 0.1 uM", "calcium blocker 1 uM"];
        assert_eq!(labels[..3], alone);
        assert_eq!(labels[4], "calcium blocker 1 uM + potassium blocker 10 nM");
        let factor = |dose: &Dose, name: &str| {
            dose.factors.iter().find(|factor| factor.name == name).unwrap().factor
        };
        assert_eq!(factor(&doses[4], "P_Ca"), 0.5);
        let product = factor(&doses[2], "G_Kr") * factor(&doses[3], "G_Kr");
        assert_eq!(factor(&doses[4], "G_Kr"), product);
        assert!((factor(&doses[3], "G_Kr") - 0.5).abs() < 1e-12);
        for (dose, expected) in [
            ("nothing 1 uM", "`nothing 1 uM` is not a dose of calcium blocker, potassium blocker"),
            ("calcium blocker 1", "is not a dose of"),
            ("calcium blocker -1 uM", "is not a dose of"),
        ] {
            let text = format!("{CHANNELS_EXAMPLE}\n[[together]]\ndoses = [\"{dose}\"]\n");
            let said = read(&text).unwrap_err().to_string();
            assert!(said.contains(expected) && said.contains("together 2"), "{said}");
        }
        let said = read(&format!("{CHANNELS_EXAMPLE}\n[[together]]\ndose = 1\n")).unwrap_err();
        assert!(said.to_string().contains("together 2"), "{said}");
    }

    #[test]
    fn what_is_wrong_names_the_block_and_the_key() {
        let block = "[drug]\nparameter = \"tau_si\"\n";
        for (text, expected) in [
            (String::new(), "there is no drug"),
            ("drug = 3".to_owned(), "there is no drug"),
            ("[drugs]\n".to_owned(), "`drugs` is not known"),
            ("[drug]\nname = ".to_owned(), "line 2"),
            (format!("{block}concentration = \"1 uM\""), "missing field `ic50`"),
            (format!("{block}concentration = \"1 uM\"\nic50 = \"1\""), "drug 1: `ic50`"),
            (
                format!("{block}concentration = \"1 uM\"\nic50 = 1"),
                "drug 1: `ic50`: `1` has no unit",
            ),
            (
                format!("{block}concentration = [1, 2]\nic50 = \"1 uM\""),
                "drug 1: `concentration`: `1` has no unit",
            ),
            (format!("{block}concentration = \"1 uM\"\nic50 = \"0 uM\""), "above 0 uM"),
            (format!("{block}concentration = \"-1 uM\"\nic50 = \"1 uM\""), "0 uM or more"),
            (format!("{block}concentration = \"1 uM\"\nic50 = \"1 uM\"\nhill = 0"), "at most 20"),
            (
                format!("{block}concentration = \"1 uM\"\nic50 = \"1 uM\"\nil = 0"),
                "unknown field `il`",
            ),
            (
                format!("{block}concentration = \"1 uM\"\nic50 = \"1 uM\"\nmaximal_effect = -2"),
                "-1 to 100",
            ),
        ] {
            let said = read(&text).unwrap_err().to_string();
            assert!(said.contains(expected), "{text}: {said}");
        }
    }
}
