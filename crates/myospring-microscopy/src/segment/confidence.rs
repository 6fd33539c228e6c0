//! Confidence in a cell, as a number and in words.

use crate::region::Region;
use geo::{Area, ConvexHull, MultiPoint, Point};
use serde::Serialize;

/// Below this score a cell is doubtful and should be checked by eye.
pub(super) const DOUBTFUL: f64 = 0.5;

/// Solidity (area divided by that of the convex hull) of debris and of a compact cell; a disc with
/// four to eight arms has 0.47 to 0.54.
const SOLIDITY: [f64; 2] = [0.15, 0.75];

/// Factor of a cell that barely touches the frame, and of one with at least the part [`CUT_MUCH`]
/// of its outline on it.
const CUT_FACTORS: [f64; 2] = [0.7, 0.5];
const CUT_MUCH: f64 = 0.1;

/// Part of the bounding box that is filled by a rectangle, and by a cell along rows or columns.
const BOX: [f64; 2] = [0.985, 0.955];

/// Relative standard deviation of the rim's distance from the centre: of a circle, and of a round
/// cell.
const CIRCLE: [f64; 2] = [0.012, 0.03];

/// What to do about a doubtful outline.
const ADVICE: &str = "if it is wrong, draw it (in ImageJ, say) and give --outline; of a tissue, `myospring segment \
                      --whole-frame` reads the fibres without one";

/// Beginnings of the reasons that the report of a cell's shape does not repeat.
const CUT: &str = "the frame cuts it";
const RAGGED: &str = "it fills little of its convex hull";

/// Beginning of the reason for a patch of something larger.
pub(super) const PATCH: &str = "it does not end at its outline";

/// Beginnings of the reasons that concern the texture of the cell.
pub(super) const OUT_OF_FOCUS: &str = "it is out of focus";
pub(super) const UNIFORM: &str = "it is uniform";
pub(super) const HIDES: [&str; 2] = ["noise and blur hide", "noise hides"];

/// Factor for each reason that is left if those that concern texture do not count.
const OTHER_REASON: f64 = 0.7;

/// A cell to be judged.
pub(super) struct Candidate<'a> {
    /// Its number.
    pub(super) number: u32,
    /// The numbers of all cells, row by row, and the length of a row.
    pub(super) numbers: &'a [u32],
    pub(super) width: usize,
    /// Its pixels, as places in the plane.
    pub(super) pixels: &'a [u32],
    /// Its pixels with a neighbour outside, except those on the frame.
    pub(super) rim: &'a [u32],
    /// Number of its pixels on the frame.
    pub(super) on_frame: usize,
    /// Evidence that it is two cells or part of one: a factor for the score, and a reason.
    pub(super) doubt: Option<(f64, String)>,
}

impl Candidate<'_> {
    /// Its pixels on a grid of this size, coarser than the plane by `factor`.
    pub(super) fn region(&self, factor: usize, [columns, rows]: [usize; 2]) -> Option<Region> {
        let mut inside = vec![false; columns * rows];
        for &pixel in self.pixels {
            let at = pixel as usize;
            let (column, row) = (at % self.width / factor, at / self.width / factor);
            if column < columns && row < rows {
                inside[row * columns + column] = true;
            }
        }
        inside.contains(&true).then(|| Region::new(columns, rows, inside.into_iter()))
    }

    /// Part of its bounding box that it fills, and deviation of its rim from a circle (a cell cut
    /// by the frame is never a circle).
    fn figure(&self, width: usize) -> (f64, f64) {
        let place =
            |&pixel: &u32| [(pixel as usize % width) as f64, (pixel as usize / width) as f64];
        let mut bounds = [f64::INFINITY, f64::INFINITY, -1.0, -1.0];
        let mut sums = [0.0; 2];
        for [x, y] in self.pixels.iter().map(place) {
            bounds = [bounds[0].min(x), bounds[1].min(y), bounds[2].max(x), bounds[3].max(y)];
            sums = [sums[0] + x, sums[1] + y];
        }
        let count = self.pixels.len().max(1) as f64;
        let fills = count / ((bounds[2] - bounds[0] + 1.0) * (bounds[3] - bounds[1] + 1.0));
        if self.on_frame > 0 || self.rim.is_empty() {
            return (fills, 1.0);
        }
        let middle = sums.map(|sum| sum / count);
        let distances = self.rim.iter().map(place);
        let distances: Vec<f64> =
            distances.map(|[x, y]| (x - middle[0]).hypot(y - middle[1])).collect();
        let mean = distances.iter().sum::<f64>() / distances.len() as f64;
        let squares: f64 = distances.iter().map(|distance| (distance - mean).powi(2)).sum();
        (fills, (squares / distances.len() as f64).sqrt() / mean.max(1.0))
    }

    fn solidity(&self, width: usize) -> f64 {
        let on_rim = if self.rim.is_empty() { self.pixels } else { self.rim };
        let place =
            |&pixel: &u32| [(pixel as usize % width) as f64, (pixel as usize / width) as f64];
        solidity(on_rim.iter().map(place), self.pixels.len())
    }
}

/// How certain a cell is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Confidence {
    /// From 0 (a guess) to 1 (no doubt): the product of one factor for each criterion.
    pub score: f64,
    /// Reasons for doubt, in words; empty if there are none.
    pub reasons: Vec<String>,
    /// Contrast of the cell. Fluorescence: its median brightness above the background, in standard
    /// deviations of the background. Brightfield: the median gradient along its outline, in those
    /// of the picture's noise. `None` for a mask.
    pub contrast: Option<f64>,
}

impl Confidence {
    /// Confidence without any doubt.
    pub(crate) fn full() -> Self {
        Self { score: 1.0, reasons: Vec::new(), contrast: None }
    }

    /// Whether the outline should be checked by eye.
    pub fn is_doubtful(&self) -> bool {
        self.score < DOUBTFUL
    }

    /// Warning about the outline; `None` if there is no doubt.
    ///
    /// # Example
    /// ```
    /// use myospring::microscopy::segment::Confidence;
    /// let reasons = vec!["the frame cuts it".to_owned()];
    /// let sure = Confidence { score: 0.5, reasons, contrast: None };
    /// assert_eq!(
    ///     sure.warning().unwrap(),
    ///     "look at the outline (confidence 0.50 of 1): the frame cuts it"
    /// );
    /// let doubtful = Confidence { score: 0.3, ..sure };
    /// assert!(doubtful.warning().unwrap().contains("if it is wrong, draw it"));
    /// ```
    pub fn warning(&self) -> Option<String> {
        let doubtful = self.is_doubtful();
        let what = if doubtful { "the outline is doubtful" } else { "look at the outline" };
        let advice = if doubtful { format!("; {ADVICE}") } else { String::new() };
        let reasons = self.reasons.join("; ");
        (!reasons.is_empty())
            .then(|| format!("{what} (confidence {:.2} of 1): {reasons}{advice}", self.score))
    }

    /// Whether one reason is that the frame cuts it.
    pub(crate) fn says_cut(&self) -> bool {
        self.reasons.iter().any(|reason| reason.starts_with(CUT))
    }

    /// Whether one reason is that it is ragged, or two cells.
    pub(crate) fn says_ragged(&self) -> bool {
        self.reasons.iter().any(|reason| reason.starts_with(RAGGED))
    }

    /// Confidence without the reasons that concern texture, which a picture made of many does not
    /// show.
    pub(crate) fn beside_texture(&self) -> Self {
        let [blurred, noisy] = HIDES;
        let texture = [OUT_OF_FOCUS, UNIFORM, blurred, noisy];
        let other = |reason: &&String| !texture.iter().any(|start| reason.starts_with(start));
        let reasons: Vec<String> = self.reasons.iter().filter(other).cloned().collect();
        let score = reasons.iter().map(|_| OTHER_REASON).product();
        Self { score, reasons, contrast: self.contrast }
    }

    /// Multiplies the score by a factor: 1 if `value` reaches `good`, 0 at `bad`, linear between.
    /// Below 0.8 the reason is recorded.
    pub(crate) fn weigh(
        &mut self,
        value: f64,
        bad: f64,
        good: f64,
        reason: impl FnOnce() -> String,
    ) {
        let factor = ((value - bad) / (good - bad)).clamp(0.0, 1.0);
        let factor = if factor.is_nan() { 0.0 } else { factor };
        self.score *= factor;
        if factor < 0.8 {
            self.reasons.push(reason());
        }
    }

    /// Applies the criteria common to all modalities: whether the frame cuts the cell, and whether
    /// its shape is that of one cell.
    pub(super) fn weigh_shape(&mut self, candidate: &Candidate<'_>, width: usize) {
        let on_frame = candidate.on_frame;
        if on_frame > 0 {
            // The larger the part of its outline on the frame, the more of the cell may be missing.
            let share = on_frame as f64 / (on_frame + candidate.rim.len()) as f64;
            let [barely, much] = CUT_FACTORS;
            self.score *= barely + (much - barely) * (share / CUT_MUCH).min(1.0);
            self.reasons.push(format!("{CUT}: {on_frame} of its pixels lie on the frame"));
        }
        let (fills_box, roundness) = candidate.figure(width);
        self.weigh(-fills_box, -BOX[0], -BOX[1], || {
            format!(
                "it fills {:.0} % of a rectangle along the picture's rows and columns: is it a panel of a \
                 figure, or part of a device?",
                100.0 * fills_box
            )
        });
        self.weigh(roundness, CIRCLE[0], CIRCLE[1], || {
            "it is a circle: is it a post, a bead, a bubble, or a dead cell?".to_owned()
        });
        let solidity = candidate.solidity(width);
        let [ragged, compact] = SOLIDITY;
        // Each fact gives one reason, the more specific one.
        if let Some((factor, reason)) = &candidate.doubt {
            let both = factor.min((solidity - ragged) / (compact - ragged));
            self.weigh(both, 0.0, 1.0, || reason.clone());
            return;
        }
        self.weigh(solidity, ragged, compact, || {
            // The report states the solidity.
            format!("{RAGGED}: is it ragged, branched, or two cells that touch?")
        });
    }
}

/// Solidity: area in pixels, divided by that of the convex hull of the corners of the rim's pixels
/// (column, row).
pub(super) fn solidity(rim: impl Iterator<Item = [f64; 2]>, pixels: usize) -> f64 {
    let corners = rim.flat_map(|[x, y]| {
        [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|[dx, dy]| Point::new(x + dx, y + dy))
    });
    let hull = MultiPoint::new(corners.collect()).convex_hull().unsigned_area();
    (pixels as f64 / hull.max(1.0)).min(1.0)
}
