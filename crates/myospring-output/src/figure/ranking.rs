//! Bar charts that rank the importance of parameters, one panel per metric.

use super::FigureError;
use super::font::text_width;
use super::sheet::{Anchor, Figure, Look, Sheet, Stroke, Style};
use super::theme::{
    AXIS_WIDTH, Colour, DOUBLE, HAIR, INK, LABEL, MUTED, POTENTIAL, TICK, decimals, fixed,
    nice_step,
};

/// Number of panels in a row.
const COLUMNS: usize = 3;
/// Distance between bars, px.
const PITCH: f64 = 15.0;
/// Space above and below the bars of a panel, px.
const ABOVE: f64 = 24.0;
const BELOW: f64 = 34.0;
/// Space between panels, px.
const GAP: f64 = 18.0;
/// Space left and right of all panels, px.
const MARGIN: f64 = 8.0;
/// Colour of the effect of a parameter alone, without interactions.
const ALONE: Colour = Colour(0x56b4e9);

/// One panel: a metric and its parameters, the most important first.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranking {
    /// The metric that is explained.
    pub title: String,
    /// Quantity measured by the bars, with its unit.
    pub axis: String,
    /// The bars, the longest first.
    pub bars: Vec<Bar>,
}

/// A bar of a ranking.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// The parameter.
    pub name: String,
    /// Its length, 0 or above.
    pub value: f64,
    /// Half of the 95 % confidence interval.
    pub confidence: f64,
    /// The part of it that the parameter causes alone, without interactions, if known.
    pub alone: Option<f64>,
}

/// Draws rankings, three in a row, two columns of a journal.
///
/// # Errors
/// No ranking, or one without a finite bar.
pub fn rankings(rankings: &[Ranking]) -> Result<Figure, FigureError> {
    let finite = |bar: &Bar| bar.value.is_finite() && bar.confidence.is_finite();
    if rankings.is_empty() || rankings.iter().any(|one| !one.bars.iter().any(finite)) {
        return Err(FigureError::Nothing { what: "rankings with bars" });
    }
    let width = (DOUBLE - 2.0 * MARGIN - GAP * (COLUMNS - 1) as f64) / COLUMNS as f64;
    let mut sheet = Sheet::default();
    let mut top = 0.0;
    for row in rankings.chunks(COLUMNS) {
        let most = row.iter().map(|one| one.bars.len()).max().unwrap_or(0);
        for (column, ranking) in row.iter().enumerate() {
            panel(&mut sheet, ranking, [MARGIN + column as f64 * (width + GAP), top], width, most);
        }
        top += ABOVE + most as f64 * PITCH + BELOW;
    }
    let both = rankings.iter().flat_map(|one| &one.bars).any(|bar| bar.alone.is_some());
    if both {
        let mut x = MARGIN;
        for (colour, words) in [(ALONE, "alone"), (POTENTIAL, "with all interactions")] {
            sheet.rect([x, top + 2.0], [9.0, 9.0], Look::fill(colour));
            sheet.text([x + 13.0, top + 10.0], words, Style::new(TICK).colour(INK));
            x += 28.0 + text_width(words, TICK);
        }
        let whisker = "whiskers: 95 % confidence";
        sheet.text(
            [DOUBLE - MARGIN, top + 10.0],
            whisker,
            Style::new(TICK).anchor(Anchor::End).colour(MUTED),
        );
        top += 18.0;
    }
    Ok(sheet.finish(DOUBLE, top))
}

fn panel(sheet: &mut Sheet, ranking: &Ranking, [left, top]: [f64; 2], width: f64, rows: usize) {
    let names = ranking.bars.iter().map(|bar| text_width(&bar.name, TICK)).fold(0.0, f64::max);
    let names = names.min(0.5 * width) + 6.0;
    let (start, length) = (left + names, width - names - 4.0);
    let end = |bar: &Bar| (bar.value + bar.confidence).max(bar.alone.unwrap_or(0.0));
    let longest = ranking.bars.iter().map(end).filter(|end| end.is_finite()).fold(0.0, f64::max);
    let longest = if longest > 0.0 { longest } else { 1.0 };
    let step = nice_step(longest, 4.0);
    let last = (longest / step).ceil() * step;
    let at = |value: f64| start + length * (value / last).clamp(0.0, 1.0);
    sheet.text([left, top + 13.0], &ranking.title, Style::new(LABEL).bold());
    let (first, bottom) = (top + ABOVE, top + ABOVE + rows as f64 * PITCH);
    for (index, bar) in ranking.bars.iter().enumerate() {
        let middle = first + (index as f64 + 0.5) * PITCH;
        sheet.text([start - 6.0, middle + 3.5], &bar.name, Style::new(TICK).anchor(Anchor::End));
        let thick = |share: f64| [middle - 0.5 * share * PITCH, share * PITCH];
        let mut draw = |value: f64, share: f64, colour: Colour| {
            let [y, height] = thick(share);
            sheet.rect([start, y], [at(value) - start, height], Look::fill(colour));
        };
        draw(bar.value, 0.62, POTENTIAL);
        if let Some(alone) = bar.alone {
            draw(alone, 0.34, ALONE);
        }
        let ends = [bar.value - bar.confidence, bar.value + bar.confidence].map(at);
        sheet.line([ends[0], middle], [ends[1], middle], Stroke::new(INK, AXIS_WIDTH));
    }
    sheet.line([start, first], [start, bottom], Stroke::new(INK, AXIS_WIDTH));
    sheet.line([start, bottom], [start + length, bottom], Stroke::new(INK, AXIS_WIDTH));
    let count = (last / step).round() as usize;
    for tick in 0..=count {
        let value = tick as f64 * step;
        let x = at(value);
        sheet.line([x, bottom], [x, bottom + 3.0], Stroke::new(INK, HAIR));
        let text = fixed(value, decimals(step));
        sheet.text([x, bottom + 13.0], &text, Style::new(TICK).anchor(Anchor::Middle));
    }
    let middle = [start + 0.5 * length, bottom + 25.0];
    sheet.text(middle, &ranking.axis, Style::new(TICK).anchor(Anchor::Middle).colour(MUTED));
}
