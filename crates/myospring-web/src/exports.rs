//! The functions of the WebAssembly module.
//!
//! The page writes a request into [`input`], calls [`answer`], and reads [`answer_length`] bytes from where that points.
#![allow(
    unsafe_code,
    reason = "the page finds the functions by their names; no pointer is followed here"
)]

use crate::engine::Engine;
use std::cell::RefCell;

thread_local! {
    static ENGINE: RefCell<Engine> = RefCell::default();
    static INPUT: RefCell<Vec<u8>> = RefCell::default();
    static ANSWER: RefCell<String> = RefCell::default();
}

/// Room for a request: `length` bytes, text and the bytes of a file after it.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn input(length: usize) -> *mut u8 {
    INPUT.with_borrow_mut(|input| {
        input.clear();
        input.resize(length, 0);
        input.as_mut_ptr()
    })
}

/// Answers the request in the input, of which the first `text` bytes are JSON. If it panics, the answer is what went wrong.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn answer(text: usize) -> *const u8 {
    std::panic::set_hook(Box::new(|info| {
        ANSWER.with_borrow_mut(|answer| *answer = info.to_string());
    }));
    let input = INPUT.take();
    let (text, bytes) = input.split_at(text.min(input.len()));
    let said =
        ENGINE.with_borrow_mut(|engine| engine.answer(&String::from_utf8_lossy(text), bytes));
    ANSWER.with_borrow_mut(|answer| {
        *answer = said;
        answer.as_ptr()
    })
}

/// Where the last answer is.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn answer_place() -> *const u8 {
    ANSWER.with_borrow(|answer| answer.as_ptr())
}

/// Bytes of the last answer.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn answer_length() -> usize {
    ANSWER.with_borrow(String::len)
}
