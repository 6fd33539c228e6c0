//! What a tension that is given, whatever the cell does, cannot tell: how fast a free cell shortens.

use super::{Outcome, Ready};
use crate::analysis::beat;
use crate::cell::minimal::MinimalModel;
use crate::mechanics::support::SupportKind;
use std::any::Any;

/// The metric that tells the shape of a contraction, whatever its size.
const METRIC: &str = "shortening_rate_over_peak";

/// Peak shortening, per cent, below which a rate over it tells nothing.
const LITTLE_PCT: f64 = 1.0;

impl Ready {
    /// A free cell under a tension that does not feel it, whose beat begins faster or slower than measured ones.
    pub(super) fn out_of_pace(&self, outcome: &Outcome) -> Option<String> {
        let simulation = &self.setup().simulation;
        let minimal = (&*simulation.cell as &dyn Any).is::<MinimalModel>();
        let given = simulation.activation.is_none() && minimal;
        if !given || simulation.support != SupportKind::MassCentre {
            return None;
        }
        let band = beat::band(METRIC)?;
        let beats = outcome.beats();
        let off = beats.iter().find_map(|beat| {
            let ratio = beat.value(METRIC)?;
            let enough = beat.value("peak_shortening")? >= LITTLE_PCT;
            let out = enough && !(band.low..=band.high).contains(&ratio);
            out.then(|| Some((ratio, beat.value("maximum_shortening_rate")?)))?
        });
        let (ratio, rate) = off?;
        let name = simulation.cell.name();
        Some(format!(
            "the cell shortens by {rate:.2} lengths/s, {ratio:.1} 1/s over its peak; free cells that were measured \
             have 10.1 and 10.8 1/s. The tension of `{name}` is a curve that follows the action potential and feels \
             neither length nor speed, so this rate is none of a cell; land_2017 feels both (docs/which-cell-model.md)"
        ))
    }
}
