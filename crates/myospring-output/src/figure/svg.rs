//! A figure as SVG: text stays text, lines stay lines.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::sheet::{Anchor, Area, Element, Figure, HALO, Look, Path, Step, Style, hundredths};
use super::theme::{FONTS, mm};

/// The figure as SVG, with its printed size.
pub(super) fn svg(figure: &Figure) -> String {
    let [width, height] = figure.size.map(px);
    let [width_mm, height_mm] = figure.size.map(|length| px(length / mm(1.0)));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width_mm}mm\" height=\"{height_mm}mm\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"{FONTS}\" fill=\"none\" \
         stroke-linejoin=\"round\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>\n",
        figure.paper
    );
    for element in &figure.elements {
        append(&mut svg, element);
    }
    svg.push_str("</svg>\n");
    svg
}

fn append(svg: &mut String, element: &Element) {
    // Writing to a String cannot fail.
    match element {
        Element::Path { path, look } => {
            writeln!(svg, r#"<path{} d="{}"/>"#, look_of(*look), data(path))
        }
        Element::Circle { centre, radius, look } => {
            let ([x, y], radius, look) = (centre.map(px), px(*radius), look_of(*look));
            writeln!(svg, r#"<circle cx="{x}" cy="{y}" r="{radius}"{look}/>"#)
        }
        Element::Text { at, text, style } => writeln!(svg, "{}", written(*at, text, *style)),
        Element::Picture { place, picture } => {
            writeln!(
                svg,
                r#"<image {} preserveAspectRatio="none" style="image-rendering:smooth" xmlns:xlink="http://www.w3.org/1999/xlink" xlink:href="data:image/png;base64,{}"/>"#,
                area(*place),
                STANDARD.encode(&picture.png)
            )
        }
        Element::Window { name, frame, inside } => {
            let frame = data(frame);
            // Names must be unique among all figures of a page.
            let name = format!("{name}-{:08x}", digest(&frame));
            writeln!(
                svg,
                r#"<clipPath id="{name}"><path d="{frame}"/></clipPath><g clip-path="url(#{name})">"#
            )
            .ok();
            for element in inside {
                append(svg, element);
            }
            writeln!(svg, "</g>")
        }
    }
    .ok();
}

/// Hash of a text (Fowler-Noll-Vo), the same on every machine.
fn digest(text: &str) -> u32 {
    text.bytes().fold(0x811c_9dc5, |sum, byte| (sum ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

fn area(Area { corner, size }: Area) -> String {
    let ([x, y], [width, height]) = (corner.map(px), size.map(px));
    format!(r#"x="{x}" y="{y}" width="{width}" height="{height}""#)
}

fn written(at: [f64; 2], text: &str, style: Style) -> String {
    let [x, y] = at.map(px);
    let mut more = String::new();
    match style.anchor {
        Anchor::Start => {}
        Anchor::Middle => more.push_str(r#" text-anchor="middle""#),
        Anchor::End => more.push_str(r#" text-anchor="end""#),
    }
    if style.bold {
        more.push_str(r#" font-weight="bold""#);
    }
    if style.upward {
        write!(more, r#" transform="rotate(-90 {x} {y})""#).ok();
    }
    let halo = style.halo.then_some(HALO);
    more.push_str(&look_of(Look { fill: Some(style.colour), stroke: halo }));
    if style.halo {
        more.push_str(r#" paint-order="stroke""#);
    }
    format!(r#"<text x="{x}" y="{y}" font-size="{}"{more}>{}</text>"#, style.size, escape(text))
}

fn look_of(look: Look) -> String {
    let mut more = String::new();
    if let Some(colour) = look.fill {
        write!(more, r#" fill="{colour}""#).ok();
    }
    if let Some(stroke) = look.stroke {
        let (colour, width) = (stroke.colour, px(stroke.width));
        write!(more, r#" stroke="{colour}" stroke-width="{width}""#).ok();
        if stroke.opacity < 1.0 {
            write!(more, r#" stroke-opacity="{}""#, px(stroke.opacity)).ok();
        }
        if let Some([dash, gap]) = stroke.dash.map(|dash| dash.map(px)) {
            write!(more, r#" stroke-dasharray="{dash} {gap}""#).ok();
        }
        if stroke.round_ends {
            more.push_str(r#" stroke-linecap="round""#);
        }
    }
    more
}

/// The path in relative coordinates, the shortest form; pairs after `m` are lines.
fn data(path: &Path) -> String {
    let mut data = String::with_capacity(8 * path.steps.len());
    let (mut here, mut start) = ([0, 0], [0, 0]);
    for step in &path.steps {
        match *step {
            Step::Close => {
                data.push('z');
                here = start;
            }
            Step::Move(to) | Step::Line(to) => {
                if matches!(step, Step::Move(_)) {
                    data.push('m');
                    start = to;
                }
                for axis in 0..2 {
                    append_number(&mut data, i64::from(to[axis]) - i64::from(here[axis]));
                }
                here = to;
            }
        }
    }
    data
}

/// Adds a number of hundredths, after a space if it would run into the one before.
fn append_number(data: &mut String, hundredths: i64) {
    if hundredths >= 0 && data.ends_with(|last: char| last.is_ascii_digit()) {
        data.push(' ');
    }
    if hundredths < 0 {
        data.push('-');
    }
    let (whole, part) = (hundredths.unsigned_abs() / 100, hundredths.unsigned_abs() % 100);
    // Writing to a String cannot fail.
    match (whole, part) {
        (_, 0) => write!(data, "{whole}"),
        (0, _) => write!(data, ".{part:02}"),
        _ => write!(data, "{whole}.{part:02}"),
    }
    .ok();
    if part > 0 && part % 10 == 0 {
        data.pop();
    }
}

/// A number with at most two decimals, without trailing zeros.
fn px(value: f64) -> String {
    let mut text = String::new();
    append_number(&mut text, i64::from(hundredths(value)));
    text
}

/// Text with XML's special characters escaped, and forbidden ones left out.
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
    fn numbers_are_short() {
        assert_eq!([px(1.0), px(-0.001), px(2.504), px(10.0)], ["1", "0", "2.5", "10"]);
        assert_eq!([px(0.5), px(-0.05), px(-3.25), px(0.994)], [".5", "-.05", "-3.25", ".99"]);
    }

    #[test]
    fn paths_go_from_point_to_point() {
        let mut path = Path::line([[10.0, 20.0], [10.5, 19.0], [8.0, 19.0]]);
        path.add_ring([[0.0, 0.25], [1.0, 0.25], [1.0, 1.0]]);
        path.add_line([[3.0, 0.25]; 2]);
        assert_eq!(data(&path), "m10 20 .5-1-2.5 0m-8-18.75 1 0 0 .75zm3 0 0 0");
    }

    #[test]
    fn text_of_users_cannot_break_the_drawing() {
        assert_eq!(escape("a<b & \u{1}c>\n"), "a&lt;b &amp; c&gt; ");
    }
}
