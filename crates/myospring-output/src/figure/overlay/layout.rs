//! Arranges the panels on their sheet, with legend and warnings.

use super::super::facets::check_mesh;
use super::super::font::text_width;
use super::super::shapes::draw_scale_bar;
use super::super::sheet::{Look, Sheet, Stroke, Style};
use super::super::theme::{Colour, DOUBLE, INK, LABEL, LETTER, MUTED, TENSION, TICK, mm};
use super::super::{Figure, FigureError};
use super::histogram::draw_histogram;
use super::panel::{Panel, View};
use super::{CHOSEN, FIBRE, OTHER, Overlay, STAND_IN};
use crate::digits::point;
use crate::field::FieldError;

/// Space around the panels and between them, px.
const MARGIN: f64 = 8.0;
/// Height of the line above a panel, and of the one below, px.
const HEAD: f64 = 18.0;
const FOOT: f64 = 22.0;
/// Pictures with a larger ratio of width to height are stacked.
const WIDE: f64 = 1.6;
/// Greatest height of a panel, px.
const TALLEST: f64 = mm(110.0);
/// Greatest height of the upper of two panels, px.
const TALLEST_ABOVE: f64 = mm(75.0);

/// Draws the picture with its outlines (A), the enlarged chosen cell with lattice and fibres (B),
/// and below, if they were read, the lengths of its sarcomeres.
///
/// Grey values are stretched between percentiles of each panel. Long cells are put below the
/// picture, others beside it. B is left out without lattice and fibres, or if it would hardly
/// differ from A. Width: two columns, 178 mm. Pictures are embedded in the SVG as PNG of at most
/// 1600 pixels a side.
///
/// # Errors
/// A picture without pixels or with another number of values, outlines,
/// fibres or a mesh with numbers that are not finite.
///
/// # Example
/// ```
/// use myospring::mesh::pixel_size::PixelSize;
/// use myospring::output::figure::{CELL, Contour, Overlay, overlay};
/// let square = [[5.0, 5.0], [15.0, 5.0], [15.0, 15.0], [5.0, 15.0]];
/// let cell = Contour { name: "1", rings: vec![&square], chosen: true };
/// let picture = vec![0.0; 40 * 40];
/// let figure = overlay(&Overlay {
///     title: "a square",
///     width: 40,
///     height: 40,
///     values: &picture,
///     pixel_size: PixelSize::new(0.5)?,
///     cells: &[cell],
///     chosen: CELL,
///     mesh: None,
///     fibres: &[],
///     sarcomeres: None,
///     warnings: &[],
/// })?;
/// assert!(figure.to_svg().contains("data:image/png;base64,"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn overlay(overlay: &Overlay<'_>) -> Result<Figure, FigureError> {
    check(overlay)?;
    let mut sheet = Sheet::default();
    let mut top = MARGIN - 4.0;
    if !overlay.title.is_empty() {
        sheet.text([MARGIN, top + 11.0], overlay.title, Style::new(LABEL));
        top += 18.0;
    }
    let whole = View::whole([overlay.width, overlay.height], overlay.pixel_size.um());
    let close = close_up(overlay, whole);
    let (panels, bottom) = arranged(whole, close, top);
    for (panel, letter) in panels.iter().zip(["A", "B"]) {
        let head = [panel.place[0], panel.place[1] - HEAD + 11.0];
        let of_two = panels.len() > 1;
        if of_two {
            sheet.text(head, letter, Style::new(LETTER).bold());
        }
        let caption = caption(overlay, letter, of_two);
        let inset = if of_two { 16.0 } else { 0.0 };
        sheet.text([head[0] + inset, head[1]], caption, Style::new(LABEL));
        let detail = !of_two || letter == "B";
        panel.draw(&mut sheet, overlay, detail, letter)?;
        if of_two && !detail {
            panel.draw_frame(&mut sheet, panels[1].view, "B");
        }
        let [width, height] = panel.size();
        let below = [panel.place[0], panel.place[1] + height + 11.0];
        let extent = [width / panel.scale, height / panel.scale];
        draw_scale_bar(&mut sheet, below, panel.scale, extent);
    }
    let bottom = draw_legend(&mut sheet, overlay, bottom);
    let letter = if panels.len() > 1 { "C" } else { "B" };
    let bottom = overlay.sarcomeres.map_or(bottom, |sarcomeres| {
        draw_histogram(&mut sheet, &sarcomeres, letter, [MARGIN, bottom])
    });
    let bottom = draw_warnings(&mut sheet, overlay.warnings, bottom);
    Ok(sheet.finish(DOUBLE, bottom + 4.0))
}

fn caption(overlay: &Overlay<'_>, letter: &str, of_two: bool) -> &'static str {
    match (letter, overlay.mesh.is_some(), overlay.fibres.is_empty()) {
        _ if overlay.cells.is_empty() && !of_two && overlay.mesh.is_none() => "Picture",
        ("A", ..) if of_two || overlay.mesh.is_none() => "Picture and outline",
        (_, true, true) => "Lattice",
        (_, true, false) => "Lattice and fibres",
        (_, false, false) => "Fibres",
        (_, false, true) => "Chosen cell",
    }
}

fn check(overlay: &Overlay<'_>) -> Result<(), FigureError> {
    let (width, height, found) = (overlay.width, overlay.height, overlay.values.len());
    if width == 0 || height == 0 {
        return Err(FigureError::Nothing { what: "pixels" });
    }
    if width.checked_mul(height) != Some(found) {
        return Err(FigureError::PictureShape { width, height, found });
    }
    for cell in overlay.cells {
        for (node, &[x, y]) in cell.rings.iter().flat_map(|ring| ring.iter()).enumerate() {
            if !(x.is_finite() && y.is_finite()) {
                let what = format!("the outline of cell \"{}\"", cell.name);
                return Err(FigureError::NotFinite { what, node, at: point(&[x, y]) });
            }
        }
    }
    for (node, tick) in overlay.fibres.iter().enumerate() {
        let ([x, y], [along_x, along_y]) = (tick.point_um, tick.direction);
        if !(x.is_finite() && y.is_finite()) {
            let (what, at) = ("the fibre field".to_owned(), point(&[x, y]));
            return Err(FigureError::NotFinite { what, node, at });
        }
        let length = along_x.hypot(along_y);
        if !(length.is_finite() && length > 0.0) {
            return Err(FieldError::Fibre { direction: point(&tick.direction) }.into());
        }
    }
    overlay.mesh.map_or(Ok(()), check_mesh)
}

/// The part of the picture around the chosen cell, if it is small enough for a panel of its own.
fn close_up(overlay: &Overlay<'_>, whole: View) -> Option<View> {
    let rings = overlay.cells.iter().filter(|cell| cell.chosen).flat_map(|cell| &cell.rings);
    let mut points: Vec<[f64; 2]> = rings.flat_map(|ring| ring.iter().copied()).collect();
    if let Some(mesh) = overlay.mesh {
        points.extend((0..mesh.len()).map(|node| mesh.point(node)));
    }
    let view = View::around(&points, whole, overlay.pixel_size.um())?;
    let gain = (whole.extent()[0] / view.extent()[0]).min(whole.extent()[1] / view.extent()[1]);
    let more_to_show = overlay.mesh.is_some() || !overlay.fibres.is_empty();
    (more_to_show || gain > 1.5).then_some(view)
}

/// Arranges panels below `top`; also returns their lower end, px.
fn arranged(whole: View, close: Option<View>, top: f64) -> (Vec<Panel>, f64) {
    let room = DOUBLE - 2.0 * MARGIN;
    let fitted = |view: View, left: f64, top: f64, width: f64, tallest: f64| {
        let [across, up] = view.extent();
        let scale = (width / across).min(tallest / up);
        Panel { view, place: [left, top + HEAD], scale }
    };
    let below = |panel: &Panel| panel.place[1] + panel.size()[1] + FOOT;
    let Some(close) = close else {
        let panel = fitted(whole, MARGIN, top, room, TALLEST);
        let bottom = below(&panel);
        return (vec![panel], bottom);
    };
    let aspects = [whole, close].map(|view| view.extent()[0] / view.extent()[1]);
    if aspects[0].max(aspects[1]) > WIDE {
        let first = fitted(whole, MARGIN, top, room, TALLEST_ABOVE);
        let second = fitted(close, MARGIN, below(&first), room, TALLEST);
        let bottom = below(&second);
        return (vec![first, second], bottom);
    }
    // Side by side with equal heights.
    let height = ((room - 12.0) / (aspects[0] + aspects[1])).min(TALLEST);
    let first = fitted(whole, MARGIN, top, room, height);
    let left = MARGIN + first.size()[0] + 12.0;
    let second = fitted(close, left, top, room, height);
    let bottom = below(&first).max(below(&second));
    (vec![first, second], bottom)
}

/// Draws the legend of the lines, each on a chip as dark as the picture; returns its lower end, px.
fn draw_legend(sheet: &mut Sheet, overlay: &Overlay<'_>, top: f64) -> f64 {
    let any = |chosen: bool| overlay.cells.iter().any(|cell| cell.chosen == chosen);
    let tick = |from: bool| overlay.fibres.iter().any(|tick| tick.from_picture == from);
    let several = overlay.cells.iter().filter(|cell| cell.chosen).count() > 1;
    let chosen = overlay.chosen[usize::from(several)];
    let entries = [
        (any(true), CHOSEN, 1.6, chosen),
        (any(false), OTHER, 1.6, "other cells"),
        (overlay.mesh.is_some(), Colour(0xa6a6a6), 0.8, "lattice"),
        (tick(true), FIBRE, 1.8, "fibre (faint: less certain)"),
        (tick(false), STAND_IN, 1.4, "fibre assumed, not from the picture"),
    ];
    let shown = entries.into_iter().filter(|entry| entry.0);
    let shown = shown.map(|(_, colour, thick, words)| (Stroke::new(colour, thick), words));
    draw_lines_legend(sheet, [MARGIN, DOUBLE - MARGIN], top, shown)
}

/// Draws lines with their words between two sides, each line on a chip as dark as a picture; returns the lower end, px.
pub(in super::super) fn draw_lines_legend<'w>(
    sheet: &mut Sheet,
    [left, right]: [f64; 2],
    top: f64,
    entries: impl Iterator<Item = (Stroke, &'w str)>,
) -> f64 {
    let (mut x, mut y) = (left, top + 8.0);
    for (stroke, words) in entries {
        let width = 24.0 + text_width(words, TICK);
        if x > left && x + width > right {
            (x, y) = (left, y + 15.0);
        }
        sheet.rect([x, y - 8.0], [19.0, 10.0], Look::fill(Colour(0x333333)));
        sheet.line([x + 2.5, y - 3.0], [x + 16.5, y - 3.0], stroke);
        sheet.text([x + 23.0, y + 0.5], words, Style::new(TICK).colour(MUTED));
        x += width + 12.0;
    }
    if x > left { y + 8.0 } else { top }
}

/// Draws warnings in lines as wide as the figure; returns their lower end, px.
fn draw_warnings(sheet: &mut Sheet, warnings: &[String], top: f64) -> f64 {
    let mut y = top;
    for warning in warnings {
        let mut line = String::new();
        let mut first = true;
        let mut flush = |line: &mut String| {
            y += 14.0;
            if first {
                sheet.rect([MARGIN, y - 7.0], [6.0, 6.0], Look::fill(TENSION));
            }
            first = false;
            sheet.text([MARGIN + 11.0, y], line, Style::new(TICK).colour(INK));
            line.clear();
        };
        for word in warning.split_whitespace() {
            let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
            if !line.is_empty() && text_width(&longer, TICK) > DOUBLE - 2.0 * MARGIN - 11.0 {
                flush(&mut line);
                word.clone_into(&mut line);
            } else {
                line = longer;
            }
        }
        if !line.is_empty() {
            flush(&mut line);
        }
    }
    if warnings.is_empty() { top } else { y + 5.0 }
}
