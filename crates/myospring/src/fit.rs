//! A cell's own parameters from its measured curve, and how sure they are.
//!
//! The curve of a free cell determines little: how far the cell shortens, which is tension over
//! stiffness, and how fast. So these numbers are fitted ([`Unknown`]), with a delay and the length
//! at rest. The stiffness itself is determined only under a known load (several curves in one fit).
//! A number that the curve does not determine gets the verdict [`Verdict::NotDetermined`].
//!
//! The method is Levenberg's and Marquardt's (`more_1978`) within bounds, from several starts,
//! since thresholds in the tension equations make local minima. Residuals are taken over the noise
//! that the cell at rest shows; single bad frames are left out. Intervals come from the profile of
//! the likelihood (`raue_2009`): one number is fixed and all others are fitted again, until chi
//! squared has risen by 3.84 times the variance of the residuals (for few frames by the square of
//! Student's quantile). Profiles run outwards and back, also from the ends of other starts, and
//! keep the lower value; if one finds a lower chi squared than the answer, that becomes the answer.
//!
//! Intervals are valid only for a model that fits its curve. Where the residuals have structure,
//! fewer frames count as independent of each other, which widens them; where the structure is large
//! ([`FitVerdict::DoesNotFit`]) there are none.
//!
//! # Example
//! ```
//! use myospring::fit::{Fitter, Observed, Scale, FitSettings, Stimuli};
//! use myospring::run_file::RunFile;
//!
//! let run = RunFile::default().resolve()?;
//! let fitter = Fitter::of(&run, |path| std::fs::read(path))?;
//! // A curve that the cell itself makes, 250 frames a second.
//! let times_ms: Vec<f64> = (0..150).map(|frame| 4.0 * f64::from(frame)).collect();
//! let values = fitter.curve(&[("tension_over_stiffness", 0.8), ("c_0", 1.1)], 100.0, &times_ms)?;
//! let stimuli = Stimuli::Given(vec![50.0]);
//! let observed = Observed { name: "cell".into(), times_ms, values, scale: Scale::Length, unit: "um".into(), stimuli };
//! let fit = fitter.fit(&[observed], &FitSettings::default(), &|_done| true)?.ok_or("it was stopped")?;
//! let tension = fit.estimate("tension_over_stiffness").ok_or("it was sought")?;
//! assert!((tension.value / (0.8 * fitter.tension_over_stiffness()) - 1.0).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod answer;
mod choice;
mod contraction;
mod error;
mod fitter;
mod forecast;
mod inverse;
mod least_squares;
mod likelihood;
mod misfit;
mod observed;
mod own_tension;
mod problem;
mod repeat;
mod reported;
mod settings;
mod simplest;
mod slopes;
mod stretch_dependent;
mod support_load;
mod sure;
mod table;
mod unknown;
mod words;
mod work;

pub use answer::{
    Estimate, Fit, FitVerdict, FittedCurve, Left, RecordedCourse, TriedModel, Verdict,
};
pub use choice::of_each_cell;
pub use error::FitError;
pub use fitter::{Fitter, Loaded};
pub use observed::{Observed, Scale, Stimuli};
pub use own_tension::{FILE as TENSION_FILE, MeanBeat, OwnTension, TensionMetric};
pub use settings::{FitOptions, FitSettings};
pub use simplest::simplest;
pub use unknown::Unknown;
pub(crate) use words::OF_OWN_TENSION;
