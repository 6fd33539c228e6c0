//! The cell models that `cell.model` may name: listed ones, own ones, and those of files.

use super::problem::Problem;
use crate::cell::equation_model::EquationModel;
use crate::cell::{self, CellModel};
use crate::cell_files::{self, Choices};
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Endings of the files of cell models.
pub(super) const MODEL_ENDINGS: &[&str] = &["mmt", "cellml"];

/// How the model of a file is read.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct FromFile {
    /// The variables that the user named.
    pub variables: Choices,
    /// Whether the myofilaments of `land_2017`, driven by the model's calcium, make its tension. By default they do where
    /// the file has calcium and no tension.
    pub myofilaments: Option<bool>,
}

/// The models of files by their names and how they were read.
type ModelsRead = BTreeMap<(String, FromFile), Arc<dyn CellModel>>;

/// Own cell models, in addition to those of [`cell::models`] and to files in CellML or Myokit's form. A file is read
/// once; clones share what was read.
#[derive(Clone, Default)]
pub struct Models {
    own: Vec<Arc<dyn CellModel>>,
    of_files: Arc<Mutex<ModelsRead>>,
    held: Arc<BTreeMap<String, Vec<u8>>>,
    /// What names of files are relative to; empty for the current folder.
    folder: PathBuf,
}

impl Models {
    /// Adds own models; an own model replaces a listed one of the same name.
    pub fn new(own: &[Arc<dyn CellModel>]) -> Self {
        Self { own: own.to_vec(), ..Self::default() }
    }

    /// The same, with files of models that are not on the disk: their contents by name.
    #[must_use]
    pub fn holding(self, held: Arc<BTreeMap<String, Vec<u8>>>) -> Self {
        Self { held, of_files: Arc::default(), ..self }
    }

    /// The same, with names of files relative to a folder.
    #[must_use]
    pub fn beside(self, folder: &Path) -> Self {
        Self { folder: folder.to_owned(), of_files: Arc::default(), ..self }
    }

    /// The name by which [`Models::model`] finds a model: that of its file as written, or its own.
    pub fn name_of(model: &dyn CellModel) -> &str {
        let file = model.equations_read().map(|equations| equations.source.file.as_str());
        file.filter(|file| cell_files::is_model_file(file)).unwrap_or_else(|| model.name())
    }

    /// The model of this name, as given or published, or that of the file of this name.
    ///
    /// # Errors
    /// An unknown name, a file that cannot be read or simulated.
    pub fn model(&self, name: &str, how: &FromFile) -> Result<Arc<dyn CellModel>, Problem> {
        if let Some(own) = self.own.iter().find(|model| model.name() == name) {
            return Ok(Arc::clone(own));
        }
        if !cell_files::is_model_file(name) {
            return cell::model(name).map_err(Problem::Model);
        }
        let mut known = self.of_files.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (name.to_owned(), how.clone());
        if let Some(model) = known.get(&key) {
            return Ok(Arc::clone(model));
        }
        let model = self.read(name, how)?;
        known.insert(key, Arc::clone(&model));
        Ok(model)
    }

    /// Reads the model of a file.
    fn read(&self, name: &str, how: &FromFile) -> Result<Arc<dyn CellModel>, Problem> {
        let held = &self.held;
        let failed = |reason: String| Problem::ModelFile { reason };
        let equations = match held.get(name).map(|bytes| std::str::from_utf8(bytes)) {
            None => cell_files::open(&self.folder.join(name), &how.variables),
            Some(Err(_)) => return Err(failed(format!("`{name}` is not text (UTF-8)"))),
            Some(Ok(text)) => cell_files::read(name, text, &how.variables, &|beside| {
                let path = Path::new(name).with_file_name(beside);
                String::from_utf8(held.get(path.to_str()?)?.clone()).ok()
            }),
        };
        let mut equations = equations.map_err(|error| failed(error.to_string()))?;
        name.clone_into(&mut equations.source.file);
        let roles = &equations.roles;
        let needed = roles.tension.is_none() && roles.calcium.is_some();
        let model = if how.myofilaments.unwrap_or(needed) {
            EquationModel::with_myofilaments(equations)
        } else {
            EquationModel::new(equations)
        };
        Ok(Arc::new(model.map_err(|error| failed(error.to_string()))?))
    }
}

impl fmt::Debug for Models {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_list().entries(self.own.iter().map(|model| model.name())).finish()
    }
}

impl PartialEq for Models {
    fn eq(&self, other: &Self) -> bool {
        let same = |(a, b): (&Arc<dyn CellModel>, &Arc<dyn CellModel>)| {
            a.name() == b.name() && a.parameters() == b.parameters()
        };
        self.own.len() == other.own.len() && self.own.iter().zip(&other.own).all(same)
    }
}
