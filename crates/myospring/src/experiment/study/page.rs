//! `report.html` of a study: what was found, its figures, and its members.

use super::found::Found;
use crate::output::figure::Figure;
use crate::output::page::{
    self, Answer as Line, Column, Drawing, Look, Page, PageError, Part, Quality, Row, Section,
    Table, TableCell, metric_words,
};
use crate::output::table;
use crate::study::parameters::{Acceptance, Answer, ParameterStudy, Ranked, Sensitivity};
use std::fmt::Write as _;

/// Name of the file.
pub(super) const FILE: &str = "report.html";
/// Members that are listed, and figures that are shown, at most.
const ROWS: usize = 1000;
const FIGURES: usize = 24;

/// The page; `text` is the description.
pub(super) fn html(
    study: &ParameterStudy,
    answer: &Answer<'_>,
    found: &Found<'_>,
    figures: &[(String, Figure)],
    (text, left_out): (&str, &[String]),
) -> Result<String, PageError> {
    let mut sections = Vec::new();
    let ranked: Vec<Part<'_>> =
        found.sensitivity.iter().filter_map(ranking).map(Part::Table).collect();
    if !ranked.is_empty() {
        sections.push(Section {
            hint: "Index or effect with half of its 95 % confidence interval; what matters most first."
                .to_owned(),
            ..Section::new("sensitivity", "Which parameter matters", ranked)
        });
    }
    let mut drawn = Vec::new();
    for (name, figure) in figures.iter().take(FIGURES) {
        drawn.push(Part::Figure(Drawing::new(figure, &name.replace('_', " "))?));
    }
    if !drawn.is_empty() {
        sections.push(Section {
            hint: match figures.len() {
                count if count > FIGURES => {
                    format!("The first {FIGURES} of {count}; the folder `figures` has all.")
                }
                _ => "The folder `figures` has them as SVG and PNG.".to_owned(),
            },
            ..Section::new("figures", "Figures", drawn)
        });
    }
    let members = members(answer);
    sections.push(Section {
        hint: match found.members {
            count if count > ROWS => {
                format!("The first {ROWS} of {count}; members.csv and members.parquet have all.")
            }
            _ => "members.csv and members.parquet have the same table.".to_owned(),
        },
        ..Section::new(
            "members",
            "Members",
            vec![Part::Table(Table::of("Members", &members, ROWS, |_| true))],
        )
    });
    let description =
        Part::Text { what: "description".to_owned(), file: "study.toml", text: text.to_owned() };
    sections.push(Section::new("description", "How to repeat it", vec![description]));
    let title = if study.title.is_empty() { "Study" } else { &study.title };
    page::html(&Page {
        kind: "Many runs, by Myospring",
        title,
        facts: vec![
            format!("{} members", found.members),
            match study.varied.len() {
                1 => "1 number varies".to_owned(),
                count => format!("{count} numbers vary"),
            },
        ],
        answer: Some(line(study, found)),
        warnings: left_out.to_vec(),
        sections,
    })
}

/// The first members, in order of their numbers.
fn members(answer: &Answer<'_>) -> table::Table {
    let mut members = answer.pieces().next().unwrap_or_else(|| answer.table());
    if let Some(table::Column::Number { name, values }) = members.columns.first() {
        let values = values.iter().map(|value| value.map(|value| format!("{value:.0}"))).collect();
        members.columns[0] = table::Column::Text { name: name.clone(), values };
    }
    members
}

/// How many members there are, and how many beat and were kept.
fn line(study: &ParameterStudy, found: &Found<'_>) -> Line {
    let Acceptance { beat, kept, failed, not_captured, .. } = found.acceptance;
    let mut words = format!("{beat} of {} members beat", found.members);
    if failed > 0 {
        let _ = write!(words, ", {failed} failed");
    }
    if not_captured > 0 {
        let _ = write!(words, ", {not_captured} missed stimuli");
    }
    if !study.keep.is_empty() {
        let _ = write!(words, ", {kept} kept");
    }
    let quality = match (beat, failed) {
        (0, _) => Quality::Poor,
        (_, 0) => Quality::Good,
        _ => Quality::Fair,
    };
    Line { words: format!("{words}."), quality }
}

/// The parameters of a metric, the most important first; none if too few members have the metric.
fn ranking(one: &Sensitivity) -> Option<Table> {
    let spread = |value: f64, confidence: f64| TableCell {
        spread: Some(confidence).filter(|it| it.is_finite()),
        ..TableCell::number(Some(value))
    };
    let row = |ranked: &Ranked| {
        let name = ranked.parameter();
        let short = name.rsplit_once('.').map_or(name, |(_, short)| short);
        let mut cells = vec![TableCell::term(short, name)];
        cells.extend(match ranked {
            Ranked::Sobol { first, total, .. } => {
                [spread(first.value, first.confidence), spread(total.value, total.confidence)]
            }
            Ranked::Morris { mean_size, mean, .. } => {
                [spread(mean_size.value, mean_size.confidence), TableCell::number(Some(*mean))]
            }
        });
        Row::from(cells)
    };
    let names = match one.parameters.first()? {
        Ranked::Sobol { .. } => {
            [Column::number("alone", ""), Column::number("with all interactions", "")]
        }
        Ranked::Morris { .. } => {
            [Column::number("mean size of effect", one.unit), Column::number("mean", one.unit)]
        }
    };
    Some(Table {
        caption: metric_words(&one.metric),
        look: Look::Numbers,
        columns: std::iter::once(Column::text("parameter")).chain(names).collect(),
        rows: one.parameters.iter().map(row).collect(),
    })
}
