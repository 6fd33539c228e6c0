//! What a fit says.

use super::observed::Scale;
use super::unknown::Unknown;
use serde::Serialize;

/// A fit of one cell to its curves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fit {
    /// Whether the cell follows its curves: read it before any number.
    pub verdict: FitVerdict,
    /// What was sought of the cell, then delays and levels.
    pub estimates: Vec<Estimate>,
    /// Correlations of the estimates, in their order; `None` where one of them has no curvature, or where the fit says
    /// nothing of the cell.
    pub correlations: Option<Vec<Vec<f64>>>,
    /// Pairs whose estimates cannot be told apart, with their correlation: those beyond 0.95 either way.
    pub correlated: Vec<(String, String, f64)>,
    /// Each curve with the fitted one.
    pub curves: Vec<FittedCurve>,
    /// What a reader must know, in order of weight.
    pub verdicts: Vec<String>,
    /// Starts that came to the same answer, of how many.
    pub agreeing_starts: [usize; 2],
    /// Of each start that came to an answer: the root mean square of its residuals over the noise.
    pub starts: Vec<f64>,
    /// Sum of squared residuals over squared noise, by degree of freedom: about 1 where the cell can follow the curve.
    pub reduced_chi_squared: f64,
    /// The variance that intervals count with, over that of the residuals: 1 where these look like noise. Of a misfit,
    /// neighbouring frames tell the same, and the numbers that were sought have taken up a part.
    pub variance_factor: f64,
    /// Rise of chi squared, over [`Fit::reduced_chi_squared`] and [`Fit::variance_factor`], at the ends of the
    /// intervals: 3.84 of many frames, somewhat more of few, since they tell the noise as well.
    pub rise_at_ends: f64,
    /// Beats of a train before the first that was recorded, as the curve has it: 0 of one that begins from rest.
    pub beats_before: usize,
    /// Curves that were computed for it.
    pub evaluations: usize,
}

/// One number that was sought.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Its name.
    pub name: String,
    /// Which it is of the cell's; `None` of a delay or a level.
    #[serde(skip)]
    pub unknown: Option<Unknown>,
    /// Its unit.
    pub unit: String,
    /// The most likely value.
    pub value: f64,
    /// Ends of the 95 % interval by profile likelihood; `None` where the curve sets no end, and of a fit that does not
    /// fit.
    pub interval: [Option<f64>; 2],
    /// Standard deviation from the curvature at the most likely value (Fisher's information), in its unit; `None`
    /// where that has none.
    pub standard_deviation: Option<f64>,
    /// Bounds between which it was sought.
    pub bounds: [f64; 2],
    /// Value and rise of chi squared above its least, as [`Fit::rise_at_ends`] counts it, for values around the answer;
    /// empty of a fit that does not fit.
    pub profile: Vec<[f64; 2]>,
    /// What its profile says.
    pub verdict: Verdict,
}

/// What a curve says of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The interval has both ends.
    Determined,
    /// Only a lower end: larger values follow the curve as well.
    AtLeast,
    /// Only an upper end.
    AtMost,
    /// Every value within the bounds follows the curve.
    NotDetermined,
    /// The most likely value is the lower bound.
    AtLowerBound,
    /// The most likely value is the upper bound.
    AtUpperBound,
    /// The model does not fit, so its value says nothing of the cell.
    DoesNotFit,
}

/// Whether a cell follows its curves: how large the structure in the residuals is, whatever noise is on top of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FitVerdict {
    /// Residuals look like noise, or their structure is below a thousandth of the curve's variance: about 1 % of the
    /// height of a beat.
    Fits,
    /// The structure is larger; the intervals count it.
    FitsNearly,
    /// The structure leaves more than 1 % of the curve's variance unexplained, about 3 % of the height of a beat: numbers
    /// of such a fit are not the cell's, and no interval is stated.
    DoesNotFit,
}

/// Parts of the curve's variance from which on a misfit is more than the one, or the other.
const SMALL: f64 = 1e-3;
const LARGE: f64 = 0.01;

impl FitVerdict {
    /// Of a misfit that leaves this part of the curve's variance unexplained.
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

/// A curve and what the fitted cell makes of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedCurve {
    /// What it is called.
    pub name: String,
    /// What its values say.
    pub scale: Scale,
    /// Their unit.
    pub unit: String,
    /// Times of the frames with a value, ms.
    pub times_ms: Vec<f64>,
    /// What was measured.
    pub measured: Vec<f64>,
    /// What the fitted cell does.
    pub fitted: Vec<f64>,
    /// Whether each frame counted; the others are single bad frames.
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
    /// Frames that count as one, since their misfit is the same: 1 where the residuals look like noise.
    pub frames_together: f64,
    /// Part of the curve's variance that this structure leaves unexplained.
    pub unexplained: f64,
}

impl Estimate {
    /// Whether the likelihood is near enough to a parabola that the standard deviation says what the interval says: its
    /// ends lie within a factor of 2 of where that would put them.
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

    /// The verdict of the worst curve; of a model that does not fit no number says how sure it is.
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
    /// Whether the cell follows this curve.
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
