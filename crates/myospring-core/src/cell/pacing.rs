//! Pacing: when and how a cell is stimulated.
//!
//! Events are half-open in time: a pulse `[start, start + duration)` acts at its start and no
//! longer at its end, and the state at the time of a jump is the state after it.

/// Whether two times, ms, differ by rounding only.
pub(super) fn same_instant(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * a.abs().max(b.abs())
}

/// One stimulus.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stimulus {
    /// The potential variable jumps at once.
    Jump {
        /// Size of the jump, in units of the potential variable.
        amplitude: f64,
    },
    /// A constant current for a while.
    Pulse {
        /// The current, in the unit that the cell model states; 1/ms for a dimensionless potential.
        amplitude: f64,
        /// How long, ms.
        duration_ms: f64,
    },
}

/// A train of equal stimuli.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Protocol {
    /// What happens at each beat.
    pub stimulus: Stimulus,
    /// Time of the first stimulus, ms.
    pub start_ms: f64,
    /// Time from one stimulus to the next, ms; without meaning if there is one beat.
    pub cycle_length_ms: f64,
    /// Number of stimuli; none leaves the cell at rest.
    pub beats: u32,
}

/// Something that happens to the cell at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event {
    /// The potential variable jumps by this much.
    Jump(f64),
    /// This current acts from now on, in the unit that the cell model states.
    CurrentOn(f64),
    /// No current acts from now on.
    CurrentOff,
}

/// Why a protocol cannot be followed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ProtocolError {
    /// NaN or infinity.
    #[error("{field} = {value} is not a finite number")]
    NotFinite {
        /// The field of the protocol.
        field: &'static str,
        /// Its value.
        value: f64,
    },
    /// The first stimulus lies before the start of the simulation.
    #[error("the first stimulus at {start_ms} ms lies before the start at 0 ms")]
    StartsBeforeZero {
        /// Time of the first stimulus, ms.
        start_ms: f64,
    },
    /// A pulse must last.
    #[error("a pulse must last longer than 0 ms, not {duration_ms} ms")]
    NoDuration {
        /// Duration of the pulse, ms.
        duration_ms: f64,
    },
    /// Several beats need time between them.
    #[error("{beats} beats need a cycle length above 0 ms, not {cycle_length_ms} ms")]
    NoCycle {
        /// Number of stimuli.
        beats: u32,
        /// Time between them, ms.
        cycle_length_ms: f64,
    },
    /// A pulse is still on when the next begins.
    #[error("a pulse of {duration_ms} ms does not end before the next, {cycle_length_ms} ms later")]
    Overlap {
        /// Duration of the pulse, ms.
        duration_ms: f64,
        /// Time between pulses, ms.
        cycle_length_ms: f64,
    },
}

impl Protocol {
    /// When the first stimulus of [`Protocol::once`] and of the reference beat falls, ms.
    pub const DEFAULT_START_MS: f64 = 50.0;

    /// One stimulus at 50 ms.
    ///
    /// # Example
    /// ```
    /// use myospring::cell::pacing::{Protocol, Stimulus};
    /// let protocol = Protocol::once(Stimulus::Jump { amplitude: 0.325 });
    /// assert_eq!(protocol.stimulus_times().collect::<Vec<_>>(), [50.0]);
    /// ```
    pub const fn once(stimulus: Stimulus) -> Self {
        Self { stimulus, start_ms: Self::DEFAULT_START_MS, cycle_length_ms: 1000.0, beats: 1 }
    }

    /// No stimulus at all.
    pub const fn rest() -> Self {
        Self { beats: 0, ..Self::once(Stimulus::Jump { amplitude: 0.0 }) }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// Numbers that are not finite, a start before 0 ms, a pulse that does not last or that runs
    /// into the next one, several beats without time between them.
    pub fn validate(&self) -> Result<(), ProtocolError> {
        let Self { stimulus, start_ms, cycle_length_ms, beats } = *self;
        let finite = |field, value: f64| {
            if value.is_finite() { Ok(()) } else { Err(ProtocolError::NotFinite { field, value }) }
        };
        finite("start", start_ms)?;
        finite("cycle length", cycle_length_ms)?;
        if start_ms < 0.0 {
            return Err(ProtocolError::StartsBeforeZero { start_ms });
        }
        if beats > 1 && cycle_length_ms <= 0.0 {
            return Err(ProtocolError::NoCycle { beats, cycle_length_ms });
        }
        match stimulus {
            Stimulus::Jump { amplitude } => finite("amplitude of the jump", amplitude),
            Stimulus::Pulse { amplitude, duration_ms } => {
                finite("amplitude of the pulse", amplitude)?;
                finite("duration of the pulse", duration_ms)?;
                if duration_ms <= 0.0 {
                    return Err(ProtocolError::NoDuration { duration_ms });
                }
                if beats > 1 && duration_ms >= cycle_length_ms {
                    return Err(ProtocolError::Overlap { duration_ms, cycle_length_ms });
                }
                Ok(())
            }
        }
    }

    /// Times of the stimuli, ms: `start + n cycle_length`, not a running sum.
    pub fn stimulus_times(&self) -> impl Iterator<Item = f64> + use<> {
        let Self { start_ms, cycle_length_ms, beats, .. } = *self;
        (0..beats).map(move |beat| start_ms + f64::from(beat) * cycle_length_ms)
    }

    /// Every event with its time in ms, in order.
    ///
    /// # Example
    /// ```
    /// use myospring::cell::pacing::{Event, Protocol, Stimulus};
    /// let pulse = Stimulus::Pulse { amplitude: 0.5, duration_ms: 1.0 };
    /// let events: Vec<_> = Protocol::once(pulse).events().collect();
    /// assert_eq!(events, [(50.0, Event::CurrentOn(0.5)), (51.0, Event::CurrentOff)]);
    /// ```
    pub fn events(&self) -> impl Iterator<Item = (f64, Event)> + use<> {
        let protocol = *self;
        (0..).map_while(move |index| protocol.nth_event(index))
    }

    /// The current of the pulse that acts at a time, ms; 0 if none does.
    ///
    /// # Example
    /// ```
    /// use myospring::cell::pacing::{Protocol, Stimulus};
    /// let pulse = Protocol::once(Stimulus::Pulse { amplitude: 0.5, duration_ms: 1.0 });
    /// assert_eq!([49.9, 50.0, 50.9, 51.0].map(|time| pulse.current_at(time)), [0.0, 0.5, 0.5, 0.0]);
    /// ```
    pub fn current_at(&self, time_ms: f64) -> f64 {
        let Stimulus::Pulse { amplitude, duration_ms } = self.stimulus else { return 0.0 };
        let cycles = (time_ms - self.start_ms) / self.cycle_length_ms;
        let last = u64::from(self.beats.saturating_sub(1));
        let near = if last > 0 { (cycles.max(0.0).floor() as u64).min(last) } else { 0 };
        // The quotient may be rounded down to the beat before.
        let acts = (near..=last.min(near + 1)).any(|beat| {
            let start_ms = self.start_ms + beat as f64 * self.cycle_length_ms;
            (start_ms..start_ms + duration_ms).contains(&time_ms)
        });
        if acts && self.beats > 0 { amplitude } else { 0.0 }
    }

    /// Time since the last stimulus began, ms; infinite before the first.
    pub(super) fn since_stimulus(&self, time_ms: f64) -> f64 {
        if self.beats == 0 || time_ms < self.start_ms {
            return f64::INFINITY;
        }
        let last = self.beats - 1;
        let began = |beat: u32| self.start_ms + f64::from(beat) * self.cycle_length_ms;
        let near = if last > 0 {
            (((time_ms - self.start_ms) / self.cycle_length_ms).floor() as u32).min(last)
        } else {
            0
        };
        // The quotient may be rounded down to the beat before.
        let next = (near + 1).min(last);
        time_ms - if last > 0 && began(next) <= time_ms { began(next) } else { began(near) }
    }

    /// Event number `index` in order of time, if there is one.
    pub(super) fn nth_event(&self, index: u64) -> Option<(f64, Event)> {
        let (events_per_beat, duration_ms) = match self.stimulus {
            Stimulus::Jump { .. } => (1, 0.0),
            Stimulus::Pulse { duration_ms, .. } => (2, duration_ms),
        };
        let beat = index / events_per_beat;
        if beat >= u64::from(self.beats) {
            return None;
        }
        let start_ms = self.start_ms + beat as f64 * self.cycle_length_ms;
        Some(match self.stimulus {
            Stimulus::Jump { amplitude } => (start_ms, Event::Jump(amplitude)),
            Stimulus::Pulse { amplitude, .. } if index.is_multiple_of(2) => {
                (start_ms, Event::CurrentOn(amplitude))
            }
            Stimulus::Pulse { .. } => (start_ms + duration_ms, Event::CurrentOff),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PULSE: Stimulus = Stimulus::Pulse { amplitude: 0.5, duration_ms: 1.0 };

    #[test]
    fn a_train_has_every_beat_at_its_exact_time() {
        let train = Protocol { stimulus: PULSE, start_ms: 0.3, cycle_length_ms: 0.1, beats: 1000 };
        let times: Vec<f64> = train.stimulus_times().collect();
        assert_eq!(times.len(), 1000);
        assert_eq!(times[999], 0.3 + 999.0 * 0.1);
    }

    #[test]
    fn events_alternate_and_never_go_back_in_time() {
        let train = Protocol { stimulus: PULSE, start_ms: 0.0, cycle_length_ms: 2.0, beats: 5 };
        let events: Vec<(f64, Event)> = train.events().collect();
        assert_eq!(events.len(), 10);
        assert!(events.windows(2).all(|pair| pair[0].0 < pair[1].0));
        assert_eq!(events[9], (9.0, Event::CurrentOff));
        assert_eq!(train.nth_event(9), Some(events[9]));
        assert_eq!(train.nth_event(10), None);
    }

    #[test]
    fn impossible_protocols_are_refused_with_the_reason() {
        let good = Protocol { stimulus: PULSE, start_ms: 0.0, cycle_length_ms: 2.0, beats: 5 };
        assert_eq!(good.validate(), Ok(()));
        let pulse = |amplitude, duration_ms| Stimulus::Pulse { amplitude, duration_ms };
        let jump = Stimulus::Jump { amplitude: f64::INFINITY };
        for (bad, message) in [
            (Protocol { start_ms: f64::NAN, ..good }, "start = NaN is not a finite number"),
            (Protocol { start_ms: -1.0, ..good }, "-1 ms lies before the start"),
            (Protocol { cycle_length_ms: 0.0, ..good }, "5 beats need a cycle length above 0 ms"),
            (Protocol { cycle_length_ms: 1.0, ..good }, "does not end before the next"),
            (Protocol { stimulus: pulse(0.5, 0.0), ..good }, "must last longer than 0 ms"),
            (Protocol { stimulus: pulse(f64::NAN, 1.0), ..good }, "amplitude of the pulse"),
            (Protocol { stimulus: jump, ..good }, "amplitude of the jump = inf"),
        ] {
            let error = bad.validate().unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn a_single_beat_needs_no_cycle_length() {
        let once = Protocol { cycle_length_ms: 0.0, ..Protocol::once(PULSE) };
        assert_eq!(once.validate(), Ok(()));
        assert_eq!(Protocol::rest().events().count(), 0);
    }
}
