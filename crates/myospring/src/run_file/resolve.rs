//! Every value checked, every default filled in.

use super::bounds::{self, Setting};
use super::check::nearest;
use super::error::Problem;
use super::shape::{Shape, Source};
use super::{
    CellTable, Fibre, IntegratorName, MaterialTable, MechanicsTable, NumericsTable, Run, RunFile,
    SegmentationTable, ShapeTable, StimulusKind, StimulusTable, SupportName, picture,
};
use crate::cell::pacing::{Protocol, Stimulus};
use crate::cell::solve::Settings;
use crate::cell::{self, CellModel, coelho_2021};
use crate::integrate::Method;
use crate::integrate::verlet::Integrator;
use crate::mechanics::active::ActiveLaw;
use crate::mechanics::area::AreaLaw;
use crate::mechanics::material::{Material, Stiffness, default_material};
use crate::mechanics::support::SupportKind;
use crate::mesh::built_in;
use crate::microscopy::fibres::{FibreSettings, Stain};
use crate::parameter::ParameterError;
use crate::simulation::{Numerics, TensionScale};
use crate::units::{self, Dimension};
use std::sync::Arc;

pub(super) type Checked<T> = Result<T, (String, Problem)>;

/// Peak tension unless stated, kPa: the largest of `coelho_2021`, Fig. 6.
const PEAK_TENSION: f64 = 50.0;
/// Cell model unless stated.
const MODEL: &str = "coelho_2021";
/// Cell unless stated.
const BUILT_IN: &str = "adult_ventricular";
/// Time after the last stimulus that a run lasts unless stated, ms: the paper's 600 ms.
const AFTER_LAST_STIMULUS: f64 = 550.0;
/// Most samples and shapes that a run may record.
const MOST_SAMPLES: f64 = 5e6;
const MOST_FRAMES: f64 = 1e5;

pub(super) fn fail<T>(key: &str, problem: Problem) -> Checked<T> {
    Err((key.to_owned(), problem))
}

pub(super) fn resolve(file: &RunFile) -> Checked<Run> {
    let (cell, settings) = cell_model(&file.cell)?;
    let as_authors = file.cell.authors_step == Some(true) && cell.name() == MODEL;
    let protocol = protocol(&file.stimulus, &*cell, as_authors)?;
    let last = f64::from(protocol.beats.saturating_sub(1)) * protocol.cycle_length_ms;
    let numerics = numerics(&file.numerics, settings)?;
    check_method(file, numerics.method)?;
    let exchange = numerics.exchange_interval;
    // The authors' stimulus falls one of their steps before 50 ms; the run still lasts 600 ms.
    let enough = ((protocol.start_ms + last + AFTER_LAST_STIMULUS) / exchange).ceil() * exchange;
    let duration = bounds::DURATION.read_or(file.run.duration.as_ref(), enough)?;
    check_times(&numerics, duration)?;
    let tension = file.cell.peak_tension.as_ref();
    Ok(Run {
        title: file.title.clone().unwrap_or_default(),
        cell,
        peak_tension: bounds::PEAK_TENSION.read_or(tension, PEAK_TENSION)?,
        tension_scale: file.cell.tension_scale.unwrap_or(TensionScale::Published),
        protocol,
        shape: shape(&file.shape, &file.segmentation)?,
        material: material(&file.material)?,
        active: file.mechanics.active.unwrap_or(ActiveLaw::Fibre),
        fibre: fibre(&file.mechanics, &file.shape)?,
        support: support(&file.mechanics)?,
        numerics,
        duration,
    })
}

fn cell_model(table: &CellTable) -> Checked<(Arc<dyn CellModel>, Settings)> {
    let name = table.model.as_deref().unwrap_or(MODEL);
    let published = cell::model(name).or_else(|error| fail("cell.model", Problem::Model(error)))?;
    let authors = table.authors_step == Some(true);
    for (given, second) in
        [(table.method.is_some(), "cell.method"), (table.step.is_some(), "cell.step")]
    {
        if authors && given {
            let advice = "leave one of them out";
            return fail(second, Problem::Conflict { first: "cell.authors_step", second, advice });
        }
    }
    let mut settings = if authors { coelho_2021::authors_step() } else { Settings::default() };
    settings.method = table.method.unwrap_or(settings.method);
    settings.step_ms = bounds::CELL_STEP.read_or(table.step.as_ref(), settings.step_ms)?;
    let mut parameters = if authors && name == MODEL {
        coelho_2021::authors_model().parameters().clone()
    } else {
        published.parameters().clone()
    };
    for (name, setting) in &table.parameters {
        let key = format!("cell.parameters.{name}");
        let unit =
            parameters.rows().iter().find(|row| row.name == *name).map(|row| row.unit.clone());
        let Some(unit) = unit else {
            let known: Vec<String> =
                parameters.rows().iter().map(|row| row.name.to_string()).collect();
            let suggestion = nearest(name, known.iter().map(String::as_str)).map(str::to_owned);
            let table = "cell.parameters".to_owned();
            let problem = Problem::UnknownKey { key: name.clone(), table, suggestion, known };
            return fail(&key, problem);
        };
        let value = in_unit(&key, setting, &unit)?;
        parameters
            .set(name, value)
            .or_else(|error: ParameterError| fail(&key, Problem::Parameter(error)))?;
    }
    let cell = published
        .with_parameters(parameters)
        .or_else(|error| fail("cell.parameters", Problem::Parameters(error)))?;
    Ok((cell, settings))
}

/// A parameter's value in its row's unit: a bare number, or text with a unit of the same kind.
fn in_unit(key: &str, setting: &Setting, unit: &str) -> Checked<f64> {
    let text = match setting {
        Setting::Number(value) => return Ok(*value),
        Setting::Text(text) => text.trim(),
    };
    let Some(dimension) = Dimension::of_unit(unit) else {
        // A unit that only the model knows is taken as it is written there, and no other.
        let number = text.strip_suffix(unit).and_then(|number| number.trim().parse().ok());
        return number.map_or_else(
            || {
                let (key, found) = (key.to_owned(), format!("the text \"{text}\""));
                let wanted = format!("a plain number, or a number in {unit} like \"1.5 {unit}\",");
                fail(&key.clone(), Problem::Kind { key, found, wanted })
            },
            Ok,
        );
    };
    // The row's unit is the internal one of its dimension.
    units::parse(text, dimension).or_else(|cause| {
        let example = units::format(1.5, dimension);
        fail(key, Problem::Unit { key: key.to_owned(), cause, example })
    })
}

fn protocol(table: &StimulusTable, cell: &dyn CellModel, as_authors: bool) -> Checked<Protocol> {
    let default = cell.default_stimulus();
    let kind = table.kind.unwrap_or(match default {
        Stimulus::Jump { .. } => StimulusKind::Jump,
        Stimulus::Pulse { .. } => StimulusKind::Pulse,
    });
    let missing = |reason| fail("stimulus", Problem::Missing { key: "stimulus.amplitude", reason });
    let stimulus = match (kind, default) {
        (StimulusKind::Jump, _) if table.duration.is_some() => {
            let (first, second) = ("stimulus.kind", "stimulus.duration");
            let advice = "a jump takes no time; leave the duration out or give kind = \"pulse\"";
            return fail(second, Problem::Conflict { first, second, advice });
        }
        (StimulusKind::Jump, Stimulus::Jump { amplitude }) => {
            Stimulus::Jump { amplitude: bounds::JUMP.read_or(table.amplitude.as_ref(), amplitude)? }
        }
        (StimulusKind::Jump, Stimulus::Pulse { .. }) => match &table.amplitude {
            Some(amplitude) => Stimulus::Jump { amplitude: bounds::JUMP.read(amplitude)? },
            None => return missing("this cell model has no jump of its own; give its size"),
        },
        (StimulusKind::Pulse, Stimulus::Pulse { amplitude, duration_ms }) => Stimulus::Pulse {
            amplitude: bounds::PULSE.read_or(table.amplitude.as_ref(), amplitude)?,
            duration_ms: bounds::PULSE_DURATION.read_or(table.duration.as_ref(), duration_ms)?,
        },
        (StimulusKind::Pulse, Stimulus::Jump { .. }) => match (&table.amplitude, &table.duration) {
            (Some(amplitude), Some(duration)) => Stimulus::Pulse {
                amplitude: bounds::PULSE.read(amplitude)?,
                duration_ms: bounds::PULSE_DURATION.read(duration)?,
            },
            _ => {
                return missing(
                    "this cell model has no pulse of its own; give its size and duration",
                );
            }
        },
    };
    let start = if as_authors {
        coelho_2021::authors_protocol().start_ms
    } else {
        Protocol::DEFAULT_START_MS
    };
    let protocol = Protocol {
        stimulus,
        start_ms: bounds::START.read_or(table.start.as_ref(), start)?,
        cycle_length_ms: bounds::CYCLE_LENGTH.read_or(table.cycle_length.as_ref(), 1000.0)?,
        beats: bounds::BEATS.read(table.beats)?.unwrap_or(1),
    };
    protocol.validate().or_else(|error| fail("stimulus", Problem::Stimulus(error)))?;
    Ok(protocol)
}

fn shape(table: &ShapeTable, segmentation: &SegmentationTable) -> Checked<Shape> {
    let given: Vec<&'static str> = [
        ("shape.built_in", table.built_in.is_some()),
        ("shape.picture", table.picture.is_some()),
        ("shape.outline", table.outline.is_some()),
    ]
    .iter()
    .filter(|(_, given)| *given)
    .map(|(key, _)| *key)
    .collect();
    if let [first, second, ..] = given[..] {
        let advice = "a cell has one shape; leave one of them out";
        return fail(second, Problem::Conflict { first, second, advice });
    }
    let exclude = |first, second, advice| fail(second, Problem::Conflict { first, second, advice });
    let source = if let Some(path) = &table.picture {
        if table.rotate.is_some() {
            let advice = "a picture is not turned; the fibre follows the cell's long axis anyway";
            return exclude("shape.picture", "shape.rotate", advice);
        }
        Source::Picture(Box::new(picture::resolve(path, table, segmentation)?))
    } else {
        let other = *given.first().unwrap_or(&"shape.built_in");
        let advice = "only a picture has it; leave it out";
        if let Some(key) = of_pictures(segmentation) {
            return exclude(other, key, advice);
        }
        if let Some(path) = &table.outline {
            let path = with_ending("shape.outline", path, picture::OUTLINES)?;
            let pixel_size = table.pixel_size.as_ref();
            let pixel_size = pixel_size.map(|size| bounds::PIXEL_SIZE.read(size)).transpose()?;
            Source::Outline { path, pixel_size, choice: picture::choice(table, segmentation)? }
        } else {
            let keys = [
                ("shape.pixel_size", table.pixel_size.is_some()),
                ("shape.label", table.label.is_some()),
                ("segmentation.cell", segmentation.cell.is_some()),
            ];
            if let Some((key, _)) = keys.into_iter().find(|(_, given)| *given) {
                return exclude(other, key, advice);
            }
            let name = table.built_in.as_deref().unwrap_or(BUILT_IN);
            let Some(cell) = built_in::find(name) else {
                let known: Vec<String> =
                    built_in::CELLS.iter().map(|cell| cell.name.to_owned()).collect();
                let suggestion = nearest(name, known.iter().map(String::as_str)).map(str::to_owned);
                let (key, word) = ("shape.built_in".to_owned(), name.to_owned());
                return fail(
                    "shape.built_in",
                    Problem::UnknownWord { key, word, suggestion, known },
                );
            };
            Source::BuiltIn(cell)
        }
    };
    Ok(Shape {
        source,
        rotate: bounds::ROTATE.read_or(table.rotate.as_ref(), 0.0)?,
        spacing: table.spacing.as_ref().map(|spacing| bounds::SPACING.read(spacing)).transpose()?,
    })
}

/// A key of `[segmentation]` that only a picture has, if there is one.
fn of_pictures(table: &SegmentationTable) -> Option<&'static str> {
    let keys = [
        ("segmentation.modality", table.modality.is_some()),
        ("segmentation.channel", table.channel.is_some()),
        ("segmentation.frame", table.frame.is_some()),
        ("segmentation.z", table.z.is_some()),
        ("segmentation.threshold", table.threshold.is_some()),
        ("segmentation.smooth", table.smooth.is_some()),
        ("segmentation.seed", table.seed.is_some()),
        ("segmentation.allow_cut", table.allow_cut.is_some()),
        ("segmentation.outline", table.outline.is_some()),
    ];
    keys.into_iter().find_map(|(key, given)| given.then_some(key))
}

pub(super) fn with_ending(key: &'static str, path: &str, endings: &[&str]) -> Checked<String> {
    let lower = path.to_lowercase();
    if endings.iter().any(|ending| lower.ends_with(&format!(".{ending}"))) {
        return Ok(path.to_owned());
    }
    let known = endings.iter().map(|ending| format!(".{ending}")).collect::<Vec<_>>().join(", ");
    fail(key, Problem::Ending { key, path: path.to_owned(), known })
}

fn material(table: &MaterialTable) -> Checked<Material> {
    let default = default_material();
    let stiffness = match (&table.young_modulus, &table.spring_stiffness) {
        (Some(_), Some(_)) => {
            let (first, second) = ("material.young_modulus", "material.spring_stiffness");
            let advice = "each follows from the other; leave one of them out";
            return fail(second, Problem::Conflict { first, second, advice });
        }
        (Some(modulus), None) => Stiffness::YoungModulus(bounds::YOUNG_MODULUS.read(modulus)?),
        (None, Some(spring)) => Stiffness::Spring(bounds::SPRING_STIFFNESS.read(spring)?),
        (None, None) => default.stiffness,
    };
    let or = |bounds: bounds::Bounds, setting: &Option<Setting>, default| {
        bounds.read_or(setting.as_ref(), default)
    };
    Ok(Material {
        stiffness,
        thickness: or(bounds::THICKNESS, &table.thickness, default.thickness)?,
        area_law: table.area_law.unwrap_or(default.area_law),
        area_modulus: or(bounds::AREA_MODULUS, &table.area_modulus, default.area_modulus)?,
        damping_ratio: or(bounds::DAMPING_RATIO, &table.damping_ratio, default.damping_ratio)?,
        slowest_period: or(bounds::SLOWEST_PERIOD, &table.slowest_period, default.slowest_period)?,
        drag_ratio: or(bounds::DRAG_RATIO, &table.drag_ratio, default.drag_ratio)?,
    })
}

fn fibre(table: &MechanicsTable, shape: &ShapeTable) -> Checked<Fibre> {
    const WORDS: [&str; 2] = ["long axis", "picture"];
    let of_picture = [
        ("mechanics.stain", table.stain.is_some()),
        ("mechanics.fibre_smoothing", table.fibre_smoothing.is_some()),
    ];
    let fibre = match &table.fibre {
        None => Fibre::LongAxis,
        Some(Setting::Text(words)) if words.trim() == WORDS[0] => Fibre::LongAxis,
        Some(Setting::Text(words)) if words.trim() == WORDS[1] => {
            if shape.picture.is_none() {
                let reason = "fibre = \"picture\" reads the direction from a picture; give one, or take \
                              \"long axis\" or an angle";
                return fail("mechanics.fibre", Problem::Missing { key: "shape.picture", reason });
            }
            let mut settings = FibreSettings::of(table.stain.unwrap_or(Stain::ZDisc));
            let smoothing = table.fibre_smoothing.as_ref();
            settings.smoothing_um =
                bounds::FIBRE_SMOOTHING.read_or(smoothing, settings.smoothing_um)?;
            return Ok(Fibre::Picture(settings));
        }
        Some(Setting::Text(words)) if !words.contains(|c: char| c.is_ascii_digit()) => {
            let mut known: Vec<String> = WORDS.map(str::to_owned).to_vec();
            known.push("an angle like 15 deg".to_owned());
            let suggestion = nearest(words, WORDS.into_iter()).map(str::to_owned);
            let (key, word) = (bounds::FIBRE.key.to_owned(), words.clone());
            return fail(bounds::FIBRE.key, Problem::UnknownWord { key, word, suggestion, known });
        }
        Some(angle) => Fibre::Angle(bounds::FIBRE.read(angle)?),
    };
    if let Some((second, _)) = of_picture.into_iter().find(|(_, given)| *given) {
        let advice = "only fibre = \"picture\" has it; choose that or leave it out";
        return fail(second, Problem::Conflict { first: "mechanics.fibre", second, advice });
    }
    Ok(fibre)
}

fn support(table: &MechanicsTable) -> Checked<SupportKind> {
    let name = table.support.unwrap_or(SupportName::MassCentre);
    let springs = [
        (
            SupportName::SpringHeldEnds,
            bounds::END_STIFFNESS,
            &table.end_stiffness,
            "the springs at the ends need their stiffness: give it like end_stiffness = \
             \"100 nN/um\", or --end-stiffness \"100 nN/um\"",
            "only support = \"spring-held-ends\" has it; choose that support or leave it out",
        ),
        (
            SupportName::ElasticBed,
            bounds::BED_STIFFNESS,
            &table.bed_stiffness,
            "an elastic bed needs its stiffness: give it like bed_stiffness = \"0.5 kPa/um\", or \
             --bed-stiffness \"0.5 kPa/um\"",
            "only support = \"elastic-bed\" has it; choose that support or leave it out",
        ),
    ];
    let mut stiffness = 0.0;
    for (holder, bounds, setting, reason, advice) in springs {
        match (name == holder, setting) {
            (true, Some(setting)) => stiffness = bounds.read(setting)?,
            (true, None) => {
                let problem = Problem::Missing { key: bounds.key, reason };
                return fail("mechanics.support", problem);
            }
            (false, Some(_)) => {
                let (first, second) = ("mechanics.support", bounds.key);
                return fail(second, Problem::Conflict { first, second, advice });
            }
            (false, None) => {}
        }
    }
    Ok(match name {
        SupportName::MassCentre => SupportKind::MassCentre,
        SupportName::ClampedEnd => SupportKind::ClampedEnd,
        SupportName::ClampedEnds => SupportKind::ClampedEnds,
        SupportName::SpringHeldEnds => SupportKind::SpringHeldEnds { stiffness },
        SupportName::ElasticBed => SupportKind::ElasticBed { stiffness },
    })
}

fn numerics(table: &NumericsTable, cell: Settings) -> Checked<Numerics> {
    let default = Numerics::default();
    let exchange = table.exchange_interval.as_ref();
    let output = table.output_interval.as_ref();
    let frame = table.frame_interval.as_ref();
    Ok(Numerics {
        method: table.integrator.map_or(default.method, method),
        time_step: table.time_step.as_ref().map(|step| bounds::TIME_STEP.read(step)).transpose()?,
        exchange_interval: bounds::EXCHANGE_INTERVAL
            .read_or(exchange, default.exchange_interval)?,
        output_interval: bounds::OUTPUT_INTERVAL.read_or(output, default.output_interval)?,
        frame_interval: bounds::FRAME_INTERVAL.read_or(frame, default.frame_interval)?,
        cell,
        engine: default.engine,
    })
}

fn method(name: IntegratorName) -> Method {
    match name {
        IntegratorName::Verlet | IntegratorName::StoermerVerlet => {
            Method::Verlet(Integrator::StoermerVerlet)
        }
        IntegratorName::VelocityVerlet => Method::Verlet(Integrator::VelocityVerlet),
        IntegratorName::QuasiStatic => Method::QuasiStatic,
    }
}

/// Settings without a path of equilibria stand in the way of a quasi-static run.
fn check_method(file: &RunFile, method: Method) -> Checked<()> {
    if method != Method::QuasiStatic {
        return Ok(());
    }
    let hindrances = [
        (
            matches!(file.material.area_law, Some(AreaLaw::Barycentric | AreaLaw::Printed)),
            "material.area_law",
            "this area law has no energy, so the shape is no function of the tension; use area_law = \
             \"gradient\", or integrator = \"verlet\"",
        ),
        (
            file.mechanics.active == Some(ActiveLaw::Ends),
            "mechanics.active",
            "loads on the ends push the cell from outside and have no path of equilibria; use active \
             = \"fibre\", or integrator = \"verlet\"",
        ),
        (
            file.numerics.time_step.is_some(),
            "numerics.time_step",
            "equilibria know no time step; leave it out, or use integrator = \"verlet\"",
        ),
    ];
    match hindrances.into_iter().find(|(stands, ..)| *stands) {
        None => Ok(()),
        Some((_, second, advice)) => {
            let first = "integrator = \"quasi-static\"";
            fail(second, Problem::Conflict { first, second, advice })
        }
    }
}

/// Intervals must divide each other, and there must be room for what they record.
fn check_times(numerics: &Numerics, duration: f64) -> Checked<()> {
    let Numerics { exchange_interval, output_interval, frame_interval, .. } = *numerics;
    let exchange = ("numerics.exchange_interval", exchange_interval);
    let output = ("numerics.output_interval", output_interval);
    let frame = ("numerics.frame_interval", frame_interval);
    let multiples = [(output, exchange), (frame, output), (("run.duration", duration), exchange)];
    for ((key, value), (unit_key, unit)) in multiples {
        let ratio = value / unit;
        // A part in a million allows for decimal fractions that binary numbers cannot hold.
        if ratio.round() < 1.0 || (ratio - ratio.round()).abs() > 1e-6 * ratio {
            return fail(key, Problem::NotAMultiple { key, value, unit_key, unit });
        }
    }
    let limits = [(output, "samples", MOST_SAMPLES), (frame, "shapes", MOST_FRAMES)];
    for ((key, value), what, most) in limits {
        let count = duration / value;
        if count > most {
            return fail(key, Problem::TooMany { key, value, count, what, most });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_in_a_unit_of_its_own_is_read_in_that_unit_or_refused() {
        let read =
            |text: &str, unit| in_unit("cell.parameters.g", &Setting::Text(text.into()), unit);
        assert_eq!(read("1.5 mol/l", "mol/l").unwrap(), 1.5);
        assert_eq!(in_unit("g", &Setting::Number(1.5), "mol/l").unwrap(), 1.5);
        for wrong in ["1.5 ms", "1.5 %", "1.5", "mol/l", "1.5 mol"] {
            let (key, problem) = read(wrong, "mol/l").unwrap_err();
            assert_eq!(key, "cell.parameters.g");
            assert!(problem.to_string().contains("mol/l"), "{wrong}: {problem}");
        }
        assert_eq!(read("0.0019 s", "ms").unwrap(), 1.9);
        assert_eq!(read("0.5 mM", "uM").unwrap(), 500.0);
        assert_eq!(read("1.5 nS/pF", "mS/uF").unwrap(), 1.5);
        assert_eq!(read("50 %", "").unwrap(), 0.5);
    }

    #[test]
    fn whole_numbers_outside_their_bounds_are_refused_and_not_replaced() {
        let file = |change: fn(&mut RunFile)| {
            let mut file = RunFile::default();
            file.shape.picture = Some("cell.tif".to_owned());
            change(&mut file);
            file.resolve().err().map(|error| error.to_string()).unwrap_or_default()
        };
        for (message, key) in [
            (file(|file| file.stimulus.beats = Some(-1)), "stimulus.beats"),
            (file(|file| file.stimulus.beats = Some(20_000)), "stimulus.beats"),
            (file(|file| file.shape.label = Some(-3)), "shape.label"),
            (file(|file| file.shape.label = Some(0)), "shape.label"),
            (file(|file| file.segmentation.channel = Some(-1)), "segmentation.channel"),
            (file(|file| file.segmentation.frame = Some(-1)), "segmentation.frame"),
        ] {
            assert!(message.contains(key) && message.contains("whole number from"), "{message}");
        }
        let message = file(|file| file.segmentation.threshold = Some(f64::NAN));
        assert!(message.contains("segmentation.threshold"), "{message}");
    }
}
