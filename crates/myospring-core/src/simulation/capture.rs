//! Stimuli that raised no action potential, and alternans.

use super::Outcome;
use crate::analysis::beats::Beats;
use crate::analysis::spontaneous::SpontaneousRhythm;
use crate::analysis::value;
use std::fmt::Write as _;

/// Warnings about the rhythm.
pub(super) fn rhythm(outcome: &Outcome) -> Vec<String> {
    let beats = outcome.beats();
    if let Some(own) = &beats.rhythm.spontaneous {
        return [Some(by_itself(own)), beats.rhythm.alternans.clone()]
            .into_iter()
            .flatten()
            .collect();
    }
    [missed(&beats), beats.rhythm.alternans.clone(), missed_s2(&beats)]
        .into_iter()
        .flatten()
        .collect()
}

/// What a cell that beats by itself does, and whether the pacing captures it.
fn by_itself(own: &SpontaneousRhythm) -> String {
    let SpontaneousRhythm { action_potentials, raised_by_stimuli, stimuli, unit, .. } = *own;
    let mut text = match own.cycle_length_ms {
        Some(cycle_ms) => format!("the cell beats by itself every {cycle_ms:.0} ms"),
        None => "the cell beats by itself".to_owned(),
    };
    if let Some(lowest) = own.maximum_diastolic_potential {
        let _ = write!(text, ", with a maximum diastolic potential of {lowest:.1} {unit}");
    }
    text.push_str("; each beat counts from its stimulus, or from its upstroke if it has none");
    let alone = action_potentials - raised_by_stimuli;
    if stimuli > 0 && raised_by_stimuli == stimuli {
        let _ = write!(
            text,
            ". Each of {stimuli} stimuli raised an action potential; {alone} further ones came without a stimulus"
        );
    } else if stimuli > 0 {
        let _ = write!(
            text,
            ". The pacing does not capture: {raised_by_stimuli} of {stimuli} stimuli raised an action potential, and {alone} \
             of {action_potentials} action potentials came without a stimulus; pace with a shorter cycle length than the cell's own, \
             or make the stimulus stronger"
        );
    }
    text
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
