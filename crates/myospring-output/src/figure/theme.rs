//! One look for all figures: sizes, colours, fonts, number formats.

use std::fmt::{Display, Formatter};

/// Width of a figure over one column of a journal, px.
pub(super) const SINGLE: f64 = mm(85.0);
/// Width of a figure over two columns, px.
pub(super) const DOUBLE: f64 = mm(178.0);

/// Millimetres in px: drawings have 96 px per inch.
pub(super) const fn mm(length: f64) -> f64 {
    length * 96.0 / 25.4
}

/// Font families, the embedded one first.
pub(super) const FONTS: &str = "Noto Sans, Arial, Helvetica, sans-serif";

/// Size of panel letters, px (10 pt in print).
pub(super) const LETTER: u32 = 13;
/// Size of axis labels, px (8.25 pt).
pub(super) const LABEL: u32 = 11;
/// Size of tick labels and legends, px (7.5 pt).
pub(super) const TICK: u32 = 10;

/// Red, green and blue in two hexadecimal digits each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Colour(pub(super) u32);

impl Colour {
    pub(super) const fn channels(self) -> [u8; 3] {
        let [_, red, green, blue] = self.0.to_be_bytes();
        [red, green, blue]
    }
}

impl Display for Colour {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "#{:06x}", self.0)
    }
}

/// Paper and rings of dots.
pub(super) const WHITE: Colour = Colour(0xffffff);
/// Rims of what lies on a picture.
pub(super) const BLACK: Colour = Colour(0x000000);
/// Text and axes.
pub(super) const INK: Colour = Colour(0x1a1a1a);
/// Text of second rank and reference lines.
pub(super) const MUTED: Colour = Colour(0x666666);
/// Bands behind curves.
pub(super) const BAND: Colour = Colour(0xe6e6e6);
/// Potential (Okabe-Ito blue).
pub(super) const POTENTIAL: Colour = Colour(0x0072b2);
/// Tension (Okabe-Ito vermillion).
pub(super) const TENSION: Colour = Colour(0xd55e00);
/// Shortening (Okabe-Ito bluish green).
pub(super) const SHORTENING: Colour = Colour(0x009e73);
/// Curves that are compared, in order (Okabe-Ito).
pub(super) const CURVES: [Colour; 6] = [
    Colour(0x0072b2),
    Colour(0xe69f00),
    Colour(0x009e73),
    Colour(0xd55e00),
    Colour(0x56b4e9),
    Colour(0xcc79a7),
];

/// Width of curves, px.
pub(super) const CURVE_WIDTH: f64 = 1.6;
/// Width of axes and ticks, px.
pub(super) const AXIS_WIDTH: f64 = 0.9;
/// Width of hairlines, px.
pub(super) const HAIR: f64 = 0.6;

/// Colours of shortening from rest: magma (van der Walt and Smith 2015, CC0) reversed and without
/// its blackest end, perceptually uniform.
const SHORTER: [[u8; 3]; 17] = [
    [0xfc, 0xfd, 0xbf],
    [0xfd, 0xe3, 0xa5],
    [0xfe, 0xcc, 0x8f],
    [0xfe, 0xb2, 0x7a],
    [0xfd, 0x9a, 0x6a],
    [0xfa, 0x7f, 0x5e],
    [0xf4, 0x67, 0x5c],
    [0xe7, 0x52, 0x63],
    [0xd3, 0x43, 0x6e],
    [0xbf, 0x3a, 0x77],
    [0xa8, 0x32, 0x7d],
    [0x93, 0x2b, 0x80],
    [0x7c, 0x23, 0x82],
    [0x68, 0x1c, 0x81],
    [0x52, 0x13, 0x7c],
    [0x3d, 0x0f, 0x71],
    [0x25, 0x12, 0x55],
];
/// Colours of stretch from rest: the greens and blues of `YlGnBu` (Brewer 2003, Apache-2.0).
const LONGER: [[u8; 3]; 7] = [
    [0xfc, 0xfd, 0xbf],
    [0xc7, 0xe9, 0xb4],
    [0x7f, 0xcd, 0xbb],
    [0x41, 0xb6, 0xc4],
    [0x1d, 0x91, 0xc0],
    [0x22, 0x5e, 0xa8],
    [0x0c, 0x2c, 0x84],
];

/// The colour of a strain relative to the greatest one of the figure, in [-1, 1]: rest is light,
/// shortening goes over red to purple, stretch over green to blue.
pub(super) fn strain_colour(relative: f64) -> Colour {
    let map: &[[u8; 3]] = if relative <= 0.0 { &SHORTER } else { &LONGER };
    let place = relative.abs().min(1.0) * (map.len() - 1) as f64;
    let below = (place.floor() as usize).min(map.len() - 2);
    let part = place - below as f64;
    let mix = |channel: usize| {
        let (a, b) = (f64::from(map[below][channel]), f64::from(map[below + 1][channel]));
        (a + part * (b - a)).round() as u8
    };
    Colour(u32::from_be_bytes([0, mix(0), mix(1), mix(2)]))
}

/// A number with `decimals` digits after the point and a real minus sign, never "-0".
pub(super) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|byte| matches!(byte, b'0' | b'.')) => rest.to_owned(),
        Some(rest) => format!("\u{2212}{rest}"),
        None => text,
    }
}

/// A time as people write it: `171.5 ms`, `50 ms`.
pub(super) fn time(t_ms: f64) -> String {
    let text = fixed(t_ms, 1);
    format!("{} ms", text.strip_suffix(".0").unwrap_or(&text))
}

/// Digits after the point that tell ticks of this step apart.
pub(super) fn decimals(step: f64) -> usize {
    (0..9)
        .find(|&n| (step * 10f64.powi(n) - (step * 10f64.powi(n)).round()).abs() < 1e-6)
        .unwrap_or(9) as usize
}

/// The step of 1, 2 or 5 times a power of ten that cuts `span` into at most `most` parts.
pub(super) fn nice_step(span: f64, most: f64) -> f64 {
    let raw = span / most;
    if !(raw.is_finite() && raw > 0.0) {
        return 1.0;
    }
    let power = 10f64.powf(raw.log10().floor());
    [1.0, 2.0, 5.0]
        .into_iter()
        .map(|m| m * power)
        .find(|step| *step >= raw * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_one_two_or_five() {
        for (span, most, step) in
            [(600.0, 6.0, 100.0), (14.0, 5.0, 5.0), (0.9, 5.0, 0.2), (0.0, 5.0, 1.0)]
        {
            assert!((nice_step(span, most) - step).abs() < 1e-12, "{span} / {most}");
        }
        assert_eq!((decimals(0.2), decimals(0.05), decimals(20.0)), (1, 2, 0));
    }

    #[test]
    fn numbers_have_a_minus_sign_and_no_negative_zero() {
        assert_eq!(fixed(-0.04, 1), "0.0");
        assert_eq!(fixed(-12.34, 1), "\u{2212}12.3");
        assert_eq!((time(50.0), time(171.45)), ("50 ms".to_owned(), "171.4 ms".to_owned()));
    }

    #[test]
    fn rest_is_light_and_both_ends_of_the_strain_map_are_dark() {
        assert_eq!(
            [-2.0, -1.0, -0.5].map(strain_colour),
            [0x251255, 0x251255, 0xd3436e].map(Colour)
        );
        assert_eq!(Colour(0x0072b2).to_string(), "#0072b2");
        assert_eq!([0.0, 0.5, 1.0].map(strain_colour), [0xfcfdbf, 0x41b6c4, 0x0c2c84].map(Colour));
    }
}
