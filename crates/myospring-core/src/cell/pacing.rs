//! Pacing: when and how a cell is stimulated.
//!
//! Events are half-open in time: a pulse `[start, start + duration)` includes its start but not its
//! end, and the state at the time of a jump is the state after the jump.

/// Whether two times, ms, differ only by rounding.
pub(super) fn same_instant(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * a.abs().max(b.abs())
}

/// One stimulus.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stimulus {
    /// An instantaneous jump of the potential variable.
    Jump {
        /// Size of the jump, in units of the potential variable.
        amplitude: f64,
    },
    /// A constant current for some time.
    Pulse {
        /// The current, in the unit that the cell model states; 1/ms for a dimensionless potential.
        amplitude: f64,
        /// Its duration, ms.
        duration_ms: f64,
    },
}

/// A train of equal stimuli (S1), optionally followed by one extra stimulus (S2) at another
/// interval.
///
/// # Example
/// A premature stimulus 320 ms after the last of ten at 600 ms:
/// ```
/// use myospring::cell::pacing::{Protocol, Stimulus};
/// let pulse = Stimulus::Pulse { amplitude: 0.5, duration_ms: 1.0 };
/// let train = Protocol { cycle_length_ms: 600.0, beats: 10, ..Protocol::once(pulse) };
/// let protocol = Protocol { s2_interval_ms: Some(320.0), ..train };
/// assert_eq!(protocol.stimulus_times().last(), Some(50.0 + 9.0 * 600.0 + 320.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Protocol {
    /// The stimulus of each beat.
    pub stimulus: Stimulus,
    /// Time of the first stimulus, ms.
    pub start_ms: f64,
    /// Time from one stimulus to the next, ms; ignored for a single beat.
    pub cycle_length_ms: f64,
    /// Number of stimuli of the train; none leaves the cell at rest.
    pub beats: u32,
    /// Coupling interval of the extra stimulus S2, from the last stimulus of the train, ms; `None`
    /// for no S2.
    pub s2_interval_ms: Option<f64>,
}

/// An event at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event {
    /// The potential variable jumps by this much.
    Jump(f64),
    /// This current acts from now on, in the unit that the cell model states.
    CurrentOn(f64),
    /// No current acts from now on.
    CurrentOff,
}

/// Why a protocol is invalid.
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
    /// A pulse without duration.
    #[error("a pulse must last longer than 0 ms, not {duration_ms} ms")]
    NoDuration {
        /// Duration of the pulse, ms.
        duration_ms: f64,
    },
    /// Several beats without time between them.
    #[error("{beats} beats need a cycle length above 0 ms, not {cycle_length_ms} ms")]
    NoCycle {
        /// Number of stimuli.
        beats: u32,
        /// Time between them, ms.
        cycle_length_ms: f64,
    },
    /// An extra stimulus without a train.
    #[error("an S2 follows the last stimulus of a train, and there is none; give 1 beat or more")]
    NoTrain,
    /// S2 does not come after S1.
    #[error("S2 must come after the last stimulus of the train, not {s2_interval_ms} ms after it")]
    NotAfter {
        /// Time from the last stimulus of the train to S2, ms.
        s2_interval_ms: f64,
    },
    /// The last pulse of the train is still on when S2 begins.
    #[error("a pulse of {duration_ms} ms does not end before S2, {s2_interval_ms} ms later")]
    S2Overlap {
        /// Duration of the pulse, ms.
        duration_ms: f64,
        /// Time from the last stimulus of the train to S2, ms.
        s2_interval_ms: f64,
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
    /// Time of the first stimulus of [`Protocol::once`] and of the reference beat, ms.
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
        Self {
            stimulus,
            start_ms: Self::DEFAULT_START_MS,
            cycle_length_ms: 1000.0,
            beats: 1,
            s2_interval_ms: None,
        }
    }

    /// No stimulus at all.
    pub const fn rest() -> Self {
        Self { beats: 0, ..Self::once(Stimulus::Jump { amplitude: 0.0 }) }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// Numbers that are not finite, a start before 0 ms, a pulse without duration or that overlaps
    /// the next one, several beats without time between them, an S2 without a train or not after
    /// it.
    pub fn validate(&self) -> Result<(), ProtocolError> {
        let Self { stimulus, start_ms, cycle_length_ms, beats, s2_interval_ms } = *self;
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
        if let Some(s2_interval_ms) = s2_interval_ms {
            finite("S2 interval", s2_interval_ms)?;
            if beats == 0 {
                return Err(ProtocolError::NoTrain);
            }
            if s2_interval_ms <= 0.0 {
                return Err(ProtocolError::NotAfter { s2_interval_ms });
            }
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
                match s2_interval_ms {
                    Some(s2_interval_ms) if duration_ms >= s2_interval_ms => {
                        Err(ProtocolError::S2Overlap { duration_ms, s2_interval_ms })
                    }
                    _ => Ok(()),
                }
            }
        }
    }

    /// Times of the stimuli, ms: `start + n cycle_length`, not a running sum; S2 last.
    pub fn stimulus_times(&self) -> impl Iterator<Item = f64> + use<> {
        let protocol = *self;
        (0..).map_while(move |index| protocol.nth_stimulus_ms(index))
    }

    /// Time of S2, ms; `None` without S2.
    pub fn s2_ms(&self) -> Option<f64> {
        self.s2_interval_ms.and_then(|_| self.nth_stimulus_ms(u64::from(self.beats)))
    }

    /// Time of the stimulus with this index, ms, if there is one.
    fn nth_stimulus_ms(&self, index: u64) -> Option<f64> {
        let Self { start_ms, cycle_length_ms, beats, s2_interval_ms, .. } = *self;
        let of_train = |index: u64| start_ms + index as f64 * cycle_length_ms;
        match u64::from(beats) {
            beats if index < beats => Some(of_train(index)),
            beats if index == beats => Some(of_train(beats.checked_sub(1)?) + s2_interval_ms?),
            _ => None,
        }
    }

    /// Time of the last stimulus up to a time, ms, if there is one.
    fn last_stimulus_ms(&self, time_ms: f64) -> Option<f64> {
        if let Some(s2_ms) = self.s2_ms().filter(|s2_ms| *s2_ms <= time_ms) {
            return Some(s2_ms);
        }
        let last = u64::from(self.beats).checked_sub(1)?;
        let near = if last > 0 {
            (((time_ms - self.start_ms) / self.cycle_length_ms).max(0.0).floor() as u64).min(last)
        } else {
            0
        };
        // The quotient may be rounded to the previous or next beat.
        let nearest = [(near + 1).min(last), near, near.saturating_sub(1)];
        let mut times = nearest.into_iter().filter_map(|index| self.nth_stimulus_ms(index));
        times.find(|began_ms| *began_ms <= time_ms)
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

    /// The stimulus current at a time, ms; 0 without a pulse.
    ///
    /// # Example
    /// ```
    /// use myospring::cell::pacing::{Protocol, Stimulus};
    /// let pulse = Protocol::once(Stimulus::Pulse { amplitude: 0.5, duration_ms: 1.0 });
    /// assert_eq!([49.9, 50.0, 50.9, 51.0].map(|time| pulse.current_at(time)), [0.0, 0.5, 0.5, 0.0]);
    /// ```
    pub fn current_at(&self, time_ms: f64) -> f64 {
        let Stimulus::Pulse { amplitude, duration_ms } = self.stimulus else { return 0.0 };
        let began_ms = self.last_stimulus_ms(time_ms);
        let acts = began_ms.is_some_and(|began_ms| time_ms < began_ms + duration_ms);
        if acts { amplitude } else { 0.0 }
    }

    /// Time since the last stimulus began, ms; infinite before the first.
    pub(super) fn since_stimulus(&self, time_ms: f64) -> f64 {
        self.last_stimulus_ms(time_ms).map_or(f64::INFINITY, |began_ms| time_ms - began_ms)
    }

    /// The event with this index in order of time, if there is one.
    pub(super) fn nth_event(&self, index: u64) -> Option<(f64, Event)> {
        let (events_per_beat, duration_ms) = match self.stimulus {
            Stimulus::Jump { .. } => (1, 0.0),
            Stimulus::Pulse { duration_ms, .. } => (2, duration_ms),
        };
        let start_ms = self.nth_stimulus_ms(index / events_per_beat)?;
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

    fn train(start_ms: f64, cycle_length_ms: f64, beats: u32) -> Protocol {
        Protocol { start_ms, cycle_length_ms, beats, ..Protocol::once(PULSE) }
    }

    #[test]
    fn a_train_has_every_beat_at_its_exact_time() {
        let train = self::train(0.3, 0.1, 1000);
        let times: Vec<f64> = train.stimulus_times().collect();
        assert_eq!(times.len(), 1000);
        assert_eq!(times[999], 0.3 + 999.0 * 0.1);
    }

    #[test]
    fn events_alternate_and_never_go_back_in_time() {
        let train = self::train(0.0, 2.0, 5);
        let events: Vec<(f64, Event)> = train.events().collect();
        assert_eq!(events.len(), 10);
        assert!(events.windows(2).all(|pair| pair[0].0 < pair[1].0));
        assert_eq!(events[9], (9.0, Event::CurrentOff));
        assert_eq!(train.nth_event(9), Some(events[9]));
        assert_eq!(train.nth_event(10), None);
    }

    #[test]
    fn impossible_protocols_are_refused_with_the_reason() {
        let good = train(0.0, 2.0, 5);
        assert_eq!(good.validate(), Ok(()));
        let pulse = |amplitude, duration_ms| Stimulus::Pulse { amplitude, duration_ms };
        let jump = Stimulus::Jump { amplitude: f64::INFINITY };
        let s2 = |interval_ms| Protocol { s2_interval_ms: Some(interval_ms), ..good };
        assert_eq!([s2(1.5).validate(), s2(1e4).validate()], [Ok(()); 2]);
        for (bad, message) in [
            (Protocol { start_ms: f64::NAN, ..good }, "start = NaN is not a finite number"),
            (Protocol { start_ms: -1.0, ..good }, "-1 ms lies before the start"),
            (Protocol { cycle_length_ms: 0.0, ..good }, "5 beats need a cycle length above 0 ms"),
            (Protocol { cycle_length_ms: 1.0, ..good }, "does not end before the next"),
            (Protocol { stimulus: pulse(0.5, 0.0), ..good }, "must last longer than 0 ms"),
            (Protocol { stimulus: pulse(f64::NAN, 1.0), ..good }, "amplitude of the pulse"),
            (Protocol { stimulus: jump, ..good }, "amplitude of the jump = inf"),
            (s2(f64::NAN), "S2 interval = NaN is not a finite number"),
            (s2(0.0), "S2 must come after the last stimulus of the train, not 0 ms"),
            (s2(1.0), "a pulse of 1 ms does not end before S2, 1 ms later"),
            (Protocol { beats: 0, ..s2(300.0) }, "there is none; give 1 beat or more"),
        ] {
            let error = bad.validate().unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn an_extra_stimulus_comes_once_after_the_last_of_the_train_early_or_late() {
        for (beats, interval_ms) in [(1, 1.5), (5, 0.3), (5, 7.7), (3, 300.0)] {
            let train = self::train(0.7, 2.0, beats);
            let pulse = Stimulus::Pulse { amplitude: 0.5, duration_ms: 0.2 };
            let with = Protocol { stimulus: pulse, s2_interval_ms: Some(interval_ms), ..train };
            let last_ms = 0.7 + 2.0 * f64::from(beats - 1);
            let s2_ms = last_ms + interval_ms;
            assert_eq!(with.s2_ms(), Some(s2_ms));
            let times: Vec<f64> = with.stimulus_times().collect();
            assert_eq!(times[..beats as usize], train.stimulus_times().collect::<Vec<_>>());
            assert_eq!(times[beats as usize..], [s2_ms]);
            let events: Vec<_> = with.events().collect();
            assert_eq!(events.len(), 2 * times.len());
            let last = [(s2_ms, Event::CurrentOn(0.5)), (s2_ms + 0.2, Event::CurrentOff)];
            assert_eq!(events[events.len() - 2..], last);
            // What acts follows from the events alone, at any time.
            for tick in 0..40_000 {
                let time_ms = 0.01 * f64::from(tick);
                let before = times.iter().rev().find(|began_ms| **began_ms <= time_ms);
                let since = before.map_or(f64::INFINITY, |began_ms| time_ms - began_ms);
                assert_eq!(with.since_stimulus(time_ms), since, "{time_ms} ms");
                let acts = before.is_some_and(|began_ms| time_ms < began_ms + 0.2);
                assert_eq!(with.current_at(time_ms), if acts { 0.5 } else { 0.0 }, "{time_ms} ms");
            }
        }
    }

    #[test]
    fn a_single_beat_needs_no_cycle_length() {
        let once = Protocol { cycle_length_ms: 0.0, ..Protocol::once(PULSE) };
        assert_eq!(once.validate(), Ok(()));
        assert_eq!(Protocol::rest().events().count(), 0);
    }
}
