//! What the page is told while an experiment goes on.
#![allow(unsafe_code, reason = "the page gives the function; it copies the text before it returns")]

use myospring::experiment::Observer;
use std::sync::{Mutex, PoisonError};

/// Tells the page how far an experiment is.
#[derive(Default)]
pub(crate) struct Told {
    /// The present stage, and how many steps it has.
    stage: Mutex<(String, u64)>,
}

impl Observer for Told {
    fn stage(&self, what: &str, of: u64) {
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner) = (what.to_owned(), of);
        tell(what, 0, of);
    }

    fn reached(&self, done: u64) {
        let (what, of) = &*self.stage.lock().unwrap_or_else(PoisonError::into_inner);
        tell(what, done, *of);
    }
}

#[cfg(target_family = "wasm")]
fn tell(what: &str, done: u64, of: u64) {
    #[link(wasm_import_module = "page")]
    unsafe extern "C" {
        fn tell(text: *const u8, length: usize, done: f64, of: f64);
    }
    // SAFETY: the page reads `length` bytes from `text`, which lives until it returns.
    unsafe { tell(what.as_ptr(), what.len(), done as f64, of as f64) }
}

#[cfg(not(target_family = "wasm"))]
fn tell(_what: &str, _done: u64, _of: u64) {}
