//! Colours of a field: perceptually even, light at rest, readable with any colour vision.

use super::Field;

/// Colours below rest: magma (van der Walt and Smith 2015, CC0), reversed and without its darkest
/// end.
const LESS: [[u8; 3]; 17] = [
    [0xfc, 0xfd, 0xbf],
    [0xfd, 0xe3, 0xa5],
    [0xfe, 0xcc, 0x8f],
    [0xfe, 0xb2, 0x7a],
    [0xfd, 0x9a, 0x6a],
    [0xfa, 0x7f, 0x5e],
    [0xf4, 0x67, 0x5c],
    [0xe7, 0x52, 0x63],
    [0xd3, 0x43, 0x6e],
    [0xbf, 0x3a, 0x77],
    [0xa8, 0x32, 0x7d],
    [0x93, 0x2b, 0x80],
    [0x7c, 0x23, 0x82],
    [0x68, 0x1c, 0x81],
    [0x52, 0x13, 0x7c],
    [0x3d, 0x0f, 0x71],
    [0x25, 0x12, 0x55],
];
/// Colours above rest: the greens and blues of `YlGnBu` (Brewer 2003, Apache-2.0).
const MORE: [[u8; 3]; 7] = [
    [0xfc, 0xfd, 0xbf],
    [0xc7, 0xe9, 0xb4],
    [0x7f, 0xcd, 0xbb],
    [0x41, 0xb6, 0xc4],
    [0x1d, 0x91, 0xc0],
    [0x22, 0x5e, 0xa8],
    [0x0c, 0x2c, 0x84],
];

/// The colour at a fraction of the way from the smallest value of a map to the largest, light to
/// dark.
pub(crate) fn light_to_dark(part: f64) -> [u8; 3] {
    along(&MORE, part)
}

/// The colour at a fraction of the way through a colour map, interpolated.
fn along(map: &[[u8; 3]], part: f64) -> [u8; 3] {
    let place = part.clamp(0.0, 1.0) * (map.len() - 1) as f64;
    let below = (place.floor() as usize).min(map.len() - 2);
    let part = place - below as f64;
    [0, 1, 2].map(|channel: usize| {
        let (a, b) = (f64::from(map[below][channel]), f64::from(map[below + 1][channel]));
        (a + part * (b - a)).round() as u8
    })
}

/// The colours of a field between two values.
///
/// Rest is light; values below rest run through red to purple, values above through green to blue.
/// Both sides have the same scale, so the side with the smaller range stays lighter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourScale {
    field: Field,
    limits: [f64; 2],
    /// The value that is light.
    light: f64,
}

impl ColourScale {
    /// Between the limits that [`Field::limits`] gives.
    ///
    /// # Example
    /// ```
    /// use myospring::output::field::{ColourScale, Field};
    /// let scale = ColourScale::new(Field::FibreStrain, [-12.0, 3.0]);
    /// assert_eq!(scale.colour(0.0), [0xfc, 0xfd, 0xbf]);
    /// assert_eq!(scale.colour(-12.0), [0x25, 0x12, 0x55]);
    /// assert_eq!(scale.steps(2), [scale.colour(-12.0), scale.colour(3.0)]);
    /// ```
    pub fn new(field: Field, limits: [f64; 2]) -> Self {
        Self { field, limits, light: field.at_rest() }
    }

    /// The same with another value that is light than the field at rest.
    #[must_use]
    pub fn light_at(self, light: f64) -> Self {
        Self { light, ..self }
    }

    /// The field.
    pub fn field(&self) -> Field {
        self.field
    }

    /// Least and greatest value.
    pub fn limits(&self) -> [f64; 2] {
        self.limits
    }

    /// Red, green and blue of a value; beyond the limits it is the colour of the nearer limit, and
    /// for values that are not finite that of rest.
    pub fn colour(&self, value: f64) -> [u8; 3] {
        let [low, high] = self.limits;
        let rest = self.light;
        let reach = (high - rest).max(rest - low);
        let away = if value.is_finite() { value.min(high).max(low) - rest } else { 0.0 };
        let relative = if reach > 0.0 { away / reach } else { 0.0 };
        let map: &[[u8; 3]] = if relative <= 0.0 { &LESS } else { &MORE };
        along(map, relative.abs())
    }

    /// The value at a fraction of the way from the lower limit to the upper.
    pub fn value(&self, part: f64) -> f64 {
        let [low, high] = self.limits;
        low + part * (high - low)
    }

    /// The colour of one of `count` equal steps between the limits: that of its middle.
    pub fn step(&self, step: usize, count: usize) -> [u8; 3] {
        self.colour(self.value((step as f64 + 0.5) / count as f64))
    }

    /// Colours from the lower limit to the upper in even steps.
    pub fn steps(&self, count: usize) -> Vec<[u8; 3]> {
        let last = count.saturating_sub(1).max(1) as f64;
        (0..count).map(|step| self.colour(self.value(step as f64 / last))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance (WCAG 2.2).
    fn luminance(colour: [u8; 3]) -> f64 {
        let linear = colour.map(|channel| {
            let part = f64::from(channel) / 255.0;
            if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
        });
        0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    }

    #[test]
    fn further_from_rest_is_darker_so_that_no_colour_vision_is_needed() {
        for field in Field::ALL {
            let rest = field.at_rest();
            for side in [-1.0, 1.0] {
                let scale = ColourScale::new(field, [rest - 1.0, rest + 1.0]);
                let lights: Vec<f64> = (0..=50)
                    .map(|step| luminance(scale.colour(rest + side * f64::from(step) / 50.0)))
                    .collect();
                assert!(lights.windows(2).all(|pair| pair[1] < pair[0]), "{field:?}: {lights:?}");
            }
        }
    }

    #[test]
    fn both_sides_of_rest_have_one_length() {
        let scale = ColourScale::new(Field::FibreStrain, [-10.0, 5.0]);
        let whole = ColourScale::new(Field::FibreStrain, [-10.0, 10.0]);
        assert_eq!(scale.colour(5.0), whole.colour(5.0));
        assert_eq!(scale.colour(9.0), whole.colour(5.0));
        assert_eq!(scale.colour(f64::NAN), scale.colour(0.0));
    }
}
