//! Shared parts of the figures of many members of a study.

mod distributions;
mod responses;
mod scatter;
mod trace_bands;

pub use distributions::{Distribution, distributions};
pub use responses::{MemberResponse, ResponseMap, response_map, responses};
pub use scatter::{Scatter, scatter};
pub use trace_bands::{QUANTILES, TraceBand, trace_bands};

use super::font::text_width;
use super::sheet::{Look, Sheet, Stroke, Style};
use super::theme::{CURVE_WIDTH, Colour, INK, TICK};

/// One quantity of all members.
#[derive(Debug, Clone, PartialEq)]
pub struct Numbers {
    /// Its name and unit: `Peak shortening (%)`.
    pub label: String,
    /// One value per member; NaN if it has none.
    pub values: Vec<f64>,
}

impl Numbers {
    fn finite(&self) -> impl Iterator<Item = f64> {
        self.values.iter().copied().filter(|value| value.is_finite())
    }
}

/// Smallest and largest value; `None` without values.
fn ends(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let both = |[low, high]: [f64; 2], [value, _]: [f64; 2]| [low.min(value), high.max(value)];
    values.filter(|value| value.is_finite()).map(|value| [value, value]).reduce(both)
}

/// Quantile of sorted values, interpolated; NaN without values.
fn quantile(sorted: &[f64], part: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = part.clamp(0.0, 1.0) * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// Colour of rejected members.
const REJECTED: Colour = Colour(0xb8b8b8);

/// A mark of the legend.
enum Mark {
    Patch(Colour),
    Line(Colour),
    Dashed(Colour),
    None,
}

/// Draws a legend from its upper left corner, in rows as wide as there is room; returns its height,
/// px.
fn legend(sheet: &mut Sheet, [left, top]: [f64; 2], right: f64, entries: &[(Mark, String)]) -> f64 {
    let [mut x, mut y] = [left, top];
    for (mark, words) in entries {
        let swatch = match mark {
            Mark::None => 0.0,
            Mark::Patch(_) => 13.0,
            Mark::Line(_) | Mark::Dashed(_) => 24.0,
        };
        let width = swatch + text_width(words, TICK) + 16.0;
        if x > left && x + width - 16.0 > right {
            (x, y) = (left, y + 14.0);
        }
        let middle = y + 7.0;
        let line = |colour| Stroke::new(colour, CURVE_WIDTH);
        match *mark {
            Mark::None => {}
            Mark::Patch(colour) => sheet.rect([x, y + 2.5], [9.0, 9.0], Look::fill(colour)),
            Mark::Line(colour) => sheet.line([x, middle], [x + 18.0, middle], line(colour)),
            Mark::Dashed(colour) => {
                sheet.line([x, middle], [x + 18.0, middle], line(colour).dash(3.0, 2.0));
            }
        }
        sheet.text([x + swatch, y + 10.5], words, Style::new(TICK).colour(INK));
        x += width;
    }
    y + 14.0 - top
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_lie_between_neighbours() {
        let sorted = [1.0, 2.0, 4.0];
        assert_eq!([0.0, 0.25, 0.5, 1.0].map(|part| quantile(&sorted, part)), [1.0, 1.5, 2.0, 4.0]);
        assert!(quantile(&[], 0.5).is_nan());
    }
}
