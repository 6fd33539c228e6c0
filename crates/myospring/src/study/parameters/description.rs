//! The description of a study of parameters, from TOML.

use super::super::sampling::{Distribution, Sampler, sample};
use super::cell_metrics;
use super::error::ParameterStudyError;
use super::values::Values;
use crate::cell::solve::CellMethod;
use crate::interruption::Interruption;
use crate::measured::decoded;
use crate::run_file::{RunFile, RunFileError};
use crate::settings::{Models, Named, NumericSetting, Run, Value, read_toml};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io;

const PARAMETERS: &str = "cell.parameters";

/// The kind of members.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MemberKind {
    /// A cell that beats: electrical activity, tension and shape.
    #[default]
    Beat,
    /// Action potential and tension only, many cells side by side.
    Cell,
}

/// Which beat's metrics count, if a run has several.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CountedBeat {
    /// The first.
    First,
    /// The last: that of an S2, where there is one.
    #[default]
    Last,
    /// The mean over the beats of the train.
    Mean,
}

/// A band in which a metric has to lie for a member to be kept.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AcceptanceBand(
    /// Least and largest value, in the metric's unit.
    pub [f64; 2],
);

/// A number of the run that a study varies.
#[derive(Debug, Clone, PartialEq)]
pub struct Varied {
    /// The number.
    pub number: NumericSetting,
    /// How its values are distributed; `None` if a table has them.
    pub distribution: Option<Distribution>,
}

/// Where the values come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Design {
    /// Sampled.
    Sampled {
        /// How.
        sampler: Sampler,
        /// Seed of all random numbers.
        seed: u64,
    },
    /// Rows from a table.
    Table,
}

/// A study of parameters: what its members have in common, and how they differ.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterStudy {
    /// Title, for people.
    pub title: String,
    /// What every member is.
    pub kind: MemberKind,
    /// What all have in common.
    pub run: RunFile,
    /// The varied numbers, in alphabetical order, or in the order of a table's columns.
    pub varied: Vec<Varied>,
    /// Where the values come from.
    pub design: Design,
    /// Names of the metrics that are wanted, in order.
    pub metrics: Vec<String>,
    /// Which beat counts.
    pub beat: CountedBeat,
    /// Bands by metric.
    pub keep: BTreeMap<String, AcceptanceBand>,
    /// Whether the curves of each member are stored.
    pub traces: bool,
    /// The values of each member.
    pub values: Values,
    /// Interruption of the preparation ([`Common::new`](super::Common::new)); not part of a file.
    pub interruption: Interruption,
}

/// The error in the table `[sampling]`, in the words of its author.
fn in_sampling(error: &toml::de::Error) -> ParameterStudyError {
    let whole = "a whole number from 0 on";
    let cause = ["usize", "u64", "u32"].iter().fold(error.message().to_owned(), |text, kind| {
        text.replace(&format!("expected {kind}"), &format!("expected {whole}"))
    });
    ParameterStudyError::Design { cause }
}

/// As it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Written {
    #[serde(default)]
    title: String,
    #[serde(default)]
    kind: MemberKind,
    #[serde(default)]
    metrics: Vec<String>,
    #[serde(default)]
    beat: CountedBeat,
    #[serde(default)]
    run: Option<toml::Value>,
    #[serde(default)]
    parameters: toml::Table,
    #[serde(default)]
    sampling: Option<toml::Table>,
    #[serde(default)]
    keep: BTreeMap<String, AcceptanceBand>,
    #[serde(default)]
    traces: Option<bool>,
}

impl Written {
    /// The run that members have in common; `read` reads a run file that it names.
    fn run_file(
        &self,
        models: Models,
        read: impl Fn(&str) -> Result<String, ParameterStudyError>,
    ) -> Result<RunFile, ParameterStudyError> {
        let run = match &self.run {
            None => RunFile::default(),
            Some(toml::Value::String(path)) => RunFile::from_text(&read(path)?)?,
            Some(tables) => RunFile::from_text(&toml::to_string(tables).unwrap_or_default())?,
        };
        let run = ParameterStudy::along_equilibria(run.knowing(models))?;
        if self.kind == MemberKind::Cell && !run.has("cell.tolerance") {
            let mut with = run.clone();
            with.set("cell.tolerance", STIFF_TOLERANCE)?;
            if with.resolve().is_ok_and(|run| run.cell_settings().method == CellMethod::Stiff) {
                return Ok(with);
            }
        }
        Ok(run)
    }
}

/// `[sampling]` of a table.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OfTable {
    #[serde(rename = "sampler")]
    _sampler: String,
    file: String,
}

/// Populations of up to this many members store their curves by default: some 15 MB.
const TRACED: usize = 5000;

/// Default tolerance of cells in stiff steps: APD90 is right to 0.001 ms, calcium to 0.01 %.
const STIFF_TOLERANCE: f64 = 1e-4;

/// Default metrics of a beat.
const OF_BEATS: [&str; 9] = [
    "peak_shortening",
    "time_to_peak_from_stimulus",
    "maximum_shortening_rate",
    "maximum_relengthening_rate",
    "relaxation_time_50",
    "relaxation_time_90",
    "peak_tension",
    "time_to_peak_tension",
    "action_potential_duration_90",
];

impl ParameterStudy {
    /// Reads a description; `read` reads a file by its name as written: a run file, a table of rows.
    ///
    /// # Errors
    /// What is wrong with it, with its place.
    ///
    /// # Example
    /// ```
    /// use myospring::study::parameters::ParameterStudy;
    /// let study = ParameterStudy::from_toml(
    ///     r#"
    ///     metrics = ["peak_shortening"]
    ///     [parameters]
    ///     tau_si = { distribution = "uniform", low = 0.98, high = 1.02, relative = true }
    ///     thickness = { distribution = "normal", mean = "10 um", standard_deviation = "1 um" }
    ///     [sampling]
    ///     sampler = "latin-hypercube"
    ///     size = 20
    ///     "#,
    ///     |_file| Err(std::io::ErrorKind::NotFound.into()),
    /// )?;
    /// assert_eq!((study.values.members(), study.varied[1].number.unit.as_str()), (20, "um"));
    /// # Ok::<(), myospring::study::parameters::ParameterStudyError>(())
    /// ```
    pub fn from_toml(
        text: &str,
        read: impl Fn(&str) -> io::Result<Vec<u8>>,
    ) -> Result<Self, ParameterStudyError> {
        Self::from_toml_knowing(text, Models::default(), read)
    }

    /// As [`ParameterStudy::from_toml`], for a run that may name custom cell models.
    ///
    /// # Errors
    /// What is wrong with it, with its place.
    pub fn from_toml_knowing(
        text: &str,
        models: Models,
        read: impl Fn(&str) -> io::Result<Vec<u8>>,
    ) -> Result<Self, ParameterStudyError> {
        let written: Written = read_toml(text)?;
        let read_text = |what, path: &str| {
            let failed = |cause| ParameterStudyError::Read { what, path: path.to_owned(), cause };
            let bytes = read(path).map_err(failed)?;
            decoded(&bytes).map_err(|_| failed(io::ErrorKind::InvalidData.into()))
        };
        let run = written.run_file(models, |path| read_text("run", path))?;
        let base = run.resolve()?;
        let sampling = written.sampling.ok_or(ParameterStudyError::NoSampling)?;
        let (varied, design, values) = if sampling.get("sampler") == Some(&"table".into()) {
            tabled(sampling, &written.parameters, &base, |path| read_text("[sampling] file", path))?
        } else {
            sampled(sampling, &written.parameters, &base)?
        };
        let unknown = |varied: &&Varied| varied.number.get(&base).is_none();
        if let (MemberKind::Cell, Some(Varied { number, .. })) =
            (written.kind, varied.iter().find(unknown))
        {
            let (name, key) = (number.name().to_owned(), number.key.clone());
            return Err(ParameterStudyError::NoUsual { name, key });
        }
        let mut metrics = written.metrics;
        if metrics.is_empty() {
            metrics = match written.kind {
                MemberKind::Cell => cell_metrics::metrics(&base)
                    .iter()
                    .map(|(name, _)| (*name).to_owned())
                    .collect(),
                MemberKind::Beat => OF_BEATS.iter().map(|name| (*name).to_owned()).collect(),
            };
        }
        for (metric, AcceptanceBand([low, high])) in &written.keep {
            // Nothing lies within NaN.
            if low.partial_cmp(high).is_none_or(std::cmp::Ordering::is_gt) {
                let (metric, band) = (metric.clone(), [*low, *high]);
                return Err(ParameterStudyError::Band { metric, band });
            }
        }
        // Metrics with a band are computed, too.
        for name in
            written.keep.keys().filter(|name| !metrics.contains(name)).cloned().collect::<Vec<_>>()
        {
            metrics.push(name);
        }
        let population = match design {
            Design::Table => true,
            Design::Sampled { sampler, .. } => sampler.is_population(),
        };
        let traces = written.traces.unwrap_or(population && values.members() <= TRACED);
        Ok(Self {
            title: written.title,
            kind: written.kind,
            run,
            varied,
            design,
            metrics,
            beat: written.beat,
            keep: written.keep,
            traces,
            values,
            interruption: Interruption::default(),
        })
    }

    /// A run along its equilibria, as is usual for many members, unless it names another method or does not support this one.
    ///
    /// # Errors
    /// None for a run file that can be read.
    pub fn along_equilibria(run: RunFile) -> Result<RunFile, RunFileError> {
        let key = "numerics.integrator";
        if run.has(key) {
            return Ok(run);
        }
        let mut along = run.clone();
        along.set(key, "quasi-static")?;
        Ok(if along.resolve().is_ok() { along } else { run })
    }

    /// A study of given rows: beats of a run in which each of these numbers has the value of its
    /// column. Metrics are the mean over the beats of a run; methods are those of the run, or its
    /// usual ones.
    ///
    /// # Errors
    /// Rows of another length than there are numbers.
    ///
    /// # Example
    /// ```
    /// use myospring::run_file::RunFile;
    /// use myospring::settings::NumericSetting;
    /// use myospring::study::parameters::{Common, ParameterStudy, Shard, run};
    /// use myospring::study::{Journal, Threads};
    ///
    /// let file = RunFile::from_text("numerics.integrator = \"quasi-static\"")?;
    /// let tension = NumericSetting::named(&file.resolve()?, "peak_tension")?;
    /// let metrics = vec!["peak_shortening".to_owned()];
    /// let study = ParameterStudy::of_rows(file, vec![tension], metrics, vec![vec![20.0], vec![50.0]])?;
    /// let common = Common::new(&study, |file| std::fs::read(file))?;
    /// let (journal, threads) = (Journal::in_memory(), Threads::new(None)?);
    /// let rows: Vec<_> = run(&study, &common, Shard::WHOLE, &journal, &threads, &())?.rows;
    /// assert!(rows[0].metrics[0] < rows[1].metrics[0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of_rows(
        run: RunFile,
        numbers: Vec<NumericSetting>,
        metrics: Vec<String>,
        values: Vec<Vec<f64>>,
    ) -> Result<Self, ParameterStudyError> {
        if let Some((row, of)) = values.iter().enumerate().find(|(_, of)| of.len() != numbers.len())
        {
            let (length, columns) = (of.len(), numbers.len());
            return Err(ParameterStudyError::Length { row: row + 1, length, columns });
        }
        let varied = numbers.into_iter().map(|number| Varied { number, distribution: None });
        Ok(Self {
            title: String::new(),
            kind: MemberKind::Beat,
            run,
            varied: varied.collect(),
            design: Design::Table,
            metrics,
            beat: CountedBeat::Mean,
            keep: BTreeMap::new(),
            traces: false,
            values: Values::Table(values),
            interruption: Interruption::default(),
        })
    }

    /// The run file of a member.
    ///
    /// # Errors
    /// A value of the wrong kind; bounds are checked when it is resolved.
    pub fn run_of(&self, values: &[f64]) -> Result<RunFile, RunFileError> {
        run_of(&self.run, &self.varied, values)
    }

    /// The columns in which members differ.
    pub fn moving(&self) -> Vec<usize> {
        let fixed = |varied: &Varied| varied.distribution.is_some_and(|it| it.is_fixed());
        (0..self.varied.len()).filter(|&at| !fixed(&self.varied[at])).collect()
    }
}

/// What varies, where its values come from, and the values.
type Members = (Vec<Varied>, Design, Values);

/// The members of a table that `read` reads.
fn tabled(
    sampling: toml::Table,
    parameters: &toml::Table,
    base: &Run,
    read: impl Fn(&str) -> Result<String, ParameterStudyError>,
) -> Result<Members, ParameterStudyError> {
    let OfTable { file, .. } = OfTable::deserialize(toml::Value::Table(sampling))
        .map_err(|error| ParameterStudyError::Table { cause: error.message().to_owned() })?;
    if !parameters.is_empty() {
        let cause = format!(
            "the columns of `{file}` are what varies, so [parameters] would not be used: leave it out"
        );
        return Err(ParameterStudyError::Table { cause });
    }
    let (varied, values) = rows_of_table(&file, &read(&file)?, base)?;
    Ok((varied, Design::Table, Values::Table(values)))
}

/// The members that a sampler draws.
fn sampled(
    mut sampling: toml::Table,
    parameters: &toml::Table,
    base: &Run,
) -> Result<Members, ParameterStudyError> {
    let seed = match sampling.remove("seed") {
        None => 1,
        Some(seed) => u64::deserialize(seed).map_err(|error| in_sampling(&error))?,
    };
    let sampler = Sampler::deserialize(toml::Value::Table(sampling));
    let sampler = sampler.map_err(|error| in_sampling(&error))?;
    let varied = varied(parameters, base)?;
    let distributions: Vec<Distribution> =
        varied.iter().filter_map(|varied| varied.distribution).collect();
    let values = sample(&sampler, &distributions, seed)?;
    Ok((varied, Design::Sampled { sampler, seed }, Values::Sampled(values)))
}

/// The numbers that vary, with their distributions in the units of these numbers.
fn varied(written: &toml::Table, base: &Run) -> Result<Vec<Varied>, ParameterStudyError> {
    let mut all: Vec<Varied> = Vec::new();
    for (name, value) in written {
        let number = NumericSetting::named(base, name)?;
        if all.iter().any(|other| other.number == number) {
            return Err(ParameterStudyError::Twice { key: number.key });
        }
        let name = || name.clone();
        let wrong = |cause: String| ParameterStudyError::Distribution { name: name(), cause };
        let toml::Value::Table(mut table) = value.clone() else {
            return Err(wrong(
                "write a distribution, like { distribution = \"uniform\", low = 1, high = 2 }"
                    .to_owned(),
            ));
        };
        let relative = match table.remove("relative") {
            None => false,
            Some(toml::Value::Boolean(relative)) => relative,
            Some(other) => return Err(wrong(format!("relative is true or false, not {other}"))),
        };
        for (what, value) in table.iter_mut().filter(|(what, _)| *what != "distribution") {
            if let toml::Value::String(text) = value {
                if relative {
                    return Err(wrong(format!(
                        "{what} = \"{text}\": with relative = true it is a factor, a number without quotes and unit, like \
                         {what} = 0.9"
                    )));
                }
                let failed =
                    |cause| ParameterStudyError::Unit { name: name(), what: what.clone(), cause };
                *value = number.read(text).map_err(failed)?.into();
            }
        }
        let distribution = Distribution::deserialize(toml::Value::Table(table))
            .map_err(|error| wrong(error.message().to_owned()))?;
        let distribution = if relative {
            let usual =
                number.get(base).ok_or_else(|| ParameterStudyError::NoValue { name: name() })?;
            distribution.times(usual)
        } else {
            distribution
        };
        distribution.check().map_err(|error| wrong(error.to_string()))?;
        all.push(Varied { number, distribution: Some(distribution) });
    }
    Ok(all)
}

/// The numbers and values of a table: a column for each number, named as it is or by its key.
fn rows_of_table(
    path: &str,
    text: &str,
    base: &Run,
) -> Result<(Vec<Varied>, Vec<Vec<f64>>), ParameterStudyError> {
    let wrong = |cause: String| ParameterStudyError::Rows { path: path.to_owned(), cause };
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| wrong(error.to_string()))?.clone();
    let mut varied: Vec<Varied> = Vec::new();
    for name in &header {
        let number = NumericSetting::named(base, name)?;
        if varied.iter().any(|other| other.number == number) {
            return Err(ParameterStudyError::Twice { key: number.key });
        }
        varied.push(Varied { number, distribution: None });
    }
    let mut values = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| wrong(error.to_string()))?;
        let line = record.position().map_or(0, csv::Position::line);
        let row = record.iter().zip(&varied).map(|(text, varied)| {
            let said =
                |error| wrong(format!("line {line}, column {}: {error}", varied.number.name()));
            match text.parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(value),
                _ => varied.number.read(text).map_err(said),
            }
        });
        values.push(row.collect::<Result<Vec<f64>, _>>()?);
    }
    if values.is_empty() {
        return Err(wrong("it has no rows".to_owned()));
    }
    Ok((varied, values))
}

/// A run file with other values of some numbers.
pub(super) fn run_of(
    run: &RunFile,
    varied: &[Varied],
    values: &[f64],
) -> Result<RunFile, RunFileError> {
    let mut file = run.clone();
    for (varied, value) in varied.iter().zip(values) {
        write(&varied.number, &mut file, *value)?;
    }
    Ok(file)
}

/// Puts a value of a number, in its unit, into a run file.
fn write(number: &NumericSetting, file: &mut RunFile, value: f64) -> Result<(), RunFileError> {
    let Some(parameter) = number.parameter() else {
        return file.set(&number.key, number.written(value));
    };
    let mut all = match file.get(PARAMETERS) {
        Some(Value::Named(named)) => named.clone(),
        _ => Named::new(),
    };
    all.insert(parameter.to_owned(), Value::Number(value));
    file.set(PARAMETERS, Value::Named(all))
}
