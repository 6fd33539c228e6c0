//! Common style of all figures: sizes, colours, fonts, number formats.

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
    pub(super) const fn from_channels([red, green, blue]: [u8; 3]) -> Self {
        Self(u32::from_be_bytes([0, red, green, blue]))
    }

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
/// Rims of elements on a picture.
pub(super) const BLACK: Colour = Colour(0x000000);
/// Text and axes.
pub(super) const INK: Colour = Colour(0x1a1a1a);
/// Secondary text and reference lines.
pub(super) const MUTED: Colour = Colour(0x666666);
/// Bands behind curves.
pub(super) const BAND: Colour = Colour(0xe6e6e6);
/// Potential (Okabe-Ito blue).
pub(super) const POTENTIAL: Colour = Colour(0x0072b2);
/// Calcium (Okabe-Ito reddish purple, darker, so that it is visible on paper).
pub(super) const CALCIUM: Colour = Colour(0xb0578d);
/// Tension (Okabe-Ito vermillion).
pub(super) const TENSION: Colour = Colour(0xd55e00);
/// Stimuli without a beat.
pub(super) const MISSED: Colour = TENSION;
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

/// The outline at rest.
pub(super) const REST: Colour = Colour(0x8c8c8c);
/// Inside of the lattice.
pub(super) const LATTICE: Colour = Colour(0xf3f6f9);

/// Light or dark paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Theme {
    /// Dark ink on white, as journals print.
    #[default]
    Light,
    /// Light ink on nearly black, for slides and screens.
    Dark,
}

impl Theme {
    /// Both themes.
    pub const ALL: [Self; 2] = [Self::Light, Self::Dark];

    /// Its name in options.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Dark => "dark",
        }
    }

    /// The colour as shown in this theme: paper and ink change, colours of data and curves stay.
    pub(super) fn shown(self, colour: Colour) -> Colour {
        match (self, colour) {
            (Self::Light, _) => colour,
            (Self::Dark, WHITE) => Colour(0x14171c),
            (Self::Dark, INK) => Colour(0xe8e8e8),
            (Self::Dark, MUTED) => Colour(0xa8abb0),
            (Self::Dark, BAND) => Colour(0x343941),
            (Self::Dark, LATTICE) => Colour(0x1e242c),
            (Self::Dark, other) => other,
        }
    }
}

/// Width of curves, px.
pub(super) const CURVE_WIDTH: f64 = 1.6;
/// Width of axes and ticks, px.
pub(super) const AXIS_WIDTH: f64 = 0.9;
/// Width of hairlines, px.
pub(super) const HAIR: f64 = 0.6;

/// A number with `decimals` digits after the point and a real minus sign, never "-0".
pub(super) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|byte| matches!(byte, b'0' | b'.')) => rest.to_owned(),
        Some(rest) => format!("\u{2212}{rest}"),
        None => text,
    }
}

/// A time as text: `171.5 ms`, `50 ms`.
pub(super) fn time(t_ms: f64) -> String {
    let text = fixed(t_ms, 1);
    format!("{} ms", text.strip_suffix(".0").unwrap_or(&text))
}

/// Number of decimals that distinguishes ticks of this step.
pub(super) fn decimals(step: f64) -> usize {
    (0..9)
        .find(|&n| (step * 10f64.powi(n) - (step * 10f64.powi(n)).round()).abs() < 1e-6)
        .unwrap_or(9) as usize
}

/// The step of 1, 2 or 5 times a power of ten that divides `span` into at most `most` parts.
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

    /// Relative luminance (WCAG 2.2).
    fn luminance(colour: Colour) -> f64 {
        let linear = colour.channels().map(|channel| {
            let part = f64::from(channel) / 255.0;
            if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
        });
        0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    }

    fn contrast(a: Colour, b: Colour) -> f64 {
        let [a, b] = [a, b].map(luminance);
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn text_and_curves_stand_out_from_either_paper() {
        for theme in [Theme::Light, Theme::Dark] {
            let shown = |colour| theme.shown(colour);
            // WCAG 2.2: text 4.5, graphics 3.
            for text in [INK, MUTED] {
                assert!(contrast(shown(text), shown(WHITE)) >= 4.5, "{theme:?} {text}");
            }
            for curve in [POTENTIAL, CALCIUM, TENSION, SHORTENING, REST] {
                assert!(contrast(shown(curve), shown(WHITE)) >= 3.0, "{theme:?} {curve}");
            }
        }
        for curve in CURVES {
            assert!(contrast(Theme::Dark.shown(curve), Theme::Dark.shown(WHITE)) >= 3.0, "{curve}");
        }
    }
}
