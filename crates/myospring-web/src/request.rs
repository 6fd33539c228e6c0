//! What the page asks.

use myospring::settings::Value;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A question of the page.
#[derive(Deserialize)]
#[serde(tag = "ask", rename_all = "kebab-case")]
pub(crate) enum Request {
    /// The settings and cell models.
    About,
    /// Holds a file, whose bytes follow the text, under a name by which settings may name it.
    Hold {
        /// Its name.
        name: String,
    },
    /// Simulates a cell and shows it.
    Run(Setup),
    /// The labels of the doses of a file of doses.
    Doses {
        /// The file.
        text: String,
    },
    /// Pins the last run: later ones are compared with it.
    Pin,
    /// Forgets what was pinned.
    Unpin,
    /// What is shown, as a file.
    Save {
        /// Which.
        what: File,
    },
}

/// What is simulated.
#[derive(Deserialize)]
pub(crate) struct Setup {
    /// Name of a run file that is held.
    pub(crate) file: Option<String>,
    /// Settings by their keys, which override that file's.
    #[serde(default)]
    pub(crate) settings: BTreeMap<String, Value>,
    /// A file of doses, as `myospring compare --dose` reads it, and which of them is given.
    pub(crate) dose: Option<(String, String)>,
    /// What the run is called among others.
    pub(crate) label: String,
}

/// A file that the page may save.
#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum File {
    /// `report.html` of all that is shown.
    Report,
    /// `traces.csv` of the last run.
    Traces,
    /// `run.toml` of the last run.
    Run,
    /// `overview.png` of the last run.
    Picture,
}
