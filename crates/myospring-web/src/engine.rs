//! The engine: holds files and runs, and answers.

use crate::about::About;
use crate::request::{File, Request, Setup};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use myospring::compare::{dose, factor};
use myospring::experiment::compare::{Compared, Side};
use myospring::experiment::run::{BeatCell, FinishedRun, RunSeries};
use myospring::experiment::{ExperimentError, Files, input};
use myospring::interruption::Interruption;
use myospring::output::{csv, page};
use myospring::settings;
use serde::Serialize;
use serde_json::value::RawValue;
use std::collections::BTreeMap;
use std::path::Path;

/// Resolution of saved figures, dots per inch.
const DPI: f64 = 300.0;

/// Answers the page, and remembers what it will ask for again.
#[derive(Default)]
pub struct Engine {
    held: BTreeMap<String, Vec<u8>>,
    files: Files,
    series: RunSeries,
    /// The last run, and what it is called.
    last: Option<FinishedRun>,
    pinned: Vec<Side>,
}

/// An answer.
#[derive(Serialize)]
#[serde(rename_all = "kebab-case")]
enum Answer {
    About(About),
    /// Nothing more to say.
    Done,
    /// The data of a page, as `report.html` has them.
    Page(Box<RawValue>),
    /// Labels of doses, the control first.
    Doses(Vec<String>),
    /// A file.
    File {
        name: &'static str,
        base64: String,
    },
    Error {
        message: String,
        advice: Option<String>,
    },
}

impl From<ExperimentError> for Answer {
    fn from(error: ExperimentError) -> Self {
        Self::Error { message: error.to_string(), advice: error.advice().map(str::to_owned) }
    }
}

impl Engine {
    /// Answers a request in JSON; `bytes` are those of the file that it may be about.
    pub fn answer(&mut self, request: &str, bytes: &[u8]) -> String {
        let answer = match serde_json::from_str(request) {
            Ok(request) => self.answer_to(request, bytes).unwrap_or_else(Answer::from),
            Err(error) => {
                ExperimentError::new(format!("the request cannot be read: {error}")).into()
            }
        };
        serde_json::to_string(&answer).unwrap_or_default()
    }

    fn answer_to(&mut self, request: Request, bytes: &[u8]) -> Result<Answer, ExperimentError> {
        match request {
            Request::About => return Ok(Answer::About(About::new())),
            Request::Hold { name } => {
                self.held.insert(name, bytes.to_vec());
                self.files = Files::holding(self.held.clone());
                return Ok(Answer::Done);
            }
            Request::Doses { text } => {
                let doses = dose::read(&text).map_err(ExperimentError::new)?;
                return Ok(Answer::Doses(doses.into_iter().map(|dose| dose.label).collect()));
            }
            Request::Run(setup) => self.run(setup)?,
            Request::Pin => {
                let side = side(self.last()?)?;
                self.pinned.push(side);
            }
            Request::Unpin => self.pinned.clear(),
            Request::Save { what } => return self.save(what),
        }
        let data = self.page(page::data)?;
        RawValue::from_string(data).map(Answer::Page).map_err(ExperimentError::new)
    }

    fn run(&mut self, setup: Setup) -> Result<(), ExperimentError> {
        let chosen = setup.settings.into_iter().map(|(key, value)| {
            let unknown = || ExperimentError::new(format!("there is no setting `{key}`"));
            Ok((settings::find(&key).ok_or_else(unknown)?, value))
        });
        let chosen: Vec<_> = chosen.collect::<Result<_, ExperimentError>>()?;
        let file = setup.file.as_deref().map(Path::new);
        let (name, mut run) = input::settle(file, &chosen, &self.files, &Interruption::default())?;
        if let Some((doses, given)) = setup.dose {
            let doses = dose::read(&doses).map_err(ExperimentError::new)?;
            let dose = doses.iter().find(|dose| dose.label == given);
            let dose =
                dose.ok_or_else(|| ExperimentError::new(format!("there is no dose `{given}`")))?;
            factor::scale(&mut run, &dose.factors)?;
        }
        run.title = setup.label;
        let cell = BeatCell { name, run, threads: Some(1), refused: None };
        self.last = Some(self.series.prepare(cell, &self.files)?.beat(&()));
        Ok(())
    }

    fn last(&self) -> Result<&FinishedRun, ExperimentError> {
        self.last.as_ref().ok_or_else(|| ExperimentError::new("there is no run yet"))
    }

    /// The page of the last run, or of what was pinned with it.
    fn page(
        &self,
        make: impl FnOnce(&page::Page<'_>) -> Result<String, page::PageError>,
    ) -> Result<String, ExperimentError> {
        let last = self.last()?;
        if self.pinned.is_empty() {
            return last.page(make);
        }
        let mut sides = self.pinned.clone();
        sides.push(side(last)?);
        let compared = Compared::of_runs(sides, &self.files);
        let missing = || ExperimentError::new("a run has no frames");
        compared.page(make)?.ok_or_else(missing)
    }

    fn save(&self, what: File) -> Result<Answer, ExperimentError> {
        let last = self.last()?;
        let (name, bytes) = match what {
            File::Report => ("report.html", self.page(page::html)?.into_bytes()),
            File::Traces => ("traces.csv", csv::traces(&last.outcome.recording)?.into_bytes()),
            File::Run => ("run.toml", last.run_file().into_bytes()),
            File::Picture => ("overview.png", last.overview()?.to_png(DPI)?),
        };
        Ok(Answer::File { name, base64: STANDARD.encode(bytes) })
    }
}

/// A run as it is compared.
fn side(run: &FinishedRun) -> Result<Side, ExperimentError> {
    let (label, source, shape) =
        (run.run.title.clone(), run.name.clone(), run.shape_sha256.clone());
    Side::of(label, source, &run.run, &run.made, &run.outcome, shape)
}
