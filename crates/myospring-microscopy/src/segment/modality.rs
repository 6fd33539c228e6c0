//! How a picture was taken, told from its grey values.

use myospring_core::mesh::pixel_size::PixelSize;
use std::collections::{BTreeSet, HashMap};

use super::Modality;
use super::ground::Ground;
use crate::filter::{self, quantile, sample};
use crate::plane::Plane;

/// A fluorescent cell is brighter than the background by so many times what anything is darker; in brightfield
/// a cell has darker places as well as brighter ones, and noise has as much of both.
const BRIGHTER: f32 = 2.0;

/// Scale of smoothing before that is asked, um: noise is as often darker as brighter.
const SMOOTH_UM: f64 = 1.0;

/// Part of the picture that may be brighter or darker without counting: dust, dead pixels.
const TAIL: f64 = 0.005;

/// Most values of a mask with labels of its own.
const MOST_LABELS: usize = 4096;

/// A label borders on itself so many times as often as on other labels.
const FLAT: u64 = 3;

/// A picture changes from pixel to pixel; the rows of a mask do so in one pixel of so many at the most.
const CHANGES: usize = 12;

/// Tells a mask, a fluorescence picture and a brightfield picture from each other.
pub(super) fn guess(plane: &Plane, pixel_size: PixelSize, notes: &mut Vec<String>) -> Modality {
    if is_mask(plane) {
        return Modality::Mask;
    }
    let factor = ((SMOOTH_UM / 2.0 / pixel_size.um()).round() as usize).max(1);
    let coarse = filter::coarse(plane, factor);
    let smooth = filter::gaussian(&coarse, SMOOTH_UM / (pixel_size.um() * factor as f64));
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

/// Whether most values that are not 0 border on themselves wherever they do not border on 0, as the inside of a
/// label does; those of a soft edge do not.
pub(super) fn has_flat_labels(plane: &Plane) -> bool {
    let width = plane.width();
    let values = plane.values();
    let mut pairs: HashMap<u32, [u64; 2]> = HashMap::new();
    let mut count = |of: f32, same: bool, by: u64| {
        pairs.entry(of.to_bits()).or_default()[usize::from(same)] += by;
    };
    // Equal pairs in a row come after each other and are counted together.
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
