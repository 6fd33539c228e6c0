//! From a vector of unknowns to the residuals of several curves of one cell.

use super::contraction::Contraction;
use super::least_squares::Least;
use super::observed::{Frames, Observed, Scale, Stimuli};
use super::unknown::{Physics, Unknown};

/// Bound of the delays around the value from the rise of the beat, ms.
const DELAY_MS: f64 = 150.0;
/// Bound of the levels around the resting level, in heights of the beat.
const LEVELS: f64 = 3.0;
/// Steps for differences: of logarithms, of delays (ms), and of levels over the height of the beat.
const STEP: f64 = 1e-4;
const STEP_MS: f64 = 0.02;
/// Bound of the error of a scale, in its standard deviations.
const LARGEST_ERROR: f64 = 6.0;

/// A curve and the cell that makes it.
pub(super) struct Source {
    pub(super) observed: Observed,
    pub(super) frames: Frames,
    pub(super) contraction: Contraction,
    /// Of each frame: whether it counts.
    pub(super) used: Vec<bool>,
    /// Mean time from stimulus to stimulus, ms; for a single beat the rest of the recording.
    pub(super) cycle: f64,
    /// Relative standard deviation of the scale of a load; 0 if it is exact.
    pub(super) scale_error: f64,
}

/// The meaning of an unknown of the vector.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Role {
    /// Logarithm of the factor on the run's value.
    Physics(Unknown),
    /// Delay of all beats of a curve, or of one, ms.
    Delay { source: usize, beat: Option<usize> },
    /// Value at rest.
    Level { source: usize },
    /// How much higher the last frame's rest is than the first's, of a curve with several beats.
    Drift { source: usize },
    /// Height of a contraction in arbitrary units for a shortening of all the cell.
    Gain { source: usize },
    /// Logarithm of the factor on a load that the error of its scale makes.
    ScaleError { source: usize },
}

/// What a curve shows, without its level and scale: the shortening, or a load.
pub(super) struct Response {
    pub(super) values: Vec<f64>,
    /// The derivative of a load by the shortening.
    pub(super) by_shortening: Option<Vec<f64>>,
}

/// All unknowns, and how residuals follow from them.
pub(super) struct Layout {
    pub(super) sources: Vec<Source>,
    pub(super) roles: Vec<Role>,
    pub(super) bounds: Vec<[f64; 2]>,
    pub(super) steps: Vec<f64>,
    /// The run's value of every fitted parameter, in the order of the roles.
    pub(super) usual: Vec<f64>,
    /// Standard deviation of a residual, in those of the noise: the errors of scales, which are known, count in these.
    pub(super) unit: f64,
}

impl Layout {
    /// `bounds` are those of the unknowns, as factors.
    pub(super) fn new(sources: Vec<Source>, unknowns: &[(Unknown, [f64; 2], f64)]) -> Self {
        let mut layout = Self {
            sources,
            roles: Vec::new(),
            bounds: Vec::new(),
            steps: Vec::new(),
            usual: Vec::new(),
            unit: 1.0,
        };
        for (unknown, [low, high], usual) in unknowns {
            layout.add(Role::Physics(unknown.clone()), [low.ln(), high.ln()], STEP);
            if matches!(unknown, Unknown::Parameter(_)) {
                layout.usual.push(*usual);
            }
        }
        for source in 0..layout.sources.len() {
            let Source { observed, frames, .. } = &layout.sources[source];
            let (height, rest, scale) = (frames.reach.abs(), frames.rest, observed.scale);
            let beats = match &observed.stimuli {
                Stimuli::Given(_) => vec![None],
                Stimuli::Seen(times) => (0..times.len()).map(Some).collect(),
                Stimuli::Clocked { .. } => Vec::new(),
            };
            for beat in beats {
                layout.add(Role::Delay { source, beat }, [-DELAY_MS, DELAY_MS], STEP_MS);
            }
            let levels = [rest - LEVELS * height, rest + LEVELS * height];
            layout.add(Role::Level { source }, levels, 1e-3 * height);
            if layout.sources[source].observed.stimuli.beats() > 1 {
                layout.add(Role::Drift { source }, [-height, height], 1e-3 * height);
            }
            if scale == Scale::Arbitrary {
                layout.add(Role::Gain { source }, [1e-3 * height, 1e6 * height], 1e-2 * height);
            }
            let error = layout.sources[source].scale_error;
            if error > 0.0 {
                let most = LARGEST_ERROR * error;
                layout.add(Role::ScaleError { source }, [-most, most], STEP);
            }
        }
        layout
    }

    fn add(&mut self, role: Role, bounds: [f64; 2], step: f64) {
        self.roles.push(role);
        self.bounds.push(bounds);
        self.steps.push(step);
    }

    /// Factors of the physics, and the values of the fitted parameters.
    pub(super) fn physics<'a>(&self, at: &[f64], parameters: &'a mut Vec<f64>) -> Physics<'a> {
        let (mut ratio, mut stiffness, mut tension) = (0.0, 0.0, None);
        parameters.clear();
        for (role, value) in self.roles.iter().zip(at) {
            match role {
                Role::Physics(Unknown::TensionOverStiffness) => ratio = *value,
                Role::Physics(Unknown::YoungModulus) => stiffness = *value,
                Role::Physics(Unknown::PeakTension) => tension = Some(*value),
                Role::Physics(Unknown::Parameter(_)) => {
                    parameters.push(self.usual[parameters.len()] * value.exp());
                }
                _ => {}
            }
        }
        let ratio = tension.map_or(ratio, |tension| tension - stiffness);
        Physics { tension: ratio.exp(), stiffness: stiffness.exp(), parameters }
    }

    /// Where tension over stiffness and the stiffness are, if both are sought.
    pub(super) fn ratio_and_stiffness(&self) -> Option<[usize; 2]> {
        let place = |wanted: Unknown| {
            self.roles.iter().position(|role| *role == Role::Physics(wanted.clone()))
        };
        Some([place(Unknown::TensionOverStiffness)?, place(Unknown::YoungModulus)?])
    }

    /// Seeks the tension in place of tension over stiffness: the same problem in other coordinates.
    pub(super) fn seek_tension(&mut self, [ratio, stiffness]: [usize; 2], answers: &mut [Least]) {
        self.roles[ratio] = Role::Physics(Unknown::PeakTension);
        let [lower, upper] = self.bounds[stiffness];
        let [low, high] = self.bounds[ratio];
        self.bounds[ratio] = [low + lower, high + upper];
        for answer in answers {
            answer.at[ratio] += answer.at[stiffness];
        }
    }

    /// The stimuli of a curve, each with its delay.
    pub(super) fn stimuli(&self, at: &[f64], number: usize) -> Vec<f64> {
        let mut times = self.sources[number].observed.stimuli.times().to_vec();
        for (role, delay) in self.roles.iter().zip(at) {
            match role {
                Role::Delay { source, beat: None } if *source == number => {
                    for time in &mut times {
                        *time += delay;
                    }
                }
                Role::Delay { source, beat: Some(beat) } if *source == number => {
                    times[*beat] += delay;
                }
                _ => {}
            }
        }
        times
    }

    /// The shortening in each frame of a curve.
    pub(super) fn shortening(&self, at: &[f64], number: usize, times: &[f64]) -> Option<Vec<f64>> {
        let mut parameters = Vec::new();
        let physics = self.physics(at, &mut parameters);
        let stimuli = self.stimuli(at, number);
        // Delays must keep the order of the beats.
        if stimuli.windows(2).any(|pair| pair[1] <= pair[0]) {
            return None;
        }
        self.sources[number].contraction.shortening(&physics, &stimuli, times)
    }

    /// What a curve shows, without its level and scale.
    pub(super) fn response(&self, at: &[f64], number: usize, times: &[f64]) -> Option<Response> {
        let values = self.shortening(at, number, times)?;
        let source = &self.sources[number];
        let Scale::Load(name) = source.observed.scale else {
            return Some(Response { values, by_shortening: None });
        };
        let mut parameters = Vec::new();
        let physics = self.physics(at, &mut parameters);
        let most = values.iter().copied().fold(0.0, f64::max);
        let load = source.contraction.load(name, physics.stiffness, most)?;
        let at = values.into_iter().map(|shortening| load.at(shortening));
        let (values, by_shortening) = at.map(|[load, by]| (load, by)).unzip();
        Some(Response { values, by_shortening: Some(by_shortening) })
    }

    /// The model's curve in the units of the measured one.
    pub(super) fn curve(&self, at: &[f64], number: usize, times: &[f64]) -> Option<Vec<f64>> {
        let mut curve = self.response(at, number, times)?.values;
        let [level, gain, drift] = self.scale(at, number);
        for (value, part) in curve.iter_mut().zip(self.parts(number, times)) {
            let level = level + drift * part;
            *value = match self.sources[number].observed.scale {
                Scale::Length => level * (1.0 - *value),
                Scale::Percent => level + 100.0 * *value,
                Scale::Arbitrary | Scale::Load(_) => level + gain * *value,
            };
        }
        Some(curve)
    }

    /// Level, gain and drift of a curve.
    pub(super) fn scale(&self, at: &[f64], number: usize) -> [f64; 3] {
        let find = |wanted: &Role| self.roles.iter().position(|role| role == wanted);
        let level = find(&Role::Level { source: number }).map_or(0.0, |place| at[place]);
        let error = find(&Role::ScaleError { source: number }).map_or(0.0, |place| at[place]);
        let gain = find(&Role::Gain { source: number }).map_or(error.exp(), |place| at[place]);
        let drift = find(&Role::Drift { source: number }).map_or(0.0, |place| at[place]);
        [level, gain, drift]
    }

    /// Times as parts of the recording of a curve, from -1/2 to 1/2.
    pub(super) fn parts(&self, number: usize, times: &[f64]) -> Vec<f64> {
        let all = &self.sources[number].frames.times;
        let (first, last) = (all[0], all[all.len() - 1]);
        times.iter().map(|time| (time - first) / (last - first) - 0.5).collect()
    }

    /// Residuals of all frames that count, over their noise, then those of the errors of scales.
    pub(super) fn residuals(&self, at: &[f64]) -> Option<Vec<f64>> {
        let mut all = Vec::new();
        for number in 0..self.sources.len() {
            let Source { frames, used, .. } = &self.sources[number];
            let curve = self.curve(at, number, &frames.times)?;
            let off = frames.values.iter().zip(&curve).zip(used).filter(|(_, used)| **used);
            all.extend(off.map(|((value, curve), _)| (value - curve) / frames.noise));
        }
        all.extend(self.scale_errors().map(|(place, deviation)| at[place] / deviation));
        all.iter().all(|value| value.is_finite()).then_some(all)
    }

    /// Where errors of scales are, and their standard deviations over that of a residual.
    pub(super) fn scale_errors(&self) -> impl Iterator<Item = (usize, f64)> {
        self.roles.iter().enumerate().filter_map(|(place, role)| {
            let Role::ScaleError { source } = role else { return None };
            Some((place, self.sources[*source].scale_error / self.unit))
        })
    }

    /// A starting point: parameters with these factors, a tension at which beats have the measured
    /// height, and delays at which they rise when the measured ones do.
    pub(super) fn start(&self, factors: &[f64]) -> Option<Vec<f64>> {
        let mut at: Vec<f64> = self.roles.iter().map(|_| 0.0).collect();
        let mut factors = factors.iter();
        for (place, role) in self.roles.iter().enumerate() {
            if let Role::Physics(unknown) = role
                && *unknown != Unknown::TensionOverStiffness
            {
                let [low, high] = self.bounds[place];
                at[place] = factors.next().copied().unwrap_or(1.0).ln().clamp(low, high);
            }
        }
        let first = &self.sources[0];
        let tension = self
            .roles
            .iter()
            .position(|role| *role == Role::Physics(Unknown::TensionOverStiffness));
        if let (Some(place), Some(height)) = (tension, first.shortening()) {
            let mut parameters = Vec::new();
            let physics = self.physics(&at, &mut parameters);
            let [low, high] = self.bounds[place];
            let found = first.contraction.tension_for(height, &physics, first.cycle)?;
            at[place] = found.ln().clamp(low, high);
        }
        for number in 0..self.sources.len() {
            let source = &self.sources[number];
            let fine: Vec<f64> = (0..400).map(|at| f64::from(at) * source.cycle / 400.0).collect();
            let mut parameters = Vec::new();
            let physics = self.physics(&at, &mut parameters);
            let beat = source.contraction.shortening(&physics, &[0.0], &fine)?;
            let peak = beat.iter().copied().fold(0.0, f64::max);
            let risen = beat.iter().position(|value| *value > 0.5 * peak)?;
            let seen = source.risen();
            for (place, role) in self.roles.iter().enumerate() {
                let [low, high] = self.bounds[place];
                match role {
                    Role::Delay { source: of, beat } if *of == number => {
                        let beat = beat.unwrap_or(0);
                        let stimulus = source.observed.stimuli.times()[beat];
                        let rise = seen.get(beat).copied().flatten();
                        let delay = rise.map_or(0.0, |rise| rise - fine[risen] - stimulus);
                        at[place] = delay.clamp(low, high);
                    }
                    Role::Level { source: of } if *of == number => at[place] = source.frames.rest,
                    Role::Gain { source: of } if *of == number => {
                        at[place] = (source.frames.reach / peak).clamp(low, high);
                    }
                    _ => {}
                }
            }
        }
        Some(at)
    }
}

impl Source {
    /// The largest measured shortening, a part of the resting length; `None` in arbitrary units.
    pub(super) fn shortening(&self) -> Option<f64> {
        let Frames { rest, reach, .. } = self.frames;
        shortening(self.observed.scale, rest, reach)
    }

    /// When each beat has risen by half, ms, if the curve shows it.
    fn risen(&self) -> Vec<Option<f64>> {
        let Frames { times, values, rest, reach, .. } = &self.frames;
        let half = |value: f64| (value - rest) / reach - 0.5;
        let stimuli = self.observed.stimuli.times();
        let beat = |(number, stimulus): (usize, &f64)| {
            let end = stimuli.get(number + 1).copied().unwrap_or(f64::INFINITY);
            let frames = times.windows(2).zip(values.windows(2));
            let mut within = frames.filter(|(times, _)| {
                times[0] >= stimulus - DELAY_MS && times[0] < end - DELAY_MS.min(0.3 * self.cycle)
            });
            let (times, values) =
                within.find(|(_, values)| half(values[0]) <= 0.0 && half(values[1]) > 0.0)?;
            let [from, to] = [half(values[0]), half(values[1])];
            Some(times[0] + (times[1] - times[0]) * from / (from - to))
        };
        stimuli.iter().enumerate().map(beat).collect()
    }
}

/// The shortening that a curve shows, a part of the resting length; `None` in arbitrary units.
pub(super) fn shortening(scale: Scale, rest: f64, reach: f64) -> Option<f64> {
    match scale {
        Scale::Length => Some((-reach / rest).clamp(1e-6, 0.9)),
        Scale::Percent => Some((reach / 100.0).clamp(1e-6, 0.9)),
        Scale::Arbitrary | Scale::Load(_) => None,
    }
}
