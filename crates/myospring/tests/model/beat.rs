//! Whole beats: the acceptance numbers of the default cell, convergence, and what stops a run.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

#[cfg(feature = "microscopy")]
use crate::common;

use myospring::analysis::{contraction, shape, trace, value};
use myospring::cell::pacing::Protocol;
use myospring::cell::{
    self, CellModel, Input, ModelError, StateVariable, Stimulation, TensionKind, solve, toy,
};
use myospring::integrate::Method;
use myospring::integrate::quasi_static::Tolerance;
use myospring::integrate::verlet::Integrator;
use myospring::mechanics::Vectors;
use myospring::mechanics::active::ActiveLaw;
use myospring::mechanics::material::{Material, Stiffness, default_material};
use myospring::mechanics::support::SupportKind;
use myospring::mesh::ends::{end_points, end_zones};
use myospring::mesh::{Mesh, built_in, lattice, quality};
use myospring::parameter::ParameterSet;
use myospring::recording::Sample;
use myospring::simulation::{Effort, Numerics, Outcome, SetupError, Simulation, StopReason};
use std::sync::Arc;

fn built_in_cell(angle: f64, spacing: Option<f64>) -> Mesh {
    let outline = built_in::adult_ventricular().rotated(angle);
    lattice::from_outline(&outline, spacing).unwrap().0
}

fn run(simulation: &Simulation) -> Outcome {
    simulation.prepare().unwrap().run(|_| true)
}

fn column(outcome: &Outcome, of: impl Fn(&Sample) -> f64) -> Vec<f64> {
    outcome.recording.samples.iter().map(of).collect()
}

/// Peak shortening, %, and its time, ms.
fn peak_shortening(outcome: &Outcome) -> trace::Point {
    trace::peak(&column(outcome, |s| s.t_ms), &column(outcome, |s| s.shortening_pct)).unwrap()
}

/// A quick twitch with a known tension, for questions of mechanics: peak 12 ms after the start.
pub(crate) fn quick_twitch(mesh: Mesh) -> Simulation {
    let mut parameters = toy::parameters();
    parameters.set("tau", 12.0).unwrap();
    let toy = toy::ToyModel::new(parameters).unwrap();
    Simulation {
        protocol: Protocol { start_ms: 0.0, ..Protocol::once(toy.default_stimulus()) },
        cell: Arc::new(toy),
        duration: 20.0,
        ..Simulation::new(mesh)
    }
}

#[test]
fn the_default_beat_shortens_by_twelve_per_cent_and_keeps_its_volume() {
    let outcome = run(&Simulation::new(built_in_cell(0.0, None)));
    assert_eq!(outcome.stop, None);
    let times = column(&outcome, |s| s.t_ms);
    let metrics = contraction::metrics(&times, &column(&outcome, |s| s.length_um), 50.0);
    let shortening = value(&metrics, "peak_shortening").unwrap();
    assert!((shortening - 12.0).abs() <= 0.2, "shortening {shortening} %");

    let widths = column(&outcome, |s| s.width_um);
    let widest = trace::peak(&times, &widths).unwrap().value / widths[0];
    let isovolumic = (1.0 - shortening / 100.0).powf(-0.5);
    assert!((widest / isovolumic - 1.0).abs() <= 0.01, "width {widest}, isovolumic {isovolumic}");

    let tension = trace::peak(&times, &column(&outcome, |s| s.ta_kpa)).unwrap();
    assert!((tension.value - 50.0).abs() < 0.01, "tension {} kPa", tension.value);
    assert!((tension.time - 171.5).abs() <= 0.5, "tension peaks at {} ms", tension.time);
    let lag = value(&metrics, "time_of_peak").unwrap() - tension.time;
    assert!((0.0..=1.0).contains(&lag), "shortening lags tension by {lag} ms");

    let last = outcome.recording.samples.last().unwrap();
    assert_eq!(last.t_ms, 600.0);
    assert!(last.shortening_pct.abs() < 0.1, "{} % short at 600 ms", last.shortening_pct);

    // The work of the active force is stored or dissipated: at each time, to 0.1 % of the largest.
    let largest = column(&outcome, |s| s.active_work_fj).into_iter().fold(0.0, f64::max);
    for s in &outcome.recording.samples {
        let balance =
            s.active_work_fj - s.elastic_energy_fj - s.kinetic_energy_fj - s.dissipated_energy_fj;
        assert!(
            balance.abs() < 1e-3 * largest,
            "{balance} fJ of {largest} missing at {} ms",
            s.t_ms
        );
    }
    // Internal forces give the free cell no momentum: 1e-9 of what its parts have is rounding.
    let fastest = column(&outcome, |s| s.kinetic_energy_fj).into_iter().fold(0.0, f64::max);
    for s in &outcome.recording.samples {
        assert!(
            s.momentum_nn_ms < 1e-9 * fastest.sqrt(),
            "{} nN ms at {} ms",
            s.momentum_nn_ms,
            s.t_ms
        );
        assert!(s.angular_momentum_nn_um_ms.abs() < 1e-7 * fastest.sqrt());
    }
    // The shape at the peak is kept.
    let frames = &outcome.recording.frames;
    assert!(frames.iter().any(|frame| (frame.t_ms - tension.time).abs() <= 0.5));
    assert!(frames.windows(2).all(|pair| pair[0].t_ms < pair[1].t_ms));
}

#[test]
fn a_cell_that_lies_aslant_shortens_along_its_own_axis() {
    let mesh = built_in_cell(35.0, Some(2.4));
    let axis = quality::long_axis(&mesh);
    assert!((axis[1].atan2(axis[0]).to_degrees() - 35.6).abs() < 1.0);
    let aslant = peak_shortening(&run(&quick_twitch(mesh)));
    let straight = peak_shortening(&run(&quick_twitch(built_in_cell(0.0, Some(2.4)))));
    assert!((aslant.value - straight.value).abs() < 0.3, "{aslant:?}, straight {straight:?}");
}

#[cfg(feature = "microscopy")]
#[test]
fn a_real_tear_drop_cell_beats_along_its_own_axis() {
    let Some(path) = common::shared_data("images/sarcgraph_e5_mask.png") else { return };
    let (mesh, _) = lattice::from_mask(&common::mask(path), Some(3.5)).unwrap();
    // Measured on the pixels with other software: 57.5 degrees, 110.9 um long.
    let axis = quality::long_axis(&mesh);
    assert!((axis[1].atan2(axis[0]).to_degrees() - 57.5).abs() < 1.5, "{axis:?}");
    assert!((quality::extent(&mesh, axis) - 110.9).abs() < 4.0);
    let outcome = run(&quick_twitch(mesh));
    assert_eq!(outcome.stop, None);
    let peak = peak_shortening(&outcome).value;
    assert!((peak - 12.0).abs() < 0.5, "{peak} %");
}

#[test]
fn halving_or_doubling_the_spacing_moves_the_peak_by_less_than_a_third_of_a_point() {
    let peaks = [0.6, 1.2, 2.4].map(|spacing| {
        let outcome = run(&quick_twitch(built_in_cell(0.0, Some(spacing))));
        assert_eq!(outcome.stop, None);
        peak_shortening(&outcome).value
    });
    for peak in peaks {
        assert!((peak - peaks[1]).abs() < 0.3, "{peaks:?} %");
    }
}

#[test]
fn half_the_mass_gives_the_same_beat() {
    let beat = |slowest_period: f64| {
        let material = Material { slowest_period: Some(slowest_period), ..default_material() };
        let mesh = built_in_cell(0.0, Some(2.4));
        let simulation = Simulation { material, ..Simulation::new(mesh) };
        peak_shortening(&run(&simulation))
    };
    let (heavy, light) = (beat(2.0), beat(2.0 * 0.5_f64.sqrt()));
    assert!((heavy.value / light.value - 1.0).abs() < 1e-3, "{heavy:?}, half the mass {light:?}");
}

/// Largest difference of the shortening in time from that along the path of equilibria, and the stated one, % of the peak.
fn lag(simulation: &Simulation) -> [f64; 2] {
    let path = simulation.run_quasi_static(Tolerance::default(), |_| true).unwrap();
    let motion = run(simulation);
    let pairs = path.recording.samples.iter().zip(&motion.recording.samples);
    let differences = pairs.map(|(a, b)| (a.shortening_pct - b.shortening_pct).abs());
    let peak = peak_shortening(&path).value;
    let Effort::Verlet { lag_pct: Some(stated), .. } = motion.effort else { panic!("no lag") };
    [100.0 * differences.fold(0.0, f64::max) / peak, stated]
}

#[test]
#[ignore = "slow"]
fn a_motion_lags_by_less_than_it_says_and_not_much_less() {
    for model in ["coelho_2021", "bueno_orovio_2008_epi", "bueno_orovio_2008_m"] {
        for support in [SupportKind::MassCentre, SupportKind::ClampedEnd] {
            for slowest_period in [None, Some(4.0)] {
                let mesh = built_in_cell(20.0, Some(4.0));
                let material = Material { slowest_period, ..default_material() };
                let cell = cell::model(model).unwrap();
                let simulation = Simulation { material, cell, support, ..Simulation::new(mesh) };
                let [lag, stated] = lag(&simulation);
                assert!(
                    lag < stated && stated < 3.0 * lag,
                    "{model}, {support:?}, {slowest_period:?}: {lag} %, stated {stated} %"
                );
            }
        }
    }
}

#[test]
fn the_masses_are_as_heavy_as_the_tension_allows() {
    let period = |change: fn(&mut Simulation)| {
        let mut simulation = Simulation::new(built_in_cell(0.0, Some(5.0)));
        change(&mut simulation);
        let outcome = simulation.prepare().unwrap().run(|progress| progress.time < 1.0);
        let Effort::Verlet { slowest_period_ms, .. } = outcome.effort else { panic!("in time") };
        slowest_period_ms.unwrap()
    };
    let usual = period(|_| ());
    assert!(usual > 4.0 && usual < 8.0, "{usual} ms");
    // Of a tension that rises faster, and of one that is not known before the run.
    assert_eq!(period(|it| it.cell = cell::model("bueno_orovio_2008_epi").unwrap()), 2.0);
    assert_eq!(period(|it| it.cell = cell::model("land_2017").unwrap()), 2.0);
    assert_eq!(period(|it| it.wave_speed = Some(50.0)), 2.0);
    // More drag, or one end that is held, lags more.
    let damped = period(|it| it.material.drag_ratio *= 2.0);
    assert!(damped > 2.0 && damped < 0.6 * usual, "{damped} ms");
    let held = period(|it| it.support = SupportKind::ClampedEnd);
    assert!(held < 0.6 * usual, "{held} ms");
    // Strong dashpots lag, too: by how much is not estimated.
    assert_eq!(period(|it| it.material.damping_ratio = 1.0), 2.0);
    // What is set is kept.
    assert_eq!(period(|it| it.material.slowest_period = Some(0.5)), 0.5);
}

#[test]
fn a_smaller_step_or_the_other_form_of_verlet_gives_the_same_beat() {
    let default = quick_twitch(built_in_cell(0.0, Some(2.4)));
    let reference = peak_shortening(&run(&default));
    let mut finer = quick_twitch(built_in_cell(0.0, Some(2.4)));
    finer.numerics.time_step = Some(0.5 * default.prepare().unwrap().time_step());
    let mut other = quick_twitch(built_in_cell(0.0, Some(2.4)));
    other.numerics.method = Method::Verlet(Integrator::VelocityVerlet);
    for (name, simulation) in [("half the step", finer), ("velocity Verlet", other)] {
        let peak = peak_shortening(&run(&simulation));
        assert!(
            (peak.value / reference.value - 1.0).abs() < 1e-5,
            "{name}: {peak:?}, {reference:?}"
        );
    }
}

#[test]
fn more_tension_shortens_more() {
    let peaks = [30.0, 40.0, 50.0].map(|peak_tension| {
        let mesh = built_in_cell(0.0, Some(2.4));
        peak_shortening(&run(&Simulation { peak_tension, ..quick_twitch(mesh) })).value
    });
    assert!(peaks[0] < peaks[1] && peaks[1] < peaks[2], "{peaks:?} %");
}

#[test]
fn the_same_beat_has_the_same_bits_from_any_thread() {
    let beat = || run(&quick_twitch(built_in_cell(10.0, Some(3.0))));
    let here = beat();
    let there: Vec<Outcome> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..3).map(|_| scope.spawn(beat)).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    assert!(there.iter().all(|outcome| outcome.recording == here.recording));
}

#[test]
fn a_cell_with_both_ends_clamped_does_not_shorten() {
    let mesh = built_in_cell(0.0, Some(2.4));
    let outcome = run(&Simulation { support: SupportKind::ClampedEnds, ..quick_twitch(mesh) });
    assert!(peak_shortening(&outcome).value < 1e-9);
    let tension = column(&outcome, |s| s.ta_kpa).into_iter().fold(0.0, f64::max);
    assert!(tension > 49.9);
}

#[test]
fn a_stubby_cell_shortens_under_end_loads_as_the_paper_has_them() {
    let mesh = lattice::rectangle(20, 10, 2.0).unwrap();
    let material = Material {
        stiffness: Stiffness::YoungModulus(400.0),
        area_modulus: 0.0,
        ..default_material()
    };
    let simulation = Simulation { active: ActiveLaw::Ends, material, ..quick_twitch(mesh) };
    // 13.07 % for the homogeneous lattice under a dead load of 50 kPa at 400 kPa.
    let peak = peak_shortening(&run(&simulation)).value;
    assert!((peak - 13.07).abs() < 0.02, "{peak} %");
}

#[test]
fn a_step_above_the_limit_is_refused_with_the_limit() {
    let mut simulation = quick_twitch(built_in_cell(0.0, Some(2.4)));
    simulation.numerics.time_step = Some(0.05);
    let Err(error) = simulation.prepare() else { panic!("0.05 ms was taken") };
    assert!(
        matches!(error, SetupError::UnstableStep { time_step: 0.05, limit, .. } if limit < 0.02)
    );
    assert!(error.to_string().contains("exceeds the stability limit"), "{error}");
}

#[test]
fn too_much_tension_stops_the_run_with_time_and_place_and_keeps_what_was_computed() {
    let mesh = built_in_cell(0.0, Some(2.4));
    let simulation = Simulation { peak_tension: 3e5, ..quick_twitch(mesh) };
    let outcome = run(&simulation);
    let stop = outcome.stop.unwrap();
    assert!(
        matches!(stop, StopReason::Inverted { time, .. } | StopReason::NotFinite { time, .. } if time > 0.0),
        "{stop:?}"
    );
    assert!(stop.to_string().contains("at t = "), "{stop}");
    assert!(!outcome.recording.samples.is_empty() && !outcome.recording.frames.is_empty());
    assert!(outcome.recording.samples.iter().all(|s| s.length_um.is_finite()));
}

#[test]
fn a_run_can_be_interrupted_and_keeps_what_it_has() {
    let simulation = quick_twitch(built_in_cell(0.0, Some(4.0)));
    let outcome = simulation.prepare().unwrap().run(|progress| progress.time < 5.0);
    assert_eq!(outcome.stop, Some(StopReason::Interrupted { time: 5.0 }));
    assert_eq!(outcome.recording.samples.last().unwrap().t_ms, 5.0);
}

/// A cell model that fails on purpose.
struct Failing {
    inner: toy::ToyModel,
}

impl CellModel for Failing {
    fn name(&self) -> &'static str {
        "failing"
    }
    fn description(&self) -> &'static str {
        "becomes NaN once the cell has shortened"
    }
    fn parameters(&self) -> &ParameterSet {
        self.inner.parameters()
    }
    fn with_parameters(&self, _: ParameterSet) -> Result<Arc<dyn CellModel>, ModelError> {
        Ok(Arc::new(Self { inner: self.inner.clone() }))
    }
    fn states(&self) -> &[StateVariable] {
        self.inner.states()
    }
    fn derivatives(&self, state: &[f64], input: &Input, rates: &mut [f64]) {
        self.inner.derivatives(state, input, rates);
        if input.stretch < 0.95 {
            rates[0] = f64::NAN;
        }
    }
    fn stimulation(&self) -> Stimulation {
        self.inner.stimulation()
    }
    fn potential(&self, state: &[f64]) -> Option<f64> {
        self.inner.potential(state)
    }
    fn membrane_potential_mv(&self, state: &[f64]) -> Option<f64> {
        self.inner.membrane_potential_mv(state)
    }
    fn tension(&self, state: &[f64], input: &Input) -> f64 {
        self.inner.tension(state, input)
    }
    fn tension_kind(&self) -> TensionKind {
        self.inner.tension_kind()
    }
    fn feels_stretch(&self) -> bool {
        true
    }
}

#[test]
fn the_cell_model_feels_the_stretch_and_its_failure_stops_the_run() {
    let mut parameters = toy::parameters();
    parameters.set("tau", 12.0).unwrap();
    let inner = toy::ToyModel::new(parameters).unwrap();
    let cell = Arc::new(Failing { inner });
    let outcome = run(&Simulation { cell, ..quick_twitch(built_in_cell(0.0, Some(4.0))) });
    let Some(StopReason::CellModel { cause }) = outcome.stop else {
        panic!("{:?}", outcome.stop);
    };
    assert!(cause.contains("ms"), "{cause}");
    let last = outcome.recording.samples.last().unwrap();
    assert!(last.shortening_pct > 4.0 && last.t_ms < 12.0, "{last:?}");
}

#[test]
fn every_model_of_the_list_can_drive_the_mesh() {
    for model in cell::models() {
        let name = model.name().to_owned();
        let relative = model.tension_kind().published_peak().is_some();
        let has_tension = model.tension_kind() != TensionKind::None;
        let mut simulation = Simulation {
            protocol: Protocol::once(model.default_stimulus()),
            ..Simulation::new(built_in_cell(0.0, Some(5.0)))
        };
        simulation.cell = model;
        if !has_tension {
            let error = simulation.build().err().unwrap().to_string();
            assert!(error.contains("has no tension"), "{error}");
            continue;
        }
        let outcome = run(&simulation);
        assert_eq!(outcome.stop, None, "{name}");
        let peak = peak_shortening(&outcome).value;
        // Tension that is scaled has the peak for which the cell shortens by 12 %; one in kPa has its own.
        assert!(if relative { (peak - 12.0).abs() < 0.1 } else { peak > 0.0 }, "{name}: {peak} %");
    }
}

#[test]
fn the_tension_of_a_run_given_again_makes_the_same_curve() {
    use myospring::cell::given_tension::{GivenTension, TensionClock, TensionCourse};
    for model in ["coelho_2021", "land_2017"] {
        let mut simulation = Simulation::new(lattice::rectangle(20, 4, 5.0).unwrap());
        simulation.cell = cell::model(model).unwrap();
        simulation.protocol = Protocol {
            cycle_length_ms: 700.0,
            beats: 2,
            ..Protocol::once(simulation.cell.default_stimulus())
        };
        simulation.duration = 1400.0;
        let along = |simulation: &Simulation| {
            simulation.run_quasi_static(Tolerance::default(), |_| true).unwrap()
        };
        let first = along(&simulation);
        let samples = &first.recording.samples;
        let times: Vec<f64> = samples.iter().map(|sample| sample.t_ms).collect();
        let tensions: Vec<f64> = samples.iter().map(|sample| sample.ta_kpa).collect();
        let course = TensionCourse::new(&times, &tensions).unwrap();
        let given = GivenTension::example().with_course(course, TensionClock::Run);
        simulation.cell = Arc::new(given);
        let again = along(&simulation);
        let of_path = |outcome: &Outcome| {
            let Effort::QuasiStatic { interpolation_error_um, .. } = outcome.effort else {
                panic!("{:?}", outcome.effort)
            };
            interpolation_error_um
        };
        let of_paths = of_path(&first) + of_path(&again);
        assert!(of_paths < 1e-4, "{of_paths} um");
        assert_eq!(again.recording.samples.len(), samples.len(), "{model}");
        for (one, other) in samples.iter().zip(&again.recording.samples) {
            // Samples are rows, so no tension is interpolated; paths to different peaks have different knots.
            let off = (one.length_um - other.length_um).abs();
            assert!(off < 1e-9 + of_paths, "{model}, {} ms: {off} um", one.t_ms);
        }
        assert_eq!(again.beats().len(), 2, "stimuli mark the beats");
    }
}

/// `coelho_2021` with another `tau_si` (ms), along its equilibria.
fn with_tau_si(tau_si: f64) -> Simulation {
    let published = cell::model("coelho_2021").unwrap();
    let mut parameters = published.parameters().clone();
    parameters.set("tau_si", tau_si).unwrap();
    let simulation = Simulation::new(built_in_cell(0.0, Some(5.0)));
    let numerics = Numerics { method: Method::QuasiStatic, ..simulation.numerics.clone() };
    let cell = published.with_parameters(parameters).unwrap();
    Simulation { cell, numerics, ..simulation }
}

/// Peak of the dimensionless tension of the published `coelho_2021`.
fn coelho_2021_peak() -> f64 {
    cell::model("coelho_2021").unwrap().tension_kind().published_peak().unwrap()
}

#[test]
fn a_changed_parameter_changes_the_strength_of_the_cell() {
    let published = coelho_2021_peak();
    let beats = [1.4, 1.76816, 2.4].map(|tau_si| {
        let simulation = with_tau_si(tau_si);
        let own = solve::reference_beat(&*simulation.cell, simulation.cell_settings()).unwrap();
        let finished = simulation.build().unwrap().run(|_| true);
        assert_eq!(finished.stop, None);
        let samples = &finished.recording.samples;
        let largest = |of: fn(&Sample) -> f64| samples.iter().map(of).fold(0.0, f64::max);
        let (tension, shortening) = (largest(|s| s.ta_kpa), largest(|s| s.shortening_pct));
        // Samples every 0.5 ms miss a flat peak by less than 1e-4.
        let expected = 50.0 * own.peak_tension / published;
        assert!((tension / expected - 1.0).abs() < 1e-4, "{tau_si} ms: {tension}, {expected} kPa");
        [tension, shortening]
    });
    assert!((beats[1][0] - 50.0).abs() < 0.02 && (beats[1][1] - 12.0).abs() < 0.1, "{beats:?}");
    for k in 0..2 {
        let apart = |a: [f64; 2], b: [f64; 2]| (a[k] / b[k] - 1.0).abs() > 0.01;
        assert!(apart(beats[0], beats[1]) && apart(beats[1], beats[2]), "{beats:?}");
    }
}

#[test]
fn the_time_step_of_a_strong_cell_is_stable_at_its_own_peak() {
    let strong = with_tau_si(1.0);
    let own = solve::reference_beat(&*strong.cell, strong.cell_settings()).unwrap();
    let ratio = own.peak_tension / coelho_2021_peak();
    let stated =
        Simulation { peak_tension: 50.0 * ratio, ..Simulation::new(built_in_cell(0.0, Some(5.0))) };
    // With masses as heavy.
    let [strong, stated] = [strong, stated].map(|mut simulation| {
        simulation.material.slowest_period = Some(2.0);
        simulation
    });
    let (a, b) = (strong.prepare().unwrap().limit, stated.prepare().unwrap().limit);
    assert!(ratio > 1.02 && a.time_step == b.time_step, "{ratio}, {a:?}, {b:?}");
}

#[test]
fn a_cell_that_swings_about_its_clamped_end_is_as_wide_as_a_free_one() {
    let change = |support: SupportKind| {
        let simulation = Simulation::new(built_in_cell(0.0, Some(2.5)));
        let [x, y] = simulation.long_axis;
        let (sine, cosine) = 20.0_f64.to_radians().sin_cos();
        let fibre = [cosine * x - sine * y, sine * x + cosine * y];
        let fibres = vec![fibre; simulation.mesh.simplices.len()];
        // The swing of a clamped cell is slow; half the period keeps it along its equilibria.
        let material = Material { slowest_period: Some(1.0), ..simulation.material.clone() };
        let simulation = Simulation { fibres, support, material, ..simulation };
        let equilibria = simulation.equilibria(&[50.0], Tolerance::default()).unwrap();
        let [rest, peak] = equilibria.follow(&[[0.0, 0.0], [1.0, 50.0]]).unwrap()[..] else {
            panic!("two answers");
        };
        let [_, upper] = end_points(&simulation.mesh.points, [x, y]);
        let mean = |positions: &Vectors| {
            let areas = &simulation.mesh.areas;
            let total: f64 = upper.iter().map(|&node| areas[node]).sum();
            let along = |node: usize| positions[0][node] * x + positions[1][node] * y;
            upper.iter().map(|&node| areas[node] * along(node)).sum::<f64>() / total
        };
        let [held, _] = end_zones(&simulation.mesh, [x, y]);
        let (mesh, now) = (&simulation.mesh.points, equilibria.positions(50.0).unwrap());
        // What is not held is stretched as it is from the clamp to the middle of the free end.
        let stretch = (mean(&now) - held[1]) / (mean(mesh) - held[1]);
        let depth = held[1] - held[0];
        let length = depth + stretch * (shape::extent(mesh, [x, y]) - depth);
        (peak.width_um / rest.width_um - 1.0, peak.length_um, length)
    };
    let (free, ..) = change(SupportKind::MassCentre);
    let (clamped, measured, along_the_axis) = change(SupportKind::ClampedEnd);
    // What the clamp keeps from widening is a twentieth of the length; without the turn it is 41 %.
    assert!((clamped - free).abs() < 0.005, "free {free}, clamped {clamped}");
    // Rounding.
    assert!((measured - along_the_axis).abs() < 1e-9, "{measured}, {along_the_axis}");
}

#[test]
fn a_train_of_beats_repeats_itself() {
    let model = cell::model("bueno_orovio_2008_epi").unwrap();
    let simulation = Simulation {
        protocol: Protocol {
            beats: 3,
            cycle_length_ms: 500.0,
            ..Protocol::once(model.default_stimulus())
        },
        cell: model,
        duration: 1550.0,
        ..Simulation::new(built_in_cell(0.0, Some(5.0)))
    };
    let outcome = run(&simulation);
    let (times, shortening) =
        (column(&outcome, |s| s.t_ms), column(&outcome, |s| s.shortening_pct));
    let peaks: Vec<f64> = [50.0, 550.0, 1050.0]
        .iter()
        .map(|start| {
            let (times, values) = trace::window(&times, &shortening, *start, start + 500.0);
            trace::peak(times, values).unwrap().value
        })
        .collect();
    assert!((peaks[2] / peaks[1] - 1.0).abs() < 0.02, "{peaks:?} %");
}
