//! A sheet of SVG elements, in px with y downward.

use std::fmt::Write;

use super::Figure;
use super::theme::{FONTS, INK};

/// Where a text stands relative to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// How a text looks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Style {
    pub(super) size: u32,
    pub(super) anchor: Anchor,
    pub(super) colour: &'static str,
    pub(super) bold: bool,
    /// Written upward, as along a vertical axis.
    pub(super) upward: bool,
}

impl Style {
    pub(super) const fn new(size: u32) -> Self {
        Self { size, anchor: Anchor::Start, colour: INK, bold: false, upward: false }
    }

    pub(super) const fn anchor(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    pub(super) const fn colour(self, colour: &'static str) -> Self {
        Self { colour, ..self }
    }

    pub(super) const fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    pub(super) const fn upward(self) -> Self {
        Self { upward: true, ..self }
    }
}

/// Elements in drawing order.
#[derive(Debug, Default)]
pub(super) struct Sheet {
    body: String,
}

impl Sheet {
    /// Adds a finished element.
    pub(super) fn raw(&mut self, element: &str) {
        self.body.push_str(element);
        self.body.push('\n');
    }

    pub(super) fn text(&mut self, [x, y]: [f64; 2], text: &str, style: Style) {
        let anchor = match style.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let (x, y) = (px(x), px(y));
        let weight = if style.bold { r#" font-weight="bold""# } else { "" };
        let turn = if style.upward {
            format!(r#" transform="rotate(-90 {x} {y})""#)
        } else {
            String::new()
        };
        self.raw(&format!(
            r#"<text x="{x}" y="{y}" font-size="{}" text-anchor="{anchor}" fill="{}"{weight}{turn}>{}</text>"#,
            style.size,
            style.colour,
            escape(text)
        ));
    }

    pub(super) fn line(
        &mut self,
        from: [f64; 2],
        to: [f64; 2],
        colour: &str,
        width: f64,
        dash: &str,
    ) {
        let dash =
            if dash.is_empty() { String::new() } else { format!(r#" stroke-dasharray="{dash}""#) };
        self.raw(&format!(
            r#"<line x1="{}" y1="{}" x2="{}" y2="{}" stroke="{colour}" stroke-width="{width}"{dash}/>"#,
            px(from[0]),
            px(from[1]),
            px(to[0]),
            px(to[1])
        ));
    }

    pub(super) fn rect(
        &mut self,
        [x, y]: [f64; 2],
        [width, height]: [f64; 2],
        fill: &str,
        more: &str,
    ) {
        self.raw(&format!(
            r#"<rect x="{}" y="{}" width="{}" height="{}" fill="{fill}"{more}/>"#,
            px(x),
            px(y),
            px(width),
            px(height)
        ));
    }

    /// A dot on a curve, ringed in white so that it stands out.
    pub(super) fn dot(&mut self, [x, y]: [f64; 2], colour: &str) {
        self.raw(&format!(
            r##"<circle cx="{}" cy="{}" r="3" fill="{colour}" stroke="#ffffff" stroke-width="1"/>"##,
            px(x),
            px(y)
        ));
    }

    /// The figure, `width` by `height` px large, on white.
    pub(super) fn finish(self, width: f64, height: f64) -> Figure {
        let in_mm = |length: f64| px(length * 25.4 / 96.0);
        let (w, h) = (px(width), px(height));
        Figure {
            svg: format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}mm\" height=\"{}mm\" \
                 viewBox=\"0 0 {w} {h}\" font-family=\"{FONTS}\">\n\
                 <rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n{}</svg>\n",
                in_mm(width),
                in_mm(height),
                self.body
            ),
        }
    }
}

/// A coordinate with two digits after the point, without trailing zeros.
pub(super) fn px(value: f64) -> String {
    let mut text = String::with_capacity(8);
    // Writing to a String cannot fail.
    write!(text, "{:.2}", value + 0.0).ok();
    if text.contains('.') {
        text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
    }
    if text == "-0" { "0".to_owned() } else { text }
}

/// Text with the characters that XML keeps for itself written out, and those it forbids left out.
fn escape(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '\t' | '\n' | '\r' => safe.push(' '),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {}
            c => safe.push(c),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_short() {
        assert_eq!([px(1.0), px(-0.001), px(2.505), px(10.0)], ["1", "0", "2.5", "10"]);
    }

    #[test]
    fn text_of_users_cannot_break_the_drawing() {
        assert_eq!(escape("a<b & \u{1}c>\n"), "a&lt;b &amp; c&gt; ");
    }
}
