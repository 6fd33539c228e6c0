//! `[stimulus]`; missing values come from the cell model.

use super::super::bounds::{Bounds, Whole};
use super::super::problem::Problem;
use super::super::run::Run;
use super::super::setting::{Setting, ValueKind};
use super::super::value::Value;
use super::super::words::{Word, Worded, worded};
use super::cell::in_unit;
use crate::cell::pacing::Stimulus;
use crate::units::Dimension;
use std::borrow::Cow;

/// How a stimulus acts.
#[derive(Clone, Copy)]
enum StimulusKind {
    Jump,
    Pulse,
}

worded! { StimulusKind {
    StimulusKind::Jump = "jump": "An instantaneous jump of the potential variable.",
    StimulusKind::Pulse = "pulse": "A constant current for some time.",
} }

const AMPLITUDE: &str = "stimulus.amplitude";
const JUMP: Bounds = Bounds::any(Dimension::Number, "0.325").from(-10.0).to(10.0);
const PULSE: Bounds = Bounds::any(Dimension::Rate, "0.5 1/ms").from(-100.0).to(100.0);

pub(super) const ROWS: &[Setting] = &[
    Setting::new(
        "stimulus.kind",
        "A jump of the potential variable, or a pulse of current.",
        ValueKind::Words {
            words: StimulusKind::WORDS,
            get: |run| moves_something(run).then(|| kind(run).word()),
            set: |run, word| {
                // The rules of run files require the size if the model has no default of this kind.
                match (StimulusKind::of_word(word)?, run.protocol.stimulus) {
                    (StimulusKind::Jump, Stimulus::Pulse { .. }) => {
                        run.protocol.stimulus = Stimulus::Jump { amplitude: 0.0 };
                    }
                    (StimulusKind::Pulse, Stimulus::Jump { .. }) => {
                        run.protocol.stimulus =
                            Stimulus::Pulse { amplitude: 0.0, duration_ms: 0.0 };
                    }
                    _ => {}
                }
                Some(())
            },
        },
    )
    .otherwise("the cell model's own"),
    Setting::new(
        AMPLITUDE,
        "Size: a dimensionless number for a jump of u; for a pulse a rate (\"0.5 1/ms\"), or the current of a model that has \
         one, in its unit (\"53 A/F\"). Positive values depolarise.",
        ValueKind::Written {
            bounds: Some(JUMP),
            numbers: true,
            example: JUMP.example,
            get: |run| {
                moves_something(run).then(|| match run.protocol.stimulus {
                    Stimulus::Jump { amplitude } => JUMP.write(amplitude),
                    Stimulus::Pulse { amplitude, .. } => match own_unit(run) {
                        None => PULSE.write(amplitude),
                        Some(unit) => Value::Text(format!("{amplitude} {unit}")),
                    },
                })
            },
            set: set_amplitude,
        },
    )
    .otherwise("the cell model's own"),
    Setting::quantity(
        "stimulus.duration",
        "Duration of a pulse; not for a jump.",
        Bounds::any(Dimension::Time, "1 ms").above(0.0).to(1000.0),
        |run| match run.protocol.stimulus {
            Stimulus::Jump { .. } => None,
            Stimulus::Pulse { duration_ms, .. } => Some(duration_ms),
        },
        |run, duration| {
            if let Stimulus::Pulse { duration_ms, .. } = &mut run.protocol.stimulus {
                *duration_ms = duration;
            }
        },
    ),
    Setting::quantity(
        "stimulus.start",
        "Time of the first stimulus.",
        Bounds::any(Dimension::Time, "50 ms").from(0.0).to(1e5),
        |run| Some(run.protocol.start_ms),
        |run, start| run.protocol.start_ms = start,
    ),
    Setting::new(
        "stimulus.beats",
        "Number of stimuli; 0 leaves the cell at rest.",
        ValueKind::Whole {
            bounds: Whole { minimum: 0, maximum: 10_000, example: 3 },
            get: |run| Some(run.protocol.beats),
            set: |run, beats| run.protocol.beats = beats,
        },
    )
    .option("--beats", "N"),
    Setting::quantity(
        "stimulus.cycle_length",
        "Time from one stimulus to the next.",
        Bounds::any(Dimension::Time, "1000 ms").above(0.0).to(1e5),
        |run| Some(run.protocol.cycle_length_ms),
        |run, cycle| run.protocol.cycle_length_ms = cycle,
    )
    .option("--cycle-length", "TIME"),
    Setting::quantity(
        "stimulus.s2_interval",
        "Coupling interval of one extra stimulus, S2: its time after the last of the train, S1. Its beat is measured from \
         the rest before that S1; it has no metrics if it raises no action potential, and does not count in means over beats.",
        Bounds::any(Dimension::Time, "350 ms").above(0.0).to(1e5),
        |run| run.protocol.s2_interval_ms,
        |run, interval| run.protocol.s2_interval_ms = Some(interval),
    )
    .otherwise("no extra stimulus")
    .option_saying(
        "--s2-interval",
        "TIME",
        "Coupling interval of one extra stimulus after the last of the train: S1-S2 protocol",
    ),
    Setting::quantity(
        "stimulus.steady_state",
        "Pace the cell model alone at this cycle length before the run, until no state changes by more than this over ten \
         beats, relative to its size within a beat; the run's first beat is then the next one of that train.",
        Bounds::any(Dimension::Number, "0.001").from(1e-6).to(0.1),
        |run| run.steady_state,
        |run, tolerance| run.steady_state = Some(tolerance),
    )
    .otherwise("the run starts from the model's initial state")
    .option_saying(
        "--steady-state",
        "TOLERANCE",
        "Pace the cell model before the run until no state changes by more than this over ten beats (\"0.1 %\")",
    ),
    Setting::new(
        "stimulus.steady_state_cache",
        "Folder in which steady states are stored for other runs with the same model, parameters and pacing; empty for none.",
        ValueKind::Text {
            get: |run| Some(run.steady_state_cache.clone()),
            set: |run, folder| {
                folder.clone_into(&mut run.steady_state_cache);
                Ok(())
            },
        },
    )
    .option_saying(
        "--steady-state-cache",
        "DIR",
        "Folder in which steady states are stored for other runs",
    ),
    Setting::quantity(
        "stimulus.wave_speed",
        "Speed at which each stimulus, and its calcium release, travels along the cell from the end where the \
         long axis starts: a cell model for each triangle, much slower. Beats are measured from the start of the wave.",
        Bounds::any(Dimension::Speed, "0.1 um/ms").from(1e-3).to(1e6),
        |run| run.wave_speed,
        |run, speed| run.wave_speed = Some(speed),
    )
    .otherwise("everywhere at once")
    .option_saying(
        "--wave-speed",
        "SPEED",
        "Speed at which each stimulus, and its calcium, travels along the cell",
    ),
];

/// With prescribed calcium, a stimulus only starts its course.
fn moves_something(run: &Run) -> bool {
    !run.cell.stimulation().moves.is_empty()
}

fn kind(run: &Run) -> StimulusKind {
    match run.protocol.stimulus {
        Stimulus::Jump { .. } => StimulusKind::Jump,
        Stimulus::Pulse { .. } => StimulusKind::Pulse,
    }
}

fn set_amplitude(run: &mut Run, value: &Value) -> Result<(), Problem> {
    let unit = own_unit(run);
    match &mut run.protocol.stimulus {
        Stimulus::Jump { amplitude } => *amplitude = JUMP.read(AMPLITUDE, value)?,
        Stimulus::Pulse { amplitude, .. } => {
            *amplitude = match unit {
                None => PULSE.read(AMPLITUDE, value)?,
                Some(unit) => in_unit(AMPLITUDE, value, &unit)?,
            }
        }
    }
    Ok(())
}

/// The unit of the stimulus current of a model whose pulses are no rates.
fn own_unit(run: &Run) -> Option<Cow<'static, str>> {
    let unit = run.cell.stimulation().current_unit;
    (Dimension::of_unit(&unit) != Some(Dimension::Rate)).then_some(unit)
}
