//! What `analyse` tells people.

use super::Read;
use super::files::{Mean, conventions, means, value};
use crate::table::{aligned, number};
use myospring::analysis::curve::State;

/// Curves of which every metric is printed, at most.
const WHOLE: usize = 3;

/// Metrics of a row where there are many curves: of whichever of the alternatives it has.
const COLUMNS: [(&str, &[&str]); 5] = [
    ("interval", &["interval"]),
    (
        "amplitude",
        &[
            "peak_shortening",
            "peak_amplitude",
            "developed_tension",
            "transient_amplitude",
            "action_potential_amplitude",
        ],
    ),
    (
        "time to peak",
        &[
            "time_to_peak_from_stimulus",
            "time_to_peak_tension",
            "time_to_peak_from_onset",
            "time_to_peak_tension_from_onset",
        ],
    ),
    (
        "half back",
        &[
            "relaxation_time_50",
            "tension_relaxation_time_50",
            "decay_time_50",
            "action_potential_duration_50",
        ],
    ),
    (
        "90 % back",
        &[
            "relaxation_time_90",
            "tension_relaxation_time_90",
            "decay_time_90",
            "action_potential_duration_90",
        ],
    ),
];

/// The tables on the terminal.
pub(crate) fn tables(all: &[Read]) -> String {
    let found = all.iter().filter(|read| read.found.is_ok()).count();
    if found > WHOLE { rows(all) } else { all.iter().map(one).collect::<Vec<_>>().join("\n") }
}

fn one(read: &Read) -> String {
    let rate = read.curve.frame_rate_per_s().map(|rate| format!(" at {} /s", number(rate)));
    let head = format!(
        "{}: {}, {} frames{}",
        read.title(),
        read.curve.kind,
        read.curve.values.len(),
        rate.unwrap_or_default()
    );
    let Ok(analysis) = &read.found else { return format!("{head}\n") };
    let count = |state| analysis.beats.iter().filter(|beat| beat.state == state).count();
    let states = [
        State::Whole,
        State::CutAtStart,
        State::CutAtEnd,
        State::Disturbed,
        State::Interrupted,
        State::Missed,
    ];
    let states: Vec<String> = states
        .into_iter()
        .filter(|state| count(*state) > 0)
        .map(|state| format!("{} {}", count(state), state.words()))
        .collect();
    let mut lines = vec![vec![
        "metric".to_owned(),
        "mean".to_owned(),
        "SD".to_owned(),
        "beats".to_owned(),
        "unit".to_owned(),
        String::new(),
    ]];
    for mean in means(analysis) {
        let show = |value: Option<f64>| value.map(number).unwrap_or_default();
        lines.push(vec![
            mean.name.replace('_', " "),
            show(mean.mean),
            show(mean.standard_deviation),
            mean.beats.to_string(),
            mean.unit.to_owned(),
            mean.missing.map_or_else(String::new, |why| format!("none: {}", why.words())),
        ]);
    }
    format!(
        "{head}\nbeats: {}\n{}\n{}",
        states.join(", "),
        conventions(&analysis.treatment).replace("; ", "\n"),
        aligned(&lines, &[1, 2, 3])
    )
}

/// A row for each curve.
fn rows(all: &[Read]) -> String {
    let mut lines = vec![vec!["curve".to_owned(), "beats".to_owned()]];
    lines[0].extend(COLUMNS.iter().map(|(title, _)| (*title).to_owned()));
    for read in all {
        let mut line = vec![read.title()];
        match &read.found {
            Err(_) => line.push("none".to_owned()),
            Ok(analysis) => {
                let means = means(analysis);
                line.push(analysis.beats.len().to_string());
                line.extend(COLUMNS.iter().map(|(_, names)| {
                    let has = |mean: &&Mean| names.contains(&mean.name) && mean.mean.is_some();
                    means.iter().find(has).and_then(value).unwrap_or_default()
                }));
            }
        }
        lines.push(line);
    }
    aligned(&lines, &[1])
}

/// What is odd, curve by curve.
pub(crate) fn remarks(all: &[Read]) -> Vec<String> {
    let mut remarks = Vec::new();
    let none: Vec<&Read> = all.iter().filter(|read| read.found.is_err()).collect();
    if none.len() > WHOLE {
        remarks.push(format!(
            "{} of {} curves have no beat; summary.csv has the reasons",
            none.len(),
            all.len()
        ));
    } else {
        remarks.extend(none.iter().filter_map(|read| {
            let why = read.found.as_ref().err()?;
            Some(format!("{}: {why}", read.title()))
        }));
    }
    let mut odd = Vec::new();
    for read in all {
        let Ok(analysis) = &read.found else { continue };
        let of_curve = analysis.remarks.iter().cloned();
        // What is said of every beat in turn the remark on the curve has said.
        let said = ["alternans", "an artefact at", "artefacts at"];
        let is_new = |remark: &&String| !said.iter().any(|start| remark.starts_with(start));
        let of_beats = analysis.beats.iter().flat_map(|beat| {
            beat.remarks
                .iter()
                .filter(is_new)
                .map(move |remark| format!("beat {}: {remark}", beat.number))
        });
        odd.extend(of_curve.chain(of_beats).map(|remark| format!("{}: {remark}", read.title())));
    }
    let more = odd.len().saturating_sub(20);
    odd.truncate(20);
    remarks.extend(odd);
    if more > 0 {
        remarks.push(format!("{more} further remarks stand in summary.json and metrics.csv"));
    }
    remarks
}
