//! Ending long work early.

use std::fmt;
use std::sync::Arc;

/// Says whether work shall end early. Work that may take longer than a fraction of a second checks
/// it often, also within one equilibrium; the default never interrupts.
///
/// # Example
/// ```
/// use myospring::interruption::Interruption;
/// use myospring::prelude::*;
/// use std::time::{Duration, Instant};
///
/// let begun = Instant::now();
/// let mut simulation = Simulation::new(lattice::rectangle(20, 4, 5.0)?);
/// simulation.interruption = Interruption::when(move || begun.elapsed() > Duration::from_secs(600));
/// assert!(simulation.build()?.run(|_progress| true).stop.is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Default)]
pub struct Interruption(Option<Arc<dyn Fn() -> bool + Send + Sync>>);

impl Interruption {
    /// Work ends once this returns `true`; it is called often and from several threads, so it must be fast.
    pub fn when(asked: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(asked)))
    }

    /// Whether work shall end.
    pub fn is_requested(&self) -> bool {
        self.0.as_ref().is_some_and(|asked| asked())
    }

    /// An error once work shall end.
    ///
    /// # Errors
    /// [`Interrupted`].
    pub fn check(&self) -> Result<(), Interrupted> {
        if self.is_requested() { Err(Interrupted) } else { Ok(()) }
    }
}

/// All values are equal, because no result depends on an interruption.
impl PartialEq for Interruption {
    fn eq(&self, _other: &Self) -> bool {
        true
    }
}

impl fmt::Debug for Interruption {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(if self.0.is_some() { "Interruption" } else { "Interruption(never)" })
    }
}

/// Work was interrupted and has no result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("it was interrupted")]
pub struct Interrupted;
