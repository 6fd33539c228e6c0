//! Everything that the integration of a model needs, compiled once.

use super::compile::{Layout, Tape};
use super::derivative::{By, derivatives};
use super::elimination::Plan;
use super::graph::{Graph, Id, One, Operation, Outer, Two};
use super::values;

/// The compiled equations of a model, for any values of its numbers.
#[derive(Debug)]
pub(in crate::cell) struct Program {
    pub(super) states: usize,
    pub(super) layout: Layout,
    graph: Graph,
    pub(super) rates: Tape,
    /// The rates, then the nonzero entries of the Jacobian.
    pub(super) jacobian: Tape,
    /// Row and column of each of these entries.
    pub(super) pattern: Vec<(usize, usize)>,
    pub(super) plan: Plan,
    /// The rates' derivatives by time, if any is not 0, for each state; empty if none.
    by_time: Vec<Option<Id>>,
    observed: Tape,
    gates: Tape,
    gate_places: Vec<usize>,
    /// The states that change when the stimulus does, with the derivative of their rates.
    moved: Vec<(usize, Id)>,
}

/// A place from which a program is evaluated.
#[derive(Debug, Clone, Copy)]
pub(in crate::cell) struct Outside {
    pub(in crate::cell) stimulus: f64,
    pub(in crate::cell) time_ms: f64,
    pub(in crate::cell) stretch: f64,
    pub(in crate::cell) stretch_rate: f64,
}

impl Outside {
    fn of(&self, outer: Outer) -> f64 {
        match outer {
            Outer::Stimulus => self.stimulus,
            Outer::Time => self.time_ms,
            Outer::Stretch => self.stretch,
            Outer::StretchRate => self.stretch_rate,
        }
    }
}

impl Program {
    /// Compiles the rates of all states, and further values that are read from a state.
    /// `potential` is the state on which gates may depend.
    pub(in crate::cell) fn new(
        mut graph: Graph,
        rates: &[Id],
        observed: &[Id],
        potential: Option<usize>,
    ) -> Self {
        let slopes = derivatives(&mut graph, rates);
        let (mut pattern, mut entries, mut moved) = (Vec::new(), Vec::new(), Vec::new());
        let mut by_time = vec![None; rates.len()];
        for (row, slopes) in slopes.iter().enumerate() {
            for &(by, slope) in slopes {
                match by {
                    By::State(column) => {
                        pattern.push((row, column as usize));
                        entries.push(slope);
                    }
                    By::Stimulus => moved.push((row, slope)),
                    By::Time => by_time[row] = Some(slope),
                }
            }
        }
        let gate_places = gates(&graph, rates, &pattern, &entries, potential);
        let own_slope = |place: &usize| {
            pattern.iter().position(|at| *at == (*place, *place)).map(|at| entries[at])
        };
        let gate_roots: Vec<Id> = gate_places
            .iter()
            .filter_map(|place| Some([rates[*place], own_slope(place)?]))
            .flatten()
            .collect();
        let both: Vec<Id> = rates.iter().chain(&entries).copied().collect();
        let all: Vec<Id> = both
            .iter()
            .chain(observed)
            .chain(moved.iter().map(|(_, slope)| slope))
            .copied()
            .collect();
        let layout = Layout::new(&graph, rates.len(), &all);
        let tape = |roots: &[Id]| Tape::new(&graph, &layout, roots);
        let plan = Plan::new(rates.len(), &pattern);
        let by_time = if by_time.iter().any(Option::is_some) { by_time } else { Vec::new() };
        Self {
            states: rates.len(),
            rates: tape(rates),
            jacobian: tape(&both),
            observed: tape(observed),
            gates: tape(&gate_roots),
            pattern,
            plan,
            by_time,
            gate_places,
            moved,
            layout,
            graph,
        }
    }

    /// Whether rates depend on time other than through jumps.
    pub(in crate::cell) fn follows_time(&self) -> bool {
        !self.by_time.is_empty()
    }

    /// The states that are gates.
    pub(in crate::cell) fn gates(&self) -> &[usize] {
        &self.gate_places
    }

    /// The rows of the cell's numbers.
    pub(in crate::cell) fn fixed(&self, given: &[f64]) -> Vec<f64> {
        let values = self.unmoving(given);
        self.layout.order.iter().map(|id| values[id.index()]).collect()
    }

    /// The states that a stimulus changes, with the rate that a stimulus of 1 adds; `None` for one
    /// whose weight depends on the state.
    pub(in crate::cell) fn moved(&self, given: &[f64]) -> Vec<(usize, Option<f64>)> {
        let values = self.unmoving(given);
        let weight = |id: Id| (!self.graph.moves(id)).then(|| values[id.index()]);
        self.moved.iter().map(|&(state, id)| (state, weight(id))).collect()
    }

    /// The values of all operations that do not change while a cell is integrated.
    fn unmoving(&self, given: &[f64]) -> Vec<f64> {
        let mut all = vec![f64::NAN; self.graph.len()];
        for id in self.graph.ids().filter(|id| !self.graph.moves(*id)) {
            let of = |id: Id| all[id.index()];
            all[id.index()] = match self.graph.operation(id) {
                Operation::Literal(bits) => f64::from_bits(bits),
                Operation::Given(index) => given[index as usize],
                Operation::One(one, a) => values::one(one, of(a)),
                Operation::Two(two, a, b) => values::two(two, of(a), of(b)),
                Operation::Select(a, b, c) => of(if of(a) == 0.0 { c } else { b }),
                Operation::State(_) | Operation::Outer(_) => f64::NAN,
            };
        }
        all
    }

    /// Writes the rates at a state.
    pub(in crate::cell) fn write_rates(
        &self,
        fixed: &[f64],
        state: &[f64],
        outside: &Outside,
        rates: &mut [f64],
    ) {
        let rows = rows(&self.rates, fixed, state, outside);
        for (rate, row) in rates.iter_mut().zip(&self.rates.roots) {
            *rate = rows[*row][0];
        }
    }

    /// Writes the Jacobian at a state, row by row.
    pub(in crate::cell) fn write_jacobian(
        &self,
        fixed: &[f64],
        state: &[f64],
        outside: &Outside,
        jacobian: &mut [f64],
    ) {
        let rows = rows(&self.jacobian, fixed, state, outside);
        jacobian.fill(0.0);
        for (&(row, column), place) in self.pattern.iter().zip(&self.jacobian.roots[self.states..])
        {
            jacobian[row * self.states + column] = rows[*place][0];
        }
    }

    /// The observed values at a state.
    pub(in crate::cell) fn observe(
        &self,
        fixed: &[f64],
        state: &[f64],
        outside: &Outside,
    ) -> Vec<f64> {
        let rows = rows(&self.observed, fixed, state, outside);
        self.observed.roots.iter().map(|row| rows[*row][0]).collect()
    }

    /// Rate and its derivative by the gate itself, of each gate, at a state.
    pub(in crate::cell) fn gate_rates(
        &self,
        fixed: &[f64],
        state: &[f64],
        outside: &Outside,
    ) -> Vec<[f64; 2]> {
        let rows = rows(&self.gates, fixed, state, outside);
        let roots = self.gates.roots.chunks_exact(2);
        roots.map(|pair| [rows[pair[0]][0], rows[pair[1]][0]]).collect()
    }
}

/// Evaluates a tape at one state.
fn rows(tape: &Tape, fixed: &[f64], state: &[f64], outside: &Outside) -> Vec<[f64; 1]> {
    let mut rows = Vec::with_capacity(tape.rows);
    let outer = Outer::ALL.map(|outer| outside.of(outer));
    rows.extend(fixed.iter().chain(state).chain(&outer).map(|value| [*value]));
    rows.resize(tape.rows, [0.0]);
    tape.evaluate(&mut rows);
    rows
}

/// The states on which a value depends, and those on which its jumps depend.
#[derive(Debug, Clone, Default)]
struct Dependence {
    states: Vec<u64>,
    jumps: Vec<u64>,
}

fn has(set: &[u64], state: usize) -> bool {
    set[state / 64] >> (state % 64) & 1 == 1
}

/// What every operation depends on.
fn dependences(graph: &Graph, states: usize) -> Vec<Dependence> {
    let words = states.div_ceil(64);
    let mut all: Vec<Dependence> = Vec::with_capacity(graph.len());
    for id in graph.ids() {
        let operation = graph.operation(id);
        let mut own = Dependence { states: vec![0; words], jumps: vec![0; words] };
        if let Operation::State(index) = operation {
            own.states[index as usize / 64] |= 1 << (index % 64);
        }
        for operand in operation.operands() {
            let other = &all[operand.index()];
            for word in 0..words {
                own.states[word] |= other.states[word];
                own.jumps[word] |= other.jumps[word];
            }
        }
        let turns = match operation {
            Operation::One(one, _) => {
                matches!(one, One::Not | One::Floor | One::Ceiling | One::Absolute)
            }
            Operation::Two(two, _, _) => {
                !matches!(two, Two::Add | Two::Subtract | Two::Multiply | Two::Divide | Two::Power)
            }
            _ => false,
        };
        if turns {
            own.jumps.clone_from(&own.states);
        }
        all.push(own);
    }
    all
}

/// The states whose rate is linear in themselves and otherwise depends on the potential alone.
fn gates(
    graph: &Graph,
    rates: &[Id],
    pattern: &[(usize, usize)],
    entries: &[Id],
    potential: Option<usize>,
) -> Vec<usize> {
    let Some(potential) = potential else { return Vec::new() };
    let all = dependences(graph, rates.len());
    let alone = |set: &[u64], but: &[usize]| {
        (0..rates.len()).all(|state| but.contains(&state) || !has(set, state))
    };
    let is_gate = |state: &usize| {
        let at = pattern.iter().position(|at| *at == (*state, *state));
        let (rate, slope) = match at {
            Some(at) => (&all[rates[*state].index()], &all[entries[at].index()]),
            None => return false,
        };
        *state != potential
            && alone(&rate.states, &[potential, *state])
            && alone(&rate.jumps, &[potential])
            && alone(&slope.states, &[potential])
    };
    (0..rates.len()).filter(is_gate).collect()
}
