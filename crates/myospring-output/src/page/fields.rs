//! What the cell can be coloured by, each with one scale of colours for all frames of a run.

use super::display::Display;
use crate::digits::rounded;
use crate::field::{ColourScale, Field, Fields};
use myospring_core::analysis::order::quantile;
use myospring_core::recording::Frame;
use serde::Serialize;

/// Colours of a scale, from its low end to its high one.
const STOPS: usize = 33;

/// Part of the cell, at either end of a scale, that may be single places where a film was followed badly.
const OUTLIERS: f64 = 0.01;

#[derive(Debug, Serialize)]
pub(super) struct FieldData {
    key: &'static str,
    name: &'static str,
    unit: &'static str,
    definition: &'static str,
    /// Ends of the scale of colours.
    pub(super) low: f64,
    pub(super) high: f64,
    colours: Vec<String>,
    extremes: [f64; 2],
}

/// All fields of a cell that these frames have.
pub(super) fn of(
    fields: &Fields<'_>,
    display: &Display,
    frames: &[&Frame],
    has_tension: bool,
) -> Vec<FieldData> {
    let known = Field::ALL.into_iter().filter(|field| field.is_known(frames, has_tension));
    let means = |field, frame| {
        let mut values = display.means(&fields.on_triangles(field, frame));
        values.truncate(display.within);
        values
    };
    known.map(|field| data(field, frames.iter().map(|frame| means(field, frame)))).collect()
}

/// A field with these values in each frame.
pub(super) fn data(field: Field, frames: impl Iterator<Item = Vec<f64>>) -> FieldData {
    let nothing = [f64::INFINITY, f64::NEG_INFINITY];
    let (mut extremes, mut most_places) = (nothing, nothing);
    for values in frames {
        let wider = |[low, high]: [f64; 2], part: f64| {
            let ends = [part, 1.0 - part].map(|part| quantile(values.iter().copied(), part));
            [low.min(ends[0].unwrap_or(low)), high.max(ends[1].unwrap_or(high))]
        };
        extremes = wider(extremes, 0.0);
        most_places = wider(most_places, OUTLIERS);
    }
    let [low, high] = field.limits(ends(field, extremes, most_places));
    let colours = ColourScale::new(field, [low, high]).steps(STOPS).into_iter();
    let colours = colours.map(|[red, green, blue]| format!("#{red:02x}{green:02x}{blue:02x}"));
    FieldData {
        key: field.word(),
        name: field.title(),
        unit: field.unit(),
        definition: field.definition(),
        low: rounded(low),
        high: rounded(high),
        colours: colours.collect(),
        extremes: extremes.map(rounded),
    }
}

/// The values between which the colours of a field change. A few places that are more than twice as far from rest as
/// all others have the colour of the end, so that the others differ in colour.
fn ends(field: Field, extremes: [f64; 2], most_places: [f64; 2]) -> [f64; 2] {
    let rest = field.at_rest();
    std::array::from_fn(|end| {
        let [all, most] = [extremes[end], most_places[end]];
        if (all - rest).abs() < 1e-3 * field.least_range() {
            // Rounding errors are no strain.
            rest
        } else if (all - rest).abs() > 2.0 * (most - rest).abs().max(field.least_range()) {
            most
        } else {
            all
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_places_far_from_all_others_do_not_set_the_scale() {
        let ends = |extremes, most| ends(Field::FibreStrain, extremes, most);
        assert_eq!(ends([-55.0, 106.0], [-14.0, 3.0]), [-14.0, 3.0]);
        // A strain that grows evenly towards one end of the cell is drawn whole.
        assert_eq!(ends([-20.0, 4.0], [-12.0, 2.5]), [-20.0, 4.0]);
        assert_eq!(ends([-12.0, 1e-9], [-11.0, 1e-9]), [-12.0, 0.0]);
        // All of a cell that does not move is within the narrowest scale.
        assert_eq!(ends([-0.1, 0.2], [0.0, 0.0]), [-0.1, 0.2]);
    }
}
