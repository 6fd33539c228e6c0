//! The cell models of a fit.

use crate::cell::{self as cells, CellModel};
use crate::experiment::ExperimentError;
use crate::settings::Run;
use std::io;
use std::sync::Arc;

/// Which cell models are fitted.
pub enum Models {
    /// That of the run.
    OfRun,
    /// None: the tension itself is sought.
    Tension,
    /// All that may serve, and the tension itself; the simplest that follows the curve is taken.
    All(Vec<(String, Result<Driven, ExperimentError>)>),
}

/// A run, and its cell model with calcium or tension from its tables.
pub struct Driven {
    pub(super) run: Run,
    pub(super) cell: Arc<dyn CellModel>,
}

impl Models {
    /// All models that know which of their parameters a curve determines. `resolve` gives the run with a model of this name, `read`
    /// reads a file of that run.
    ///
    /// # Errors
    /// If no model suits the settings, why the first does not.
    pub fn all(
        resolve: impl Fn(&str) -> Result<Run, ExperimentError>,
        read: impl Fn(&str) -> io::Result<Vec<u8>>,
    ) -> Result<Self, ExperimentError> {
        let driven = |name: &str| {
            let run = resolve(name)?;
            let (cell, _) = run.driven(&read).map_err(ExperimentError::new)?;
            Ok(Driven { run, cell })
        };
        let models = cells::models();
        let known = models.iter().filter(|model| !model.in_fits().usual.is_empty());
        let mut tried: Vec<_> =
            known.map(|model| (model.name().to_owned(), driven(model.name()))).collect();
        if tried.iter().all(|(_, run)| run.is_err()) {
            let (_, first) = tried.swap_remove(0);
            first?;
        }
        Ok(Self::All(tried))
    }

    /// The first model that suits the settings, where there are several.
    pub fn first(&self) -> Option<&str> {
        let Self::All(tried) = self else { return None };
        tried.iter().find(|(_, run)| run.is_ok()).map(|(name, _)| name.as_str())
    }
}
