//! The figure of a fit: measured and fitted curve, residual, and likelihood profiles of its
//! parameters.

use super::chart::{Axis, Chart, Curve, align, ends};
use super::font::text_width;
use super::sheet::{Anchor, Area, Look, Path, Sheet, Stroke, Style};
use super::theme::{BAND, Colour, DOUBLE, HAIR, INK, LETTER, MUTED, SHORTENING, TENSION, TICK};
use super::{Figure, FigureError};

/// Heights of the plots, px.
const OVERLAY: f64 = 150.0;
const RESIDUAL: f64 = 56.0;
const PROFILE: f64 = 74.0;
/// Space above the first plot, px.
const HEAD: f64 = 26.0;
/// The misfit is smoothed over this fraction (one part in so many) of the frames.
const SMOOTH: usize = 60;
/// Colour of the area between a measured curve and a fit that does not follow it.
const MISFIT: Colour = Colour(0xf0b48c);
/// Space below a plot with its own time axis, and between curve and residual, px.
const UNDER: f64 = 46.0;
const BETWEEN: f64 = 14.0;
/// Number of profiles in a row, and the space between them, px.
const BESIDE: usize = 4;
const GAP: f64 = 20.0;
/// Largest rise of chi squared that is drawn, relative to that at the ends of the interval.
const HIGHEST: f64 = 2.08;
/// Colour of the measurement: readable on light and on dark paper.
const MEASURED: Colour = MUTED;

/// A measured curve with the fitted one.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnFit {
    /// The measured quantity, with its unit.
    pub label: String,
    /// Its unit alone, for the residual.
    pub unit: String,
    /// Times, ms.
    pub times_ms: Vec<f64>,
    /// Measured values.
    pub measured: Vec<f64>,
    /// Fitted values.
    pub fitted: Vec<f64>,
    /// Whether each frame was used in the fit; others are drawn hollow.
    pub used: Vec<bool>,
    /// Standard deviation of the noise.
    pub noise: f64,
    /// Warning above the curve, in colour. With a warning, the misfit is drawn, too.
    pub warning: Option<String>,
    /// Stimuli, ms.
    pub stimuli_ms: Vec<f64>,
}

/// A tension that a curve asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnTension {
    /// Times, ms.
    pub times_ms: Vec<f64>,
    /// Tension, kPa.
    pub tension_kpa: Vec<f64>,
    /// Ends of its 95 % band, kPa.
    pub band_kpa: [Vec<f64>; 2],
    /// The true tension, where it is known, kPa; drawn dashed.
    pub true_kpa: Option<Vec<f64>>,
    /// Stimuli, ms.
    pub stimuli_ms: Vec<f64>,
}

/// The profile likelihood of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct LikelihoodProfile {
    /// The parameter, with its unit.
    pub label: String,
    /// The most likely value.
    pub value: f64,
    /// Ends of its 95 % interval, if it has them.
    pub interval: [Option<f64>; 2],
    /// Points of the profile: value and rise of chi squared.
    pub points: Vec<[f64; 2]>,
    /// Rise at the ends of the interval.
    pub at_ends: f64,
}

/// Draws curves with their residuals, and the profiles below.
///
/// Width: two columns, 178 mm.
///
/// # Errors
/// No curve, or one without a finite frame.
pub fn fit(curves: &[DrawnFit], profiles: &[LikelihoodProfile]) -> Result<Figure, FigureError> {
    if curves.is_empty() {
        return Err(FigureError::Nothing { what: "fitted curves" });
    }
    let mut charts: Vec<Chart> = Vec::new();
    let mut top = HEAD;
    for curve in curves {
        charts.extend(pair(curve, top)?);
        top += OVERLAY + BETWEEN + RESIDUAL + UNDER + 8.0;
    }
    // Half of the last tick label extends beyond the time axis.
    let offset = align(&mut charts, 28.0, DOUBLE - 20.0);
    let mut sheet = Sheet::default();
    for (number, (charts, curve)) in charts.chunks_exact_mut(2).zip(curves).enumerate() {
        let [above, below] = charts else { continue };
        if let Some(warning) = &curve.warning {
            misfit(&mut sheet, [above, below], curve);
            let at = [above.place[0], above.place[1] - 9.0];
            sheet.text(at, warning, Style::new(TICK).bold().colour(TENSION));
        }
        above.draw(&mut sheet, offset);
        below.draw(&mut sheet, offset);
        for (frame, time) in curve.times_ms.iter().enumerate() {
            let colour = if curve.used[frame] { MEASURED } else { TENSION };
            let value = curve.measured[frame];
            if value.is_finite() {
                // One beyond the scale is drawn at its end.
                let [low, high] = above.y.range;
                sheet.point(above.at([*time, value.clamp(low, high)]), 1.5, colour);
            }
            let off = value - curve.fitted[frame];
            if off.is_finite() && (below.y.range[0]..=below.y.range[1]).contains(&off) {
                sheet.point(below.at([*time, off]), 1.2, colour);
            }
        }
        // The fitted curve is drawn over the frames.
        above.curves.push(fitted(curve));
        above.draw_curves(&mut sheet);
        if number == 0 {
            legend(&mut sheet, above);
            sheet.text([6.0, above.place[1] + 4.0], "A", Style::new(LETTER).bold());
            sheet.text([6.0, below.place[1] + 4.0], "B", Style::new(LETTER).bold());
        }
    }
    for (row, profiles) in profiles.chunks(BESIDE).enumerate() {
        let room = (DOUBLE - 14.0 - 22.0) / BESIDE as f64;
        for (column, profile) in profiles.iter().enumerate() {
            let start = 22.0 + room * column as f64;
            let mut chart = likelihood(profile, [start, top], room - GAP);
            let offset = chart.label_offset();
            chart.place[0] += offset;
            chart.size[0] -= offset;
            let first = row == 0 && column == 0;
            chart.y.labelled = column == 0;
            draw_profile(&mut sheet, &chart, profile, offset, first);
            if first {
                sheet.text([6.0, top + 4.0], "C", Style::new(LETTER).bold());
            }
        }
        top += PROFILE + UNDER;
    }
    Ok(sheet.finish(DOUBLE, top))
}

/// Draws a tension over time with its 95 % band.
///
/// Width: two columns, 178 mm.
///
/// # Errors
/// A tension without frames.
pub fn tension(drawn: &DrawnTension) -> Result<Figure, FigureError> {
    let DrawnTension { times_ms, tension_kpa, band_kpa: [low, high], true_kpa, stimuli_ms } = drawn;
    let (Some(&first), Some(&last)) = (times_ms.first(), times_ms.last()) else {
        return Err(FigureError::Nothing { what: "tensions" });
    };
    let top = high.iter().copied().fold(0.0, f64::max);
    let line = |values: &[f64]| times_ms.iter().zip(values).map(|(t, v)| [*t, *v]).collect();
    let mut curves = vec![Curve::solid(line(tension_kpa), TENSION)];
    curves.extend(true_kpa.as_ref().map(|values| Curve {
        points: line(values),
        colour: INK,
        dash: Some([3.0, 2.0]),
    }));
    let mut chart = Chart {
        place: [0.0, HEAD],
        size: [0.0, OVERLAY],
        x: Axis::time([first, last]),
        y: Axis::values("Active tension (kPa)", [0.0, top], OVERLAY),
        curves,
        bands: Vec::new(),
        marks: stimuli_ms.clone(),
    };
    let offset = chart.label_offset();
    chart.place[0] = 28.0 + offset;
    chart.size[0] = DOUBLE - 20.0 - chart.place[0];
    let mut sheet = Sheet::default();
    let edge = |values: &[f64]| -> Vec<[f64; 2]> {
        times_ms.iter().zip(values).map(|(t, v)| chart.at([*t, *v])).collect()
    };
    let mut area = Path::default();
    area.add_ring(edge(high).into_iter().chain(edge(low).into_iter().rev()));
    let mut inside = Sheet::default();
    inside.path(area, Look::fill(BAND));
    let plot = Area { corner: chart.place, size: chart.size };
    sheet.window("band".to_owned(), Path::rect(plot), inside);
    chart.draw(&mut sheet, offset);
    chart.draw_curves(&mut sheet);
    let words = match true_kpa {
        Some(_) => "line: found, grey: 95 % band, dashed: true",
        None => "line: tension, grey: 95 % band",
    };
    let right = [chart.place[0] + chart.size[0], chart.place[1] - 8.5];
    sheet.text(right, words, Style::new(TICK).anchor(Anchor::End).colour(INK));
    Ok(sheet.finish(DOUBLE, HEAD + OVERLAY + UNDER))
}

fn draw_profile(
    sheet: &mut Sheet,
    chart: &Chart,
    profile: &LikelihoodProfile,
    offset: f64,
    first: bool,
) {
    chart.draw(sheet, offset);
    let threshold = chart.x.range.map(|x| chart.at([x, profile.at_ends]));
    sheet.line(threshold[0], threshold[1], Stroke::new(MUTED, HAIR).dash(3.0, 2.0));
    if first {
        // The profile is low in the middle.
        let [x, y] = [0, 1].map(|axis| f64::midpoint(threshold[0][axis], threshold[1][axis]));
        sheet.text([x, y - 4.0], "95 %", Style::new(TICK).anchor(Anchor::Middle).colour(MUTED));
    }
    for end in profile.interval.into_iter().flatten() {
        let ends = [profile.at_ends, 0.0].map(|rise| chart.at([end, rise]));
        sheet.line(ends[0], ends[1], Stroke::new(SHORTENING, HAIR));
    }
    sheet.point(chart.at([profile.value, 0.0]), 2.4, SHORTENING);
}

fn fitted(curve: &DrawnFit) -> Curve {
    let points = curve.times_ms.iter().zip(&curve.fitted).map(|(time, value)| [*time, *value]);
    Curve::solid(points.collect(), SHORTENING)
}

/// A curve and, below it, its residual.
fn pair(curve: &DrawnFit, top: f64) -> Result<[Chart; 2], FigureError> {
    // Frames that were not used do not determine the scale.
    let counts = || curve.measured.iter().zip(&curve.fitted).zip(&curve.used).filter(|it| *it.1);
    let values = ends(curve.fitted.iter().copied().chain(counts().map(|it| *it.0.0)));
    let times = ends(curve.times_ms.iter().copied());
    if !(values[0].is_finite() && times[1] > times[0]) {
        return Err(FigureError::NoSamples { what: curve.label.clone() });
    }
    let off = ends(counts().map(|((measured, fitted), _)| (measured - fitted).abs()));
    let reach = off[1].max(2.5 * curve.noise);
    let left = match curve.unit.as_str() {
        "" => "Residual".to_owned(),
        unit => format!("Residual ({unit})"),
    };
    let time = Axis::time(times);
    let without_text = Axis { labelled: false, ..time.clone() };
    let values = Axis::upright(&curve.label, values, OVERLAY);
    let above = Chart::new(top, OVERLAY, [without_text, values], Vec::new());
    let residuals = Axis::upright(&left, [-reach, reach], RESIDUAL);
    let below = Chart::new(top + OVERLAY + BETWEEN, RESIDUAL, [time, residuals], Vec::new());
    Ok([
        Chart { marks: curve.stimuli_ms.clone(), ..above },
        Chart { bands: vec![[-curve.noise, curve.noise]], ..below },
    ])
}

/// Fills the area between the smoothed measured curve and the fitted one, and draws their smoothed
/// difference below.
fn misfit(sheet: &mut Sheet, [above, below]: [&Chart; 2], curve: &DrawnFit) {
    let frames: Vec<usize> = (0..curve.times_ms.len())
        .filter(|&at| curve.used[at] && curve.measured[at].is_finite())
        .collect();
    let off: Vec<f64> = frames.iter().map(|&at| curve.measured[at] - curve.fitted[at]).collect();
    let half = frames.len() / SMOOTH / 2;
    let smooth = |place: usize| {
        let near = &off[place.saturating_sub(half)..(place + half + 1).min(off.len())];
        near.iter().sum::<f64>() / near.len() as f64
    };
    let off: Vec<f64> = (0..off.len()).map(smooth).collect();
    let along = |chart: &Chart, of: &dyn Fn(usize) -> f64| -> Vec<[f64; 2]> {
        frames.iter().enumerate().map(|(n, &at)| chart.at([curve.times_ms[at], of(n)])).collect()
    };
    let fitted = |n: usize| curve.fitted[frames[n]];
    for (chart, upper, lower) in [
        (above, along(above, &|n| fitted(n) + off[n]), along(above, &fitted)),
        (below, along(below, &|n| off[n]), along(below, &|_| 0.0)),
    ] {
        let mut area = Path::default();
        area.add_ring(upper.into_iter().chain(lower.into_iter().rev()));
        let mut inside = Sheet::default();
        inside.path(area, Look::fill(MISFIT));
        let plot = Area { corner: chart.place, size: chart.size };
        sheet.window("misfit".to_owned(), Path::rect(plot), inside);
    }
}

/// Draws the legend above the plot, where it hides no frame.
fn legend(sheet: &mut Sheet, chart: &Chart) {
    let y = chart.place[1] - 12.0;
    let mut right = chart.place[0] + chart.size[0];
    for (words, colour) in [("fitted", SHORTENING), ("measured", MEASURED)] {
        sheet.text([right, y + 3.5], words, Style::new(TICK).anchor(Anchor::End).colour(INK));
        right -= text_width(words, TICK) + 6.0;
        if colour == MEASURED {
            sheet.point([right - 4.0, y], 1.8, colour);
        } else {
            sheet.line([right - 12.0, y], [right, y], Stroke::new(colour, 1.6));
        }
        right -= 26.0;
    }
}

fn likelihood(profile: &LikelihoodProfile, place: [f64; 2], width: f64) -> Chart {
    let highest = HIGHEST * profile.at_ends;
    let points = below(&profile.points, highest);
    let low = points.iter().map(|point| point[0]).fold(profile.value, f64::min);
    let high = points.iter().map(|point| point[0]).fold(profile.value, f64::max);
    let x = Axis::across(&profile.label, [low, high], width);
    let (range, label) = ([0.0, highest], "Rise of χ²".to_owned());
    let y = Axis { range, step: 4.0, label, labelled: true };
    let chart = Chart::new(place[1], PROFILE, [x, y], vec![Curve::solid(points, MEASURED)]);
    Chart { place, size: [width, PROFILE], ..chart }
}

/// The part of a curve below a height, with the points where it crosses that height.
fn below(points: &[[f64; 2]], height: f64) -> Vec<[f64; 2]> {
    let mut kept = Vec::new();
    for (at, &[x, y]) in points.iter().enumerate() {
        if y <= height {
            kept.push([x, y]);
        }
        if let Some(&[to, above]) = points.get(at + 1)
            && (y <= height) != (above <= height)
        {
            kept.push([x + (height - y) / (above - y) * (to - x), height]);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve with a fit beside it, of so many frames.
    fn curve(frames: usize, scale: f64, unit: &str) -> DrawnFit {
        let beat = |at: usize| {
            let time = at as f64 / frames as f64;
            scale * (100.0 - 10.0 * (8.0 * time * (1.0 - 8.0 * time).exp()))
        };
        let fitted: Vec<f64> = (0..frames).map(beat).collect();
        let measured =
            fitted.iter().enumerate().map(|(at, v)| v + scale * (at as f64).sin()).collect();
        DrawnFit {
            label: format!("Length ({unit})"),
            unit: unit.to_owned(),
            times_ms: (0..frames).map(|at| 4.0 * at as f64).collect(),
            measured,
            fitted,
            used: vec![true; frames],
            noise: 0.3 * scale,
            warning: Some(
                "The model does not fit: it is off by 7 % of the height of a beat".into(),
            ),
            stimuli_ms: vec![10.0],
        }
    }

    #[test]
    fn the_legend_hides_no_frame_and_no_label_is_clipped() {
        let long = "arbitrary units of the camera's sixteen bits";
        for frames in [12, 150, 10_000] {
            for scale in [1e-8, 1e-3, 1.0, 1e7] {
                for unit in ["\u{b5}m", "", long] {
                    let figure = fit(&[curve(frames, scale, unit)], &[]).unwrap();
                    assert_eq!(figure.beyond([0.0, DOUBLE]), [], "{frames} {scale} {unit}");
                    // The legend stands above the plot, where no frame is drawn.
                    let above = figure.elements.iter().filter(|element| {
                        matches!(element, crate::figure::sheet::Element::Text { at, text, .. }
                            if (text == "fitted" || text == "measured") && at[1] < HEAD)
                    });
                    assert_eq!(above.count(), 2);
                }
            }
        }
        let one = curve(1, 1.0, "um");
        assert!(matches!(fit(&[one], &[]), Err(FigureError::NoSamples { .. })));
    }

    #[test]
    fn the_rise_at_the_ends_of_an_interval_lies_within_its_plot() {
        for at_ends in [3.84, 1.2, 40.0] {
            let profile = LikelihoodProfile {
                label: "c_0".to_owned(),
                value: 5.0,
                interval: [Some(4.0), Some(6.0)],
                points: (0..=40)
                    .map(|k| 3.0 + 0.1 * f64::from(k))
                    .map(|x| [x, at_ends * (x - 5.0).powi(2)])
                    .collect(),
                at_ends,
            };
            let chart = likelihood(&profile, [100.0, 50.0], 200.0);
            for end in profile.interval.into_iter().flatten() {
                let [x, y] = chart.at([end, at_ends]);
                assert!((100.0..=300.0).contains(&x) && (50.0..=50.0 + PROFILE).contains(&y));
            }
        }
    }
}
