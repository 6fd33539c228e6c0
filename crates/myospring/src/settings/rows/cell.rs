//! `[cell]`.

use super::super::bounds::Bounds;
use super::super::calcium::CALCIUM_ENDINGS;
use super::super::models::{MODEL_ENDINGS, Models};
use super::super::problem::{Failure, Problem};
use super::super::run::Run;
use super::super::setting::{Named, Setting, ValueKind};
use super::super::tension::TENSION_ENDINGS;
use super::super::value::Value;
use super::super::words::{Word, Worded, choose, worded};
use crate::cell::coelho_2021;
use crate::cell::given_tension::TensionClock;
use crate::cell::solve::{CellMethod, SolverSettings};
use crate::cell_files::Choices;
use crate::mechanics::material::myofilament_material;
use crate::simulation::StretchFelt;
use crate::units::{self, Dimension};

worded! { StretchFelt {
    StretchFelt::Cell = "cell": "That of the whole cell: its length over its resting length.",
    StretchFelt::Triangle = "triangle":
        "That of each triangle along its fibre: a model for each, much slower. For cells whose \
         parts differ, by their content of myofibrils or their fibres.",
} }

/// What makes the tension of a model from a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FilamentChoice {
    Land,
    None,
}

impl FilamentChoice {
    fn of(myofilaments: bool) -> Self {
        if myofilaments { Self::Land } else { Self::None }
    }
}

worded! { FilamentChoice {
    FilamentChoice::Land = "land_2017":
        "The myofilaments of `land_2017`, driven by the model's calcium. Calcium does not depend on them: their binding of \
         calcium is only as the file has it.",
    FilamentChoice::None = "none": "None: the tension of the file, if it has one.",
} }

worded! { TensionClock {
    TensionClock::Stimulus = "stimulus":
        "From each stimulus: the table has one beat, which restarts with every stimulus.",
    TensionClock::Run = "run":
        "From the start of the run: the table has a whole recording, and stimuli only mark its beats.",
} }

worded! { CellMethod {
    CellMethod::RungeKutta4 = "runge-kutta-4":
        "Classical Runge-Kutta, order 4 for smooth equations; fixed steps.",
    CellMethod::ForwardEuler = "forward-euler": "Forward Euler, order 1; fixed steps.",
    CellMethod::StaggeredEuler = "staggered-euler":
        "Forward Euler that updates one block of the minimal model after the other, each with the \
         new values of the previous ones, order 1; fixed steps. The method of the authors of `coelho_2021`.",
    CellMethod::RushLarsen = "rush-larsen":
        "Gates by their exact solution at constant potential, the rest by forward Euler, order 1; \
         fixed steps. For models that declare their gates.",
    CellMethod::Adaptive = "adaptive":
        "Adaptive steps that are cut at the model's switches; for the minimal model \
         only.",
    CellMethod::Stiff = "stiff":
        "Implicit adaptive steps for stiff models whose equations do not \
         jump.",
} }

const PARAMETERS: &str = "cell.parameters";
const VARIABLES: &str = "cell.variables";

pub(super) const ROWS: &[Setting] = &[
    // Before the model: its file is read with them.
    Setting::new(
        VARIABLES,
        "Variables of a model from a file that the file does not tell: ROLE=VARIABLE, separated by commas, with the roles \
         potential, stimulus, calcium and tension and variables like component.variable; `myospring models FILE` lists them.",
        ValueKind::Written {
            bounds: None,
            numbers: false,
            example: "calcium=Ca.cai",
            get: named_variables,
            set: set_variables,
        },
    )
    .otherwise("found by annotation, name and unit")
    .option_saying(
        "--variables",
        "ROLE=VARIABLE,...",
        "Variables that a model from a file does not tell: potential, stimulus, calcium, tension",
    ),
    Setting::new(
        "cell.myofilaments",
        "What makes the tension of a model from a file: land_2017, driven by the model's calcium, or none, for the membrane \
         alone with the tension that the file may have.",
        ValueKind::Words {
            words: FilamentChoice::WORDS,
            get: |run| run.from_file.myofilaments.map(|chosen| FilamentChoice::of(chosen).word()),
            set: set_myofilaments,
        },
    )
    .otherwise("the file's own tension; land_2017 for a file without one that has calcium")
    .option_saying(
        "--myofilaments",
        "NAME",
        "Myofilaments of a model from a file: land_2017, driven by its calcium, or none",
    ),
    Setting::new(
        "cell.model",
        "Cell model; `myospring models` lists them. Or the file of a published model, relative to this file: CellML (.cellml) \
         or Myokit's (.mmt).",
        ValueKind::NameOrFile {
            endings: MODEL_ENDINGS,
            get: |run| Some(Models::name_of(&*run.cell).to_owned()),
            set: set_model,
        },
    )
    .option_saying(
        "--model",
        "NAME|FILE",
        "Cell model: a name that `myospring models` lists, or a CellML (.cellml) or Myokit (.mmt) file",
    ),
    Setting::new(
        "cell.calcium",
        "Calcium from a table (.csv), relative to this file, for a model with prescribed calcium: a column of times \
         from the stimulus and one of calcium, with their units in the header like time (ms),calcium (uM), or a ratio \
         with its calibration. The course restarts at each stimulus.",
        ValueKind::File {
            endings: CALCIUM_ENDINGS,
            words: &[],
            example: "calcium.csv",
            get: |run| run.calcium.clone(),
            set: |run, path| run.calcium = Some(path),
        },
    )
    .otherwise("the cell model's own; for land_2017, two exponentials")
    .option_saying(
        "--calcium",
        "FILE",
        "Calcium from a table (.csv) for --model land_2017: time (ms),calcium (uM), or a ratio with its calibration",
    ),
    Setting::quantity(
        "cell.calcium_dissociation",
        "For a ratio in that table: dissociation constant of the dye times the ratio of its fluorescence without to that with \
         calcium at the second wavelength, K in Ca = K (R - R_min) / (R_max - R).",
        Bounds::any(Dimension::Concentration, "0.8 uM").above(0.0).to(1000.0),
        |run| run.calibration.dissociation_um,
        |run, value| run.calibration.dissociation_um = Some(value),
    ),
    Setting::quantity(
        "cell.ratio_min",
        "The ratio without calcium, R_min.",
        Bounds::any(Dimension::Number, "0.4").from(0.0).to(1e6),
        |run| run.calibration.ratio_min,
        |run, value| run.calibration.ratio_min = Some(value),
    ),
    Setting::quantity(
        "cell.ratio_max",
        "The ratio with the dye saturated with calcium, R_max.",
        Bounds::any(Dimension::Number, "6").above(0.0).to(1e6),
        |run| run.calibration.ratio_max,
        |run, value| run.calibration.ratio_max = Some(value),
    ),
    Setting::new(
        "cell.tension",
        "Active tension from a table (.csv), relative to this file, for model = \"given_tension\": a column of times and \
         one of tension, with their units in the header like time (ms),tension (kPa), or tension over Young's modulus, \
         tension_over_stiffness. Between rows it is interpolated without overshoot.",
        ValueKind::File {
            endings: TENSION_ENDINGS,
            words: &[],
            example: "tension.csv",
            get: |run| run.tension.clone(),
            set: |run, path| run.tension = Some(path),
        },
    )
    .option_saying(
        "--tension",
        "FILE",
        "Active tension from a table (.csv) for --model given_tension: time (ms),tension (kPa), or \
         tension_over_stiffness",
    ),
    Setting::new(
        "cell.tension_clock",
        "From when the times of that table count.",
        ValueKind::Words {
            words: TensionClock::WORDS,
            get: |run| run.tension_clock.map(|clock| clock.word()),
            set: |run, word| choose(run.tension_clock.insert(TensionClock::default()), word),
        },
    )
    .option("--tension-clock", "NAME"),
    Setting::quantity(
        "cell.peak_tension",
        "Peak of the active tension of one default beat with the model's published parameters; \
         changed parameters make the cell stronger or weaker than that. Not for a model whose tension \
         is already in kPa, such as land_2017: scale its T_ref.",
        Bounds::any(Dimension::Pressure, "50 kPa").from(0.0).to(500.0),
        |run| run.has_relative_tension().then_some(run.peak_tension),
        |run, tension| run.peak_tension = tension,
    )
    .option_saying("--peak-tension", "TENSION", "Peak of the active tension"),
    Setting::new(
        "cell.stretch_felt",
        "Which stretch acts on a model that depends on stretch, such as land_2017.",
        ValueKind::Words {
            words: StretchFelt::WORDS,
            get: |run| Some(run.stretch_felt.word()),
            set: |run, word| choose(&mut run.stretch_felt, word),
        },
    ),
    Setting::new(
        "cell.authors_step",
        "Integrate the cell model as the authors of `coelho_2021` did (staggered Euler, 0.05 \
         ms); its peak tension is 4 % low, its onset 20 ms late. Not together with method or \
         step.",
        // A run is written back with the corresponding method and step.
        ValueKind::Flag { get: |_| None, set: set_authors_step },
    )
    .option_saying(
        "--authors-step",
        "",
        "Integrate the cell model as the authors of `coelho_2021` did",
    ),
    Setting::new(
        "cell.integrator",
        "Integration method of the cell model, with fixed or adaptive steps.",
        ValueKind::Words {
            words: CellMethod::WORDS,
            get: |run| Some(run.cell_settings().method.word()),
            set: |run, word| choose(&mut run.cell_settings_mut().method, word),
        },
    )
    .otherwise("that of the cell model: adaptive for the minimal models, stiff for ToR-ORd, else mostly runge-kutta-4"),
    Setting::quantity(
        "cell.step",
        "Largest time step of the cell model, for a method with fixed steps. If only the step is given, \
         minimal models take runge-kutta-4.",
        // Shorter steps need minutes for a beat without changing the result.
        Bounds::any(Dimension::Time, "0.005 ms").from(1e-5).to(1.0),
        |run| {
            let SolverSettings { method, step_ms, .. } = run.cell_settings();
            (!method.chooses_steps()).then_some(step_ms)
        },
        |run, step| run.cell_settings_mut().step_ms = step,
    )
    .otherwise("that of the method and the cell model: adaptive steps have none; 0.005 ms, for land_2017 0.05 ms, in a tissue 0.02 ms"),
    Setting::quantity(
        "cell.tolerance",
        "Largest error of a step relative to the size of each variable, for a method with adaptive \
         steps.",
        Bounds::any(Dimension::Number, "0.00001")
            .from(SolverSettings::TOLERANCES[0])
            .to(SolverSettings::TOLERANCES[1]),
        |run| {
            let SolverSettings { method, tolerance, .. } = run.cell_settings();
            method.chooses_steps().then_some(tolerance)
        },
        |run, tolerance| run.cell_settings_mut().tolerance = tolerance,
    )
    .otherwise("0.00001"),
    Setting::new(
        PARAMETERS,
        "Parameters of the cell model that differ from the published ones, by name: \"1.9 ms\", \
         or a plain number in the parameter's own unit; `myospring models NAME` lists them.",
        ValueKind::Named {
            example: ("tau_si", "1.9 ms"),
            get: |run| Some(changed_parameters(run)),
            set: set_parameters,
        },
    ),
];

fn set_model(run: &mut Run, name: &str) -> Result<(), Problem> {
    run.cell = run.models.model(name, &run.from_file)?;
    run.protocol.stimulus = run.cell.default_stimulus();
    run.numerics.cell = None;
    if run.cell.feels_stretch() && !run.has_relative_tension() {
        run.material = myofilament_material();
    }
    Ok(())
}

fn named_variables(run: &Run) -> Option<Value> {
    let named = &run.from_file.variables;
    (*named != Choices::default()).then(|| Value::Text(named.to_string()))
}

fn set_variables(run: &mut Run, value: &Value) -> Result<(), Problem> {
    let wrong = |reason| Problem::Text { key: VARIABLES, reason };
    run.from_file.variables = value.written().parse().map_err(wrong)?;
    Ok(())
}

fn set_myofilaments(run: &mut Run, word: &str) -> Option<()> {
    let mut choice = FilamentChoice::None;
    choose(&mut choice, word)?;
    run.from_file.myofilaments = Some(choice == FilamentChoice::Land);
    Some(())
}

fn set_authors_step(run: &mut Run, authors: bool) {
    if !authors {
        return;
    }
    run.numerics.cell = Some(coelho_2021::authors_step());
    if let Some((cell, start_ms)) = run.cell.in_authors_program() {
        run.cell = cell;
        run.protocol.start_ms = start_ms;
    }
}

/// Parameters that differ from the published ones, each in its own unit.
fn changed_parameters(run: &Run) -> Named {
    let cell = &run.cell;
    let Ok(published) = run.published_cell() else { return Named::new() };
    let rows = cell.parameters().rows().iter();
    rows.filter(|row| published.parameters().get(&row.name) != Some(row.value))
        .map(|row| (row.name.to_string(), Value::Number(row.value)))
        .collect()
}

fn set_parameters(run: &mut Run, values: &Named) -> Result<(), Failure> {
    let mut parameters = run.cell.parameters().clone();
    for (name, value) in values {
        let key = format!("{PARAMETERS}.{name}");
        let Some(row) = parameters.rows().iter().find(|row| row.name == *name) else {
            let known = parameters.rows().iter().map(|row| &*row.name);
            return Err((key, Problem::unknown_key(name, PARAMETERS, known)));
        };
        let set = in_unit(&key, value, &row.unit)
            .and_then(|number| parameters.set(name, number).map_err(Problem::Parameter));
        set.map_err(|problem| (key, problem))?;
    }
    run.cell = run
        .cell
        .with_parameters(parameters)
        .map_err(|error| (PARAMETERS.to_owned(), Problem::Parameters(error)))?;
    Ok(())
}

/// A value in the model's own unit: a bare number, or text with a unit of the same kind.
pub(super) fn in_unit(key: &str, value: &Value, unit: &str) -> Result<f64, Problem> {
    if let Value::Number(number) = value {
        return Ok(*number);
    }
    let text = value.written();
    let Some(dimension) = Dimension::of_unit(unit) else {
        // A unit that only the model knows must be written exactly as there.
        let number = text.strip_suffix(unit).and_then(|number| number.trim().parse().ok());
        return number.ok_or_else(|| Problem::Kind {
            key: key.to_owned(),
            found: value.described(),
            wanted: format!("a plain number, or a number in {unit} like \"1.5 {unit}\","),
        });
    };
    // The row's unit is the internal one of its dimension.
    units::parse(&text, dimension).map_err(|cause| {
        let example = units::format(1.5, dimension);
        Problem::Unit { key: key.to_owned(), cause, example }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_methods_are_written_as_the_cell_models_name_them() {
        for method in CellMethod::ALL {
            assert_eq!(method.word(), method.name());
        }
    }

    #[test]
    fn a_parameter_in_a_unit_of_its_own_is_read_in_that_unit_or_refused() {
        let read = |text: &str, unit| in_unit("cell.parameters.g", &Value::from(text), unit);
        assert_eq!(read("1.5 mol/l", "mol/l").unwrap(), 1.5);
        assert_eq!(in_unit("g", &Value::Number(1.5), "mol/l").unwrap(), 1.5);
        for wrong in ["1.5 ms", "1.5 %", "1.5", "mol/l", "1.5 mol"] {
            let problem = read(wrong, "mol/l").unwrap_err().to_string();
            assert!(problem.contains("cell.parameters.g"), "{wrong}: {problem}");
            assert!(problem.contains("mol/l"), "{wrong}: {problem}");
        }
        assert_eq!(read("0.0019 s", "ms").unwrap(), 1.9);
        assert_eq!(read("0.5 mM", "uM").unwrap(), 500.0);
        assert_eq!(read("1.5 nS/pF", "mS/uF").unwrap(), 1.5);
        assert_eq!(read("50 %", "").unwrap(), 0.5);
    }
}
