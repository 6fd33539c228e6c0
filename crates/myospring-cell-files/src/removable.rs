//! Removable singularities: `P/(exp(U) - 1)` where `P` and `U` are zero at the same potential.
//!
//! Near that potential, `P/(exp(U) - 1) = (dP/dU) U/(exp(U) - 1)`, and `(exp(U) - 1)/U` is its power
//! series. Both `P` and `U` must be linear in one state, and the quotient a product of factors. The
//! same in Myokit: <https://myokit.readthedocs.io/en/stable/api_formats/general.html>
//! (`HHModel` and GHK forms).

use crate::draft::{Draft, Id, Kind, Problem, Term, Terms};
use myospring_core::cell::equations::{BinaryOperation as B, UnaryOperation as U};
use std::collections::HashMap;

/// Where `|U|` is below this, the series is used: its error is below 1e-19, that of the quotient
/// above it below 1e-12.
const NEAR: f64 = 1e-3;

/// How many variables an expression is followed through.
const FARTHEST: usize = 12;

/// Replaces all removable singularities; `values` are those of all variables at the start. Returns
/// how many.
pub(crate) fn remove(draft: &mut Draft, values: &[f64]) -> Result<usize, Problem> {
    let count = draft.terms.0.len();
    let mut is_factor = vec![false; count];
    for term in &draft.terms.0 {
        if let Term::Binary(B::Multiply | B::Divide, a, b) = *term {
            (is_factor[a], is_factor[b]) = (true, true);
        }
    }
    let mut found = HashMap::new();
    let fixed = fixed(draft);
    let mut pass = Pass { draft, values, fixed, numbers: Vec::new(), linear: HashMap::new() };
    for root in 0..count {
        let is_product =
            matches!(pass.draft.terms.0[root], Term::Binary(B::Multiply | B::Divide, ..));
        if is_product
            && !is_factor[root]
            && let Some(new) = pass.product(root)?
        {
            found.insert(root, new);
        }
    }
    if found.is_empty() {
        return Ok(0);
    }
    rewrite(pass.draft, count, &found)?;
    Ok(found.len())
}

/// Lets every expression of the draft refer to the new terms.
fn rewrite(draft: &mut Draft, count: usize, found: &HashMap<Id, Id>) -> Result<(), Problem> {
    let mut new: Vec<Id> = (0..count).collect();
    for id in 0..count {
        let moved = match draft.terms.0[id] {
            Term::Unary(operation, a) => Term::Unary(operation, new[a]),
            Term::Binary(operation, a, b) => Term::Binary(operation, new[a], new[b]),
            Term::Select(a, b, c) => Term::Select(new[a], new[b], new[c]),
            other => other,
        };
        new[id] = match found.get(&id) {
            Some(&replacement) => replacement,
            None if moved == draft.terms.0[id] || matches!(moved, Term::Number(_)) => id,
            None => draft.terms.push(moved)?,
        };
    }
    for variable in &mut draft.variables {
        variable.kind = match variable.kind {
            Kind::Value(id) => Kind::Value(new[id]),
            Kind::State { start, rate } => Kind::State { start, rate: new[rate] },
            Kind::Time => Kind::Time,
        };
    }
    Ok(())
}

/// Whether each term changes with no state and not with time.
fn fixed(draft: &Draft) -> Vec<bool> {
    let mut variables: Vec<bool> =
        (0..draft.variables.len()).map(|index| draft.number(index).is_some()).collect();
    let mut terms = vec![false; draft.terms.0.len()];
    for _ in 0..FARTHEST {
        for (id, &term) in draft.terms.0.iter().enumerate() {
            terms[id] = match term {
                Term::Number(_) => true,
                Term::Rate(_) => false,
                Term::Variable(index) => variables[index],
                other => other.operands().all(|operand| terms[operand]),
            };
        }
        for (index, variable) in draft.variables.iter().enumerate() {
            variables[index] = matches!(variable.kind, Kind::Value(root) if terms[root]);
        }
    }
    terms
}

struct Pass<'a> {
    draft: &'a mut Draft,
    values: &'a [f64],
    fixed: Vec<bool>,
    /// Values of the terms at the start, as far as they were needed.
    numbers: Vec<f64>,
    linear: HashMap<Id, Option<Linear>>,
}

/// The longest product that is searched.
const MOST_FACTORS: usize = 40;

/// `exp(U) - 1`, or its negative.
struct Denominator {
    argument: Id,
    negative: bool,
}

/// A function that is linear in one state, with the derivative as a term.
#[derive(Clone, Copy)]
struct Linear {
    state: usize,
    slope: Id,
}

impl Pass<'_> {
    /// The replacement of a product with a removable singularity.
    fn product(&mut self, root: Id) -> Result<Option<Id>, Problem> {
        let mut factors = Vec::new();
        self.factors(root, false, &mut factors);
        if factors.len() > MOST_FACTORS {
            return Ok(None);
        }
        let once = |id: Id| factors.iter().filter(|&&(other, _)| other == id).count() == 1;
        for &(below, in_denominator) in &factors {
            let Some(denominator) =
                (in_denominator && once(below)).then(|| self.denominator(below)).flatten()
            else {
                continue;
            };
            let Some(inner) = self.linear(denominator.argument, FARTHEST)? else { continue };
            for &(above, in_denominator) in &factors {
                if in_denominator || !once(above) {
                    continue;
                }
                let Some(outer) = self.linear(above, FARTHEST)? else { continue };
                if outer.state == inner.state
                    && self.same_zero(above, outer, denominator.argument, inner)
                {
                    return self
                        .replace(root, (above, outer), (below, &denominator, inner))
                        .map(Some);
                }
            }
        }
        Ok(None)
    }

    /// The factors of a product, and whether they divide.
    fn factors(&self, root: Id, below: bool, factors: &mut Vec<(Id, bool)>) {
        let mut open = vec![(root, below)];
        while let Some((id, below)) = open.pop() {
            match self.draft.terms.0[id] {
                Term::Binary(B::Multiply, a, b) => open.extend([(a, below), (b, below)]),
                Term::Binary(B::Divide, a, b) => open.extend([(a, below), (b, !below)]),
                Term::Unary(U::Negative, a) if id != root => open.push((a, below)),
                _ => factors.push((id, below)),
            }
        }
    }

    /// Follows variables that are only names for other terms.
    fn behind(&self, mut id: Id) -> Id {
        for _ in 0..FARTHEST {
            match self.draft.terms.0[id] {
                Term::Variable(index) => match self.draft.variables[index].kind {
                    Kind::Value(root) if self.draft.number(index).is_none() => id = root,
                    _ => return id,
                },
                _ => return id,
            }
        }
        id
    }

    fn denominator(&self, id: Id) -> Option<Denominator> {
        let terms = &self.draft.terms;
        let number = |id: Id| match terms.0[id] {
            Term::Number(number) => Some(number),
            Term::Variable(index) => self.draft.number(index),
            _ => None,
        };
        let exponent = |id: Id| match terms.0[self.behind(id)] {
            Term::Unary(U::Exponential, argument) => Some(argument),
            _ => None,
        };
        let (a, negative) = match terms.0[self.behind(id)] {
            Term::Binary(B::Subtract, a, b) if number(b) == Some(1.0) => (a, false),
            Term::Binary(B::Subtract, a, b) if number(a) == Some(1.0) => (b, true),
            Term::Binary(B::Add, a, b) if number(a) == Some(-1.0) => (b, false),
            Term::Binary(B::Add, a, b) if number(b) == Some(-1.0) => (a, false),
            _ => return None,
        };
        exponent(a).map(|argument| Denominator { argument, negative })
    }

    /// The derivative of a term by the one state that it is linear in; `None` for other terms.
    fn linear(&mut self, id: Id, depth: usize) -> Result<Option<Linear>, Problem> {
        if depth == 0 {
            return Ok(None);
        }
        if let Some(&known) = self.linear.get(&id) {
            return Ok(known);
        }
        let linear = self.linear_anew(id, depth)?;
        self.linear.insert(id, linear);
        Ok(linear)
    }

    fn linear_anew(&mut self, id: Id, depth: usize) -> Result<Option<Linear>, Problem> {
        let terms = |pass: &mut Self, operation, a, b| pass.draft.terms.binary(operation, a, b);
        match self.draft.terms.0[id] {
            Term::Variable(index) => match self.draft.variables[index].kind {
                Kind::State { .. } => {
                    let slope = self.draft.terms.number(1.0)?;
                    Ok(Some(Linear { state: index, slope }))
                }
                Kind::Value(root) => self.linear(root, depth - 1),
                Kind::Time => Ok(None),
            },
            Term::Unary(U::Negative, a) => self.negated(a, depth),
            Term::Binary(operation @ (B::Add | B::Subtract), a, b) => {
                if self.fixed[b] {
                    return self.linear(a, depth - 1);
                }
                if self.fixed[a] {
                    return if operation == B::Add {
                        self.linear(b, depth - 1)
                    } else {
                        self.negated(b, depth)
                    };
                }
                Ok(None)
            }
            Term::Binary(B::Multiply, a, b) => {
                let (fixed, other) = if self.fixed[a] { (a, b) } else { (b, a) };
                if !self.fixed[fixed] {
                    return Ok(None);
                }
                let Some(linear) = self.linear(other, depth - 1)? else { return Ok(None) };
                let slope = terms(self, B::Multiply, fixed, linear.slope)?;
                Ok(Some(Linear { slope, ..linear }))
            }
            Term::Binary(B::Divide, a, b) if self.fixed[b] => {
                let Some(linear) = self.linear(a, depth - 1)? else { return Ok(None) };
                let slope = terms(self, B::Divide, linear.slope, b)?;
                Ok(Some(Linear { slope, ..linear }))
            }
            _ => Ok(None),
        }
    }

    fn negated(&mut self, a: Id, depth: usize) -> Result<Option<Linear>, Problem> {
        let Some(linear) = self.linear(a, depth - 1)? else { return Ok(None) };
        let slope = self.draft.terms.unary(U::Negative, linear.slope)?;
        Ok(Some(Linear { slope, ..linear }))
    }

    /// Whether two linear functions are zero at one value of their state.
    fn same_zero(&mut self, a: Id, linear_a: Linear, b: Id, linear_b: Linear) -> bool {
        let [value_a, slope_a, value_b, slope_b] =
            [a, linear_a.slope, b, linear_b.slope].map(|id| self.number(id));
        let zero = |value: f64, slope: f64| self.values[linear_a.state] - value / slope;
        let (zero_a, zero_b) = (zero(value_a, slope_a), zero(value_b, slope_b));
        (zero_a - zero_b).abs() <= 1e-9 * (1.0 + self.values[linear_a.state].abs())
    }

    /// The value of a term at the start.
    fn number(&mut self, id: Id) -> f64 {
        while self.numbers.len() <= id {
            let of = |id: Id| self.numbers[id];
            let value = match self.draft.terms.0[self.numbers.len()] {
                Term::Number(number) => number,
                Term::Variable(index) => self.values[index],
                Term::Rate(_) => f64::NAN,
                Term::Select(a, b, c) => of(if of(a) == 0.0 { c } else { b }),
                Term::Unary(operation, a) => operation.of(of(a)),
                Term::Binary(operation, a, b) => operation.of(of(a), of(b)),
            };
            self.numbers.push(value);
        }
        self.numbers[id]
    }

    fn replace(
        &mut self,
        root: Id,
        (above, outer): (Id, Linear),
        (below, denominator, inner): (Id, &Denominator, Linear),
    ) -> Result<Id, Problem> {
        let terms = &mut self.draft.terms;
        let ratio = terms.binary(B::Divide, outer.slope, inner.slope)?;
        let mut series = series(terms, denominator.argument)?;
        if denominator.negative {
            series = terms.unary(U::Negative, series)?;
        }
        let new =
            copy(terms, root, &HashMap::from([(above, ratio), (below, series)]), DEEPEST_PRODUCT)?;
        let size = terms.unary(U::Absolute, denominator.argument)?;
        let near = terms.number(NEAR)?;
        let condition = terms.binary(B::Less, size, near)?;
        terms.push(Term::Select(condition, new, root))
    }
}

/// How many factors a product is followed through.
const DEEPEST_PRODUCT: usize = 100;

/// A product with some of its factors replaced.
fn copy(terms: &mut Terms, id: Id, new: &HashMap<Id, Id>, depth: usize) -> Result<Id, Problem> {
    if let Some(&new) = new.get(&id) {
        return Ok(new);
    }
    if depth == 0 {
        return Ok(id);
    }
    match terms.0[id] {
        Term::Binary(operation @ (B::Multiply | B::Divide), a, b) => {
            let (own_a, own_b) = (copy(terms, a, new, depth - 1)?, copy(terms, b, new, depth - 1)?);
            if (own_a, own_b) == (a, b) { Ok(id) } else { terms.binary(operation, own_a, own_b) }
        }
        Term::Unary(U::Negative, a) => {
            let own = copy(terms, a, new, depth - 1)?;
            if own == a { Ok(id) } else { terms.unary(U::Negative, own) }
        }
        _ => Ok(id),
    }
}

/// `(exp(u) - 1)/u = 1 + u/2 (1 + u/3 (1 + u/4 (1 + u/5)))`.
fn series(terms: &mut Terms, u: Id) -> Result<Id, Problem> {
    let mut sum = terms.number(1.0)?;
    for order in [5.0, 4.0, 3.0, 2.0] {
        let part = terms.number(1.0 / order)?;
        let part = terms.binary(B::Multiply, u, part)?;
        let part = terms.binary(B::Multiply, part, sum)?;
        let one = terms.number(1.0)?;
        sum = terms.binary(B::Add, one, part)?;
    }
    Ok(sum)
}
