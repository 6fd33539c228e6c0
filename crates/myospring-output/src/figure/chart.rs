//! Charts: axes, ticks and curves.

use super::font::text_width;
use super::sheet::{Anchor, Look, Path, Sheet, Stroke, Style};
use super::theme::{
    AXIS_WIDTH, BAND, CURVE_WIDTH, Colour, HAIR, INK, LABEL, MUTED, TICK, decimals, fixed,
    nice_step,
};

/// Length of a tick, px.
const TICK_LENGTH: f64 = 4.0;

/// One axis: what it measures, from where to where, and the step between its ticks.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    pub(super) label: String,
    pub(super) range: [f64; 2],
    pub(super) step: f64,
    /// Whether ticks and axis carry text; of panels that share an axis only one does.
    pub(super) labelled: bool,
}

impl Axis {
    /// The time axis of curves between these times: as long as the data, unless a tick is near.
    pub(super) fn time([first, last]: [f64; 2]) -> Self {
        let span = if last > first { last - first } else { 1.0 };
        let step = nice_step(span, 6.0);
        let tick = ((first + span) / step).ceil() * step;
        let end = if tick - (first + span) < 0.02 * span { tick } else { first + span };
        Self { label: "Time (ms)".to_owned(), range: [first, end], step, labelled: true }
    }

    /// A vertical axis around these values, from 0 where none is really negative, that ends at ticks
    /// and is `height` px long.
    ///
    /// Among the steps that keep tick labels apart it takes the one that wastes the least room, and
    /// fewer ticks for little more waste.
    pub(super) fn values(label: &str, [low, high]: [f64; 2], height: f64) -> Self {
        let low = if low > -0.02 * (high - low) { 0.0 } else { low };
        let high = if high > low { high } else { low + 1.0 };
        let most = (height / 14.0).floor().max(2.0);
        let cut = |parts: f64| {
            let step = nice_step(high - low, parts);
            let range = [(low / step).floor() * step, (high / step - 1e-9).ceil() * step];
            let count = ((range[1] - range[0]) / step).round();
            let filled = (high - low) / (range[1] - range[0]);
            (range, step, count, filled - 0.012 * count)
        };
        let mut best = cut(2.0);
        for candidate in [3.0, 5.0, 8.0, 12.0].map(cut) {
            if candidate.2 <= most && candidate.3 > best.3 {
                best = candidate;
            }
        }
        Self { label: label.to_owned(), range: best.0, step: best.1, labelled: true }
    }

    /// A horizontal axis around these values, from near the least to near the largest, `width` px long: as many ticks
    /// as their labels leave room for.
    pub(super) fn across(label: &str, ends: [f64; 2], width: f64) -> Self {
        Self::around(label, ends, |axis| {
            let ticks = axis.ticks().count() as f64;
            ticks * (axis.tick_width() + 8.0) <= width
        })
    }

    /// A vertical axis around these values, from near the least to near the largest, `height` px long.
    pub(super) fn upright(label: &str, ends: [f64; 2], height: f64) -> Self {
        Self::around(label, ends, |axis| axis.ticks().count() as f64 * 18.0 <= height)
    }

    /// An axis with a little room at both ends, and the most ticks that fit.
    fn around(label: &str, [low, high]: [f64; 2], fits: impl Fn(&Self) -> bool) -> Self {
        let span = match high - low {
            span if span > 0.0 => span,
            _ if low == 0.0 => 1.0,
            _ => 0.2 * low.abs(),
        };
        let middle = f64::midpoint(low, high);
        let range = [middle - 0.54 * span, middle + 0.54 * span];
        let with = |parts: f64| {
            let step = nice_step(range[1] - range[0], parts);
            Self { label: label.to_owned(), range, step, labelled: true }
        };
        let fitting = [7.0, 5.0, 4.0, 3.0, 2.0].map(with).into_iter().find(|axis| fits(axis));
        fitting.unwrap_or_else(|| with(1.0))
    }

    /// Where a value lies, as a part of the way.
    fn part(&self, value: f64) -> f64 {
        (value - self.range[0]) / (self.range[1] - self.range[0])
    }

    /// The places of the ticks, and what is written there.
    fn ticks(&self) -> impl Iterator<Item = (f64, String)> {
        let (step, digits) = (self.step, decimals(self.step));
        let [first, last] = [
            (self.range[0] / step - 1e-6).ceil() as i64,
            (self.range[1] / step + 1e-6).floor() as i64,
        ];
        (first..=last).map(move |count| {
            let value = count as f64 * step;
            (value, fixed(value, digits))
        })
    }

    /// Width of the widest tick label, px.
    fn tick_width(&self) -> f64 {
        self.ticks().map(|(_, text)| text_width(&text, TICK)).fold(0.0, f64::max)
    }
}

/// A curve; it breaks where a point is not finite.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    pub(super) points: Vec<[f64; 2]>,
    pub(super) colour: Colour,
    /// Length of dashes and of the gaps between them, px.
    pub(super) dash: Option<[f64; 2]>,
}

/// A chart: `place` is the upper left corner of the plot, `size` its width and height, px.
#[derive(Debug, Clone)]
pub(super) struct Chart {
    pub(super) place: [f64; 2],
    pub(super) size: [f64; 2],
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) curves: Vec<Curve>,
    /// Horizontal bands behind the curves.
    pub(super) bands: Vec<[f64; 2]>,
    /// Times with a dashed line.
    pub(super) marks: Vec<f64>,
}

impl Chart {
    /// Where a value is drawn.
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            self.place[0] + self.x.part(x) * self.size[0],
            self.place[1] + (1.0 - self.y.part(y)) * self.size[1],
        ]
    }

    /// Whether a curve passes through a box between two corners, px.
    pub(super) fn crosses(&self, upper_left: [f64; 2], lower_right: [f64; 2]) -> bool {
        let inside = |&point: &[f64; 2]| {
            let at = self.at(point);
            (0..2).all(|axis| at[axis] >= upper_left[axis] && at[axis] <= lower_right[axis])
        };
        self.curves.iter().any(|curve| curve.points.iter().any(inside))
    }

    /// Distance from the vertical axis to the baseline of its label, px.
    pub(super) fn label_offset(&self) -> f64 {
        self.y.tick_width() + TICK_LENGTH + 10.0
    }

    /// Draws the chart; the vertical label stands `label_offset` px left of its axis.
    pub(super) fn draw(&self, sheet: &mut Sheet, label_offset: f64) {
        let [left, top] = self.place;
        let [width, height] = self.size;
        let bottom = top + height;
        self.draw_behind(sheet);
        self.draw_axes(sheet);
        self.draw_curves(sheet);
        let middle = Style::new(LABEL).anchor(Anchor::Middle);
        if self.y.labelled {
            let place = [left - label_offset, top + height / 2.0];
            sheet.text(place, &self.y.label, middle.upward());
        }
        if self.x.labelled {
            sheet.text([left + width / 2.0, bottom + 31.0], &self.x.label, middle);
        }
    }

    /// Bands and marked times, behind axes and curves.
    fn draw_behind(&self, sheet: &mut Sheet) {
        let [[first, last], [bottom, top]] = [self.x.range, self.y.range];
        for band in &self.bands {
            let [low, high] = band.map(|value| value.clamp(bottom, top));
            let [left, upper] = self.at([first, high]);
            let [right, lower] = self.at([last, low]);
            sheet.rect([left, upper], [right - left, lower - upper], Look::fill(BAND));
        }
        for &t in self.marks.iter().filter(|t| (first..=last).contains(*t)) {
            let stroke = Stroke::new(MUTED, HAIR).dash(3.0, 2.0);
            sheet.line(self.at([t, bottom]), self.at([t, top]), stroke);
        }
    }

    /// Both axes and their ticks, outside the plot, with what is written there.
    fn draw_axes(&self, sheet: &mut Sheet) {
        let [left, top] = self.place;
        let [right, bottom] = [left + self.size[0], top + self.size[1]];
        let mut axes = Path::line([[left, top], [left, bottom], [right, bottom]]);
        for (value, text) in self.x.ticks() {
            let [x, _] = self.at([value, 0.0]);
            axes.add_line([[x, bottom], [x, bottom + TICK_LENGTH]]);
            if self.x.labelled {
                let style = Style::new(TICK).anchor(Anchor::Middle);
                sheet.text([x, bottom + TICK_LENGTH + 9.5], &text, style);
            }
        }
        for (value, text) in self.y.ticks() {
            let [_, y] = self.at([0.0, value]);
            axes.add_line([[left - TICK_LENGTH, y], [left, y]]);
            if self.y.labelled {
                let style = Style::new(TICK).anchor(Anchor::End);
                sheet.text([left - TICK_LENGTH - 3.0, y + 3.6], &text, style);
            }
        }
        sheet.path(axes, Stroke::new(INK, AXIS_WIDTH));
    }

    /// The curves alone, for a chart that has been drawn.
    pub(super) fn draw_curves(&self, sheet: &mut Sheet) {
        for curve in &self.curves {
            self.draw_curve(sheet, curve);
        }
    }

    /// Lines between neighbouring points, dots for those that stand alone.
    fn draw_curve(&self, sheet: &mut Sheet, curve: &Curve) {
        let mut path = Path::default();
        for run in runs(&curve.points) {
            match run {
                [alone] => sheet.dot(self.at(*alone), curve.colour),
                run => path.add_line(thin(run, self.size[0]).into_iter().map(|at| self.at(at))),
            }
        }
        let stroke = Stroke::new(curve.colour, CURVE_WIDTH);
        sheet.path(path, Stroke { dash: curve.dash, ..stroke });
    }
}

/// Stretches of finite points.
fn runs(points: &[[f64; 2]]) -> impl Iterator<Item = &[[f64; 2]]> {
    points.split(|[x, y]| !(x.is_finite() && y.is_finite())).filter(|run| !run.is_empty())
}

/// At most four points for each third of a px: first, lowest, highest and last, so that no peak is lost.
fn thin(points: &[[f64; 2]], width: f64) -> Vec<[f64; 2]> {
    let columns = (3.0 * width).max(1.0) as usize;
    if points.len() <= 4 * columns {
        return points.to_vec();
    }
    let size = points.len().div_ceil(columns);
    let mut kept = Vec::with_capacity(4 * columns);
    for group in points.chunks(size) {
        let by_value = |a: &usize, b: &usize| group[*a][1].total_cmp(&group[*b][1]);
        let mut places = [
            0,
            (0..group.len()).min_by(by_value).unwrap_or(0),
            (0..group.len()).max_by(by_value).unwrap_or(0),
            group.len() - 1,
        ]
        .to_vec();
        places.sort_unstable();
        places.dedup();
        kept.extend(places.into_iter().map(|place| group[place]));
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_ends_and_the_peak() {
        let mut points: Vec<[f64; 2]> =
            (0..100_000).map(|i| [f64::from(i), f64::from(i % 7)]).collect();
        points[54_321][1] = 99.0;
        let kept = thin(&points, 100.0);
        assert!(kept.len() <= 1200);
        assert!(kept.contains(&[54_321.0, 99.0]));
        assert_eq!((kept[0], kept[kept.len() - 1]), (points[0], points[99_999]));
    }

    #[test]
    fn axes_end_at_ticks_and_start_from_zero_where_they_can() {
        let axis = Axis::values("", [-0.01, 13.4], 90.0);
        assert_eq!((axis.range, axis.step), ([0.0, 15.0], 5.0));
        assert_eq!(Axis::values("", [0.0, 13.4], 170.0).step, 2.0);
        assert_eq!(Axis::values("", [-84.0, 37.0], 108.0).range, [-100.0, 40.0]);
        assert_eq!(Axis::values("", [0.0, 0.0], 108.0).range, [0.0, 1.0]);
        assert_eq!(Axis::time([0.0, 599.95]).range, [0.0, 600.0]);
        assert_eq!(Axis::time([0.0, 83.0]).range, [0.0, 83.0]);
        assert_eq!(Axis::time([5.0, 5.0]).range, [5.0, 6.0]);
    }

    #[test]
    fn ticks_are_round_numbers_within_the_axis() {
        let texts = |axis: &Axis| axis.ticks().map(|(_, text)| text).collect::<Vec<_>>();
        assert_eq!(texts(&Axis::time([5.0, 83.0])), ["20", "40", "60", "80"]);
        let potential = Axis::values("", [-84.0, 37.0], 108.0);
        assert_eq!(texts(&potential)[..2], ["\u{2212}100", "\u{2212}80"]);
        assert_eq!(potential.ticks().last(), Some((40.0, "40".to_owned())));
        // The last tick stays, whatever rounding makes of the end.
        let shares = Axis { range: [0.0, 0.1 * 3.0], step: 0.1, ..potential };
        assert_eq!(texts(&shares), ["0.0", "0.1", "0.2", "0.3"]);
    }

    #[test]
    fn a_curve_breaks_where_numbers_do() {
        let points = [[0.0, 1.0], [1.0, f64::NAN], [2.0, 1.0], [3.0, 2.0]];
        assert_eq!(runs(&points).map(<[_]>::len).collect::<Vec<_>>(), [1, 2]);
    }
}
