//! The beats of curves and tensions.

use crate::analysis::curve::{Analysis, CurveError, CurveOptions, analyse};
use crate::analysis::kind::Kind;
use crate::fit::observed::Stimuli;

/// The beats of a curve, by its stimuli where they are known.
pub(super) fn analysis(
    times: &[f64],
    values: &[f64],
    kind: Kind,
    stimuli: &Stimuli,
) -> Result<Analysis, CurveError> {
    let stimuli_ms = match stimuli {
        Stimuli::Given(times) => times.clone(),
        Stimuli::Seen(_) | Stimuli::Clocked { .. } => Vec::new(),
    };
    let unit = if kind == Kind::Tension { "kPa" } else { "a.u." };
    analyse(times, values, kind, unit, &CurveOptions { stimuli_ms, ..CurveOptions::default() })
}
