//! One step as a curve: Hermite's cubic through both ends, its roots and peaks.

use super::branch::State;

/// A cubic in the fraction of a step, `0..=1`; of order 3, as the steps are.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Cubic([f64; 4]);

impl Cubic {
    /// From value and slope (per step) at both ends.
    pub(super) fn new([y0, y1]: [f64; 2], [slope_0, slope_1]: [f64; 2]) -> Self {
        let rise = y1 - y0;
        Self([y0, slope_0, 3.0 * rise - 2.0 * slope_0 - slope_1, slope_0 + slope_1 - 2.0 * rise])
    }

    pub(super) fn value(&self, x: f64) -> f64 {
        let Self([a, b, c, d]) = *self;
        a + x * (b + x * (c + x * d))
    }

    pub(super) fn slope(&self, x: f64) -> f64 {
        let Self([_, b, c, d]) = *self;
        b + x * (2.0 * c + x * 3.0 * d)
    }

    /// Distance from a bound, positive on the inner side: below it for `sign = -1`.
    pub(super) fn inside(&self, bound: f64, sign: f64) -> Self {
        let Self([a, b, c, d]) = *self;
        Self([sign * (a - bound), sign * b, sign * c, sign * d])
    }

    /// First root after which this distance is negative, checked at the middle and the end; a start
    /// at distance 0 is not a root if the curve moves inwards.
    pub(super) fn first_root(&self) -> Option<f64> {
        let Self([a, b, c, d]) = *self;
        let distance = |x: f64| if a == 0.0 { b + x * (c + x * d) } else { self.value(x) };
        let end = [0.5, 1.0].into_iter().find(|x| distance(*x) < 0.0)?;
        Some(if distance(0.0) <= 0.0 { 0.0 } else { root(distance, end) })
    }

    /// The first maximum before `end`, if the curve rises at the start and falls at `end`.
    pub(super) fn peak(&self, end: f64) -> Option<f64> {
        (self.slope(0.0) > 0.0 && self.slope(end) < 0.0).then(|| root(|x| self.slope(x), end))
    }
}

/// Root of a function that is positive at 0 and not positive at `end`; at the result, it is not
/// positive.
///
/// Regula falsi in the Illinois form (`dowell_jarratt_1971`), which cannot leave the bracket.
pub(super) fn root(f: impl Fn(f64) -> f64, end: f64) -> f64 {
    const ENOUGH: usize = 100;
    let (mut low, mut high) = (0.0, end);
    let (mut f_low, mut f_high) = (f(low), f(high));
    let mut kept_low = 0;
    for _ in 0..ENOUGH {
        if high - low <= 1e-14 || f_high == 0.0 {
            break;
        }
        let x = (low + (high - low) * (f_low / (f_low - f_high))).clamp(low, high);
        let value = f(x);
        if value > 0.0 {
            (low, f_low) = (x, value);
            f_high *= if kept_low < 0 { 0.5 } else { 1.0 };
            kept_low = -1;
        } else {
            (high, f_high) = (x, value);
            f_low *= if kept_low > 0 { 0.5 } else { 1.0 };
            kept_low = 1;
        }
    }
    high
}

/// A step that was taken.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Piece {
    /// Its start and the length of the whole step, ms.
    pub(super) start_ms: f64,
    pub(super) step_ms: f64,
    /// Both ends of the whole step.
    pub(super) states: [State; 2],
    pub(super) rates: [State; 2],
}

impl Piece {
    /// The course of one variable.
    pub(super) fn cubic(&self, k: usize) -> Cubic {
        let Self { step_ms, states, rates, .. } = self;
        Cubic::new([states[0][k], states[1][k]], [step_ms * rates[0][k], step_ms * rates[1][k]])
    }

    /// The state after a part of the step.
    pub(super) fn state(&self, part: f64) -> State {
        if part >= 1.0 {
            self.states[1]
        } else {
            std::array::from_fn(|k| self.cubic(k).value(part))
        }
    }

    /// The state at a time within the step.
    pub(super) fn state_at(&self, time_ms: f64) -> State {
        if self.step_ms > 0.0 {
            self.state((time_ms - self.start_ms) / self.step_ms)
        } else {
            self.states[1]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x^3 - 1.5 x^2 + 0.56 x has its roots at 0, 0.7 and 0.8.
    fn cubic() -> Cubic {
        Cubic::new([0.0, 0.06], [0.56, 0.56])
    }

    #[test]
    fn hermites_cubic_is_the_polynomial_with_these_ends() {
        for x in [0.0, 0.3, 0.75, 1.0] {
            let exact = ((x - 1.5) * x + 0.56) * x;
            assert!((cubic().value(x) - exact).abs() < 1e-15);
            assert!((cubic().slope(x) - ((3.0 * x - 3.0) * x + 0.56)).abs() < 1e-15);
        }
    }

    #[test]
    fn roots_and_peaks_are_found() {
        let falls = Cubic::new([0.3, -0.1], [0.0, -0.4]);
        let root = falls.first_root().unwrap();
        assert!(falls.value(root).abs() < 1e-14 && falls.value(root) <= 0.0);
        assert_eq!(cubic().inside(-0.1, 1.0).first_root(), None);
        let peak = cubic().peak(0.7).unwrap();
        // 3 x^2 - 3 x + 0.56 = 0.
        let exact = (3.0 - (9.0_f64 - 6.72).sqrt()) / 6.0;
        assert!((peak - exact).abs() < 1e-13, "{peak}");
        assert!(cubic().slope(peak).abs() < 1e-12);
        assert_eq!(cubic().peak(0.1), None);
    }

    #[test]
    fn a_start_on_the_bound_is_no_root_unless_the_curve_leaves_at_once() {
        let inwards = Cubic::new([0.0, 1.0], [1.0, 1.0]);
        assert_eq!(inwards.first_root(), None);
        let there_and_back = Cubic::new([0.0, -0.5], [1.0, -2.0]);
        let root = there_and_back.first_root().unwrap();
        assert!(root > 0.3 && there_and_back.value(root).abs() < 1e-13);
        let outwards = Cubic::new([0.0, -1.0], [-1.0, -1.0]);
        assert_eq!(outwards.first_root(), Some(0.0));
    }

    #[test]
    fn an_excursion_within_the_first_half_is_seen_at_the_middle() {
        let dips = Cubic::new([0.1, 0.1], [-1.0, 1.0]);
        let root = dips.first_root().unwrap();
        assert!(root < 0.5 && dips.value(root).abs() < 1e-14);
    }
}
