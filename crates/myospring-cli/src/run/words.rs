//! A run in words: the table on the terminal, and the work that it took.

use crate::table::{aligned, number};
use myospring::analysis::Metric;
use myospring::analysis::bands::band;
use myospring::analysis::beat::Beat;
use myospring::analysis::summary::Summary;
use myospring::analysis::wave::CONDUCTION_VELOCITY;
use myospring::experiment::run::{RunNumbers, WrittenOutputs};
use myospring::settings::Run;
use myospring::simulation::Effort;
use std::fmt::Write as _;
use std::path::Path;

/// Shown if the cell becomes longer instead of shorter.
const LENGTHENING: &str = "peak_lengthening";

/// Rows of the table after a run: metric and its name for people.
pub(crate) const ROWS: [(&str, &str); 35] = [
    ("peak_tension", "peak tension"),
    ("time_to_peak_tension", "time to peak tension, from stimulus"),
    ("resting_length", "resting length"),
    ("peak_shortening", "peak shortening"),
    (LENGTHENING, "peak lengthening"),
    ("time_to_peak_from_stimulus", "time to peak shortening, from stimulus"),
    ("lag_of_shortening", "lag of shortening behind tension"),
    ("maximum_shortening_rate", "largest shortening rate"),
    ("shortening_rate_over_peak", "  over peak shortening"),
    ("maximum_relengthening_rate", "largest relengthening rate"),
    ("relaxation_time_50", "peak to 50 % relengthened"),
    ("relaxation_time_90", "peak to 90 % relengthened"),
    ("width_change_at_peak", "width change at peak"),
    ("isovolumic_width_change", "  that would keep the volume"),
    ("area_change_at_peak", "projected area change at peak"),
    ("peak_thickening", "thickening, largest"),
    ("volume_change", "volume change, largest"),
    ("top_shortening", "shortening of the upper face, largest"),
    ("bottom_shortening", "  of the lower face"),
    ("peak_end_force", "peak force at the ends"),
    ("time_to_end_systole", "time to end of systole, from stimulus"),
    ("work_on_load", "work on the load"),
    ("peak_traction_force", "peak force on the gel, all directions"),
    ("peak_axial_force", "  of half the cell, along it"),
    ("time_to_peak_traction_force", "time to peak force on the gel, from stimulus"),
    ("peak_contractile_moment", "peak contractile moment"),
    ("peak_gel_energy", "peak energy of the gel"),
    ("action_potential_duration_90", "APD90"),
    ("conduction_velocity", "conduction velocity"),
    ("activation_time", "time until the last place is activated, from stimulus"),
    ("activated_part", "part of the tissue that is activated"),
    ("local_action_potential_duration_90", "APD90, mean over the places"),
    ("repolarisation_spread", "first to last repolarisation"),
    ("rotation_period", "period of a spiral wave"),
    ("tip_drift", "  drift of its tip"),
];

/// Rows only of an S2.
const OF_S2: [(&str, &str); 6] = [
    ("coupling_interval", "coupling interval of S2"),
    ("diastolic_interval", "diastolic interval before S2"),
    ("relative_peak_tension", "peak tension of S2, of that of S1"),
    ("relative_peak_shortening", "peak shortening of S2, of that of S1"),
    ("rotation_period", "period of a spiral wave after S2"),
    ("tip_drift", "  drift of its tip"),
];

/// Optional columns of the table after a run.
#[derive(Clone, Copy)]
struct Columns {
    /// The standard deviation of several beats.
    spread: bool,
    /// An extra stimulus.
    s2: bool,
}

impl Columns {
    /// A row: quantity, value, standard deviation, S2, unit, measured.
    fn row(self, cells: [String; 6]) -> Vec<String> {
        let there = [true, true, self.spread, self.s2, true, true];
        cells.into_iter().zip(there).filter_map(|(cell, there)| there.then_some(cell)).collect()
    }
}

/// The table after a run; for several beats mean and standard deviation, and the beat of an extra
/// stimulus.
pub(super) fn for_people(name: &str, run: &Run, numbers: &RunNumbers<'_>) -> String {
    let summary = numbers.summary;
    let mut text = title(name, run, summary);
    let Some(first) = summary.usual() else {
        text.push_str("no stimulus, so nothing to measure\n");
        return text;
    };
    let s2 = summary.s2();
    let columns = Columns { spread: !summary.beat_to_beat.is_empty(), s2: s2.is_some() };
    let is_of_tissue =
        |beat: &Beat| beat.metrics().any(|metric| metric.name == CONDUCTION_VELOCITY);
    let loaded =
        summary.beats.first().is_some_and(|beat| !beat.load.is_empty() || is_of_tissue(beat));
    let band_column = if loaded { "" } else { "measured*" };
    let header = ["quantity", "value", "+- sd", "S2", "unit", band_column].map(str::to_owned);
    let mut rows = vec![columns.row(header)];
    let of_beats = ROWS.iter().filter_map(|row| of_beats(row, first, summary, loaded));
    rows.extend(of_beats.map(|cells| columns.row(cells)));
    let of_s2 = OF_S2.iter().filter_map(|(metric, words)| {
        let beat = s2?;
        let Metric { value, unit, .. } = beat.s2.iter().find(|row| row.name == *metric)?;
        // A cell with prescribed calcium has no action potential.
        if value.is_none() && beat.captured.is_none() {
            return None;
        }
        Some([
            (*words).to_owned(),
            String::new(),
            String::new(),
            or_dash(*value),
            (*unit).to_owned(),
            String::new(),
        ])
    });
    rows.extend(of_s2.map(|cells| columns.row(cells)));
    let fibres = numbers.fibres.as_ref();
    if let Some(length) = fibres.and_then(|report| report.seen?.sarcomere_um) {
        let words = "sarcomere length at rest, median".to_owned();
        let none = String::new;
        rows.push(columns.row([words, number(length), none(), none(), "um".to_owned(), none()]));
    }
    let right = 1 + usize::from(columns.spread) + usize::from(columns.s2);
    text.push_str(&aligned(&rows, &(1..=right).collect::<Vec<_>>()));
    if first.load.is_empty() {
        text.push_str(
            "* in unloaded adult ventricular myocytes; inside or outside does not make a cell right or wrong\n",
        );
    }
    if let Some(fibres) = fibres {
        let _ = writeln!(text, "fibres: {fibres}");
    }
    text
}

/// The headline: model, beats and tension.
fn title(name: &str, run: &Run, summary: &Summary) -> String {
    let title = if run.title.is_empty() { name } else { &run.title };
    let beats = summary.captured();
    let mut of = vec![run.cell.name().to_owned(), run.strength()];
    // A model whose tension is in kPa has its own.
    of.dedup();
    let s = if beats == 1 { "" } else { "s" };
    let of_stimuli = match summary.rhythm.not_captured.len() {
        0 => String::new(),
        missed => {
            let stimuli = summary.rhythm.stimuli;
            let us = if stimuli == 1 { "us" } else { "i" };
            format!(" after {stimuli} stimul{us} ({missed} not captured)")
        }
    };
    let and_s2 = match summary.s2() {
        Some(Beat { captured: Some(false), .. }) => " and S2 (no capture)",
        Some(_) => " and S2",
        None => "",
    };
    let cut = if summary.cut_short { " (the last is cut short and is not measured)" } else { "" };
    format!("{title}: {beats} beat{s}{of_stimuli}{and_s2} of {}{cut}\n\n", of.join(" at "))
}

/// The row of a metric, if the first beat has it: for several beats mean and standard deviation.
fn of_beats(
    (metric, words): &(&str, &str),
    first: &Beat,
    summary: &Summary,
    loaded: bool,
) -> Option<[String; 6]> {
    let Metric { value, missing, unit, .. } = first.metrics().find(|m| m.name == *metric)?;
    let shorter = first.value("peak_shortening").unwrap_or(0.0);
    if *metric == LENGTHENING && value.is_none_or(|longer| longer <= shorter) {
        return None;
    }
    let over_beats = summary.beat_to_beat.iter().find(|spread| spread.name == *metric);
    let value = over_beats.map(|spread| spread.mean).or(*value);
    // The bands are those of unloaded cells.
    let reference = band(metric).filter(|_| !loaded);
    let measured = match (value, reference) {
        (Some(value), Some(band)) => {
            let ends = format!("{} to {}", band.low, band.high);
            format!("{ends:<12}{}", band.place(value).words())
        }
        (Some(_), None) => String::new(),
        (None, _) => missing.map_or_else(String::new, |why| format!("none: {}", why.words())),
    };
    Some([
        (*words).to_owned(),
        or_dash(value),
        over_beats.map_or_else(String::new, |s| number(s.standard_deviation)),
        summary.s2().map_or_else(String::new, |beat| or_dash(beat.value(metric))),
        (*unit).to_owned(),
        measured,
    ])
}

fn or_dash(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), number)
}

/// The work that the run took, in a line.
pub(super) fn in_words(effort: &Effort) -> String {
    match *effort {
        Effort::OwnStepper { time_step_ms, steps, .. } => {
            format!("own stepper: {steps} steps of {time_step_ms:.4} ms")
        }
        Effort::Verlet { time_step_ms, stability_limit_ms, steps, lag_pct, .. } => {
            let lag = lag_pct.map_or_else(String::new, |lag| {
                format!("; it lags its equilibria by an estimated {lag:.1} % of the peak")
            });
            format!(
                "Verlet: {steps} steps of {time_step_ms:.4} ms, stable up to {stability_limit_ms:.4} ms{lag}"
            )
        }
        Effort::QuasiStatic {
            load_steps,
            newton_iterations,
            factorisations,
            interpolation_error_um,
            delay_ms,
        } => format!(
            "quasi-static: {load_steps} load steps, {newton_iterations} Newton iterations, \
             {factorisations} factorisations\n\
             positions to {interpolation_error_um:.1e} um; a run in time with this damping would lag by \
             {delay_ms:.2} ms"
        ),
        Effort::Field { equilibria, newton_iterations, factorisations } => format!(
            "quasi-static, tension by place: {equilibria} equilibria, {newton_iterations} Newton iterations, \
             {factorisations} factorisations"
        ),
    }
}

/// Where the results are, how large the outputs, and which file to open.
pub(super) fn results(target: &Path, seconds: f64, written: &WrittenOutputs) -> String {
    let mut text = format!("\nresults in {} ({seconds:.2} s)", target.display());
    let sizes = written.sizes();
    if !sizes.is_empty() {
        let _ = write!(text, ": curves, numbers, {}", sizes.join(", "));
    }
    if let Some(file) = written.look() {
        let _ = write!(text, "\nopen {}", target.join(file).display());
    }
    text
}
