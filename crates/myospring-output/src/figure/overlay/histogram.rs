//! Histogram of sarcomere lengths, below the panels.

use super::super::chart::{Axis, Chart};
use super::super::sheet::{Look, Sheet, Stroke, Style};
use super::super::theme::{AXIS_WIDTH, INK, LABEL, LETTER, MUTED, TICK, WHITE, fixed};
use super::{FIBRE, Sarcomeres};

/// Width of a bar, um.
const BAR_UM: f64 = 0.025;
/// Smallest range of the axis, um, so that figures of several cells can be compared: lengths of
/// sarcomeres at rest.
const USUAL_UM: [f64; 2] = [1.4, 2.4];
/// Size of the plot, px.
const SIZE: [f64; 2] = [300.0, 56.0];
/// Height above the plot for its title, and below it for its axis, px.
const ABOVE: f64 = 26.0;
const BELOW: f64 = 38.0;

/// Draws the histogram with its median, from an upper left corner; returns its lower end, px.
pub(super) fn draw_histogram(
    sheet: &mut Sheet,
    sarcomeres: &Sarcomeres<'_>,
    letter: &str,
    [left, top]: [f64; 2],
) -> f64 {
    let lengths: Vec<f64> =
        sarcomeres.lengths_um.iter().copied().filter(|length| length.is_finite()).collect();
    if lengths.is_empty() || !sarcomeres.median_um.is_finite() {
        return top;
    }
    let bin = |length: f64| (length / BAR_UM).floor() as i64;
    let [mut first, mut last] = USUAL_UM.map(|length| (length / BAR_UM).round() as i64);
    // Lengths that no sarcomere has are counted in the outer bars instead of widening the axis.
    let bounds = [bin(1.0), bin(4.0)];
    for length in &lengths {
        let at = bin(*length).clamp(bounds[0], bounds[1]);
        (first, last) = (first.min(at), last.max(at + 1));
    }
    let mut counts = vec![0_usize; (last - first) as usize];
    for length in &lengths {
        counts[(bin(*length).clamp(first, last - 1) - first) as usize] += 1;
    }
    let share = |count: usize| 100.0 * count as f64 / lengths.len() as f64;
    let highest = counts.iter().copied().max().map_or(0.0, share);
    let range = [first, last].map(|bin| bin as f64 * BAR_UM);
    let x =
        Axis { label: "Sarcomere length (\u{b5}m)".to_owned(), range, step: 0.2, labelled: true };
    let y = Axis::values("Share (%)", [0.0, highest], SIZE[1]);
    let mut chart = Chart::new(top + ABOVE, SIZE[1], [x, y], Vec::new());
    let offset = chart.label_offset();
    (chart.place[0], chart.size[0]) = (left + offset + 10.0, SIZE[0]);
    for (count, at) in counts.into_iter().zip(first..) {
        let [from, to] = [at, at + 1].map(|bin| bin as f64 * BAR_UM);
        let ([x, upper], [right, lower]) = (chart.at([from, share(count)]), chart.at([to, 0.0]));
        if count > 0 {
            let look = Look::fill(FIBRE).stroke(Stroke::new(WHITE, 0.4));
            sheet.rect([x, upper], [right - x, lower - upper], look);
        }
    }
    chart.draw(sheet, offset);
    let [_, high] = chart.y.range;
    let median = sarcomeres.median_um.clamp(range[0], range[1]);
    let stroke = Stroke::new(INK, 1.5 * AXIS_WIDTH);
    sheet.line(chart.at([median, 0.0]), chart.at([median, high]), stroke);
    let head = [left, chart.place[1] - 9.0];
    sheet.text(head, letter, Style::new(LETTER).bold());
    let title = "Sarcomere length at rest, as the picture shows it";
    sheet.text([head[0] + 16.0, head[1]], title, Style::new(LABEL));
    let beside = [chart.place[0] + SIZE[0] + 16.0, chart.place[1] + 14.0];
    let words = format!("median {} \u{b5}m", fixed(sarcomeres.median_um, 2));
    sheet.text(beside, &words, Style::new(LETTER).bold());
    let count = format!("n = {} triangles of the lattice", lengths.len());
    sheet.text([beside[0], beside[1] + 16.0], &count, Style::new(TICK).colour(MUTED));
    let read = format!("{} % of the cell read", fixed(sarcomeres.read_pct, 0));
    sheet.text([beside[0], beside[1] + 30.0], &read, Style::new(TICK).colour(MUTED));
    top + ABOVE + SIZE[1] + BELOW
}
