//! The results of all members of a study.

use super::super::Status;
use super::super::sampling::Sampler;
use super::super::sensitivity::{Index, Pair, SensitivityError, morris, sobol};
use super::description::{Design, ParameterStudy};
use super::error::ParameterStudyError;
use super::member::VariationRow;
use super::rows::{MemberRow, Rows};
use crate::output::table::{Column, Table, column_name};
use serde::Serialize;
use std::ops::Range;

/// Rows that are written at a time.
const PIECE: usize = 1 << 14;

/// The rows of a study, in the order of its members.
pub struct Answer<'a> {
    pub(super) study: &'a ParameterStudy,
    pub(super) units: &'a [&'static str],
    pub(super) rows: Rows,
}

/// How many members are kept, and what rejects the others.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Acceptance {
    /// Members that beat.
    pub beat: usize,
    /// Those of them whose metrics lie in every band.
    pub kept: usize,
    /// Members that failed.
    pub failed: usize,
    /// Members that beat, but whose S2 raised no action potential.
    #[serde(skip_serializing_if = "is_none")]
    pub not_captured: usize,
    /// The rejections of each band; empty without bands.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bands: Vec<Rejected>,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde asks")]
fn is_none(count: &usize) -> bool {
    *count == 0
}

/// The members that one band rejects.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rejected {
    /// The metric.
    pub metric: String,
    /// Its unit.
    pub unit: &'static str,
    /// Least and largest value that is kept.
    pub band: [f64; 2],
    /// Members below it.
    pub below: usize,
    /// Members above it.
    pub above: usize,
    /// Members that beat without such a metric.
    pub without: usize,
    /// Members that only this band rejects.
    pub alone: usize,
    /// Median of the metric over all members that beat, and the range of the middle 90 %.
    pub found: Option<[f64; 3]>,
}

impl Rejected {
    /// How many members it rejects.
    pub fn all(&self) -> usize {
        self.below + self.above + self.without
    }
}

/// How much a metric depends on each parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sensitivity {
    /// The metric.
    pub metric: String,
    /// Its unit.
    pub unit: &'static str,
    /// Its parameters, the most important first.
    pub parameters: Vec<Ranked>,
    /// Interactions of pairs, by the names of both, the strongest first; where the design has them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pairs: Vec<([String; 2], Index)>,
    /// Base points or trajectories that were used.
    pub used: usize,
    /// Those that were left out, since a member of theirs failed or does not have the metric.
    pub left_out: usize,
}

impl Sensitivity {
    /// For a metric that too few members have.
    fn none(metric: &str, unit: &'static str, left_out: usize) -> Self {
        let (metric, parameters, pairs) = (metric.to_owned(), Vec::new(), Vec::new());
        Self { metric, unit, parameters, pairs, used: 0, left_out }
    }
}

/// The result, or `None` if too few members have the metric.
fn enough<T>(found: Result<T, SensitivityError>) -> Result<Option<T>, SensitivityError> {
    match found {
        Err(SensitivityError::TooFew { .. }) => Ok(None),
        found => found.map(Some),
    }
}

/// The sensitivity to one parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Ranked {
    /// By Sobol's indices.
    Sobol {
        /// Its key.
        parameter: String,
        /// Part of the variance that it causes alone.
        first: Index,
        /// Part of the variance that it causes alone and with others.
        total: Index,
    },
    /// By Morris's elementary effects, in the metric's unit over the whole range of the parameter.
    Morris {
        /// Its key.
        parameter: String,
        /// Mean size of the effects, with half of its 95 % confidence interval.
        mean_size: Index,
        /// Mean of the effects.
        mean: f64,
        /// Their standard deviation.
        spread: f64,
    },
}

impl Ranked {
    /// The parameter's key.
    pub fn parameter(&self) -> &str {
        match self {
            Self::Sobol { parameter, .. } | Self::Morris { parameter, .. } => parameter,
        }
    }

    /// The number by which it is ranked.
    pub fn rank(&self) -> Index {
        match self {
            Self::Sobol { total, .. } => *total,
            Self::Morris { mean_size, .. } => *mean_size,
        }
    }
}

/// Where a metric lies, seen from a band.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    Inside,
    Below,
    Above,
    Nowhere,
}

impl Place {
    fn is_inside(self) -> bool {
        self == Self::Inside
    }
}

fn lies(row: MemberRow<'_>, at: usize, [low, high]: [f64; 2]) -> Place {
    match row.metric(at) {
        Some(value) if value < low => Place::Below,
        Some(value) if value > high => Place::Above,
        Some(value) if value.is_finite() => Place::Inside,
        _ => Place::Nowhere,
    }
}

impl<'a> Answer<'a> {
    /// From the available rows, in any order; `units` are those of the metrics.
    pub fn new(study: &'a ParameterStudy, units: &'a [&'static str], rows: Rows) -> Self {
        Self { study, units, rows: rows.sorted() }
    }

    /// From the rows of a table that [`Answer::table`] gave and CSV stored.
    ///
    /// # Errors
    /// An invalid table, or one of another study.
    pub fn from_csv(
        study: &'a ParameterStudy,
        units: &'a [&'static str],
        csv: &[u8],
    ) -> Result<Self, ParameterStudyError> {
        let wrong = |cause: String| ParameterStudyError::Members { cause };
        let mut reader = csv::Reader::from_reader(csv);
        let header = reader.headers().map_err(|error| wrong(error.to_string()))?.clone();
        let place = |name: &str| {
            let found = header.iter().position(|known| known == name);
            found.ok_or_else(|| wrong(format!("it has no column {name}")))
        };
        let (member, status, reason) = (place("member")?, place("status")?, place("reason")?);
        let number = |varied: &super::description::Varied| {
            place(&column_name(varied.number.name(), &varied.number.unit))
        };
        let values: Vec<usize> = study.varied.iter().map(number).collect::<Result<_, _>>()?;
        let metrics = study.metrics.iter().zip(units);
        let metrics: Vec<usize> = metrics
            .map(|(name, unit)| place(&column_name(name, unit)))
            .collect::<Result<_, _>>()?;
        let mut rows = Rows::default();
        for record in reader.records() {
            let record = record.map_err(|error| wrong(error.to_string()))?;
            let text = |at: usize| record.get(at).unwrap_or_default();
            let line = record.position().map_or(0, csv::Position::line);
            let of_study = text(member).parse::<usize>().ok().and_then(|member| {
                let known = study.values.of(member)?;
                let same = |(&at, known): (&usize, &f64)| text(at).parse() == Ok(*known);
                values.iter().zip(&*known).all(same).then_some(member)
            });
            let member = of_study.ok_or_else(|| {
                wrong(format!("line {line} is no member of this study; run it, or name its folder"))
            })?;
            let value = |&at: &usize| text(at).parse().ok();
            rows.extend([match text(status) {
                "ok" => VariationRow {
                    reason: text(reason).to_owned(),
                    ..VariationRow::done(member, metrics.iter().map(value).collect())
                },
                _ => super::super::Row::failed(&member.to_string(), text(reason).to_owned()),
            }]);
        }
        Ok(Self::new(study, units, rows))
    }

    /// The rows, in the order of the members.
    pub fn rows(&self) -> &Rows {
        &self.rows
    }

    /// Whether every member has a row.
    pub fn is_whole(&self) -> bool {
        self.rows.len() == self.study.values.members()
    }

    /// Whether a member's metrics lie in every band.
    pub fn is_kept(&self, row: MemberRow<'_>) -> bool {
        row.status == Status::Ok && self.bands().all(|(at, band)| lies(row, at, band).is_inside())
    }

    /// The metrics with a band, by their places.
    fn bands(&self) -> impl Iterator<Item = (usize, [f64; 2])> {
        let metrics = self.study.metrics.iter().enumerate();
        metrics.filter_map(|(at, name)| Some((at, self.study.keep.get(name)?.0)))
    }

    /// How many members are kept, and what rejects the others.
    pub fn acceptance(&self) -> Acceptance {
        let beat = || self.rows.iter().filter(|row| row.status == Status::Ok);
        let bands: Vec<(usize, [f64; 2])> = self.bands().collect();
        let of = |&(at, band): &(usize, [f64; 2])| {
            let mut of = Rejected {
                metric: self.study.metrics[at].clone(),
                unit: self.units.get(at).copied().unwrap_or_default(),
                band,
                below: 0,
                above: 0,
                without: 0,
                alone: 0,
                found: None,
            };
            for row in beat() {
                let count = match lies(row, at, band) {
                    Place::Inside => continue,
                    Place::Below => &mut of.below,
                    Place::Above => &mut of.above,
                    Place::Nowhere => &mut of.without,
                };
                *count += 1;
                let mut others = bands.iter().filter(|(other, _)| *other != at);
                let others = others.all(|&(at, band)| lies(row, at, band).is_inside());
                of.alone += usize::from(others);
            }
            let mut values: Vec<f64> = beat().filter_map(|row| row.metric(at)).collect();
            values.sort_by(f64::total_cmp);
            let part = |part: f64| values[(part * (values.len() - 1) as f64).round() as usize];
            of.found = (!values.is_empty()).then(|| [0.05, 0.5, 0.95].map(part));
            of
        };
        Acceptance {
            beat: beat().count(),
            kept: self.rows.iter().filter(|row| self.is_kept(*row)).count(),
            failed: self.rows.iter().filter(|row| row.status == Status::Failed).count(),
            not_captured: beat().filter(|row| !row.reason.is_empty()).count(),
            bands: bands.iter().map(of).collect(),
        }
    }

    /// One row per member: its values, metrics and status.
    pub fn table(&self) -> Table {
        self.piece(0..self.rows.len())
    }

    /// The table in pieces of some 16 000 rows, one below the other: at least one.
    pub fn pieces(&self) -> impl Iterator<Item = Table> {
        let count = self.rows.len();
        let starts = (0..count.max(1)).step_by(PIECE);
        starts.map(move |start| self.piece(start..count.min(start + PIECE)))
    }

    fn piece(&self, places: Range<usize>) -> Table {
        let rows: Vec<MemberRow<'_>> = places.filter_map(|at| self.rows.get(at)).collect();
        let number = |name: String, value: &dyn Fn(&MemberRow<'_>) -> Option<f64>| Column::Number {
            name,
            values: rows.iter().map(value).collect(),
        };
        let text = |name: &str, value: &dyn Fn(&MemberRow<'_>) -> String| Column::Text {
            name: name.to_owned(),
            values: rows.iter().map(|row| Some(value(row))).collect(),
        };
        let mut columns = vec![number("member".to_owned(), &|row| Some(row.member as f64))];
        let values: Vec<_> = rows.iter().map(|row| self.study.values.of(row.member)).collect();
        for (at, varied) in self.study.varied.iter().enumerate() {
            let name = column_name(varied.number.name(), &varied.number.unit);
            let values = values.iter().map(|values| values.as_ref()?.get(at).copied()).collect();
            columns.push(Column::Number { name, values });
        }
        for (at, (name, unit)) in self.study.metrics.iter().zip(self.units).enumerate() {
            columns.push(number(column_name(name, unit), &|row| row.metric(at)));
        }
        if !self.study.keep.is_empty() {
            columns.push(text("kept", &|row| self.is_kept(*row).to_string()));
        }
        columns.push(text("status", &|row| row.status.to_string()));
        columns.push(text("reason", &|row| row.reason.to_owned()));
        Table { columns }
    }

    /// How much each metric depends on each parameter; empty if the design does not allow it, or
    /// members are missing. A metric that fewer than two base points or trajectories have in all
    /// their members has no parameters, and all are left out.
    ///
    /// # Errors
    /// Rows that are not those of the design.
    pub fn sensitivity(&self) -> Result<Vec<Sensitivity>, ParameterStudyError> {
        let Design::Sampled { sampler, seed } = self.study.design else { return Ok(Vec::new()) };
        let moving = self.study.moving();
        let name = |at: usize| self.study.varied[moving[at]].number.key.clone();
        let mut all = Vec::new();
        for (at, (metric, &unit)) in self.study.metrics.iter().zip(self.units).enumerate() {
            if !self.is_whole() {
                break;
            }
            let value = |row: MemberRow<'_>| row.metric(at).unwrap_or(f64::NAN);
            let answers: Vec<f64> = self.rows.iter().map(value).collect();
            let constant = || answers.iter().all(|answer| *answer == answers[0]);
            if constant() {
                continue;
            }
            let (mut parameters, mut pairs, used, left_out) = match sampler {
                Sampler::Saltelli { size, pairs } => {
                    let Some(found) = enough(sobol(&answers, moving.len(), pairs, seed))? else {
                        all.push(Sensitivity::none(metric, unit, size));
                        continue;
                    };
                    let both = found.first.iter().zip(&found.total).enumerate();
                    let of = |(at, (&first, &total))| Ranked::Sobol {
                        parameter: name(at),
                        first,
                        total,
                    };
                    let couple = |Pair { of, index }: &Pair| (of.map(name), *index);
                    let pairs: Vec<_> = found.pairs.iter().map(couple).collect();
                    (both.map(of).collect::<Vec<_>>(), pairs, found.used, found.left_out)
                }
                Sampler::Morris { trajectories, .. } => {
                    let points: Vec<_> = sampler.unit_cube(moving.len(), seed)?.iter().collect();
                    let Some(found) = enough(morris(&points, &answers, moving.len(), seed))? else {
                        all.push(Sensitivity::none(metric, unit, trajectories));
                        continue;
                    };
                    let of = |(at, effect): (usize, &super::super::sensitivity::Effect)| {
                        Ranked::Morris {
                            parameter: name(at),
                            mean_size: Index {
                                value: effect.mean_size,
                                confidence: effect.confidence,
                            },
                            mean: effect.mean,
                            spread: effect.spread,
                        }
                    };
                    let effects = found.effects.iter().enumerate().map(of).collect();
                    (effects, Vec::new(), found.used, found.left_out)
                }
                _ => return Ok(Vec::new()),
            };
            parameters.sort_by(|a, b| b.rank().value.total_cmp(&a.rank().value));
            pairs.sort_by(|a, b| b.1.value.total_cmp(&a.1.value));
            all.push(Sensitivity {
                metric: metric.clone(),
                unit,
                parameters,
                pairs,
                used,
                left_out,
            });
        }
        Ok(all)
    }
}
