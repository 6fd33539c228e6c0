//! Choices and the words that they are written with.

/// A word that a choice is written with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Word {
    /// As written.
    pub name: &'static str,
    /// What it chooses, in a sentence.
    pub doc: &'static str,
}

/// A choice that is written with words.
pub(super) trait Worded: Sized {
    /// All words.
    const WORDS: &'static [Word];

    /// The word of this choice.
    fn word(&self) -> &'static str;

    /// The choice of a word, if it is one of them.
    fn of_word(word: &str) -> Option<Self>;
}

/// Takes the choice of a word, if it is one.
pub(super) fn choose<T: Worded>(place: &mut T, word: &str) -> Option<()> {
    *place = T::of_word(word)?;
    Some(())
}

/// Gives each variant its word; a variant without one does not compile.
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
