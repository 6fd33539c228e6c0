//! The data of a page; `page/src/payload.d.ts` has the same types for its script.

use super::cell::{self, BeatingCells, CellData};
use super::chart::{Chart, ChartData, Times};
use super::content::{Answer, Page, Part, Section};
use super::error::PageError;
use super::figure::{Drawing, Thumbnail};
use super::table::{Table, Tile};
use crate::digits::rounded;
use crate::figure::LikelihoodProfile;
use crate::json::JsonError;
use serde::Serialize;

#[derive(Serialize)]
struct Payload<'a> {
    form: u32,
    kind: &'a str,
    title: &'a str,
    version: &'static str,
    facts: &'a [String],
    answer: Option<&'a Answer>,
    warnings: &'a [String],
    times_ms: Vec<Vec<f64>>,
    sections: Vec<SectionData<'a>>,
}

#[derive(Serialize)]
struct SectionData<'a> {
    id: &'static str,
    title: &'a str,
    hint: &'a str,
    parts: Vec<PartData<'a>>,
}

#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum PartData<'a> {
    Beat(BeatData<'a>),
    Charts { charts: Vec<ChartData<'a>> },
    Profiles { profiles: Vec<ProfileData<'a>> },
    Tiles { tiles: &'a [Tile] },
    Table(&'a Table),
    Gallery { thumbnails: &'a [Thumbnail] },
    Figure(&'a Drawing),
    Words { words: &'a [String] },
    Text { what: &'a str, file: &'a str, text: &'a str },
    Folded { title: &'a str, on_paper: bool, parts: Vec<PartData<'a>> },
}

#[derive(Serialize)]
struct BeatData<'a> {
    colour: &'static str,
    cells: Vec<CellData<'a>>,
    charts: Vec<ChartData<'a>>,
    folded_title: &'a str,
    folded: Vec<ChartData<'a>>,
    words: &'a str,
}

#[derive(Serialize)]
struct ProfileData<'a> {
    label: &'a str,
    value: f64,
    interval: [Option<f64>; 2],
    points: Vec<[f64; 2]>,
    at_ends: f64,
}

/// The data of a page as JSON, for a script that draws it as `report.html` does.
///
/// # Errors
/// Those of [`html`](fn@super::html).
pub fn data(page: &Page<'_>) -> Result<String, PageError> {
    let mut charts = Vec::new();
    page.sections.iter().for_each(|section| charts_in(&section.parts, &mut charts));
    let times = Times::of(charts.into_iter());
    let Page { kind, title, facts, answer, warnings, sections } = page;
    let sections = sections.iter().map(|Section { id, title, hint, parts }| {
        Ok(SectionData { id, title, hint, parts: all(parts, &times)? })
    });
    let sections = sections.collect::<Result<_, PageError>>()?;
    let payload = Payload {
        form: 2,
        kind,
        title,
        version: env!("CARGO_PKG_VERSION"),
        facts,
        answer: answer.as_ref(),
        warnings,
        times_ms: times.data(),
        sections,
    };
    Ok(serde_json::to_string(&payload).map_err(JsonError::from)?)
}

fn charts_in<'a>(parts: &'a [Part<'_>], all: &mut Vec<&'a Chart>) {
    for part in parts {
        match part {
            Part::Beat(beat) => all.extend(beat.charts.iter().chain(&beat.folded.1)),
            Part::Charts(charts) => all.extend(charts),
            Part::Folded { parts, .. } => charts_in(parts, all),
            _ => {}
        }
    }
}

fn all<'a>(parts: &'a [Part<'_>], times: &Times<'a>) -> Result<Vec<PartData<'a>>, PageError> {
    parts.iter().map(|part| data_of(part, times)).collect()
}

fn data_of<'a>(part: &'a Part<'_>, times: &Times<'a>) -> Result<PartData<'a>, PageError> {
    let of = |charts: &'a [Chart]| charts.iter().map(|chart| times.chart(chart)).collect();
    Ok(match part {
        Part::Beat(beat) => {
            let BeatingCells { colour, cells, charts, folded: (folded_title, folded), words } =
                beat;
            if cells.is_empty() {
                return Err(PageError::NoRuns);
            }
            // All cells together are one file.
            let cells = cells.iter().map(|each| cell::of(each, cells.len()));
            let (cells, colour) = (cells.collect::<Result<_, _>>()?, colour.word());
            let (charts, folded) = (of(charts), of(folded));
            PartData::Beat(BeatData { colour, cells, charts, folded_title, folded, words })
        }
        Part::Charts(charts) => PartData::Charts { charts: of(charts) },
        Part::Profiles(all) => PartData::Profiles { profiles: all.iter().map(profile).collect() },
        Part::Tiles(tiles) => PartData::Tiles { tiles },
        Part::Table(table) => PartData::Table(table),
        Part::Gallery(thumbnails) => PartData::Gallery { thumbnails },
        Part::Figure(drawing) => PartData::Figure(drawing),
        Part::Words(words) => PartData::Words { words },
        Part::Text { what, file, text } => PartData::Text { what, file, text },
        Part::Folded { title, on_paper, parts } => {
            PartData::Folded { title, on_paper: *on_paper, parts: all(parts, times)? }
        }
    })
}

fn profile(profile: &LikelihoodProfile) -> ProfileData<'_> {
    let LikelihoodProfile { label, value, interval, points, at_ends } = profile;
    let points = points.iter().map(|point| point.map(rounded)).collect();
    ProfileData { label, value: *value, interval: *interval, points, at_ends: *at_ends }
}
