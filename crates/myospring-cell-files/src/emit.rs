//! A draft to nodes: variables in the order of their needs, each operation once.

use crate::draft::{Draft, Id, Kind, Problem, Term};
use myospring_core::cell::equations::{BinaryOperation, Expression, Node, Nodes, UnaryOperation};

/// What an expression may need: the value of a variable or the rate of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Item {
    Value(usize),
    Rate(usize),
}

/// Where the stimulus acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StimulusAt {
    /// Nowhere: the file as it is.
    Nowhere,
    /// In place of a variable, with its sign or the opposite one.
    Variable(usize, bool),
    /// Added to the rate of a state, in its unit per ms.
    Rate(usize),
}

/// The nodes of a draft so far.
pub(crate) struct Emission<'a> {
    draft: &'a Draft,
    stimulus: StimulusAt,
    pub(crate) nodes: Nodes,
    /// The constants: variables by index.
    pub(crate) constants: Vec<usize>,
    /// The intermediates in order, with their expressions.
    pub(crate) intermediates: Vec<(usize, Expression)>,
    place_of: Vec<Option<u32>>,
    /// Constants and states.
    given: Vec<bool>,
    rates: Vec<Option<Expression>>,
    terms: Vec<Option<Expression>>,
    state: Vec<Progress>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Progress {
    New,
    Open,
    Done,
}

impl<'a> Emission<'a> {
    /// Nothing yet; `kept` says which variables may be constants.
    pub(crate) fn new(
        draft: &'a Draft,
        stimulus: StimulusAt,
        kept: &dyn Fn(usize) -> bool,
    ) -> Self {
        let count = draft.variables.len();
        let is_replaced = |index| matches!(stimulus, StimulusAt::Variable(own, _) if own == index);
        let constants: Vec<usize> = (0..count)
            .filter(|&index| kept(index) && !is_replaced(index) && draft.number(index).is_some())
            .collect();
        let mut place_of = vec![None; count];
        constants.iter().enumerate().for_each(|(place, &own)| place_of[own] = Some(place as u32));
        draft
            .states
            .iter()
            .enumerate()
            .for_each(|(place, &own)| place_of[own] = Some(place as u32));
        Self {
            draft,
            stimulus,
            nodes: Nodes::default(),
            constants,
            intermediates: Vec::new(),
            given: place_of.iter().map(Option::is_some).collect(),
            place_of,
            rates: vec![None; count],
            terms: vec![None; draft.terms.0.len()],
            state: vec![Progress::New; 2 * count],
        }
    }

    /// Adds a variable or rate and all that it needs.
    pub(crate) fn add(&mut self, item: Item) -> Result<(), Problem> {
        let mut open = vec![item];
        while let Some(&item) = open.last() {
            let place = self.progress(item);
            if self.state[place] == Progress::Done {
                open.pop();
                continue;
            }
            let missing: Vec<Item> = self
                .needs(item)
                .into_iter()
                .filter(|&need| self.state[self.progress(need)] != Progress::Done)
                .collect();
            if missing.is_empty() {
                self.emit(item)?;
                self.state[place] = Progress::Done;
                open.pop();
                continue;
            }
            if let Some(again) = missing
                .iter()
                .find(|&&need| need == item || self.state[self.progress(need)] == Progress::Open)
            {
                return Err(self.circle(&open, *again));
            }
            self.state[place] = Progress::Open;
            // One at a time, so that `open` is a chain of needs.
            open.push(missing[0]);
        }
        Ok(())
    }

    fn progress(&self, item: Item) -> usize {
        match item {
            Item::Value(index) => index,
            Item::Rate(index) => self.draft.variables.len() + index,
        }
    }

    fn circle(&self, open: &[Item], again: Item) -> Problem {
        let start = open.iter().position(|&item| item == again).unwrap_or(0);
        let words = open[start..].iter().chain([&again]).map(|item| {
            let (Item::Value(index) | Item::Rate(index)) = *item;
            let variable = &self.draft.variables[index];
            format!("{} (line {})", variable.name, variable.place.line)
        });
        let circle: Vec<String> = words.collect();
        let (Item::Value(index) | Item::Rate(index)) = again;
        let reason = format!(
            "these variables need each other, which only a solver of algebraic equations could do: {}",
            circle.join(" -> ")
        );
        Problem::of(&self.draft.variables[index], reason)
    }

    /// What an item needs that is neither constant, state, time nor stimulus.
    fn needs(&self, item: Item) -> Vec<Item> {
        let root = match item {
            _ if self.is_given(item) => None,
            Item::Value(index) => self.root(index, false),
            Item::Rate(index) => self.root(index, true),
        };
        let Some(root) = root else { return Vec::new() };
        self.needs_of(root)
    }

    /// What a term needs.
    pub(crate) fn needs_of(&self, root: Id) -> Vec<Item> {
        let mut open = vec![root];
        let mut items = Vec::new();
        let mut seen = std::collections::HashSet::new();
        while let Some(id) = open.pop() {
            if !seen.insert(id) || self.terms[id].is_some() {
                continue;
            }
            let item = match self.draft.terms.0[id] {
                Term::Variable(index) => Item::Value(index),
                Term::Rate(index) => Item::Rate(index),
                other => {
                    open.extend(other.operands());
                    continue;
                }
            };
            if !self.is_given(item) {
                items.push(item);
            }
        }
        items
    }

    fn is_given(&self, item: Item) -> bool {
        match item {
            Item::Rate(_) => false,
            Item::Value(index) => {
                self.given[index]
                    || self.draft.variables[index].kind == Kind::Time
                    || matches!(self.stimulus, StimulusAt::Variable(own, _) if own == index)
            }
        }
    }

    fn root(&self, index: usize, rate: bool) -> Option<Id> {
        match self.draft.variables[index].kind {
            Kind::Value(id) if !rate => Some(id),
            Kind::State { rate: id, .. } if rate => Some(id),
            _ => None,
        }
    }

    fn emit(&mut self, item: Item) -> Result<(), Problem> {
        match item {
            Item::Value(_) if self.is_given(item) => {}
            Item::Value(index) => {
                if let Some(root) = self.root(index, false) {
                    let value = self.term(root)?;
                    self.place_of[index] = Some(self.intermediates.len() as u32);
                    self.intermediates.push((index, value));
                }
            }
            Item::Rate(index) => {
                let Some(root) = self.root(index, true) else {
                    let variable = &self.draft.variables[index];
                    let reason =
                        format!("the derivative of {} is used, which is no state", variable.name);
                    return Err(Problem::of(variable, reason));
                };
                self.rates[index] = Some(self.term(root)?);
            }
        }
        Ok(())
    }

    /// The expression of a term whose needs are all there.
    pub(crate) fn term(&mut self, root: Id) -> Result<Expression, Problem> {
        let mut open = vec![root];
        while let Some(&id) = open.last() {
            if self.terms[id].is_some() {
                open.pop();
                continue;
            }
            let term = self.draft.terms.0[id];
            let before = open.len();
            open.extend(term.operands().filter(|&operand| self.terms[operand].is_none()));
            if open.len() > before {
                continue;
            }
            open.pop();
            self.terms[id] = Some(self.node(term)?);
        }
        self.terms[root].ok_or_else(|| Problem::new("an expression is empty"))
    }

    fn node(&mut self, term: Term) -> Result<Expression, Problem> {
        let of = |id: Id| self.terms[id].ok_or_else(|| Problem::new("an operand is missing"));
        let node = match term {
            Term::Number(number) => Node::Number(number),
            Term::Unary(operation, a) => Node::Unary(operation, of(a)?),
            Term::Binary(operation, a, b) => Node::Binary(operation, of(a)?, of(b)?),
            Term::Select(a, b, c) => Node::Select(of(a)?, of(b)?, of(c)?),
            Term::Variable(index) => return self.variable(index),
            Term::Rate(index) => {
                return self.rates[index].ok_or_else(|| Problem::new("a rate is missing"));
            }
        };
        self.push(node)
    }

    fn variable(&mut self, index: usize) -> Result<Expression, Problem> {
        let node = match (self.draft.variables[index].kind, self.stimulus) {
            (_, StimulusAt::Variable(own, positive)) if own == index => {
                let stimulus = self.push(Node::Stimulus)?;
                if positive {
                    return Ok(stimulus);
                }
                Node::Unary(UnaryOperation::Negative, stimulus)
            }
            (Kind::Time, _) => {
                let time = self.push(Node::Time)?;
                return self.scaled(time, 1.0 / self.draft.milliseconds);
            }
            (Kind::State { .. }, _) => Node::State(self.place(index)?),
            (Kind::Value(_), _)
                if self.draft.number(index).is_some() && self.is_given(Item::Value(index)) =>
            {
                Node::Constant(self.place(index)?)
            }
            (Kind::Value(_), _) => Node::Intermediate(self.place(index)?),
        };
        self.push(node)
    }

    fn place(&self, index: usize) -> Result<u32, Problem> {
        self.place_of[index].ok_or_else(|| {
            let variable = &self.draft.variables[index];
            Problem::of(variable, format!("{} has no value", variable.name))
        })
    }

    /// The rate of a state per ms, stimulus included.
    pub(crate) fn rate_per_ms(&mut self, index: usize) -> Result<Expression, Problem> {
        self.add(Item::Rate(index))?;
        let rate = self.rates[index].ok_or_else(|| Problem::new("a rate is missing"))?;
        let rate = self.scaled(rate, 1.0 / self.draft.milliseconds)?;
        if self.stimulus != StimulusAt::Rate(index) {
            return Ok(rate);
        }
        let stimulus = self.push(Node::Stimulus)?;
        self.push(Node::Binary(BinaryOperation::Add, rate, stimulus))
    }

    fn scaled(&mut self, value: Expression, factor: f64) -> Result<Expression, Problem> {
        if factor == 1.0 {
            return Ok(value);
        }
        let factor = self.push(Node::Number(factor))?;
        self.push(Node::Binary(BinaryOperation::Multiply, value, factor))
    }

    fn push(&mut self, node: Node) -> Result<Expression, Problem> {
        self.nodes.push(node).map_err(|error| Problem::new(error.to_string()))
    }

    /// The values of all nodes.
    pub(crate) fn values(&self, states: &[f64], time_ms: f64, stimulus: f64) -> Vec<f64> {
        let constants: Vec<f64> = self
            .constants
            .iter()
            .map(|&index| self.draft.number(index).unwrap_or(f64::NAN))
            .collect();
        let places: Vec<Expression> = self.intermediates.iter().map(|&(_, place)| place).collect();
        let mut values = Vec::new();
        self.nodes.evaluate(&constants, states, time_ms, stimulus, &places, &mut values);
        values
    }
}
