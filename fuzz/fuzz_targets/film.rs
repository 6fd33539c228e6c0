//! Any bytes as a film.
#![no_main]

#[path = "../../crates/myospring/tests/common/film_bytes.rs"]
mod film_bytes;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    film_bytes::exercise(bytes);
    film_bytes::exercise_stack(bytes);
});
