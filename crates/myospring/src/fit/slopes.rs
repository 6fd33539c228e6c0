//! Derivatives of residuals by the unknowns.
//!
//! Numbers of the cell change the whole curve, so their derivatives are differences of curves.
//! Levels, gain and drift are factors and sums, so their derivatives are exact. A delay shifts only
//! its own beat, so the derivatives by all delays of a curve together cost a few curves.

use super::least_squares::{Column, Problem, difference};
use super::observed::Scale;
use super::problem::{Layout, Response, Role};
use super::work::Work;

/// Derivatives by the unknowns, from their values and which of them are fixed.
pub(super) type Slopes<'a> = dyn Fn(&[f64], &[bool]) -> Option<Vec<Column>> + Sync + 'a;

/// A search ends when a step lowers chi squared by less than this; one standard deviation raises it
/// by 1.
const ENOUGH: f64 = 1e-5;

/// Of the frames of one curve.
struct Frames {
    /// What it shows without level and scale: the shortening, or a load.
    response: Vec<f64>,
    /// The derivative of each value by that.
    by_response: Vec<f64>,
    /// The derivative of a load by the shortening.
    load_by_shortening: Option<Vec<f64>>,
    /// The time of each as a part of the recording, from -1/2 to 1/2.
    part: Vec<f64>,
    /// How many frames that count are before each, and in all.
    before: Vec<usize>,
    /// The first residual of this curve.
    first: usize,
}

impl Layout {
    /// The residuals; counts one evaluation.
    pub(super) fn counted<'a>(
        &'a self,
        work: &'a Work<'a>,
    ) -> impl Fn(&[f64]) -> Option<Vec<f64>> + Sync + 'a {
        move |at| if work.counts() { self.residuals(at) } else { None }
    }

    /// The least-squares problem.
    pub(super) fn problem<'a>(
        &'a self,
        residuals: &'a (dyn Fn(&[f64]) -> Option<Vec<f64>> + Sync),
        slopes: &'a Slopes<'a>,
    ) -> Problem<'a> {
        let frames = self.sources.iter().map(|source| source.frames.values.len()).sum::<usize>();
        let enough = ENOUGH / frames.max(1) as f64;
        let (bounds, steps) = (&self.bounds, &self.steps);
        Problem { residuals, slopes: Some(slopes), bounds, steps, enough }
    }

    /// Derivatives of the residuals, a column for each unknown, empty for fixed ones.
    pub(super) fn slopes(&self, at: &[f64], held: &[bool], work: &Work<'_>) -> Option<Vec<Column>> {
        let all = (0..self.sources.len()).collect::<Vec<_>>();
        let mut first = 0;
        let frames = all.iter().map(|&number| {
            let frames = self.frames(at, number, first)?;
            first += frames.before.last().copied().unwrap_or(0);
            Some(frames)
        });
        let frames = frames.collect::<Option<Vec<Frames>>>()?;
        if !work.counts() {
            return None;
        }
        let delays = all.iter().map(|&number| self.by_stimulus(at, held, number));
        let delays = delays.collect::<Option<Vec<_>>>()?;
        let rows = first + self.scale_errors().count();
        let column = |(place, role): (usize, &Role)| {
            if held[place] {
                return Some(Column::default());
            }
            Some(match role {
                Role::Physics(_) => {
                    let mut values = Vec::with_capacity(first);
                    for &number in &all {
                        let source = &self.sources[number];
                        let of = |at: &[f64]| {
                            let wanted = work.counts();
                            wanted.then(|| {
                                let response = self.response(at, number, &source.frames.times)?;
                                Some(response.values)
                            })?
                        };
                        let (step, bounds) = (self.steps[place], &self.bounds);
                        let moved = if source.contraction.is_slow() {
                            one_sided(of, at, place, step, bounds, &frames[number].response)?
                        } else {
                            difference(of, at, place, step, bounds)?
                        };
                        let whole = Column { first: 0, values: moved };
                        let part = self.by_response(number, &frames[number], &whole);
                        values.extend(part.values);
                    }
                    Column { first: 0, values }
                }
                Role::Delay { source, beat: Some(beat) } => {
                    self.by_shortening(*source, &frames[*source], &delays[*source][*beat])
                }
                // All of them at once.
                Role::Delay { source, beat: None } => {
                    let count = frames[*source].response.len();
                    let mut sum = Column { first: 0, values: vec![0.0; count] };
                    for one in &delays[*source] {
                        for (sum, value) in sum.values[one.first..].iter_mut().zip(&one.values) {
                            *sum += value;
                        }
                    }
                    self.by_shortening(*source, &frames[*source], &sum)
                }
                Role::Level { source } | Role::Drift { source } | Role::Gain { source } => {
                    self.by_scale(role, *source, &frames[*source])
                }
                Role::ScaleError { source } => {
                    let mut column = self.by_scale(role, *source, &frames[*source]);
                    let mut errors = self.scale_errors().enumerate();
                    let (row, deviation) = errors.find_map(|(row, (at, deviation))| {
                        (at == place).then_some((row, deviation))
                    })?;
                    column.values.resize(rows - column.first, 0.0);
                    column.values[first + row - column.first] = deviation.recip();
                    column
                }
            })
        };
        let columns = self.roles.iter().enumerate().map(column).collect::<Option<Vec<_>>>()?;
        let finite = |column: &Column| column.values.iter().all(|value| value.is_finite());
        columns.iter().all(finite).then_some(columns)
    }

    /// Derivatives of the shortening of a curve by each of its stimuli; `None` if no delay is
    /// fitted.
    fn by_stimulus(&self, at: &[f64], held: &[bool], number: usize) -> Option<Vec<Column>> {
        let sought = self.roles.iter().zip(held).any(|(role, held)| {
            !held && matches!(role, Role::Delay { source, .. } if *source == number)
        });
        if !sought {
            return Some(Vec::new());
        }
        let mut parameters = Vec::new();
        let physics = self.physics(at, &mut parameters);
        let (stimuli, source) = (self.stimuli(at, number), &self.sources[number]);
        source.contraction.by_stimulus(&physics, &stimuli, &source.frames.times)
    }

    fn frames(&self, at: &[f64], number: usize, first: usize) -> Option<Frames> {
        let source = &self.sources[number];
        let times = &source.frames.times;
        let Response { values: response, by_shortening: load_by_shortening } =
            self.response(at, number, times)?;
        let part = self.parts(number, times);
        let [level, gain, drift] = self.scale(at, number);
        let by_response = match source.observed.scale {
            Scale::Length => part.iter().map(|part| -(level + drift * part)).collect(),
            Scale::Percent => vec![100.0; times.len()],
            Scale::Arbitrary | Scale::Load(_) => vec![gain; times.len()],
        };
        let mut before = vec![0];
        for used in &source.used {
            before.push(before[before.len() - 1] + usize::from(*used));
        }
        Some(Frames { response, by_response, load_by_shortening, part, before, first })
    }

    /// The derivatives of residuals from those of the shortening.
    fn by_shortening(&self, number: usize, frames: &Frames, column: &Column) -> Column {
        let Some(load) = &frames.load_by_shortening else {
            return self.by_response(number, frames, column);
        };
        let values = column.values.iter().zip(&load[column.first..]);
        let values = values.map(|(value, by)| value * by).collect();
        self.by_response(number, frames, &Column { first: column.first, values })
    }

    /// The derivatives of residuals from those of what a curve shows.
    fn by_response(&self, number: usize, frames: &Frames, column: &Column) -> Column {
        let values = column.values.iter().zip(&frames.by_response[column.first..]);
        self.column(number, frames, column.first, values.map(|(value, by)| value * by))
    }

    /// Derivatives by level, gain, drift and the error of the scale.
    fn by_scale(&self, role: &Role, number: usize, frames: &Frames) -> Column {
        let scale = self.sources[number].observed.scale;
        let all = frames.response.iter().zip(&frames.by_response).zip(&frames.part);
        let values = all.map(|((response, by_response), part)| {
            let level = if scale == Scale::Length { 1.0 - response } else { 1.0 };
            match role {
                Role::Drift { .. } => level * part,
                Role::Gain { .. } => *response,
                Role::ScaleError { .. } => by_response * response,
                _ => level,
            }
        });
        self.column(number, frames, 0, values)
    }

    /// Of derivatives of the values of frames, from one on.
    fn column(
        &self,
        number: usize,
        frames: &Frames,
        from: usize,
        values: impl Iterator<Item = f64>,
    ) -> Column {
        let source = &self.sources[number];
        let used = values.zip(&source.used[from..]).filter(|(_, used)| **used);
        let values = used.map(|(value, _)| -value / source.frames.noise).collect();
        Column { first: frames.first + frames.before[from], values }
    }
}

/// The one-sided derivative by one unknown, with an error of a ten-thousandth, which shifts an
/// answer by a ten-thousandth of its standard deviation.
fn one_sided(
    of: impl Fn(&[f64]) -> Option<Vec<f64>>,
    at: &[f64],
    place: usize,
    step: f64,
    bounds: &[[f64; 2]],
    here: &[f64],
) -> Option<Vec<f64>> {
    let mut there = at.to_vec();
    let step = if at[place] + step > bounds[place][1] { -step } else { step };
    there[place] += step;
    let mut moved = of(&there)?;
    for (moved, here) in moved.iter_mut().zip(here) {
        *moved = (*moved - here) / (there[place] - at[place]);
    }
    Some(moved)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::unknown::Unknown;
    use crate::fit::{Fitter, Loaded, Observed, Stimuli};
    use crate::interruption::Interruption;
    use crate::recording::AXIAL_FORCE;
    use crate::run_file::RunFile;

    /// Four beats, 100 frames a second.
    fn layout(text: &str, free: &[&str], scale: Scale, stimuli: Stimuli) -> Layout {
        let run = RunFile::from_text(text).unwrap().resolve().unwrap();
        let fitter = Fitter::of(&run, |path| std::fs::read(path)).unwrap();
        let times_ms: Vec<f64> = (0..230).map(|frame| 10.0 * f64::from(frame)).collect();
        let beat = |time: f64| (time * std::f64::consts::PI / 550.0).sin().powi(4);
        let sign = if scale == Scale::Length { -10.0 } else { 10.0 };
        let values = times_ms.iter().map(|time| 100.0 + sign * beat(*time)).collect();
        let unit = String::new();
        let observed = Observed { name: "cell".into(), times_ms, values, scale, unit, stimuli };
        let support = fitter.simulation().support;
        let unknowns: Vec<Unknown> = free.iter().map(|name| Unknown::named(name)).collect();
        let scale_error = if matches!(scale, Scale::Load(_)) { 0.05 } else { 0.0 };
        let loaded = Loaded { support, observed, scale_error };
        let mut source = fitter.source(&loaded, &unknowns, 0, Some(0.1)).unwrap();
        source.used[17] = false;
        let usual = |unknown: &Unknown| match unknown {
            Unknown::Parameter(name) => fitter.simulation().cell.parameters().get(name).unwrap(),
            _ => 1.0,
        };
        let sought: Vec<_> =
            unknowns.into_iter().map(|one| (one.clone(), [0.2, 5.0], usual(&one))).collect();
        Layout::new(vec![source], &sought)
    }

    #[test]
    fn derivatives_are_the_differences_of_all_residuals() {
        let viscous =
            "numerics.integrator = \"quasi-static\"\nmaterial.retardation_time = \"30 ms\"";
        let seen = || Stimuli::Seen(vec![43.3, 561.7, 1094.1, 1660.9]);
        let given = || Stimuli::Given(vec![43.3, 561.7, 1094.1, 1660.9]);
        let of_tension = ["tension_over_stiffness", "c_0", "x_3", "sigma"];
        let of_filaments = ["tension_over_stiffness", "k_ws"];
        let land = "cell.model = \"land_2017\"";
        let gel = "mechanics.support = \"gel\"\nmechanics.gel_modulus = \"10 kPa\"\nshape.spacing = \"7 um\"";
        let on_gel = ["tension_over_stiffness", "young_modulus", "c_0"];
        for (text, free, scale, stimuli) in [
            ("", &of_tension[..], Scale::Length, seen()),
            ("", &of_tension, Scale::Percent, given()),
            (viscous, &of_tension, Scale::Length, seen()),
            (land, &of_filaments, Scale::Length, seen()),
            (land, &of_filaments[1..], Scale::Arbitrary, given()),
            (gel, &on_gel, Scale::Load(AXIAL_FORCE), seen()),
        ] {
            let layout = layout(text, free, scale, stimuli);
            let at: Vec<f64> = layout
                .roles
                .iter()
                .enumerate()
                .map(|(place, role)| match role {
                    Role::Physics(_) => 0.1 - 0.07 * place as f64,
                    Role::Delay { .. } => 3.7 * place as f64 - 11.3,
                    Role::Level { .. } => 99.0,
                    Role::Drift { .. } => 0.7,
                    Role::Gain { .. } => 123.0,
                    Role::ScaleError { .. } => 0.03,
                })
                .collect();
            let held = vec![false; at.len()];
            let residuals = |at: &[f64]| layout.residuals(at);
            let (bounds, steps) = (&layout.bounds, &layout.steps);
            let plain = Problem::plain(&residuals, bounds, steps);
            let plain = plain.jacobian(&at, &held).unwrap();
            let quick =
                layout.slopes(&at, &held, &Work::new(&|_| true, &Interruption::default())).unwrap();
            for ((role, plain), quick) in layout.roles.iter().zip(&plain).zip(&quick) {
                let most = plain.values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
                assert!(most > 0.0, "{role:?}");
                for (place, plain) in plain.values.iter().enumerate() {
                    let local = place.checked_sub(quick.first).and_then(|k| quick.values.get(k));
                    let off = (plain - local.copied().unwrap_or(0.0)).abs();
                    // Slopes of tables and cubics jump a little from one piece to the next.
                    assert!(off < 2e-3 * most, "{text} {role:?}, {place}: off by {off} of {most}");
                }
            }
        }
    }

    #[test]
    fn what_is_held_has_no_column() {
        let layout = layout("", &["c_0"], Scale::Length, Stimuli::Seen(vec![43.3, 561.7]));
        let at: Vec<f64> = layout
            .roles
            .iter()
            .map(|role| if matches!(role, Role::Level { .. }) { 99.0 } else { 0.0 })
            .collect();
        let held: Vec<bool> = (0..at.len()).map(|place| place % 2 == 0).collect();
        let columns =
            layout.slopes(&at, &held, &Work::new(&|_| true, &Interruption::default())).unwrap();
        for (column, held) in columns.iter().zip(held) {
            assert_eq!(column.values.is_empty(), held);
        }
    }
}
