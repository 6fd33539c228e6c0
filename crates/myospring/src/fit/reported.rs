//! What a fit reports of its unknowns and of its curves.

use super::answer::FittedCurve;
use super::least_squares::{Least, squares};
use super::misfit::Misfit;
use super::observed::{Frames, Scale};
use super::problem::{Layout, Role, Source};
use super::unknown::Unknown;

/// A frame is bad if its residual is this many times the noise while those of its neighbours are
/// not.
const BAD: f64 = 6.0;

impl Layout {
    /// Whether its profile is computed; delays of single beats are fitted but not reported.
    pub(super) fn is_shown(&self, place: usize) -> bool {
        let role = &self.roles[place];
        !matches!(
            role,
            Role::Delay { beat: Some(_), .. } | Role::Drift { .. } | Role::ScaleError { .. }
        )
    }

    pub(super) fn unknown(&self, place: usize) -> Option<&Unknown> {
        match &self.roles[place] {
            Role::Physics(unknown) => Some(unknown),
            _ => None,
        }
    }

    pub(super) fn name(&self, place: usize) -> String {
        let of = |what: &str, source: usize| {
            if self.sources.len() == 1 {
                what.to_owned()
            } else {
                format!("{what} ({})", self.sources[source].observed.name)
            }
        };
        match &self.roles[place] {
            Role::Physics(unknown) => unknown.to_string(),
            Role::Delay { source, .. } => of("delay", *source),
            Role::Level { source } => match self.sources[*source].observed.scale {
                Scale::Length => of("resting_length", *source),
                Scale::Percent | Scale::Arbitrary | Scale::Load(_) => of("baseline", *source),
            },
            Role::Gain { source } => of("gain", *source),
            Role::Drift { source } => of("drift", *source),
            Role::ScaleError { source } => of("scale_error", *source),
        }
    }

    /// Leaves out single bad frames, those far from the fitted curve whose neighbours are not;
    /// returns whether there are any.
    pub(super) fn leave_out_bad_frames(&mut self, least: &Least) -> bool {
        let mut any = false;
        for number in 0..self.sources.len() {
            let Some(curve) = self.curve(&least.at, number, &self.sources[number].frames.times)
            else {
                continue;
            };
            let Source { frames: Frames { values, noise, .. }, used, .. } =
                &mut self.sources[number];
            let off: Vec<f64> = values.iter().zip(&curve).map(|(a, b)| (a - b) / *noise).collect();
            for at in 0..off.len() {
                let mut near: Vec<f64> = (at.saturating_sub(2)..(at + 3).min(off.len()))
                    .filter(|other| *other != at)
                    .map(|other| off[other])
                    .collect();
                near.sort_by(f64::total_cmp);
                let usual = f64::midpoint(near[(near.len() - 1) / 2], near[near.len() / 2]);
                let spread = (near[near.len() - 1] - near[0]).max(1.0);
                if (off[at] - usual).abs() > BAD * spread {
                    used[at] = false;
                    any = true;
                }
            }
        }
        any
    }

    /// Frames that count as one: the mean over all curves, weighted by their parts of the sum of
    /// squares.
    pub(super) fn frames_together(&self, least: &Least) -> Option<f64> {
        let (mut sum, mut over_long) = (0.0, 0.0);
        for number in 0..self.sources.len() {
            let FittedCurve { noise, residual, frames_together, used, .. } =
                self.fitted(least, number)?;
            let count = used.iter().filter(|used| **used).count() as f64;
            let squares = count * (residual / noise).powi(2);
            sum += squares;
            over_long += frames_together * squares;
        }
        Some(if sum > 0.0 { over_long / sum } else { 1.0 })
    }

    pub(super) fn fitted(&self, least: &Least, number: usize) -> Option<FittedCurve> {
        let source = &self.sources[number];
        let Source { observed, frames, used, .. } = source;
        let fitted = self.curve(&least.at, number, &frames.times)?;
        let stimuli_ms = self.stimuli(&least.at, number);
        let misfit = Misfit::of(source, &stimuli_ms, &fitted);
        let off: Vec<f64> = frames
            .values
            .iter()
            .zip(&fitted)
            .zip(used)
            .filter(|(_, used)| **used)
            .map(|((value, fitted), _)| value - fitted)
            .collect();
        Some(FittedCurve {
            name: observed.name.clone(),
            scale: observed.scale,
            unit: observed.unit.clone(),
            times_ms: frames.times.clone(),
            measured: frames.values.clone(),
            left_out_ms: observed.gaps(),
            stimuli_ms,
            noise: frames.noise,
            residual: (squares(&off) / off.len().max(1) as f64).sqrt(),
            misfit: misfit.size,
            frames_together: misfit.together,
            unexplained: misfit.unexplained,
            used: used.clone(),
            fitted,
        })
    }
}
