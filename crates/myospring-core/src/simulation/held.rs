//! A tension stored from one exchange to the next.

use crate::mechanics::Tension;

/// A tension with its own memory, kPa.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Held {
    Uniform(f64),
    PerElement(Vec<f64>),
}

impl Held {
    /// A copy of a tension.
    pub(super) fn of(tension: Tension<'_>) -> Self {
        match tension {
            Tension::Uniform(tension) => Self::Uniform(tension),
            Tension::PerElement(list) => Self::PerElement(list.to_vec()),
            Tension::Following(law) => Self::PerElement(law.tension.to_vec()),
        }
    }

    /// In the form that the forces need.
    pub(super) fn tension(&self) -> Tension<'_> {
        match self {
            Self::Uniform(tension) => Tension::Uniform(*tension),
            Self::PerElement(list) => Tension::PerElement(list),
        }
    }

    /// Whether there is none anywhere.
    pub(super) fn is_zero(&self) -> bool {
        match self {
            Self::Uniform(tension) => *tension == 0.0,
            Self::PerElement(list) => list.iter().all(|tension| *tension == 0.0),
        }
    }

    /// One for each triangle, where they differ.
    pub(super) fn by_element(&self) -> Option<&[f64]> {
        match self {
            Self::Uniform(_) => None,
            Self::PerElement(list) => Some(list),
        }
    }

    /// The mean of this and another.
    pub(super) fn mean(&self, other: &Self) -> Self {
        match (self, other) {
            (Self::Uniform(a), Self::Uniform(b)) => Self::Uniform(0.5 * (a + b)),
            (Self::PerElement(list), _) | (_, Self::PerElement(list)) => {
                let [a, b] = [self.tension(), other.tension()];
                Self::PerElement((0..list.len()).map(|e| 0.5 * (a.at(e) + b.at(e))).collect())
            }
        }
    }

    /// The tension, kPa; where it differs from place to place, the mean weighted by these volumes.
    pub(super) fn average(&self, volumes: &[f64]) -> f64 {
        match self {
            Self::Uniform(tension) => *tension,
            Self::PerElement(list) => {
                let whole: f64 = volumes.iter().sum();
                list.iter().zip(volumes).map(|(t, v)| t * v).sum::<f64>() / whole
            }
        }
    }
}
