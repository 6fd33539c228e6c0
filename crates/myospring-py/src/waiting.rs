//! Waiting for work so that Python goes on: the lock of the interpreter is released, and Ctrl-C is heard.

use myospring::interruption::Interruption;
use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// How often signals are looked for.
const SOON: Duration = Duration::from_millis(50);

/// Does work on a thread of its own, without the interpreter, while this one listens for signals. Once one has come
/// the work is asked to end early, and what the signal raised is the error.
///
/// # Errors
/// What a signal raised, such as `KeyboardInterrupt`.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&Interruption) -> T + Send,
) -> PyResult<T> {
    let stop = Arc::new(AtomicBool::new(false));
    let asked = Arc::clone(&stop);
    let interruption = Interruption::when(move || asked.load(Ordering::Relaxed));
    let (done, bell) = (Mutex::new(false), Condvar::new());
    thread::scope(|scope| {
        let worker = scope.spawn(|| {
            let _ring = Ring { done: &done, bell: &bell };
            work(&interruption)
        });
        let mut raised = None;
        loop {
            let is_done = py.detach(|| {
                let done = done.lock().unwrap_or_else(PoisonError::into_inner);
                let waited = bell.wait_timeout_while(done, SOON, |done| !*done);
                *waited.unwrap_or_else(PoisonError::into_inner).0
            });
            if is_done {
                break;
            }
            if let Err(error) = py.check_signals() {
                stop.store(true, Ordering::Relaxed);
                raised.get_or_insert(error);
            }
        }
        let outcome = py.detach(|| worker.join()).unwrap_or_else(|panic| resume_unwind(panic));
        raised.map_or(Ok(outcome), Err)
    })
}

/// Rings when it is dropped, whether the work came to its end or panicked.
struct Ring<'a> {
    done: &'a Mutex<bool>,
    bell: &'a Condvar,
}

impl Drop for Ring<'_> {
    fn drop(&mut self) {
        *self.done.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.bell.notify_all();
    }
}
