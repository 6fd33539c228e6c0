//! The result of a fit.

use super::observed::Scale;
use super::own_tension::OwnTension;
use super::unknown::Unknown;
use serde::Serialize;

/// A fit of one cell to its curves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fit {
    /// Name of the cell model.
    pub model: String,
    /// Whether the model fits the curves: read it before any number.
    pub verdict: FitVerdict,
    /// The fitted numbers of the cell, then delays and levels.
    pub estimates: Vec<Estimate>,
    /// Correlations of the estimates, in their order; `None` where one of them has no curvature, or
    /// where the model does not fit.
    pub correlations: Option<Vec<Vec<f64>>>,
    /// Pairs of estimates that the curve can hardly distinguish, with their correlation: above 0.95
    /// or below -0.95.
    pub correlated: Vec<(String, String, f64)>,
    /// Each curve with the fitted one.
    pub curves: Vec<FittedCurve>,
    /// What a reader must know, in order of weight.
    pub verdicts: Vec<String>,
    /// The number of starts that reached this answer, and the number of all starts.
    pub agreeing_starts: [usize; 2],
    /// For each start that reached an answer: the root mean square of its residuals over the noise.
    pub starts: Vec<f64>,
    /// Sum of squared residuals over squared noise, by degree of freedom: about 1 where the model
    /// fits.
    pub reduced_chi_squared: f64,
    /// The variance that intervals use, over that of the residuals: 1 where residuals look like
    /// noise. With a misfit it is larger, since residuals of neighbouring frames are correlated and
    /// the fitted numbers have absorbed a part of the misfit.
    pub variance_factor: f64,
    /// Rise of chi squared, in units of [`Fit::reduced_chi_squared`] times
    /// [`Fit::variance_factor`], at the ends of the intervals: 3.84 for many frames, somewhat more
    /// for few, from which the noise is estimated, too.
    pub rise_at_ends: f64,
    /// Beats of the train before the first recorded one, determined from the curve: 0 if the train
    /// begins from rest.
    pub beats_before: usize,
    /// The number of fitted numbers, delays of single beats included; for the curve's own tension one for each frame.
    pub numbers: usize,
    /// The number of curves that were computed.
    pub evaluations: usize,
    /// The tension that the curve asks for, where that was sought.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub own_tension: Option<OwnTension>,
    /// What each cell model leaves of the curve, the one that was taken first; empty where only one was asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tried: Vec<TriedModel>,
    /// The calcium that was recorded together with the curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calcium: Option<RecordedCourse>,
}

/// Calcium that was recorded together with a curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordedCourse {
    /// Whether it drives the model; otherwise it is shown beside the curve.
    pub drives: bool,
    /// Times on the clock of the curve, ms.
    pub times_ms: Vec<f64>,
    /// Calcium, uM.
    pub calcium_um: Vec<f64>,
}

impl RecordedCourse {
    /// The file of a fit's results that has it; time counts from its first sample.
    pub const FILE: &str = "calcium.csv";
}

/// What a cell model leaves of a curve, or why it was not fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TriedModel {
    /// Its name.
    pub model: String,
    /// Whether the fit is of this model.
    pub taken: bool,
    /// What it leaves; `None` if it was not fitted.
    #[serde(flatten)]
    pub left: Option<Left>,
    /// Why it was not fitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// What a model leaves of a curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Left {
    /// Whether it follows the curve.
    pub verdict: FitVerdict,
    /// Number of fitted numbers; for the curve's own tension one for each frame.
    pub numbers: usize,
    /// Squared residuals over squared noise, summed over the frames that every model used.
    pub chi_squared: f64,
    /// Number of these frames.
    pub frames: usize,
    /// Bayesian information criterion.
    pub bic: f64,
    /// Structure in the residuals, root mean square, % of the height of a beat; 0 if they look like noise.
    pub misfit_pct: f64,
    /// Neighbouring frames that count as one, since their residuals are correlated; 1 if they look like noise.
    pub frames_together: f64,
    /// Whether the curve does not tell it from the model that was taken.
    pub as_good: bool,
}

/// One fitted number.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Its name.
    pub name: String,
    /// Which number of the cell it is; `None` for a delay or a level.
    #[serde(skip)]
    pub unknown: Option<Unknown>,
    /// Its unit.
    pub unit: String,
    /// The most likely value.
    pub value: f64,
    /// Ends of the 95 % interval by profile likelihood; `None` where the curve sets no end, and if
    /// the model does not fit.
    pub interval: [Option<f64>; 2],
    /// Standard deviation from the curvature at the most likely value (Fisher's information), in
    /// its unit; `None` without curvature.
    pub standard_deviation: Option<f64>,
    /// Bounds of the fit.
    pub bounds: [f64; 2],
    /// Value and rise of chi squared above its minimum, in the units of [`Fit::rise_at_ends`], for
    /// values around the answer; empty if the model does not fit.
    pub profile: Vec<[f64; 2]>,
    /// The verdict from its profile.
    pub verdict: Verdict,
}

/// What a curve determines about a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The interval has both ends.
    Determined,
    /// Only a lower end: larger values fit the curve as well.
    AtLeast,
    /// Only an upper end.
    AtMost,
    /// Every value within the bounds fits the curve as well.
    NotDetermined,
    /// The most likely value is the lower bound.
    AtLowerBound,
    /// The most likely value is the upper bound.
    AtUpperBound,
    /// The model does not fit, so its value is not that of the cell.
    DoesNotFit,
}

/// Whether the model fits the curves: how large the structure in the residuals is, whatever the
/// noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FitVerdict {
    /// Residuals look like noise, or their structure is below a thousandth of the curve's variance: about 1 % of the
    /// height of a beat.
    Fits,
    /// The structure is larger; the intervals include it.
    FitsNearly,
    /// The structure leaves more than 1 % of the curve's variance unexplained, about 3 % of the
    /// height of a beat: such numbers are not those of the cell, and have no intervals.
    DoesNotFit,
}

/// The largest unexplained part of the curve's variance of a fit that fits, and of one that fits
/// nearly.
const SMALL: f64 = 1e-3;
const LARGE: f64 = 0.01;

impl FitVerdict {
    /// The verdict for this unexplained part of the curve's variance.
    pub(super) fn of(unexplained: f64) -> Self {
        match unexplained {
            ..SMALL => Self::Fits,
            SMALL..LARGE => Self::FitsNearly,
            _ => Self::DoesNotFit,
        }
    }

    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Fits => "fits",
            Self::FitsNearly => "fits nearly: the intervals count the misfit",
            Self::DoesNotFit => "does not fit",
        }
    }

    /// Its word in files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Fits => "fits",
            Self::FitsNearly => "fits-nearly",
            Self::DoesNotFit => "does-not-fit",
        }
    }
}

impl Verdict {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Determined => "determined",
            Self::AtLeast => "at least; larger values follow this curve as well",
            Self::AtMost => "at most; smaller values follow this curve as well",
            Self::NotDetermined => "not determined by this curve",
            Self::AtLowerBound => "at its lower bound",
            Self::AtUpperBound => "at its upper bound",
            Self::DoesNotFit => "no interval: the model does not fit",
        }
    }
}

/// A measured curve and the fitted one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedCurve {
    /// What it is called.
    pub name: String,
    /// The quantity that its values measure.
    pub scale: Scale,
    /// Their unit.
    pub unit: String,
    /// Times of the frames with a value, ms.
    pub times_ms: Vec<f64>,
    /// Measured values.
    pub measured: Vec<f64>,
    /// Fitted values.
    pub fitted: Vec<f64>,
    /// Whether each frame was used; the others are single bad frames.
    pub used: Vec<bool>,
    /// Stretches that were left out, such as artefacts: their first and last frame, ms.
    pub left_out_ms: Vec<[f64; 2]>,
    /// Stimuli with the fitted delays, ms.
    pub stimuli_ms: Vec<f64>,
    /// Standard deviation of the noise, from the cell at rest, in the curve's unit.
    pub noise: f64,
    /// Root mean square of the residuals of the frames that counted, in the curve's unit.
    pub residual: f64,
    /// Root mean square of the structure in the residuals, in the curve's unit: 0 where they look like noise.
    pub misfit: f64,
    /// Frames that count as one, since their residuals are correlated: 1 where these look like
    /// noise.
    pub frames_together: f64,
    /// Part of the curve's variance that this structure leaves unexplained.
    pub unexplained: f64,
}

impl Estimate {
    /// Whether the likelihood is close enough to a parabola that standard deviation and interval
    /// agree: the ends of the interval lie within a factor of 2 of those of a parabola.
    pub fn is_parabolic(&self) -> bool {
        let Some(deviation) = self.standard_deviation else { return false };
        let near =
            |end: f64| (0.5..2.0).contains(&((end - self.value).abs() / (NORMAL * deviation)));
        self.interval.iter().all(|end| end.is_some_and(near))
    }
}

/// Standard deviations from the middle of a 95 % interval to its ends.
const NORMAL: f64 = 1.96;

impl Fit {
    /// The estimate of a name.
    pub fn estimate(&self, name: &str) -> Option<&Estimate> {
        self.estimates.iter().find(|estimate| estimate.name == name)
    }

    /// Sets the verdict to that of the worst curve; if the model does not fit, removes intervals
    /// and correlations.
    pub(super) fn judge(&mut self) {
        self.verdict =
            self.curves.iter().map(FittedCurve::verdict).max().unwrap_or(FitVerdict::Fits);
        if self.verdict < FitVerdict::DoesNotFit {
            return;
        }
        self.correlations = None;
        self.correlated.clear();
        for estimate in &mut self.estimates {
            estimate.interval = [None; 2];
            estimate.standard_deviation = None;
            estimate.profile.clear();
            if !matches!(estimate.verdict, Verdict::AtLowerBound | Verdict::AtUpperBound) {
                estimate.verdict = Verdict::DoesNotFit;
            }
        }
    }

    /// The correlation of two estimates.
    pub fn correlation(&self, one: &str, other: &str) -> Option<f64> {
        let place = |name: &str| self.estimates.iter().position(|estimate| estimate.name == name);
        Some(self.correlations.as_ref()?[place(one)?][place(other)?])
    }
}

impl FittedCurve {
    /// Whether the model fits this curve.
    pub fn verdict(&self) -> FitVerdict {
        FitVerdict::of(self.unexplained)
    }

    /// From the least to the greatest value of the fitted curve.
    pub fn height(&self) -> f64 {
        let [low, high] = self
            .fitted
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(*v), high.max(*v)]);
        high - low
    }
}
