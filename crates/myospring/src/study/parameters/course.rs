//! The beats of a cell without a mesh, read from its samples as in a run.

use super::cell_metrics::{Timed, unit};
use super::description::CountedBeat;
use crate::analysis::beats::Beats;
use crate::cell::CellModel;
use crate::cell::batch::CellSample;
use crate::cell::pacing::Protocol;
use crate::recording::{CALCIUM, Recording, Sample, Signal};

/// The beats of samples whose tension is in kPa.
pub(super) fn beats(model: &dyn CellModel, protocol: &Protocol, timed: &[Timed]) -> Beats {
    let in_mv = unit(model) == "mV";
    let sample = |(t_ms, it): &Timed| {
        let vm_mv = it.potential.filter(|_| in_mv);
        Sample { t_ms: *t_ms, u: it.potential, vm_mv, ta_kpa: it.tension, ..Sample::STILL }
    };
    let read: fn(&Timed) -> Option<f64> = |(_, CellSample { calcium_um, .. })| *calcium_um;
    let signal = |values| Signal { name: CALCIUM.into(), unit: "uM".into(), values };
    let calcium: Option<Vec<f64>> = timed.iter().map(read).collect();
    let recording = Recording {
        samples: timed.iter().map(sample).collect(),
        signals: calcium.map(signal).into_iter().collect(),
        ..Recording::default()
    };
    // A beat of which there is more than its rest.
    let last = timed.last().map_or(f64::NEG_INFINITY, |(t_ms, _)| *t_ms);
    let stimuli: Vec<f64> = protocol.stimulus_times().take_while(|time| *time <= last).collect();
    Beats::of(&recording, &stimuli, protocol.s2_ms().filter(|time| *time <= last))
}

/// The metrics of these names of the beat that counts, or their means over the beats of the train.
pub(super) fn metrics(beats: &Beats, which: CountedBeat, names: &[String]) -> Vec<Option<f64>> {
    let of = |name: &String| match which {
        CountedBeat::First => beats.first()?.value(name),
        CountedBeat::Last => beats.last()?.value(name),
        CountedBeat::Mean => {
            let train = beats.iter().filter(|beat| !beat.is_s2());
            let values: Vec<f64> = train.filter_map(|beat| beat.value(name)).collect();
            (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
        }
    };
    names.iter().map(of).collect()
}

/// Which stimuli raised no action potential, if any.
pub(super) fn no_capture(beats: &Beats) -> Option<String> {
    beats.rhythm.no_capture(beats.s2().and_then(|beat| beat.captured))
}
