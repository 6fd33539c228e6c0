//! The beats of a run: means, spreads, energy balance.

use super::bands::{BANDS, Band};
use super::beat::{Beat, beats, potential, s2_beat};
use super::rhythm::Rhythm;
use super::rows::{recorded, row};
use super::spiral;
use super::spontaneous::{self, Upstrokes};
use super::{Metric, Missing, Spread, beat_to_beat, s2};
use crate::recording::{
    AXIAL_FORCE, CONTRACTILE_MOMENT, END_FORCE, GEL_ENERGY, LENGTH_BOTTOM, LENGTH_TOP, Recording,
    Sample, Signal, THICKNESS, TRACTION_FORCE, VOLUME, Wave,
};
use std::ops::Deref;

/// Metrics of the beats of a run: a list of [`Beat`]s, one for each stimulus within the run; for a
/// cell that beats by itself, one for each action potential, from its stimulus or its take-off.
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
        let own = by_itself(recording, stimulus_times_ms).filter(|_| s2_ms.is_none());
        let starts = own.as_ref().map(|(upstrokes, _)| upstrokes.starts(stimulus_times_ms));
        let mut list = beats(recording, starts.as_deref().unwrap_or(stimulus_times_ms));
        if let Some((upstrokes, unit)) = &own {
            for (at, beat) in list.iter_mut().enumerate() {
                beat.action_potential.extend(upstrokes.metrics(at, unit));
            }
        }
        let cut_short = is_cut_short(&list, &recording.samples);
        if let Some(s2_ms) = s2_ms {
            list.retain(|beat| beat.stimulus_ms != s2_ms);
            if let Some(s1) = list.iter().rfind(|beat| !beat.is_missed()).or(list.last()) {
                list.extend(s2_beat(recording, stimulus_times_ms, s2_ms, s1));
            }
        }
        let mut all = Self { list, energy, bands: BANDS, cut_short, rhythm: Rhythm::default() };
        let train = || all.list.iter().filter(|beat| !beat.is_s2());
        let mut stimuli: Vec<f64> = train().map(|beat| beat.stimulus_ms).collect();
        let mut captured: Vec<Option<bool>> = train().map(|beat| beat.captured).collect();
        if let Some((Upstrokes(upstrokes), _)) = &own {
            stimuli = stimulus_times_ms.to_vec();
            let raised = |at: usize| upstrokes.iter().any(|own| own.stimulus == Some(at));
            captured = (0..stimuli.len()).map(|at| Some(raised(at))).collect();
        }
        let heights = HEIGHTS.map(|(name, words)| {
            (words, all.counted().map(|beat| beat.value(name)).collect::<Vec<_>>())
        });
        all.rhythm = Rhythm::of(&stimuli, &captured, &heights);
        all.rhythm.spontaneous =
            own.map(|(upstrokes, unit)| upstrokes.rhythm(unit, stimulus_times_ms.len()));
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

/// The upstrokes of a cell that beats by itself, and the unit of its potential.
fn by_itself(recording: &Recording, stimuli_ms: &[f64]) -> Option<(Upstrokes, &'static str)> {
    let (values, unit) = potential(&recording.samples)?;
    let times: Vec<f64> = recording.samples.iter().map(|sample| sample.t_ms).collect();
    Some((Upstrokes::of(&times, &values, unit, stimuli_ms)?, unit))
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
    let signal = |name: &str| Signal { name: name.into(), unit: String::new(), values: vec![0.0] };
    let told = [
        END_FORCE,
        TRACTION_FORCE,
        AXIAL_FORCE,
        CONTRACTILE_MOMENT,
        GEL_ENERGY,
        THICKNESS,
        VOLUME,
        LENGTH_TOP,
        LENGTH_BOTTOM,
    ];
    let signals = told.map(signal).to_vec();
    let wave = Some(Wave::default());
    let recording = Recording { samples: vec![still], signals, wave, ..Recording::default() };
    let Beats { list, energy, .. } = Beats::of(&recording, &[0.0], None);
    let of_beat = list.iter().flat_map(Beat::metrics).cloned();
    of_beat
        .chain(spontaneous::rows([Err(Missing::First); 3], if in_mv { "mV" } else { "" }))
        .chain(s2::rows(None, None, &[], &[]))
        .chain(spiral::metrics(&Wave::default(), [0.0, f64::INFINITY]))
        .chain(energy)
        .map(|metric| Metric { value: None, missing: None, ..metric })
        .collect()
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
    use crate::analysis::value;

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
