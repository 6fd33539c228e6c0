//! What the cell can be coloured by, each with one scale of colours for all frames of a run.

use super::display::Display;
use crate::digits::rounded;
use crate::field::{ColourScale, Field, Fields};
use myospring_core::recording::Frame;
use serde::Serialize;

/// Colours of a scale, from its low end to its high one.
const STOPS: usize = 33;

#[derive(Debug, Serialize)]
pub(super) struct FieldData {
    key: &'static str,
    name: &'static str,
    unit: &'static str,
    definition: &'static str,
    low: f64,
    high: f64,
    colours: Vec<String>,
    extremes: [f64; 2],
}

/// All fields of a cell over these frames; its active stress only where the frames have it.
pub(super) fn of(
    fields: &Fields<'_>,
    display: &Display,
    frames: &[&Frame],
    has_tension: bool,
) -> Vec<FieldData> {
    let known = Field::ALL.into_iter().filter(|field| has_tension || *field != Field::ActiveStress);
    known.map(|field| data(field, fields, display, frames)).collect()
}

fn data(field: Field, fields: &Fields<'_>, display: &Display, frames: &[&Frame]) -> FieldData {
    let mut extremes = [f64::INFINITY, f64::NEG_INFINITY];
    for frame in frames {
        let values = display.means(&fields.on_triangles(field, frame));
        for value in &values[..display.within] {
            extremes = [extremes[0].min(*value), extremes[1].max(*value)];
        }
    }
    // What is left of rounding is no strain, and its digits no end of a scale.
    let rest = field.at_rest();
    let seen = extremes
        .map(|end| if (end - rest).abs() < 1e-3 * field.least_range() { rest } else { end });
    let [low, high] = field.limits(seen);
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
