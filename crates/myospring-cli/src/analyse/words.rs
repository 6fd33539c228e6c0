//! The output of `analyse` for people.

use crate::table::{aligned, number};
use myospring::analysis::curve::State;
use myospring::experiment::analyse::{AnalysedCurve, KEY, Mean, conventions, means};

/// Curves of which every metric is printed, at most.
const WHOLE: usize = 3;

/// The tables on the terminal.
pub(crate) fn tables(all: &[AnalysedCurve]) -> String {
    let found = all.iter().filter(|read| read.found.is_ok()).count();
    if found > WHOLE { rows(all) } else { all.iter().map(one).collect::<Vec<_>>().join("\n") }
}

fn one(read: &AnalysedCurve) -> String {
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
fn rows(all: &[AnalysedCurve]) -> String {
    let mut lines = vec![vec!["curve".to_owned(), "beats".to_owned()]];
    let columns = || KEY.iter().filter(|(title, _)| *title != "at rest");
    lines[0].extend(columns().map(|(title, _)| (*title).to_owned()));
    for read in all {
        let mut line = vec![read.title()];
        match &read.found {
            Err(_) => line.push("none".to_owned()),
            Ok(analysis) => {
                let means = means(analysis);
                line.push(analysis.beats.len().to_string());
                line.extend(columns().map(|(_, names)| {
                    Mean::first(&means, names).and_then(Mean::in_words).unwrap_or_default()
                }));
            }
        }
        lines.push(line);
    }
    aligned(&lines, &[1])
}
