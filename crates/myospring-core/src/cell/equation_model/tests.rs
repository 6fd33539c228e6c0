use super::example::{self, Builder};
use super::*;
use crate::cell::equations::{BinaryOperation, Expression, Node, UnaryOperation};
use crate::cell::pacing::Protocol;
use crate::cell::solve::solve;
use crate::cell::tape::graph::{Graph, Id, Outer, Two};

use crate::testing::cell_model::check_cell_model_with;
use proptest::prelude::*;

fn model(equations: Equations) -> EquationModel {
    EquationModel::new(equations).unwrap()
}

#[test]
fn models_from_equations_hold_to_the_promises_of_every_cell_model() {
    for equations in [example::decay(), example::fitzhugh(0.0), example::fitzhugh(0.5)] {
        let model: Arc<dyn CellModel> = Arc::new(model(equations));
        check_cell_model_with(&model, model.usual_settings());
    }
}

#[test]
fn a_gate_is_found_by_its_equation() {
    let decay = model(example::decay());
    assert!(decay.gates().is_empty(), "the potential itself is no gate");
    // w of the oscillator: linear in itself, and otherwise the potential alone.
    let fitzhugh = model(example::fitzhugh(0.5));
    assert_eq!(fitzhugh.gates(), [1]);
    let mut gates = [Gate::default()];
    fitzhugh.write_gates(&[0.4, 0.2], &Input::REST, &mut gates);
    // tau dw/dt = v + a - b w: w_inf = (v + a) / b, tau / b with 10 ms per unit of time
    assert!((gates[0].steady_state - 1.1 / 0.8).abs() < 1e-14);
    assert!((gates[0].time_constant_ms - 12.5 * 10.0 / 0.8).abs() < 1e-11);
}

/// `dV/dt = 1` below and -1 above -30 mV, with the stimulus.
fn sliding() -> Equations {
    let mut builder = Builder::new("sliding");
    let v = builder.state("membrane.V", "mV", -80.0);
    let [threshold, one, minus] = [-30.0, 1.0, -1.0].map(|number| builder.number(number));
    let below = builder.two(BinaryOperation::Less, v, threshold);
    let rate = builder.node(Node::Select(below, one, minus));
    let stimulus = builder.node(Node::Stimulus);
    let sum = builder.two(BinaryOperation::Add, rate, stimulus);
    builder.rate(0, sum);
    builder.done()
}

#[test]
fn a_potential_that_slides_along_a_threshold_is_noticed_and_takes_fixed_steps() {
    let model = model(sliding());
    assert!(model.jumps() && model.side_by_side().is_none());
    assert!(!super::tests::model(example::decay()).jumps());
    let protocol = Protocol::once(model.default_stimulus());
    let trace = solve(&model, protocol, model.usual_settings(), 200.0, 1.0).unwrap();
    assert!((trace.states[0].last().unwrap() + 30.0).abs() < 0.02);
}

#[test]
fn a_file_without_calcium_cannot_take_myofilaments() {
    let error = EquationModel::with_myofilaments(example::decay()).unwrap_err().to_string();
    assert!(error.contains("has no calcium"), "{error}");
}

/// A membrane with calcium that follows the potential, in mM.
fn with_calcium() -> Equations {
    let mut builder = Builder::new("calcium");
    let v = builder.state("membrane.V", "mV", -80.0);
    let ca = builder.state("calcium.Ca", "mM", 5e-5);
    let rest = builder.constant("membrane.rest", -80.0);
    let off = builder.two(BinaryOperation::Subtract, rest, v);
    let slow = builder.number(0.02);
    let leak = builder.two(BinaryOperation::Multiply, slow, off);
    let stimulus = builder.node(Node::Stimulus);
    let sum = builder.two(BinaryOperation::Add, leak, stimulus);
    builder.rate(0, sum);
    let gain = builder.number(-2e-5);
    let aim = builder.two(BinaryOperation::Multiply, gain, off);
    let low = builder.number(5e-5);
    let aim = builder.two(BinaryOperation::Add, aim, low);
    let missing = builder.two(BinaryOperation::Subtract, aim, ca);
    let follow = builder.two(BinaryOperation::Multiply, slow, missing);
    builder.rate(1, follow);
    builder.stimulus(100.0, 1.0, "mV/ms");
    let mut equations = builder.done();
    equations.roles.calcium = Some(crate::cell::equations::CalciumRole {
        variable: crate::cell::equations::Variable::State(1),
        micromolar: 1e3,
        found: crate::cell::equations::Found::User,
    });
    equations
}

#[test]
fn myofilaments_on_calcium_are_those_of_land_2017_and_hold_to_every_promise() {
    let model = EquationModel::with_myofilaments(with_calcium()).unwrap();
    let plain = Myofilaments::published();
    let state = [-75.0, 4e-4, 0.03, 0.05, 0.4, 0.8, 0.1, -0.2];
    let input = Input { stretch: 0.95, stretch_rate: -2e-4, ..Input::REST };
    let mut rates = [0.0; 8];
    model.derivatives(&state, &input, &mut rates);
    let six = [0.03, 0.05, 0.4, 0.8, 0.1, -0.2];
    for (rate, expected) in rates[2..].iter().zip(plain.rates(&six, 0.4, 0.95, -2e-4)) {
        // Other order of the same operations.
        assert!((rate - expected).abs() < 1e-14 * (1.0 + expected.abs()), "{rate} {expected}");
    }
    assert_eq!(model.tension(&state, &input), plain.tension(&six, 0.95));
    assert_eq!(model.filaments().map(|filaments| filaments.first), Some(2));
    let model: Arc<dyn CellModel> = Arc::new(model);
    check_cell_model_with(&model, model.usual_settings());
}

/// The expression of some random numbers, over two states, a constant and the stimulus.
fn expression(builder: &mut Builder, leaves: &[Expression], recipe: &[u8]) -> Expression {
    use BinaryOperation as B;
    use UnaryOperation as U;
    let mut stack = leaves.to_vec();
    for pair in recipe.chunks_exact(3) {
        let pick = |byte: u8| stack[byte as usize % stack.len()];
        let (a, b) = (pick(pair[1]), pick(pair[2]));
        let node = match pair[0] % 24 {
            0 | 1 => Node::Binary(B::Add, a, b),
            2 | 3 => Node::Binary(B::Subtract, a, b),
            4 | 5 => Node::Binary(B::Multiply, a, b),
            6 | 7 => Node::Binary(B::Divide, a, b),
            8 => Node::Binary(B::Power, a, b),
            9 => Node::Binary(B::Minimum, a, b),
            10 => Node::Binary(B::Maximum, a, b),
            11 => Node::Binary(B::Remainder, a, b),
            12 => Node::Binary(B::Less, a, b),
            13 => Node::Binary(B::GreaterOrEqual, a, b),
            14 => Node::Binary(B::And, a, b),
            15 => Node::Unary(U::Negative, a),
            16 => Node::Unary(U::Exponential, a),
            17 => Node::Unary(U::Logarithm, a),
            18 => Node::Unary(U::SquareRoot, a),
            19 => Node::Unary(U::Absolute, a),
            20 => Node::Unary(U::HyperbolicTangent, a),
            21 => Node::Unary(U::Logarithm10, a),
            22 => Node::Unary(U::Not, a),
            _ => Node::Select(a, b, leaves[0]),
        };
        stack.push(builder.node(node));
    }
    stack[stack.len() - 1]
}

fn random(recipe: &[u8]) -> (Equations, Vec<Expression>) {
    let mut builder = Builder::new("random");
    let leaves = [
        builder.state("a.x", "", 0.3),
        builder.state("a.y", "", -1.7),
        builder.constant("a.c", 2.0),
        builder.number(3.0),
        builder.number(0.5),
        builder.node(Node::Stimulus),
    ];
    let root = expression(&mut builder, &leaves, recipe);
    let stimulus = builder.two(BinaryOperation::Add, leaves[0], leaves[5]);
    builder.rate(0, stimulus);
    builder.rate(1, root);
    (builder.done(), leaves.to_vec())
}

/// Whether a value is the expected one: both NaN or infinite, or equal but for rounding that grows
/// through a dozen operations.
fn same(value: f64, expected: f64, all: &[f64]) -> bool {
    // Where a step of the plain evaluation leaves the range of the vectorised exponential or
    // meets an infinite number, the last digits say nothing.
    let wild = |value: &f64| {
        !value.is_finite() || (*value != 0.0 && !(1e-12..1e12).contains(&value.abs()))
    };
    all.iter().any(wild) || (value - expected).abs() <= 1e-9 * (1e-3 + expected.abs())
}

/// Whether small errors can turn a condition or a whole number.
fn turns(equations: &Equations, values: &[f64]) -> bool {
    equations.nodes.iter().any(|(_, node)| {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9 * (1.0 + a.abs());
        match node {
            Node::Binary(BinaryOperation::Less | BinaryOperation::GreaterOrEqual, a, b) => {
                near(values[a.index()], values[b.index()])
            }
            Node::Binary(BinaryOperation::Remainder, a, b) => {
                let part = values[a.index()] / values[b.index()];
                near(part, part.round())
            }
            // A power of a negative number needs a whole exponent to the last digit.
            Node::Binary(BinaryOperation::Power, a, _) => values[a.index()] <= 0.0,
            Node::Binary(BinaryOperation::And, a, b) => {
                near(values[a.index()], 0.0) || near(values[b.index()], 0.0)
            }
            Node::Unary(UnaryOperation::Not, a) | Node::Select(a, _, _) => {
                values[a.index()] != 0.0 && near(values[a.index()], 0.0)
            }
            _ => false,
        }
    })
}

proptest! {
    #[test]
    fn the_tape_gives_what_plain_evaluation_gives(
        recipe in proptest::collection::vec(any::<u8>(), 3..60),
        x in -3.0..3.0_f64,
        y in -3.0..3.0_f64,
    ) {
        let (equations, _) = random(&recipe);
        let plain = equations.evaluate(&[2.0], &[x, y], 0.0, 0.25);
        let values: Vec<f64> =
            equations.nodes.iter().map(|(place, _)| plain.expression(place)).collect();
        prop_assume!(!turns(&equations, &values));
        let expected = plain.rates();
        let Ok(model) = EquationModel::new(equations.clone()) else { return Ok(()) };
        let mut rates = [0.0; 2];
        let input = Input { stimulus: 0.25, ..Input::REST };
        model.derivatives(&[x, y], &input, &mut rates);
        prop_assert!(same(rates[1], expected[1], &values), "{} {}", rates[1], expected[1]);
    }

    #[test]
    fn the_jacobian_is_that_of_differences(
        recipe in proptest::collection::vec(any::<u8>(), 3..30),
        x in 0.1..3.0_f64,
        y in 0.1..3.0_f64,
    ) {
        let (equations, _) = random(&recipe);
        let at = |x: f64, y: f64| {
            let plain = equations.evaluate(&[2.0], &[x, y], 0.0, 0.25);
            let values: Vec<f64> =
                equations.nodes.iter().map(|(place, _)| plain.expression(place)).collect();
            let tame = |value: &f64| value.is_finite() && value.abs() < 1e3;
            (values.iter().all(tame) && !turns(&equations, &values)).then(|| plain.rates()[1])
        };
        let Ok(model) = EquationModel::new(equations.clone()) else { return Ok(()) };
        let mut jacobian = [0.0; 4];
        let input = Input { stimulus: 0.25, ..Input::REST };
        model.jacobian(&[x, y], &input, &mut jacobian);
        let slope = |h: f64| Some((at(x, y + h)? - at(x, y - h)?) / (2.0 * h));
        // Two widths that agree show that the function is smooth there.
        let (Some(wide), Some(narrow)) = (slope(1e-4), slope(5e-5)) else { return Ok(()) };
        prop_assume!((wide - narrow).abs() < 1e-4 * (1.0 + wide.abs()));
        prop_assert!((jacobian[3] - narrow).abs() < 1e-3 * (1.0 + narrow.abs()), "{} {narrow}", jacobian[3]);
    }
}

#[test]
fn a_choice_that_is_not_taken_may_be_nan_and_its_derivative_too() {
    // if(x > 0, sqrt(x), 0) at -1.
    let mut builder = Builder::new("select");
    let x = builder.state("a.x", "", -1.0);
    let zero = builder.number(0.0);
    let positive = builder.two(BinaryOperation::Greater, x, zero);
    let root = builder.one(UnaryOperation::SquareRoot, x);
    let chosen = builder.node(Node::Select(positive, root, zero));
    let stimulus = builder.node(Node::Stimulus);
    let rate = builder.two(BinaryOperation::Add, chosen, stimulus);
    builder.rate(0, rate);
    let model = model(builder.done());
    let (mut rates, mut jacobian) = ([f64::NAN], [f64::NAN]);
    model.derivatives(&[-1.0], &Input::REST, &mut rates);
    model.jacobian(&[-1.0], &Input::REST, &mut jacobian);
    assert_eq!((rates, jacobian), ([0.0], [0.0]));
    model.derivatives(&[4.0], &Input::REST, &mut rates);
    model.jacobian(&[4.0], &Input::REST, &mut jacobian);
    assert_eq!((rates, jacobian), ([2.0], [0.25]));
}

#[test]
fn a_saturated_sigmoid_has_the_derivative_zero() {
    // dx/dt = 1 / (1 + e^(1000 x)) at x = 1.
    let mut builder = Builder::new("sigmoid");
    let x = builder.state("a.x", "", 1.0);
    let (one, steep) = (builder.number(1.0), builder.number(1000.0));
    let exponent = builder.two(BinaryOperation::Multiply, steep, x);
    let exponential = builder.one(UnaryOperation::Exponential, exponent);
    let sum = builder.two(BinaryOperation::Add, one, exponential);
    let sigmoid = builder.two(BinaryOperation::Divide, one, sum);
    let stimulus = builder.node(Node::Stimulus);
    let rate = builder.two(BinaryOperation::Add, sigmoid, stimulus);
    builder.rate(0, rate);
    let mut jacobian = [f64::NAN];
    model(builder.done()).jacobian(&[1.0], &Input::REST, &mut jacobian);
    assert_eq!(jacobian, [0.0]);
}

#[test]
fn whole_and_half_powers_become_products_and_roots() {
    let mut graph = Graph::default();
    let x: Id = graph.state(0);
    let by_tape = |graph: &Graph, root: Id, value: f64| {
        let program = crate::cell::tape::Program::new(graph.clone(), &[root], &[], None);
        let fixed = program.fixed(&[]);
        let outside = outside(&Input::REST);
        let mut rates = [0.0];
        program.write_rates(&fixed, &[value], &outside, &mut rates);
        rates[0]
    };
    let _ = graph.outer(Outer::Time);
    for exponent in [-3.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0, 4.5, 7.0] {
        let power = graph.literal(exponent);
        let root = graph.two(Two::Power, x, power);
        for value in [0.3, 1.7, 12.0_f64] {
            let expected = value.powf(exponent);
            let found = by_tape(&graph, root, value);
            assert!((found / expected - 1.0).abs() < 4.0 * f64::EPSILON, "{value}^{exponent}");
        }
    }
    let cube = graph.literal(3.0);
    let cube = graph.two(Two::Power, x, cube);
    assert_eq!(by_tape(&graph, cube, -2.0), -8.0);
}

#[test]
fn stiff_steps_of_a_model_from_equations_have_their_order() {
    let model = model(example::fitzhugh(0.5));
    let protocol = Protocol { start_ms: 1e6, ..Protocol::once(model.default_stimulus()) };
    let end = |tolerance: f64| {
        let settings = SolverSettings { tolerance, ..SolverSettings::of(CellMethod::Stiff) };
        solve(&model, protocol, settings, 600.0, 600.0).unwrap().states[0][1]
    };
    let exact = end(1e-10);
    let [rough, fine] = [1e-4, 1e-7].map(|tolerance| (end(tolerance) - exact).abs());
    // The error is in proportion to the tolerance, within a factor of ten over three decades.
    assert!(fine < 1e-2 * rough && rough < 1e-2, "{rough:e} {fine:e}");
}
