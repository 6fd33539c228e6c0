//! Random numbers that are the same on every machine and in every version: `ChaCha8`.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

/// A stream of random numbers.
pub(in crate::study) struct Random(ChaCha8Rng);

impl Random {
    /// The stream of a seed; `stream` separates numbers for different purposes.
    pub(in crate::study) fn new(seed: u64, stream: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream);
        Self(generator)
    }

    /// Skips numbers, in constant time.
    pub(super) fn skip(&mut self, numbers: usize) {
        let words = 2 * numbers as u128;
        self.0.set_word_pos(self.0.get_word_pos() + words);
    }

    /// 64 random bits.
    pub(in crate::study) fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Evenly from [0, 1).
    pub(in crate::study) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A whole number below `end`, each equally likely to 1 in 2^53.
    pub(in crate::study) fn below(&mut self, end: usize) -> usize {
        ((self.unit() * end as f64) as usize).min(end - 1)
    }

    /// Puts a list in random order (Fisher and Yates).
    pub(in crate::study) fn shuffle<T>(&mut self, list: &mut [T]) {
        for last in (1..list.len()).rev() {
            list.swap(last, self.below(last + 1));
        }
    }
}
