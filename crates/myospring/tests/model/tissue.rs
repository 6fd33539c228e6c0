//! Tissue: cells that stimulate each other, against a separate program, closed forms and cells alone.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use myospring::analysis::value;
use myospring::cell::bueno_orovio_2008::{Variant, model};
use myospring::cell::integrator::CellIntegrator;
use myospring::cell::land_2017::Land2017;
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::{CellMethod, SolverSettings};
use myospring::cell::{CellModel, TensionKind};
use myospring::exchange::{
    Activation, ActivationBounds, ActivationError, ActivationTangent, Conduction, Coupling, Sites,
    StimulusPlace, StretchCurrent, StretchState, Tissue, TissueCells, TissueError,
};
use myospring::mechanics::Tension;
use myospring::mechanics::support::SupportKind;
use myospring::prelude::*;
use myospring::run_file::RunFile;
use std::sync::Arc;

/// That of human ventricles with the minimal models, um^2/ms.
const HUMAN: f64 = 1.171e5;

fn fixed(step_ms: f64) -> SolverSettings {
    SolverSettings { method: CellMethod::ForwardEuler, step_ms, ..SolverSettings::default() }
}

/// A strip whose left end is stimulated, or another side of it.
fn strip(
    variant: Variant,
    mesh: &Mesh,
    fibre: [f64; 2],
    conduction: &Conduction,
    step_ms: f64,
) -> Tissue {
    let model = model(variant);
    let beat = Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) };
    let protocol = |node: usize| if mesh.point(node)[0] < 620.0 { beat } else { Protocol::rest() };
    let protocols: Vec<Protocol> = (0..mesh.len()).map(protocol).collect();
    let fibres = vec![fibre; mesh.simplices.len()];
    let TensionKind::Relative { published_peak } = model.tension_kind() else { panic!("kPa") };
    let (scale, model) = (50.0 / published_peak, Arc::new(model));
    let cells =
        TissueCells { model, state: None, protocols: &protocols, settings: fixed(step_ms), scale };
    Tissue::new(mesh, &fibres, conduction, cells).unwrap()
}

/// When each node was first activated, ms.
fn activation(tissue: &Tissue) -> Vec<Option<f64>> {
    let beats = tissue.local_beats().unwrap();
    beats.iter().map(|beats| Some(beats.first()?.activated_ms)).collect()
}

/// Conduction velocity, cm/s, between a half and three quarters of a strip of this many nodes.
fn velocity(variant: Variant, spacing: f64, step_ms: f64, conduction: &Conduction) -> f64 {
    let columns = (10_000.0 / spacing) as usize;
    let mesh = lattice::rectangle(columns, 1, spacing).unwrap();
    let mut strip = strip(variant, &mesh, [1.0, 0.0], conduction, step_ms);
    strip.reach(25.0).unwrap();
    let activated = |column: usize| {
        let near = |node: &usize| (mesh.point(*node)[0] - column as f64 * spacing).abs() < 1e-6;
        activation(&strip)[(0..mesh.len()).find(near).unwrap()].unwrap()
    };
    let [from, to] = [columns / 2, 3 * columns / 4];
    0.1 * (to - from) as f64 * spacing / (activated(to) - activated(from))
}

#[test]
fn a_wave_across_the_fibres_is_slower_by_the_root_of_both() {
    let mesh = lattice::rectangle(120, 1, 100.0).unwrap();
    let conduction = Conduction { along: HUMAN, ..Conduction::even(0.5 * HUMAN) };
    let time = |fibre: [f64; 2], conduction: &Conduction| {
        // So short a step that all three spread by the same terms.
        let mut strip = strip(Variant::Epi, &mesh, fibre, conduction, 0.005);
        strip.reach(30.0).unwrap();
        let at = |x: f64| {
            let near = |node: &usize| (mesh.point(*node)[0] - x).abs() < 1e-6;
            activation(&strip)[(0..mesh.len()).find(near).unwrap()].unwrap()
        };
        at(9000.0) - at(6000.0)
    };
    let across = time([0.0, 1.0], &conduction);
    let same = time([1.0, 0.0], &Conduction::even(0.5 * HUMAN));
    // The strip is thin and its wave plane, so only what goes along it counts.
    assert!((across / same - 1.0).abs() < 1e-9, "{across} {same}");
    let along = time([1.0, 0.0], &conduction);
    assert!((across / along / 2.0_f64.sqrt() - 1.0).abs() < 0.06, "{across} {along}");
}

#[test]
fn cells_of_which_nothing_spreads_are_cells_alone_to_the_last_bit() {
    let mesh = lattice::rectangle(3, 2, 250.0).unwrap();
    let mut tissue = strip(Variant::Epi, &mesh, [1.0, 0.0], &Conduction::even(0.0), 0.02);
    let mut again = tissue.clone();
    for ms in 1..=100 {
        tissue.reach(f64::from(ms)).unwrap();
    }
    again.reach(100.0).unwrap();
    let model = model(Variant::Epi);
    let beat = Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) };
    let mut alone = CellIntegrator::new(Arc::new(model), beat, fixed(0.02)).unwrap();
    for ms in 1..=100 {
        alone.advance_to(f64::from(ms), 1.0, 0.0).unwrap();
    }
    let first = |tissue: &Tissue| tissue.potentials().next().unwrap();
    assert_eq!(first(&tissue), alone.state()[0]);
    assert_eq!(first(&again), alone.state()[0]);
    assert!(activation(&tissue)[0].is_some());
    // Those that are not stimulated rest.
    assert_eq!(activation(&tissue).iter().filter(|at| at.is_none()).count(), 3);
}

#[test]
fn steps_are_of_second_order_where_the_cell_is() {
    let mesh = lattice::rectangle(30, 1, 250.0).unwrap();
    let last = |step_ms: f64| {
        let mut strip = strip(Variant::Epi, &mesh, [1.0, 0.0], &Conduction::even(HUMAN), step_ms);
        strip.reach(12.0).unwrap();
        activation(&strip).into_iter().flatten().fold(0.0, f64::max)
    };
    // Forward Euler in the cell: first order.
    let [coarse, fine, finest] = [0.04, 0.02, 0.005].map(last);
    let ratio = (coarse - finest) / (fine - finest);
    assert!((1.8..3.2).contains(&ratio), "{coarse} {fine} {finest}: {ratio}");
}

#[test]
fn a_sheet_contracts_where_the_wave_has_passed_and_its_path_is_that_of_its_tension() {
    let mesh = lattice::rectangle(40, 10, 250.0).unwrap();
    let tissue = strip(Variant::Epi, &mesh, [1.0, 0.0], &Conduction::even(HUMAN), 0.05);
    let mut simulation =
        Simulation { activation: Some(Box::new(tissue)), duration: 150.0, ..Simulation::new(mesh) };
    simulation.numerics.method = Method::QuasiStatic;
    simulation.numerics.output_interval = 5.0;
    let outcome = simulation.build().unwrap().run(|_progress| true);
    assert_eq!(outcome.stop, None);
    let shortest =
        outcome.recording.samples.iter().map(|sample| sample.shortening_pct).fold(0.0, f64::max);
    assert!(shortest > 3.0, "{shortest} %");
}

#[test]
fn velocities_on_finer_lattices_come_closer_with_the_square_of_the_spacing() {
    let at = |spacing| velocity(Variant::Epi, spacing, 0.005, &Conduction::even(HUMAN));
    let [coarse, middle, fine] = [200.0, 100.0, 50.0].map(at);
    let ratio = (middle - coarse) / (fine - middle);
    assert!((3.2..4.8).contains(&ratio), "{coarse} {middle} {fine}: {ratio}");
}

/// The outcome of a run file on a strip of 5 x 1 mm, or what it says otherwise.
fn run(text: &str, files: &[(&str, &str)]) -> Outcome {
    const STRIP: &str = r#"{"type": "Polygon", "coordinates": [[[0, 0], [5000, 0], [5000, 1000], [0, 1000], [0, 0]]]}"#;
    let usual = "[cell]\nmodel = \"bueno_orovio_2008_epi\"\npeak_tension = \"5 kPa\"\n[shape]\noutline = \"strip.geojson\"\n\
                 spacing = \"125 um\"\n[material]\nyoung_modulus = \"20 kPa\"\narea_modulus = \"11.4 kPa\"\n";
    let run = RunFile::from_text(&format!("{usual}{text}")).unwrap().resolve().unwrap();
    let read = |file: &str| {
        let known = files.iter().chain(&[("strip.geojson", STRIP)]).find(|(name, _)| *name == file);
        Ok(known.unwrap().1.as_bytes().to_vec())
    };
    let shaped = run.shape.mesh(&run.shape.bytes(read).unwrap()).unwrap();
    let outcome = run.make(shaped, read).unwrap().simulation.build().unwrap().run(|_| true);
    assert_eq!(outcome.stop, None);
    outcome
}

/// A metric of the first beat.
fn metric(outcome: &Outcome, name: &str) -> f64 {
    outcome.beats()[0].value(name).unwrap()
}

#[test]
fn a_tissue_has_the_conduction_velocity_that_its_run_file_asks_for() {
    for velocity in [20.0, 50.0] {
        let text = format!(
            "[tissue]\nconduction_velocity = \"{velocity} cm/s\"\n[run]\nduration = \"100 ms\""
        );
        let outcome = run(&text, &[]);
        let found = metric(&outcome, "conduction_velocity");
        assert!((found / velocity - 1.0).abs() < 0.005, "{found} of {velocity} cm/s");
        assert_eq!(metric(&outcome, "activated_part"), 100.0);
        // While the wave runs, what it has reached is excited and the rest is not.
        let frames = &outcome.recording.frames;
        let behind = frames.iter().find(|frame| frame.t_ms >= 50.0 + 250.0 / velocity).unwrap();
        let potentials = behind.potential_mv.as_ref().unwrap();
        let [x, _] = &behind.positions;
        for (x, potential) in x.iter().zip(potentials) {
            assert!(*x > 1000.0 || *potential > -20.0, "{potential} mV at {x} um");
            assert!(*x < 4500.0 || *potential < -75.0, "{potential} mV at {x} um");
        }
        // The stimulated end is activated at once, the rest by the wave.
        let time = metric(&outcome, "activation_time");
        let whole = 500.0 / velocity;
        assert!((0.75 * whole..whole).contains(&time), "{time} of {whole} ms");
    }
}

#[test]
fn a_wave_is_slower_across_the_fibres_by_the_ratio_that_is_asked_for() {
    // Fibres across the strip, so that the wave along it goes across them.
    let text = "[tissue]\nconduction_velocity = \"60 cm/s\"\nvelocity_ratio = 2\n[mechanics]\nfibre = \"90 deg\"\n\
                [run]\nduration = \"100 ms\"";
    let found = metric(&run(text, &[]), "conduction_velocity");
    assert!((found / 30.0 - 1.0).abs() < 0.005, "{found} cm/s");
}

#[test]
fn what_a_wave_does_of_work_is_stored_and_given_back() {
    let text = "[tissue]\nconduction_velocity = \"50 cm/s\"\n[run]\nduration = \"200 ms\"";
    let energy = run(text, &[]).beats().energy;
    let of = |name: &str| value(&energy, name).unwrap();
    assert!(of("largest_stored_energy") > 1e5, "{} fJ", of("largest_stored_energy"));
    assert!(of("energy_gap").abs() < 0.5, "{} %", of("energy_gap"));
}

#[test]
fn no_wave_crosses_a_scar() {
    let scar =
        "x_um,y_um,conductivity\n500,500,1\n2300,500,1\n2500,500,0\n2700,500,1\n4500,500,1\n";
    let text = "[tissue]\nconduction_velocity = \"50 cm/s\"\nconductivity = \"scar.csv\"\n[run]\nduration = \"150 ms\"";
    let part = metric(&run(text, &[("scar.csv", scar)]), "activated_part");
    assert!((40.0..55.0).contains(&part), "{part} %");
}

#[test]
fn posts_are_springs_of_their_stiffness() {
    let tissue =
        "[tissue]\nconduction_velocity = \"50 cm/s\"\n[run]\nduration = \"200 ms\"\n[mechanics]\n";
    let posts = "support = \"posts\"\npost_length = \"6 mm\"\npost_width = \"1 mm\"\npost_modulus = \"1.6 MPa\"";
    let stiffness = 3.0 * 1600.0 * std::f64::consts::PI * 1e12 / 64.0 / 6000.0_f64.powi(3);
    let springs = format!("support = \"spring-held-ends\"\nend_stiffness = \"{stiffness} nN/um\"");
    let force = |support: &str| metric(&run(&format!("{tissue}{support}"), &[]), "peak_end_force");
    let [of_posts, of_springs] = [posts, &springs].map(force);
    assert!((of_posts / of_springs - 1.0).abs() < 1e-9, "{of_posts} {of_springs} nN");
    assert!(of_posts > 1000.0, "{of_posts} nN");
}

/// A given tension in each triangle, kPa.
#[derive(Clone)]
struct Given(Vec<f64>);

impl Activation for Given {
    fn sites(&self) -> Sites {
        Sites::PerElement(self.0.len())
    }

    fn advance(&mut self, _to_ms: f64, _now: StretchState<'_>) -> Result<(), ActivationError> {
        Ok(())
    }

    fn keep(&mut self) {}

    fn tension(&self) -> Tension<'_> {
        Tension::PerElement(&self.0)
    }

    fn tangent(&self) -> Option<ActivationTangent<'_>> {
        None
    }

    fn strongest(&self) -> ActivationBounds {
        let tension = self.0.iter().copied().fold(0.0, f64::max);
        ActivationBounds { tension, ..ActivationBounds::default() }
    }

    fn boxed(&self) -> Box<dyn Activation> {
        Box::new(self.clone())
    }
}

/// Positions along a strip of one row under a tension at each place, um.
fn at_rest(support: SupportKind, tension: impl Fn(f64) -> f64) -> Vec<f64> {
    let mesh = lattice::rectangle(80, 1, 100.0).unwrap();
    let tensions =
        mesh.simplices.iter().map(|triangle| tension(mesh.centre(triangle)[0])).collect();
    let lower: Vec<usize> = (0..mesh.len()).filter(|node| mesh.points[1][*node] == 0.0).collect();
    let mut simulation = Simulation {
        activation: Some(Box::new(Given(tensions))),
        duration: 1.0,
        support,
        ..Simulation::new(mesh)
    };
    simulation.numerics.method = Method::QuasiStatic;
    simulation.numerics.frame_interval = 0.5;
    let outcome = simulation.build().unwrap().run(|_| true);
    assert_eq!(outcome.stop, None);
    let positions = &outcome.recording.frames.last().unwrap().positions[0];
    lower.into_iter().map(|node| positions[node]).collect()
}

#[test]
fn a_strip_of_fixed_length_stretches_where_it_pulls_less_than_on_average() {
    // Weise and Panfilov: in a chain of fixed length each spring changes by (mean tension - own tension)/stiffness. Small tensions, so
    // that the stiffness is the same everywhere.
    let free = at_rest(SupportKind::MassCentre, |_| 0.1);
    let modulus = 0.1 / (1.0 - (free[80] - free[0]) / 8000.0);
    let bell = |x: f64| 0.1 * (-((x - 3000.0) / 800.0).powi(2)).exp();
    let held = at_rest(SupportKind::ClampedEnds, bell);
    // The clamps hold the outer twentieth, of which the strip between them knows nothing.
    let between = 4..76;
    let of = |column: usize| bell(100.0 * (column as f64 + 0.5));
    let mean = between.clone().map(of).sum::<f64>() / between.len() as f64;
    for column in between.start + 2..between.end - 2 {
        let stretch = (held[column + 1] - held[column]) / 100.0 - 1.0;
        let expected = (mean - of(column)) / modulus;
        let off = (stretch - expected).abs() / (0.1 / modulus);
        assert!(off < 0.005, "column {column}: {stretch} {expected}");
    }
}

#[test]
fn a_strip_between_two_springs_shortens_and_pulls_as_they_say() {
    // Small tensions: shortening T A/(k + K/2) and force T A (K/2)/(k + K/2) with the stiffness k of the strip and K of each spring.
    let free = at_rest(SupportKind::MassCentre, |_| 0.1);
    let alone = 8000.0 - (free[80] - free[0]);
    // T A = k times the free shortening; the thickness is 10 um.
    let pull = 0.1 * 100.0 * 10.0;
    let own = pull / alone;
    for stiffness in [0.1 * own, 0.5 * own, 2.0 * own] {
        let held = at_rest(SupportKind::SpringHeldEnds { stiffness }, |_| 0.1);
        // The springs hold the outer twentieth of the strip at either end, which shortens, too: the stiffer they are, the more of the
        // shortening is there.
        let shortening = 8000.0 - (held[80] - held[0]);
        let expected = pull / (own + 0.5 * stiffness);
        assert!((shortening / expected - 1.0).abs() < 0.1, "{stiffness}: {shortening} {expected}");
    }
}

/// A piece of tissue at rest whose fibres are held at a stretch, after some time: the potential of its first cell.
fn held(model: &Arc<dyn CellModel>, current: StretchCurrent, stretch: f64, to_ms: f64) -> f64 {
    let mesh = lattice::rectangle(3, 2, 250.0).unwrap();
    let protocols = vec![Protocol::rest(); mesh.len()];
    let cells = TissueCells {
        model: Arc::clone(model),
        state: None,
        protocols: &protocols,
        settings: fixed(0.02),
        scale: 1.0,
    };
    let triangles = mesh.simplices.len();
    let tissue = Tissue::new(&mesh, &vec![[1.0, 0.0]; triangles], &Conduction::even(HUMAN), cells);
    let mut tissue = tissue.unwrap().with_stretch_current(current);
    let (stretch, rate) = (vec![stretch; triangles], vec![0.0; triangles]);
    tissue.advance(to_ms, StretchState { stretch: &stretch, rate: &rate }).unwrap();
    tissue.potentials().next().unwrap()
}

#[test]
fn channels_that_stretch_opens_draw_the_potential_to_their_own() {
    let published = model(Variant::Epi);
    let mut parameters = published.parameters().clone();
    for name in ["tau_fi", "tau_o1", "tau_o2", "tau_so1", "tau_so2", "tau_si"] {
        parameters.set(name, 1e6).unwrap();
    }
    // Without currents of its own: u = E (1 - exp(-G (stretch - 1) t)), and u = 0 at -84 mV, 1 at 1.7 mV.
    let bare = published.with_parameters(parameters).unwrap();
    let current = StretchCurrent { conductance: 0.4, reversal_mv: -10.0 };
    let expected = (-10.0 + 84.0) / 85.7 * (1.0 - (-0.4_f64 * 0.1 * 12.0).exp());
    let found = held(&bare, current, 1.1, 12.0);
    assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
    // Shorter cells have none.
    assert_eq!(held(&bare, current, 0.9, 12.0), held(&bare, current, 1.0, 12.0));
}

#[test]
fn a_stretched_place_is_nearer_to_its_threshold_and_a_strong_stretch_excites_it() {
    let epi: Arc<dyn CellModel> = Arc::new(model(Variant::Epi));
    let reached = |conductance, stretch| {
        held(&epi, StretchCurrent { conductance, reversal_mv: -10.0 }, stretch, 60.0)
    };
    let (rest, nearer, excited) = (reached(0.5, 1.0), reached(0.05, 1.1), reached(2.0, 1.1));
    assert!(rest.abs() < 1e-9 && (0.001..0.13).contains(&nearer), "{rest} {nearer}");
    assert!(excited > 0.8, "{excited}");
}

#[test]
fn what_a_wave_stretches_ahead_of_it_is_nearer_to_its_threshold() {
    let strip = |conductance: &str| {
        let text = format!(
            "[tissue]\nconduction_velocity = \"20 cm/s\"\nstretch_conductance = \"{conductance}\"\n\
             [stimulus]\nstart = \"0 ms\"\n[mechanics]\nsupport = \"clamped-ends\"\n[run]\nduration = \"20 ms\"\n"
        );
        run(&text, &[])
    };
    let end = |outcome: &Outcome| -> Vec<f64> {
        let signals = &outcome.recording.signals;
        signals.iter().find(|signal| signal.name == "potential_end").unwrap().values.clone()
    };
    let (without, with) = (strip("0 mS/uF"), strip("0.5 mS/uF"));
    let rise = |outcome: &Outcome| end(outcome).into_iter().fold(f64::MIN, f64::max) + 84.0;
    let [without, with] = [rise(&without), rise(&with)];
    assert!(without.abs() < 0.1 && with > 0.5, "{without} mV, with feedback {with} mV");
}

/// A strip of human cells that feel their stretch, over its first 40 ms after the stimulus: shortening, per cent, and tension, kPa, at the
/// end.
fn of_human_cells(tissue: Option<Coupling>, support: SupportKind, exchange_ms: f64) -> [f64; 2] {
    let cell = myospring::cell::model("tor_ord_land").unwrap();
    let beat = Protocol { start_ms: 0.0, ..Protocol::once(cell.default_stimulus()) };
    let mut simulation = Simulation {
        tissue,
        protocol: beat,
        support,
        duration: 40.0,
        ..Simulation::new(lattice::rectangle(12, 2, 250.0).unwrap())
    };
    simulation.numerics.method = Method::QuasiStatic;
    // Usual in a tissue.
    if simulation.tissue.is_none() {
        simulation.numerics.cell = Some(SolverSettings::coupled(&*cell));
    }
    simulation.numerics.exchange_interval = exchange_ms;
    simulation.numerics.output_interval = 4.0;
    simulation.numerics.frame_interval = 4.0;
    simulation.cell = cell;
    let outcome = simulation.build().unwrap().run(|_| true);
    assert_eq!(outcome.stop, None);
    let end = outcome.recording.samples.last().unwrap();
    [end.shortening_pct, end.ta_kpa]
}

fn coupled(diffusion: f64, stimulated: StimulusPlace) -> Coupling {
    let conduction = Conduction::even(diffusion);
    Coupling { conduction, stimulated, s2_stimulated: stimulated, stretch_current: None }
}

#[test]
fn a_tissue_that_is_stimulated_everywhere_feels_its_stretch_as_one_cell_does() {
    let tissue = coupled(0.0, StimulusPlace::Everywhere);
    let [of_tissue, of_cell] =
        [Some(tissue), None].map(|tissue| of_human_cells(tissue, SupportKind::MassCentre, 0.5));
    assert!(of_cell[0] > 0.4, "{of_cell:?}");
    for (tissue, cell) in of_tissue.into_iter().zip(of_cell) {
        assert!((tissue / cell - 1.0).abs() < 1e-4, "{of_tissue:?} {of_cell:?}");
    }
}

#[test]
fn stretch_and_tension_of_a_wave_are_found_together_with_the_square_of_the_interval() {
    let tissue = || Some(coupled(2e4, StimulusPlace::End));
    let [long, short, shortest] = [4.0, 2.0, 1.0]
        .map(|exchange_ms| of_human_cells(tissue(), SupportKind::MassCentre, exchange_ms));
    let ratio = (long[0] - short[0]) / (short[0] - shortest[0]);
    assert!((3.0..6.0).contains(&ratio), "{long:?} {short:?} {shortest:?}: {ratio}");
}

#[test]
fn longer_sarcomeres_pull_harder_in_a_tissue_too() {
    let pull = |stretch: f64| {
        let cell = myospring::cell::model("tor_ord_land").unwrap();
        let mesh = lattice::rectangle(2, 1, 250.0).unwrap();
        let beat = Protocol { start_ms: 0.0, ..Protocol::once(cell.default_stimulus()) };
        let protocols = vec![beat; mesh.len()];
        let settings = SolverSettings::coupled(&*cell);
        let cells =
            TissueCells { model: cell, state: None, protocols: &protocols, settings, scale: 1.0 };
        let triangles = mesh.simplices.len();
        let fibres = vec![[1.0, 0.0]; triangles];
        let tissue = Tissue::new(&mesh, &fibres, &Conduction::even(HUMAN), cells).unwrap();
        let mut tissue = tissue.at_resting_stretch(&vec![stretch; triangles]).unwrap();
        tissue.reach(60.0).unwrap();
        tissue.tension().at(0)
    };
    let [usual, longer] = [1.0, 1.05].map(pull);
    assert!(longer > 1.1 * usual && usual > 1.0, "{usual} {longer} kPa");
}

#[test]
fn what_cannot_be_coupled_is_refused_with_the_reason() {
    let mesh = lattice::rectangle(3, 2, 250.0).unwrap();
    let fibres = vec![[1.0, 0.0]; mesh.simplices.len()];
    let protocols = vec![Protocol::rest(); mesh.len()];
    let even = || Conduction::even(HUMAN);
    let epi: Arc<dyn CellModel> = Arc::new(model(Variant::Epi));
    let new = |model: &Arc<dyn CellModel>, protocols: &[Protocol], conduction, settings| {
        let model = Arc::clone(model);
        let cells = TissueCells { model, state: None, protocols, settings, scale: 1.0 };
        Tissue::new(&mesh, &fibres, &conduction, cells).map(|_| ()).unwrap_err()
    };
    let land: Arc<dyn CellModel> = Arc::new(Land2017::published());
    let refused = new(&land, &protocols, even(), land.usual_settings()).to_string();
    assert!(refused.contains("land_2017") & refused.contains("no potential"), "{refused}");
    let refused = new(&epi, &protocols[1..], even(), fixed(0.02));
    assert_eq!(refused, TissueError::Count { what: "protocols", found: 11, expected: 12 });
    let negative = Conduction { across: -1.0, ..even() };
    let refused = new(&epi, &protocols, negative, fixed(0.02)).to_string();
    assert!(refused.contains("across the fibres is -1"), "{refused}");
    let adaptive = SolverSettings { method: CellMethod::Adaptive, ..fixed(0.02) };
    assert!(new(&epi, &protocols, even(), adaptive).to_string().contains("fixed steps"));
}
