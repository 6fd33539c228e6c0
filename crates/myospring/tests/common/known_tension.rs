//! Curves of cells whose tension is known: three beats of a model.
#![allow(dead_code, reason = "no user of this file needs all of it")]

use myospring::analysis::monotone::MonotoneCubic;
use myospring::cell;
use myospring::fit::{Fit, FitSettings, Fitter, Observed, OwnTension, Scale, Stimuli};
use myospring::mechanics::support::SupportKind;
use myospring::prelude::*;
use myospring::simulation::Outcome;
use myospring::study::sampling::{Distribution, Sampler, sample};

pub(crate) const STIMULI: [f64; 3] = [50.0, 1050.0, 2050.0];

pub(crate) fn strip() -> Simulation {
    let mut simulation = Simulation::new(lattice::rectangle(20, 4, 5.0).unwrap());
    simulation.numerics.method = Method::QuasiStatic;
    simulation
}

pub(crate) fn beaten(simulation: &Simulation) -> Outcome {
    let outcome = simulation.build().unwrap().run(|_progress| true);
    assert_eq!(outcome.stop, None);
    outcome
}

/// Times, lengths and tensions above that at rest of three beats of a model.
pub(crate) struct Truth {
    pub(crate) times: Vec<f64>,
    pub(crate) lengths: Vec<f64>,
    pub(crate) tensions: Vec<f64>,
    /// Tension at rest, kPa.
    pub(crate) rest: f64,
}

impl Truth {
    pub(crate) fn of(model: &str, support: SupportKind) -> (Simulation, Self) {
        let mut simulation = strip();
        simulation.cell = cell::model(model).unwrap();
        simulation.support = support;
        simulation.protocol = Protocol {
            cycle_length_ms: 1000.0,
            beats: 3,
            ..Protocol::once(simulation.cell.default_stimulus())
        };
        simulation.duration = 3050.0;
        let samples = beaten(&simulation).recording.samples;
        let column = |of: fn(&myospring::recording::Sample) -> f64| -> Vec<f64> {
            samples.iter().map(of).collect()
        };
        let tensions = column(|sample| sample.ta_kpa);
        let rest = tensions[0];
        let tensions = tensions.into_iter().map(|tension| tension - rest).collect();
        let truth = Self {
            times: column(|sample| sample.t_ms),
            lengths: column(|it| it.length_um),
            tensions,
            rest,
        };
        (simulation, truth)
    }

    pub(crate) fn peak(&self) -> f64 {
        self.tensions.iter().copied().fold(0.0, f64::max)
    }

    /// Frames at a rate, with noise as a part of the amplitude, and the true tension in each.
    pub(crate) fn filmed(&self, frames_per_s: f64, noise: f64, seed: u64) -> (Observed, Vec<f64>) {
        let lengths = MonotoneCubic::new(self.times.clone(), self.lengths.clone());
        let tensions = MonotoneCubic::new(self.times.clone(), self.tensions.clone());
        let count = (3050.0 * frames_per_s / 1e3) as usize;
        let times_ms: Vec<f64> = (0..count).map(|at| at as f64 * 1e3 / frames_per_s).collect();
        let shortest = self.lengths.iter().copied().fold(f64::INFINITY, f64::min);
        let deviation = (noise * (self.lengths[0] - shortest)).max(1e-300);
        let normal = Distribution::Normal { mean: 0.0, standard_deviation: deviation };
        let drawn = sample(&Sampler::LatinHypercube { size: count }, &[normal], seed).unwrap();
        let values =
            times_ms.iter().zip(drawn.iter()).map(|(time, draw)| lengths.at(*time) + draw[0]);
        let (values, truth) =
            (values.collect(), times_ms.iter().map(|t| tensions.at(*t)).collect());
        let stimuli = Stimuli::Given(STIMULI.to_vec());
        let unit = "um".to_owned();
        (
            Observed { name: "cell".into(), times_ms, values, scale: Scale::Length, unit, stimuli },
            truth,
        )
    }

    /// Mean of the peaks of the beats, kPa.
    pub(crate) fn mean_peak(&self) -> f64 {
        let within = |from: f64| {
            let samples = self.times.iter().zip(&self.tensions);
            let beat = samples.filter(|(time, _)| (from..from + 1000.0).contains(*time));
            beat.map(|(_, tension)| *tension).fold(0.0, f64::max)
        };
        STIMULI.map(within).iter().sum::<f64>() / STIMULI.len() as f64
    }

    /// Whether the mean of the peaks lies in the interval that a noisy curve gives by its noise, and in that by its beats.
    pub(crate) fn peak_is_covered(
        &self,
        fitter: &Fitter,
        frames_per_s: f64,
        noise: f64,
        seed: u64,
    ) -> [bool; 2] {
        let (_, own) = own(fitter, self.filmed(frames_per_s, noise, seed).0);
        let peak = own.metrics.iter().find(|metric| metric.name == "peak_tension").unwrap();
        [peak.interval_by_noise, peak.interval_by_beats.unwrap()]
            .map(|[low, high]| (low..=high).contains(&self.mean_peak()))
    }

    /// How far the tension of a curve without noise is off at most, as a part of its peak.
    pub(crate) fn off_when_clean(&self, fitter: &Fitter) -> f64 {
        let (observed, tensions) = self.filmed(1000.0, 0.0, 1);
        let (_, own) = own(fitter, observed);
        let off = own.unclipped_kpa.iter().zip(&tensions).map(|(a, b)| (a - b).abs());
        off.fold(0.0, f64::max) / self.peak()
    }
}

pub(crate) fn own(fitter: &Fitter, observed: Observed) -> (Fit, OwnTension) {
    let fit = fitter.fit(&[observed], &FitSettings::default(), &|_| true).unwrap().unwrap();
    let own = fit.own_tension.clone().unwrap();
    (fit, own)
}

/// Part of the frames whose true tension lies in the band.
pub(crate) fn covered(own: &OwnTension, observed: &Observed, truth: &[f64]) -> [usize; 2] {
    let at = |time: f64| observed.times_ms.partition_point(|other| *other < time - 1e-6);
    let [low, high] = &own.band_kpa;
    let within = own.times_ms.iter().enumerate().filter(|(frame, time)| {
        let true_tension = truth[at(**time)].max(0.0);
        // Rounding of a band without width.
        let hair = 1e-9 * (1.0 + true_tension);
        (low[*frame] - hair..=high[*frame] + hair).contains(&true_tension)
    });
    [within.count(), own.times_ms.len()]
}
