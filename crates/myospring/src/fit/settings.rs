//! What is sought, and where.

use super::error::FitError;
use super::unknown::Unknown;
use crate::cell::CellModel;
use std::collections::BTreeMap;

/// What is sought, by the names that people write.
#[derive(Debug, Clone, PartialEq)]
pub struct Sought {
    /// What is sought beside tension over stiffness; none: what a curve tells ([`FitSettings::usual`]), and with a curve
    /// under a known load the stiffness.
    pub free: Vec<String>,
    /// What is not sought of these.
    pub fix: Vec<String>,
    /// Bounds other than the usual ones, in the unit of each unknown.
    pub bounds: Vec<(String, [f64; 2])>,
    /// How many starts.
    pub starts: usize,
    /// Decides the starts.
    pub seed: u64,
}

impl Default for Sought {
    fn default() -> Self {
        let FitSettings { starts, seed, .. } = FitSettings::default();
        Self { free: Vec::new(), fix: Vec::new(), bounds: Vec::new(), starts, seed }
    }
}

impl Sought {
    /// The settings for a cell model; `loaded` says whether there is a curve under a known load.
    ///
    /// # Errors
    /// A name to fix or to bound that is not sought anyway.
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
        match bounds.keys().find(|unknown| !free.contains(unknown)) {
            Some(unknown) => Err(not_sought(unknown, &free)),
            None => {
                Ok(FitSettings { free: Some(free), bounds, starts: self.starts, seed: self.seed })
            }
        }
    }
}

/// Settings of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FitSettings {
    /// What is sought beside delays and lengths at rest; `None`: what a curve of this model tells
    /// ([`FitSettings::usual`]).
    pub free: Option<Vec<Unknown>>,
    /// Bounds other than the usual ones, in the unit of each unknown.
    pub bounds: BTreeMap<Unknown, [f64; 2]>,
    /// How many starts.
    pub starts: usize,
    /// Decides the starts.
    pub seed: u64,
}

impl Default for FitSettings {
    fn default() -> Self {
        Self { free: None, bounds: BTreeMap::new(), starts: 8, seed: 1 }
    }
}

impl FitSettings {
    /// What a curve of one cell tells: of a tension that is given its height and its rate, of myofilaments that feel
    /// their length the height alone, since calcium's sensitivity and the height can hardly be told apart.
    pub fn usual(cell: &dyn CellModel) -> Vec<Unknown> {
        let usual = cell.in_fits().usual.iter();
        let of_cell = usual.map(|name| Unknown::Parameter((*name).to_owned()));
        [Unknown::TensionOverStiffness].into_iter().chain(of_cell).collect()
    }

    /// Every unknown with its bounds as factors on the run's value, and that value; `of` gives the value of what is no
    /// parameter.
    pub(super) fn sought(
        &self,
        cell: &dyn CellModel,
        of: impl Fn(&Unknown) -> f64,
        arbitrary: bool,
    ) -> Result<Vec<(Unknown, [f64; 2], f64)>, FitError> {
        let mut free = self.free.clone().unwrap_or_else(|| Self::usual(cell));
        if arbitrary {
            // A height in arbitrary units is no height.
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
    FitError::NotSought { name: unknown.to_string(), sought: names.join(", ") }
}
