//! Progress of a run, and the time of its parts.

use super::record::Timings;
use crate::clock::Stopwatch;
use crate::experiment::Observer;
use crate::interruption::Interruption;
use crate::simulation::{self, Outcome, Progress, Ready, RunPart};

/// Runs the simulation, reports progress, and measures the time of its parts.
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

/// Reports the progress of a run and adds up the time of its parts.
struct Watch<'a> {
    observer: &'a dyn Observer,
    interruption: Interruption,
    timings: &'a mut Timings,
    /// The current part, and when it began.
    at: Option<(RunPart, Stopwatch)>,
}

impl Watch<'_> {
    fn turn(&mut self, next: Option<RunPart>) {
        if let Some((part, since)) = self.at {
            let total = match part {
                RunPart::Cell => &mut self.timings.cell_s,
                RunPart::Mechanics => &mut self.timings.mechanics_s,
                RunPart::Recording => &mut self.timings.recording_s,
            };
            *total += since.elapsed().as_secs_f64();
        }
        self.at = next.map(|part| (part, Stopwatch::start()));
    }
}

impl simulation::RunObserver for Watch<'_> {
    fn sample(&mut self, Progress { time, .. }: Progress) -> bool {
        self.observer.reached(time as u64);
        !self.interruption.is_requested()
    }

    fn begins(&mut self, part: RunPart) {
        self.turn(Some(part));
    }
}
