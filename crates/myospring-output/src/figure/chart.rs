//! Charts: axes, ticks and curves.

use super::font::text_width;
use super::sheet::{Anchor, Look, Path, Sheet, Stroke, Style};
use super::theme::{
    AXIS_WIDTH, BAND, CURVE_WIDTH, Colour, HAIR, INK, LABEL, MISSED, MUTED, TICK, decimals, fixed,
    nice_step,
};

/// Length of a tick, px.
const TICK_LENGTH: f64 = 4.0;

/// If the largest number of an axis lies between these, its numbers are written out.
const SHORT: [f64; 2] = [1e-4, 1e5];
/// End of the label of a time axis; large times are shown in s.
const MILLISECONDS: &str = "(ms)";
/// Largest excess of a label over the length of its axis, px, and the smallest font size before its
/// end is cut.
const LONGER: f64 = 24.0;
const SMALLEST: u32 = 8;

/// One axis: label, range, and step between ticks.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    pub(super) label: String,
    pub(super) range: [f64; 2],
    pub(super) step: f64,
    /// Whether ticks and axis have text; only one of several panels that share an axis does.
    pub(super) labelled: bool,
}

impl Axis {
    /// The time axis of curves between these times; it ends with the data, or at a tick near their
    /// end.
    pub(super) fn time([first, last]: [f64; 2]) -> Self {
        let span = if last > first { last - first } else { 1.0 };
        let step = nice_step(span, 6.0);
        let tick = ((first + span) / step).ceil() * step;
        let end = if tick - (first + span) < 0.02 * span { tick } else { first + span };
        Self { label: "Time (ms)".to_owned(), range: [first, end], step, labelled: true }
    }

    /// A vertical axis around these values, `height` px long, which ends at ticks and starts at 0
    /// unless values are clearly negative.
    ///
    /// Among the steps that keep tick labels apart, it chooses the one that wastes the least room,
    /// and prefers fewer ticks if they waste only a little more.
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

    /// A horizontal axis that just contains these values, `width` px long, with as many ticks as
    /// fit with their labels.
    pub(super) fn across(label: &str, ends: [f64; 2], width: f64) -> Self {
        Self::around(label, ends, |axis| {
            let apart = axis.step / (axis.range[1] - axis.range[0]) * width;
            axis.tick_width() + 8.0 <= apart
        })
    }

    /// A vertical axis that just contains these values, `height` px long.
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

    /// Position of a value, as a fraction of the axis.
    fn part(&self, value: f64) -> f64 {
        (value - self.range[0]) / (self.range[1] - self.range[0])
    }

    /// The power of ten (a multiple of 3) in the label, so that ticks have short numbers; 0 if they
    /// are short without it.
    fn power(&self) -> i32 {
        let largest = self.range[0].abs().max(self.range[1].abs());
        if !(largest > 0.0 && largest.is_finite()) || (SHORT[0]..SHORT[1]).contains(&largest) {
            return 0;
        }
        let power = 3 * (largest.log10() / 3.0).floor() as i32;
        // Times are in ms or s only.
        if self.label.ends_with(MILLISECONDS) { power.clamp(0, 3) } else { power }
    }

    /// The label of the axis, with its power of ten.
    fn title(&self) -> String {
        let power = self.power();
        if power == 0 {
            return self.label.clone();
        }
        if let Some(name) = self.label.strip_suffix(MILLISECONDS) {
            return format!("{name}(s)");
        }
        let factor = format!("\u{d7}10{}", raised(power));
        match self.label.rsplit_once('(').filter(|(_, unit)| unit.ends_with(')')) {
            Some((name, unit)) => format!("{name}({factor} {unit}"),
            None => format!("{} ({factor})", self.label),
        }
    }

    /// Positions and labels of the ticks.
    fn ticks(&self) -> impl Iterator<Item = (f64, String)> {
        let by = 10_f64.powi(-self.power());
        let (step, digits) = (self.step, decimals(self.step * by));
        let [first, last] = [
            (self.range[0] / step - 1e-6).ceil() as i64,
            (self.range[1] / step + 1e-6).floor() as i64,
        ];
        (first..=last).map(move |count| {
            let value = count as f64 * step;
            (value, fixed(value * by, digits))
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

impl Curve {
    pub(super) fn solid(points: Vec<[f64; 2]>, colour: Colour) -> Self {
        Self { points, colour, dash: None }
    }
}

/// Smallest and largest finite value; the infinities if there is none.
pub(super) fn ends(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let finite = values.into_iter().filter(|value| value.is_finite());
    finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    })
}

/// Puts charts between two edges of the sheet, px, with the labels of all right of the left one; returns the distance
/// of these labels from the plots.
pub(super) fn align(charts: &mut [Chart], left: f64, right: f64) -> f64 {
    let offset = charts.iter().map(Chart::label_offset).fold(0.0, f64::max);
    for chart in charts {
        chart.place[0] = left + offset;
        chart.size[0] = right - chart.place[0];
    }
    offset
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
    /// Times that are marked by a dashed line.
    pub(super) marks: Vec<f64>,
}

impl Chart {
    /// A chart without bands and marks, from `top` down, `height` px high; place and width across are set later.
    pub(super) fn new(top: f64, height: f64, [x, y]: [Axis; 2], curves: Vec<Curve>) -> Self {
        let (place, size) = ([0.0, top], [0.0, height]);
        Self { place, size, x, y, curves, bands: Vec::new(), marks: Vec::new() }
    }

    /// Position of a value on the sheet, px.
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

    /// Draws the chart; the vertical label is `label_offset` px left of its axis.
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
            let (text, size) = fitting(&self.y.title(), height + LONGER);
            sheet.text(place, &text, Style { size, ..middle }.upward());
        }
        if self.x.labelled {
            let (text, size) = fitting(&self.x.title(), width + LONGER);
            sheet.text([left + width / 2.0, bottom + 31.0], &text, Style { size, ..middle });
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

    /// Draws stimuli without a beat as dashed lines in their own colour; the first has a label at
    /// its upper end.
    pub(super) fn draw_missed(&self, sheet: &mut Sheet, missed: &[f64], word: &str) {
        let [[first, last], [bottom, top]] = [self.x.range, self.y.range];
        for (place, &t) in missed.iter().filter(|t| (first..=last).contains(*t)).enumerate() {
            sheet.line(
                self.at([t, bottom]),
                self.at([t, top]),
                Stroke::new(MISSED, 1.0).dash(2.0, 3.0),
            );
            if place == 0 {
                let [x, y] = self.at([t, top]);
                let room = self.place[0] + self.size[0] - x - text_width(word, TICK) - 3.0;
                let style = Style::new(TICK).colour(MISSED);
                let (x, style) = if room > 0.0 {
                    (x + 3.0, style)
                } else {
                    (x - 3.0, style.anchor(Anchor::End))
                };
                sheet.text([x, y + 9.0], word, style);
            }
        }
    }

    /// Draws both axes with ticks and labels, outside the plot.
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

    /// Draws the curves alone, for a chart that has been drawn.
    pub(super) fn draw_curves(&self, sheet: &mut Sheet) {
        for curve in &self.curves {
            self.draw_curve(sheet, curve);
        }
    }

    /// Draws lines between neighbouring points, and dots for isolated ones.
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

/// A label that fits into a width in px, and its font size: smaller if needed, and cut if that is
/// not enough.
fn fitting(label: &str, room: f64) -> (String, u32) {
    let fits = |text: &str, size| text_width(text, size) <= room;
    if let Some(size) = (SMALLEST..=LABEL).rev().find(|size| fits(label, *size)) {
        return (label.to_owned(), size);
    }
    let mut text = label.to_owned();
    while !text.is_empty() && !fits(&format!("{text}\u{2026}"), SMALLEST) {
        text.pop();
    }
    (format!("{}\u{2026}", text.trim_end()), SMALLEST)
}

/// A power of ten in superscript digits.
fn raised(power: i32) -> String {
    let digit = |digit: char| match digit {
        // The font has no raised minus; this is a raised bar.
        '-' => '\u{2c9}',
        '1' => '\u{b9}',
        '2' => '\u{b2}',
        '3' => '\u{b3}',
        digit => char::from_u32(0x2070 + digit as u32 - '0' as u32).unwrap_or(digit),
    };
    power.to_string().chars().map(digit).collect()
}

/// Runs of finite points.
fn runs(points: &[[f64; 2]]) -> impl Iterator<Item = &[[f64; 2]]> {
    points.split(|[x, y]| !(x.is_finite() && y.is_finite())).filter(|run| !run.is_empty())
}

/// Thins points to at most four per third of a px (first, lowest, highest, last), which keeps every
/// peak.
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
    fn long_numbers_have_their_power_in_the_label() {
        let axis = |label: &str, ends| Axis::upright(label, ends, 150.0);
        let large = axis("Force (nN)", [0.0, 1e9]);
        assert_eq!(large.title(), "Force (\u{d7}10\u{2079} nN)");
        let small = axis("Left", [-3e-7, 3e-7]);
        assert_eq!(small.title(), "Left (\u{d7}10\u{2c9}\u{2079})");
        assert!(small.title().chars().all(super::super::font::has));
        let time = Axis::time([0.0, 4e5]);
        assert_eq!(
            (time.title().as_str(), time.ticks().nth(1).unwrap().1.as_str()),
            ("Time (s)", "100")
        );
        assert_eq!(axis("Length (um)", [0.0, 140.0]).title(), "Length (um)");
        // As wide as the number needs, whatever its size.
        for scale in [1e-12, 1e-6, 1.0, 1e4, 1e9, 1e30] {
            for ends in [[0.0, 1.0], [1.0, 1.3], [-2.0, 5.0]] {
                let axis = axis("Length (um)", ends.map(|end| end * scale));
                assert!(axis.tick_width() < 40.0, "{scale} {ends:?}: {}", axis.tick_width());
                let texts: Vec<String> = axis.ticks().map(|(_, text)| text).collect();
                assert!(texts.len() > 1 && texts.windows(2).all(|pair| pair[0] != pair[1]));
            }
        }
    }

    #[test]
    fn numbers_below_an_axis_stay_apart_however_close_its_ends_are() {
        for middle in [0.01666, 0.1624, 140.446, -3.0] {
            for span in [1e-4, 7e-4, 0.01, 0.3] {
                let ends = [middle - span, middle + 1.1 * span];
                let axis = Axis::across("", ends, 140.0);
                let apart = axis.step / (axis.range[1] - axis.range[0]) * 140.0;
                let count = axis.ticks().count();
                assert!(count < 2 || axis.tick_width() < apart, "{ends:?}: {apart}");
            }
        }
    }

    #[test]
    fn a_label_is_no_longer_than_its_axis() {
        let long = "Normalised fluorescence intensity of the indicator (arbitrary units)";
        for room in [60.0, 150.0, 300.0, 600.0] {
            let (text, size) = fitting(long, room);
            assert!(text_width(&text, size) <= room, "{text}");
        }
        assert_eq!(fitting("Time (ms)", 100.0), ("Time (ms)".to_owned(), LABEL));
    }

    #[test]
    fn a_curve_breaks_where_numbers_do() {
        let points = [[0.0, 1.0], [1.0, f64::NAN], [2.0, 1.0], [3.0, 2.0]];
        assert_eq!(runs(&points).map(<[_]>::len).collect::<Vec<_>>(), [1, 2]);
    }
}
