//! How a picture was taken, told from its grey values.

use std::collections::BTreeSet;

use super::Modality;
use super::ground::Ground;
use crate::microscopy::filter::{self, quantile, sample};
use crate::microscopy::plane::Plane;

/// A fluorescent cell is brighter than the background by so many times what anything is darker; in brightfield
/// a cell has darker places as well as brighter ones.
const BRIGHTER: f32 = 3.0;

/// Scale of smoothing before that is asked, um: noise is as often darker as brighter.
const SMOOTH_UM: f64 = 1.0;

/// Part of the picture that may be brighter or darker without counting: dust, dead pixels.
const TAIL: f64 = 0.005;

/// Most values of a mask with labels of its own.
const MOST_LABELS: usize = 4096;

/// Tells a mask, a fluorescence picture and a brightfield picture from each other.
pub(super) fn guess(plane: &Plane, pixel_size_um: f64, notes: &mut Vec<String>) -> Modality {
    if is_mask(plane) {
        return Modality::Mask;
    }
    let factor = ((SMOOTH_UM / 2.0 / pixel_size_um).round() as usize).max(1);
    let coarse = filter::coarse(plane, factor);
    let smooth = filter::gaussian(&coarse, SMOOTH_UM / (pixel_size_um * factor as f64));
    let lifted = Ground::under(&smooth).taken_off(&smooth);
    let values = sample(lifted.values(), 200_000);
    let (up, down) = (quantile(&values, 1.0 - TAIL), -quantile(&values, TAIL));
    let brighter = up / down.max(1e-6 * up.abs()).max(f32::MIN_POSITIVE);
    let modality = if brighter > BRIGHTER { Modality::Fluorescence } else { Modality::Brightfield };
    let word = if modality == Modality::Fluorescence { "fluorescence" } else { "brightfield" };
    if (BRIGHTER / 1.5..BRIGHTER * 1.5).contains(&brighter) {
        notes.push(format!(
            "the picture was taken for {word}, though not surely: its brightest places are {brighter:.1} times as far \
             from the background as its darkest; say --modality if that is wrong"
        ));
    }
    modality
}

/// Whether the values are labels: whole, few, 0 among them, and neighbours mostly equal.
fn is_mask(plane: &Plane) -> bool {
    let mut values = BTreeSet::new();
    let mut changes = 0;
    let mut last = f32::NAN;
    for &value in plane.values() {
        if value != last {
            if value < 0.0 || value.fract() != 0.0 {
                return false;
            }
            changes += 1;
            values.insert(value.to_bits());
            if values.len() > MOST_LABELS {
                return false;
            }
        }
        last = value;
    }
    let zero = values.contains(&0.0_f32.to_bits());
    // A picture changes from pixel to pixel; the rows of a mask do so some times each, per label.
    zero && (values.len() == 2 || changes * 12 < plane.values().len() && has_flat_labels(plane))
}

/// Whether each value that is not 0 mostly borders on itself, as the inside of a label does.
pub(super) fn has_flat_labels(plane: &Plane) -> bool {
    let width = plane.width();
    let (mut same, mut all) = (0_usize, 0_usize);
    for row in plane.values().chunks_exact(width) {
        for pair in row.windows(2) {
            if pair[0] != 0.0 {
                all += 1;
                same += usize::from(pair[0] == pair[1]);
            }
        }
    }
    same * 10 > all * 9
}
