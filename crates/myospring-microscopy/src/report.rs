//! The shape of a cell in numbers, with warnings.

use std::f64::consts::PI;
use std::fmt;

use geo::{Area, ConvexHull};
use serde::Serialize;

use super::outlines::PixelFrame;
use super::outlines::raster::within;
use super::segment::Confidence;
use myospring_core::mesh::outline::Outline;
use myospring_core::mesh::quality::{Dimensions, outline_dimensions, write_report};

/// Solidity below which the report warns. Rod-shaped and spindle-shaped cells have 0.85 and more,
/// including those with stepped intercalated discs; two rods of 5:1 in an L have 0.53, in a T 0.60.
pub const LEAST_SOLIDITY: f64 = 0.8;

/// Default range of the expected area of a single heart cell, um^2. Narrow patterned hiPSC
/// cardiomyocytes have 800, neonatal rat cells in culture mostly 600 to 2000, adult rods 2000 to
/// 4500, widely spread hiPSC cardiomyocytes up to 10 000; debris, stripes and vessels mostly lie
/// below 500, sheets and clumps above 20 000. A pixel size that is wrong by a factor of three or
/// more gives an area outside this range.
pub const USUAL_AREAS_UM2: [f64; 2] = [500.0, 20_000.0];

/// Shortest and longest possible length of a heart cell, um. The longest adult ventricular cells
/// have 250, atrial and Purkinje cells up to 300; the smallest cells that beat in culture are some
/// 20 across. A pixel size that is wrong by a factor of ten gives a length outside this range.
pub const POSSIBLE_LENGTHS_UM: [f64; 2] = [15.0, 400.0];

/// Longest usual cell, um: adult ventricular cells have 100 to 150, in failing hearts up to 200.
pub const LONGEST_USUAL_UM: f64 = 250.0;

/// Largest usual ratio of length and mean width; adult cells have 5 to 8.
pub const LARGEST_USUAL_ASPECT: f64 = 15.0;

/// Share of holes in the area of the cell above which the report warns, per cent.
pub const MOST_HOLES_PCT: f64 = 1.0;

/// Shape of a cell; prints as a table.
///
/// All measures are those of the polygon. Holes reduce the area; they do not change any other
/// measure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShapeReport {
    /// Area within the exterior and outside of holes, um^2.
    pub area_um2: f64,
    /// Length of the exterior, um. For an outline along pixel edges it is the length of a
    /// staircase, which is too long.
    pub perimeter_um: f64,
    /// Length, width and long axis.
    #[serde(flatten)]
    pub dimensions: Dimensions,
    /// Area over that of the convex hull, 0 to 1: 1 means no dents and no holes.
    pub solidity: f64,
    /// `4 pi area / perimeter^2`, 0 to 1: 1 is a circle.
    pub circularity: f64,
    /// Number of holes.
    pub holes: usize,
    /// Pixels of the cell in the first and last row and column of the picture; 0 if the picture is
    /// not known.
    pub pixels_on_frame: usize,
    /// Warnings; empty if nothing is unusual.
    pub warnings: Vec<String>,
}

/// Measures an outline, and its position in a picture if that is known; warns of an area outside
/// [`USUAL_AREAS_UM2`].
///
/// # Example
/// ```
/// use myospring::{mesh::built_in, microscopy::report::shape_report};
/// let report = shape_report(&built_in::adult_ventricular(), None);
/// assert!(report.solidity > 0.85 && report.warnings.is_empty());
/// assert_eq!(report.dimensions.length_um.round(), 140.0);
/// ```
pub fn shape_report(outline: &Outline, frame: Option<&PixelFrame>) -> ShapeReport {
    let on_frame = frame.map_or(0, |frame| pixels_on_frame(outline, frame));
    shape_report_of(outline, on_frame, USUAL_AREAS_UM2, &Confidence::full())
}

/// Measures an outline with this number of pixels on the frame; warns of an unexpected area, but
/// does not repeat the reasons of its confidence.
pub(super) fn shape_report_of(
    outline: &Outline,
    pixels_on_frame: usize,
    areas_um2: [f64; 2],
    said: &Confidence,
) -> ShapeReport {
    let (area_um2, perimeter_um) = (outline.area(), outline.perimeter());
    let exterior = geo::Polygon::new(outline.exterior().iter().copied().collect(), Vec::new());
    let holes_area = exterior.unsigned_area() - area_um2;
    let mut report = ShapeReport {
        area_um2,
        perimeter_um,
        dimensions: outline_dimensions(outline),
        solidity: area_um2 / exterior.convex_hull().unsigned_area(),
        circularity: 4.0 * PI * area_um2 / (perimeter_um * perimeter_um),
        holes: outline.holes().len(),
        pixels_on_frame,
        warnings: Vec::new(),
    };
    let holes_pct = 100.0 * holes_area / (area_um2 + holes_area);
    report.warnings = warnings(&report, holes_pct, areas_um2, said);
    report
}

/// Warning about an unusual area of a cell, um^2; `None` within the expected range.
///
/// # Example
/// ```
/// use myospring::microscopy::report::{USUAL_AREAS_UM2, unusual_area};
/// assert_eq!(unusual_area(2500.0, USUAL_AREAS_UM2), None);
/// let debris = unusual_area(130.0, USUAL_AREAS_UM2).unwrap();
/// assert!(debris.starts_with("its area of 130 um^2 is below 500 um^2"));
/// ```
pub fn unusual_area(area_um2: f64, [least, most]: [f64; 2]) -> Option<String> {
    if area_um2 < least {
        return Some(format!(
            "its area of {area_um2:.0} um^2 is below {least} um^2 (--min-area): is it debris, or a piece of a cell, or \
             is the pixel size wrong?"
        ));
    }
    (area_um2 > most).then(|| {
        format!(
            "its area of {area_um2:.0} um^2 is above {most} um^2 (--max-area): are they several cells, or is the pixel \
             size wrong?"
        )
    })
}

/// Why an object of this length and area cannot be a heart cell, as the predicate of a sentence;
/// `None` if it can.
///
/// # Example
/// ```
/// use myospring::microscopy::report::{USUAL_AREAS_UM2, impossible_size};
/// assert_eq!(impossible_size(140.0, 3000.0, USUAL_AREAS_UM2), None);
/// let huge = impossible_size(4140.0, 1.6e6, USUAL_AREAS_UM2).unwrap();
/// assert_eq!(huge, "is 4140 um long; no heart cell is longer than 400 um");
/// ```
pub fn impossible_size(length_um: f64, area_um2: f64, [least, most]: [f64; 2]) -> Option<String> {
    let [shortest, longest] = POSSIBLE_LENGTHS_UM;
    if length_um > longest {
        Some(format!("is {length_um:.0} um long; no heart cell is longer than {longest} um"))
    } else if length_um < shortest {
        Some(format!("is {length_um:.1} um long; no heart cell is shorter than {shortest} um"))
    } else if area_um2 < least {
        Some(format!(
            "has an area of {area_um2:.0} um^2, below the smallest expected area, {least} um^2 (--min-area)"
        ))
    } else if area_um2 > most {
        Some(format!(
            "has an area of {area_um2:.0} um^2, above the largest expected area, {most} um^2 (--max-area)"
        ))
    } else {
        None
    }
}

pub(super) fn pixels_on_frame(outline: &Outline, frame: &PixelFrame) -> usize {
    let (last_column, last_row) = (frame.width() - 1, frame.height() - 1);
    let mut count = 0;
    within(outline, frame, |row, columns| {
        count += if row == 0 || row == last_row {
            columns.len()
        } else {
            // A picture of one column has only one side.
            let right = columns.end == last_column + 1 && last_column > 0;
            usize::from(columns.start == 0) + usize::from(right)
        };
    });
    count
}

fn warnings(
    report: &ShapeReport,
    holes_pct: f64,
    areas_um2: [f64; 2],
    said: &Confidence,
) -> Vec<String> {
    let mut warnings = Vec::new();
    let Dimensions { length_um, aspect_ratio, .. } = report.dimensions;
    if report.pixels_on_frame > 0 && !said.says_cut() {
        warnings.push(format!(
            "the cell touches the frame of the picture with {} pixels and may be cut: its length, width \
             and shortening are then not those of a whole cell",
            report.pixels_on_frame
        ));
    }
    if report.solidity < LEAST_SOLIDITY && !said.says_ragged() {
        warnings.push(format!(
            "solidity {:.2} is below {LEAST_SOLIDITY}: the outline is ragged, or two cells, or has large \
             holes",
            report.solidity
        ));
    }
    let unusual = unusual_area(report.area_um2, areas_um2);
    if unusual.is_none() && length_um > LONGEST_USUAL_UM {
        warnings.push(format!(
            "the cell is {length_um:.0} um long, more than the usual {LONGEST_USUAL_UM} um: is the pixel size right, \
             is it one cell?"
        ));
    }
    warnings.extend(unusual);
    if aspect_ratio > LARGEST_USUAL_ASPECT {
        warnings.push(format!(
            "the cell is {aspect_ratio:.0} times as long as wide, more than {LARGEST_USUAL_ASPECT}: is it \
             a strand of cells, or a scratch?"
        ));
    }
    if holes_pct > MOST_HOLES_PCT {
        warnings.push(format!(
            "holes take {holes_pct:.1} % of the cell: fill them unless they are real"
        ));
    }
    warnings
}

impl fmt::Display for ShapeReport {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let before = [
            ("area", format!("{:.1}", self.area_um2), "um^2"),
            ("perimeter", format!("{:.1}", self.perimeter_um), "um"),
        ];
        let after = [
            ("solidity", format!("{:.3}", self.solidity), ""),
            ("circularity", format!("{:.3}", self.circularity), ""),
            ("holes", self.holes.to_string(), ""),
            ("pixels on the frame", self.pixels_on_frame.to_string(), ""),
        ];
        write_report(
            out,
            before.into_iter().chain(self.dimensions.rows()).chain(after),
            &self.warnings,
        )
    }
}
