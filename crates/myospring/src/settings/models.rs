//! The cell models that `cell.model` may name: listed ones and own ones.

use crate::cell::{self, CellModel, UnknownModel};
use std::fmt;
use std::sync::Arc;

/// Own cell models, in addition to those of [`cell::models`].
#[derive(Clone, Default)]
pub struct Models(Vec<Arc<dyn CellModel>>);

impl Models {
    /// Adds own models; an own model replaces a listed one of the same name.
    pub fn new(own: &[Arc<dyn CellModel>]) -> Self {
        Self(own.to_vec())
    }

    /// The model of this name, as given or published.
    ///
    /// # Errors
    /// An unknown name.
    pub fn model(&self, name: &str) -> Result<Arc<dyn CellModel>, UnknownModel> {
        let own = self.0.iter().find(|model| model.name() == name);
        own.map_or_else(|| cell::model(name), |model| Ok(Arc::clone(model)))
    }
}

impl fmt::Debug for Models {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_list().entries(self.0.iter().map(|model| model.name())).finish()
    }
}

impl PartialEq for Models {
    fn eq(&self, other: &Self) -> bool {
        let same = |(a, b): (&Arc<dyn CellModel>, &Arc<dyn CellModel>)| {
            a.name() == b.name() && a.parameters() == b.parameters()
        };
        self.0.len() == other.0.len() && self.0.iter().zip(&other.0).all(same)
    }
}
