//! What a cell does to its support, by its shortening.

use super::inverse::Inverse;
use crate::simulation::equilibria::TensionResponse;

/// Intervals of a table: with 128, between its points a force is right to 1e-8 of the largest.
const INTERVALS: u32 = 128;

/// A load of the support by the shortening, a cubic between points.
///
/// In equilibrium both follow from the tension that shapes the cell, so one follows from the other.
pub(super) struct SupportLoad {
    /// Shortening, load, and the derivative of the load by the shortening; ascending.
    points: Vec<[f64; 3]>,
}

impl SupportLoad {
    /// The load of this name ([`TensionResponse::load`]) up to a shortening; `None` if the support has no such load.
    pub(super) fn new(response: &dyn TensionResponse, name: &str, most: f64) -> Option<Self> {
        // Some shortening, so that there are two points.
        let highest = Inverse::of(response).at(most.max(1e-6));
        let point = |at: u32| {
            let tension = highest * f64::from(at) / f64::from(INTERVALS);
            let [load, by_tension] = response.load(name, tension)?;
            let [shortening, slope] = response.shortening(tension);
            Some([shortening, load, by_tension / slope])
        };
        Some(Self { points: (0..=INTERVALS).map(point).collect::<Option<_>>()? })
    }

    /// The load at a shortening, and its derivative; past either end on a straight line.
    pub(super) fn at(&self, shortening: f64) -> [f64; 2] {
        let points = &self.points;
        let after = points.partition_point(|[place, ..]| *place <= shortening);
        if after == 0 || after == points.len() {
            let [place, load, slope] = points[after.saturating_sub(1)];
            return [load + slope * (shortening - place), slope];
        }
        let ([left, from, leave], [right, to, arrive]) = (points[after - 1], points[after]);
        let width = right - left;
        let part = (shortening - left) / width;
        let other = 1.0 - part;
        // Hermite's cubic and its derivative.
        let value = other * other * ((1.0 + 2.0 * part) * from + part * width * leave)
            + part * part * ((1.0 + 2.0 * other) * to - other * width * arrive);
        let slope = 6.0 * part * other * (to - from) / width
            + other * (other - 2.0 * part) * leave
            + part * (part - 2.0 * other) * arrive;
        [value, slope]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shortening that saturates with tension, and a load that grows with its square.
    struct Saturating;

    impl TensionResponse for Saturating {
        fn shortening(&self, tension: f64) -> [f64; 2] {
            [tension / (tension + 100.0), 100.0 / (tension + 100.0).powi(2)]
        }

        fn steepest(&self) -> f64 {
            0.01
        }

        fn highest(&self) -> f64 {
            50.0
        }

        fn load(&self, name: &str, tension: f64) -> Option<[f64; 2]> {
            (name == "force").then_some([tension * tension, 2.0 * tension])
        }
    }

    #[test]
    fn load_and_slope_follow_from_the_tension_of_a_shortening() {
        let table = SupportLoad::new(&Saturating, "force", 0.3).unwrap();
        for at in 0..=300 {
            let shortening = 1e-3 * f64::from(at);
            let tension = 100.0 * shortening / (1.0 - shortening);
            let slope = 2.0 * tension * (tension + 100.0).powi(2) / 100.0;
            let [load, found] = table.at(shortening);
            assert!((load - tension * tension).abs() < 1e-8 * 1800.0, "{shortening}: {load}");
            assert!((found - slope).abs() < 1e-5 * 15_000.0, "{shortening}: {found}, {slope}");
        }
        assert!(SupportLoad::new(&Saturating, "energy", 0.3).is_none());
    }

    #[test]
    fn past_the_ends_a_load_goes_on_along_a_straight_line() {
        let table = SupportLoad::new(&Saturating, "force", 0.3).unwrap();
        let [last, slope] = table.at(0.3);
        let [beyond, same] = table.at(0.4);
        assert!((beyond - last - 0.1 * slope).abs() < 1e-6 * beyond && (same - slope).abs() < 1e-6);
        assert_eq!(table.at(-0.1), [0.0, 0.0]);
    }
}
