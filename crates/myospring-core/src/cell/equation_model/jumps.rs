//! Whether a variable slides along a threshold at which its own rate jumps.
//!
//! It does where the rate points at the threshold from both sides, and stiff steps cannot follow
//! that. Any other jump only makes a few steps short.

use crate::cell::equations::{BinaryOperation, Equations, Expression, Node};

/// Distance from the threshold at which both sides are compared, relative to its size.
const APART: f64 = 1e-9;
/// Smallest jump relative to the rates; a continuous rate changes by far less over that distance.
const JUMP: f64 = 1e-4;

/// Whether the rate of a state points at a threshold of this state from both sides, with the other
/// states at their start. Thresholds are comparisons that are linear in the state.
pub(super) fn slides(equations: &Equations, state: usize) -> bool {
    let all = depends(equations, state);
    let used = used_by(equations, equations.states[state].rate);
    equations.nodes.iter().any(|(place, node)| {
        let Node::Binary(operation, a, b) = node else { return false };
        is_comparison(operation)
            && used[place.index()]
            && (all[a.index()] || all[b.index()])
            && holds(equations, state, a, b)
    })
}

fn is_comparison(operation: BinaryOperation) -> bool {
    use BinaryOperation::{Equal, Greater, GreaterOrEqual, Less, LessOrEqual, NotEqual};
    matches!(operation, Less | LessOrEqual | Greater | GreaterOrEqual | Equal | NotEqual)
}

fn holds(equations: &Equations, state: usize, a: Expression, b: Expression) -> bool {
    let constants = equations.constant_values();
    let start = equations.start();
    let at = |value: f64| {
        let mut states = start.clone();
        states[state] = value;
        let values = equations.evaluate(&constants, &states, 0.0, 0.0);
        let rate = values.expression(equations.states[state].rate);
        (values.expression(a) - values.expression(b), rate)
    };
    let from = start[state];
    let by = 0.1 * from.abs().max(0.1);
    let (here, there) = (at(from).0, at(from + by).0);
    let threshold = from - here * by / (there - here);
    if !threshold.is_finite() || at(threshold).0.abs() > 1e-9 * here.abs() {
        return false;
    }
    let apart = APART * threshold.abs().max(1e-3);
    let (below, above) = (at(threshold - apart).1, at(threshold + apart).1);
    below > 0.0 && above < 0.0 && below - above > JUMP * below.abs().max(above.abs())
}

/// Which nodes depend on a state.
fn depends(equations: &Equations, state: usize) -> Vec<bool> {
    let mut all: Vec<bool> = Vec::with_capacity(equations.nodes.len());
    for (_, node) in equations.nodes.iter() {
        let own = match node {
            Node::State(index) => index as usize == state,
            Node::Intermediate(index) => all[equations.intermediates[index as usize].value.index()],
            _ => node.operands().any(|operand| all[operand.index()]),
        };
        all.push(own);
    }
    all
}

/// Which nodes an expression needs.
fn used_by(equations: &Equations, root: Expression) -> Vec<bool> {
    let mut used = vec![false; equations.nodes.len()];
    let mut open = vec![root];
    while let Some(place) = open.pop() {
        if std::mem::replace(&mut used[place.index()], true) {
            continue;
        }
        match equations.nodes.node(place) {
            Node::Intermediate(index) => open.push(equations.intermediates[index as usize].value),
            node => open.extend(node.operands()),
        }
    }
    used
}
