//! Stripes with a period that sarcomeres cannot have: most likely the pixel size is wrong.
//!
//! Other periods are searched by the same code that searches sarcomeres, with another pixel size.

use std::fmt;

use super::super::plane::Plane;
use super::settings::FibreSettings;
use super::spectra::{LONGEST_UM, SHORTEST_UM};
use super::stripes::{self, Stripes};
use myospring_core::interruption::Interruption;

/// Pixel sizes, relative to the stated one, at which the picture is examined again: periods from
/// 2.5 to 4.7 um, from 0.8 to 1.4 and from 0.44 to 0.8.
const LONGER: f64 = 0.55;
const SHORTER: [f64; 2] = [1.8, 3.2];

/// Least part of a cell that must show stripes of another period.
const LEAST_SHARE: f64 = 0.4;

/// If sarcomeres are found in at least this part of a cell, shorter stripes are not searched.
const ENOUGH_SHARE: f64 = 0.1;

/// Two periods are multiples of each other if their ratio differs from a whole number by at most
/// this.
const MULTIPLE: f64 = 0.15;

/// Usual length of sarcomeres at rest, um.
const USUAL_UM: f64 = 1.85;

/// Stripes that are too far apart or too close for sarcomeres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Misfit {
    /// Distance of the stripes at the stated pixel size, um.
    pub period_um: f64,
    /// The stated side of a pixel, um.
    pub pixel_um: f64,
}

impl Misfit {
    /// The side of a pixel at which the stripes would be 1.85 um apart, um.
    ///
    /// # Example
    /// ```
    /// use myospring::microscopy::fibres::Misfit;
    /// let misfit = Misfit { period_um: 0.925, pixel_um: 0.1 };
    /// assert!((misfit.fitting_pixel_um() - 0.2).abs() < 1e-12);
    /// ```
    pub fn fitting_pixel_um(&self) -> f64 {
        self.pixel_um * USUAL_UM / self.period_um
    }
}

impl fmt::Display for Misfit {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            out,
            "stripes {:.2} um apart: is the pixel size {} um? (sarcomeres are {SHORTEST_UM} to {LONGEST_UM} um long; \
             {USUAL_UM} um would need pixels of {:.3} um)",
            self.period_um,
            self.pixel_um,
            self.fitting_pixel_um()
        )
    }
}

/// Looks for another period that explains the picture better than the sarcomeres that were found in it; an answer that
/// was interrupted means nothing.
pub(super) fn find(
    plane: &Plane,
    inside: &[bool],
    pixel_um: f64,
    settings: &FibreSettings,
    found: &Stripes,
    interruption: &Interruption,
) -> Option<Misfit> {
    let share = found.readings.answered_share();
    let at = |scale: f64| {
        let pixel_um = pixel_um * scale;
        let other = stripes::of_cell(plane, inside, pixel_um, settings, interruption).ok()??;
        let share = other.readings.answered_share();
        let period_um = other.period_um? / scale;
        (share >= LEAST_SHARE).then_some((other.power, period_um))
    };
    let misfit = |period_um| Misfit { period_um, pixel_um };
    // Stripes just beyond the band also appear at its end; the search beyond it finds their true
    // period.
    let beyond = found.period_um.filter(|period| !found.band.contains(*period));
    if let Some(period) = beyond.filter(|_| found.share >= LEAST_SHARE) {
        let there = if period > found.band.longest_um { &[LONGER][..] } else { &SHORTER };
        let better = there.iter().find_map(|&scale| at(scale)).map(|(_, period)| period);
        return Some(misfit(better.unwrap_or(period)));
    }
    if let Some((power, period_um)) = at(LONGER) {
        // Narrow stripes have weaker harmonics at two and three times their wave number; harmonics
        // are not sarcomeres.
        let multiple = found.period_um.is_some_and(|period| {
            let ratio = period_um / period;
            ratio > 1.5 && (ratio - ratio.round()).abs() < MULTIPLE
        });
        if share < ENOUGH_SHARE || (multiple && power > found.power) {
            return Some(misfit(period_um));
        }
    }
    if share >= ENOUGH_SHARE {
        return None;
    }
    SHORTER.iter().find_map(|&scale| at(scale)).map(|(_, period_um)| misfit(period_um))
}
