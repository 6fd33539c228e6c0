//! Durations of work, for people.

use std::time::Duration;

/// Measures how long work takes. In a web page it measures nothing and every duration is 0: WebAssembly alone has no
/// clock, and the page measures its runs itself.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stopwatch(#[cfg(not(target_family = "wasm"))] std::time::Instant);

impl Stopwatch {
    /// Starts to measure.
    pub(crate) fn start() -> Self {
        Self(
            #[cfg(not(target_family = "wasm"))]
            std::time::Instant::now(),
        )
    }

    /// The time since the start.
    pub(crate) fn elapsed(&self) -> Duration {
        #[cfg(not(target_family = "wasm"))]
        return self.0.elapsed();
        #[cfg(target_family = "wasm")]
        Duration::ZERO
    }
}
