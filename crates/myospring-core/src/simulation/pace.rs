//! How fast a free cell shortens, compared with measured cells.

use super::{Outcome, Ready, Simulation};
use crate::analysis::bands::{self, Band, BandPosition};
use crate::analysis::beats::Beats;
use crate::cell::{CellModel, KnownDeparture};
use crate::mechanics::support::SupportKind;

/// The metric of speed that does not depend on the size of the contraction.
const METRIC: &str = "shortening_rate_over_peak";

/// Peak shortening, per cent, below which the rate over it is not used.
const LITTLE_PCT: f64 = 1.0;

/// By which part a run's rate may exceed that of its model's published beat; stimuli, shapes and
/// materials change it a little.
const MARGIN: f64 = 0.1;

/// The speed of a contraction, compared with measured cells.
#[derive(Debug, Clone, PartialEq)]
pub enum Pace {
    /// As in measured cells, or not comparable: the cell is held, or hardly shortens.
    AsMeasured,
    /// Different, as is known for its model.
    AsItsModel(KnownDeparture),
    /// Different, and not explained by its model.
    Unexplained {
        /// Of the beat that is furthest from the band, 1/s.
        over_peak: f64,
        /// Its largest shortening rate, lengths/s.
        rate: f64,
        /// The band of measured cells, 1/s.
        band: Band,
    },
}

impl Pace {
    /// The pace of the beats of a cell.
    pub fn of(cell: &dyn CellModel, support: SupportKind, beats: &Beats) -> Self {
        let Some(band) = bands::band(METRIC).filter(|_| support == SupportKind::MassCentre) else {
            return Self::AsMeasured;
        };
        let beyond = |ratio: f64| (band.low - ratio).max(ratio - band.high);
        let paces = beats.iter().filter_map(|beat| {
            let enough = beat.value("peak_shortening")? >= LITTLE_PCT;
            enough.then_some((beat.value(METRIC)?, beat.value("maximum_shortening_rate")?))
        });
        let furthest = paces.max_by(|a, b| beyond(a.0).total_cmp(&beyond(b.0)));
        match furthest.map(|(ratio, rate)| (ratio, rate, band.place(ratio))) {
            None | Some((.., BandPosition::In)) => Self::AsMeasured,
            Some((over_peak, rate, place)) => {
                let explains = |known: &KnownDeparture| {
                    let published = known.shortening_rate_over_peak;
                    let further = match place {
                        BandPosition::Below => over_peak < (1.0 - MARGIN) * published,
                        BandPosition::In | BandPosition::Above => {
                            over_peak > (1.0 + MARGIN) * published
                        }
                    };
                    band.place(published) == place && !further
                };
                let known = cell.known_departure().filter(explains);
                known.map_or(Self::Unexplained { over_peak, rate, band: *band }, Self::AsItsModel)
            }
        }
    }

    /// The known property of the cell model that the beats show, in a sentence.
    pub fn about_model(&self) -> Option<String> {
        match self {
            Self::AsItsModel(KnownDeparture { fact, instead, .. }) => {
                Some(format!("{fact}; `--model {instead}` does not."))
            }
            Self::AsMeasured | Self::Unexplained { .. } => None,
        }
    }
}

impl Simulation {
    /// How fast the cell shortened in these beats, compared with measured cells;
    /// [`Pace::AsMeasured`] if its tension is not that of its cell model.
    ///
    /// # Example
    /// ```
    /// use myospring::prelude::*;
    /// use myospring::simulation::Pace;
    /// let mut simulation = Simulation::new(lattice::rectangle(20, 4, 5.0)?);
    /// simulation.numerics.method = Method::QuasiStatic;
    /// let beats = simulation.build()?.run(|_progress| true).beats();
    /// let Pace::AsItsModel(known) = simulation.pace(&beats) else { panic!() };
    /// assert_eq!(known.instead, "land_2017");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn pace(&self, beats: &Beats) -> Pace {
        match self.activation {
            None => Pace::of(&*self.cell, self.support, beats),
            Some(_) => Pace::AsMeasured,
        }
    }
}

impl Ready {
    /// The warning for a free cell whose rate neither measured cells nor its model's published
    /// parameters have.
    pub(super) fn out_of_pace(&self, outcome: &Outcome) -> Option<String> {
        let pace = self.simulation().pace(&outcome.beats());
        let Pace::Unexplained { over_peak, rate, band } = pace else { return None };
        let Band { low, high, .. } = band;
        let than = match band.place(over_peak) {
            BandPosition::Below => "no measured cell shortens this slowly",
            BandPosition::In | BandPosition::Above => "no measured cell shortens this fast",
        };
        Some(format!(
            "{than}: {over_peak:.1} 1/s (largest rate over peak; {rate:.2} lengths/s), unloaded adult ventricular myocytes \
             {low} to {high} 1/s. The parameters of the cell model, or how it is stimulated, make it so; \
             docs/explanation/which-cell-model.md compares the models"
        ))
    }
}
