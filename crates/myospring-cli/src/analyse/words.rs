//! The output of `analyse` for people.

use crate::table::{aligned, number};
use myospring::analysis::curve::State;
use myospring::experiment::analyse::{
    AnalysedCurve, KEY, Mean, PairedCurves, conventions, means, means_of,
};

/// Curves of which every metric is printed, at most.
const WHOLE: usize = 3;

/// The tables on the terminal.
pub(crate) fn tables(all: &[AnalysedCurve]) -> String {
    let found = all.iter().filter(|read| read.found.is_ok()).count();
    if found > WHOLE { rows(all) } else { all.iter().map(one).collect::<Vec<_>>().join("\n") }
}

/// Calcium and motion of the same beats.
pub(crate) fn pairs(all: &[AnalysedCurve], pairs: &[PairedCurves]) -> String {
    let one = |pair: &PairedCurves| {
        let counted = pair.paired.counted();
        let head = format!(
            "{}: {} of {} beats in both; loop {}",
            pair.title(all),
            counted.len(),
            pair.paired.beats.len(),
            pair.paired.direction.words()
        );
        format!("\n{head}\n{}", aligned(&lines(means_of(&counted)), &[1, 2, 3]))
    };
    pairs.iter().take(WHOLE).map(one).collect()
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
    format!(
        "{head}\nbeats: {}\n{}\n{}",
        states.join(", "),
        conventions(&analysis.treatment).replace("; ", "\n"),
        aligned(&lines(means(analysis)), &[1, 2, 3])
    )
}

/// A row for each metric, below a head.
fn lines(means: Vec<Mean>) -> Vec<Vec<String>> {
    let mut lines = vec![vec![
        "metric".to_owned(),
        "mean".to_owned(),
        "SD".to_owned(),
        "beats".to_owned(),
        "unit".to_owned(),
        String::new(),
    ]];
    for mean in means {
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
    lines
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
