//! Monotone cubic interpolation: between two points it stays between them.

/// A monotone cubic through points (`fritsch_1984`), which has no extremum that the points do not
/// have.
///
/// # Example
/// ```
/// use myospring::analysis::monotone::MonotoneCubic;
/// let cubic = MonotoneCubic::new(vec![0.0, 1.0, 2.0, 4.0], vec![0.0, 3.0, 3.0, 0.0]);
/// assert_eq!([cubic.at(-1.0), cubic.at(1.5), cubic.at(9.0)], [0.0, 3.0, 0.0]);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MonotoneCubic {
    places: Vec<f64>,
    values: Vec<f64>,
    slopes: Vec<f64>,
}

impl MonotoneCubic {
    /// Through values at ascending places.
    ///
    /// # Panics
    /// Lists of different length, or fewer than two points.
    pub fn new(places: Vec<f64>, values: Vec<f64>) -> Self {
        assert!(places.len() == values.len() && places.len() > 1, "two points or more");
        let slopes = slopes(&places, &values);
        Self { places, values, slopes }
    }

    /// The values at its points.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The value at a place; the first value before the first point, the last one after the last.
    pub fn at(&self, place: f64) -> f64 {
        let Self { places, values, slopes } = self;
        let after = places.partition_point(|other| *other <= place);
        if after == 0 || after == places.len() {
            return values[after.saturating_sub(1)];
        }
        let (from, to) = (after - 1, after);
        let width = places[to] - places[from];
        let part = (place - places[from]) / width;
        // Hermite's cubic.
        let (other, square) = (1.0 - part, part * part);
        other * other * ((1.0 + 2.0 * part) * values[from] + part * width * slopes[from])
            + square * ((1.0 + 2.0 * other) * values[to] - other * width * slopes[to])
    }
}

/// Slopes for which the cubic between two points is monotone: weighted harmonic means of the slopes of
/// both chords, 0 at extrema (`fritsch_1984`).
fn slopes(places: &[f64], values: &[f64]) -> Vec<f64> {
    let widths: Vec<f64> = places.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let rises = values.windows(2).map(|pair| pair[1] - pair[0]);
    let chords: Vec<f64> = rises.zip(&widths).map(|(rise, width)| rise / width).collect();
    let inner = |at: usize| {
        let ([before, after], [left, right]) =
            ([chords[at - 1], chords[at]], [widths[at - 1], widths[at]]);
        if before * after <= 0.0 {
            return 0.0;
        }
        let [of_before, of_after] = [left + 2.0 * right, 2.0 * left + right];
        (of_before + of_after) / (of_before / before + of_after / after)
    };
    // The parabola through three points, unless it would overshoot.
    let end = |near: usize, next: usize| {
        let Some(&other) = chords.get(next) else { return chords[near] };
        let (chord, [width, beyond]) = (chords[near], [widths[near], widths[next]]);
        let slope = ((2.0 * width + beyond) * chord - width * other) / (width + beyond);
        if slope * chord <= 0.0 {
            0.0
        } else if chord * other < 0.0 && slope.abs() > 3.0 * chord.abs() {
            3.0 * chord
        } else {
            slope
        }
    };
    let last = chords.len() - 1;
    let mut slopes = vec![end(0, 1)];
    slopes.extend((1..=last).map(inner));
    slopes.push(end(last, last.wrapping_sub(1)));
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_monotone_between_points_and_nears_a_smooth_curve_with_their_square() {
        let times = [0.0, 3.0, 4.0, 9.0, 10.0, 30.0];
        let values = [0.0, 0.0, 5.0, 5.5, 2.0, 2.0];
        let cubic = MonotoneCubic::new(times.to_vec(), values.to_vec());
        for (pair, ends) in times.windows(2).zip(values.windows(2)) {
            let at = |part: f64| cubic.at(pair[0] + part * (pair[1] - pair[0]));
            let fine: Vec<f64> = (0..=100).map(|part| at(f64::from(part) / 100.0)).collect();
            assert_eq!([fine[0], fine[100]], [ends[0], ends[1]]);
            let falls = ends[1] < ends[0];
            // Rounding.
            let steps = fine.windows(2).map(|pair| pair[1] - pair[0]);
            assert!(steps.clone().all(|step| if falls { step < 1e-12 } else { step > -1e-12 }));
        }
        // Against the sine that was sampled, away from its flat top: twice as many rows are four times as near at least.
        let off = |rows: u32| {
            let step = 1.2 / f64::from(rows);
            let times: Vec<f64> = (0..=rows).map(|row| step * f64::from(row)).collect();
            let values: Vec<f64> = times.iter().map(|time| time.sin()).collect();
            let cubic = MonotoneCubic::new(times, values);
            let fine = (0..1200).map(|at| f64::from(at) * 1e-3);
            fine.map(|time| (cubic.at(time) - time.sin()).abs()).fold(0.0, f64::max)
        };
        assert!(off(40) < 0.25 * off(20) && off(40) < 1e-5, "{:e}, {:e}", off(20), off(40));
    }
}
