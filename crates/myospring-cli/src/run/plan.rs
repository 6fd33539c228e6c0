//! What a run would do.

use crate::args::RunArgs;
use crate::failure::Failure;
use crate::print;
use crate::table::aligned;
use myospring::experiment::Inputs;
use myospring::experiment::run::{self, Output, PreparedRun, resolved};
use myospring::mesh::quality::MeshReport;
use myospring::output::json;
use myospring::settings::{FibreReport, Run};
use myospring::simulation::Effort;
use serde::Serialize;
use std::path::Path;

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

/// Prints the plan of a run; with the chosen outputs.
pub(super) fn plan(
    args: &RunArgs,
    outputs: &[&Output],
    prepared: &PreparedRun,
    target: &Path,
) -> Result<(), Failure> {
    let (run, made) = (&prepared.run, &prepared.made);
    let (simulation, report) = (&made.simulation, &made.report);
    let of_picture = made.fibres_of_picture();
    let fibres = of_picture.as_ref();
    let run::RunPlan { effort, spring_updates, estimated_s } = prepared.plan();
    if let Some(end) = prepared.ready.end() {
        print::warn(&format!("the run will stop early: {end}"));
    }
    let plan = Plan {
        name: run.shape.name(),
        model: run.cell.name(),
        results: target,
        effort,
        spring_updates,
        estimated_s,
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
    let written = ["curves and numbers"].into_iter().chain(plan.outputs.iter().copied());
    let mut rows = rows(&plan, run);
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

/// The rows of a plan: name and value.
fn rows(plan: &Plan<'_>, run: &Run) -> Vec<(&'static str, String)> {
    let mut rows = vec![
        ("cell model", plan.model.to_owned()),
        ("beats", beats_in_words(run)),
        ("peak tension", run.strength()),
    ];
    // A model whose tension is in kPa has its own.
    rows.retain(|(name, value)| *name != "peak tension" || value != plan.model);
    rows.extend(plan.fibres.map(|fibres| ("fibres", fibres.to_string())));
    match plan.effort {
        Effort::Verlet { time_step_ms, stability_limit_ms, steps, .. } => rows.extend([
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
            ("lag of a run in time", format!("{delay_ms:.2} ms")),
        ]),
        Effort::Field { .. } => {
            rows.push(("integrator", "quasi-static, tension by place".to_owned()));
        }
        Effort::OwnStepper { time_step_ms, .. } => rows.extend([
            ("integrator", "own stepper, in time".to_owned()),
            ("time step", format!("{time_step_ms:.4} ms")),
        ]),
    }
    if let Some(updates) = plan.spring_updates {
        rows.push(("spring updates", format!("{updates:.2e}")));
    }
    rows.push(("estimated time", format!("{:.1} s", plan.estimated_s)));
    rows
}

fn beats_in_words(run: &Run) -> String {
    let s2 = run.protocol.s2_interval_ms;
    let s2 = s2.map_or_else(String::new, |interval| format!(" and S2 {interval} ms later,"));
    format!("{}{s2} in {} ms", run.protocol.beats, run.duration)
}
