//! Rules that concern several settings together.

use super::file::RunFile;
use crate::cell::pacing::Stimulus;
use crate::cell::{CellModel, TensionKind, calcium};
use crate::integrate::engine::Loops;
use crate::mechanics::active::ActiveLaw;
use crate::mechanics::area::AreaLaw;
use crate::mechanics::support::SupportKind;
use crate::settings::{
    self, Conducts, Failure, FibreDirection, FromPlaces, Problem, Run, Source, Value,
};
use crate::simulation::{MOST_FRAMES, MOST_SAMPLES, divides};
use crate::units::{self, Dimension};

type Checked = Result<(), Failure>;

/// How the cell model is integrated.
pub(super) const INTEGRATION: [&str; 3] = ["cell.integrator", "cell.step", "cell.tolerance"];

/// Keys that name the shape of the cell.
pub(crate) const SHAPES: [&str; 4] =
    ["shape.built_in", "shape.picture", "shape.outline", "shape.stack"];

/// Keys of which only one may be given, and the advice for users who give two.
const ALTERNATIVES: [(&[&str], &str); 6] = [
    (&SHAPES, "a cell has one shape; leave one of them out"),
    (
        &["shape.stack", "shape.profile"],
        "a stack shows how thick the cell is in each place; leave the profile out",
    ),
    (
        &["shape.stack", "material.thickness"],
        "a stack shows how thick the cell is; leave the thickness out",
    ),
    (
        &["material.young_modulus", "material.spring_stiffness"],
        "each follows from the other; leave one of them out",
    ),
    (
        &["tissue.conduction_velocity", "tissue.diffusion"],
        "each follows from the other; leave one of them out",
    ),
    (
        &["shape.label", "segmentation.seed", "segmentation.cell"],
        "each chooses the cell; leave one of them out",
    ),
];

/// A support with a stiffness or a load: its word, the key of that value, the message if the value
/// is missing and there is no usual one, and the advice if it is given with another support.
struct Springs {
    support: &'static str,
    key: &'static str,
    reason: Option<&'static str>,
    advice: &'static str,
}

const OF_GEL: &str = "only support = \"gel\" has it; choose that support or leave it out";

const OF_POSTS: &str = "only support = \"posts\" has it; choose that support or leave it out";

const SPRINGS: [Springs; 13] = [
    Springs {
        support: "spring-held-ends",
        key: "mechanics.end_stiffness",
        reason: Some(
            "the springs at the ends need their stiffness: give it like end_stiffness = \"100 nN/um\", or \
             --end-stiffness \"100 nN/um\"",
        ),
        advice: "only support = \"spring-held-ends\" has it; choose that support or leave it out",
    },
    Springs {
        support: "posts",
        key: "mechanics.post_length",
        reason: Some(
            "posts need their length: give it like post_length = \"3 mm\", or --post-length \"3 mm\"",
        ),
        advice: OF_POSTS,
    },
    Springs {
        support: "posts",
        key: "mechanics.post_width",
        reason: Some(
            "posts need their width, or diameter: give it like post_width = \"1 mm\", or --post-width \"1 mm\"",
        ),
        advice: OF_POSTS,
    },
    Springs {
        support: "posts",
        key: "mechanics.post_modulus",
        reason: Some(
            "posts need their Young's modulus: give it like post_modulus = \"1.6 MPa\", or --post-modulus \"1.6 MPa\"",
        ),
        advice: OF_POSTS,
    },
    Springs { support: "posts", key: "mechanics.post_thickness", reason: None, advice: OF_POSTS },
    Springs { support: "posts", key: "mechanics.post_load_height", reason: None, advice: OF_POSTS },
    Springs {
        support: "afterloaded-ends",
        key: "mechanics.afterload",
        reason: Some(
            "afterloaded ends need their load: give it like afterload = \"2000 nN\", or --afterload \"2000 nN\"",
        ),
        advice: "only support = \"afterloaded-ends\" has it; choose that support or leave it out",
    },
    Springs {
        support: "elastic-bed",
        key: "mechanics.bed_stiffness",
        reason: None,
        advice: "only support = \"elastic-bed\" has it; choose that support or leave it out",
    },
    Springs {
        support: "gel",
        key: "mechanics.gel_modulus",
        reason: Some(
            "a gel needs its Young's modulus: give it like gel_modulus = \"10 kPa\", or --gel-modulus \"10 kPa\"",
        ),
        advice: OF_GEL,
    },
    Springs { support: "gel", key: "mechanics.gel_poisson", reason: None, advice: OF_GEL },
    Springs { support: "gel", key: "mechanics.gel_thickness", reason: None, advice: OF_GEL },
    Springs { support: "gel", key: "mechanics.adhesion", reason: None, advice: OF_GEL },
    Springs { support: "gel", key: "mechanics.adhesion_stiffness", reason: None, advice: OF_GEL },
];

/// Returns the keys that an option overrides when it sets this key to this value; `model` is the cell model that
/// it names.
pub(super) fn put_out_of_force(
    key: &str,
    value: &Value,
    model: Option<&dyn CellModel>,
) -> Vec<&'static str> {
    let word = value.as_text();
    match key {
        "mechanics.support" => {
            let others = SPRINGS.iter().filter(|springs| word != Some(springs.support));
            others.map(|springs| springs.key).collect()
        }
        "shape.profile" if word == Some("flat") => OF_THICK.to_vec(),
        "shape.profile" => OF_FLAT.to_vec(),
        "mechanics.fibre" if !["auto", "picture"].map(Some).contains(&word) => OF_FIBRES.to_vec(),
        "cell.model" => {
            let own = |what: fn(&dyn CellModel) -> bool, keys: &[&'static str]| match model {
                Some(model) if what(model) => keys.to_vec(),
                _ => Vec::new(),
            };
            [
                own(|cell| cell.equations_read().is_none(), &OF_FILES),
                own(has_own_tension, &OF_RELATIVE_TENSION),
                own(is_prescribed, &OF_MEMBRANE),
                own(|cell| cell.given_peak().is_none(), &OF_GIVEN_TENSION),
            ]
            .concat()
        }
        "numerics.integrator" if word == Some("quasi-static") => vec!["numerics.time_step"],
        _ => {
            let groups = ALTERNATIVES.iter().map(|(keys, _)| *keys);
            let others = groups.filter(|keys| keys.contains(&key)).flatten().copied();
            // Only another shape takes the place of a shape.
            others.filter(|other| SHAPES.contains(&key) || !SHAPES.contains(other)).collect()
        }
    }
}

/// What was assumed where the run file is silent, and a person should know.
pub(super) fn assumed(file: &RunFile, run: &Run) -> Vec<String> {
    const BED: &str = "mechanics.bed_stiffness";
    let bed = match run.support {
        SupportKind::ElasticBed { stiffness } if !file.has(BED) => Some(format!(
            "the stiffness of the bed is not stated: {} is assumed, and how far the cell shortens under a tension depends \
             on it (--bed-stiffness)",
            units::format(stiffness, Dimension::BedStiffness)
        )),
        _ => None,
    };
    let read = run.cell.equations_read().filter(|_| run.cell.filaments().is_some());
    let myofilaments = read.map(|equations| {
        let asked = file.has("cell.myofilaments");
        let chosen = if asked { "" } else { ", since the file has none (--myofilaments)" };
        format!(
            "the tension is that of the myofilaments of land_2017, driven by the calcium of {}{chosen}; calcium does not \
             depend on them",
            equations.name
        )
    });
    let conducts = run.tissue.as_ref().and_then(|tissue| tissue.conducts);
    let velocity = match conducts {
        Some(Conducts::Velocity(velocity)) if !file.has("tissue.conduction_velocity") => {
            Some(format!(
                "the conduction velocity of the tissue is not stated: {} is assumed (--conduction-velocity)",
                units::format(velocity, Dimension::Speed)
            ))
        }
        _ => None,
    };
    bed.into_iter().chain(myofilaments).chain(velocity).collect()
}

/// Checks a run together with the run file that it was made from.
pub(super) fn check(file: &RunFile, run: &Run) -> Checked {
    alternatives(file)?;
    cell_model(file, run)?;
    stimulus(file, run)?;
    tissue(file, run)?;
    shape(file, run)?;
    profile(file, run)?;
    fibre(file, run)?;
    sarcomeres(file, run)?;
    support(file, run)?;
    method(file, run)?;
    times(run)
}

fn exclude(first: &'static str, second: &'static str, advice: &'static str) -> Checked {
    Err((second.to_owned(), Problem::Conflict { first, second, advice }))
}

fn alternatives(file: &RunFile) -> Checked {
    for (keys, advice) in ALTERNATIVES {
        let mut given = keys.iter().filter(|key| file.has(key));
        if let (Some(first), Some(second)) = (given.next(), given.next()) {
            return exclude(first, second, advice);
        }
    }
    Ok(())
}

/// Keys that apply only to models from files.
const OF_FILES: [&str; 2] = ["cell.variables", "cell.myofilaments"];
/// Keys that apply only to models whose tension is scaled.
const OF_RELATIVE_TENSION: [&str; 1] = ["cell.peak_tension"];
/// Keys that apply only to models with a membrane, which a stimulus can change.
const OF_MEMBRANE: [&str; 3] = ["stimulus.kind", "stimulus.amplitude", "stimulus.duration"];
/// Keys that apply only to a model whose tension is given.
const OF_GIVEN_TENSION: [&str; 2] = ["cell.tension", "cell.tension_clock"];

fn has_own_tension(cell: &dyn CellModel) -> bool {
    !matches!(cell.tension_kind(), TensionKind::Relative { .. })
}

fn is_prescribed(cell: &dyn CellModel) -> bool {
    cell.stimulation().moves.is_empty()
}

fn cell_model(file: &RunFile, run: &Run) -> Checked {
    if run.cell.equations_read().is_none()
        && let Some(second) = OF_FILES.into_iter().find(|key| file.has(key))
    {
        let advice = "only the model of a file has it; give model = \"FILE.mmt\" or \"FILE.cellml\", or leave it out";
        return exclude("cell.model", second, advice);
    }
    if has_own_tension(&*run.cell)
        && let Some(second) = OF_RELATIVE_TENSION.into_iter().find(|key| file.has(key))
    {
        let advice = "this model gives its tension in kPa; leave this setting out and change the strength by the \
                      model's own parameter, T_ref of land_2017";
        return exclude("cell.model", second, advice);
    }
    if is_prescribed(&*run.cell)
        && let Some(second) = OF_MEMBRANE.into_iter().find(|key| file.has(key))
    {
        let advice = "what drives this model is prescribed and restarts at each stimulus; a stimulus has no other \
            effect, so leave this setting out";
        return exclude("cell.model", second, advice);
    }
    match run.cell.given_peak() {
        Some(_) if !file.has("cell.tension") => {
            let reason = "given_tension beats by the tension of a table; give tension = \"FILE.csv\", or --tension FILE.csv";
            return Err((
                "cell.model".to_owned(),
                Problem::Missing { key: "cell.tension", reason },
            ));
        }
        None => {
            if let Some(second) = OF_GIVEN_TENSION.into_iter().find(|key| file.has(key)) {
                let advice = "only model = \"given_tension\" takes its tension from a table; choose it, or leave the table out";
                return exclude("cell.model", second, advice);
            }
        }
        Some(_) => {}
    }
    if let Some(second) = ["cell.calcium_dissociation", "cell.ratio_min", "cell.ratio_max"]
        .into_iter()
        .find(|key| file.has(key) && !file.has("cell.calcium"))
    {
        let reason = "a calibration applies to a ratio in a table; give calcium = \"FILE.csv\", or leave it out";
        return Err((second.to_owned(), Problem::Missing { key: "cell.calcium", reason }));
    }
    if file.has("cell.calcium") {
        if !is_prescribed(&*run.cell) {
            let advice = "only a model with prescribed calcium reads it from a table; give model = \"land_2017\", or \
                          leave the table out";
            return exclude("cell.model", "cell.calcium", advice);
        }
        let own = calcium::rows();
        if let Some(Value::Named(given)) = file.get("cell.parameters")
            && own.iter().any(|row| given.contains_key(&*row.name))
        {
            let advice = "the calcium comes from the table, not from two exponentials; leave Ca_rest, Ca_amplitude, tau_Ca_rise \
                          and tau_Ca_fall out, or the table";
            return exclude("cell.calcium", "cell.parameters", advice);
        }
    }
    let authors = file.get("cell.authors_step") == Some(&Value::Flag(true));
    if let Some(second) = INTEGRATION.into_iter().find(|key| authors && file.has(key)) {
        return exclude("cell.authors_step", second, "leave one of them out");
    }
    if !file.has("cell.integrator") && file.has("cell.step") && file.has("cell.tolerance") {
        let advice =
            "a step is for fixed steps, a tolerance for adaptive ones; leave one of them out";
        return exclude("cell.step", "cell.tolerance", advice);
    }
    let (second, advice) = if run.cell_settings().method.chooses_steps() {
        ("cell.step", "this method chooses its steps by the tolerance; leave the step out")
    } else {
        ("cell.tolerance", "only integrator = \"adaptive\" or \"stiff\" has it; leave it out")
    };
    if file.has(second) { exclude("cell.integrator", second, advice) } else { Ok(()) }
}

fn stimulus(file: &RunFile, run: &Run) -> Checked {
    let missing = |reason| {
        Err(("stimulus".to_owned(), Problem::Missing { key: "stimulus.amplitude", reason }))
    };
    let sized = file.has("stimulus.amplitude");
    let lasts = file.has("stimulus.duration");
    match (run.protocol.stimulus, run.cell.default_stimulus()) {
        (Stimulus::Jump { .. }, _) if lasts => {
            return exclude(
                "stimulus.kind",
                "stimulus.duration",
                "a jump has no duration; leave the duration out or give kind = \"pulse\"",
            );
        }
        (Stimulus::Jump { .. }, Stimulus::Pulse { .. }) if !sized => {
            return missing("this cell model has no default jump; give its size");
        }
        (Stimulus::Pulse { .. }, Stimulus::Jump { .. }) if !(sized && lasts) => {
            return missing("this cell model has no default pulse; give its size and duration");
        }
        _ => {}
    }
    if !run.steady_state_cache.is_empty() && run.steady_state.is_none() {
        let reason = "a folder for steady states needs the setting steady_state: give steady_state = 0.001, or --steady-state 0.001, \
                      or leave the folder out";
        let problem = Problem::Missing { key: "stimulus.steady_state", reason };
        return Err(("stimulus.steady_state_cache".to_owned(), problem));
    }
    let valid = run.protocol.validate();
    valid.map_err(|error| ("stimulus".to_owned(), Problem::Stimulus(error)))?;
    match run.protocol.s2_ms() {
        Some(s2_ms) if s2_ms >= run.duration => {
            let duration_ms = run.duration;
            Err(("run.duration".to_owned(), Problem::EndsBeforeS2 { duration_ms, s2_ms }))
        }
        _ => Ok(()),
    }
}

/// A tissue says how it conducts, and its cells have what they need.
fn tissue(file: &RunFile, run: &Run) -> Checked {
    let Some(settings) = &run.tissue else { return Ok(()) };
    let given =
        settings::table().map(|setting| setting.key).filter(|key| key.starts_with("tissue."));
    if settings.conducts.is_none()
        && let Some(second) = given.into_iter().find(|key| file.has(key))
    {
        let reason = "a tissue needs the velocity of its waves: give conduction_velocity = \"20 cm/s\", or --conduction-velocity \
                      \"20 cm/s\"";
        let key = "tissue.conduction_velocity";
        return Err((second.to_owned(), Problem::Missing { key, reason }));
    }
    let key = "tissue.conduction_velocity";
    if file.has("stimulus.wave_speed") {
        let advice = "in a tissue the wave has the velocity that its cells give it; leave the speed of the stimuli out";
        return exclude(key, "stimulus.wave_speed", advice);
    }
    if run.shape.is_thick() {
        let advice = "a tissue is a flat sheet, whose thickness is that of its material; leave out what makes it thick";
        return exclude(key, thick_by(run), advice);
    }
    if run.cell_settings().method.chooses_steps() {
        let advice = "coupled cells need fixed steps; take forward-euler, rush-larsen or runge-kutta-4, or leave the method out";
        return exclude(key, "cell.integrator", advice);
    }
    if settings.s2_stimulated.is_some() && run.protocol.s2_ms().is_none() {
        let reason = "a place of S2 needs its time: give s2_interval = \"250 ms\", or --s2-interval \"250 ms\", or leave the place out";
        let problem = Problem::Missing { key: "stimulus.s2_interval", reason };
        return Err(("tissue.s2_stimulated".to_owned(), problem));
    }
    Ok(())
}

/// Checks keys that apply only to pictures, or only to pictures and files of outlines.
fn shape(file: &RunFile, run: &Run) -> Checked {
    const ADVICE: &str = "this applies only to pictures; leave it out";
    let source = match run.shape.source {
        Source::Picture(_) => {
            let slices = run.shape.slices().is_some();
            let source = if slices { "shape.stack" } else { "shape.picture" };
            if file.has("shape.rotate") {
                let advice =
                    "pictures are not rotated; the fibres follow the long axis of the cell anyway";
                return exclude(source, "shape.rotate", advice);
            }
            let flat = [
                ("segmentation.z", "all slices of a stack are read; leave it out"),
                (
                    "segmentation.outline",
                    "the form of the cell is found in its slices; leave the outline out, or give a stack that is a mask",
                ),
            ];
            let flat = flat.into_iter().filter(|_| slices);
            if let Some((second, advice)) = flat.into_iter().find(|(key, _)| file.has(key)) {
                return exclude(source, second, advice);
            }
            let areas = run.shape.source.picture().map(|picture| picture.options.areas_um2);
            if areas.is_some_and(|[least, most]| least >= most) {
                let advice = "the least area must be below the largest one";
                return exclude("segmentation.min_area", "segmentation.max_area", advice);
            }
            return Ok(());
        }
        Source::Outline { .. } => "shape.outline",
        Source::BuiltIn(_) => "shape.built_in",
    };
    let of_outlines = ["shape.pixel_size", "shape.label", "segmentation.cell"];
    let of_pictures = settings::table()
        .map(|setting| setting.key)
        .filter(|key| key.starts_with("segmentation.") && !of_outlines.contains(key));
    let built_in = matches!(run.shape.source, Source::BuiltIn(_));
    let refused = of_pictures.chain(of_outlines.into_iter().filter(|_| built_in));
    match refused.into_iter().find(|key| file.has(key)) {
        Some(key) => exclude(source, key, ADVICE),
        None => Ok(()),
    }
}

/// Keys that apply only to thick cells, only to stacks, and only to flat cells.
const OF_THICK: [&str; 2] = ["material.poisson_ratio", "mechanics.helix_angle"];
const OF_STACK: [&str; 3] = ["shape.z_step", "shape.first_slice", "shape.stack_stain"];
const OF_FLAT: [&str; 3] =
    ["material.area_law", "material.area_modulus", "material.spring_stiffness"];

/// The key that makes a cell thick, or would.
fn thick_by(run: &Run) -> &'static str {
    if run.shape.slices().is_some() { "shape.stack" } else { "shape.profile" }
}

fn profile(file: &RunFile, run: &Run) -> Checked {
    if run.shape.slices().is_none()
        && let Some(second) = OF_STACK.into_iter().find(|key| file.has(key))
    {
        let reason = "only a stack has it; give stack = \"FILE.tif\" (--stack), or leave it out";
        return Err((second.to_owned(), Problem::Missing { key: "shape.stack", reason }));
    }
    let (others, advice) = if run.shape.is_thick() {
        (
            &OF_FLAT[..],
            "a thick cell has young_modulus and poisson_ratio instead; leave it out, or give profile = \"flat\"",
        )
    } else {
        (
            &OF_THICK[..],
            "only a thick cell has it; give profile = \"round\", \"dome\" or \"slab\" (--profile) or a stack (--stack), or leave \
             it out",
        )
    };
    match others.iter().find(|key| file.has(key)) {
        Some(second) => exclude(thick_by(run), second, advice),
        None => Ok(()),
    }
}

/// Keys that apply only to pictures whose fibre direction is read.
const OF_FIBRES: [&str; 2] = ["mechanics.stain", "mechanics.fibre_smoothing"];

fn fibre(file: &RunFile, run: &Run) -> Checked {
    let source = match run.shape.source {
        Source::Picture(_) => None,
        Source::Outline { .. } => Some("shape.outline"),
        Source::BuiltIn(_) => Some("shape.built_in"),
    };
    if run.shape.slices().is_some() {
        const ADVICE: &str = "this is read from a flat picture only; give a table, or leave it out";
        if run.myofibril_content == FromPlaces::Picture {
            return exclude("shape.stack", "mechanics.myofibril_content", ADVICE);
        }
        if run.sarcomere_length == FromPlaces::Picture {
            return exclude("shape.stack", "mechanics.sarcomere_length", ADVICE);
        }
        if matches!(run.fibre, FibreDirection::Picture(_)) && run.helix_angle != 0.0 {
            let advice = "the slices show how the fibres turn; leave it out, or give fibre = \"long axis\" or an angle";
            return exclude("mechanics.fibre", "mechanics.helix_angle", advice);
        }
    }
    let given = OF_FIBRES.into_iter().find(|key| file.has(key));
    if run.myofibril_content == FromPlaces::Picture {
        const CONTENT: &str = "mechanics.myofibril_content";
        match (run.fibre, source) {
            (FibreDirection::LongAxis | FibreDirection::Angle(_), None) => {
                let advice = "myofibril_content = \"picture\" uses the fibres that the picture shows: give fibre \
                              = \"auto\" or \"picture\", or content from a file";
                return exclude("mechanics.fibre", CONTENT, advice);
            }
            (_, Some(_)) => {
                let reason = "myofibril_content = \"picture\" needs a picture of the cell; give one, or take \
                              \"uniform\" or a file";
                let problem = Problem::Missing { key: "shape.picture", reason };
                return Err((CONTENT.to_owned(), problem));
            }
            _ => {}
        }
    }
    match (run.fibre, source, given) {
        (FibreDirection::Picture(_), Some(_), _) => {
            let reason = "fibre = \"picture\" reads the direction from a picture; give one, or take \
                          \"long axis\" or an angle";
            let problem = Problem::Missing { key: "shape.picture", reason };
            Err(("mechanics.fibre".to_owned(), problem))
        }
        (FibreDirection::Auto(_), Some(source), Some(second)) => {
            exclude(source, second, "this applies only to pictures; leave it out")
        }
        (FibreDirection::LongAxis | FibreDirection::Angle(_), _, Some(second)) => exclude(
            "mechanics.fibre",
            second,
            "only fibre = \"auto\" or \"picture\" uses this; choose one of them or leave it out",
        ),
        _ => Ok(()),
    }
}

/// Checks the lengths of sarcomeres: the model must depend on its stretch, and a reference length
/// must be given.
fn sarcomeres(file: &RunFile, run: &Run) -> Checked {
    const LENGTH: &str = "mechanics.sarcomere_length";
    const REFERENCE: &str = "mechanics.sarcomere_reference";
    if run.sarcomere_length == FromPlaces::Uniform {
        if file.has(REFERENCE) {
            let reason = "a reference length needs sarcomere lengths; give sarcomere_length = \"picture\" or a table, or leave it out";
            return Err((REFERENCE.to_owned(), Problem::Missing { key: LENGTH, reason }));
        }
        return Ok(());
    }
    if !run.cell.feels_stretch() {
        let advice = "this model does not depend on its stretch; give model = \"land_2017\" or \"tor_ord_land\", or \
                      leave the lengths out";
        return exclude("cell.model", LENGTH, advice);
    }
    if !file.has(REFERENCE) {
        let reason = "give the length at which the model's stretch is 1, like sarcomere_reference = \"1.71 um\", at \
                      which isolated rat cells rest, or --sarcomere-reference \"1.71 um\"";
        return Err((LENGTH.to_owned(), Problem::Missing { key: REFERENCE, reason }));
    }
    if run.sarcomere_length == FromPlaces::Picture {
        if !matches!(run.shape.source, Source::Picture(_)) {
            let reason =
                "sarcomere_length = \"picture\" needs a picture of the cell; give one, or a table";
            return Err((LENGTH.to_owned(), Problem::Missing { key: "shape.picture", reason }));
        }
        if matches!(run.fibre, FibreDirection::LongAxis | FibreDirection::Angle(_)) {
            let advice = "sarcomere_length = \"picture\" uses the sarcomeres that the picture shows: give fibre = \
                          \"auto\" or \"picture\", or a table";
            return exclude("mechanics.fibre", LENGTH, advice);
        }
    }
    Ok(())
}

fn support(file: &RunFile, run: &Run) -> Checked {
    let holder = match run.support {
        SupportKind::SpringHeldEnds { .. } => Some("spring-held-ends"),
        SupportKind::Posts(_) => Some("posts"),
        SupportKind::ElasticBed { .. } => Some("elastic-bed"),
        SupportKind::Gel(_) => Some("gel"),
        SupportKind::AfterloadedEnds { .. } => Some("afterloaded-ends"),
        SupportKind::MassCentre | SupportKind::ClampedEnd | SupportKind::ClampedEnds => None,
    };
    for Springs { support, key, reason, advice } in SPRINGS {
        match (holder == Some(support), file.has(key), reason) {
            (true, false, Some(reason)) => {
                let problem = Problem::Missing { key, reason };
                return Err(("mechanics.support".to_owned(), problem));
            }
            (false, true, _) => return exclude("mechanics.support", key, advice),
            _ => {}
        }
    }
    let clamps =
        matches!(run.support, SupportKind::ClampedEnds | SupportKind::AfterloadedEnds { .. });
    if run.end_stretch != 1.0 && !clamps {
        let advice = "only clamped ends keep a cell stretched; give support = \"clamped-ends\" or \
                      \"afterloaded-ends\", or leave it out";
        return exclude("mechanics.support", "mechanics.end_stretch", advice);
    }
    if holder == Some("afterloaded-ends") && run.numerics.method.is_in_time() {
        let advice = "afterloaded ends need a quasi-static run; give integrator = \
                      \"quasi-static\", or --integrator quasi-static";
        return exclude("numerics.integrator", "mechanics.support", advice);
    }
    Ok(())
}

/// Checks the method: some settings exclude a quasi-static run, and others need one.
fn method(file: &RunFile, run: &Run) -> Checked {
    let viscous = run.material.retardation_time > 0.0;
    if run.numerics.method.is_in_time() {
        let advice = "integrated in time, a viscous cell would need steps of about 1e-6 ms; give integrator = \
                      \"quasi-static\", or --integrator quasi-static, or leave the retardation time out";
        if viscous {
            return exclude("numerics.integrator", "material.retardation_time", advice);
        }
        return Ok(());
    }
    if viscous && run.support.gives_way() {
        let advice = "the springs of the support would be viscous, too; choose another support, or leave the \
                      retardation time out";
        return exclude("mechanics.support", "material.retardation_time", advice);
    }
    let hindrances = [
        (
            run.material.area_law != AreaLaw::Gradient,
            "material.area_law",
            "this area law has no energy, so the tension does not determine the shape; use \
             area_law = \"gradient\", or integrator = \"verlet\"",
        ),
        (
            run.active == ActiveLaw::Ends,
            "mechanics.active",
            "loads on the ends act from outside the cell, so a quasi-static run cannot follow them; use \
             active = \"fibre\", or integrator = \"verlet\"",
        ),
        (
            run.numerics.engine.loops != Loops::Auto,
            "numerics.engine",
            "a quasi-static run does not use it; leave it out, or use integrator = \"verlet\"",
        ),
        (
            file.has("numerics.time_step"),
            "numerics.time_step",
            "a quasi-static run has no time step; leave it out, or use integrator = \"verlet\"",
        ),
    ];
    match hindrances.into_iter().find(|(stands, ..)| *stands) {
        None => Ok(()),
        Some((_, second, advice)) => exclude("integrator = \"quasi-static\"", second, advice),
    }
}

/// Checks the intervals: they must divide each other, and the records must not become too large.
fn times(run: &Run) -> Checked {
    let exchange = ("numerics.exchange_interval", run.numerics.exchange_interval);
    let output = ("numerics.output_interval", run.numerics.output_interval);
    let frame = ("numerics.frame_interval", run.numerics.frame_interval);
    let duration = ("run.duration", run.duration);
    for ((key, value), (unit_key, unit)) in
        [(output, exchange), (frame, output), (duration, exchange)]
    {
        if !divides(unit, value) {
            return Err((key.to_owned(), Problem::NotAMultiple { key, value, unit_key, unit }));
        }
    }
    let limits = [(output, "samples", MOST_SAMPLES), (frame, "shapes", MOST_FRAMES)];
    for ((key, value), what, most) in limits {
        let count = run.duration / value;
        if count > most {
            return Err((key.to_owned(), Problem::TooMany { key, value, count, what, most }));
        }
    }
    Ok(())
}
