//! Calcium that was recorded together with the curve of a fit.

use super::curves::Named;
use crate::analysis::curve::State;
use crate::analysis::kind::Kind;
use crate::analysis::paired::Paired;
use crate::analysis::value;
use crate::cell::calcium::CalciumTrace;
use crate::experiment::analyse::pairs::paired;
use crate::experiment::analyse::{AnalysedCurve, PairedCurves};
use crate::experiment::{BeatOptions, ExperimentError, Files};
use crate::fit::{Fit, RecordedCourse, Stimuli};
use crate::measured::{Curve, TableOptions};
use std::path::PathBuf;

/// The least calcium, uM: a smoothed curve may fall below 0.
const LEAST_UM: f64 = 1e-4;
/// Below this frame rate the rise of calcium, some 35 ms, has too few frames: the numbers of a fit are off by more than their
/// intervals say (docs/reference/accuracy.md).
const FEW_FRAMES_PER_S: f64 = 90.0;

/// Calcium that was recorded together with the curve of a fit, on the same clock.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RecordedCalcium {
    /// Its table; `None` takes the column of calcium of the curve's own table, or what the caller has read.
    pub path: Option<PathBuf>,
    /// Calcium at rest and at the peak of the mean beat, uM: the scale of a ratio or a fluorescence, which is taken as linear.
    pub rest_um: Option<f64>,
    /// See `rest_um`.
    pub peak_um: Option<f64>,
}

/// Calcium over a whole recording, ready to drive a cell model.
#[derive(Debug, Clone)]
pub struct DrivingCalcium {
    pub(super) trace: CalciumTrace,
    pub(super) course: RecordedCourse,
    pub(super) stimuli: Stimuli,
}

impl RecordedCalcium {
    /// Whether calcium was asked for. Otherwise a column of calcium beside the curve is used if that is possible.
    fn is_asked(&self) -> bool {
        *self != Self::default()
    }

    /// The calcium of the only curve, and what was assumed. `own` are the curves of calcium in its own table.
    pub(super) fn of(
        &self,
        curves: &[Named],
        own: Vec<Curve>,
        (options, beats): (&TableOptions, &BeatOptions),
        files: &Files,
    ) -> Result<(Option<DrivingCalcium>, Vec<String>), ExperimentError> {
        let own = match &self.path {
            Some(path) => {
                let part = TableOptions {
                    from_ms: options.from_ms,
                    until_ms: options.until_ms,
                    ignore_marks: options.ignore_marks,
                    frame_rate_per_s: options.frame_rate_per_s,
                    time_unit: options.time_unit.clone(),
                    ..TableOptions::default()
                };
                files.table(path, &part)?.curves
            }
            None => own,
        };
        self.among(&own, curves, beats)
    }

    /// The calcium of the only curve among curves of calcium that were read already, and what was assumed.
    ///
    /// # Errors
    /// Calcium that was asked for and cannot be used: other times or beats, no scale, or several curves.
    pub fn among(
        &self,
        own: &[Curve],
        curves: &[Named],
        beats: &BeatOptions,
    ) -> Result<(Option<DrivingCalcium>, Vec<String>), ExperimentError> {
        if !self.is_asked() && own.is_empty() {
            return Ok((None, Vec::new()));
        }
        let found = self.chosen(own).and_then(|calcium| match curves {
            [(_, Ok(curve))] => self.driving(calcium, curve, beats),
            _ => Err(ExperimentError::new(format!(
                "calcium of the same beats needs one curve, but there are {}",
                curves.len()
            ))
            .advise("--columns chooses one")),
        });
        match found {
            Ok((driving, notes)) => Ok((Some(driving), notes)),
            Err(error) if self.is_asked() => Err(error),
            Err(error) => Ok((None, vec![format!("the recorded calcium is not used: {error}")])),
        }
    }

    /// The curve of calcium of a table: in uM, else a ratio, else a fluorescence.
    fn chosen(&self, own: &[Curve]) -> Result<Curve, ExperimentError> {
        let of = |kind| own.iter().filter(move |curve: &&Curve| curve.kind == kind);
        let kinds = [Kind::Calcium, Kind::CalciumRatio, Kind::Fluorescence];
        let found = kinds.into_iter().find(|kind| of(*kind).next().is_some());
        let place = self.path.as_ref().map_or_else(
            || "the table of the curve".to_owned(),
            |path| format!("`{}`", path.display()),
        );
        let Some(kind) = found else {
            return Err(ExperimentError::new(format!("{place} has no column of calcium"))
                .advise("name it with its unit, such as `Ca (uM)`, `ratio` or `F/F0`"));
        };
        let all: Vec<&Curve> = of(kind).collect();
        match all[..] {
            [one] => Ok(one.clone()),
            _ => Err(ExperimentError::new(format!(
                "{place} has {} curves of {kind}, and which of them belongs to the curve is not known",
                all.len()
            ))),
        }
    }

    /// The calcium of a curve's beats, and what was assumed.
    fn driving(
        &self,
        calcium: Curve,
        curve: &Curve,
        beats: &BeatOptions,
    ) -> Result<(DrivingCalcium, Vec<String>), ExperimentError> {
        let name = calcium.name.clone();
        let calcium = self.in_um(calcium, beats)?;
        let [calcium, motion] =
            [calcium, curve.clone()].map(|curve| AnalysedCurve::of("", curve, beats));
        let both = paired(&calcium, &motion).map_err(|why| {
            ExperimentError::new(format!(
                "`{name}` and `{}` were not recorded together: {why}",
                curve.name
            ))
        })?;
        let (times_ms, calcium_um, filled) = course(&calcium, &motion, &both);
        let from = times_ms[0];
        let since: Vec<f64> = times_ms.iter().map(|time| time - from).collect();
        let trace = CalciumTrace::new(&since, &calcium_um)
            .map_err(|cause| ExperimentError::new(format!("`{name}`: {cause}")))?;
        let in_motion = both.beats.iter().filter(|beat| beat.motion_beat.is_some()).count();
        let mut notes = vec![format!(
            "calcium `{name}` was recorded together with `{}`: it drives models that take calcium, beat for beat",
            curve.name
        )];
        if let Some(rate) = calcium.curve.frame_rate_per_s().filter(|rate| *rate < FEW_FRAMES_PER_S)
        {
            notes.push(format!(
                "`{name}` has {rate:.0} frames a second, too few for its rise: the fitted numbers may be off by some per cent more than their \
                 intervals say; with 100 or more they are not"
            ));
        }
        if filled > 0 {
            notes.push(format!(
                "{filled} of {in_motion} beats have no calcium of their own in `{name}`: the mean beat of calcium takes its place"
            ));
        }
        if let Some((rest, peak)) = self.rest_um.zip(self.peak_um) {
            notes.push(format!(
                "`{name}` was scaled to {rest} uM at rest and {peak} uM at its peak, linearly; the scale is not fitted"
            ));
        }
        let course = RecordedCourse { drives: true, times_ms, calcium_um };
        let stimuli = Stimuli::Clocked { from: [from], beats: in_motion.max(1) };
        Ok((DrivingCalcium { trace, course, stimuli }, notes))
    }

    /// A curve of calcium in uM.
    fn in_um(&self, mut calcium: Curve, beats: &BeatOptions) -> Result<Curve, ExperimentError> {
        let name = calcium.name.clone();
        let scale = match (self.rest_um, self.peak_um) {
            (None, None) if calcium.kind == Kind::Calcium => return Ok(calcium),
            (Some(rest), Some(peak)) => [rest, peak],
            _ => {
                let what = if calcium.kind == Kind::Calcium { "in uM" } else { "no concentration" };
                return Err(ExperimentError::new(format!(
                    "`{name}` is a {}, {what}, and not both ends of its scale are given",
                    calcium.kind
                ))
                .advise("give calcium at rest and at its peak: --calcium-rest \"0.1 uM\" --calcium-peak \"0.6 uM\""));
            }
        };
        let [rest, peak] = scale;
        if !(rest > 0.0 && peak > rest && peak <= CalciumTrace::MOST_UM) {
            return Err(ExperimentError::new(format!(
                "calcium of {rest} uM at rest and {peak} uM at its peak: the first must be above 0, the second above it and at \
                 most {} uM",
                CalciumTrace::MOST_UM
            )));
        }
        let read = AnalysedCurve::of("", calcium.clone(), beats);
        let found = read.found.map_err(|why| ExperimentError::new(format!("`{name}`: {why}")))?;
        let ends = ["diastolic_level", "systolic_level"].map(|level| found.mean(level));
        let [Some(low), Some(high)] = ends else {
            return Err(ExperimentError::new(format!("`{name}` has no whole beat to scale")));
        };
        for value in &mut calcium.values {
            *value = (rest + (peak - rest) * (*value - low) / (high - low)).max(LEAST_UM);
        }
        (calcium.kind, calcium.unit) = (Kind::Calcium, "uM");
        Ok(calcium)
    }
}

/// Times and values of calcium over the recording of a motion, and how many beats of the motion have that of the mean beat.
fn course(
    calcium: &AnalysedCurve,
    motion: &AnalysedCurve,
    both: &Paired,
) -> (Vec<f64>, Vec<f64>, usize) {
    let (Ok(of_calcium), Ok(of_motion)) = (&calcium.found, &motion.found) else {
        return (Vec::new(), Vec::new(), 0);
    };
    let times = &calcium.curve.times_ms;
    let mut samples: Vec<[f64; 2]> =
        times.iter().zip(&of_calcium.read).map(|(time, value)| [*time, *value]).collect();
    let delay = both.mean("delay_of_onset").unwrap_or(0.0);
    let mut filled = 0;
    // Where calcium of a beat is not known: the mean beat.
    if let Some(mean) = &both.mean_loop {
        for beat in &of_motion.beats {
            let own = both.beats.iter().find(|pair| pair.motion_beat == Some(beat.number));
            let own = own.and_then(|pair| pair.calcium_beat);
            let own = own.map(|number| &of_calcium.beats[number - 1]);
            let is_known =
                own.is_some_and(|own| matches!(own.state, State::Whole | State::CutAtEnd));
            let Some(onset) = beat.onset_ms.filter(|_| !is_known) else { continue };
            let onset = own.and_then(|own| own.onset_ms).unwrap_or(onset - delay);
            let last = mean.times_ms.len() - 1;
            let [from, to] = [mean.times_ms[0], mean.times_ms[last]].map(|time| onset + time);
            samples.retain(|[time, _]| !(from..=to).contains(time));
            let beat = mean.times_ms.iter().zip(&mean.calcium);
            samples.extend(beat.map(|(time, value)| [onset + time, *value]));
            filled += 1;
        }
    }
    samples.sort_by(|a, b| a[0].total_cmp(&b[0]));
    samples.dedup_by(|later, earlier| later[0] <= earlier[0]);
    let (times, values) =
        samples.into_iter().map(|[time, value]| (time, value.max(LEAST_UM))).unzip();
    (times, values, filled)
}

/// The tension that a curve needs, paired with the calcium that was recorded together with it.
pub(super) fn with_tension(fit: &Fit) -> Option<([AnalysedCurve; 2], PairedCurves)> {
    let (own, calcium, curve) =
        (fit.own_tension.as_ref()?, fit.calcium.as_ref()?, fit.curves.first()?);
    let first = *curve.times_ms.first()?;
    let of = |name: &str, kind, unit, times_ms: Vec<f64>, values: &[f64]| {
        let (values, lines, stimuli_ms) = (values.to_vec(), vec![0; values.len()], Vec::new());
        let curve =
            Curve { name: name.to_owned(), kind, unit, times_ms, values, lines, stimuli_ms };
        AnalysedCurve::of("", curve, &BeatOptions::default())
    };
    let times = own.times_ms.iter().map(|time| first + time).collect();
    let curves = [
        of("calcium", Kind::Calcium, "uM", calcium.times_ms.clone(), &calcium.calcium_um),
        of("tension", Kind::Tension, "kPa", times, &own.tension_kpa),
    ];
    let paired = paired(&curves[0], &curves[1]).ok()?;
    let level =
        paired.beats.iter().any(|beat| value(&beat.metrics, "calcium_at_half_rise").is_some());
    level.then_some((curves, PairedCurves { calcium: 0, motion: 1, paired }))
}
