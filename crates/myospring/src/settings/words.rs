//! Choices that are written as words.

/// The word of a choice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Word {
    /// As written.
    pub name: &'static str,
    /// Its description, in a sentence.
    pub doc: &'static str,
}

/// A choice that is written as a word.
pub(super) trait Worded: Sized {
    /// All words.
    const WORDS: &'static [Word];

    /// The word of this choice.
    fn word(&self) -> &'static str;

    /// The choice with this word, if there is one.
    fn of_word(word: &str) -> Option<Self>;
}

/// Sets the choice with this word, if there is one.
pub(super) fn choose<T: Worded>(place: &mut T, word: &str) -> Option<()> {
    *place = T::of_word(word)?;
    Some(())
}

/// Assigns a word to each variant; a missing one is a compile error.
macro_rules! worded {
    ($type:ty { $($variant:path = $word:literal : $doc:literal,)* }) => {
        impl Worded for $type {
            const WORDS: &'static [Word] = &[$(Word { name: $word, doc: $doc }),*];

            fn word(&self) -> &'static str {
                match self {
                    $($variant => $word,)*
                }
            }

            fn of_word(word: &str) -> Option<Self> {
                match word {
                    $($word => Some($variant),)*
                    _ => None,
                }
            }
        }
    };
}
pub(super) use worded;
