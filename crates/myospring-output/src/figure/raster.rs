//! A figure as PNG, painted with the embedded font.

use png::{BitDepth, ColorType, Compression, Encoder, PixelDimensions, Unit};
use tiny_skia::{
    Color, ColorU8, FillRule, FilterQuality, LineCap, LineJoin, Mask, Paint, PathBuilder, Pattern,
    Pixmap, Rect, SpreadMode, StrokeDash, Transform,
};

use super::sheet::{Anchor, Area, Element, Figure, HALO, Look, Path, Picture, Step, Style};
use super::theme::Colour;
use super::{FigureError, font};

/// Draws a figure with `dpi` pixels per inch.
pub(super) fn png(figure: &Figure, dpi: f64) -> Result<Vec<u8>, FigureError> {
    if !(10.0..=2400.0).contains(&dpi) {
        return Err(FigureError::Resolution { dpi });
    }
    let pixels = painted(figure, dpi)?;
    encoded(pixels.size, ColorType::Rgb, &pixels.colours, Some(dpi))
}

/// A painted figure: red, green and blue of each pixel, row by row from the top left.
pub(super) struct Pixels {
    pub(super) size: [u32; 2],
    pub(super) colours: Vec<u8>,
}

/// Paints a figure with `dpi` pixels per inch.
pub(super) fn painted(figure: &Figure, dpi: f64) -> Result<Pixels, FigureError> {
    let [width, height] = figure.size.map(|length| (length * dpi / 96.0).round().max(1.0) as u32);
    let mut pixmap = Pixmap::new(width, height).ok_or_else(|| FigureError::Raster {
        reason: format!(
            "{width} x {height} pixels are too many; lower the resolution of {dpi} dpi"
        ),
    })?;
    // The last row and column are covered completely even if the size was rounded up.
    let scale = [f64::from(width) / figure.size[0], f64::from(height) / figure.size[1]];
    let transform = Transform::from_scale(scale[0] as f32, scale[1] as f32);
    let [red, green, blue] = figure.paper.channels();
    pixmap.fill(Color::from_rgba8(red, green, blue, u8::MAX));
    Canvas { pixmap: &mut pixmap, transform, mask: None }.draw(&figure.elements);
    let mut colours = vec![0; 3 * pixmap.pixels().len()];
    for (rgb, rgba) in colours.chunks_exact_mut(3).zip(pixmap.data().chunks_exact(4)) {
        // The page is opaque.
        rgb.copy_from_slice(&rgba[..3]);
    }
    Ok(Pixels { size: [width, height], colours })
}

/// Encodes a grey picture for embedding.
pub(super) fn grey_png(size: [u32; 2], grey: &[u8]) -> Result<Vec<u8>, FigureError> {
    encoded(size, ColorType::Grayscale, grey, None)
}

/// Bytes of a PNG with 8 bits per channel.
fn encoded(
    [width, height]: [u32; 2],
    colour: ColorType,
    pixels: &[u8],
    dpi: Option<f64>,
) -> Result<Vec<u8>, FigureError> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(colour);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Balanced);
    encoder.set_pixel_dims(dpi.map(|dpi| {
        let per_metre = (dpi / 0.0254).round() as u32;
        PixelDimensions { xppu: per_metre, yppu: per_metre, unit: Unit::Meter }
    }));
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(pixels)?;
        writer.finish()
    });
    match written {
        Ok(()) => Ok(bytes),
        Err(error) => Err(FigureError::Raster { reason: error.to_string() }),
    }
}

/// Pixels, the transformation from px to pixels, and the clipping mask.
struct Canvas<'a> {
    pixmap: &'a mut Pixmap,
    transform: Transform,
    mask: Option<&'a Mask>,
}

impl Canvas<'_> {
    fn draw(&mut self, elements: &[Element]) {
        for element in elements {
            match element {
                Element::Path { path, look } => {
                    if let Some(path) = outline(path) {
                        self.paint(&path, *look, self.transform);
                    }
                }
                Element::Circle { centre: [x, y], radius, look } => {
                    let [x, y, radius] = [*x, *y, *radius].map(|length| length as f32);
                    if let Some(circle) = PathBuilder::from_circle(x, y, radius) {
                        self.paint(&circle, *look, self.transform);
                    }
                }
                Element::Text { at, text, style } => self.write(*at, text, *style),
                Element::Picture { place, picture } => self.show(*place, picture),
                Element::Window { frame, inside, .. } => self.look_through(frame, inside),
            }
        }
    }

    fn paint(&mut self, path: &tiny_skia::Path, look: Look, transform: Transform) {
        if let Some(colour) = look.fill {
            let paint = ink(colour, 1.0);
            self.pixmap.fill_path(path, &paint, FillRule::Winding, transform, self.mask);
        }
        if let Some(pen) = look.stroke {
            let stroke = tiny_skia::Stroke {
                width: pen.width as f32,
                line_cap: if pen.round_ends { LineCap::Round } else { LineCap::Butt },
                line_join: LineJoin::Round,
                dash: pen.dash.and_then(|dash| {
                    StrokeDash::new(dash.map(|length| length as f32).to_vec(), 0.0)
                }),
                ..tiny_skia::Stroke::default()
            };
            let paint = ink(pen.colour, pen.opacity);
            self.pixmap.stroke_path(path, &paint, &stroke, transform, self.mask);
        }
    }

    fn write(&mut self, [x, y]: [f64; 2], text: &str, style: Style) {
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
        let transform = self.transform.pre_concat(place).pre_translate(-before as f32, 0.0);
        if style.halo {
            self.paint(&outlines, HALO.into(), transform);
        }
        self.paint(&outlines, Look::fill(style.colour), transform);
    }

    fn show(&mut self, place: Area, picture: &Picture) {
        let [columns, rows] = picture.size;
        let (Some(mut pixels), Some(area)) = (Pixmap::new(columns, rows), rect(place)) else {
            return;
        };
        for (pixel, &level) in pixels.pixels_mut().iter_mut().zip(&picture.grey) {
            *pixel = ColorU8::from_rgba(level, level, level, u8::MAX).premultiply();
        }
        let spread = Transform::from_row(
            area.width() / columns as f32,
            0.0,
            0.0,
            area.height() / rows as f32,
            area.x(),
            area.y(),
        );
        let shader =
            Pattern::new(pixels.as_ref(), SpreadMode::Pad, FilterQuality::Bilinear, 1.0, spread);
        let paint = Paint { shader, ..Paint::default() };
        self.pixmap.fill_rect(area, &paint, self.transform, self.mask);
    }

    /// Draws elements, clipped to closed lines.
    fn look_through(&mut self, frame: &Path, inside: &[Element]) {
        let path = outline(frame);
        let mask = match self.mask.cloned() {
            // A window in a window.
            Some(mut mask) => {
                let Some(path) = path else { return };
                mask.intersect_path(&path, FillRule::Winding, true, self.transform);
                Some(mask)
            }
            None => Mask::new(self.pixmap.width(), self.pixmap.height()).map(|mut mask| {
                if let Some(path) = path {
                    mask.fill_path(&path, FillRule::Winding, true, self.transform);
                }
                mask
            }),
        };
        let Some(mask) = mask else { return };
        Canvas { pixmap: self.pixmap, transform: self.transform, mask: Some(&mask) }.draw(inside);
    }
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
    fn text_becomes_ink_without_fonts_of_the_system() {
        let drawn = |text| png(&page(text), 96.0).unwrap();
        assert_ne!(drawn("\u{b5}m"), drawn(""));
        assert_eq!(drawn(" "), drawn(""));
    }
}
