//! A cell's own parameters from its measured curve, and how sure they are.
//!
//! A curve of one free cell tells little: how far it shortens, which is tension over stiffness, and how fast. So that is
//! what is sought ([`Unknown`]), with a delay and the length at rest; stiffness itself shows under a known load alone
//! (several curves in one fit), and whatever a curve does not tell is said to be so.
//!
//! The method is Levenberg's and Marquardt's (`more_1978`) within bounds, from several starts, since thresholds in the
//! tension equations make local minima. Residuals are taken over the noise that the cell at rest shows; single bad frames
//! are left out. How sure an answer is says the profile of its likelihood (`raue_2009`): one number is held, all others
//! are sought anew, until chi squared has risen by 3.84 times the variance of what is left (few frames: by the square of
//! Student's quantile). Profiles go out and come back, also from where other starts ended, and take the lower way; one
//! that goes below the answer makes it the answer.
//!
//! Intervals are of a model that follows its curve. Where the residuals have structure, fewer frames count as independent
//! of each other, which widens them; where the structure is large ([`FitVerdict::DoesNotFit`]) there are none.
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
mod least_squares;
mod likelihood;
mod misfit;
mod observed;
mod problem;
mod repeat;
mod settings;
mod slopes;
mod stretch_dependent;
mod sure;
mod table;
mod unknown;
mod words;
mod work;

pub use answer::{Estimate, Fit, FitVerdict, FittedCurve, Verdict};
pub use choice::of_each_cell;
pub use error::FitError;
pub use fitter::{Fitter, Loaded};
pub use observed::{Observed, Scale, Stimuli};
pub use settings::{FitSettings, Sought};
pub use unknown::Unknown;
