//! What a study found, as people read it.

use crate::table::{aligned, number};
use myospring::experiment::study::Found;
use myospring::study::parameters::{Acceptance, ParameterStudy, Ranked, Rejected};
use myospring::study::sensitivity::Index;
use std::fmt::Write as _;

/// Rows of a table, for each metric.
const SHOWN: usize = 10;
/// Part of the members below which advice is printed.
const FEW: f64 = 0.02;

fn short(key: &str) -> &str {
    key.rsplit_once('.').map_or(key, |(_, name)| name)
}

fn words(metric: &str) -> String {
    metric.replace('_', " ")
}

pub(super) fn for_people(study: &ParameterStudy, outcome: &Found<'_>) -> String {
    let Acceptance { beat, kept, failed, not_captured, ref bands } = outcome.acceptance;
    let mut text = format!("{} members: {beat} beat", outcome.members);
    if failed > 0 {
        let _ = write!(text, ", {failed} failed (the column reason says why)");
    }
    if not_captured > 0 {
        let _ = write!(
            text,
            ", {not_captured} with stimuli that raised no action potential (the column reason says which)"
        );
    }
    if !study.keep.is_empty() {
        let share = 100.0 * kept as f64 / outcome.members.max(1) as f64;
        let _ = write!(text, ", {kept} kept ({share:.1} % of all)");
    }
    text.push('\n');
    if !bands.is_empty() {
        text.push_str(&of_bands(bands));
        let few = (kept as f64) < FEW * beat as f64;
        if few && let Some(worst) = bands.iter().max_by_key(|band| band.all()) {
            text.push_str(&advice(worst, beat));
        }
    }
    for one in &outcome.sensitivity {
        let _ = writeln!(text, "\n{}", words(&one.metric));
        let unit = |what: &str| format!("{what} ({})", one.unit);
        let mut rows = vec![match one.parameters.first() {
            Some(Ranked::Morris { .. }) => {
                let sizes = ["mean size of effect", "mean", "spread"].map(unit);
                ["parameter".to_owned()].into_iter().chain(sizes).collect()
            }
            _ => ["parameter", "alone", "with all interactions"].map(str::to_owned).to_vec(),
        }];
        let with = |index: Index| format!("{:.3} +- {:.3}", index.value, index.confidence);
        rows.extend(one.parameters.iter().take(SHOWN).map(|ranked| {
            let name = short(ranked.parameter()).to_owned();
            match ranked {
                Ranked::Sobol { first, total, .. } => vec![name, with(*first), with(*total)],
                Ranked::Morris { mean_size, mean, spread, .. } => {
                    vec![name, with(*mean_size), number(*mean), number(*spread)]
                }
            }
        }));
        if rows.len() > 1 {
            text.push_str(&aligned(&rows, &[1, 2, 3]));
        }
        if one.left_out > 0 {
            let all = one.used + one.left_out;
            let _ = writeln!(
                text,
                "{} of {all} groups of members are left out, since one failed or has no such metric",
                one.left_out
            );
        }
    }
    text
}

/// What each band rejects.
fn of_bands(bands: &[Rejected]) -> String {
    let names = ["metric", "kept from", "to", "below", "above", "rejected by this alone"];
    let mut rows = vec![names.map(str::to_owned).to_vec()];
    for band in bands {
        let [low, high] = band.band.map(number);
        let counts = [band.below, band.above, band.alone].map(|count| count.to_string());
        let name = match band.unit {
            "" => words(&band.metric),
            unit => format!("{} ({unit})", words(&band.metric)),
        };
        rows.push([name, low, high].into_iter().chain(counts).collect());
    }
    let mut text = format!("\n{}", aligned(&rows, &[1, 2, 3, 4, 5]));
    for band in bands.iter().filter(|band| band.without > 0) {
        let _ = writeln!(text, "{} members have no {}", band.without, words(&band.metric));
    }
    text
}

/// Advice if hardly any member is kept.
fn advice(worst: &Rejected, beat: usize) -> String {
    let name = words(&worst.metric);
    let share = 100.0 * worst.all() as f64 / beat.max(1) as f64;
    let mut text =
        format!("\nhardly any member is kept: the band of {name} rejects {share:.1} % of them");
    if let Some([low, median, high]) = worst.found {
        let [low, median, high] = [low, median, high].map(number);
        let _ = write!(
            text,
            "; their median is {median} {}, and nine of ten are {low} to {high}",
            worst.unit
        );
    }
    text.push_str(
        "\nmove the values in [run] towards the bands, narrow the distributions, or widen [keep]\n",
    );
    text
}
