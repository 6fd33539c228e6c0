//! An extra stimulus that raised no action potential.

use super::Outcome;
use crate::analysis::value;

/// That an S2 was missed, if it was.
pub(super) fn not_captured(outcome: &Outcome) -> Option<String> {
    let beats = outcome.beats();
    let beat = beats.s2().filter(|beat| beat.captured == Some(false))?;
    let interval = value(&beat.s2, "coupling_interval")?;
    let when = match value(&beat.s2, "diastolic_interval") {
        Some(diastolic) => format!("{diastolic:.0} ms after its 90 % repolarisation"),
        None => "before its 90 % repolarisation".to_owned(),
    };
    Some(format!(
        "no capture: S2, {interval} ms after the last S1 and {when}, raised no action potential, so its beat has no \
         numbers; make the S2 interval longer"
    ))
}
