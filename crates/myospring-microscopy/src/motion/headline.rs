//! Which measure gives the contraction of a cell in a film: its length, or the strain of the whole
//! cell.
//!
//! The length is used if both ends are visible and move with the rest of the cell. The smaller
//! principal stretch of all points is used if the frame cuts an end, an end is not found again, or
//! the distance between the ends does not follow the strain of the whole cell (a cell held at its
//! ends, a tissue between posts, a cell that contracts across its long axis).

use super::{CellMotion, Stretches};
use myospring_core::mesh::ends::end_points;
use myospring_core::mesh::quality::long_axis;
use std::fmt;

/// Largest part of an end's area that may be cut by the frame, or be lost in most frames.
const MOST_CUT: f64 = 0.1;
const MOST_LOST: f64 = 0.5;
/// Least correlation of the shortening with the contraction by strain, and the usual range of their
/// ratio.
const LEAST_CORRELATION: f64 = 0.9;
const USUAL: [f64; 2] = [0.5, 2.0];
/// Angle between contraction and long axis from which the length is not used, degrees.
const ASKEW: f64 = 30.0;
/// Least detectable contraction, %, and in standard errors of a point relative to the length of the
/// cell.
const LEAST_PCT: f64 = 0.2;
const LEAST_ERRORS: f64 = 4.0;

/// The measure of a cell's contraction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Its length: [`CellMotion::lengths_um`].
    Length,
    /// The smaller principal stretch of the whole cell: [`CellMotion::stretches`].
    Stretch,
}

/// Why a measure was chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reason {
    /// Both ends are seen and move with the rest.
    Follows {
        /// Correlation of the two curves.
        correlation: f64,
    },
    /// The frame cuts an end.
    Cut,
    /// An end was not found again in most frames.
    Lost,
    /// The outline is doubtful, so the ends of the cell are not known.
    Outline,
    /// The cell does not move.
    Still {
        /// The least detectable contraction, %.
        least_pct: f64,
    },
    /// It contracts along another line than its long axis.
    Askew {
        /// Angle between both, degrees.
        degrees: f64,
    },
    /// The ends do not move as the whole cell does.
    Differs {
        /// Correlation of the two curves.
        correlation: f64,
    },
    /// The ends move in time with the whole cell, but by much less or more.
    Disproportion {
        /// Ratio of the shortening to the contraction by strain.
        ratio: f64,
    },
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Follows { correlation } => write!(
                f,
                "both ends are seen and move as the whole cell does (correlation with stretch_1 {correlation:.2})"
            ),
            Self::Cut => write!(f, "the frame cuts an end of the cell, so its length is not known"),
            Self::Lost => write!(f, "an end of the cell was not found again in most frames"),
            Self::Outline => {
                write!(f, "the outline is doubtful, so the ends of the cell are not known")
            }
            Self::Still { least_pct } => {
                write!(f, "the cell hardly moves (less than {least_pct:.2} % cannot be seen)")
            }
            Self::Askew { degrees } => {
                write!(f, "the cell contracts at {degrees:.0} degrees to its long axis")
            }
            Self::Differs { correlation } => write!(
                f,
                "the ends do not move as the whole cell does (correlation of the length with stretch_1 {correlation:.2})"
            ),
            Self::Disproportion { ratio } if *ratio < 1.0 => write!(
                f,
                "the shortening between the ends is {:.0} % of the whole cell's contraction: something holds the ends",
                100.0 * ratio.max(0.0)
            ),
            Self::Disproportion { ratio } => write!(
                f,
                "the shortening between the ends is {ratio:.1} times the whole cell's contraction: something else moves the ends"
            ),
        }
    }
}

/// The chosen measure of a cell's contraction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Headline {
    /// The measure.
    pub measure: Measure,
    /// Why it was chosen.
    pub reason: Reason,
}

impl Headline {
    /// Changes the measure if it is the length, because a doubtful outline does not give the
    /// length.
    #[must_use]
    pub fn with_doubtful_outline(self) -> Self {
        match self.measure {
            Measure::Length => Self { measure: Measure::Stretch, reason: Reason::Outline },
            Measure::Stretch => self,
        }
    }
}

impl CellMotion {
    /// Chooses the measure of contraction for this film; see [`Measure`].
    pub fn headline(&self) -> Headline {
        let seen = self.frames_with_cell();
        let (lengths, all) = (self.lengths_um(), self.stretches());
        let rest = lengths[self.rest_index()];
        let shortening: Vec<f64> =
            seen.iter().map(|&at| 100.0 * (1.0 - lengths[at] / rest)).collect();
        let stretches: Vec<Stretches> = seen.iter().map(|&at| all[at]).collect();
        let contraction: Vec<f64> =
            stretches.iter().map(|stretch| 100.0 * (1.0 - stretch.smaller)).collect();
        let least_pct = self.least_contraction_pct();
        let reason = self.at_ends().unwrap_or_else(|| {
            if contraction.iter().all(|contraction| *contraction < least_pct) {
                return Reason::Still { least_pct };
            }
            let degrees = self.askew(&stretches);
            let (correlation, ratio) = compared(&shortening, &contraction);
            if degrees > ASKEW {
                Reason::Askew { degrees }
            } else if correlation < LEAST_CORRELATION {
                Reason::Differs { correlation }
            } else if !(USUAL[0]..=USUAL[1]).contains(&ratio) {
                Reason::Disproportion { ratio }
            } else {
                Reason::Follows { correlation }
            }
        });
        let measure = match reason {
            Reason::Follows { .. } => Measure::Length,
            _ => Measure::Stretch,
        };
        Headline { measure, reason }
    }

    /// The least contraction that can be detected in this film, %.
    pub fn least_contraction_pct(&self) -> f64 {
        let length = self.lengths_um()[self.rest_index()];
        let error_pct = 100.0 * self.error_um.unwrap_or(0.0) / length;
        (LEAST_ERRORS * error_pct).max(LEAST_PCT)
    }

    /// Why an end of the cell cannot be used; `None` if both can.
    fn at_ends(&self) -> Option<Reason> {
        let (cut, seen, areas) = (self.cut(), self.seen_areas(), &self.mesh.areas);
        for end in end_points(&self.mesh.points, long_axis(&self.mesh)) {
            let all: f64 = end.iter().map(|&point| areas[point]).sum();
            let part = |of: &dyn Fn(usize) -> f64| end.iter().map(|&at| of(at)).sum::<f64>() / all;
            if part(&|at| if cut[at] { areas[at] } else { 0.0 }) > MOST_CUT {
                return Some(Reason::Cut);
            }
            if part(&|at| seen[at]) < 1.0 - MOST_LOST {
                return Some(Reason::Lost);
            }
        }
        None
    }

    /// Angle between the line along which the cell contracts and its long axis, degrees, 0 to 90;
    /// each frame is weighted by the difference between its two stretches.
    fn askew(&self, stretches: &[Stretches]) -> f64 {
        let (mut cosine, mut sine) = (0.0, 0.0);
        for stretch in stretches {
            let [x, y] = stretch.direction;
            let weight = (stretch.larger - stretch.smaller).powi(2);
            // Lines have no sign, so doubled angles are averaged.
            cosine += weight * (x * x - y * y);
            sine += weight * 2.0 * x * y;
        }
        let [x, y] = long_axis(&self.mesh);
        let between = 0.5 * sine.atan2(cosine) - y.atan2(x);
        let degrees = between.to_degrees().rem_euclid(180.0);
        degrees.min(180.0 - degrees)
    }
}

/// Correlation of two curves, and the slope of the first against the second.
fn compared(one: &[f64], other: &[f64]) -> (f64, f64) {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (a, b) = (mean(one), mean(other));
    let (mut both, mut first, mut second) = (0.0, 0.0, 0.0);
    for (x, y) in one.iter().zip(other) {
        both += (x - a) * (y - b);
        first += (x - a).powi(2);
        second += (y - b).powi(2);
    }
    let correlation = if first * second > 0.0 { both / (first * second).sqrt() } else { 0.0 };
    (correlation, if second > 0.0 { both / second } else { 0.0 })
}
