//! How far a run has come, and what its parts take.

use super::record::Timings;
use crate::interrupt;
use crate::print::progress_bar;
use indicatif::ProgressBar;
use myospring::simulation::{Observer, Outcome, Part, Progress, Ready};
use std::time::Instant;

/// Runs with a progress bar where there is a terminal to show it, and measures what the parts take.
pub(super) fn beat(prepared: &Ready, quiet: bool, timings: &mut Timings) -> Outcome {
    let mut watch = Watch { bar: progress_bar(quiet), timings, at: None };
    let outcome = prepared.run_observed(&mut watch);
    watch.turn(None);
    watch.bar.finish_and_clear();
    outcome
}

/// Shows how far a run has come and adds up what its parts take.
struct Watch<'a> {
    bar: ProgressBar,
    timings: &'a mut Timings,
    /// What the run is at, and since when.
    at: Option<(Part, Instant)>,
}

impl Watch<'_> {
    fn turn(&mut self, next: Option<Part>) {
        let now = Instant::now();
        if let Some((part, since)) = self.at {
            let total = match part {
                Part::Cell => &mut self.timings.cell_s,
                Part::Mechanics => &mut self.timings.mechanics_s,
                Part::Recording => &mut self.timings.recording_s,
            };
            *total += (now - since).as_secs_f64();
        }
        self.at = next.map(|part| (part, now));
    }
}

impl Observer for Watch<'_> {
    fn sample(&mut self, Progress { time, duration }: Progress) -> bool {
        self.bar.set_length(duration as u64);
        self.bar.set_position(time as u64);
        !interrupt::asked()
    }

    fn begins(&mut self, part: Part) {
        self.turn(Some(part));
    }
}
