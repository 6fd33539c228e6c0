//! Steps of many cells in vector registers.

use super::{Electrical, MinimalModel, Tension};
use crate::cell::cell_model::Together;

/// Cells of one piece of the loop, which fills vector registers.
const LANES: usize = 16;

impl Together for MinimalModel {
    fn euler(&self, states: &mut [&mut [f64]], stimuli: &[f64], step_ms: f64) {
        let [u, v, w, s, ta_i, ta] = states else {
            unreachable!("the minimal model has six state variables, not {}", states.len());
        };
        let states = [u, v, w, s, ta_i, ta].map(|values| &mut values[..stimuli.len()]);
        pulp::Arch::new().dispatch(Euler { model: self, states, stimuli, step_ms });
    }
}

/// A step, compiled for each kind of vector unit.
struct Euler<'a> {
    model: &'a MinimalModel,
    states: [&'a mut [f64]; 6],
    stimuli: &'a [f64],
    step_ms: f64,
}

impl pulp::WithSimd for Euler<'_> {
    type Output = ();

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "a call from here would lose the vector units")]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { model, states, stimuli, step_ms } = self;
        // Constants that are not behind a pointer stay in registers.
        let model = (model.electrical, model.tension);
        // Pieces of a known length are read without a call for each.
        let mut states = states.map(|values| values.as_chunks_mut::<LANES>());
        let (stimuli, last_stimuli) = stimuli.as_chunks::<LANES>();
        for (piece, stimulus) in stimuli.iter().enumerate() {
            let mut of = [[0.0; LANES]; 6];
            for (lanes, (pieces, _)) in of.iter_mut().zip(&states) {
                *lanes = pieces[piece];
            }
            step_of(model, &mut of, stimulus, step_ms);
            for (lanes, (pieces, _)) in of.iter().zip(&mut states) {
                pieces[piece] = *lanes;
            }
        }
        let padded = |values: &[f64]| {
            let mut lanes = [0.0; LANES];
            lanes[..values.len()].copy_from_slice(values);
            lanes
        };
        if !last_stimuli.is_empty() {
            let mut of = states.each_ref().map(|(_, rest)| padded(rest));
            step_of(model, &mut of, &padded(last_stimuli), step_ms);
            for (lanes, (_, rest)) in of.iter().zip(&mut states) {
                rest.copy_from_slice(&lanes[..rest.len()]);
            }
        }
    }
}

/// A step of some cells.
#[inline(always)]
#[allow(clippy::inline_always, reason = "a call would lose the vector units")]
fn step_of(
    (electrical, tension): (Electrical, Tension),
    of: &mut [[f64; LANES]; 6],
    stimulus: &[f64; LANES],
    step_ms: f64,
) {
    for lane in 0..LANES {
        let [u, v, w, s, ta_i, ta] = [0, 1, 2, 3, 4, 5].map(|at: usize| of[at][lane]);
        let [u_rate, v_rate, w_rate, s_rate] = electrical.rates(u, v, w, s);
        let [ta_i_rate, ta_rate] = tension.rates(u, ta_i, ta);
        of[0][lane] = u + step_ms * (u_rate + stimulus[lane]);
        of[1][lane] = v + step_ms * v_rate;
        of[2][lane] = w + step_ms * w_rate;
        of[3][lane] = s + step_ms * s_rate;
        of[4][lane] = ta_i + step_ms * ta_i_rate;
        of[5][lane] = ta + step_ms * ta_rate;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::bueno_orovio_2008::{self, Variant};
    use crate::cell::cell_model::CellModel as _;
    use crate::cell::coelho_2021;
    use crate::cell::description::Input;

    #[test]
    fn a_step_of_many_cells_is_that_of_each_to_the_last_bit() {
        for model in [coelho_2021::model(), bueno_orovio_2008::model(Variant::Epi)] {
            // 37 cells: a number that no register fills, with potentials on both sides of each threshold and on it.
            let theta_w = model.parameters().get("theta_w").unwrap();
            let at = |cell: usize, k: usize| ((cell * 7 + k * 5) % 37) as f64 / 37.0;
            let state = |cell: usize| -> [f64; 6] {
                let u = if cell == 3 { theta_w } else { 1.6 * at(cell, 0) - 0.1 };
                [u, at(cell, 1), at(cell, 2), at(cell, 3), 9.0 * at(cell, 4), at(cell, 5)]
            };
            let stimuli: Vec<f64> = (0..37).map(|cell| at(cell, 6)).collect();
            let mut states: Vec<Vec<f64>> =
                (0..6).map(|k| (0..37).map(|cell| state(cell)[k]).collect()).collect();
            let mut lists: Vec<&mut [f64]> = states.iter_mut().map(Vec::as_mut_slice).collect();
            model.euler(&mut lists, &stimuli, 0.02);
            for cell in 0..37 {
                let (before, mut rates) = (state(cell), [0.0; 6]);
                let input = Input { stimulus: stimuli[cell], ..Input::REST };
                model.derivatives(&before, &input, &mut rates);
                for k in 0..6 {
                    assert_eq!(states[k][cell], before[k] + 0.02 * rates[k], "{cell}, {k}");
                }
            }
        }
    }
}
