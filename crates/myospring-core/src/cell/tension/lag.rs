//! The tension that shapes a viscous cell.
//!
//! Viscous forces that are `tau` times the rate of the elastic ones (Kelvin and Voigt) make the elastic forces, and with
//! them the shape, those of a tension `theta` that lags behind the active one:
//!
//! ```text
//! tau dtheta/dt = Ta - theta
//! ```

/// Parts of `tau` so short that Simpson's rule is exact to 1e-13.
const SHORT: f64 = 0.01;

/// How the tension that shapes a cell follows the active one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Lag {
    tau: f64,
}

impl Lag {
    /// The shape is always that of the active tension.
    pub const NONE: Self = Self { tau: 0.0 };

    /// By a retardation time, ms; 0 is none.
    pub fn by(tau: f64) -> Self {
        Self { tau }
    }

    /// Whether the shape is always that of the active tension.
    pub fn is_none(self) -> bool {
        self.tau <= 0.0
    }

    /// How fast `theta` changes under a tension, in its unit per ms; 0 without a lag.
    pub fn rate(self, theta: f64, tension: f64) -> f64 {
        if self.is_none() { 0.0 } else { (tension - theta) / self.tau }
    }

    /// `theta` after a time (ms) over which the tension goes evenly from one value to another. Exact. Where no time is
    /// left to it, the other value has acted for ever and made the shape.
    pub fn over_line(self, time: f64, theta: f64, [from, to]: [f64; 2]) -> f64 {
        if self.is_none() || time <= 0.0 {
            return to;
        }
        let behind = self.tau * (to - from) / time;
        to - behind + (theta - from + behind) * (-time / self.tau).exp()
    }

    /// `theta` after a time (ms) over which the tension is the parabola through its values at the begin, in the middle and
    /// at the end. Exact.
    pub fn over_parabola(self, time: f64, theta: f64, [from, middle, to]: [f64; 3]) -> f64 {
        if self.is_none() {
            return to;
        }
        if time <= 0.0 {
            return theta;
        }
        let part = time / self.tau;
        let decay = (-part).exp();
        if part < SHORT {
            // Simpson's rule, where the parabola's own would be differences of almost nothing.
            let sum = from * decay + 4.0 * middle * (-0.5 * part).exp() + to;
            return theta * decay + part * sum / 6.0;
        }
        let bend = 4.0 * (from - 2.0 * middle + to) / (time * time);
        let [first, last] = [4.0 * middle - 3.0 * from - to, 3.0 * to + from - 4.0 * middle]
            .map(|slope| slope / time);
        let behind = |ta: f64, slope: f64| ta - self.tau * (slope - self.tau * bend);
        behind(to, last) + (theta - behind(from, first)) * decay
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_parabolas_are_followed_exactly() {
        let (tau, time, theta) = (20.0, 6.0, 3.0);
        // theta by 100 000 steps of the implicit midpoint rule, whose error is far below what is asked for.
        let plain = |tension: &dyn Fn(f64) -> f64| {
            let step: f64 = time / 1e5;
            (0..100_000).fold(theta, |theta, k| {
                let by = 0.5 * step / tau;
                let middle = tension((f64::from(k) + 0.5) * step);
                (theta * (1.0 - by) + 2.0 * by * middle) / (1.0 + by)
            })
        };
        let lag = Lag::by(tau);
        let line = |t: f64| 5.0 + 2.0 * t;
        let found = lag.over_line(time, theta, [line(0.0), line(time)]);
        assert!((found - plain(&line)).abs() < 1e-8);
        let parabola = |t: f64| 5.0 + 2.0 * t - 0.7 * t * t;
        let through = [parabola(0.0), parabola(0.5 * time), parabola(time)];
        assert!((lag.over_parabola(time, theta, through) - plain(&parabola)).abs() < 1e-8);
        assert_eq!(Lag::NONE.over_line(time, theta, [1.0, 4.0]), 4.0);
        assert_eq!(Lag::NONE.over_parabola(time, theta, through), through[2]);
    }

    #[test]
    fn both_ways_to_follow_a_parabola_meet() {
        let way = |time: f64| Lag::by(1.0).over_parabola(time, 0.3, [1.0, 1.001, 1.0021]);
        // Simpson's rule is off by 1e-12 for a tension that bends by a tenth of its change, as here.
        assert!((way(SHORT * (1.0 - 1e-12)) - way(SHORT)).abs() < 1e-11);
    }
}
