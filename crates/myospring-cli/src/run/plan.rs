//! What a run would do.

use super::record::resolved;
use crate::args::RunArgs;
use crate::failure::Failure;
use crate::outputs::Output;
use crate::print;
use crate::table::aligned;
use myospring::experiment::Inputs;
use myospring::mesh::quality::MeshReport;
use myospring::output::json;
use myospring::settings::{FibreReport, Run};
use myospring::simulation::{Effort, Ready, Simulation};
use serde::Serialize;
use std::path::Path;
use std::time::Instant;

/// The plan as JSON.
#[derive(Serialize)]
struct Plan<'a> {
    name: &'a str,
    model: &'a str,
    results: &'a Path,
    #[serde(flatten)]
    effort: Effort,
    #[serde(skip_serializing_if = "Option::is_none")]
    spring_updates: Option<f64>,
    estimated_s: f64,
    run_file: String,
    mesh: &'a MeshReport,
    #[serde(skip_serializing_if = "Option::is_none")]
    fibres: Option<&'a FibreReport>,
    outputs: Vec<&'static str>,
}

/// Prints the plan of a run; its outputs are those that were chosen.
#[allow(clippy::too_many_arguments, reason = "the parts of a plan, each once")]
pub(super) fn plan(
    args: &RunArgs,
    outputs: &[&Output],
    run: &Run,
    simulation: &Simulation,
    prepared: &Ready,
    report: &MeshReport,
    fibres: Option<&FibreReport>,
    target: &Path,
) -> Result<(), Failure> {
    // The first interval of output tells how long the rest of a motion will take; a path is solved.
    let start = Instant::now();
    let first = prepared.run(|progress| progress.time <= 0.0);
    let intervals = match prepared {
        Ready::InTime(_) | Ready::FromRestToRest(_) => {
            run.duration / run.numerics.output_interval.max(1e-9)
        }
        Ready::AlongPath(_) => 1.0,
    };
    let estimate = start.elapsed().as_secs_f64() * intervals;
    let mut effort = first.effort;
    let mut spring_updates = None;
    if let (Ready::InTime(prepared), Effort::Verlet { steps, .. }) = (prepared, &mut effort) {
        let exchanges = (run.duration / run.numerics.exchange_interval).round();
        let whole = exchanges * prepared.steps_per_exchange as f64;
        *steps = whole as u64;
        spring_updates = Some(whole * simulation.mesh.springs.len() as f64);
    }
    if let Ready::AlongPath(path) = prepared
        && let Some(end) = &path.end
    {
        print::warn(&format!("the run will stop early: {end}"));
    }
    let plan = Plan {
        name: run.shape.name(),
        model: run.cell.name(),
        results: target,
        effort,
        spring_updates,
        estimated_s: estimate,
        run_file: resolved(
            run,
            // Nothing is written: files are named as they were given.
            (&Inputs::default(), ""),
            simulation,
            report.spacing_um,
            effort.time_step(),
        ),
        mesh: report,
        fibres,
        outputs: outputs.iter().map(|output| output.word).collect(),
    };
    if args.output.json {
        print::out(&json::pretty(&plan)?)?;
        return Ok(());
    }
    let mut rows = vec![
        ("cell model", plan.model.to_owned()),
        ("beats", beats_in_words(run)),
        ("peak tension", run.strength()),
    ];
    // A model whose tension is in kPa has its own.
    rows.retain(|(name, value)| *name != "peak tension" || value != plan.model);
    rows.extend(fibres.map(|fibres| ("fibres", fibres.to_string())));
    match effort {
        Effort::Verlet { time_step_ms, stability_limit_ms, steps } => rows.extend([
            ("integrator", "Verlet, in time".to_owned()),
            ("time step", format!("{time_step_ms:.4} ms")),
            ("stability limit", format!("{stability_limit_ms:.4} ms")),
            ("steps", steps.to_string()),
        ]),
        Effort::QuasiStatic {
            load_steps,
            newton_iterations,
            interpolation_error_um,
            delay_ms,
            ..
        } => rows.extend([
            ("integrator", "quasi-static, along the path of equilibria".to_owned()),
            ("load steps", format!("{load_steps}, {newton_iterations} Newton iterations")),
            ("error of positions", format!("{interpolation_error_um:.1e} um")),
            ("lag of a motion", format!("{delay_ms:.2} ms")),
        ]),
        Effort::Field { .. } => {
            rows.push(("integrator", "quasi-static, tension by place".to_owned()));
        }
        Effort::OwnStepper { time_step_ms, .. } => rows.extend([
            ("integrator", "own stepper, in time".to_owned()),
            ("time step", format!("{time_step_ms:.4} ms")),
        ]),
    }
    if let Some(updates) = spring_updates {
        rows.push(("spring updates", format!("{updates:.2e}")));
    }
    rows.push(("estimated time", format!("{:.1} s", plan.estimated_s)));
    let written = ["curves and numbers"].into_iter().chain(plan.outputs.iter().copied());
    rows.push(("would be written", written.collect::<Vec<_>>().join(", ")));
    rows.push(("results would go to", target.display().to_string()));
    let rows: Vec<Vec<String>> =
        rows.into_iter().map(|(name, value)| vec![name.to_owned(), value]).collect();
    // Warnings have gone to stderr.
    let mesh = report.to_string();
    let mesh: Vec<&str> = mesh.lines().filter(|line| !line.starts_with("warning")).collect();
    print::out(&format!("Mesh\n{}\n\nPlan\n{}", mesh.join("\n"), aligned(&rows, &[])))?;
    print::out("nothing was written (--dry-run)")?;
    Ok(())
}

fn beats_in_words(run: &Run) -> String {
    let s2 = run.protocol.s2_interval_ms;
    let s2 = s2.map_or_else(String::new, |interval| format!(" and S2 {interval} ms later,"));
    format!("{}{s2} in {} ms", run.protocol.beats, run.duration)
}
