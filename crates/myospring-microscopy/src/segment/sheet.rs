//! Whether a picture is full of its like: a sheet, a tissue, or a cell that is larger than it.

use super::confidence::{Confidence, PATCH};

/// Part of the frame's rim that is covered: by a sheet, and by a cell that is larger than the picture.
const FRAME: [f64; 2] = [0.55, 0.35];
/// Below this factor a person is told.
const TOLD: f64 = 0.8;
/// Part of the area found that is patches of something larger, in a picture of a sheet.
const PATCHES: f64 = 0.5;

/// Why all cells of a picture are doubtful at once.
const LIKE_A_SHEET: &str = "the picture looks like a sheet";

/// What was found, as it counts for a sheet.
pub(super) struct Part<'a> {
    pub(super) pixels: usize,
    pub(super) on_frame: usize,
    pub(super) confidence: &'a mut Confidence,
}

/// Lowers the confidence of all cells of a picture that looks like a sheet, and says what a person should know of it;
/// `rim_of_frame` is how many pixels lie on the frame.
pub(super) fn weigh(parts: &mut [Part<'_>], rim_of_frame: usize) -> Option<String> {
    let on_frame: usize = parts.iter().map(|part| part.on_frame).sum();
    let covered = on_frame as f64 / rim_of_frame.max(1) as f64;
    let factor = ((FRAME[0] - covered) / (FRAME[0] - FRAME[1])).clamp(0.0, 1.0);
    let is_patch =
        |part: &&Part<'_>| part.confidence.reasons.iter().any(|reason| reason.starts_with(PATCH));
    let all: usize = parts.iter().map(|part| part.pixels).sum();
    let patches: usize = parts.iter().filter(is_patch).map(|part| part.pixels).sum();
    let seen = if factor < TOLD {
        format!("what was found covers {:.0} % of the picture's rim", 100.0 * covered)
    } else if patches > 0 && patches as f64 >= PATCHES * all as f64 {
        "what was found goes on beyond its outlines".to_owned()
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
