use super::*;
use crate::cell::batch::{run, run_while};
use crate::cell::description::Input;
use crate::cell::equation_model::{EquationModel, example};
use crate::cell::integrator::Steps;
use crate::cell::pacing::{Protocol, Stimulus};
use crate::cell::settings::{CellMethod, SolverSettings};
use crate::cell::tomek_2019::{Layer, TomekModel, Variant};

const SETTINGS: BatchSettings = every(1e-3, 1.7);

const fn every(tolerance: f64, interval_ms: f64) -> BatchSettings {
    let method = SolverSettings { tolerance, ..SolverSettings::of(CellMethod::Stiff) };
    BatchSettings { method, sample_interval_ms: Some(interval_ms) }
}

/// Every form and layer of the model, each paced in its own way.
fn cells() -> Vec<Paced> {
    let forms = [Variant::Land, Variant::Published, Variant::MovingChloride];
    let models = Layer::ALL.iter().flat_map(|layer| forms.map(|form| (*layer, form)));
    let cell = |(k, (layer, form)): (usize, (Layer, Variant))| {
        let k = k as f64;
        let mut parameters = crate::cell::tomek_2019::parameters(layer, form);
        parameters.set("G_Kr", 0.02 + 0.004 * k).unwrap();
        let model = TomekModel::new(layer, form, parameters).unwrap();
        let stimulus =
            if k == 4.0 { Stimulus::Jump { amplitude: 60.0 } } else { model.default_stimulus() };
        let protocol = Protocol {
            start_ms: 3.7 * k,
            cycle_length_ms: 250.0 + 9.0 * k,
            // A train of two, or an S1 and an S2.
            beats: if k % 2.0 == 0.0 { 2 } else { 1 },
            s2_interval_ms: (k % 2.0 != 0.0).then_some(250.0 + 9.0 * k),
            ..Protocol::once(stimulus)
        };
        Paced::new(Arc::new(model), protocol, 300.0 + 11.0 * k).unwrap()
    };
    models.enumerate().map(cell).collect()
}

#[test]
fn a_cell_has_the_same_bits_in_any_company_order_and_vector_units() {
    let cells = cells();
    let together = run(&cells, &SETTINGS).unwrap();
    assert!(together.iter().all(Result::is_ok));
    for (cell, expected) in cells.iter().zip(&together) {
        assert_eq!(&run(std::slice::from_ref(cell), &SETTINGS).unwrap()[0], expected);
    }
    // More cells than lanes, so that some take the place of others.
    let many: Vec<Paced> = cells.iter().rev().cycle().take(25).cloned().collect();
    let expected = together.iter().rev().cycle().take(25);
    assert!(run(&many, &SETTINGS).unwrap().iter().eq(expected));

    assert_eq!(by(pulp::Scalar::new(), &cells), together);
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = pulp::x86::V3::try_new() {
        assert_eq!(by(avx2, &cells), together);
    }
}

/// Equations as data, each cell with another threshold of its oscillator.
fn oscillators() -> Vec<Paced> {
    let model = EquationModel::new(example::fitzhugh(0.0)).unwrap();
    let cell = |k: i32| {
        let mut parameters = model.parameters().clone();
        parameters.set("membrane_z", 0.1 * f64::from(k)).unwrap();
        let protocol = Protocol {
            start_ms: 7.0 * f64::from(k),
            beats: 2,
            cycle_length_ms: 150.0,
            ..Protocol::once(model.default_stimulus())
        };
        let model = model.with_parameters(parameters).unwrap();
        Paced::new(model, protocol, 200.0 + 30.0 * f64::from(k)).unwrap()
    };
    (0..11).map(cell).collect()
}

#[test]
fn cells_of_equations_have_the_same_bits_alone_among_others_and_with_other_lanes() {
    let cells = oscillators();
    let together = run(&cells, &SETTINGS).unwrap();
    for (cell, expected) in cells.iter().zip(&together) {
        assert!(expected.is_ok());
        assert_eq!(&run(std::slice::from_ref(cell), &SETTINGS).unwrap()[0], expected);
    }
    let all: Vec<&Paced> = cells.iter().collect();
    let one =
        moved(&members::<EquationModel>(&all), &SETTINGS, &|| true, Lanes::<1>::try_step).unwrap();
    let five =
        moved(&members::<EquationModel>(&all), &SETTINGS, &|| true, Lanes::<5>::try_step).unwrap();
    assert_eq!((&one, &five), (&together, &together));
}

/// All cells to their end, with these vector units.
fn by<S: pulp::Simd>(simd: S, cells: &[Paced]) -> Vec<Result<CellOutcome, SolveError>> {
    let cells: Vec<&Paced> = cells.iter().collect();
    let members = members::<TomekModel>(&cells);
    moved(&members, &SETTINGS, &|| true, |it: &mut Lanes<LANES>| S::vectorize(simd, TryStep(it)))
        .unwrap()
}

#[test]
fn a_cell_beside_others_goes_the_way_of_one_that_stiff_steps_move_alone() {
    let beside = every(1e-5, 2.0);
    for form in [Variant::Land, Variant::Published, Variant::MovingChloride] {
        let model = TomekModel::published(Layer::Mid, form);
        let protocol =
            Protocol { start_ms: 5.0, beats: 2, ..Protocol::once(model.default_stimulus()) };
        let cell = Paced::new(Arc::new(model.clone()), protocol, 1200.0).unwrap();
        let outcome = run(&[cell], &beside).unwrap().remove(0).unwrap();
        let mut alone = Steps::new(&model, protocol, beside.method).unwrap();
        alone.hold();
        assert_eq!(outcome.samples.len(), 601);
        for (k, sample) in outcome.samples.iter().enumerate() {
            alone.advance_to(&model, 2.0 * k as f64, 1.0, 0.0).unwrap();
            let state = alone.state();
            let tension = model.tension(state, &Input::REST);
            // Other roundings, grown through two upstrokes of 250 mV/ms.
            assert!((sample.potential_mv.unwrap() - state[0]).abs() < 1e-7, "{form:?} {k}");
            assert!((sample.calcium_um.unwrap() - 1e3 * state[5]).abs() < 1e-9, "{form:?} {k}");
            assert!((sample.tension - tension).abs() < 1e-7, "{form:?} {k}");
        }
    }
}

#[test]
fn a_cell_that_goes_nowhere_has_its_error_and_leaves_the_others_alone() {
    let model = TomekModel::published(Layer::Endo, Variant::Published);
    let usual = Protocol::once(model.default_stimulus());
    let wild = Protocol { start_ms: 5.0, ..Protocol::once(Stimulus::Jump { amplitude: 1e300 }) };
    let cell = |protocol| Paced::new(Arc::new(model.clone()), protocol, 20.0).unwrap();
    let outcomes = run(&[cell(usual), cell(wild), cell(usual)], &SETTINGS).unwrap();
    assert!(matches!(outcomes[1], Err(SolveError::Stalled { .. })), "{:?}", outcomes[1]);
    assert!(outcomes[0].is_ok() && outcomes[0] == outcomes[2]);
    assert_eq!(outcomes[0], run(&[cell(usual)], &SETTINGS).unwrap()[0]);
}

#[test]
fn what_is_not_possible_is_refused_and_who_stops_it_is_heard() {
    let model = Arc::new(TomekModel::published(Layer::Endo, Variant::Land));
    let protocol = Protocol::once(model.default_stimulus());
    assert!(Paced::new(Arc::<TomekModel>::clone(&model), protocol, 0.0).is_err());
    let cells = [Paced::new(model, protocol, 1e5).unwrap()];
    assert!(run(&cells, &every(1.0, 1.7)).is_err());
    assert!(run(&cells, &every(1e-3, 0.0)).is_err());
    assert_eq!(run_while(&cells, &SETTINGS, &|| false).unwrap(), None);
}
