//! One run in one figure: the cell at rest and at its peak, beside its curves.

use super::cell::DrawnCell;
use super::moments::key_shapes;
use super::shapes::{Gallery, HEAD};
use super::sheet::Sheet;
use super::theme::{DOUBLE, SHORTENING};
use super::traces::{ACTIVE_TENSION, Drives, Quantity, SHORTENING as SHORTENING_CURVE, Stack};
use super::{Figure, FigureError};
use myospring_core::recording::Recording;

/// Draws the cell at rest and at its peak, beside potential and calcium (if it has them), active
/// tension and shortening.
///
/// Width: two columns, 178 mm; at 200 dpi the PNG is 1402 pixels wide.
///
/// # Errors
/// A recording without samples or frames, or frames that [`cell_shapes`](super::cell_shapes)
/// rejects.
pub fn overview(
    cell: &DrawnCell<'_>,
    recording: &Recording,
    stimulus_times_ms: &[f64],
) -> Result<Figure, FigureError> {
    let mut shapes = key_shapes(recording, stimulus_times_ms);
    if !Gallery::new(cell, &shapes)?.is_elongated() {
        // Two shapes of a round cell take the room of four of a long one.
        shapes.retain(|shape| matches!(shape.name.as_str(), "at rest" | "peak" | "end of record"));
    }
    let gallery = Gallery::new(cell, &shapes)?;
    let mut quantities = Drives::of(recording).quantities();
    quantities.push(Quantity { label: "Tension (kPa)".into(), ..ACTIVE_TENSION });
    quantities.push(Quantity { colour: SHORTENING, ..SHORTENING_CURVE });
    let mut sheet = Sheet::default();
    let (margin, width) = (8.0, 318.0);
    let stack = Stack {
        recording,
        quantities: &quantities,
        stimulus_times_ms,
        sides: [margin + width + 24.0, DOUBLE - 4.0],
        top: 18.0,
        height: 86.0,
        gap: 15.0,
        letter: 'B',
    };
    let bottom = stack.draw(&mut sheet)?;

    // The shapes share the height beside the curves, above the colour bar.
    let pitch = (bottom - 62.0) / shapes.len() as f64;
    let scale = gallery.scale_into([width, pitch - HEAD - 8.0]);
    for index in 0..shapes.len() {
        let top = 9.0 + index as f64 * pitch;
        let letter = if index == 0 { "A" } else { "" };
        gallery.draw_row(&mut sheet, index, [margin, top], [width, scale], letter);
    }
    gallery.draw_scale_bar(&mut sheet, [margin, bottom - 26.0], scale);
    gallery.draw_colour_bar(&mut sheet, [margin + width - 172.0, bottom - 30.0], 164.0);
    Ok(sheet.finish(DOUBLE, bottom))
}
