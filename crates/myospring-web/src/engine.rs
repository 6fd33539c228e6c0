//! The engine: holds files and runs, and answers.

use crate::about::{About, Model};
use crate::cells::ShownCells;
use crate::progress::Told;
use crate::request::{File, Filmed, Fit, OnPosts, Reading, Request, Setup};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use myospring::compare::{dose, factor};
use myospring::experiment::analyse::Analyse;
use myospring::experiment::compare::{Compared, Side};
use myospring::experiment::fit::FitCell;
use myospring::experiment::input::ChosenSetting;
use myospring::experiment::posts::{self, FollowPosts};
use myospring::experiment::run::{BeatCell, FILE, FinishedRun, OUTPUTS, RunSeries, Style};
use myospring::experiment::segment::Segment;
use myospring::experiment::track::Track;
use myospring::experiment::{Experiment, ExperimentError, Files, Folder, Outcome, input};
use myospring::fit::FitOptions;
use myospring::interruption::Interruption;
use myospring::measured::TableOptions;
use myospring::microscopy::film::Film;
use myospring::microscopy::outlines::OutlineFormat;
use myospring::microscopy::picture::Selection;
use myospring::microscopy::read::read_picture;
use myospring::output::{csv, page};
use myospring::run_file::RunFile;
use myospring::settings::{self, FromFile, Models, Run, Value};
use serde::Serialize;
use serde_json::value::RawValue;
use std::collections::BTreeMap;
use std::path::Path;

/// Resolution of saved figures, dots per inch.
const DPI: f64 = 300.0;

/// The setting of the cell model.
const MODEL: &str = "cell.model";

/// Answers the page, and remembers what it will ask for again.
#[derive(Default)]
pub struct Engine {
    held: BTreeMap<String, Vec<u8>>,
    files: Files,
    series: RunSeries,
    /// The last run, and what it is called.
    last: Option<FinishedRun>,
    pinned: Vec<Side>,
    /// The files of the last results that were saved.
    results: BTreeMap<String, Vec<u8>>,
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
    /// Results: the data of their page, as `report.html` has them, where they have one, and their files.
    Results {
        page: Option<Box<RawValue>>,
        files: Vec<Listed>,
    },
    /// A cell model.
    Model(Model),
    /// What a file holds.
    Kind(Held),
    /// A picture with the cells that it shows.
    Picture(ShownCells),
    /// Settings by their keys.
    Settings(BTreeMap<&'static str, Value>),
    /// A file.
    File {
        name: String,
        base64: String,
    },
    Error {
        message: String,
        advice: Option<String>,
    },
}

/// What a file holds whose name does not say it.
#[derive(Serialize)]
#[serde(rename_all = "kebab-case")]
enum Held {
    Curves,
    Outline,
    Film,
    /// Slices in depth, as the file says.
    Stack,
}

/// A file of results.
#[derive(Serialize)]
struct Listed {
    name: String,
    bytes: usize,
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
                self.hold([(name, bytes.to_vec())]);
                return Ok(Answer::Done);
            }
            Request::Keep => {
                self.hold(self.results.clone());
                return Ok(Answer::Done);
            }
            Request::Kind { name } => return self.kind(&name).map(Answer::Kind),
            Request::Settings { name } => return self.settings_of(&name),
            Request::Model { name } => {
                let models = Models::default().holding(self.files.held());
                let model = models.model(&name, &FromFile::default());
                return Ok(Answer::Model(Model::of(&*model.map_err(ExperimentError::new)?)));
            }
            Request::Analyse(reading) => return self.analyse(&reading),
            Request::Track(film) => return self.results_of(&track(film)?),
            Request::Posts(film) => return self.follow_posts(film),
            Request::MapWaves(film) => return self.results_of(&film.experiment()),
            Request::Traction(displaced) => return self.results_of(&displaced.experiment()?),
            Request::Fit(fit) => return self.fit(fit),
            Request::Cells { settings } => {
                let shown = ShownCells::of(&self.picture(settings)?.1, &self.files)?;
                return Ok(Answer::Picture(shown));
            }
            Request::Outline { settings, name } => {
                let (picture, run) = self.picture(settings)?;
                let (all, refused, of_cut) = (false, None, Vec::new());
                let found = Segment { picture, run, all, refused, of_cut };
                let found = found.run(&self.files, &Told::default())?;
                return Ok(file(&name, &found.encoded(Path::new(&name))?));
            }
            Request::Open { name } => return self.open(&name),
            Request::SaveAll => {
                let folder = Folder::in_memory();
                let outputs: Vec<_> = OUTPUTS.iter().collect();
                self.last()?.write(&folder, &outputs, Style::default(), &Told::default())?;
                return self.finished(&folder, false);
            }
            Request::Result { name } => {
                let unknown = || ExperimentError::new(format!("there is no result `{name}`"));
                let bytes = self.results.get(&name).ok_or_else(unknown)?;
                return Ok(file(&name, bytes));
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
        let chosen = chosen(setup.settings)?;
        let (name, mut run) = input::settle(None, &chosen, &self.files, &Interruption::default())?;
        if let Some((doses, given)) = setup.dose {
            let doses = dose::read(&doses).map_err(ExperimentError::new)?;
            let dose = doses.iter().find(|dose| dose.label == given);
            let dose =
                dose.ok_or_else(|| ExperimentError::new(format!("there is no dose `{given}`")))?;
            factor::scale(&mut run, &dose.factors)?;
        }
        run.title = setup.label;
        let cell = BeatCell { name, run, threads: Some(1), refused: None, mesh_figure: None };
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
        Ok(file(name, &bytes))
    }

    fn hold(&mut self, files: impl IntoIterator<Item = (String, Vec<u8>)>) {
        self.held.extend(files);
        self.files = Files::holding(self.held.clone());
    }

    /// What a file holds: a film, an outline, or else a table of curves.
    fn kind(&self, name: &str) -> Result<Held, ExperimentError> {
        let path = Path::new(name);
        let bytes =
            self.files.bytes(path).map_err(|error| ExperimentError::unread(path, &error))?;
        let is_outline = OutlineFormat::of(&bytes).is_some();
        let picture = read_picture(&bytes, &Selection::default());
        let is_stack = picture.is_ok_and(|picture| picture.slices > 1 && picture.frames <= 1);
        Ok(if is_stack {
            Held::Stack
        } else if Film::read(bytes, &Selection::default()).is_ok() {
            Held::Film
        } else if is_outline && self.files.table(path, &TableOptions::default()).is_err() {
            Held::Outline
        } else {
            // The reader of tables says what one that it cannot read lacks.
            Held::Curves
        })
    }

    fn settings_of(&self, name: &str) -> Result<Answer, ExperimentError> {
        let text = self.files.text(Path::new(name))?;
        let read = |text: &str| RunFile::from_text(text).map_err(ExperimentError::new);
        let own = read(&text)?;
        // A run file of results states all settings; what is as always is no choice.
        let model = own.get(MODEL).map_or_else(String::new, |model| format!("{MODEL} = {model}"));
        // A model that needs a file is nothing without it.
        let usual = read(&model)?.resolve().or_else(|_needs_a_file| RunFile::default().resolve());
        let usual = usual.map_err(ExperimentError::new)?.to_run_file();
        let differs =
            |(key, value): &(&str, &Value)| *key == MODEL || usual.get(key) != Some(value);
        let differing = own.values().filter(differs).map(|(key, value)| (key, value.clone()));
        Ok(Answer::Settings(differing.collect()))
    }

    /// A picture's name and how it is read.
    fn picture(&self, settings: BTreeMap<String, Value>) -> Result<(String, Run), ExperimentError> {
        let chosen = chosen(settings)?;
        let (_, run) = input::settle(None, &chosen, &self.files, &Interruption::default())?;
        Ok((run.shape.name().to_owned(), run))
    }

    fn analyse(&mut self, reading: &Reading) -> Result<Answer, ExperimentError> {
        let paths = vec![reading.name.clone().into()];
        let (table, beats) = (reading.table()?, reading.beats());
        self.results_of(&Analyse { paths, table, beats, curves: Vec::new() })
    }

    fn follow_posts(&mut self, film: OnPosts) -> Result<Answer, ExperimentError> {
        let OnPosts { film, post_places, post_stiffness_un_per_um } = film;
        self.results_of(&FollowPosts {
            track: track(film)?,
            posts: post_places.as_deref().map(posts::places).transpose()?,
            stiffness: post_stiffness_un_per_um.map(|stiffness| 1000.0 * stiffness),
        })
    }

    fn fit(&mut self, fit: Fit) -> Result<Answer, ExperimentError> {
        let traction = fit.on_gel().into_iter().collect();
        let Fit { curve, settings, free, peak_shortening_pct, .. } = fit;
        let sought = FitOptions { free, peak_shortening_pct, ..FitOptions::default() };
        self.results_of(&FitCell {
            table: curve.table()?,
            beats: curve.beats(),
            to: vec![curve.name.into()],
            settings: chosen(settings)?,
            traction,
            sought,
            threads: Some(1),
            ..FitCell::default()
        })
    }

    /// The results of an experiment, as the program would save them.
    fn results_of<E: Experiment>(&mut self, experiment: &E) -> Result<Answer, ExperimentError> {
        let told = Told::default();
        let outcome = experiment.run(&self.files, &told)?;
        let folder = Folder::in_memory();
        outcome.save(&folder, &told)?;
        self.finished(&folder, true)
    }

    fn finished(&mut self, folder: &Folder, is_shown: bool) -> Result<Answer, ExperimentError> {
        self.results = folder.contents();
        let listed = |(name, content): (&String, &Vec<u8>)| Listed {
            name: name.clone(),
            bytes: content.len(),
        };
        let files = self.results.iter().map(listed).collect();
        // Of several cells, the first.
        let report = || self.results.iter().find(|(name, _)| name.ends_with(FILE));
        let page = is_shown.then(report).flatten().map(|(name, html)| data(name, html));
        Ok(Answer::Results { page: page.transpose()?, files })
    }

    fn open(&self, name: &str) -> Result<Answer, ExperimentError> {
        let html = self
            .files
            .bytes(name)
            .map_err(|error| ExperimentError::unread(Path::new(name), &error))?;
        data(name, &html).map(Answer::Page)
    }
}

fn file(name: &str, bytes: &[u8]) -> Answer {
    // A browser saves a file, not a path.
    let name = name.rsplit('/').next().unwrap_or(name).to_owned();
    Answer::File { name, base64: STANDARD.encode(bytes) }
}

/// The data of a report.
fn data(name: &str, html: &[u8]) -> Result<Box<RawValue>, ExperimentError> {
    let none = || ExperimentError::new(format!("`{name}` is no report of Myospring"));
    let html = std::str::from_utf8(html).map_err(|_not_text| none())?;
    let data = page::data_of(html).ok_or_else(none)?;
    RawValue::from_string(data.to_owned()).map_err(|_no_data| none())
}

fn chosen(settings: BTreeMap<String, Value>) -> Result<Vec<ChosenSetting>, ExperimentError> {
    let chosen = settings.into_iter().map(|(key, value)| {
        let unknown = || ExperimentError::new(format!("there is no setting `{key}`"));
        Ok((settings::find(&key).ok_or_else(unknown)?, value))
    });
    chosen.collect()
}

/// How a film is followed.
fn track(film: Filmed) -> Result<Track, ExperimentError> {
    let (settings, frame_rate) = (chosen(film.settings)?, film.frame_rate_per_s);
    Ok(Track { settings, frame_rate, threads: Some(1), ..Track::of(film.name) })
}

/// A run as it is compared.
fn side(run: &FinishedRun) -> Result<Side, ExperimentError> {
    let (label, source, shape) =
        (run.run.title.clone(), run.name.clone(), run.shape_sha256.clone());
    Side::of(label, source, &run.run, &run.made, &run.outcome, shape)
}
