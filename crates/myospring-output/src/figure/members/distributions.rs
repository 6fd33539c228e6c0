//! Histograms of the metrics of many members.

use super::super::chart::{Axis, Chart};
use super::super::sheet::{Anchor, Area, Look, Path, Sheet, Style};
use super::super::theme::{BAND, DOUBLE, MUTED, POTENTIAL, TICK, decimals, fixed, nice_step};
use super::super::{Figure, FigureError};
use super::{Mark, Numbers, REJECTED, ends, legend, quantile};

/// Number of panels in a row, and sizes, px.
const COLUMNS: usize = 3;
const HEIGHT: f64 = 92.0;
const GAP: f64 = 18.0;
const MARGIN: f64 = 6.0;
/// Space above and below the plots of a row, px.
const ABOVE: f64 = 18.0;
const BELOW: f64 = 44.0;
/// Smallest and largest number of bars of a histogram.
const BARS: [f64; 2] = [8.0, 40.0];

/// One metric of all members.
#[derive(Debug, Clone, PartialEq)]
pub struct Distribution {
    /// The metric.
    pub metric: Numbers,
    /// Range of the metric in which members are accepted.
    pub band: Option<[f64; 2]>,
    /// Its value in the reference run.
    pub usual: Option<f64>,
}

/// Draws histograms of metrics, each with median and middle 90 % of the accepted members (of all,
/// if `kept` is `None`). Three panels in a row, two columns of a journal.
///
/// # Errors
/// No metric, or one that no member has.
pub fn distributions(
    panels: &[Distribution],
    kept: Option<&[bool]>,
) -> Result<Figure, FigureError> {
    if panels.is_empty() {
        return Err(FigureError::Nothing { what: "metrics" });
    }
    let bars: Option<Vec<Bars>> = panels.iter().map(|one| Bars::of(one, kept)).collect();
    let bars = bars.ok_or(FigureError::Nothing { what: "members with finite numbers" })?;
    let mut charts: Vec<Chart> =
        panels.iter().zip(&bars).map(|(one, bars)| chart(one, bars)).collect();
    let offset = charts.iter().map(Chart::label_offset).fold(0.0, f64::max);
    let pitch = (DOUBLE - 2.0 * MARGIN + GAP) / COLUMNS as f64;
    let mut sheet = Sheet::default();
    for (index, (chart, bars)) in charts.iter_mut().zip(&bars).enumerate() {
        let left = MARGIN + (index % COLUMNS) as f64 * pitch + 10.0 + offset;
        let top = ABOVE + (index / COLUMNS) as f64 * (ABOVE + HEIGHT + BELOW);
        let right = MARGIN + ((index % COLUMNS) as f64 + 1.0) * pitch - GAP;
        chart.place = [left, top];
        chart.size[0] = right - left;
        let [first, last] = chart.x.range;
        chart.x = Axis::across(&chart.x.label, [first, last], right - left);
        chart.x.range = [first, last];
        chart.y.labelled = true;
        draw(&mut sheet, chart, &panels[index], bars, offset);
    }
    let rows = panels.len().div_ceil(COLUMNS) as f64;
    let bottom = rows * (ABOVE + HEIGHT + BELOW) - 4.0;
    let mut words = Vec::new();
    if let Some(kept) = kept {
        let count = kept.iter().filter(|kept| **kept).count();
        words.push((Mark::Patch(POTENTIAL), format!("{count} members kept")));
        words.push((Mark::Patch(REJECTED), "rejected (stacked on top)".to_owned()));
    } else {
        words.push((Mark::Patch(POTENTIAL), "all members".to_owned()));
    }
    if panels.iter().any(|one| one.band.is_some()) {
        words.push((Mark::Patch(BAND), "accepted band".to_owned()));
    }
    if panels.iter().any(|one| one.usual.is_some()) {
        words.push((Mark::Dashed(MUTED), "unchanged run".to_owned()));
    }
    words.push((Mark::None, "above: median (middle 90 %)".to_owned()));
    let height = legend(&mut sheet, [MARGIN + 10.0, bottom], DOUBLE - MARGIN, &words);
    Ok(sheet.finish(DOUBLE, bottom + height + 6.0))
}

/// A histogram.
struct Bars {
    range: [f64; 2],
    /// Number of members in each bar: accepted, and all.
    counts: Vec<[usize; 2]>,
    /// 5, 50 and 95 % quantiles of the accepted members, or of all.
    quantiles: [f64; 3],
}

impl Bars {
    fn of(one: &Distribution, kept: Option<&[bool]>) -> Option<Self> {
        let is_kept =
            |index: usize| kept.is_none_or(|kept| kept.get(index).copied().unwrap_or(false));
        let values = one.metric.values.iter().copied().enumerate();
        let values: Vec<(f64, bool)> = values
            .filter(|(_, value)| value.is_finite())
            .map(|(index, value)| (value, is_kept(index)))
            .collect();
        let sorted = |kept_only: bool| {
            let some = values.iter().filter(|(_, kept)| *kept || !kept_only);
            let mut some: Vec<f64> = some.map(|(value, _)| *value).collect();
            some.sort_by(f64::total_cmp);
            some
        };
        let (all, inside) = (sorted(false), sorted(true));
        let [low, high] = ends(all.iter().copied())?;
        let range = if high > low { [low, high] } else { [low - 0.5, high + 0.5] };
        // Freedman and Diaconis (1981), within visible limits.
        let spread = quantile(&all, 0.75) - quantile(&all, 0.25);
        let wide = 2.0 * spread / (all.len() as f64).cbrt();
        let bars = ((range[1] - range[0]) / wide).ceil().clamp(BARS[0], BARS[1]);
        let bars = if bars.is_finite() { bars } else { BARS[1] };
        let mut counts = vec![[0; 2]; bars as usize];
        for (value, kept) in &values {
            let place = (value - range[0]) / (range[1] - range[0]) * bars;
            let bar = &mut counts[(place as usize).min(bars as usize - 1)];
            bar[1] += 1;
            bar[0] += usize::from(*kept);
        }
        let shown = if inside.is_empty() { &all } else { &inside };
        let quantiles = [0.05, 0.5, 0.95].map(|part| quantile(shown, part));
        Some(Self { range, counts, quantiles })
    }
}

/// The chart of a histogram; place and width are set later.
fn chart(one: &Distribution, bars: &Bars) -> Chart {
    let most = bars.counts.iter().map(|count| count[1]).max().unwrap_or(0) as f64;
    let span = bars.range[1] - bars.range[0];
    let [mut first, mut last] = [bars.range[0] - 0.04 * span, bars.range[1] + 0.04 * span];
    // A band that ends near the members is shown completely.
    for end in one.band.into_iter().flatten().chain(one.usual) {
        if end > first - 0.25 * span && end < last + 0.25 * span {
            (first, last) = (first.min(end - 0.04 * span), last.max(end + 0.04 * span));
        }
    }
    let x = Axis { range: [first, last], ..Axis::across(&one.metric.label, [first, last], 100.0) };
    let y = Axis::values("Members", [0.0, most], HEIGHT);
    let marks = one.usual.into_iter().collect();
    Chart { marks, ..Chart::new(0.0, HEIGHT, [x, y], Vec::new()) }
}

fn draw(sheet: &mut Sheet, chart: &Chart, one: &Distribution, bars: &Bars, offset: f64) {
    let [first, last] = chart.x.range;
    if let Some(band) = one.band {
        let [low, high] = band.map(|end| end.clamp(first, last));
        let [left, _] = chart.at([low, 0.0]);
        let [right, _] = chart.at([high, 0.0]);
        sheet.rect([left, chart.place[1]], [right - left, HEIGHT], Look::fill(BAND));
    }
    let wide = (bars.range[1] - bars.range[0]) / bars.counts.len() as f64;
    let mut paths = [Path::default(), Path::default()];
    for (index, &[kept, all]) in bars.counts.iter().enumerate() {
        let ends = [index, index + 1].map(|end| bars.range[0] + end as f64 * wide);
        for (path, [from, to]) in paths.iter_mut().zip([[0, kept], [kept, all]]) {
            let [left, upper] = chart.at([ends[0], to as f64]);
            let [right, lower] = chart.at([ends[1], from as f64]);
            if lower > upper {
                let bar = Area { corner: [left, upper], size: [right - left - 0.4, lower - upper] };
                path.steps.extend(Path::rect(bar).steps);
            }
        }
    }
    let [kept, rejected] = paths;
    sheet.path(rejected, Look::fill(REJECTED));
    sheet.path(kept, Look::fill(POTENTIAL));
    chart.draw(sheet, offset);
    let [low, median, high] = bars.quantiles;
    let digits = decimals(nice_step((high - low).abs(), 20.0)).min(6);
    let note = format!(
        "{} ({}\u{2013}{})",
        fixed(median, digits),
        fixed(low, digits),
        fixed(high, digits)
    );
    let place = [chart.place[0] + chart.size[0], chart.place[1] - 5.0];
    sheet.text(place, &note, Style::new(TICK).anchor(Anchor::End).colour(MUTED));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_member_stands_in_a_bar_and_kept_ones_say_where_the_middle_is() {
        let values: Vec<f64> = (0..1001).map(f64::from).chain([f64::NAN]).collect();
        let kept: Vec<bool> = (0..1002).map(|i| i < 501).collect();
        let metric = Numbers { label: "m".to_owned(), values };
        let one = Distribution { metric, band: None, usual: None };
        let bars = Bars::of(&one, Some(&kept)).unwrap();
        let sums = [0, 1].map(|kind| bars.counts.iter().map(|count| count[kind]).sum::<usize>());
        assert_eq!(sums, [501, 1001]);
        assert_eq!(bars.quantiles, [25.0, 250.0, 475.0]);
    }
}
