//! The embedded font: widths and outlines of text.

use std::sync::OnceLock;

use tiny_skia::{Path, PathBuilder};
use ttf_parser::gpos::{PairAdjustment, PositioningSubtable};
use ttf_parser::{Face, GlyphId, OutlineBuilder, Tag};

/// Noto Sans (SIL Open Font License 1.1).
fn face(bold: bool) -> Option<&'static Face<'static>> {
    static REGULAR: OnceLock<Option<Face<'static>>> = OnceLock::new();
    static BOLD: OnceLock<Option<Face<'static>>> = OnceLock::new();
    let (face, data) =
        if bold { (&BOLD, notosans::BOLD_TTF) } else { (&REGULAR, notosans::REGULAR_TTF) };
    face.get_or_init(|| Face::parse(data, 0).ok()).as_ref()
}

/// Width of a text in the regular face, px.
pub(super) fn text_width(text: &str, size: u32) -> f64 {
    face(false).map_or(0.0, |face| {
        let (_, end) = glyphs(face, text);
        end * scale(face, size)
    })
}

/// Whether a character can be drawn.
#[cfg(test)]
pub(super) fn has(character: char) -> bool {
    face(false).is_some_and(|face| face.glyph_index(character).is_some())
}

/// The outlines of a text that starts at the origin (px, y downward) and its width; no outlines for
/// blank text.
pub(super) fn outlines(text: &str, size: u32, bold: bool) -> (Option<Path>, f64) {
    let Some(face) = face(bold) else { return (None, 0.0) };
    let (glyphs, end) = glyphs(face, text);
    let scale = scale(face, size);
    let mut pen = Pen { path: PathBuilder::new(), scale, start: 0.0 };
    for (glyph, start) in glyphs {
        pen.start = start * scale;
        // A glyph without outlines, such as a space, draws nothing.
        face.outline_glyph(glyph, &mut pen);
    }
    (pen.path.finish(), end * scale)
}

/// Size of a font unit, px.
fn scale(face: &Face<'_>, size: u32) -> f64 {
    f64::from(size) / f64::from(face.units_per_em())
}

/// The glyphs of a text with their positions, and the end of the text, in font units.
fn glyphs(face: &Face<'_>, text: &str) -> (Vec<(GlyphId, f64)>, f64) {
    let mut placed: Vec<(GlyphId, f64)> = Vec::with_capacity(text.len());
    let mut end = 0.0;
    for c in text.chars().filter(|c| !c.is_control()) {
        // Missing characters are drawn as the font's replacement box.
        let glyph = face.glyph_index(c).unwrap_or_default();
        if let Some(&(left, _)) = placed.last() {
            end += f64::from(kerning(face, left, glyph).unwrap_or(0));
        }
        placed.push((glyph, end));
        end += f64::from(face.glyph_hor_advance(glyph).unwrap_or(0));
    }
    (placed, end)
}

/// Kerning: extra distance between two neighbouring glyphs (OpenType's table GPOS, feature `kern`).
fn kerning(face: &Face<'_>, left: GlyphId, right: GlyphId) -> Option<i16> {
    let table = face.tables().gpos?;
    let feature = table.features.find(Tag::from_bytes(b"kern"))?;
    let lookups = feature.lookup_indices.into_iter().filter_map(|index| table.lookups.get(index));
    let pairs = lookups.flat_map(|lookup| lookup.subtables.into_iter::<PositioningSubtable>());
    pairs.into_iter().find_map(|subtable| {
        let PositioningSubtable::Pair(pairs) = subtable else { return None };
        let covered = pairs.coverage().get(left)?;
        let (first, _) = match pairs {
            PairAdjustment::Format1 { sets, .. } => sets.get(covered)?.get(right),
            PairAdjustment::Format2 { classes, matrix, .. } => {
                matrix.get((classes.0.get(left), classes.1.get(right)))
            }
        }?;
        Some(first.x_advance)
    })
}

/// Draws glyphs, which have y upward, into a path.
struct Pen {
    path: PathBuilder,
    scale: f64,
    start: f64,
}

impl Pen {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        let (x, y) = (f64::from(x), f64::from(y));
        ((self.start + x * self.scale) as f32, (-y * self.scale) as f32)
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_as_wide_as_their_glyphs_with_kerning() {
        // Advances and kerning in the tables `hmtx` and `GPOS` of the file, 2048 units an em.
        for (text, units) in [
            ("", 0),
            ("1.2", 1171 + 549 + 1171),
            ("\u{b5}m", 1276 + 1915),
            ("Te", 1139 - 70 + 1155),
            ("AV", 1309 - 40 + 1229),
            ("A V", 1309 + 532 + 1229),
        ] {
            let width = text_width(text, 10);
            assert!((width - f64::from(units) * 10.0 / 2048.0).abs() < 1e-9, "{text}: {width}");
            assert_eq!(outlines(text, 10, false).1, width);
        }
        assert!(outlines("Te", 10, true).1 > text_width("Te", 10));
    }

    #[test]
    fn outlines_stand_on_the_baseline() {
        let (path, width) = outlines("T", 100, false);
        let ink = path.unwrap().bounds();
        // The height of capitals in Noto Sans is 1462 units.
        assert!((f64::from(ink.top()) + 71.39).abs() < 0.01, "{}", ink.top());
        assert_eq!(ink.bottom(), 0.0);
        assert!(ink.left() > 0.0 && f64::from(ink.right()) < width);
        assert!(outlines(" \u{1b}", 100, false).0.is_none());
    }
}
