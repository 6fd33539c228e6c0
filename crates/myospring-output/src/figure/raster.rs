//! A figure as PNG, painted with the embedded font.

use std::io::{self, Write};

use png::{
    BitDepth, ColorType, DeflateCompression, Encoder, EncodingError, Filter, PixelDimensions, Unit,
};
use tiny_skia::{
    Color, ColorU8, FillRule, FilterQuality, LineCap, LineJoin, Mask, Paint, PathBuilder, Pattern,
    Pixmap, Rect, SpreadMode, StrokeDash, Transform,
};

use super::sheet::{Anchor, Area, Element, Figure, HALO, Look, Path, Picture, Step, Stroke, Style};
use super::theme::Colour;
use super::{FigureError, font};

/// Pixels of a band, which stay in the second-level cache.
const AT_ONCE: u32 = 1 << 17;
/// Level of deflate: half the time of level 6, and files that are larger by some per cent.
const LEVEL: u8 = 4;

/// Draws a figure with `dpi` pixels per inch.
pub(super) fn png(figure: &Figure, dpi: f64) -> Result<Vec<u8>, FigureError> {
    if !(10.0..=2400.0).contains(&dpi) {
        return Err(FigureError::Resolution { dpi });
    }
    let list = listed(figure, dpi);
    // Areas of one colour are shorter unfiltered, photographs filtered.
    let filter = if has_picture(&list.marks) { Filter::Adaptive } else { Filter::NoFilter };
    encoded(list.size, ColorType::Rgb, filter, Some(dpi), |rows| {
        list.paint(AT_ONCE, |band| rows(band))
    })
}

/// A painted figure: red, green and blue of each pixel, row by row from the top left.
pub(super) struct Pixels {
    pub(super) size: [u32; 2],
    pub(super) colours: Vec<u8>,
}

/// Paints a figure with `dpi` pixels per inch.
pub(super) fn painted(figure: &Figure, dpi: f64) -> Result<Pixels, FigureError> {
    let list = listed(figure, dpi);
    let mut colours = Vec::new();
    let whole: io::Result<()> = list.paint(AT_ONCE, |band| {
        colours.extend_from_slice(band);
        Ok(())
    });
    whole.map_err(unpainted)?;
    Ok(Pixels { size: list.size, colours })
}

/// Encodes a grey picture for embedding.
pub(super) fn grey_png(size: [u32; 2], grey: &[u8]) -> Result<Vec<u8>, FigureError> {
    encoded(size, ColorType::Grayscale, Filter::Adaptive, None, |rows| rows(grey))
}

/// Bytes of a PNG with 8 bits per channel; `give` passes on its rows, any number at a time.
fn encoded(
    [width, height]: [u32; 2],
    colour: ColorType,
    filter: Filter,
    dpi: Option<f64>,
    give: impl FnOnce(&mut dyn FnMut(&[u8]) -> io::Result<()>) -> io::Result<()>,
) -> Result<Vec<u8>, FigureError> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(colour);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_deflate_compression(DeflateCompression::Level(LEVEL));
    encoder.set_filter(filter);
    encoder.set_pixel_dims(dpi.map(|dpi| {
        let per_metre = (dpi / 0.0254).round() as u32;
        PixelDimensions { xppu: per_metre, yppu: per_metre, unit: Unit::Meter }
    }));
    let written = encoder.write_header().and_then(|mut writer| {
        let mut rows = writer.stream_writer()?;
        give(&mut |pixels| rows.write_all(pixels))?;
        rows.finish()?;
        writer.finish()
    });
    written.map_err(unpainted)?;
    Ok(bytes)
}

fn unpainted(error: impl Into<EncodingError>) -> FigureError {
    FigureError::Raster { reason: error.into().to_string() }
}

/// What is painted of a figure with `dpi` pixels per inch.
fn listed(figure: &Figure, dpi: f64) -> List {
    let size = figure.size.map(|length| (length * dpi / 96.0).round().max(1.0) as u32);
    // The last row and column are covered completely even if the size was rounded up.
    let [x, y] = [0, 1].map(|axis: usize| f64::from(size[axis]) / figure.size[axis]);
    let mut list = List {
        size,
        paper: figure.paper,
        to_pixels: Transform::from_scale(x as f32, y as f32),
        marks: Vec::new(),
    };
    list.marks = list.of(&figure.elements);
    list
}

/// The marks of a figure, in the order in which they are painted, in pixels.
struct List {
    size: [u32; 2],
    paper: Colour,
    /// From px.
    to_pixels: Transform,
    marks: Vec<Mark>,
}

/// Something that is painted.
struct Mark {
    /// Rows that it may touch.
    rows: [f32; 2],
    what: What,
}

enum What {
    /// An area, and the ink that fills it.
    Area(tiny_skia::Path, Paint<'static>),
    /// A line of at most one pixel.
    Hair(tiny_skia::Path, Paint<'static>, tiny_skia::Stroke),
    /// A grey picture, and where it goes, px.
    Picture(Pixmap, Rect),
    /// Marks that are clipped to an area.
    Window(tiny_skia::Path, Vec<Mark>),
}

impl List {
    fn of(&self, elements: &[Element]) -> Vec<Mark> {
        let mut marks = Vec::new();
        for element in elements {
            match element {
                Element::Path { path, look } => {
                    if let Some(path) = outline(path) {
                        self.draw(&mut marks, &path, *look, self.to_pixels);
                    }
                }
                Element::Circle { centre: [x, y], radius, look } => {
                    let [x, y, radius] = [*x, *y, *radius].map(|length| length as f32);
                    if let Some(circle) = PathBuilder::from_circle(x, y, radius) {
                        self.draw(&mut marks, &circle, *look, self.to_pixels);
                    }
                }
                Element::Text { at, text, style } => self.write(&mut marks, *at, text, *style),
                Element::Picture { place, picture } => {
                    if let Some((pixels, area)) = pixels(picture).zip(rect(*place)) {
                        let to = self.to_pixels;
                        let rows = [area.top(), area.bottom()].map(|y| to.sy * y);
                        marks.push(Mark { rows, what: What::Picture(pixels, area) });
                    }
                }
                Element::Window { frame, inside, .. } => {
                    let frame = outline(frame).and_then(|path| path.transform(self.to_pixels));
                    if let Some(frame) = frame {
                        let rows = rows(&frame);
                        marks.push(Mark { rows, what: What::Window(frame, self.of(inside)) });
                    }
                }
            }
        }
        marks
    }

    fn draw(&self, marks: &mut Vec<Mark>, path: &tiny_skia::Path, look: Look, to: Transform) {
        if let Some((area, colour)) = path.clone().transform(to).zip(look.fill) {
            marks.push(Mark { rows: rows(&area), what: What::Area(area, ink(colour, 1.0)) });
        }
        if let Some(pen) = look.stroke {
            marks.extend(self.line(path, pen, to));
        }
    }

    fn line(&self, path: &tiny_skia::Path, pen: Stroke, to: Transform) -> Option<Mark> {
        let scale = self.to_pixels.sx.max(self.to_pixels.sy);
        let dashed = pen.dash.and_then(|dash| {
            let dash = StrokeDash::new(dash.map(|length| length as f32).to_vec(), 0.0)?;
            path.dash(&dash, scale)
        });
        let path = dashed.as_ref().unwrap_or(path);
        let stroke = tiny_skia::Stroke {
            width: pen.width as f32,
            line_cap: if pen.round_ends { LineCap::Round } else { LineCap::Butt },
            line_join: LineJoin::Round,
            ..tiny_skia::Stroke::default()
        };
        let paint = ink(pen.colour, pen.opacity);
        let width = scale * stroke.width;
        if width > 1.0 {
            let area = path.stroke(&stroke, scale)?.transform(to)?;
            return Some(Mark { rows: rows(&area), what: What::Area(area, paint) });
        }
        let path = path.clone().transform(to)?;
        let [top, bottom] = rows(&path);
        let stroke = tiny_skia::Stroke { width, ..stroke };
        // The caps of a line of one pixel.
        Some(Mark { rows: [top - 1.0, bottom + 1.0], what: What::Hair(path, paint, stroke) })
    }

    fn write(&self, marks: &mut Vec<Mark>, [x, y]: [f64; 2], text: &str, style: Style) {
        let (outlines, width) = font::outlines(text, style.size, style.bold);
        let Some(outlines) = outlines else { return };
        let before = match style.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * width,
            Anchor::End => width,
        };
        let (x, y) = (x as f32, y as f32);
        let place = if style.upward {
            Transform::from_row(0.0, -1.0, 1.0, 0.0, x, y)
        } else {
            Transform::from_translate(x, y)
        };
        let to = self.to_pixels.pre_concat(place).pre_translate(-before as f32, 0.0);
        if style.halo {
            self.draw(marks, &outlines, HALO.into(), to);
        }
        self.draw(marks, &outlines, Look::fill(style.colour), to);
    }

    /// Paints one band of about `at_once` pixels after the other, from the top. `each` receives its colours: red, green and blue of
    /// each pixel.
    fn paint(&self, at_once: u32, mut each: impl FnMut(&[u8]) -> io::Result<()>) -> io::Result<()> {
        let [width, height] = self.size;
        // In bands of one or two rows tiny-skia draws no thin lines.
        let most = (at_once / width).max(8).min(height);
        let [red, green, blue] = self.paper.channels();
        let to_pixels = self.to_pixels;
        let Some(mut pixmap) = Pixmap::new(width, most) else {
            return Err(io::Error::other(format!(
                "{width} pixels in a row are too many; lower the resolution"
            )));
        };
        let mut colours = vec![0; 3 * pixmap.pixels().len()];
        for top in (0..height).step_by(most as usize) {
            pixmap.fill(Color::from_rgba8(red, green, blue, u8::MAX));
            Band { pixmap: &mut pixmap, top, to_pixels, mask: None }.paint(&self.marks);
            for (rgb, rgba) in colours.chunks_exact_mut(3).zip(pixmap.data().chunks_exact(4)) {
                // The page is opaque.
                rgb.copy_from_slice(&rgba[..3]);
            }
            each(&colours[..(3 * width * most.min(height - top)) as usize])?;
        }
        Ok(())
    }
}

/// Some rows of a figure, and what they are clipped to.
struct Band<'a> {
    pixmap: &'a mut Pixmap,
    /// The first row.
    top: u32,
    to_pixels: Transform,
    mask: Option<&'a Mask>,
}

impl Band<'_> {
    fn paint(&mut self, marks: &[Mark]) {
        let [first, last] = [self.top, self.top + self.pixmap.height()].map(|row| row as f32);
        let here = Transform::from_translate(0.0, -first);
        for Mark { rows: [top, bottom], what } in marks {
            if *bottom < first || *top > last {
                continue;
            }
            match what {
                What::Area(area, ink) => {
                    self.pixmap.fill_path(area, ink, FillRule::Winding, here, self.mask);
                }
                What::Hair(line, ink, stroke) => {
                    self.pixmap.stroke_path(line, ink, stroke, here, self.mask);
                }
                What::Picture(picture, area) => self.show(picture, *area, here),
                What::Window(frame, inside) => self.look_through(frame, inside, here),
            }
        }
    }

    fn show(&mut self, picture: &Pixmap, area: Rect, here: Transform) {
        let spread = Transform::from_row(
            area.width() / picture.width() as f32,
            0.0,
            0.0,
            area.height() / picture.height() as f32,
            area.x(),
            area.y(),
        );
        let shader =
            Pattern::new(picture.as_ref(), SpreadMode::Pad, FilterQuality::Bilinear, 1.0, spread);
        let paint = Paint { shader, ..Paint::default() };
        self.pixmap.fill_rect(area, &paint, self.to_pixels.post_concat(here), self.mask);
    }

    /// Paints marks, clipped to an area.
    fn look_through(&mut self, frame: &tiny_skia::Path, inside: &[Mark], here: Transform) {
        let mask = match self.mask.cloned() {
            // A window in a window.
            Some(mut mask) => {
                mask.intersect_path(frame, FillRule::Winding, true, here);
                Some(mask)
            }
            None => Mask::new(self.pixmap.width(), self.pixmap.height()).map(|mut mask| {
                mask.fill_path(frame, FillRule::Winding, true, here);
                mask
            }),
        };
        let Some(mask) = mask else { return };
        let Self { top, to_pixels, .. } = *self;
        Band { pixmap: self.pixmap, top, to_pixels, mask: Some(&mask) }.paint(inside);
    }
}

/// The rows from the top of a path to its bottom.
fn rows(path: &tiny_skia::Path) -> [f32; 2] {
    let bounds = path.bounds();
    [bounds.top(), bounds.bottom()]
}

/// Whether a picture is among some marks.
fn has_picture(marks: &[Mark]) -> bool {
    marks.iter().any(|mark| match &mark.what {
        What::Picture(..) => true,
        What::Window(_, inside) => has_picture(inside),
        What::Area(..) | What::Hair(..) => false,
    })
}

fn pixels(picture: &Picture) -> Option<Pixmap> {
    let [columns, rows] = picture.size;
    let mut pixels = Pixmap::new(columns, rows)?;
    for (pixel, &level) in pixels.pixels_mut().iter_mut().zip(&picture.grey) {
        *pixel = ColorU8::from_rgba(level, level, level, u8::MAX).premultiply();
    }
    Some(pixels)
}

fn ink(colour: Colour, opacity: f64) -> Paint<'static> {
    let [red, green, blue] = colour.channels();
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, (255.0 * opacity).round() as u8);
    paint
}

fn rect(Area { corner: [x, y], size: [width, height] }: Area) -> Option<Rect> {
    Rect::from_xywh(x as f32, y as f32, width as f32, height as f32)
}

fn outline(path: &Path) -> Option<tiny_skia::Path> {
    let mut outline = PathBuilder::with_capacity(path.steps.len(), path.steps.len());
    let px = |place: [i32; 2]| place.map(|hundredths| (f64::from(hundredths) / 100.0) as f32);
    for step in &path.steps {
        match *step {
            Step::Move(to) => outline.move_to(px(to)[0], px(to)[1]),
            Step::Line(to) => outline.line_to(px(to)[0], px(to)[1]),
            Step::Close => outline.close(),
        }
    }
    outline.finish()
}

#[cfg(test)]
mod tests {
    use super::super::sheet::Sheet;
    use super::super::theme::{INK, WHITE};
    use super::*;

    fn page(text: &str) -> Figure {
        let mut sheet = Sheet::default();
        sheet.text([5.0, 15.0], text, Style::new(11));
        sheet.finish(96.0, 48.0)
    }

    #[test]
    fn resolutions_outside_the_range_are_refused() {
        for dpi in [0.0, -300.0, 9.9, 2401.0, 1e9, f64::NAN] {
            assert!(matches!(png(&page(""), dpi), Err(FigureError::Resolution { .. })));
        }
    }

    #[test]
    fn the_file_says_how_large_it_is_and_how_fine() {
        let bytes = png(&page("text"), 300.0).unwrap();
        let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        assert_eq!(reader.info().size(), (300, 150));
        let Some(PixelDimensions { xppu, yppu, unit }) = reader.info().pixel_dims else { panic!() };
        // 300 / 0.0254 pixels per metre.
        assert_eq!((xppu, yppu, unit), (11811, 11811, Unit::Meter));
    }

    #[test]
    fn a_figure_is_the_same_in_many_bands_and_in_one() {
        let (ink, thin) = (Stroke::new(INK, 1.3), Stroke::new(INK, 0.2));
        let at = |corner: [f64; 2], size: [f64; 2]| Area { corner, size };
        let mut sheet = Sheet::default();
        sheet.rect([3.0, 4.0], [60.0, 37.3], Look::fill(INK));
        sheet.line([2.0, 1.0], [93.0, 47.0], ink.dash(3.0, 2.0));
        sheet.line([2.0, 46.0], [93.0, 1.0], thin);
        sheet.path(Path::line([[70.0, 2.0], [71.0, 46.0], [80.0, 3.0]]), ink.round_ends());
        sheet.dot([80.0, 24.0], INK);
        let style = Style::new(11).colour(WHITE);
        sheet.text([20.0, 40.0], "across", Style { upward: true, halo: true, ..style });
        let grey: Vec<u8> = (0..48).map(|value| 5 * value).collect();
        let picture = Picture { size: [8, 6], grey, png: Vec::new() };
        sheet.picture(at([60.0, 10.0], [20.0, 30.0]), picture.clone());
        let mut within = Sheet::default();
        within.rect([0.0, 0.0], [96.0, 48.0], Look::fill(WHITE));
        let mut inner = Sheet::default();
        inner.picture(at([10.0, 5.0], [30.0, 40.0]), picture);
        within.window(
            "inner".to_owned(),
            Path::line([[5.0, 5.0], [40.0, 8.0], [20.0, 44.0]]),
            inner,
        );
        sheet.window("outer".to_owned(), Path::rect(at([8.0, 8.0], [30.0, 36.0])), within);
        let figure = sheet.finish(96.0, 48.0);

        for dpi in [96.0, 300.0] {
            let list = listed(&figure, dpi);
            let size = list.size;
            let of = |at_once: u32| {
                let mut colours = Vec::new();
                let all = list.paint(at_once, |band| {
                    colours.extend_from_slice(band);
                    Ok(())
                });
                all.unwrap();
                colours
            };
            let (whole, bands) = (of(size[0] * size[1]), of(1));
            assert_eq!(whole.len(), (3 * size[0] * size[1]) as usize);
            let apart = whole.iter().zip(&bands).filter(|(a, b)| a.abs_diff(**b) > 8);
            // Edges are cut at the border of a band and rounded anew.
            let (apart, painted) =
                (apart.count(), whole.iter().filter(|&&value| value != 255).count());
            assert!(apart < painted / 500, "{apart} of {painted} at {dpi} dpi");
        }
    }

    #[test]
    fn text_becomes_ink_without_fonts_of_the_system() {
        let drawn = |text| png(&page(text), 96.0).unwrap();
        assert_ne!(drawn("\u{b5}m"), drawn(""));
        assert_eq!(drawn(" "), drawn(""));
    }
}
