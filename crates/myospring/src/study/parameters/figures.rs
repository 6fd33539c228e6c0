//! The figures of a study, from its rows.

use super::super::sampling::Sampler;
use super::super::{Status, StudyError};
use super::answer::{Answer, Ranked, Sensitivity};
use super::description::{Design, Varied};
use super::rows::MemberRow;
use super::traces::TRACES;
use super::work::Common;
use crate::output::figure::{
    Bar, Distribution, Figure, FigureError, MemberResponse, Numbers, QUANTILES, Ranking,
    ResponseMap, Scatter, TraceBand, distributions, rankings, response_map, responses, scatter,
    trace_bands,
};
use crate::output::npy::Records;
use std::borrow::Cow;
use std::path::Path;

/// Bars of a ranking, and parameters of a scatter.
const BARS: usize = 10;
const PARAMETERS: usize = 12;
/// Members that are drawn, evenly from all.
const MEMBERS: usize = 50_000;
/// Members whose curves are drawn, at most.
const TRACED: usize = 5000;

/// A figure by the name of its file, without ending.
#[derive(Debug)]
pub struct Drawn {
    /// `sensitivity`, `distributions`, `scatter_peak_shortening`.
    pub name: String,
    /// The figure, or why there is none.
    pub figure: Result<Figure, FigureError>,
}

impl Answer<'_> {
    /// The figures that suit the design: rankings where there are indices, distributions of the metrics, each metric
    /// over its parameters, or response curves where these were sampled.
    ///
    /// `usual` are the metrics of the run without any change, in their order.
    pub fn figures(&self, usual: &[Option<f64>], sensitivity: &[Sensitivity]) -> Vec<Drawn> {
        let mut all = Vec::new();
        let mut add = |name: String, figure| all.push(Drawn { name, figure });
        let members = self.drawn();
        if members.is_empty() {
            return all;
        }
        if !sensitivity.is_empty() {
            let known = sensitivity.iter().filter(|one| !one.parameters.is_empty());
            let bars: Vec<Ranking> = known.map(ranking).collect();
            add("sensitivity".to_owned(), rankings(&bars));
        }
        let kept: Option<Vec<bool>> = (!self.study.keep.is_empty())
            .then(|| members.iter().map(|row| self.is_kept(*row)).collect());
        let metrics: Vec<Numbers> = (0..self.study.metrics.len())
            .map(|at| self.metric(at, members.iter().copied()))
            .collect();
        let band = |at: usize| self.study.keep.get(&self.study.metrics[at]).map(|band| band.0);
        let there = |at: &usize| differ(&metrics[*at].values);
        let there: Vec<usize> = (0..metrics.len()).filter(there).collect();
        let panels: Vec<Distribution> = there
            .iter()
            .map(|&at| Distribution {
                metric: metrics[at].clone(),
                band: band(at),
                usual: usual.get(at).copied().flatten(),
            })
            .collect();
        if panels.is_empty() {
            return all;
        }
        add("distributions".to_owned(), distributions(&panels, kept.as_deref()));
        let moving = self.study.moving();
        let design = match self.study.design {
            Design::Sampled { sampler, .. } => Some(sampler),
            Design::Table => None,
        };
        let named = |what: &str, at: usize| format!("{what}_{}", self.study.metrics[at]);
        match design {
            Some(Sampler::Grid { .. }) if moving.len() == 2 && self.is_whole() => {
                let map = self.map([moving[0], moving[1]], &there);
                add("response".to_owned(), response_map(&map));
            }
            Some(Sampler::Grid { .. }) if moving.len() == 1 => {
                let curves: Vec<MemberResponse> =
                    there.iter().map(|&at| self.response(moving[0], at, &members)).collect();
                add("response".to_owned(), responses(&curves));
            }
            Some(Sampler::OneAtATime { levels }) => {
                for &at in &there {
                    let curves: Vec<MemberResponse> = moving
                        .iter()
                        .zip(0..)
                        .map(|(&column, place)| {
                            let of = |row: &&MemberRow<'_>| (row.member - 1) / levels == place;
                            let rows: Vec<MemberRow<'_>> =
                                members.iter().filter(of).copied().collect();
                            self.response(column, at, &rows)
                        })
                        .collect();
                    add(named("response", at), responses(&curves));
                }
            }
            _ => {
                let parameters = self.parameters(&moving, &members);
                for &at in &there {
                    let ranked =
                        sensitivity.iter().find(|one| one.metric == self.study.metrics[at]);
                    let shown = self.most(&parameters, &metrics[at], ranked);
                    let given = Scatter {
                        metric: metrics[at].clone(),
                        parameters: shown,
                        kept: kept.clone(),
                        band: band(at),
                    };
                    add(named("scatter", at), scatter(&given));
                }
            }
        }
        all
    }

    /// The curves of the members that are kept, or of all: median, middle half and middle 90 %;
    /// `None` if the study stores no curves, or no member is kept. At most 5000 of them, evenly
    /// from all, are read.
    ///
    /// `folder` has the file of curves.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn trace_figure(
        &self,
        common: &Common,
        folder: &Path,
    ) -> Result<Option<Drawn>, StudyError> {
        let Some(axes) = &common.axes else { return Ok(None) };
        let kept: Vec<usize> =
            self.rows.iter().filter(|row| self.is_kept(*row)).map(|row| row.member).collect();
        if kept.is_empty() {
            return Ok(None);
        }
        let shape = [self.study.values.members(), axes.quantities.len(), axes.times];
        let mut records = Records::open(&folder.join(TRACES), &shape)?;
        let mut columns = vec![Vec::new(); axes.quantities.len() * axes.times];
        for member in kept.iter().step_by(kept.len().div_ceil(TRACED)) {
            for (column, number) in columns.iter_mut().zip(records.read(member - 1)?) {
                if number.is_finite() {
                    column.push(number);
                }
            }
        }
        for column in &mut columns {
            column.sort_by(f32::total_cmp);
        }
        let band = |(quantity, label): (usize, &&str)| {
            let of = quantity * axes.times..(quantity + 1) * axes.times;
            let below = |part: f64| {
                let value = |column: &Vec<f32>| {
                    let last = column.len().checked_sub(1)?;
                    Some(f64::from(column[(part * last as f64).round() as usize]))
                };
                let values = columns[of.clone()].iter().map(value);
                values.map(|value| value.unwrap_or(f64::NAN)).collect()
            };
            let usual = common.usual_curves.get(of.clone()).unwrap_or_default();
            TraceBand {
                label: (*label).to_owned(),
                quantiles: QUANTILES.map(below),
                usual: usual.iter().map(|&number| f64::from(number)).collect(),
            }
        };
        let bands: Vec<TraceBand> = axes.quantities.iter().enumerate().map(band).collect();
        let which = if self.study.keep.is_empty() { "members" } else { "members kept" };
        let words = format!("{} {which}", kept.len());
        let figure = trace_bands(&axes.times_ms(), &bands, &words);
        Ok(Some(Drawn { name: "traces".to_owned(), figure }))
    }

    /// Members that beat, evenly from all where there are very many.
    fn drawn(&self) -> Vec<MemberRow<'_>> {
        let beat = self.rows.iter().filter(|row| row.status == Status::Ok);
        let count = beat.clone().count();
        beat.step_by(count.div_ceil(MEMBERS).max(1)).collect()
    }

    fn metric<'a>(&self, at: usize, members: impl Iterator<Item = MemberRow<'a>>) -> Numbers {
        Numbers {
            label: labelled(&words(&self.study.metrics[at]), self.units.get(at).unwrap_or(&"")),
            values: members.map(|row| row.metric(at).unwrap_or(f64::NAN)).collect(),
        }
    }

    fn parameters(&self, columns: &[usize], members: &[MemberRow<'_>]) -> Vec<(usize, Numbers)> {
        let of = |row: &MemberRow<'_>| self.study.values.of(row.member);
        let rows: Vec<_> = members.iter().map(of).collect();
        let column = |&at: &usize| {
            let value = |row: &Option<Cow<'_, [f64]>>| row.as_ref()?.get(at).copied();
            let values = rows.iter().map(|row| value(row).unwrap_or(f64::NAN)).collect();
            (at, Numbers { label: label(&self.study.varied[at]), values })
        };
        columns.iter().map(column).collect()
    }

    fn value(&self, row: &MemberRow<'_>, at: usize) -> f64 {
        let values = self.study.values.of(row.member);
        values.and_then(|values| values.get(at).copied()).unwrap_or(f64::NAN)
    }

    /// The parameters that matter most for a metric: by their indices, or else by their rank correlation with it.
    fn most(
        &self,
        parameters: &[(usize, Numbers)],
        metric: &Numbers,
        ranked: Option<&Sensitivity>,
    ) -> Vec<Numbers> {
        let strength = |(at, numbers): &(usize, Numbers)| match ranked {
            Some(ranked) => {
                let key = &self.study.varied[*at].number.key;
                let of = ranked.parameters.iter().find(|one| one.parameter() == key);
                of.map_or(0.0, |one| one.rank().value)
            }
            None => rank_correlation(&numbers.values, &metric.values).abs(),
        };
        let mut order: Vec<(f64, &Numbers)> =
            parameters.iter().map(|both| (strength(both), &both.1)).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0));
        order.into_iter().take(PARAMETERS).map(|(_, numbers)| numbers.clone()).collect()
    }

    fn response(&self, column: usize, metric: usize, rows: &[MemberRow<'_>]) -> MemberResponse {
        let point =
            |row: &MemberRow<'_>| [self.value(row, column), row.metric(metric).unwrap_or(f64::NAN)];
        let usual = self.study.run.resolve().ok();
        MemberResponse {
            parameter: label(&self.study.varied[column]),
            metric: self.metric(metric, std::iter::empty()).label,
            points: rows.iter().map(point).collect(),
            usual: usual.and_then(|run| self.study.varied[column].number.get(&run)),
            band: self.study.keep.get(&self.study.metrics[metric]).map(|band| band.0),
        }
    }

    /// Metrics over a grid of two parameters, the second of which changes fastest.
    fn map(&self, columns: [usize; 2], metrics: &[usize]) -> ResponseMap {
        let values = columns.map(|column| {
            let members = 1..=self.study.values.members();
            let value = |member| Some(self.study.values.of(member)?[column]);
            let mut values: Vec<f64> = members.filter_map(value).collect();
            values.sort_by(f64::total_cmp);
            values.dedup();
            values
        });
        let metrics = metrics.iter().map(|&at| self.metric(at, self.rows.iter()));
        ResponseMap {
            parameters: columns.map(|column| label(&self.study.varied[column])),
            values,
            metrics: metrics.map(|numbers| (numbers.label, numbers.values)).collect(),
        }
    }
}

fn ranking(one: &Sensitivity) -> Ranking {
    let name = |key: &str| key.rsplit_once('.').map_or(key, |(_, name)| name).to_owned();
    let bars = one.parameters.iter().take(BARS).map(|ranked| Bar {
        name: name(ranked.parameter()),
        value: ranked.rank().value.max(0.0),
        confidence: ranked.rank().confidence,
        alone: match ranked {
            Ranked::Sobol { first, .. } => Some(first.value.max(0.0)),
            Ranked::Morris { .. } => None,
        },
    });
    let axis = match one.parameters.first() {
        Some(Ranked::Morris { .. }) => labelled("mean effect", one.unit),
        _ => "part of the variance".to_owned(),
    };
    Ranking { title: words(&one.metric), axis, bars: bars.collect() }
}

/// The words of a metric: `Peak shortening`.
fn words(metric: &str) -> String {
    let words = metric.replace('_', " ");
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn labelled(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") }
}

fn label(varied: &Varied) -> String {
    labelled(varied.number.name(), &varied.number.unit)
}

/// Whether some values differ by more than rounding: what is the same for all members is not drawn.
fn differ(values: &[f64]) -> bool {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let (low, high) =
        (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    high - low > 1e-9 * high.abs().max(low.abs())
}

/// Spearman's rank correlation over those that have both; 0 where there are fewer than three.
fn rank_correlation(a: &[f64], b: &[f64]) -> f64 {
    let both: Vec<[f64; 2]> = a
        .iter()
        .zip(b)
        .filter(|(a, b)| a.is_finite() && b.is_finite())
        .map(|(&a, &b)| [a, b])
        .collect();
    if both.len() < 3 {
        return 0.0;
    }
    let ranks = [0, 1].map(|axis: usize| {
        let mut order: Vec<usize> = (0..both.len()).collect();
        order.sort_by(|&i, &j| both[i][axis].total_cmp(&both[j][axis]));
        let mut ranks = vec![0.0; both.len()];
        for (rank, place) in order.into_iter().enumerate() {
            ranks[place] = rank as f64;
        }
        ranks
    });
    let middle = (both.len() - 1) as f64 / 2.0;
    let sum = |i: usize, j: usize| -> f64 {
        ranks[i].iter().zip(&ranks[j]).map(|(a, b)| (a - middle) * (b - middle)).sum()
    };
    sum(0, 1) / sum(0, 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rank_correlation_is_one_for_whatever_rises() {
        let x: Vec<f64> = (0..50).map(f64::from).collect();
        let rises: Vec<f64> = x.iter().map(|x| x.exp()).collect();
        let falls: Vec<f64> = x.iter().map(|x| -x * x).collect();
        assert!((rank_correlation(&x, &rises) - 1.0).abs() < 1e-12);
        assert!((rank_correlation(&x, &falls) + 1.0).abs() < 1e-12);
        assert!(rank_correlation(&x, &[f64::NAN; 50]).abs() < 1e-12);
    }
}
