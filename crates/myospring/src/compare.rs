//! Runs beside each other: what makes them differ, in what settings they do, and in which numbers.
//!
//! - [`factor`]: `peak_tension=0.7,tau_si=1.2`, factors on any number of a run.
//! - [`dose`]: drugs, whose effect on such numbers follows the Hill equation: a control and a series of doses.
//! - [`setting`]: the keys in which runs differ, and which of these make them hard to compare.
//! - [`metric`]: the numbers of each run, and their differences from those of the first.
//!
//! The parameters of the minimal models are phenomenological: `tau_si` shapes a current that stands for several
//! channels. A factor on one is not the block of a channel, whatever the name of the drug; one on a conductance of
//! ToR-ORd is.

pub mod dose;
pub mod factor;
pub mod metric;
pub mod setting;

/// What every comparison that scales parameters of the minimal models has to say.
pub const PHENOMENOLOGICAL: &str = "parameters of these cell models are phenomenological: they shape currents and tension \
     as a whole and stand for no single channel, so a factor on one is not the block of a channel";
