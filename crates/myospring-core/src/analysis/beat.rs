//! Metrics of one beat of a run.

use super::capture::{self, Window};
use super::pulse::{Pulse, Top};
use super::rows::{Context, recorded, row};
use super::s2::{self, S1S2};
use super::{
    Metric, Missing, action_potential, contraction, load, reading, rest, spiral, tension,
    thickness, trace, value, wave,
};
use crate::recording::{CALCIUM, END_FORCE, Recording, STEEPEST_RISE, Sample};
use serde::Serialize;

/// One beat.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Beat {
    /// Time of its stimulus, ms.
    pub stimulus_ms: f64,
    /// Active tension.
    pub tension: Vec<Metric>,
    /// Shortening.
    pub contraction: Vec<Metric>,
    /// Width and area at the peak of shortening.
    pub shape: Vec<Metric>,
    /// Work and force at its ends, or forces on a gel; empty if nothing of the kind holds the cell.
    pub load: Vec<Metric>,
    /// Action potential; empty for a cell without one.
    pub action_potential: Vec<Metric>,
    /// Comparison of the beat of the extra stimulus S2 with the last one of its train; empty for
    /// all other beats.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub s2: Vec<Metric>,
    /// Levels of free calcium, if it was recorded; [`Beat::value`] has them, tables of a run leave
    /// them out.
    #[serde(skip)]
    pub calcium: Vec<Metric>,
    /// Whether the stimulus raised an action potential; if not, no metric has a value, except the
    /// intervals before an S2. `None` if too little was recorded to decide, or for a cell without a
    /// potential.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub captured: Option<bool>,
}

impl Beat {
    /// All metrics in the order of tables.
    pub fn metrics(&self) -> impl Iterator<Item = &Metric> {
        let Self { tension, contraction, shape, load, action_potential, s2, .. } = self;
        [tension, contraction, shape, load, action_potential, s2].into_iter().flatten()
    }

    /// Whether it belongs to an extra stimulus.
    pub fn is_s2(&self) -> bool {
        !self.s2.is_empty()
    }

    /// Whether its stimulus raised no action potential.
    pub fn is_missed(&self) -> bool {
        self.captured == Some(false)
    }

    /// The value of a metric by its name.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.metrics().chain(&self.calcium).find(|metric| metric.name == name)?.value
    }
}

/// Least rise of the tension, relative to that at rest; less is rounding.
const LEAST: f64 = 1e-9;

const UPSTROKE: &str = "maximum_upstroke_velocity";

/// The metrics of each beat; a beat ends at the next captured stimulus.
pub fn beats(recording: &Recording, stimulus_times_ms: &[f64]) -> Vec<Beat> {
    let Recording { samples, .. } = recording;
    let times: Vec<f64> = samples.iter().map(|sample| sample.t_ms).collect();
    let captured = match potential(samples) {
        Some((potential, unit)) => capture::of(&times, &potential, unit, stimulus_times_ms),
        None => Vec::new(),
    };
    let of = |window: Window| {
        let captured = captured.get(window.place).copied().flatten();
        let mut beat = beat(recording, &window, captured);
        let within = window.within.clone();
        if let Some(values) = calcium(recording).and_then(|values| values.get(within.clone())) {
            let rest = trace::baseline(&times[within.clone()], values, window.stimulus_ms);
            beat.calcium = levels(&times[within], values, rest, captured);
        }
        with_own_upstroke(beat, recording, [window.stimulus_ms, window.next_ms])
    };
    capture::windows(&times, stimulus_times_ms, &captured).into_iter().map(of).collect()
}

fn beat(recording: &Recording, window: &Window, captured: Option<bool>) -> Beat {
    let samples = &recording.samples[window.within.clone()];
    let signal =
        |name: &str| values_of(recording, name).and_then(|all| all.get(window.within.clone()));
    let stimulus = window.stimulus_ms;
    let column = |read: fn(&Sample) -> f64| samples.iter().map(read).collect::<Vec<f64>>();
    let times = column(|s| s.t_ms);
    let lengths = column(|s| s.length_um);
    let shortening: Vec<f64> = lengths.iter().map(|length| -length).collect();
    let own = trace::twitch(&times, &shortening, stimulus);
    let contraction = contraction::above(
        &times[own.clone()],
        &lengths[own],
        stimulus,
        trace::baseline(&times, &lengths, stimulus),
        rest::BEFORE_STIMULUS,
    );
    let stimuli = [stimulus, window.next_ms];
    let mut action_potential = match potential(samples) {
        Some((potential, unit)) => {
            let rest = trace::baseline(&times, &potential, stimulus);
            let rest_is = rest::BEFORE_STIMULUS;
            action_potential::above(&times, &potential, stimuli, unit, rest, rest_is)
        }
        None => Vec::new(),
    };
    if let Some(spread) = &recording.wave {
        action_potential.extend(wave::metrics(spread, stimuli));
        action_potential.extend(spiral::of_turning(spread, stimuli));
    }
    let active = column(|s| s.ta_kpa);
    let rest = trace::baseline(&times, &active, stimulus).unwrap_or_default();
    let rest = (rest, rest::BEFORE_STIMULUS);
    let own = trace::twitch(&times, &active, stimulus);
    let tension = tension(&times[own.clone()], &active[own], stimulus, rest, &contraction);
    let at_rest = |read| trace::baseline(&times, &column(read), stimulus);
    let mut shape = shape(samples, &at_rest, &contraction);
    shape.extend(thickness::metrics(&times, signal, stimulus));
    let mut load = signal(END_FORCE)
        .map_or_else(Vec::new, |force| load::metrics(&times, &lengths, force, stimulus));
    load.extend(load::on_gel(&times, signal, stimulus));
    let mut groups = [tension, contraction, shape, load, action_potential];
    if captured == Some(false) {
        without_values(&mut groups);
    }
    let [tension, contraction, shape, load, action_potential] = groups;
    let (stimulus_ms, s2, calcium) = (stimulus, Vec::new(), Vec::new());
    Beat { stimulus_ms, tension, contraction, shape, load, action_potential, s2, calcium, captured }
}

/// Free calcium, where it was recorded.
fn calcium(recording: &Recording) -> Option<&[f64]> {
    values_of(recording, CALCIUM)
}

/// The values of a signal, where it was recorded.
fn values_of<'a>(recording: &'a Recording, name: &str) -> Option<&'a [f64]> {
    Some(&recording.signals.iter().find(|signal| signal.is(name))?.values)
}

/// Levels of the free calcium of a beat.
fn levels(times: &[f64], values: &[f64], rest: Option<f64>, captured: Option<bool>) -> Vec<Metric> {
    let peak = trace::peak(times, values).map(|peak| peak.value);
    let mut levels = [vec![
        row("diastolic_level", recorded(rest), "uM", "calcium at rest"),
        row("systolic_level", recorded(peak), "uM", "largest calcium"),
    ]];
    if captured == Some(false) {
        without_values(&mut levels);
    }
    let [levels] = levels;
    levels
}

/// Replaces the upstroke of a beat by the largest rate of the model's own equations between its
/// stimulus and the next, if it was recorded.
fn with_own_upstroke(
    mut beat: Beat,
    recording: &Recording,
    [stimulus_ms, next_ms]: [f64; 2],
) -> Beat {
    let own = recording.signals.iter().find(|signal| signal.is(STEEPEST_RISE));
    let row = beat.action_potential.iter_mut().find(|metric| metric.name == UPSTROKE);
    if let (Some(own), Some(row)) = (own, row) {
        let samples = &recording.samples;
        // The sample at a stimulus still belongs to the previous beat.
        let from = samples.partition_point(|sample| sample.t_ms <= stimulus_ms);
        let to = samples.partition_point(|sample| sample.t_ms < next_ms);
        let within = own.values.get(from..to).unwrap_or_default();
        if let (Some(_), Some(steepest)) = (row.value, within.iter().copied().reduce(f64::max)) {
            row.value = Some(steepest);
            row.definition = "largest rate of the potential by the model's own equations, at every step of their solution \
                              and without the current of the stimulus";
        }
    }
    beat
}

/// The potential and its unit, if all samples have one.
pub(super) fn potential(samples: &[Sample]) -> Option<(Vec<f64>, &'static str)> {
    let everywhere =
        |read: fn(&Sample) -> Option<f64>| samples.iter().map(read).collect::<Option<Vec<f64>>>();
    let in_mv = everywhere(|s| s.vm_mv).map(|potential| (potential, "mV"));
    in_mv.or_else(|| Some((everywhere(|s| s.u)?, "")))
}

/// The beat of an S2 after the beat of the last S1; `None` if it was not recorded.
pub(super) fn s2_beat(
    recording: &Recording,
    stimuli_ms: &[f64],
    s2_ms: f64,
    s1: &Beat,
) -> Option<Beat> {
    let Recording { samples, .. } = recording;
    let column = |read: fn(&Sample) -> f64| samples.iter().map(read).collect::<Vec<f64>>();
    let times = column(|s| s.t_ms);
    let s1_place = stimuli_ms.iter().position(|time| *time == s1.stimulus_ms)?;
    let pair = S1S2::after(&times, stimuli_ms, s1_place, s2_ms)?;
    let rest = |column: &[f64]| Some(pair.rest(column));
    // Empty if the curve does not rise.
    let of = |rising: &[f64]| pair.beat(rising).unwrap_or(times.len()..times.len());

    let lengths = column(|s| s.length_um);
    let shortening: Vec<f64> = lengths.iter().map(|length| -length).collect();
    let within = of(&shortening);
    let contraction = contraction::above(
        &times[within.clone()],
        &lengths[within.clone()],
        s2_ms,
        rest(&lengths),
        rest::BEFORE_S1,
    );
    let mut shape = shape(&samples[within], &|read| rest(&column(read)), &contraction);
    shape.extend(thickness::metrics(&times, |name| values_of(recording, name), s2_ms));
    let active = column(|s| s.ta_kpa);
    let within = of(&active);
    let tension = tension(
        &times[within.clone()],
        &active[within],
        s2_ms,
        (pair.rest(&active), rest::BEFORE_S1),
        &contraction,
    );
    let mut load = values_of(recording, END_FORCE).map_or_else(Vec::new, |force| {
        let within = of(force);
        let (times, lengths) = (&times[within.clone()], &lengths[within.clone()]);
        load::above(times, lengths, &force[within], s2_ms, rest(force), rest::BEFORE_S1)
    });
    load.extend(load::on_gel(&times, |name| values_of(recording, name), s2_ms));
    let (mut action_potential, mut captured, mut diastolic) = (Vec::new(), None, None);
    if let Some((potential, unit)) = potential(samples) {
        captured = pair.captured(&times, &potential);
        diastolic = pair.diastolic_interval(&times, &potential);
        action_potential = pair.metrics(&times, &potential, unit);
        // These are among the metrics of S2.
        action_potential.retain(|metric| !metric.name.ends_with("_interval"));
    }
    if let Some(spread) = &recording.wave {
        action_potential.extend(wave::metrics(spread, [s2_ms, f64::INFINITY]));
    }
    let mut groups = [tension, contraction, shape, load, action_potential];
    if captured == Some(false) {
        without_values(&mut groups);
    }
    let [tension, contraction, shape, load, action_potential] = groups;
    let mut s2 = s2::rows(
        Some(&pair),
        diastolic,
        &[&s1.tension, &s1.contraction],
        &[&tension, &contraction],
    );
    if let Some(spread) = &recording.wave {
        s2.extend(spiral::of_turning(spread, [s2_ms, f64::INFINITY]));
    }
    let stimulus_ms = s2_ms;
    let calcium = calcium(recording).map_or_else(Vec::new, |values| {
        let within = of(values);
        levels(&times[within.clone()], &values[within], rest(values), captured)
    });
    let beat = Beat {
        stimulus_ms,
        tension,
        contraction,
        shape,
        load,
        action_potential,
        s2,
        calcium,
        captured,
    };
    Some(with_own_upstroke(beat, recording, [s2_ms, f64::INFINITY]))
}

/// Removes all values, for a stimulus that raised no action potential.
fn without_values(groups: &mut [Vec<Metric>]) {
    groups.iter_mut().flatten().for_each(|metric| metric.lose(Missing::NotCaptured));
}

fn tension(
    times: &[f64],
    active: &[f64],
    stimulus: f64,
    (rest, rest_is): (f64, &'static str),
    contraction: &[Metric],
) -> Vec<Metric> {
    let heights: Vec<f64> = active.iter().map(|tension| tension - rest).collect();
    let pulse = Pulse::new(times, &heights, stimulus, Top::Vertex).above(LEAST * rest.abs());
    let context = Context { stimulus: Some(stimulus), onset: None, rest: rest_is };
    let peak = pulse.peak();
    let shortest = reading(contraction, "time_of_peak");
    // The cell may be shortest before its tension is largest.
    let lag = shortest.and_then(|shortest| Ok(shortest - peak?.time));
    let at_end =
        peak.and_then(|peak| Ok(100.0 * recorded(active.last().copied())? / (rest + peak.value)));
    let mut rows = tension::of_pulse(&pulse, rest, "kPa", &context);
    rows.extend([
        row("lag_of_shortening", lag, "ms", "from the largest tension to the largest shortening"),
        row("tension_at_end", at_end, "%", "tension at the end of the beat, of its peak"),
    ]);
    rows
}

/// Width and area at the sample nearest to the peak, compared with a cell of constant volume.
fn shape(
    samples: &[Sample],
    at_rest: &dyn Fn(fn(&Sample) -> f64) -> Option<f64>,
    contraction: &[Metric],
) -> Vec<Metric> {
    let peak = value(contraction, "time_of_peak").and_then(|peak| {
        let distance = |sample: &&Sample| (sample.t_ms - peak).abs();
        samples.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
    });
    let change = |read: fn(&Sample) -> f64| Some(100.0 * (read(peak?) / at_rest(read)? - 1.0));
    let width = change(|s| s.width_um);
    let ratio = Some(()).and_then(|()| Some(peak?.length_um / at_rest(|s| s.length_um)?));
    // Equal transverse strains keep the volume: width L^(-1/2), projected area L^(1/2).
    let isovolumic_width = ratio.map(|ratio| 100.0 * (ratio.powf(-0.5) - 1.0));
    let isovolumic_area = ratio.map(|ratio| 100.0 * (ratio.sqrt() - 1.0));
    let off = Some(()).and_then(|()| Some(width? - isovolumic_width?));
    let why = reading(contraction, "time_of_peak").err().unwrap_or(Missing::NotRecorded);
    let row =
        |name, value: Option<f64>, definition| Metric::new(name, value.ok_or(why), "%", definition);
    vec![
        row(
            "width_change_at_peak",
            width,
            "largest extent across the cell's long axis as it has turned, at the peak of shortening, above rest",
        ),
        row(
            "isovolumic_width_change",
            isovolumic_width,
            "width change that keeps the volume, (1 - s)^(-1/2) - 1",
        ),
        row("width_beyond_isovolumic", off, "width change minus the isovolumic one"),
        row(
            "area_change_at_peak",
            change(|s| s.area_um2),
            "projected area at the peak of shortening, above rest",
        ),
        row(
            "isovolumic_area_change",
            isovolumic_area,
            "area change that keeps the volume, (1 - s)^(1/2) - 1",
        ),
    ]
}
