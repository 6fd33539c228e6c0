//! `report.html` of tractions.

use super::followed::Followed;
use super::frame::TractionFrame;
use crate::experiment::analyse::{AnalysedCurve, means};
use crate::experiment::legible::number;
use crate::mechanics::gel::Gel;
use crate::output::figure::{Figure, Measured};
use crate::output::page::{
    self, Answer, Chart, Column, Drawing, Page, PageError, Part, Quality, Row, Section, Series,
    Table, TableCell, Tile, Tone, metric_words,
};

/// What the page shows.
pub(super) struct Shown<'a> {
    /// All frames, and that of the largest force.
    pub(super) frames: &'a [TractionFrame],
    pub(super) strongest: &'a TractionFrame,
    /// Beats of the axial force, where times are known.
    pub(super) beats: Option<&'a AnalysedCurve>,
    /// The map, where it can be drawn.
    pub(super) map: Option<Figure>,
    pub(super) gel: Gel,
    /// Whether tractions were sought in a region, not in the whole window.
    pub(super) is_confined: bool,
    /// How beads were followed.
    pub(super) followed: Option<&'a Followed>,
    /// Noise of displacements and the shortest wave of the map, um.
    pub(super) noise_um: f64,
    pub(super) shortest_wave_um: f64,
    /// What each number is, by the name of its column.
    pub(super) definitions: &'a [(&'static str, &'static str)],
    pub(super) warnings: Vec<String>,
}

/// The page.
///
/// # Errors
/// A page that cannot be written.
pub(super) fn html(shown: Shown<'_>) -> Result<String, PageError> {
    let mut sections = vec![key(&shown)];
    if let Some(map) = &shown.map {
        let words =
            "Tractions of the cell on the gel at the largest force, and the force over time";
        sections.push(Section::new("map", "Map", vec![Part::Figure(Drawing::new(map, words)?)]));
    }
    let charts = charts(&shown);
    if !charts.is_empty() {
        sections.push(Section::new("curves", "Over time", vec![Part::Charts(charts)]));
    }
    sections.extend(beats(&shown));
    sections.push(found(&shown));
    let film = shown.followed.map(|followed| followed.film.rsplit(['/', '\\']).next());
    let title = film.flatten().map_or_else(
        || "Tractions from displacements of a gel".to_owned(),
        |film| format!("Tractions of {film}"),
    );
    let TractionFrame { axial_force_nn, axial_noise_floor_nn, .. } = *shown.strongest;
    let answer = Answer {
        words: format!(
            "Axial force {} nN; noise alone makes \u{b1} {} nN.",
            number(axial_force_nn),
            number(axial_noise_floor_nn)
        ),
        quality: if shown.warnings.is_empty() { Quality::Good } else { Quality::Fair },
    };
    page::html(&Page {
        kind: "Tractions of a cell on a gel, by Myospring",
        title: &title,
        facts: facts(&shown),
        answer: Some(answer),
        warnings: shown.warnings,
        sections,
    })
}

fn facts(shown: &Shown<'_>) -> Vec<String> {
    let Gel { modulus, poisson, thickness, .. } = shown.gel;
    let depth = thickness.map_or_else(|| "half-space".to_owned(), |um| format!("{um} um thick"));
    let frames = match shown.frames.len() {
        1 => "1 frame".to_owned(),
        count => format!("{count} frames"),
    };
    let place = if shown.is_confined { "in a region" } else { "in the whole window" };
    vec![
        format!("gel of {modulus} kPa, Poisson's ratio {poisson}, {depth}"),
        frames,
        place.to_owned(),
    ]
}

/// The numbers of the frame of the largest force, each with what noise makes of it.
fn key(shown: &Shown<'_>) -> Section<'static> {
    let at = shown.strongest;
    let tile = |name: &str, column: &str, value: f64, unit: &str, noise: Option<String>| {
        let known = shown.definitions.iter().find(|(known, _)| *known == column);
        let value = TableCell { unit: unit.to_owned(), ..TableCell::number(Some(value)) };
        Tile {
            definition: known.map_or_else(String::new, |(_, words)| (*words).to_owned()),
            lines: noise.into_iter().map(TableCell::text).collect(),
            ..Tile::new(name, value)
        }
    };
    let axial = format!("noise alone: \u{b1} {} nN", number(at.axial_noise_floor_nn));
    let floor = format!("noise alone: {} nN", number(at.noise_floor_nn));
    let tiles = vec![
        tile("axial force", "axial_force_nN", at.axial_force_nn, "nN", Some(axial)),
        tile("force, all directions", "traction_force_nN", at.force_nn, "nN", Some(floor)),
        tile("contractile moment", "contractile_moment_fJ", at.contractile_moment_fj, "fJ", None),
        tile("energy of the gel", "gel_energy_fJ", at.energy_fj, "fJ", None),
    ];
    let when = at.t_ms.map_or_else(String::new, |t_ms| format!(" at {} ms", number(t_ms)));
    let hint = match shown.frames.len() {
        1 => String::new(),
        _ => format!("In frame {}{when}, that of the largest force.", at.frame),
    };
    let title = if hint.is_empty() { "Key numbers" } else { "At the largest force" };
    Section { hint, ..Section::new("key", title, vec![Part::Tiles(tiles)]) }
}

/// The numbers of all frames, where their times are known.
fn charts(shown: &Shown<'_>) -> Vec<Chart> {
    let times: Option<Vec<f64>> = shown.frames.iter().map(|frame| frame.t_ms).collect();
    let Some(times) = times.filter(|times| times.len() > 1) else { return Vec::new() };
    let series = |label: &str, tone: Tone, of: &dyn Fn(&TractionFrame) -> f64| Series {
        label: label.to_owned(),
        tone,
        dotted: false,
        times_ms: times.clone(),
        values: shown.frames.iter().map(of).collect(),
    };
    let chart = |name: &str, unit: &str, series: Vec<Series>| Chart {
        name: name.to_owned(),
        unit: unit.to_owned(),
        series,
        ..Chart::default()
    };
    let name = "Axial force";
    let analysed = shown.beats.and_then(|read| Some((read, read.found.as_ref().ok()?)));
    let mut charts = if let Some((read, analysis)) = analysed {
        Chart::of_curve(&Measured {
            title: name,
            kind: read.curve.kind,
            unit: read.curve.unit,
            times_ms: &read.curve.times_ms,
            values: &read.curve.values,
            analysis,
            numbers: &[],
        })
    } else {
        let axial = series("axial force", Tone::Tension, &|frame| frame.axial_force_nn);
        vec![chart(name, "nN", vec![axial])]
    };
    let force = vec![
        series("force", Tone::Tension, &|frame| frame.force_nn),
        series("noise alone", Tone::Raw, &|frame| frame.noise_floor_nn),
    ];
    let moment = series("moment", Tone::Signal, &|frame| frame.contractile_moment_fj);
    let energy = series("energy", Tone::Shortening, &|frame| frame.energy_fj);
    charts.extend([
        chart("Force, all directions", "nN", force),
        chart("Contractile moment", "fJ", vec![moment]),
        chart("Energy of the gel", "fJ", vec![energy]),
    ]);
    charts
}

/// The beats of the axial force, or why there are none.
fn beats(shown: &Shown<'_>) -> Option<Section<'static>> {
    let title = "Beats of the axial force";
    let analysis = match &shown.beats?.found {
        Ok(analysis) => analysis,
        Err(why) => {
            let words = format!("No beats were found: {why}.");
            return Some(Section::new("beats", title, vec![Part::Words(vec![words])]));
        }
    };
    let rows = means(analysis).into_iter().map(|mean| {
        let note = mean.missing.map_or_else(String::new, |why| why.words().to_owned());
        let spread = mean.standard_deviation;
        Row::from(vec![
            TableCell::term(metric_words(mean.name), mean.definition),
            TableCell { spread, note, ..TableCell::number(mean.mean) },
            TableCell::text(mean.unit),
            TableCell::number(Some(mean.beats as f64)),
        ])
    });
    let columns = vec![
        Column::text("quantity"),
        Column::of("number", "mean \u{b1} SD"),
        Column::of("unit", "unit"),
        Column::of("number", "beats"),
    ];
    let table = Table { columns, rows: rows.collect(), ..Table::default() };
    Some(Section::new("beats", title, vec![Part::Table(table)]))
}

/// How the displacements were found, and how fine the map is.
fn found(shown: &Shown<'_>) -> Section<'static> {
    let um = |value: f64| format!("{} um", number(value));
    let mut rows = vec![
        ("noise of displacements", um(shown.noise_um)),
        ("shortest wave of the map", um(shown.shortest_wave_um)),
    ];
    if let Some(followed) = shown.followed {
        rows.extend([
            ("displacements are relative to", followed.reference.clone()),
            ("side of a square", um(followed.subset_um)),
            ("distance of beads", um(followed.bead_distance_um)),
            ("interpolated, mean", format!("{} %", number(followed.interpolated_pct_mean))),
            ("interpolated, worst frame", format!("{} %", number(followed.interpolated_pct_most))),
            (
                "motion of the stage",
                format!("{}, up to {}", followed.stage, um(followed.stage_largest_um)),
            ),
        ]);
    }
    let row = |(name, value)| Row::from(vec![TableCell::text(name), TableCell::text(value)]);
    let columns = vec![Column::text("what"), Column::text("value")];
    let table = Table { columns, rows: rows.into_iter().map(row).collect(), ..Table::default() };
    Section {
        hint: "Waves of tractions that are shorter than the shortest one are damped to less than half.".to_owned(),
        ..Section::new("found", "How it was found", vec![Part::Table(table)])
    }
}
