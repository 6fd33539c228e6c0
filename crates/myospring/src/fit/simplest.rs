//! Which of several cell models follows a curve, by what each leaves of it.
//!
//! With `k` fitted numbers and `n` frames, the criterion of `schwarz_1978` is
//! ```text
//! BIC = chi^2 + k ln n,   chi^2 = sum over the frames of (residual / noise)^2
//! ```
//! over the frames that every model used. The model with the lowest BIC is taken among those that follow the curve, that is, whose
//! verdict is not [`FitVerdict::DoesNotFit`]. If there is none, the curve's own tension is taken, which has a number for each frame.
//! Models whose BIC is higher by less than 10 are not told apart (`kass_1995`); where residuals vary more than the noise, the
//! difference is first divided by that factor.

use super::answer::{Fit, FitVerdict, FittedCurve, Left, TriedModel};
use super::words;

/// A difference of BIC above which the evidence is very strong (`kass_1995`).
const VERY_STRONG: f64 = 10.0;

/// The place of the simplest fit that follows its curve, and what each model leaves, the one that is taken first.
pub fn simplest<E: ToString>(fits: &[(String, Result<Fit, E>)]) -> (usize, Vec<TriedModel>) {
    let found: Vec<&Fit> = fits.iter().filter_map(|(_, fit)| fit.as_ref().ok()).collect();
    let common = Common::of(&found);
    let left = |fit: &Result<Fit, E>| fit.as_ref().ok().map(|fit| common.left(fit));
    let mut tried: Vec<TriedModel> = fits
        .iter()
        .map(|(model, fit)| TriedModel {
            model: model.clone(),
            taken: false,
            left: left(fit),
            reason: fit.as_ref().err().map(ToString::to_string),
        })
        .collect();
    let is_own = |at: usize| fits[at].1.as_ref().is_ok_and(|fit| fit.own_tension.is_some());
    let lowest = |follows: bool| {
        let counts = |left: &Left| !follows || left.verdict != FitVerdict::DoesNotFit;
        let bic = |at: &usize| tried[*at].left.as_ref().filter(|it| counts(it)).map(|it| it.bic);
        let of_models = (0..fits.len()).filter(|&at| !is_own(at) && bic(&at).is_some());
        of_models.min_by(|a, b| bic(a).partial_cmp(&bic(b)).unwrap_or(std::cmp::Ordering::Equal))
    };
    let own = (0..fits.len()).find(|&at| is_own(at));
    let taken = lowest(true).or(own).or_else(|| lowest(false)).unwrap_or(0);
    if let (Some(best), Ok(fit)) = (tried[taken].left.clone(), &fits[taken].1) {
        let spread = (fit.reduced_chi_squared * fit.variance_factor).max(1.0);
        for (at, row) in tried.iter_mut().enumerate() {
            let Some(left) = row.left.as_mut().filter(|_| at != taken && !is_own(at)) else {
                continue;
            };
            let follows = left.verdict != FitVerdict::DoesNotFit;
            left.as_good = follows && (left.bic - best.bic) / spread < VERY_STRONG;
        }
    }
    tried[taken].taken = true;
    let bic = |row: &TriedModel| row.left.as_ref().map_or(f64::INFINITY, |left| left.bic);
    tried.sort_by(|a, b| b.taken.cmp(&a.taken).then(bic(a).total_cmp(&bic(b))));
    (taken, tried)
}

impl Fit {
    /// The same fit, taken among models that were tried ([`simplest`]).
    #[must_use]
    pub fn among(mut self, tried: Vec<TriedModel>) -> Self {
        self.tried = tried;
        self.verdicts.splice(0..0, words::not_told_apart(&self));
        self
    }

    /// The same fit of a curve in arbitrary units whose height was set to this shortening, %.
    #[must_use]
    pub fn with_peak(mut self, shortening_pct: Option<f64>) -> Self {
        self.verdicts.extend(shortening_pct.map(words::of_peak));
        self
    }
}

/// The frames that every fit used, and their noise.
struct Common {
    /// Times of each curve, ms.
    times: Vec<Vec<f64>>,
    /// A part of the range of the measured curve, which a fit may have in another unit.
    noise: Vec<f64>,
}

impl Common {
    fn of(fits: &[&Fit]) -> Self {
        let curves = fits.iter().map(|fit| fit.curves.len()).min().unwrap_or(0);
        let used = |fit: &Fit, number: usize| -> Vec<f64> {
            let curve = &fit.curves[number];
            let used = curve.times_ms.iter().zip(&curve.used).filter(|(_, used)| **used);
            used.map(|(time, _)| *time).collect()
        };
        let shared = |number: usize| {
            let mut times = used(fits[0], number);
            for fit in &fits[1..] {
                let others = used(fit, number);
                times.retain(|time| others.binary_search_by(|it| it.total_cmp(time)).is_ok());
            }
            times
        };
        let times: Vec<Vec<f64>> = (0..curves).map(shared).collect();
        let noise = |number: usize| {
            let curves = fits.iter().map(|fit| &fit.curves[number]);
            let part = curves.map(|curve| curve.noise / range(curve, &times[number]));
            part.fold(f64::INFINITY, f64::min)
        };
        Self { noise: (0..curves).map(noise).collect(), times }
    }

    fn left(&self, fit: &Fit) -> Left {
        let mut chi_squared = 0.0;
        for ((curve, times), noise) in fit.curves.iter().zip(&self.times).zip(&self.noise) {
            let (mut shared, noise) = (times.iter().peekable(), noise * range(curve, times));
            for (at, time) in curve.times_ms.iter().enumerate() {
                if shared.next_if_eq(&time).is_some() {
                    chi_squared += ((curve.measured[at] - curve.fitted[at]) / noise).powi(2);
                }
            }
        }
        let frames: usize = self.times.iter().map(Vec::len).sum();
        let worst =
            |of: &dyn Fn(&FittedCurve) -> f64| fit.curves.iter().map(of).fold(0.0, f64::max);
        Left {
            verdict: fit.verdict,
            numbers: fit.numbers,
            chi_squared,
            frames,
            bic: chi_squared + fit.numbers as f64 * (frames.max(1) as f64).ln(),
            misfit_pct: worst(&|curve| 100.0 * curve.misfit / curve.height()),
            frames_together: worst(&|curve| curve.frames_together),
            as_good: false,
        }
    }
}

/// From the least to the greatest measured value at some of its times.
fn range(curve: &FittedCurve, times: &[f64]) -> f64 {
    let mut shared = times.iter().peekable();
    let frames = curve.times_ms.iter().zip(&curve.measured);
    let values = frames.filter(|(time, _)| shared.next_if_eq(time).is_some());
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], (_, value)| {
        [low.min(*value), high.max(*value)]
    });
    high - low
}
