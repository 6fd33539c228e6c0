//! What was found in a picture, for people.

use myospring::experiment::segment::{FrameFibres, FrameReport, LatticeReport, SegmentReport};
use myospring::microscopy::cells::PictureCells;

/// Contrasts above this are printed as a bound.
const NOISELESS: f64 = 1000.0;

/// The cells of a picture.
pub(super) fn for_people(report: &SegmentReport<'_>, cells: &PictureCells) -> String {
    let mut parts = vec![format!("{}: {}", report.picture, cells.method())];
    for cell in &report.cells {
        let contrast = match cell.confidence.contrast {
            None => String::new(),
            Some(contrast) if contrast > NOISELESS => {
                format!(", contrast above {NOISELESS} times the noise")
            }
            Some(contrast) => format!(", contrast {contrast:.1} times the noise"),
        };
        parts.push(format!(
            "cell {}, confidence {:.2} of 1{contrast}",
            cell.name, cell.confidence.score
        ));
        // Warnings go to stderr.
        let shape = cell.shape.to_string();
        let lines: Vec<&str> = shape.lines().filter(|line| !line.starts_with("warning")).collect();
        parts.push(lines.join("\n"));
        if let Some(LatticeReport { spacing_um, masses, springs, triangles }) = &cell.lattice {
            parts.push(format!(
                "{:<20} {masses} masses, {springs} springs, {triangles} triangles, spacing {spacing_um} um",
                "lattice"
            ));
        }
        if let Some(fibres) = &cell.fibres {
            parts.push(format!("{:<20} {fibres}", "fibres"));
        }
        parts.push(String::new());
    }
    parts.join("\n")
}

/// The fibres of a whole frame.
pub(super) fn of_frame(report: &FrameReport<'_>) -> String {
    let FrameFibres { read_pct, direction_deg, alignment, .. } = &report.fibres;
    let mut lines = vec![
        format!(
            "{}: the whole frame, {:.0} x {:.0} um, pixels of {} um ({}); no cell was outlined",
            report.picture,
            report.width_um,
            report.height_um,
            report.pixel_size_um,
            report.pixel_size_source
        ),
        format!("{:<20} read in {read_pct:.0} % of the frame", "fibres"),
    ];
    if let (Some(direction), Some(alignment)) = (direction_deg, alignment) {
        lines.push(format!(
            "{:<20} {direction:.0} degrees from x, alignment {alignment:.2} (1 is parallel, 0 is every direction)",
            "mean direction"
        ));
    }
    let FrameFibres { sarcomere_um, sarcomere_q1_um, sarcomere_q3_um, .. } = &report.fibres;
    if let (Some(median), Some(q1), Some(q3)) = (sarcomere_um, sarcomere_q1_um, sarcomere_q3_um) {
        let doubt = report.fibres.sarcomere_doubt;
        let doubt = doubt.map_or_else(String::new, |doubt| format!(", doubtful: {doubt}"));
        lines.push(format!(
            "{:<20} {median:.2} um (quartiles {q1:.2}, {q3:.2}){doubt}",
            "sarcomeres"
        ));
    }
    lines.join("\n")
}
