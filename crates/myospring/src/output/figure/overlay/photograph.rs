//! A part of a picture as PNG text within an SVG.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::imageops::thumbnail;
use image::{ExtendedColorType, GrayImage, ImageEncoder};

use super::super::FigureError;
use super::Overlay;

/// Longest side of an embedded picture, pixels.
pub(super) const LONGEST: u32 = 1600;

/// Parts of the pixels that become black and white: a few hot pixels or a speck of dirt must not
/// darken the cell.
const DARKEST: f64 = 0.005;
const BRIGHTEST: f64 = 0.998;

/// Values that are looked at for the percentiles.
const LOOKED_AT: usize = 100_000;

/// Columns `left` to `right` and rows `top` to `bottom` of the picture as a data URI, about `wanted`
/// pixels wide at most.
pub(super) fn data_uri(
    overlay: &Overlay<'_>,
    [left, right, top, bottom]: [usize; 4],
    wanted: f64,
) -> Result<String, FigureError> {
    let rows = || overlay.values.chunks_exact(overlay.width).take(bottom).skip(top);
    let [low, high] = percentiles(rows().map(|row| &row[left..right]));
    let scale = if high > low { 255.0 / (high - low) } else { 0.0 };
    let flat = if high > low { 0.0 } else { 96.0 };
    let grey: Vec<u8> = rows()
        .flat_map(|row| &row[left..right])
        // Values that are not numbers become black.
        .map(|value| ((value - low) * scale + flat).clamp(0.0, 255.0).round() as u8)
        .collect();
    let size = [(right - left) as u32, (bottom - top) as u32];
    let failed = |reason: String| FigureError::Raster { reason };
    let picture = GrayImage::from_raw(size[0], size[1], grey)
        .ok_or_else(|| failed("its picture has another number of pixels".to_owned()))?;
    let picture = reduced(picture, wanted);
    let mut png = Vec::new();
    PngEncoder::new_with_quality(&mut png, CompressionType::Fast, FilterType::Up)
        .write_image(picture.as_raw(), picture.width(), picture.height(), ExtendedColorType::L8)
        .map_err(|error| failed(error.to_string()))?;
    Ok(format!("data:image/png;base64,{}", STANDARD.encode(png)))
}

/// The picture at no more pixels than will be seen.
fn reduced(picture: GrayImage, wanted: f64) -> GrayImage {
    let (width, height) = picture.dimensions();
    let factor = (wanted / f64::from(width)).min(f64::from(LONGEST) / f64::from(width.max(height)));
    if factor >= 1.0 {
        return picture;
    }
    let side = |length: u32| ((f64::from(length) * factor).round() as u32).max(1);
    thumbnail(&picture, side(width), side(height))
}

/// The values that become black and white.
fn percentiles<'a>(rows: impl Iterator<Item = &'a [f32]> + Clone) -> [f32; 2] {
    let count: usize = rows.clone().map(<[f32]>::len).sum();
    // An odd step does not keep to the columns of a picture with an even width.
    let step = (count / LOOKED_AT) | 1;
    let mut seen: Vec<f32> =
        rows.flatten().copied().step_by(step).filter(|value| value.is_finite()).collect();
    if seen.is_empty() {
        return [0.0; 2];
    }
    let last = seen.len() - 1;
    let mut pick = |part: f64| {
        let place = (part * last as f64).round() as usize;
        *seen.select_nth_unstable_by(place, f32::total_cmp).1
    };
    [pick(DARKEST), pick(BRIGHTEST)]
}
