//! Determines from the grey values how a picture was taken.

use std::collections::{BTreeSet, HashMap};

use super::Modality;
use super::fluorescence::Bright;
use super::ladder::Climbed;
use crate::plane::Plane;

/// Least ratio of brightness to texture evidence for fluorescence; it is below 1 because texture is
/// averaged over some um, so its islands are larger than the cell.
const AS_WELL: f64 = 0.6;

/// Below this ratio the modality is uncertain; above the other, the ratio is not reported.
const SURE: f64 = 1.4;
const MUCH: f64 = 10.0;

/// Largest number of different values of a label image.
const MOST_LABELS: usize = 4096;

/// A pixel of a label borders on the same label at least this many times as often as on other
/// labels.
const FLAT: u64 = 3;

/// A picture changes from pixel to pixel; in the rows of a mask, at most one pixel of this many
/// differs from the next.
const CHANGES: usize = 12;

/// Decides between fluorescence and brightfield, with the reason in words: whether brightness or
/// texture explains the cells better. (In brightfield, a cell has both darker and brighter places.)
/// `None` if neither shows a cell.
pub(super) fn by_evidence(bright: &Bright, texture: &Climbed) -> Option<(Modality, String)> {
    let texture = texture.value().sqrt();
    let brightness = bright.climbed.value().sqrt();
    let (modality, more, less, ratio) = if brightness > AS_WELL * texture {
        (Modality::Fluorescence, "brightness", "texture", brightness / (AS_WELL * texture))
    } else {
        (Modality::Brightfield, "texture", "brightness", AS_WELL * texture / brightness)
    };
    let reason = match ratio {
        ratio if ratio.is_nan() => return None,
        ratio if ratio > MUCH => {
            format!("objects differ from the background in their {more}, not in their {less}")
        }
        ratio => format!(
            "objects differ from the background {ratio:.1} times as clearly in their {more} as in their {less}"
        ),
    };
    let reason = if ratio < SURE { format!("{reason}, so this is uncertain") } else { reason };
    Some((modality, reason))
}

/// Whether the values are those of a mask: few, none below 0, 0 among them, and neighbours mostly equal.
pub(super) fn is_mask(plane: &Plane) -> bool {
    let mut values = BTreeSet::new();
    let mut changes = 0;
    let mut last = f32::NAN;
    for &value in plane.values() {
        if value != last {
            if value < 0.0 {
                return false;
            }
            changes += 1;
            values.insert(value.to_bits());
            let changes_often = changes * CHANGES >= plane.values().len();
            if values.len() > MOST_LABELS || values.len() > 2 && changes_often {
                return false;
            }
        }
        last = value;
    }
    let zero = values.contains(&0.0_f32.to_bits());
    zero && (values.len() == 2 || has_flat_labels(plane))
}

/// Whether most pixels with a value other than 0 border on equal pixels or 0, as in a label; those
/// of a soft edge do not.
pub(crate) fn has_flat_labels(plane: &Plane) -> bool {
    let width = plane.width();
    let values = plane.values();
    let mut pairs: HashMap<u32, [u64; 2]> = HashMap::new();
    let mut count = |of: f32, same: bool, by: u64| {
        pairs.entry(of.to_bits()).or_default()[usize::from(same)] += by;
    };
    // Consecutive equal pairs in a row are counted together.
    let (mut run, mut equal) = (0.0, 0);
    for (at, &value) in values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
        if value != run {
            count(run, true, std::mem::take(&mut equal));
            run = value;
        }
        let right = ((at + 1) % width != 0).then(|| values[at + 1]);
        for other in right.into_iter().chain(values.get(at + width).copied()) {
            if other == value {
                equal += 2;
            } else if other != 0.0 {
                count(value, false, 1);
                count(other, false, 1);
            }
        }
    }
    count(run, true, equal);
    let seen = pairs.values().filter(|[other, same]| other + same > 0);
    let flat = seen.clone().filter(|[other, same]| *same >= FLAT * other).count();
    2 * flat > seen.count() || pairs.values().all(|[other, _]| *other == 0)
}
