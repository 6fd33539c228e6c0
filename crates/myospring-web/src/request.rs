//! What the page asks.

use crate::traction::Displaced;
use myospring::experiment::fit::TractionCurve;
use myospring::experiment::optical::MapWaves;
use myospring::experiment::{BeatOptions, ExperimentError};
use myospring::measured::{Column, Kind, TableOptions};
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
    /// What a file holds that may be a table of curves or an outline.
    Kind {
        /// Its name.
        name: String,
    },
    /// The settings of a run file that is held.
    Settings {
        /// Its name.
        name: String,
    },
    /// The cell model of a file that is held.
    Model {
        /// Its name.
        name: String,
    },
    /// Finds the beats of curves.
    Analyse(Reading),
    /// Follows the cell of a film.
    Track(Filmed),
    /// Follows the posts that hold the tissue of a film.
    Posts(OnPosts),
    /// Maps the waves of a film of a tissue's light.
    MapWaves(Lit),
    /// Finds the tractions of a cell on a gel.
    Traction(Displaced),
    /// Finds the numbers of a cell from a curve or a film.
    Fit(Fit),
    /// Shows a report that is held.
    Open {
        /// Its name.
        name: String,
    },
    /// Saves all of the last run: figures, films and tables.
    SaveAll,
    /// A file of the last results.
    Result {
        /// Its name.
        name: String,
    },
    /// Holds the files of the last results, so that settings may name them.
    Keep,
    /// The cells that a picture shows.
    Cells {
        /// Settings of shape and segmentation by their keys.
        settings: BTreeMap<String, Value>,
    },
    /// The outline of the cell of a picture, as a file.
    Outline {
        /// As of `Cells`.
        settings: BTreeMap<String, Value>,
        /// Name of the file; its ending says the format.
        name: String,
    },
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
    /// Settings by their keys.
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

/// A table of curves, and how it is read; whatever is absent is detected.
#[derive(Deserialize)]
pub(crate) struct Reading {
    /// Its name.
    pub(crate) name: String,
    frame_rate_per_s: Option<f64>,
    pixel_size_um: Option<f64>,
    #[serde(default)]
    columns: Vec<String>,
    kind: Option<String>,
    unit: Option<String>,
    time_unit: Option<String>,
    from_ms: Option<f64>,
    until_ms: Option<f64>,
    stimulus_period_ms: Option<f64>,
}

impl Reading {
    pub(crate) fn table(&self) -> Result<TableOptions, ExperimentError> {
        let unknown = |word: &String| {
            ExperimentError::new(format!("`{word}` is no kind of curve that is known"))
        };
        let of_word = |word: &String| Kind::of_word(word).ok_or_else(|| unknown(word));
        Ok(TableOptions {
            frame_rate_per_s: self.frame_rate_per_s,
            pixel_size_um: self.pixel_size_um,
            values: self.columns.iter().map(|text| Column::of(text)).collect(),
            kind: self.kind.as_ref().map(of_word).transpose()?,
            unit: self.unit.clone(),
            time_unit: self.time_unit.clone(),
            from_ms: self.from_ms,
            until_ms: self.until_ms,
            ..TableOptions::default()
        })
    }

    pub(crate) fn beats(&self) -> BeatOptions {
        BeatOptions { period_ms: self.stimulus_period_ms, ..BeatOptions::default() }
    }
}

/// A film, and what it does not say itself.
#[derive(Deserialize)]
pub(crate) struct Filmed {
    /// Its name.
    pub(crate) name: String,
    pub(crate) frame_rate_per_s: Option<f64>,
    /// Settings of shape, segmentation and fibres by their keys.
    #[serde(default)]
    pub(crate) settings: BTreeMap<String, Value>,
}

/// A film of a tissue on two posts, and what it does not say itself.
#[derive(Deserialize)]
pub(crate) struct OnPosts {
    #[serde(flatten)]
    pub(crate) film: Filmed,
    /// Column, row and size of each post, as the program takes them; found unless stated.
    pub(crate) post_places: Option<String>,
    /// Force per displacement of one post, uN/um.
    pub(crate) post_stiffness_un_per_um: Option<f64>,
}

/// A film of a tissue's light, and what it does not say itself.
#[derive(Deserialize)]
pub(crate) struct Lit {
    name: String,
    frame_rate_per_s: Option<f64>,
    pixel_size_um: Option<f64>,
    stimulus_period_ms: Option<f64>,
}

impl Lit {
    pub(crate) fn experiment(self) -> MapWaves {
        MapWaves {
            film: self.name.into(),
            frame_rate: self.frame_rate_per_s,
            pixel_size_um: self.pixel_size_um,
            beats: BeatOptions { period_ms: self.stimulus_period_ms, ..BeatOptions::default() },
            falls: None,
        }
    }
}

/// What is fitted to a curve.
#[derive(Deserialize)]
pub(crate) struct Fit {
    /// The curve.
    #[serde(flatten)]
    pub(crate) curve: Reading,
    /// Settings of the cell by their keys. Without a cell model every one that may serve is tried.
    pub(crate) settings: BTreeMap<String, Value>,
    /// What is fitted, if not the usual numbers.
    #[serde(default)]
    pub(crate) free: Vec<String>,
    /// Largest shortening of the cell, %, for a curve in arbitrary units.
    pub(crate) peak_shortening_pct: Option<f64>,
    /// A table of the force of the same cell on a gel, and Young's modulus of that gel, kPa; without it the gel of the settings.
    traction: Option<String>,
    gel_modulus_kpa: Option<f64>,
}

impl Fit {
    pub(crate) fn on_gel(&self) -> Option<TractionCurve> {
        let path = self.traction.as_ref()?.into();
        Some(TractionCurve { gel_modulus: self.gel_modulus_kpa, path })
    }
}
