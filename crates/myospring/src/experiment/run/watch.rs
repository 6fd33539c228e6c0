//! How far a run has come, and what its parts take.

use super::record::Timings;
use crate::experiment::Observer;
use crate::interruption::Interruption;
use crate::simulation::{self, Outcome, Progress, Ready, RunPart};
use std::time::Instant;

/// Runs, tells how far it has come, and measures what the parts take.
pub(super) fn beat(
    ready: &Ready,
    duration: f64,
    observer: &dyn Observer,
    timings: &mut Timings,
) -> Outcome {
    observer.stage("ms", duration as u64);
    let interruption = observer.interruption();
    let mut watch = Watch { observer, interruption, timings, at: None };
    let outcome = ready.run_observed(&mut watch);
    watch.turn(None);
    outcome
}

/// Tells how far a run has come and adds up what its parts take.
struct Watch<'a> {
    observer: &'a dyn Observer,
    interruption: Interruption,
    timings: &'a mut Timings,
    /// What the run is at, and since when.
    at: Option<(RunPart, Instant)>,
}

impl Watch<'_> {
    fn turn(&mut self, next: Option<RunPart>) {
        let now = Instant::now();
        if let Some((part, since)) = self.at {
            let total = match part {
                RunPart::Cell => &mut self.timings.cell_s,
                RunPart::Mechanics => &mut self.timings.mechanics_s,
                RunPart::Recording => &mut self.timings.recording_s,
            };
            *total += (now - since).as_secs_f64();
        }
        self.at = next.map(|part| (part, now));
    }
}

impl simulation::RunObserver for Watch<'_> {
    fn sample(&mut self, Progress { time, .. }: Progress) -> bool {
        self.observer.reached(time as u64);
        !self.interruption.is_asked()
    }

    fn begins(&mut self, part: RunPart) {
        self.turn(Some(part));
    }
}
