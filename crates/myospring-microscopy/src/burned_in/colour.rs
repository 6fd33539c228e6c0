//! Marks in a colour that the picture itself does not have.
//!
//! A camera records grey values, and a program shows them in grey or in shades of one colour: all
//! pixels lie on one line through black in the space of red, green and blue. A mark in another
//! colour lies off that line, whatever its shape, even after lossy compression.

use crate::filter::quantile;
use crate::plane::Plane;
use crate::region::{Connectivity, Region};

/// Distance from the line, as a part of the largest value, up to which a pixel counts as on it
/// (rounding, compression).
const ON_LINE: f32 = 0.06;
/// Distance from which a pixel counts as drawn.
const DRAWN: f32 = 0.15;
/// Least part of the pixels on the line. With fewer, the picture shows several stains or comes from
/// a colour camera.
const MOST: f64 = 0.93;
/// Least number of drawn pixels; fewer are noise.
const LEAST_PIXELS: usize = 8;
/// Pixels brighter than this, as a part of the largest value, determine the colour of the line.
const SHOWS_COLOUR: f32 = 0.1;

/// The pixels in a colour other than the picture's; `None` if there are none, or if the picture has
/// several colours.
pub(super) fn drawn(channels: &[Plane; 3]) -> Option<Region> {
    let [red, green, blue] = channels.each_ref().map(Plane::values);
    let pixels = || red.iter().zip(green).zip(blue).map(|((&r, &g), &b)| [r, g, b]);
    let largest = pixels().flatten().fold(0.0, f32::max);
    let length = |colour: [f32; 3]| colour.iter().map(|part| part * part).sum::<f32>().sqrt();
    let bright = pixels().filter(|&colour| length(colour) > SHOWS_COLOUR * largest);
    let stride = (red.len() / 100_000).max(1) | 1;
    let shades: Vec<[f32; 3]> =
        bright.step_by(stride).map(|colour| colour.map(|part| part / length(colour))).collect();
    if shades.is_empty() {
        return None;
    }
    // Most pixels have the colour of the line, so the others do not change the median.
    let median = |part: usize| {
        let parts: Vec<f32> = shades.iter().map(|shade| shade[part]).collect();
        quantile(&parts, 0.5)
    };
    let line = [median(0), median(1), median(2)];
    let unit = line.map(|part| part / length(line));
    let off = |colour: [f32; 3]| {
        let along: f32 = colour.iter().zip(unit).map(|(part, unit)| part * unit).sum();
        length([0, 1, 2].map(|part: usize| colour[part] - along * unit[part]))
    };
    let off: Vec<f32> = pixels().map(off).collect();
    let on_line = off.iter().filter(|&&off| off <= ON_LINE * largest).count();
    if (on_line as f64) < MOST * off.len() as f64 {
        return None;
    }
    let [first, ..] = channels;
    let drawn =
        Region::new(first.width(), first.height(), off.iter().map(|&off| off >= DRAWN * largest));
    let drawn = drawn.kept(Connectivity::Eight, |island| island.pixels >= LEAST_PIXELS);
    (drawn.count() > 0).then_some(drawn)
}
