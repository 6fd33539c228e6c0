//! Applies a pacing protocol to a cell during integration.

use super::description::{Moved, Stimulation};
use super::pacing::{Event, Protocol, ProtocolError};

/// The state of a protocol during integration.
#[derive(Debug, Clone)]
pub(super) struct Pacer {
    protocol: Protocol,
    /// The states that a jump changes, and their parts of its amplitude.
    jumps: Vec<Moved>,
    next: u64,
    current: f64,
    /// Start of the last stimulus, ms.
    began_ms: f64,
}

impl Pacer {
    /// Starts before the first event.
    pub(super) fn new(
        stimulation: &Stimulation,
        protocol: Protocol,
    ) -> Result<Self, ProtocolError> {
        protocol.validate()?;
        let first = stimulation.moves.first().map_or(1.0, |moved| moved.weight);
        let share = |moved: &Moved| Moved { weight: moved.weight / first, ..*moved };
        let jumps = stimulation.moves.iter().map(share).collect();
        Ok(Self { protocol, jumps, next: 0, current: 0.0, began_ms: f64::NEG_INFINITY })
    }

    /// The stimulus current that acts now.
    pub(super) fn current(&self) -> f64 {
        self.current
    }

    /// Time at `time_ms` since the last stimulus began, ms.
    pub(super) fn since_stimulus(&self, time_ms: f64) -> f64 {
        time_ms - self.began_ms
    }

    /// Time of the next event, ms.
    pub(super) fn next_ms(&self) -> Option<f64> {
        Some(self.protocol.nth_event(self.next)?.0)
    }

    /// Applies all events that are due at a time, ms; true if there were any.
    pub(super) fn act(&mut self, time_ms: f64, state: &mut [f64]) -> bool {
        let mut any = false;
        while let Some((event_ms, event)) = self.protocol.nth_event(self.next)
            && event_ms <= time_ms
        {
            if !matches!(event, Event::CurrentOff) {
                self.began_ms = event_ms;
            }
            match event {
                Event::Jump(amplitude) => {
                    for moved in &self.jumps {
                        state[moved.state] += moved.weight * amplitude;
                    }
                }
                Event::CurrentOn(current) => self.current = current,
                Event::CurrentOff => self.current = 0.0,
            }
            self.next += 1;
            any = true;
        }
        any
    }
}
