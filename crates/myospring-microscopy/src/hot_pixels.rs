//! Hot pixels: single pixels far beyond everything else in the picture, from a damaged sensor or a cosmic ray.
//!
//! A single hot pixel stretches the range of grey values until nothing else is visible, and
//! smoothing spreads it. The reference range consists of the values that a pixel shares with at
//! least two neighbours. A pixel is hot if it lies outside that range by more than three times the
//! range's width, and if such pixels are few: true dots of one pixel are many and of similar
//! height.

use crate::plane::Plane;

/// Least distance of a hot pixel from the range of all other pixels, in widths of that range; noise
/// and dots stay within one.
const BEYOND: f64 = 3.0;

/// At most one pixel of this number may be hot; more are a structure in the picture.
const ONE_IN: usize = 20_000;

/// This number of hot pixels is accepted in a picture of any size.
const FEW: usize = 8;

/// The plane with each hot pixel replaced by the median of its neighbours, and a note on them;
/// `None` if there are none.
///
/// # Example
/// ```
/// use myospring::microscopy::{hot_pixels, plane::Plane};
/// let mut values: Vec<f32> = (0..30 * 20).map(|at| (at % 7) as f32).collect();
/// assert!(hot_pixels::cooled(&Plane::new(30, 20, values.clone()).unwrap()).is_none());
/// values[5 * 30 + 12] = 1e38;
/// let (cooled, note) = hot_pixels::cooled(&Plane::new(30, 20, values).unwrap()).unwrap();
/// assert!(cooled.range()[1] <= 6.0);
/// assert!(note.starts_with("1 hot pixel, 1e38 at column 12, row 5,"));
/// ```
pub fn cooled(plane: &Plane) -> Option<(Plane, String)> {
    let (width, height) = (plane.width(), plane.height());
    if width < 3 || height < 3 {
        return None;
    }
    let [low, high] = borne_out(plane);
    // The difference of the largest floats would overflow `f32`.
    let [low, high] = [low, high].map(f64::from);
    let slack = BEYOND * (high - low);
    let is_hot = |value: f32| {
        let value = f64::from(value);
        value > high + slack || value < low - slack
    };
    let hot: Vec<usize> = (0..width * height).filter(|&at| is_hot(plane.values()[at])).collect();
    let most = FEW.max(width * height / ONE_IN);
    if hot.is_empty() || hot.len() > most {
        return None;
    }
    let mut values = plane.values().to_vec();
    for &at in &hot {
        let mut sane: Vec<f32> =
            neighbours(plane, at).into_iter().flatten().filter(|&value| !is_hot(value)).collect();
        sane.sort_by(f32::total_cmp);
        // A pixel whose neighbours are all hot is part of something larger: the picture stays as it is.
        values[at] = *sane.get(sane.len() / 2)?;
    }
    let note = note(plane, &hot, f64::midpoint(low, high))?;
    Some((Plane::new(width, height, values)?, note))
}

fn note(plane: &Plane, hot: &[usize], middle: f64) -> Option<String> {
    let off = |at: usize| (f64::from(plane.values()[at]) - middle).abs();
    let furthest = hot.iter().copied().max_by(|&a, &b| off(a).total_cmp(&off(b)))?;
    let (column, row) = (furthest % plane.width(), furthest / plane.width());
    let value = plane.values()[furthest];
    let value = if value.abs() < 1e7 { value.to_string() } else { format!("{value:e}") };
    let (count, taken) = match hot.len() {
        1 => (format!("1 hot pixel, {value}"), "was replaced by the median of its"),
        several => (
            format!("{several} hot pixels, the most extreme {value}"),
            "were replaced by the median of their",
        ),
    };
    Some(format!("{count} at column {column}, row {row}, {taken} neighbours"))
}

/// Smallest and largest value of the picture without isolated pixels and pairs: a value counts only
/// as far as at least two of its neighbours reach it.
fn borne_out(plane: &Plane) -> [f32; 2] {
    let values = plane.values();
    let [mut low, mut high] = [f32::INFINITY, f32::NEG_INFINITY];
    for (at, &value) in values.iter().enumerate() {
        // Most pixels change neither bound.
        if value > high {
            let [_, second] = largest_two(neighbours(plane, at).into_iter().flatten());
            high = high.max(value.min(second));
        }
        if value < low {
            let negative = neighbours(plane, at).into_iter().flatten().map(|value| -value);
            let [_, second] = largest_two(negative);
            low = low.min(value.max(-second));
        }
    }
    [low, high]
}

fn largest_two(values: impl Iterator<Item = f32>) -> [f32; 2] {
    values.fold([f32::NEG_INFINITY; 2], |[first, second], value| {
        if value > first { [value, first] } else { [first, second.max(value)] }
    })
}

/// The eight neighbours; fewer at the picture's rim.
fn neighbours(plane: &Plane, at: usize) -> [Option<f32>; 8] {
    const STEPS: [[isize; 2]; 8] =
        [[-1, -1], [0, -1], [1, -1], [-1, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];
    let (column, row) = (at % plane.width(), at / plane.width());
    STEPS.map(|[right, down]| {
        let column = column.checked_add_signed(right).filter(|&column| column < plane.width())?;
        let row = row.checked_add_signed(down).filter(|&row| row < plane.height())?;
        Some(plane.at(column, row))
    })
}
