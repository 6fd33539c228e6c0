//! One implicit step: the method `RODAS` of `hairer_wanner_1996`, IV.7, with the coefficients of
//! its authors' program.
//!
//! Order 4 with a companion of order 3, L-stable, stiffly accurate, with a cubic between the ends that
//! holds for stiff variables, too. A step needs the Jacobian `J` of the rates `f`, one factorisation and six
//! solutions, and no iteration:
//! ```text
//! (I / (gamma h) - J) k_i = f(y + sum_j a_ij k_j) + sum_j c_ij / h k_j,   j < i
//! ```
//! The last stage is the error. The rates do not depend on time within a step.

use super::lu::Lu;
use crate::cell::cell_model::CellModel;
use crate::cell::description::Input;

pub(in crate::cell) const STAGES: usize = 6;
pub(in crate::cell) const GAMMA: f64 = 0.25;
pub(in crate::cell) const A: [&[f64]; STAGES] = [
    &[],
    &[1.544],
    &[0.946_678_528_081_582_6, 0.255_701_169_898_328_4],
    &[3.314_825_187_068_521, 2.896_124_015_972_201, 0.998_641_913_997_781_7],
    &[1.221_224_509_226_641, 6.019_134_481_288_629, 12.537_083_329_320_87, -0.687_886_036_105_895],
    &[
        1.221_224_509_226_641,
        6.019_134_481_288_629,
        12.537_083_329_320_87,
        -0.687_886_036_105_895,
        1.0,
    ],
];
pub(in crate::cell) const C: [&[f64]; STAGES] = [
    &[],
    &[-5.6688],
    &[-2.430_093_356_833_875, -0.206_359_915_709_191_5],
    &[-0.107_352_905_815_137_5, -9.594_562_251_023_355, -20.470_286_148_096_16],
    &[7.496_443_313_967_647, -10.246_804_314_643_52, -33.999_903_528_199_05, 11.708_908_932_061_6],
    &[
        8.083_246_795_921_522,
        -7.981_132_988_064_893,
        -31.521_594_328_743_71,
        16.319_305_431_231_36,
        -6.058_818_238_834_054,
    ],
];
/// Coefficients of the cubic between the ends.
pub(in crate::cell) const D: [[f64; 5]; 2] = [
    [
        10.126_235_083_445_86,
        -7.487_995_877_610_167,
        -34.800_918_615_557_47,
        -7.992_771_707_568_823,
        1.025_137_723_295_662,
    ],
    [
        -0.676_280_339_280_125_3,
        6.087_714_651_680_015,
        16.430_843_208_924_78,
        24.767_225_114_183_86,
        -6.594_389_125_716_872,
    ],
];

/// Workspace and result of one step.
#[derive(Debug, Clone)]
pub(super) struct Rosenbrock {
    rates: Vec<f64>,
    jacobian: Vec<f64>,
    lu: Lu,
    stages: [Vec<f64>; STAGES],
    trial: Vec<f64>,
    trial_rates: Vec<f64>,
}

impl Rosenbrock {
    /// Workspace for `variables` variables, of which `first` are eliminated first: those that
    /// depend on few others.
    pub(super) fn new(variables: usize, first: &[usize]) -> Self {
        let zeros = || vec![0.0; variables];
        Self {
            rates: zeros(),
            jacobian: vec![0.0; variables * variables],
            lu: Lu::new(variables, first),
            stages: std::array::from_fn(|_| zeros()),
            trial: zeros(),
            trial_rates: zeros(),
        }
    }

    /// Computes rates and Jacobian at the state where the next step begins; `sizes` are the sizes
    /// of the variables. If the model has no Jacobian, finite differences are used, with increments
    /// of the root of the machine precision.
    pub(super) fn begin(
        &mut self,
        model: &dyn CellModel,
        state: &[f64],
        input: &Input,
        sizes: &[f64],
    ) {
        model.derivatives(state, input, &mut self.rates);
        if model.jacobian(state, input, &mut self.jacobian) {
            return;
        }
        let variables = state.len();
        self.trial.copy_from_slice(state);
        for column in 0..variables {
            let moved = state[column] + f64::EPSILON.sqrt() * (sizes[column] + state[column].abs());
            let by = moved - state[column];
            self.trial[column] = moved;
            model.derivatives(&self.trial, input, &mut self.trial_rates);
            self.trial[column] = state[column];
            for row in 0..variables {
                self.jacobian[row * variables + column] =
                    (self.trial_rates[row] - self.rates[row]) / by;
            }
        }
    }

    /// The rates at the beginning of the step.
    pub(super) fn rates(&self) -> &[f64] {
        &self.rates
    }

    /// Tries one step; false if its equations cannot be solved.
    pub(super) fn try_step(
        &mut self,
        model: &dyn CellModel,
        state: &[f64],
        input: &Input,
        h: f64,
    ) -> bool {
        if !self.lu.factorise(1.0 / (GAMMA * h), &self.jacobian) {
            return false;
        }
        for stage in 0..STAGES {
            self.trial.copy_from_slice(state);
            for (weight, earlier) in A[stage].iter().zip(&self.stages) {
                add(&mut self.trial, *weight, earlier);
            }
            let (earlier, this) = self.stages.split_at_mut(stage);
            let this = &mut this[0];
            if stage == 0 {
                this.copy_from_slice(&self.rates);
            } else {
                model.derivatives(&self.trial, input, this);
            }
            for (weight, earlier) in C[stage].iter().zip(earlier) {
                add(this, weight / h, earlier);
            }
            self.lu.solve(this);
        }
        // End state: the last argument plus the last stage.
        add(&mut self.trial, 1.0, &self.stages[STAGES - 1]);
        true
    }

    /// End state of the step that was tried.
    pub(super) fn end(&self) -> &[f64] {
        &self.trial
    }

    /// The error of each variable there.
    pub(super) fn errors(&self) -> &[f64] {
        &self.stages[STAGES - 1]
    }

    /// The step that was tried as a curve from `start` to its end.
    pub(super) fn curve(&self, start: &[f64]) -> Curve {
        let bend = |weights: &[f64; 5]| {
            let mut sum = vec![0.0; start.len()];
            for (weight, stage) in weights.iter().zip(&self.stages) {
                add(&mut sum, *weight, stage);
            }
            sum
        };
        Curve { start: start.to_vec(), end: self.trial.clone(), bends: [bend(&D[0]), bend(&D[1])] }
    }
}

/// A step as a curve, of order 3.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    start: Vec<f64>,
    end: Vec<f64>,
    bends: [Vec<f64>; 2],
}

impl Curve {
    /// State at a fraction of the step, `0..=1`.
    pub(super) fn at(&self, x: f64) -> Vec<f64> {
        let rest = 1.0 - x;
        (0..self.start.len())
            .map(|i| {
                let bend = self.bends[0][i] + x * self.bends[1][i];
                rest * self.start[i] + x * (self.end[i] + rest * bend)
            })
            .collect()
    }
}

fn add(sum: &mut [f64], weight: f64, vector: &[f64]) {
    for (sum, value) in sum.iter_mut().zip(vector) {
        *sum += weight * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::coelho_2021;

    /// Where the equations are smooth: above every threshold of `u`.
    const STATE: [f64; 6] = [0.7, 0.1, 0.8, 0.4, 0.5, 0.2];

    /// Some ms in equal steps; the step is left tried.
    fn run(rosenbrock: &mut Rosenbrock, duration_ms: f64, steps: u32) -> Vec<f64> {
        let model = coelho_2021::model();
        let mut state = STATE.to_vec();
        for _ in 0..steps {
            rosenbrock.begin(&model, &state, &Input::REST, &[0.1; 6]);
            let step_ms = duration_ms / f64::from(steps);
            assert!(rosenbrock.try_step(&model, &state, &Input::REST, step_ms));
            state.copy_from_slice(rosenbrock.end());
        }
        state
    }

    fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn the_step_has_order_four_and_its_curve_order_three_on_nonlinear_equations() {
        let work = &mut Rosenbrock::new(6, &[]);
        let exact = run(work, 2.0, 256);
        let mut error = |steps| largest_difference(&run(work, 2.0, steps), &exact);
        let order = (error(32) / error(64)).log2();
        // The next term of the error is large: the order comes down to 4 from above, here 4.2.
        assert!((order - 4.0).abs() < 0.4, "{order}");

        let mut error = |step_ms: f64| {
            let end = run(work, step_ms, 1);
            let curve = work.curve(&STATE);
            assert_eq!([curve.at(0.0), curve.at(1.0)], [STATE.to_vec(), end]);
            largest_difference(&curve.at(0.5), &run(work, step_ms / 2.0, 64))
        };
        let order = (error(0.5) / error(0.25)).log2();
        // One step of order 3 errs as the fourth power.
        assert!((order - 4.0).abs() < 0.4, "{order}");
    }
}
