//! What is done with the bytes of a film that may be anything.

use myospring::microscopy::film::Film;
use myospring::microscopy::picture::Selection;

/// Reads the bytes as a film and the first frames of it; how many there were. Nothing may panic.
pub(crate) fn exercise(bytes: &[u8]) -> usize {
    let Ok(film) = Film::read(bytes.to_vec(), &Selection::default()) else { return 0 };
    (0..film.len().min(4)).filter(|&index| film.frame(index).is_ok()).count()
}
