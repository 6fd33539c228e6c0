//! `report.html` of a film: its cell moving on the frame at rest, with the curves of the cell.

use super::followed::Followed;
use super::report::TrackReport;
use crate::output::field::Field;
use crate::output::page::{
    self, Answer, BeatingCells, Chart, MovingCell, Page, PageError, Part, Photograph, Quality,
    Section, Series, TableCell, Tile, Tone,
};
use crate::output::track::TrackRow;
use crate::recording::Frame;

/// The page.
pub(super) fn html(
    followed: &Followed,
    report: &TrackReport,
    frames: &[Frame],
) -> Result<String, PageError> {
    let Followed { motion, shaped, fibres, .. } = followed;
    let picture = shaped.picture.as_ref().map(|(cells, _)| Photograph {
        width: cells.plane.width(),
        height: cells.plane.height(),
        values: cells.plane.values(),
        pixel_size: cells.pixel_size,
    });
    let cell = MovingCell {
        label: "the cell",
        mesh: &motion.mesh,
        frames,
        fibres: &fibres.directions,
        myofibril_content: None,
        has_tension: false,
        outline: &shaped.outline,
        picture,
        peak_ms: report.rows[report.headline.at].t_ms,
        thick: None,
    };
    let beat = BeatingCells {
        colour: Field::default(),
        cells: vec![cell],
        charts: charts(&report.rows),
        folded: (String::new(), Vec::new()),
        words: String::new(),
    };
    let mut measured = how_measured(report);
    measured.extend(how_this_cell(report));
    let sections = vec![
        Section::new("key", "Key numbers", vec![Part::Tiles(tiles(report))]),
        Section::new("beat", "The film", vec![Part::Beat(beat)]),
        Section::new("notes", "How it was measured", vec![Part::Words(measured)]),
    ];
    let headline = &report.headline;
    let quality = if report.warnings.is_empty() { Quality::Good } else { Quality::Fair };
    let page = Page {
        kind: "The cell of a film, followed by Myospring",
        title: report.film.rsplit(['/', '\\']).next().unwrap_or(&report.film),
        facts: vec![
            format!("{} of {} frames", report.frames_followed, report.frames),
            format!("{:.4} /s", report.frames_per_second),
            format!("{} points", report.points),
        ],
        answer: Some(Answer {
            words: format!(
                "The cell contracts by {:.2} % (frame {}), read from `{}`: {}.",
                headline.peak_contraction_pct,
                headline.peak_frame,
                headline.column,
                headline.because
            ),
            quality,
        }),
        warnings: report.warnings.clone(),
        sections,
    };
    page::html(&page)
}

/// How the motion of a film was measured.
pub(super) fn how_measured(report: &TrackReport) -> Vec<String> {
    vec![
        format!("The frame at rest is frame {}.", report.rest_frame),
        format!(
            "Pixels of {:.4} um ({}); {:.4} frames a second ({}).",
            report.pixel_size_um,
            report.pixel_size_source,
            report.frames_per_second,
            report.frame_rate_source
        ),
        format!("Each point is followed by a square of {:.1} um.", report.subset_um),
        format!("Motion of the stage: {}, up to {:.2} um.", report.stage, report.stage_largest_um),
    ]
}

/// How the motion of one cell was measured.
fn how_this_cell(report: &TrackReport) -> Vec<String> {
    let mut words = vec![format!("{} points, {:.2} um apart.", report.points, report.spacing_um)];
    if let Some(error) = report.noise_error_um {
        words.push(format!("Noise moves a point by {error:.4} um (standard error)."));
    }
    if report.sarcomere_rest_um.is_some() {
        words.push(format!(
            "Sarcomeres: means of {} places in {} parts of the cell.",
            report.sarcomere_places, report.sarcomere_parts
        ));
    }
    words
}

fn tiles(report: &TrackReport) -> Vec<Tile> {
    let tile = |name: &str, definition: &str, number: Option<f64>, unit: &str| {
        let unit = unit.to_owned();
        let value = TableCell { unit, ..TableCell::number(number) };
        number
            .is_some()
            .then(|| Tile { definition: definition.to_owned(), ..Tile::new(name, value) })
    };
    let interval = |ends: Option<[f64; 2]>, digits: usize, unit: &str| {
        let words =
            ends.map(|[low, high]| format!("95 %: {low:.digits$} to {high:.digits$} {unit}"));
        words.into_iter().map(TableCell::text).collect()
    };
    let rest = tile(
        "sarcomeres at rest",
        "mean length of the sarcomeres that can be read in nearly all frames",
        report.sarcomere_rest_um,
        "um",
    );
    let shorter = tile(
        "sarcomere shortening",
        "largest shortening of these sarcomeres, per cent of their length at rest",
        report.sarcomere_shortening_pct,
        "%",
    );
    let with = |tile: Option<Tile>, lines| tile.map(|tile| Tile { lines, ..tile });
    let stretch = Some(report.least_stretch);
    [
        tile("length at rest", "extent of the cell along its long axis, in the frame at rest", Some(report.resting_length_um), "um"),
        tile("peak shortening", "largest loss of length, per cent of that at rest", Some(report.peak_shortening_pct), "%"),
        tile("least stretch", "smaller principal stretch of the whole cell, 1 at rest", stretch, ""),
        with(rest, interval(report.sarcomere_rest_interval_um, 3, "um")),
        with(shorter, interval(report.sarcomere_shortening_interval_pct, 1, "%")),
        tile("interpolated", "points that were not found again but interpolated from their neighbours, mean over the frames", Some(report.interpolated_pct_mean), "%"),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn charts(rows: &[TrackRow]) -> Vec<Chart> {
    let series = |label: &str, tone, of: &dyn Fn(&TrackRow) -> Option<f64>| Series {
        label: label.to_owned(),
        tone,
        dotted: false,
        times_ms: rows.iter().map(|row| row.t_ms).collect(),
        values: rows.iter().map(|row| of(row).unwrap_or(f64::NAN)).collect(),
    };
    let chart = |name: &str, unit: &str, note: &str, series| Chart {
        name: name.to_owned(),
        unit: unit.to_owned(),
        note: note.to_owned(),
        series,
        ..Chart::default()
    };
    let stretches = vec![
        series("smaller", Tone::Run(0), &|row| Some(row.stretch_1)),
        series("larger", Tone::Run(1), &|row| Some(row.stretch_2)),
    ];
    let mut charts = vec![
        chart(
            "Length",
            "um",
            "",
            vec![series("length", Tone::Shortening, &|row| Some(row.length_um))],
        ),
        chart(
            "Stretches of the whole cell",
            "",
            "solid: smaller, dashed: larger; 1 at rest",
            stretches,
        ),
    ];
    if rows.iter().any(|row| row.sarcomere_um.is_some()) {
        let sarcomeres = vec![series("sarcomeres", Tone::Signal, &|row| row.sarcomere_um)];
        charts.push(chart("Sarcomere length", "um", "", sarcomeres));
    }
    let interpolated =
        vec![series("interpolated", Tone::Measured, &|row| Some(row.interpolated_pct))];
    charts.push(chart("Interpolated points", "%", "not found again in this frame", interpolated));
    charts
}
