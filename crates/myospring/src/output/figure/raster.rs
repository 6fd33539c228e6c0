//! SVG to PNG with an embedded font.

use std::sync::{Arc, OnceLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

use super::FigureError;

/// Draws an SVG with `dpi` pixels per inch.
pub(super) fn png(svg: &str, dpi: f64) -> Result<Vec<u8>, FigureError> {
    if !(10.0..=2400.0).contains(&dpi) {
        return Err(FigureError::Resolution { dpi });
    }
    let failed = |reason: String| FigureError::Raster { reason };
    let tree = Tree::from_str(svg, &options()).map_err(|error| failed(error.to_string()))?;
    let scale = dpi / 96.0;
    let size = tree.size();
    let pixels = |length: f32| (f64::from(length) * scale).round().max(1.0) as u32;
    let (width, height) = (pixels(size.width()), pixels(size.height()));
    let mut pixmap = Pixmap::new(width, height).ok_or_else(|| {
        failed(format!("{width} x {height} pixels are too many; lower the resolution of {dpi} dpi"))
    })?;
    // The last row and column are covered whole even where the size was rounded up.
    let transform =
        Transform::from_scale(width as f32 / size.width(), height as f32 / size.height());
    resvg::render(&tree, transform, &mut pixmap.as_mut());
    let bytes = pixmap.encode_png().map_err(|error| failed(error.to_string()))?;
    Ok(with_resolution(bytes, dpi))
}

fn options() -> Options<'static> {
    static FONTS: OnceLock<Arc<fontdb::Database>> = OnceLock::new();
    let fonts = FONTS.get_or_init(|| {
        let mut fonts = fontdb::Database::new();
        fonts.load_font_source(fontdb::Source::Binary(Arc::new(notosans::REGULAR_TTF)));
        fonts.load_font_source(fontdb::Source::Binary(Arc::new(notosans::BOLD_TTF)));
        fonts.set_sans_serif_family("Noto Sans");
        Arc::new(fonts)
    });
    Options { fontdb: Arc::clone(fonts), font_family: "Noto Sans".to_owned(), ..Options::default() }
}

/// Length of the PNG signature and its header chunk, after which other chunks may stand.
const HEADER: usize = 33;

/// Adds the `pHYs` chunk (PNG specification, 11.3.5.3): pixels per metre along x and y.
fn with_resolution(mut png: Vec<u8>, dpi: f64) -> Vec<u8> {
    if png.len() < HEADER {
        return png;
    }
    let per_metre = ((dpi / 0.0254).round() as u32).to_be_bytes();
    let mut chunk = b"pHYs".to_vec();
    chunk.extend(per_metre);
    chunk.extend(per_metre);
    chunk.push(1);
    let sum = crc32(&chunk).to_be_bytes();
    chunk.extend(sum);
    png.splice(HEADER..HEADER, 9u32.to_be_bytes().into_iter().chain(chunk));
    png
}

/// The checksum of PNG chunks (PNG specification, annex D).
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| {
            if sum & 1 == 1 { 0xedb8_8320 ^ (sum >> 1) } else { sum >> 1 }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_that_of_the_png_specification() {
        // Every PNG ends with this chunk.
        assert_eq!(crc32(b"IEND"), 0xae42_6082);
    }

    #[test]
    fn resolutions_outside_the_range_are_refused() {
        for dpi in [0.0, -300.0, 1e9, f64::NAN] {
            assert!(matches!(png("<svg/>", dpi), Err(FigureError::Resolution { .. })));
        }
        assert!(matches!(png("no svg", 300.0), Err(FigureError::Raster { .. })));
    }
}
