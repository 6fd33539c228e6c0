//! Every check in its quick form, and our side against numbers that LAMMPS and Myokit computed.
//!
//! `cargo xtask verify` makes the checks at full length and lets the other programs run.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

#[path = "../../crates/myospring/tests/common/skipped.rs"]
mod skipped;

use myospring::cell;
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::{SolverSettings, solve};
use myospring_verification::row::Verdict;
use myospring_verification::{Setting, checks, lammps, myokit, published_data};
use std::collections::BTreeMap;
use std::path::Path;

fn passes(name: &str) {
    let folder = tempfile::tempdir().unwrap();
    let data = published_data();
    let setting = Setting { quick: true, folder: folder.path(), data: &data };
    let check = checks().into_iter().find(|check| check.name == name).unwrap();
    let rows = (check.run)(&setting).unwrap();
    assert!(!rows.is_empty());
    for row in rows {
        if row.verdict == Verdict::Skipped {
            skipped::skipped(&row.reason);
        }
        assert_ne!(row.verdict, Verdict::Fail, "{row:#?}");
    }
}

#[test]
fn an_oscillator_has_its_closed_form() {
    passes("oscillator");
}

#[test]
fn a_strip_in_motion_converges_at_the_order_of_the_method() {
    if skipped::left_to_full() {
        return;
    }
    passes("time-order");
}

#[test]
fn a_hanging_chain_takes_the_shape_of_the_catenary() {
    passes("chain");
}

#[test]
#[ignore = "slow"]
fn a_wave_runs_along_a_strip_at_its_speed() {
    if skipped::left_to_full() {
        return;
    }
    passes("wave");
}

#[test]
fn a_wave_runs_through_tissue_as_fast_as_in_a_separate_program() {
    passes("tissue");
}

#[test]
fn a_block_deforms_homogeneously_whichever_way_it_lies() {
    passes("patch");
}

#[test]
fn lands_myofilaments_are_those_of_independent_programs() {
    passes("land");
}

#[test]
#[ignore = "slow"]
fn tor_ord_is_that_of_other_programs() {
    if skipped::left_to_full() {
        return;
    }
    passes("tor-ord");
}

#[test]
fn under_loads_a_cell_pulls_and_shortens_as_in_an_independent_program() {
    passes("loads");
}

#[test]
fn a_viscous_cell_is_as_much_slower_as_in_an_independent_program() {
    passes("viscosity");
}

#[test]
#[ignore = "slow"]
fn parts_that_differ_have_the_strain_of_a_finer_mesh() {
    if skipped::left_to_full() {
        return;
    }
    passes("parts");
}

#[test]
fn a_free_lattice_conserves_what_it_must() {
    passes("conservation");
}

#[test]
#[ignore = "slow"]
fn a_beat_balances_its_energy_and_feels_neither_mass_nor_step() {
    passes("beat");
}

#[test]
#[ignore = "slow"]
fn shortening_converges_with_the_lattice() {
    if skipped::left_to_full() {
        return;
    }
    passes("convergence");
}

#[test]
fn a_finite_element_twitch_is_met_in_time_and_explained_in_shape() {
    passes("finite-elements");
}

#[test]
fn sarcomeres_of_real_cells_lie_where_another_program_finds_them() {
    passes("sarcomeres");
}

#[test]
#[ignore = "slow"]
fn a_cell_in_a_film_moves_as_another_program_sees_it() {
    if skipped::left_to_full() {
        return;
    }
    passes("motion");
}

fn reference(name: &str) -> csv::Reader<std::fs::File> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference");
    csv::Reader::from_path(folder.join(name)).unwrap()
}

#[test]
fn a_small_lattice_moves_as_in_lammps_whatever_the_engine() {
    let mut positions: BTreeMap<String, Vec<[f64; 2]>> = BTreeMap::new();
    for row in reference("lammps.csv").deserialize() {
        let (case, _, x, y): (String, usize, f64, f64) = row.unwrap();
        positions.entry(format!("small, {case}")).or_default().push([x, y]);
    }
    for case in lammps::small_cases().unwrap() {
        let theirs = &positions[case.name];
        assert_eq!(theirs.len(), 15 * 7);
        for run in &case.runs {
            for (node, at) in theirs.iter().enumerate() {
                for axis in 0..2 {
                    let off = run.positions[axis][node] - at[axis];
                    // Spacing 1.5 um; rounding after 500 steps.
                    assert!(
                        off.abs() < 1.5e-9,
                        "{}, {}: node {node} off by {off} um",
                        case.name,
                        run.engine
                    );
                }
            }
        }
    }
}

#[test]
fn every_state_of_every_set_follows_the_solution_by_cvode() {
    let mut courses: BTreeMap<String, Vec<[f64; 7]>> = BTreeMap::new();
    for row in reference("myokit.csv").deserialize() {
        let (model, values): (String, [f64; 7]) = row.unwrap();
        courses.entry(model).or_default().push(values);
    }
    assert_eq!(courses.len(), 6);
    for (name, theirs) in &courses {
        let model = cell::model(name).unwrap();
        let protocol = Protocol::once(model.default_stimulus());
        let fixed = SolverSettings::default();
        let ways = [
            (fixed, myokit::error_per_ms(name) * fixed.step_ms),
            (model.usual_settings(), myokit::ADAPTIVE),
        ];
        for (settings, bound) in ways {
            let ours = solve(&*model, protocol, settings, 600.0, 10.0).unwrap();
            assert_eq!(ours.time_ms.len(), theirs.len());
            for (state, column) in ours.states.iter().enumerate() {
                let size = theirs.iter().map(|row| row[1 + state].abs()).fold(0.0, f64::max);
                for (value, row) in column.iter().zip(theirs) {
                    let off = (value - row[1 + state]) / size;
                    let variable = model.state_names()[state];
                    assert!(
                        off.abs() < bound,
                        "{name} by {}: {variable} at {} ms off by {off} of its size",
                        settings.method,
                        row[0]
                    );
                }
            }
        }
    }
}
