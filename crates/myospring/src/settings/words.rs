//! Choices and the words that they are written with.

use crate::cell::solve::Method;
use crate::mechanics::active::ActiveLaw;
use crate::mechanics::area::AreaLaw;
use crate::microscopy::fibres::Stain;
use crate::microscopy::segment::Modality;
use crate::simulation::TensionScale;

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

worded! { TensionScale {
    TensionScale::Published = "published":
        "That of the model's published parameters: a changed parameter changes the strength of the cell.",
    TensionScale::OwnPeak = "own-peak":
        "That of the model as it is, by a reference beat of its own: every cell has the same peak tension, \
         whatever its parameters.",
} }

worded! { Method {
    Method::RungeKutta4 = "runge-kutta-4":
        "Classical Runge-Kutta, order 4 where the equations are smooth.",
    Method::ForwardEuler = "forward-euler": "Forward Euler, order 1.",
    Method::StaggeredEuler = "staggered-euler":
        "Forward Euler that updates one block of the state after the other, each with the new values of \
         those before it, order 1. The authors of `coelho_2021` step so.",
} }

worded! { Modality {
    Modality::Auto = "auto": "To be told from the grey values.",
    Modality::Fluorescence = "fluorescence": "A bright cell on a dark ground.",
    Modality::Brightfield = "brightfield":
        "A cell that shows by its edges and texture; phase contrast too.",
    Modality::Mask = "mask": "Not a picture but its segmentation: background 0.",
} }

worded! { AreaLaw {
    AreaLaw::Gradient = "gradient":
        "Minus the gradient of an energy of the area's deviation from rest.",
    AreaLaw::Barycentric = "barycentric":
        "Towards the barycentre, proportional to the area's deviation from rest.",
    AreaLaw::Printed = "printed":
        "Exactly the paper's Eq. (13), absolute area and all; for comparison only.",
} }

worded! { ActiveLaw {
    ActiveLaw::Fibre = "fibre": "Stress along the fibre in each triangle; internal.",
    ActiveLaw::Ends = "ends": "The paper's load on the end nodes along the long axis; external.",
} }

worded! { Stain {
    Stain::ZDisc = "z-disc":
        "Stripes that lie across the fibre: z-discs (alpha-actinin, titin's end), M-bands (myomesin).",
    Stain::Filament = "filament": "Threads that run along the fibre: actin (phalloidin).",
} }
