//! Derivatives of a graph, as further operations of the same graph.

use super::graph::{Graph, Id, One, Operation, Outer, Two};

/// What is differentiated by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(in crate::cell) enum By {
    State(u32),
    Stimulus,
    Time,
}

/// Bound of exponentials and powers in derivatives.
const LARGEST_FACTOR: f64 = 1e150;

/// The derivatives of one value that are not 0 everywhere, in order.
pub(in crate::cell) type Slopes = Vec<(By, Id)>;

/// Derivatives of some values with respect to states, stimulus and time, by forward
/// differentiation.
///
/// At a jump it is the derivative of the side on which the value lies.
pub(in crate::cell) fn derivatives(graph: &mut Graph, roots: &[Id]) -> Vec<Slopes> {
    let last = roots.iter().map(|root| root.index() + 1).max().unwrap_or(0);
    let ids: Vec<Id> = graph.ids().take(last).collect();
    let mut all: Vec<Slopes> = Vec::with_capacity(last);
    for id in ids {
        let mut slopes = if graph.moves(id) { of(graph, id, &all) } else { Vec::new() };
        slopes.retain(|(_, slope)| graph.number(*slope) != Some(0.0));
        all.push(slopes);
    }
    roots.iter().map(|root| all[root.index()].clone()).collect()
}

/// The derivatives of one value from those of its operands.
fn of(graph: &mut Graph, id: Id, all: &[Slopes]) -> Slopes {
    match graph.operation(id) {
        Operation::State(index) => vec![(By::State(index), graph.literal(1.0))],
        Operation::Outer(Outer::Stimulus) => vec![(By::Stimulus, graph.literal(1.0))],
        Operation::Outer(Outer::Time) => vec![(By::Time, graph.literal(1.0))],
        Operation::Literal(_) | Operation::Given(_) | Operation::Outer(_) => Vec::new(),
        Operation::One(one, a) => {
            let slopes = &all[a.index()];
            if slopes.is_empty() {
                return Vec::new();
            }
            let Some(outer) = through(graph, one, a, id) else { return Vec::new() };
            slopes.iter().map(|&(by, slope)| (by, times(graph, outer, slope))).collect()
        }
        Operation::Two(two, a, b) => binary(graph, two, [a, b], id, all),
        Operation::Select(condition, then, otherwise) => {
            merged(&all[then.index()], &all[otherwise.index()], |left, right| {
                let (left, right) = (or_zero(graph, left), or_zero(graph, right));
                graph.select(condition, left, right)
            })
        }
    }
}

fn or_zero(graph: &mut Graph, slope: Option<Id>) -> Id {
    slope.unwrap_or_else(|| graph.literal(0.0))
}

/// A product of which a factor may be 0 or 1.
fn times(graph: &mut Graph, a: Id, b: Id) -> Id {
    if graph.number(a) == Some(0.0) || graph.number(b) == Some(0.0) {
        return graph.literal(0.0);
    }
    graph.two(Two::Multiply, a, b)
}

/// A growing factor, bounded so that its product with a vanishing one is 0 and not 0 times infinity:
/// `1 / (1 + e^x)` has the derivative `-e^x / (1 + e^x)^2`, which is 0 for large `x`.
fn bounded(graph: &mut Graph, factor: Id) -> Id {
    if graph.number(factor).is_some() || !graph.moves(factor) {
        return factor;
    }
    let most = graph.literal(LARGEST_FACTOR);
    graph.two(Two::Minimum, factor, most)
}

/// The derivative of an operation on one number with respect to it; `None` if 0 everywhere.
fn through(graph: &mut Graph, one: One, a: Id, value: Id) -> Option<Id> {
    let one_literal = graph.literal(1.0);
    let squared = |graph: &mut Graph, id: Id| graph.two(Two::Multiply, id, id);
    Some(match one {
        One::Negative => graph.literal(-1.0),
        One::Absolute => {
            let (zero, minus) = (graph.literal(0.0), graph.literal(-1.0));
            let below = graph.two(Two::Less, a, zero);
            let above = graph.two(Two::Less, zero, a);
            let positive = graph.select(above, one_literal, zero);
            graph.select(below, minus, positive)
        }
        One::Exponential => bounded(graph, value),
        One::Logarithm => graph.one(One::Inverse, a),
        One::SquareRoot => {
            let half = graph.literal(0.5);
            graph.two(Two::Divide, half, value)
        }
        One::Inverse => {
            let square = squared(graph, value);
            graph.one(One::Negative, square)
        }
        One::Not | One::Floor | One::Ceiling => return None,
        One::Sine => graph.one(One::Cosine, a),
        One::Cosine => {
            let sine = graph.one(One::Sine, a);
            graph.one(One::Negative, sine)
        }
        One::Tangent => {
            let square = squared(graph, value);
            graph.two(Two::Add, one_literal, square)
        }
        One::HyperbolicTangent => {
            let square = squared(graph, value);
            graph.two(Two::Subtract, one_literal, square)
        }
        One::HyperbolicSine => graph.one(One::HyperbolicCosine, a),
        One::HyperbolicCosine => graph.one(One::HyperbolicSine, a),
        One::ArcSine | One::ArcCosine | One::AreaTangent => {
            let square = squared(graph, a);
            let rest = graph.two(Two::Subtract, one_literal, square);
            let root =
                if one == One::AreaTangent { rest } else { graph.one(One::SquareRoot, rest) };
            let inverse = graph.one(One::Inverse, root);
            if one == One::ArcCosine { graph.one(One::Negative, inverse) } else { inverse }
        }
        One::ArcTangent | One::AreaSine | One::AreaCosine => {
            let square = squared(graph, a);
            let sign = graph.literal(if one == One::AreaCosine { -1.0 } else { 1.0 });
            let sum = graph.two(Two::Add, square, sign);
            let root = if one == One::ArcTangent { sum } else { graph.one(One::SquareRoot, sum) };
            graph.one(One::Inverse, root)
        }
    })
}

fn binary(graph: &mut Graph, two: Two, [a, b]: [Id; 2], value: Id, all: &[Slopes]) -> Slopes {
    let (left, right) = (&all[a.index()], &all[b.index()]);
    if left.is_empty() && right.is_empty() {
        return Vec::new();
    }
    // The factors of both operands' derivatives.
    let factors = match two {
        Two::Add | Two::Subtract => {
            return merged(left, right, |left, right| match (left, right) {
                (Some(left), None) => left,
                (left, right) => {
                    let (left, right) = (or_zero(graph, left), or_zero(graph, right));
                    graph.two(two, left, right)
                }
            });
        }
        Two::Minimum | Two::Maximum => {
            let [low, high] = if two == Two::Minimum { [a, b] } else { [b, a] };
            let first = graph.two(Two::Less, low, high);
            return merged(left, right, |left, right| {
                let (left, right) = (or_zero(graph, left), or_zero(graph, right));
                graph.select(first, left, right)
            });
        }
        Two::Multiply => [b, a],
        Two::Divide => {
            let inverse = graph.one(One::Inverse, b);
            let slope = graph.two(Two::Multiply, value, inverse);
            [inverse, graph.one(One::Negative, slope)]
        }
        Two::Power => power(graph, [a, b], value, right.is_empty()),
        _ => return Vec::new(),
    };
    merged(left, right, |left, right| {
        let left = left.map(|slope| times(graph, slope, factors[0]));
        let right = right.map(|slope| times(graph, slope, factors[1]));
        match (left, right) {
            (Some(one), None) | (None, Some(one)) => one,
            (left, right) => {
                let (left, right) = (or_zero(graph, left), or_zero(graph, right));
                graph.two(Two::Add, left, right)
            }
        }
    })
}

/// Derivatives of `a^b` with respect to both.
fn power(graph: &mut Graph, [a, b]: [Id; 2], value: Id, constant: bool) -> [Id; 2] {
    let one = graph.literal(1.0);
    let lower = graph.two(Two::Subtract, b, one);
    let lower = graph.two(Two::Power, a, lower);
    let lower = bounded(graph, lower);
    let by_base = graph.two(Two::Multiply, b, lower);
    if constant {
        return [by_base, graph.literal(0.0)];
    }
    let logarithm = graph.one(One::Logarithm, a);
    [by_base, graph.two(Two::Multiply, value, logarithm)]
}

/// Both lists as one, in order.
fn merged(
    left: &[(By, Id)],
    right: &[(By, Id)],
    mut join: impl FnMut(Option<Id>, Option<Id>) -> Id,
) -> Slopes {
    let (mut left, mut right) = (left.iter().peekable(), right.iter().peekable());
    let mut all = Vec::new();
    loop {
        let by = match (left.peek(), right.peek()) {
            (Some(a), Some(b)) => a.0.min(b.0),
            (Some(one), None) | (None, Some(one)) => one.0,
            (None, None) => return all,
        };
        let from = left.next_if(|own| own.0 == by).map(|own| own.1);
        let other = right.next_if(|own| own.0 == by).map(|own| own.1);
        all.push((by, join(from, other)));
    }
}
