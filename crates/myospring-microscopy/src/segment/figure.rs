//! Recognises a page: a figure with panels, axes and captions, or a plot. Paper has one grey value,
//! brighter than the print, along the whole rim; a camera's picture does not.

use crate::plane::Plane;

/// Least part of the pixels on the frame that have the value of paper.
const RIM: f64 = 0.8;
/// Largest distance of white paper from the largest value, relative to the range (lossy
/// compression).
const WHITE: f32 = 0.01;
/// Least brightness of other paper, relative to the range: the background of a fluorescence picture
/// may also have a single value, but it is dark.
const BRIGHT: f32 = 0.25;
/// Factor for the confidence of all cells on a page.
pub(super) const FACTOR: f64 = 0.3;
/// Why all cells are doubtful.
pub(super) const REASON: &str = "the picture looks like a figure or a page";

/// Warning if a picture is a page.
pub(super) fn note(plane: &Plane) -> Option<String> {
    let (width, height) = (plane.width(), plane.height());
    let [low, high] = plane.range();
    let range = high - low;
    let across = (0..width).flat_map(|column| [(column, 0), (column, height - 1)]);
    let down = (0..height).flat_map(|row| [(0, row), (width - 1, row)]);
    let mut rim: Vec<f32> = across.chain(down).map(|(column, row)| plane.at(column, row)).collect();
    rim.sort_unstable_by(f32::total_cmp);
    let paper = rim[rim.len() / 2];
    let white = paper >= high - WHITE * range;
    let off = if white { WHITE * range } else { 0.0 };
    let alike = rim.iter().filter(|&&value| (value - paper).abs() <= off).count();
    let is_page = paper - low >= BRIGHT * range && alike as f64 >= RIM * rim.len() as f64;
    is_page.then(|| {
        format!(
            "this looks like a figure or a page, not like a microscope's picture: {:.0} % of its rim has one bright grey \
             value. Cut out the panel that shows the cell, without axes and captions, at its own pixel size",
            100.0 * alike as f64 / rim.len() as f64
        )
    })
}
