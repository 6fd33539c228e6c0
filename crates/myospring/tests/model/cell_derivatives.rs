//! Rates of every model against independent values, in units of epsilon.
//!
//! The table was computed once with mpmath 1.x at 50 digits by a script written from Eqs. (18)-(35)
//! of `coelho_2021`, or those of `land_2017`, and a second typing of the parameters, not from our code. Each entry: state
//! (u, v, w, s, `Ta_i`, Ta), its six rates, and for each rate the sum of the sizes of the terms that
//! it adds up, which is what rounding scales with. The states are the initial one, one in each
//! interval between the thresholds, two near the peak of u, and one at u = `theta_w` exactly, where
//! H = 1/2.

use myospring::cell::{self, Input};

type Entry = (&'static [f64], &'static [f64], &'static [f64]);

const REFERENCE: &[(&str, &[Entry])] = include!("../reference/cell_derivatives.in");

#[test]
fn rates_equal_independent_values_within_a_few_epsilon() {
    let mut worst = 0.0_f64;
    for (name, entries) in REFERENCE {
        let model = cell::model(name).unwrap();
        for (start, expected) in model.initial_state().iter().zip(entries[0].0) {
            // Systems round a power in their own way.
            assert!((start - expected).abs() <= 4.0 * f64::EPSILON * expected.abs(), "{name}");
        }
        for (state, expected, scale) in *entries {
            let mut rates = vec![f64::NAN; state.len()];
            model.derivatives(state, &Input::REST, &mut rates);
            for i in 0..state.len() {
                let error = (rates[i] - expected[i]).abs();
                let unit = f64::EPSILON * scale[i].max(f64::MIN_POSITIVE);
                worst = worst.max(error / unit);
                // tanh and exp are within 1 epsilon, a rate has fewer than ten roundings.
                assert!(
                    error <= 8.0 * unit,
                    "{name}: rate of {} at {state:?}: {} instead of {}, {:.1} epsilon",
                    model.state_names()[i],
                    rates[i],
                    expected[i],
                    error / unit
                );
            }
        }
    }
    assert!(worst > 0.0, "the comparison compares nothing");
}

#[test]
fn all_models_but_the_toy_have_reference_rates() {
    let with_reference: Vec<&str> = REFERENCE.iter().map(|entry| entry.0).collect();
    for model in cell::models() {
        assert!(
            // Those of ToR-ORd stand in tor_ord.rs.
            with_reference.contains(&model.name())
                || model.name().starts_with("tor_ord")
                || model.name() == "toy_alpha"
                // It has no rates.
                || model.states().is_empty(),
            "{} has no independent rates",
            model.name()
        );
    }
}
