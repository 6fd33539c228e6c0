//! Recognises a picture of a sheet, a tissue, or a cell larger than the picture.

use super::confidence::{Confidence, PATCH};

/// Part of the frame's rim that a sheet covers, and that a large cell covers.
const FRAME: [f64; 2] = [0.55, 0.35];
/// Factor below which a warning is given.
const TOLD: f64 = 0.8;
/// Least part of the segmented area that consists of patches, in a picture of a sheet.
const PATCHES: f64 = 0.5;

/// Reason why all cells of a picture are doubtful.
const LIKE_A_SHEET: &str = "the picture looks like a sheet";

/// A segmented object, as needed to recognise a sheet.
pub(super) struct Part<'a> {
    pub(super) pixels: usize,
    pub(super) on_frame: usize,
    pub(super) confidence: &'a mut Confidence,
}

/// Lowers the confidence of all cells of a picture that looks like a sheet, and returns a warning;
/// `rim_of_frame` is the number of pixels on the frame.
pub(super) fn weigh(parts: &mut [Part<'_>], rim_of_frame: usize) -> Option<String> {
    let on_frame: usize = parts.iter().map(|part| part.on_frame).sum();
    let covered = on_frame as f64 / rim_of_frame.max(1) as f64;
    let factor = ((FRAME[0] - covered) / (FRAME[0] - FRAME[1])).clamp(0.0, 1.0);
    let is_patch =
        |part: &&Part<'_>| part.confidence.reasons.iter().any(|reason| reason.starts_with(PATCH));
    let all: usize = parts.iter().map(|part| part.pixels).sum();
    let patches: usize = parts.iter().filter(is_patch).map(|part| part.pixels).sum();
    let seen = if factor < TOLD {
        format!("the segmented area covers {:.0} % of the picture's rim", 100.0 * covered)
    } else if patches > 0 && patches as f64 >= PATCHES * all as f64 {
        "the picture continues beyond the outlines as it is inside them".to_owned()
    } else {
        return None;
    };
    for part in parts {
        part.confidence.score *= factor;
        part.confidence.reasons.push(LIKE_A_SHEET.to_owned());
    }
    Some(format!(
        "this looks like a sheet, a tissue, or a cell larger than the picture: {seen}. Do not trust an outline of a \
         single cell here; `myospring segment --whole-frame` reads fibres and sarcomeres without one"
    ))
}
