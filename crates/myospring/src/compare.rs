//! Comparison of runs: by factors and doses, and by their settings and metrics.
//!
//! - [`factor`]: factors on any number of a run, such as `peak_tension=0.7,tau_si=1.2`.
//! - [`dose`]: a control and a series of doses of drugs, whose effect on such numbers follows the
//!   Hill equation.
//! - [`setting`]: the settings in which runs differ, with warnings for those that make a comparison
//!   difficult.
//! - [`metric`]: the metrics of each run, and their differences from those of the first.
//!
//! The parameters of the minimal models are phenomenological: `tau_si` shapes a current that
//! represents several channels. A factor on such a parameter is not the block of a channel,
//! whatever the name of the drug; a factor on a conductance of ToR-ORd is.

pub mod dose;
pub mod factor;
pub mod metric;
pub mod setting;

/// Warning of every comparison that scales parameters of the minimal models.
pub const PHENOMENOLOGICAL: &str = "parameters of these cell models are phenomenological: they shape currents and tension \
     as a whole and represent no single channel, so a factor on one is not the block of a channel";
