//! Stimuli that raised no action potential, and alternans.

use super::Outcome;
use crate::analysis::beats::Beats;
use crate::analysis::value;

/// Warnings about the rhythm.
pub(super) fn rhythm(outcome: &Outcome) -> Vec<String> {
    let beats = outcome.beats();
    [missed(&beats), beats.rhythm.alternans.clone(), missed_s2(&beats)]
        .into_iter()
        .flatten()
        .collect()
}

fn missed(beats: &Beats) -> Option<String> {
    let missed = beats.rhythm.missed()?;
    if beats.counted().next().is_none() {
        return Some(format!(
            "{missed}, so there is no beat and no number of one; make the stimulus stronger or longer"
        ));
    }
    let ratio = beats.rhythm.capture_ratio.as_ref();
    let ratio = ratio.map_or_else(String::new, |ratio| format!(" ({ratio})"));
    let mend = if beats.rhythm.not_captured[0] == 1 {
        "make the stimulus stronger or longer"
    } else {
        "make the cycle length longer to capture all"
    };
    Some(format!("{missed}{ratio}; they have no numbers and count in no mean; {mend}"))
}

fn missed_s2(beats: &Beats) -> Option<String> {
    let beat = beats.s2().filter(|beat| beat.is_missed())?;
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
