//! One run in one picture: the cell at rest and at its peak beside its curves.

use super::moments::key_shapes;
use super::shapes::Gallery;
use super::svg::{Sheet, Style};
use super::theme::{DOUBLE, LABEL, LETTER, MUTED, SHORTENING, TICK};
use super::traces::{ACTIVE_TENSION, Quantity, Stack, potential};
use super::{Figure, FigureError};
use crate::mesh::Mesh;
use crate::recording::Recording;

/// The cell at rest and most shortened beside potential, active tension and shortening.
///
/// `fibre` as in [`cell_shapes`](super::cell_shapes). Width: two columns, 178 mm; at 200 dpi the
/// PNG is 1402 pixels wide.
///
/// # Errors
/// A recording without samples or frames, or frames that [`cell_shapes`](super::cell_shapes)
/// refuses.
pub fn overview(
    mesh: &Mesh,
    recording: &Recording,
    fibre: [f64; 2],
    stimulus_times_ms: &[f64],
) -> Result<Figure, FigureError> {
    let mut shapes = key_shapes(recording, stimulus_times_ms);
    shapes.retain(|shape| matches!(shape.name.as_str(), "at rest" | "peak" | "end of record"));
    let gallery = Gallery::new(mesh, &shapes, fibre)?;
    let shortening = Quantity {
        label: "Shortening (%)",
        unit: "%",
        colour: SHORTENING,
        value: |sample| sample.shortening_pct,
    };
    let mut sheet = Sheet::default();
    let left = 402.0;
    let stack = Stack {
        recording,
        quantities: &[potential(recording), ACTIVE_TENSION, shortening],
        stimulus_times_ms,
        place: [left, 18.0],
        size: [DOUBLE - left - 13.0, 80.0],
        gap: 14.0,
        letter: 'B',
    };
    let bottom = stack.draw(&mut sheet)?;

    // The shapes share the height beside the curves, with the colour bar below.
    let (margin, width, head, foot) = (8.0, 318.0, 34.0, 48.0);
    let count = shapes.len() as f64;
    let room = (bottom - 12.0 - foot) / count - head;
    let scale = gallery.scale_into([width, room]);
    let height = gallery.extent()[1] * scale;
    let pitch = (bottom - 12.0 - foot) / count;
    sheet.text([margin, 20.0], "A", Style::new(LETTER).bold());
    for index in 0..shapes.len() {
        let top = 8.0 + index as f64 * pitch;
        let [name, moment, shortening] = gallery.notes(index);
        sheet.text([margin + 16.0, top + 12.0], &name, Style::new(LABEL));
        let facts = [moment, shortening].into_iter().filter(|text| !text.is_empty());
        let facts = facts.collect::<Vec<_>>().join(", ");
        sheet.text([margin + 16.0, top + 25.0], &facts, Style::new(TICK).colour(MUTED));
        let middle = top + head + (pitch - head).min(height + 24.0) / 2.0;
        gallery.draw(&mut sheet, index, [margin + width / 2.0, middle], scale);
    }
    gallery.draw_scale_bar(&mut sheet, [margin, bottom - 26.0], scale);
    gallery.draw_colour_bar(&mut sheet, [margin + width - 172.0, bottom - 30.0], 164.0);
    Ok(sheet.finish(DOUBLE, bottom))
}
