//! Does to a cell what its protocol wants, when it wants it.

use super::description::{Moved, Stimulation};
use super::pacing::{Event, Protocol, ProtocolError};

/// A protocol on its way through time.
#[derive(Debug, Clone)]
pub(super) struct Pacer {
    protocol: Protocol,
    /// The states that a jump moves, and by what part of its amplitude.
    jumps: Vec<Moved>,
    next: u64,
    current: f64,
    /// When the last stimulus began, ms.
    began_ms: f64,
}

impl Pacer {
    /// Before the first event.
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

    /// When the next event comes, ms.
    pub(super) fn next_ms(&self) -> Option<f64> {
        Some(self.protocol.nth_event(self.next)?.0)
    }

    /// Does everything that is due at a time, ms; true if anything was.
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
