//! The option `--outputs` of `myospring run` and `myospring track`.

use clap::builder::{PossibleValue, PossibleValuesParser};
use myospring::experiment::run::{ALL, NONE, OUTPUTS};
use myospring::experiment::track::Output;

/// The default outputs of a film.
pub(crate) const OF_TRACK: &str = "figures,gif,frames";

/// What `--outputs` of a run takes.
pub(crate) fn words() -> PossibleValuesParser {
    let some = OUTPUTS.iter().map(|output| PossibleValue::new(output.word).help(output.about));
    let every = [
        PossibleValue::new(ALL).help("all of them, as far as they can be made here"),
        PossibleValue::new(NONE).help("curves and numbers only"),
    ];
    some.chain(every).collect::<Vec<_>>().into()
}

/// The help of `--outputs`.
pub(crate) fn help() -> String {
    let default: Vec<&str> =
        OUTPUTS.iter().filter(|output| output.by_default).map(|output| output.word).collect();
    format!(
        "What to write in addition to curves and numbers, separated by commas [default: {}]",
        default.join(",")
    )
}

/// What `--outputs` of a film takes.
pub(crate) fn of_track() -> PossibleValuesParser {
    let word = |output: Output| PossibleValue::new(output.word()).help(output.about());
    let none = PossibleValue::new(NONE).help("the curve and its numbers only");
    Output::ALL.map(word).into_iter().chain([none]).collect::<Vec<_>>().into()
}
