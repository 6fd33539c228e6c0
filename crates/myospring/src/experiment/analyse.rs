//! Beats of measured curves: every metric, beat by beat, and where it was read.
//!
//! # Example
//! ```
//! use myospring::experiment::analyse::Analyse;
//! use myospring::experiment::{Experiment, Files, Outcome};
//!
//! // Two beats of a cell of 100 um, 40 frames a second.
//! let length = |frame: u32| match frame % 40 {
//!     at @ 10..30 => 100.0 - 8.0 * (f64::from(at - 10) * std::f64::consts::PI / 20.0).sin().powi(2),
//!     _ => 100.0,
//! };
//! let rows = (0..80).map(|frame| format!("{},{:.4}\n", 25 * frame, length(frame)));
//! let folder = std::env::temp_dir().join("myospring_analyse_example");
//! std::fs::create_dir_all(&folder)?;
//! std::fs::write(folder.join("cell.csv"), "t_ms,length_um\n".to_owned() + &rows.collect::<String>())?;
//!
//! let description = Analyse { paths: vec![folder.join("cell.csv")], ..Analyse::default() };
//! let outcome = description.run(&Files::default(), &())?;
//! let mean = outcome.curves[0].found.as_ref().unwrap().mean("peak_shortening").unwrap();
//! assert!((mean - 8.0).abs() < 0.3, "{mean}"); // %
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub(in crate::experiment) mod csv;
mod curve;
pub(in crate::experiment) mod figures;
mod page;
pub(in crate::experiment) mod pairs;
mod record;
mod shown;

pub use curve::AnalysedCurve;
pub use pairs::PairedCurves;
pub(in crate::experiment) use shown::Shown;

pub use record::{AnalysisRecord, KEY, Mean, conventions, means, means_of};

use super::beats::BeatOptions;
use super::tables::tables;
use super::{Experiment, ExperimentError, Files, Folder, Observer, Outcome};
use crate::analysis::curve::compare;
use crate::measured::{Curve, TableOptions};
use crate::output::figure::Theme;
use crate::output::json;
use serde::Serialize;
use std::path::PathBuf;

/// The largest number of curves that get a figure; each takes some 50 ms.
const FIGURES: usize = 500;
/// Notes that an error message lists.
const NAMED: usize = 10;
/// Up to this many curves without a beat, each gets its own warning.
const WHOLE: usize = 3;
/// The largest number of remarks that become warnings.
const REMARKS: usize = 20;

/// Finds the beats of measured curves.
#[derive(Debug, Clone, Default)]
pub struct Analyse {
    /// Tables of curves, and folders of them.
    pub paths: Vec<PathBuf>,
    /// Curves that are in no file.
    pub curves: Vec<Curve>,
    /// How the tables are read.
    pub table: TableOptions,
    /// How beats are found.
    pub beats: BeatOptions,
}

/// Curves with their beats.
#[derive(Debug, Clone)]
pub struct Analysed {
    /// In the order of the files; at least one has a beat.
    pub curves: Vec<AnalysedCurve>,
    /// Calcium and motion that were recorded together.
    pub pairs: Vec<PairedCurves>,
    /// What was found and assumed when the files were read.
    pub notes: Vec<String>,
    /// Files that could not be read; the notes say why.
    pub left_out: usize,
    /// What the page shows first.
    pub(in crate::experiment) shown: Option<Shown>,
}

impl Experiment for Analyse {
    type Outcome = Analysed;

    fn run(&self, files: &Files, observer: &dyn Observer) -> Result<Analysed, ExperimentError> {
        self.beats.check()?;
        let inputs = tables(&self.paths)?;
        let mut all = Analysed {
            curves: Vec::new(),
            pairs: Vec::new(),
            notes: Vec::new(),
            left_out: 0,
            shown: None,
        };
        observer.stage("files", inputs.len() as u64);
        for (done, path) in inputs.iter().enumerate() {
            let file = path.display().to_string();
            match files.table(path, &self.table) {
                Ok(table) => {
                    all.notes.extend(table.notes.iter().map(|note| format!("{file}: {note}")));
                    all.add(&file, table.curves, &self.beats);
                }
                Err(error) if inputs.len() == 1 => return Err(error.into()),
                // The other files are not affected.
                Err(error) => {
                    all.notes.push(format!("left out: {error}"));
                    all.left_out += 1;
                }
            }
            observer.reached(done as u64 + 1);
            observer.interruption().check().map_err(ExperimentError::new)?;
        }
        all.add("", self.curves.clone(), &self.beats);
        all.check_beats()?;
        let (pairs, notes) = pairs::pairs(&all.curves);
        all.pairs = pairs;
        all.notes.extend(notes);
        if all.curves.len() > FIGURES {
            all.notes.push(format!(
                "figures are drawn of the first {FIGURES} of {} curves; --columns chooses others",
                all.curves.len()
            ));
        }
        Ok(all)
    }
}

impl Analysed {
    /// Adds the curves of a table, and compares the beats of those that have the same times.
    fn add(&mut self, file: &str, curves: Vec<Curve>, beats: &BeatOptions) {
        let first = self.curves.len();
        self.curves.extend(curves.into_iter().map(|curve| AnalysedCurve::of(file, curve, beats)));
        let table = &mut self.curves[first..];
        let Some(times) = table.first().map(|read| read.curve.times_ms.clone()) else { return };
        let alike = table.iter_mut().filter(|read| read.curve.times_ms == times);
        let mut found: Vec<_> = alike
            .filter_map(|read| Some((read.curve.name.as_str(), read.found.as_mut().ok()?)))
            .collect();
        compare(&mut found);
    }

    /// Refuses curves none of which has a beat.
    fn check_beats(&self) -> Result<(), ExperimentError> {
        if self.curves.iter().any(|read| read.found.is_ok()) {
            return Ok(());
        }
        let Some((first, Err(why))) = self.curves.first().map(|first| (first, &first.found)) else {
            let failure =
                ExperimentError::new("none of the files can be read as a table of curves");
            return Err(self.notes.iter().fold(failure, |failure, note| failure.also(note)));
        };
        let place = match first.file.as_str() {
            "" => format!("`{}`", first.curve.name),
            file => format!("`{file}`, column `{}`", first.curve.name),
        };
        let message = match self.curves.len() {
            1 => format!("{place}: {why}"),
            count => format!("none of {count} curves has a beat; {place}: {why}"),
        };
        let mut failure = ExperimentError::new(message).advise(
            "look at the curve; --kind says what it is, --columns chooses it, --frame-rate and --time-unit say how \
             fast it was recorded",
        );
        for note in self.notes.iter().take(NAMED) {
            failure = failure.also(note);
        }
        Err(match self.notes.len().saturating_sub(NAMED) {
            0 => failure,
            more => failure.also(&format!("and {more} more notes like these")),
        })
    }

    /// What is odd, curve by curve.
    fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        let none: Vec<&AnalysedCurve> =
            self.curves.iter().filter(|read| read.found.is_err()).collect();
        if none.len() > WHOLE {
            let (none, all) = (none.len(), self.curves.len());
            remarks
                .push(format!("{none} of {all} curves have no beat; summary.csv has the reasons"));
        } else {
            remarks.extend(none.iter().filter_map(|read| {
                let why = read.found.as_ref().err()?;
                Some(format!("{}: {why}", read.title()))
            }));
        }
        let mut odd: Vec<String> = self.curves.iter().flat_map(AnalysedCurve::remarks).collect();
        let more = odd.len().saturating_sub(REMARKS);
        odd.truncate(REMARKS);
        remarks.extend(odd);
        for pair in &self.pairs {
            let title = pair.title(&self.curves);
            remarks.extend(pair.paired.remarks.iter().map(|remark| format!("{title}: {remark}")));
        }
        if more > 0 {
            remarks.push(format!("{more} further remarks stand in summary.json and metrics.csv"));
        }
        remarks
    }
}

impl Outcome for Analysed {
    fn numbers(&self) -> impl Serialize {
        AnalysisRecord::of(&self.curves, &self.pairs, &self.notes)
    }

    fn warnings(&self) -> Vec<String> {
        self.notes.iter().cloned().chain(self.remarks()).collect()
    }

    fn save(&self, folder: &Folder, observer: &dyn Observer) -> Result<(), ExperimentError> {
        folder.write("metrics.csv", csv::metrics(&self.curves)?)?;
        folder.write("summary.csv", csv::summary(&self.curves)?)?;
        folder.write("summary.json", json::for_people(&self.numbers())?)?;
        folder.write(
            "report.html",
            page::html(&self.curves, &self.pairs, self.shown.as_ref(), self.warnings())?,
        )?;
        if !self.pairs.is_empty() {
            folder.write("pairs.csv", csv::pairs(&self.curves, &self.pairs)?)?;
            folder.write("loops.csv", csv::loops(&self.curves, &self.pairs)?)?;
        }
        let names = figures::names(&self.curves);
        observer.stage("figures", names.len().min(FIGURES) as u64);
        for (done, (read, name)) in self.curves.iter().zip(&names).take(FIGURES).enumerate() {
            if let Ok(analysis) = &read.found {
                let draw = || figures::figure(read, analysis);
                folder.figures(Theme::Light, &[(name, &draw)], observer)?;
            }
            observer.reached(done as u64 + 1);
            if observer.interruption().is_requested() {
                return Ok(());
            }
        }
        let drawn = self.pairs.iter().filter(|pair| pair.paired.mean_loop.is_some());
        let names = figures::loop_names(&self.curves, drawn.clone());
        for (pair, name) in drawn.take(FIGURES).zip(&names) {
            let draw = || figures::loops(&self.curves, pair);
            folder.figures(Theme::Light, &[(name, &draw)], observer)?;
        }
        Ok(())
    }
}
