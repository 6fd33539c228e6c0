//! What is fitted, and within which bounds.

use super::error::FitError;
use super::unknown::Unknown;
use crate::cell::CellModel;
use std::collections::BTreeMap;

/// What is fitted, by the names of options.
#[derive(Debug, Clone, PartialEq)]
pub struct FitOptions {
    /// Numbers that are fitted in addition to delays and lengths at rest. Empty: those that a curve
    /// determines ([`FitSettings::usual`]), and with a curve under a known load the stiffness.
    pub free: Vec<String>,
    /// Numbers of these that are fixed.
    pub fix: Vec<String>,
    /// Bounds other than the usual ones, in the unit of each unknown.
    pub bounds: Vec<(String, [f64; 2])>,
    /// How many starts.
    pub starts: usize,
    /// Seed of the starts.
    pub seed: u64,
    /// How far the cell shortens at the peak of its beat, %, for curves in arbitrary units, which do not say so.
    pub peak_shortening_pct: Option<f64>,
}

impl Default for FitOptions {
    fn default() -> Self {
        let FitSettings { starts, seed, .. } = FitSettings::default();
        let (free, fix, bounds) = (Vec::new(), Vec::new(), Vec::new());
        Self { free, fix, bounds, starts, seed, peak_shortening_pct: None }
    }
}

impl FitOptions {
    /// The settings for a cell model; `loaded` is true if there is a curve under a known load.
    ///
    /// # Errors
    /// A name to fix or to bound that is not fitted.
    pub fn settings(&self, cell: &dyn CellModel, loaded: bool) -> Result<FitSettings, FitError> {
        let named = |name: &String| Unknown::named(name.trim());
        let mut free = FitSettings::usual(cell);
        if !self.free.is_empty() {
            free.truncate(1);
            free.extend(self.free.iter().map(named));
        } else if loaded {
            free.push(Unknown::YoungModulus);
        }
        for fixed in self.fix.iter().map(named) {
            if !free.contains(&fixed) {
                return Err(not_sought(&fixed, &free));
            }
            free.retain(|unknown| *unknown != fixed);
        }
        let bounds: BTreeMap<Unknown, [f64; 2]> =
            self.bounds.iter().map(|(name, ends)| (named(name), *ends)).collect();
        if let Some(unknown) = bounds.keys().find(|unknown| !free.contains(unknown)) {
            return Err(not_sought(unknown, &free));
        }
        let (starts, seed) = (self.starts, self.seed);
        Ok(FitSettings { free: Some(free), bounds, starts, seed, ..FitSettings::default() })
    }
}

/// Settings of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FitSettings {
    /// Numbers that are fitted in addition to delays and lengths at rest; `None`: those that a
    /// curve of this model determines ([`FitSettings::usual`]).
    pub free: Option<Vec<Unknown>>,
    /// Bounds other than the usual ones, in the unit of each unknown.
    pub bounds: BTreeMap<Unknown, [f64; 2]>,
    /// How many starts.
    pub starts: usize,
    /// Seed of the starts.
    pub seed: u64,
    /// Whether intervals are computed; without them a fit takes a fraction of the time.
    pub intervals: bool,
}

impl Default for FitSettings {
    fn default() -> Self {
        Self { free: None, bounds: BTreeMap::new(), starts: 8, seed: 1, intervals: true }
    }
}

impl FitSettings {
    /// The numbers that a curve of one cell determines. For a model whose tension follows the
    /// potential: height and rate of the tension. For myofilaments that respond to length: the
    /// height and, where the model has one, a rate; calcium's sensitivity and the height can hardly
    /// be distinguished.
    pub fn usual(cell: &dyn CellModel) -> Vec<Unknown> {
        let usual = cell.in_fits().usual.iter();
        let of_cell = usual.map(|name| Unknown::Parameter((*name).to_owned()));
        [Unknown::TensionOverStiffness].into_iter().chain(of_cell).collect()
    }

    /// Refuses names of parameters where the tension itself is sought.
    pub(super) fn refuse_parameters(&self) -> Result<(), FitError> {
        let strength = [Unknown::TensionOverStiffness];
        if self.bounds.is_empty() && self.free.as_ref().is_none_or(|free| *free == strength) {
            return Ok(());
        }
        Err(FitError::Setting {
            what: "names to free, to fix or to bound",
            why: "the tension itself is sought, frame by frame, and no parameter; leave them out",
        })
    }

    /// Every unknown with its bounds as factors on the run's value, and that value; `of` gives the
    /// value of unknowns that are not parameters.
    pub(super) fn sought(
        &self,
        cell: &dyn CellModel,
        of: impl Fn(&Unknown) -> f64,
        arbitrary: bool,
    ) -> Result<Vec<(Unknown, [f64; 2], f64)>, FitError> {
        let mut free = self.free.clone().unwrap_or_else(|| Self::usual(cell));
        if arbitrary {
            // A height in arbitrary units does not determine the tension.
            free.retain(|unknown| *unknown != Unknown::TensionOverStiffness);
        }
        if let Some(unknown) = self.bounds.keys().find(|unknown| !free.contains(unknown)) {
            return Err(not_sought(unknown, &free));
        }
        let names: Vec<&str> = [Unknown::TensionOverStiffness.name()]
            .into_iter()
            .chain(cell.in_fits().not_together.iter().copied())
            .collect();
        let sought = |name: &&str| free.iter().any(|unknown| unknown.name() == *name);
        if names.len() > 1 && names.iter().all(sought) {
            return Err(FitError::TooMany { names: names.join(", ") });
        }
        let mut all: Vec<(Unknown, [f64; 2], f64)> = Vec::new();
        for unknown in free {
            let (usual, limits) = match &unknown {
                Unknown::Parameter(name) => {
                    let rows = cell.parameters().rows();
                    let row = rows.iter().find(|row| row.name == *name).ok_or_else(|| {
                        let known: Vec<&str> = ["tension_over_stiffness", "young_modulus"]
                            .into_iter()
                            .chain(rows.iter().map(|row| &*row.name))
                            .collect();
                        let why = format!("{} has no such parameter", cell.name());
                        FitError::Unknown { name: name.clone(), why, known: known.join(", ") }
                    })?;
                    if row.value.is_nan() || row.value <= 0.0 {
                        return Err(FitError::Unknown {
                            name: name.clone(),
                            why: format!("it is {}, and a fit multiplies it by factors", row.value),
                            known: "numbers above 0".to_owned(),
                        });
                    }
                    (row.value, [row.minimum, row.maximum])
                }
                other => (of(other), other.usual().map(|factor| factor * of(other))),
            };
            let asked = self.bounds.get(&unknown).copied();
            let [low, high] = asked.unwrap_or_else(|| {
                let [low, high] = unknown.usual().map(|factor| factor * usual);
                [low.max(limits[0]), high.min(limits[1])]
            });
            if !(low > 0.0 && low < high && limits[0] <= low && high <= limits[1]) {
                let [least, most] = limits;
                return Err(FitError::Bounds { name: unknown.to_string(), low, high, least, most });
            }
            if all.iter().any(|(known, ..)| *known == unknown) {
                continue;
            }
            all.push((unknown, [low / usual, high / usual], usual));
        }
        Ok(all)
    }
}

fn not_sought(unknown: &Unknown, sought: &[Unknown]) -> FitError {
    let names: Vec<&str> = sought.iter().map(Unknown::name).collect();
    FitError::NotFitted { name: unknown.to_string(), sought: names.join(", ") }
}
