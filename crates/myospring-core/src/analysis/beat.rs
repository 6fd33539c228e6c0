//! Metrics of the beats of a run, its energy balance, and reference bands for these numbers.

use super::capture::{self, Window};
use super::pulse::{Pulse, Top};
use super::rhythm::Rhythm;
use super::rows::{Context, recorded, row};
use super::s2::{self, S1S2};
use super::{
    Metric, Missing, Spread, action_potential, beat_to_beat, contraction, load, reading, rest,
    tension, trace, value,
};
use crate::recording::{CALCIUM, END_FORCE, Recording, STEEPEST_RISE, Sample, Signal};
use serde::Serialize;
use std::ops::Deref;

/// Reference band of a quantity in unloaded adult ventricular myocytes; it is not a target.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Band {
    /// Name of the metric.
    pub name: &'static str,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Unit of both ends.
    pub unit: &'static str,
    /// The cells to which it applies.
    pub scope: &'static str,
}

/// Position of a value relative to a band.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum BandPosition {
    /// Lower than its lower end.
    Below,
    /// Between its ends.
    In,
    /// Higher than its upper end.
    Above,
}

impl BandPosition {
    /// In words: `in`, `out, above`.
    pub fn words(self) -> &'static str {
        match self {
            Self::Below => "out, below",
            Self::In => "in",
            Self::Above => "out, above",
        }
    }
}

/// Relative tolerance at the ends of a band, which are known to three digits at most.
const END: f64 = 0.005;

impl Band {
    /// Position of a value relative to this band.
    ///
    /// # Example
    /// ```
    /// use myospring::analysis::beat::{BandPosition, band};
    /// let shortening = band("peak_shortening").unwrap();
    /// assert_eq!([6.9, 9.0, 12.01, 12.1].map(|value| shortening.place(value)),
    ///     [BandPosition::Below, BandPosition::In, BandPosition::In, BandPosition::Above]);
    /// ```
    pub fn place(&self, value: f64) -> BandPosition {
        match value {
            _ if value < self.low - END * self.low.abs() => BandPosition::Below,
            _ if value > self.high + END * self.high.abs() => BandPosition::Above,
            _ => BandPosition::In,
        }
    }
}

/// The reference bands.
pub const BANDS: [Band; 5] = [
    Band {
        name: "peak_shortening",
        low: 7.0,
        high: 12.0,
        unit: "%",
        scope: "unloaded adult ventricular myocytes (guinea pig 8.1 %, rabbit 9.0 %)",
    },
    Band {
        name: "area_change_at_peak",
        low: -5.0,
        high: 0.0,
        unit: "%",
        scope: "projected area at about 10 % shortening",
    },
    Band {
        name: "maximum_shortening_rate",
        low: 0.5,
        high: 1.2,
        unit: "L0/s",
        scope: "unloaded adult ventricular myocytes (guinea pig 0.82, rabbit 0.98 L0/s)",
    },
    Band {
        name: "shortening_rate_over_peak",
        low: 8.0,
        high: 13.0,
        unit: "1/s",
        scope: "unloaded adult ventricular myocytes (guinea pig 10.1, rabbit 10.8 1/s, and a fifth either way)",
    },
    Band {
        name: "time_to_peak_from_stimulus",
        low: 100.0,
        high: 250.0,
        unit: "ms",
        scope: "unloaded adult ventricular myocytes, from the stimulus",
    },
];

/// The reference band of a metric, if there is one.
pub fn band(name: &str) -> Option<&'static Band> {
    BANDS.iter().find(|band| band.name == name)
}

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
    /// Work and force at its ends; empty if the ends are not held.
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

/// Metrics of the beats of a run: a list of [`Beat`]s, one for each stimulus within the run.
///
/// # Example
/// ```
/// use myospring::prelude::*;
/// let mut simulation = Simulation::new(lattice::rectangle(20, 4, 5.0)?);
/// simulation.numerics.method = Method::QuasiStatic;
/// let beats = simulation.build()?.run(|_progress| true).beats();
/// assert_eq!(beats.len(), 1);
/// let shortening = beats[0].value("peak_shortening").unwrap();
/// let band = beats.bands.iter().find(|band| band.name == "peak_shortening").unwrap();
/// assert!(shortening <= 1.01 * band.high, "{shortening} {}", band.unit);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Beats {
    /// In order.
    pub list: Vec<Beat>,
    /// The energy balance at the end of the run: where the work of the active force went.
    pub energy: Vec<Metric>,
    /// Reference bands of these quantities.
    pub bands: [Band; 5],
    /// Whether the run ended before the last beat was over; means and spreads exclude that beat.
    pub cut_short: bool,
    /// Capture and alternans of the train.
    pub rhythm: Rhythm,
}

/// Least rise of the tension, relative to that at rest; less is rounding.
const LEAST: f64 = 1e-9;

const UPSTROKE: &str = "maximum_upstroke_velocity";

/// Metrics in which alternans is searched, with their names in words.
const HEIGHTS: [(&str, &str); 3] = [
    ("peak_tension", "peak tension"),
    ("peak_shortening", "peak shortening"),
    ("action_potential_duration_90", "APD90"),
];

impl Beats {
    /// Computes the beats of a recording with these stimulus times, ms; `s2_ms` is the time of the
    /// extra stimulus S2, if the last one is such.
    pub fn of(recording: &Recording, stimulus_times_ms: &[f64], s2_ms: Option<f64>) -> Self {
        let energy = energy(&recording.samples);
        let mut list = beats(recording, stimulus_times_ms);
        let cut_short = is_cut_short(&list, &recording.samples);
        if let Some(s2_ms) = s2_ms {
            list.retain(|beat| beat.stimulus_ms != s2_ms);
            if let Some(s1) = list.iter().rfind(|beat| !beat.is_missed()).or(list.last()) {
                list.extend(s2_beat(recording, stimulus_times_ms, s2_ms, s1));
            }
        }
        let mut all = Self { list, energy, bands: BANDS, cut_short, rhythm: Rhythm::default() };
        let train = || all.list.iter().filter(|beat| !beat.is_s2());
        let stimuli: Vec<f64> = train().map(|beat| beat.stimulus_ms).collect();
        let captured: Vec<Option<bool>> = train().map(|beat| beat.captured).collect();
        let heights = HEIGHTS.map(|(name, words)| {
            (words, all.counted().map(|beat| beat.value(name)).collect::<Vec<_>>())
        });
        all.rhythm = Rhythm::of(&stimuli, &captured, &heights);
        all
    }

    /// The beats that count in means: beats of the train whose stimulus was captured, except one
    /// that the end of the run cut short.
    pub fn counted(&self) -> impl Iterator<Item = &Beat> {
        let cut = self.list.iter().rposition(|beat| !beat.is_missed()).filter(|_| self.cut_short);
        let counts = move |(place, beat): &(usize, &Beat)| {
            !beat.is_missed() && !beat.is_s2() && Some(*place) != cut
        };
        self.list.iter().enumerate().filter(counts).map(|(_, beat)| beat)
    }

    /// The first beat that counts; if none does, the first of all.
    pub fn usual(&self) -> Option<&Beat> {
        self.counted().next().or(self.list.first())
    }

    /// The beat of the extra stimulus, if there is one.
    pub fn s2(&self) -> Option<&Beat> {
        self.list.last().filter(|last| last.is_s2())
    }

    /// The value of a metric of the whole run or of S2, or else the mean of a metric over the beats
    /// that count and have it; `None` if none has.
    pub fn mean(&self, name: &str) -> Option<f64> {
        if let Some(metric) = self.energy.iter().find(|metric| metric.name == name) {
            return metric.value;
        }
        if let Some(metric) =
            self.s2().and_then(|beat| beat.s2.iter().find(|metric| metric.name == name))
        {
            return metric.value;
        }
        let values: Vec<f64> = self.counted().filter_map(|beat| beat.value(name)).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    }

    /// Mean and standard deviation of every metric over the beats that count, if there are several.
    pub fn spread(&self) -> Vec<Spread> {
        let all: Vec<Vec<Metric>> =
            self.counted().map(|beat| beat.metrics().cloned().collect()).collect();
        if all.len() < 2 { Vec::new() } else { beat_to_beat(&all) }
    }
}

/// Whether the last of several beats is cut short: it was recorded for less time than the beat
/// before needed from its stimulus to 90 % relaxation (or 50 %, if it is paced too fast for that).
fn is_cut_short(list: &[Beat], samples: &[Sample]) -> bool {
    let captured: Vec<&Beat> = list.iter().filter(|beat| !beat.is_missed()).collect();
    let ([.., before, last], Some(end)) = (&*captured, samples.last()) else { return false };
    let relaxed = ["tension_relaxation_time_90", "tension_relaxation_time_50"];
    let relaxed = relaxed.into_iter().find_map(|name| before.value(name));
    let peak = before.value("time_of_peak_tension").map(|peak| peak - before.stimulus_ms);
    peak.zip(relaxed).is_some_and(|(peak, relaxed)| end.t_ms - last.stimulus_ms < peak + relaxed)
}

impl Deref for Beats {
    type Target = [Beat];

    fn deref(&self) -> &[Beat] {
        &self.list
    }
}

/// Every metric without values, in the order of tables: those of a beat, of an S2, and of the whole
/// run; `in_mv` says whether potentials are in mV.
pub fn known(in_mv: bool) -> Vec<Metric> {
    let still = Sample { u: Some(0.0), vm_mv: in_mv.then_some(0.0), ..Sample::STILL };
    // Names of metrics do not depend on the recording.
    let held = Signal { name: END_FORCE.to_owned(), unit: "nN".to_owned(), values: vec![0.0] };
    let recording = Recording { samples: vec![still], signals: vec![held], frames: Vec::new() };
    let Beats { list, energy, .. } = Beats::of(&recording, &[0.0], None);
    let of_beat = list.iter().flat_map(Beat::metrics).cloned();
    of_beat
        .chain(s2::rows(None, None, &[], &[]))
        .chain(energy)
        .map(|metric| Metric { value: None, missing: None, ..metric })
        .collect()
}

/// The metrics of each beat; a beat ends at the next captured stimulus.
pub fn beats(recording: &Recording, stimulus_times_ms: &[f64]) -> Vec<Beat> {
    let Recording { samples, signals, .. } = recording;
    let force = signals.iter().find(|signal| signal.is(END_FORCE));
    let times: Vec<f64> = samples.iter().map(|sample| sample.t_ms).collect();
    let captured = match potential(samples) {
        Some((potential, unit)) => capture::of(&times, &potential, unit, stimulus_times_ms),
        None => Vec::new(),
    };
    let of = |window: Window| {
        let force = force.and_then(|force| force.values.get(window.within.clone()));
        let captured = captured.get(window.place).copied().flatten();
        let mut beat = beat(&samples[window.within.clone()], force, &window, captured);
        let within = window.within.clone();
        if let Some(values) = calcium(recording).and_then(|values| values.get(within.clone())) {
            let rest = trace::baseline(&times[within.clone()], values, window.stimulus_ms);
            beat.calcium = levels(&times[within], values, rest, captured);
        }
        with_own_upstroke(beat, recording, [window.stimulus_ms, window.next_ms])
    };
    capture::windows(&times, stimulus_times_ms, &captured).into_iter().map(of).collect()
}

fn beat(
    samples: &[Sample],
    force: Option<&[f64]>,
    window: &Window,
    captured: Option<bool>,
) -> Beat {
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
    let action_potential = match potential(samples) {
        Some((potential, unit)) => {
            let rest = trace::baseline(&times, &potential, stimulus);
            let rest_is = rest::BEFORE_STIMULUS;
            let stimuli = [stimulus, window.next_ms];
            action_potential::above(&times, &potential, stimuli, unit, rest, rest_is)
        }
        None => Vec::new(),
    };
    let active = column(|s| s.ta_kpa);
    let rest = trace::baseline(&times, &active, stimulus).unwrap_or_default();
    let rest = (rest, rest::BEFORE_STIMULUS);
    let own = trace::twitch(&times, &active, stimulus);
    let tension = tension(&times[own.clone()], &active[own], stimulus, rest, &contraction);
    let at_rest = |read| trace::baseline(&times, &column(read), stimulus);
    let shape = shape(samples, &at_rest, &contraction);
    let load = force.map_or_else(Vec::new, |force| {
        load::metrics(&times, &column(|s| s.length_um), force, stimulus)
    });
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
    Some(&recording.signals.iter().find(|signal| signal.is(CALCIUM))?.values)
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
        let samples = recording.samples.iter().zip(&own.values);
        // The sample at a stimulus still belongs to the previous beat.
        let within = samples.filter(|(it, _)| stimulus_ms < it.t_ms && it.t_ms < next_ms);
        if let (Some(_), Some(steepest)) =
            (row.value, within.map(|(_, rate)| *rate).reduce(f64::max))
        {
            row.value = Some(steepest);
            row.definition = "largest rate of the potential by the model's own equations, at every step of their solution \
                              and without the current of the stimulus";
        }
    }
    beat
}

/// The potential and its unit, if all samples have one.
fn potential(samples: &[Sample]) -> Option<(Vec<f64>, &'static str)> {
    let everywhere =
        |read: fn(&Sample) -> Option<f64>| samples.iter().map(read).collect::<Option<Vec<f64>>>();
    let in_mv = everywhere(|s| s.vm_mv).map(|potential| (potential, "mV"));
    in_mv.or_else(|| Some((everywhere(|s| s.u)?, "")))
}

/// The beat of an S2 after the beat of the last S1; `None` if it was not recorded.
fn s2_beat(recording: &Recording, stimuli_ms: &[f64], s2_ms: f64, s1: &Beat) -> Option<Beat> {
    let Recording { samples, signals, .. } = recording;
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
    let shape = shape(&samples[within], &|read| rest(&column(read)), &contraction);
    let active = column(|s| s.ta_kpa);
    let within = of(&active);
    let tension = tension(
        &times[within.clone()],
        &active[within],
        s2_ms,
        (pair.rest(&active), rest::BEFORE_S1),
        &contraction,
    );
    let force = signals.iter().find(|signal| signal.is(END_FORCE));
    let load = force.map_or_else(Vec::new, |force| {
        let within = of(&force.values);
        load::above(
            &times[within.clone()],
            &lengths[within.clone()],
            &force.values[within],
            s2_ms,
            rest(&force.values),
            rest::BEFORE_S1,
        )
    });
    let (mut action_potential, mut captured, mut diastolic) = (Vec::new(), None, None);
    if let Some((potential, unit)) = potential(samples) {
        captured = pair.captured(&times, &potential);
        diastolic = pair.diastolic_interval(&times, &potential);
        action_potential = pair.metrics(&times, &potential, unit);
        // These are among the metrics of S2.
        action_potential.retain(|metric| !metric.name.ends_with("_interval"));
    }
    let mut groups = [tension, contraction, shape, load, action_potential];
    if captured == Some(false) {
        without_values(&mut groups);
    }
    let [tension, contraction, shape, load, action_potential] = groups;
    let s2 = s2::rows(
        Some(&pair),
        diastolic,
        &[&s1.tension, &s1.contraction],
        &[&tension, &contraction],
    );
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

/// The energy balance at the end of a run: where the work of the active force went.
pub fn energy(samples: &[Sample]) -> Vec<Metric> {
    let (first, last) = (samples.first(), samples.last());
    let at_end = |read: fn(&Sample) -> f64| last.map(read);
    let stored = Some(()).and_then(|()| Some(last?.elastic_energy_fj - first?.elastic_energy_fj));
    let most_stored = samples.iter().map(|s| s.elastic_energy_fj).reduce(f64::max);
    let work = at_end(|s| s.active_work_fj);
    let spent = Some(())
        .and_then(|()| Some(stored? + last?.kinetic_energy_fj + last?.dissipated_energy_fj));
    let gap = Some(()).and_then(|()| {
        let gap = 100.0 * (work? - spent?) / most_stored?;
        Some(gap).filter(|gap| gap.is_finite())
    });
    let row =
        |name, value: Option<f64>, unit, definition| row(name, recorded(value), unit, definition);
    vec![
        row("active_work", work, "fJ", "work of the active force over the run"),
        row("stored_energy", stored, "fJ", "elastic energy at the end, above the start"),
        row("largest_stored_energy", most_stored, "fJ", "largest elastic energy"),
        row("kinetic_energy", at_end(|s| s.kinetic_energy_fj), "fJ", "kinetic energy at the end"),
        row(
            "dissipated_energy",
            at_end(|s| s.dissipated_energy_fj),
            "fJ",
            "taken by dashpots and drag over the run",
        ),
        row(
            "energy_gap",
            gap,
            "%",
            "active work minus stored, kinetic and dissipated energy, of the largest stored energy; \
             work of supports, and the error of the trapezoidal rule",
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two beats, bells of 10 % shortening 2 ms behind their tension, at constant volume.
    fn samples() -> Vec<Sample> {
        let bell = |t: f64| {
            [150.0, 650.0].iter().map(|at| (-((t - at) / 40.0_f64).powi(2)).exp()).sum::<f64>()
        };
        let sample = |t: f64| {
            let ratio = 1.0 - 0.1 * bell(t - 2.0);
            Sample {
                t_ms: t,
                u: Some(bell(t)),
                ta_kpa: 50.0 * bell(t),
                length_um: 100.0 * ratio,
                width_um: 20.0 * ratio.powf(-0.5),
                area_um2: 2000.0 * ratio.sqrt(),
                shortening_pct: 100.0 * (1.0 - ratio),
                elastic_energy_fj: 1000.0 * bell(t),
                active_work_fj: 1000.0 * bell(t) + 0.1 * t,
                dissipated_energy_fj: 0.1 * t,
                ..Sample::STILL
            }
        };
        (0..2000).map(|i| sample(0.5 * f64::from(i))).collect()
    }

    fn recording() -> Recording {
        Recording { samples: samples(), ..Recording::default() }
    }

    #[test]
    fn every_beat_is_measured_against_its_own_rest() {
        let beats = beats(&recording(), &[0.0, 500.0]);
        assert_eq!(beats.len(), 2);
        for (beat, peak) in beats.iter().zip([150.0, 650.0]) {
            for (name, expected, tolerance) in [
                ("peak_tension", 50.0, 1e-3),
                ("time_of_peak_tension", peak, 1e-3),
                ("lag_of_shortening", 2.0, 1e-2),
                ("peak_shortening", 10.0, 1e-2),
                ("width_change_at_peak", 100.0 * (0.9_f64.powf(-0.5) - 1.0), 1e-2),
                ("width_beyond_isovolumic", 0.0, 1e-6),
                ("area_change_at_peak", 100.0 * (0.9_f64.sqrt() - 1.0), 1e-2),
            ] {
                let value = beat.value(name).unwrap();
                assert!((value - expected).abs() <= tolerance, "{name}: {value} not {expected}");
            }
        }
    }

    #[test]
    fn a_beat_that_the_end_of_the_run_cuts_short_counts_in_no_mean() {
        let until = |end: f64| {
            // Their bells of 150 ms are no action potentials.
            let samples = samples().into_iter().map(|sample| Sample { u: None, ..sample });
            let samples = samples.filter(|sample| sample.t_ms <= end).collect();
            let recording = Recording { samples, ..Recording::default() };
            Beats::of(&recording, &[0.0, 500.0], None)
        };
        // Its bell has its peak at 650 ms and a tenth of it at 711 ms.
        for (end, counted) in [(999.0, 2), (720.0, 2), (700.0, 1), (600.0, 1)] {
            let beats = until(end);
            assert_eq!((beats.len(), beats.counted().count()), (2, counted), "{end} ms");
            assert_eq!(beats.cut_short, counted == 1);
            assert!((beats.mean("peak_tension").unwrap() - 50.0).abs() < 1e-2, "{end} ms");
        }
        // One alone has nothing to be compared with.
        assert!(!Beats::of(&recording(), &[0.0], None).cut_short);
    }

    /// Stimuli every 300 ms from 50 ms on, of which those at these places raise an action potential of 250 ms and a
    /// twitch of 8 or, at odd places of the list, `other` kPa; what a stimulus alone adds is gone after 30 ms.
    fn paced(stimuli: usize, captured: &[usize], other: f64) -> (Recording, Vec<f64>) {
        let times: Vec<f64> = (0..stimuli).map(|place| 50.0 + 300.0 * place as f64).collect();
        let still = samples()[0];
        let sample = |t: f64| {
            let since = |place: usize| t - times[place];
            let added = |place: usize| 0.3 * (1.0 - since(place) / 30.0).clamp(0.0, 1.0);
            let potential = (0..stimuli).filter(|&place| since(place) >= 0.0).map(|place| {
                let whole = 1.4 * (1.0 - since(place) / 250.0).max(0.0);
                if captured.contains(&place) { whole } else { added(place) }
            });
            let twitch = captured.iter().enumerate().map(|(nth, &place)| {
                let peak = if nth % 2 == 0 { 8.0 } else { other };
                peak * (-((since(place) - 120.0) / 40.0).powi(2)).exp()
            });
            let ta_kpa: f64 = twitch.sum();
            let (u, length_um) = (Some(potential.sum()), 100.0 - ta_kpa);
            Sample { t_ms: t, u, ta_kpa, length_um, shortening_pct: ta_kpa, ..still }
        };
        let end = 50.0 + 300.0 * stimuli as f64;
        let samples = (0..).map(|i| 0.5 * f64::from(i)).take_while(|t| *t < end).map(sample);
        (Recording { samples: samples.collect(), ..Recording::default() }, times)
    }

    #[test]
    fn stimuli_without_an_action_potential_stand_apart_and_count_in_no_mean() {
        let (recording, stimuli) = paced(6, &[0, 2, 4], 8.0);
        let beats = Beats::of(&recording, &stimuli, None);
        let captured: Vec<bool> = beats.iter().map(|beat| beat.captured.unwrap()).collect();
        assert_eq!(captured, [true, false, true, false, true, false]);
        assert_eq!(
            (beats.counted().count(), beats.rhythm.not_captured.as_slice()),
            (3, &[2, 4, 6][..])
        );
        assert!(beats.rhythm.capture_ratio.as_ref().unwrap().starts_with("2:1 capture"));
        assert!(beats[1].metrics().all(|metric| metric.value.is_none()));
        for (name, expected) in [
            ("peak_tension", 8.0),
            ("action_potential_duration_90", 225.0),
            ("peak_potential", 1.4),
            ("peak_shortening", 8.0),
        ] {
            let spread = beats.spread();
            let spread = spread.iter().find(|spread| spread.name == name).unwrap();
            assert_eq!(spread.beats, 3, "{name}");
            // Samples lie 0.5 ms apart.
            assert!((spread.mean - expected).abs() < 1e-2 * expected, "{name}: {}", spread.mean);
            assert_eq!(beats.mean(name), Some(spread.mean));
        }
    }

    #[test]
    fn no_beat_has_its_peak_before_its_stimulus() {
        // Tension of the beat before is still 20 kPa and falls; its own twitch is small, or none.
        for own in [4.0, 0.0] {
            let (mut recording, stimuli) = paced(2, &[0, 1], 0.0);
            for sample in &mut recording.samples {
                let since = sample.t_ms - stimuli[1];
                let bell = own * (-((since - 120.0) / 40.0).powi(2)).exp();
                sample.ta_kpa = 20.0 * (-(since + 20.0) / 40.0).exp() + bell;
                sample.length_um = 100.0 - sample.ta_kpa;
            }
            let beats = Beats::of(&recording, &stimuli, None);
            assert_eq!(beats[1].captured, Some(true));
            // A small twitch lies below the rest that is not one.
            for name in ["time_to_peak_tension", "time_to_peak_from_stimulus"] {
                assert_eq!(beats[1].value(name).filter(|time| *time <= 0.0), None, "{name}, {own}");
            }
        }
    }

    #[test]
    fn a_first_stimulus_that_is_too_weak_is_missed_and_the_next_that_is_not_gives_the_numbers() {
        let (recording, stimuli) = paced(3, &[1], 8.0);
        let beats = Beats::of(&recording, &stimuli, None);
        assert_eq!(beats.rhythm.not_captured, [1, 3]);
        assert_eq!(beats.usual().unwrap().stimulus_ms, 350.0);
        let (recording, stimuli) = paced(2, &[], 8.0);
        let beats = Beats::of(&recording, &stimuli, None);
        assert_eq!((beats.counted().count(), beats.mean("peak_tension")), (0, None));
        assert_eq!(beats.rhythm.missed().unwrap(), "no stimulus raised an action potential");
    }

    #[test]
    fn every_other_beat_that_is_weaker_is_alternans_also_where_every_other_stimulus_is_missed() {
        for captured in [vec![0, 1, 2, 3, 4, 5], vec![0, 2, 4, 6, 8, 10]] {
            let (recording, stimuli) = paced(12, &captured, 6.0);
            let alternans = Beats::of(&recording, &stimuli[..12], None).rhythm.alternans.unwrap();
            assert!(alternans.contains("peak tension by 25."), "{alternans}");
        }
        let (recording, stimuli) = paced(6, &[0, 1, 2, 3, 4, 5], 8.0);
        assert_eq!(
            Beats::of(&recording, &stimuli, None).rhythm,
            Rhythm { stimuli: 6, ..Rhythm::default() }
        );
    }

    #[test]
    fn energy_that_is_accounted_for_leaves_no_gap() {
        let energy = energy(&samples());
        // The bell is not quite zero at the start.
        assert!(value(&energy, "energy_gap").unwrap().abs() < 1e-3, "{energy:?}");
    }

    #[test]
    fn a_recording_without_samples_has_no_beats() {
        assert!(beats(&Recording::default(), &[50.0]).is_empty());
        assert_eq!(value(&energy(&[]), "active_work"), None);
    }

    #[test]
    fn every_band_belongs_to_a_metric_of_the_same_unit() {
        let beat = &beats(&recording(), &[0.0])[0];
        for band in &BANDS {
            let metric = beat.metrics().find(|metric| metric.name == band.name).unwrap();
            assert_eq!(metric.unit, band.unit);
        }
    }
}
