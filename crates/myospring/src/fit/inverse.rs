//! The tension of a shortening: the inverse of a mesh's response.

use crate::simulation::equilibria::TensionResponse;

/// Steps of the inversion, and the part of the highest tension that ends it.
const STEPS: usize = 60;
const AGREED: f64 = 1e-13;

/// The inverse of [`TensionResponse::shortening`].
pub(super) struct Inverse<'a> {
    response: &'a dyn TensionResponse,
    highest: f64,
    /// Shortening under the highest tension, and its slope there.
    end: [f64; 2],
    /// Slope without tension.
    first: f64,
}

impl<'a> Inverse<'a> {
    pub(super) fn of(response: &'a dyn TensionResponse) -> Self {
        let highest = response.highest();
        let [_, first] = response.shortening(0.0);
        Self { response, highest, end: response.shortening(highest), first }
    }

    /// The tension at a shortening, kPa; past either end on a straight line.
    pub(super) fn at(&self, shortening: f64) -> f64 {
        let Self { response, highest, end: [most, last], first } = *self;
        if shortening <= 0.0 {
            return shortening / first;
        }
        if shortening >= most {
            return highest + (shortening - most) / last;
        }
        let (mut low, mut high) = (0.0, highest);
        let mut tension = (shortening / first).min(0.5 * highest);
        // Newton's method, kept between two tensions that are too low and too high.
        for _ in 0..STEPS {
            let [found, slope] = response.shortening(tension);
            let miss = found - shortening;
            if miss > 0.0 {
                high = tension;
            } else {
                low = tension;
            }
            let mut next = tension - miss / slope;
            if !(low < next && next < high) {
                next = f64::midpoint(low, high);
            }
            let step = (next - tension).abs();
            tension = next;
            if step <= AGREED * highest {
                break;
            }
        }
        tension
    }
}
