//! Fields by which a cell is coloured in figures, films, pages and files: values by triangle (of a
//! thick cell by tetrahedron), their units and colours.
//!
//! [`Field`] names them, [`Fields`] computes them on one mesh, [`ColourScale`] gives their colours: one scale for all
//! frames of a run, so that a colour means the same throughout.

mod colour;
mod on_mesh;

pub use colour::ColourScale;
pub(crate) use colour::light_to_dark;
pub use on_mesh::{FieldError, Fields};

use myospring_core::recording::Frame;

/// A quantity that has a value in each place of the cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Field {
    /// Strain along the fibre: `|F f0| - 1`, with F the deformation gradient and f0 the fibre at rest.
    #[default]
    FibreStrain,
    /// Strain of the direction that is across the fibre at rest: `|F n0| - 1`, with n0 at a right
    /// angle to f0. In a thick cell many directions are: `sqrt(|cof(F) f0|) - 1`, the mean strain of
    /// the section across the fibre.
    CrossStrain,
    /// Area relative to that at rest: the determinant of F.
    AreaRatio,
    /// Volume of a thick cell relative to that at rest: the determinant of F.
    VolumeRatio,
    /// Active tension along the fibre times the content of myofibrils.
    ActiveStress,
    /// Distance from the position at rest.
    Displacement,
    /// Absolute traction on the gel to which the cell adheres; 0 of a cell on none.
    Traction,
    /// Membrane potential, where it differs from place to place, as in a tissue.
    Potential,
}

impl Field {
    /// All fields of a flat cell, the default first.
    pub const ALL: [Self; 7] = [
        Self::FibreStrain,
        Self::CrossStrain,
        Self::AreaRatio,
        Self::ActiveStress,
        Self::Displacement,
        Self::Traction,
        Self::Potential,
    ];

    /// Fields of a thick cell, the default first.
    pub const THICK: [Self; 5] = [
        Self::FibreStrain,
        Self::CrossStrain,
        Self::VolumeRatio,
        Self::ActiveStress,
        Self::Displacement,
    ];

    /// What shows most of frames: the potential where it differs from place to place, else the strain along the fibre.
    pub fn most_telling(frames: &[&Frame]) -> Self {
        let spreads = !frames.is_empty() && Self::Potential.is_known(frames, false);
        if spreads { Self::Potential } else { Self::default() }
    }

    /// Whether frames have it: active stress only those of a simulated cell, tractions only those of one on a gel, potentials only those
    /// of a tissue.
    pub fn is_known<const D: usize>(self, frames: &[&Frame<D>], has_tension: bool) -> bool {
        match self {
            Self::ActiveStress => has_tension,
            Self::Traction => frames.iter().all(|frame| frame.on_gel_nn.is_some()),
            Self::Potential => frames.iter().all(|frame| frame.potential_mv.is_some()),
            _ => true,
        }
    }

    /// What a thick cell is coloured by in space where a flat one is coloured by this; the default if it has nothing like it.
    #[must_use]
    pub fn in_space(self) -> Self {
        match self {
            Self::AreaRatio => Self::VolumeRatio,
            known if Self::THICK.contains(&known) => known,
            _ => Self::default(),
        }
    }

    /// Its name in options and files.
    pub const fn word(self) -> &'static str {
        match self {
            Self::FibreStrain => "fibre-strain",
            Self::CrossStrain => "cross-strain",
            Self::AreaRatio => "area-ratio",
            Self::VolumeRatio => "volume-ratio",
            Self::ActiveStress => "active-stress",
            Self::Displacement => "displacement",
            Self::Traction => "traction",
            Self::Potential => "potential",
        }
    }

    /// Its title in figures.
    pub const fn title(self) -> &'static str {
        match self {
            Self::FibreStrain => "Fibre strain",
            Self::CrossStrain => "Strain across the fibre",
            Self::AreaRatio => "Area over area at rest",
            Self::VolumeRatio => "Volume over volume at rest",
            Self::ActiveStress => "Active stress",
            Self::Displacement => "Displacement",
            Self::Traction => "Traction on the gel",
            Self::Potential => "Membrane potential",
        }
    }

    /// Its unit, ASCII; empty for a pure number.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::FibreStrain | Self::CrossStrain => "%",
            Self::AreaRatio | Self::VolumeRatio => "",
            Self::ActiveStress => "kPa",
            Self::Displacement => "um",
            Self::Traction => "Pa",
            Self::Potential => "mV",
        }
    }

    /// Its definition, in a sentence.
    pub const fn definition(self) -> &'static str {
        match self {
            Self::FibreStrain => {
                "change of length along the fibre, per cent of the length at rest; negative where shorter"
            }
            Self::CrossStrain => {
                "change of length of what lies across the fibre at rest, per cent; positive where wider"
            }
            Self::AreaRatio => "projected area over that at rest; below 1 where smaller",
            Self::VolumeRatio => "volume over that at rest; below 1 where smaller",
            Self::ActiveStress => "active tension along the fibre times the content of myofibrils",
            Self::Displacement => "distance from the position at rest",
            Self::Traction => {
                "force on the gel per area of the cell at rest, whatever its direction"
            }
            Self::Potential => "membrane potential of each place",
        }
    }

    /// Its value in a cell at rest without tension; of the potential, about that of a ventricular cell.
    pub const fn at_rest(self) -> f64 {
        match self {
            Self::Potential => -84.0,
            Self::AreaRatio | Self::VolumeRatio => 1.0,
            _ => 0.0,
        }
    }

    /// Whether its values lie on both sides of that at rest.
    pub const fn is_two_sided(self) -> bool {
        !matches!(self, Self::ActiveStress | Self::Displacement | Self::Traction | Self::Potential)
    }

    /// The narrowest range of a colour scale: smaller differences are rounding errors or
    /// negligible.
    pub const fn least_range(self) -> f64 {
        match self {
            Self::FibreStrain | Self::CrossStrain | Self::ActiveStress | Self::Traction => 1.0,
            Self::AreaRatio | Self::VolumeRatio => 0.01,
            Self::Displacement => 0.1,
            Self::Potential => 20.0,
        }
    }

    /// Limits of a colour scale for these values; they always include the value at rest.
    ///
    /// # Example
    /// ```
    /// use myospring::output::field::Field;
    /// assert_eq!(Field::FibreStrain.limits([-12.0, 1.5, f64::NAN]), [-12.0, 1.5]);
    /// // A cell that does not move has the colour of rest.
    /// assert_eq!(Field::FibreStrain.limits([0.0]), [-1.0, 0.0]);
    /// assert_eq!(Field::AreaRatio.limits([0.9]), [0.9, 1.0]);
    /// assert_eq!(Field::ActiveStress.limits([20.0, 50.0]), [0.0, 50.0]);
    /// ```
    pub fn limits(self, values: impl IntoIterator<Item = f64>) -> [f64; 2] {
        let rest = self.at_rest();
        let [low, high] = values
            .into_iter()
            .filter(|value| value.is_finite())
            .fold([rest; 2], |[low, high], value| [low.min(value), high.max(value)]);
        let least = self.least_range();
        if self.is_two_sided() {
            [low.min(high - least), high]
        } else {
            [low, high.max(low + least)]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_is_of_one_field() {
        let words: std::collections::BTreeSet<_> =
            Field::ALL.iter().chain(&Field::THICK).map(|field| field.word()).collect();
        assert_eq!(words.len(), Field::ALL.len() + 1);
    }
}
