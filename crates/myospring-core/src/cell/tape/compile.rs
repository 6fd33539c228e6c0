//! From a graph to a flat list of operations on rows.
//!
//! Operations are put in an order in which as many of the same kind as possible follow each other,
//! so that choosing what to do costs little; rows are used again once nobody needs their value.

use super::graph::{Graph, Id, One, Operation, Outer, Two};
use std::collections::HashMap;

/// What an instruction does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Code {
    One(One),
    Two(Two),
    Select,
}

/// The row of the result and those of the operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Instruction {
    pub(super) to: u32,
    pub(super) from: [u32; 3],
}

/// Instructions of one kind that follow each other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) code: Code,
    pub(super) instructions: Vec<Instruction>,
}

/// Instructions that compute some values of a graph.
#[derive(Debug, Clone)]
pub(in crate::cell) struct Tape {
    pub(super) runs: Vec<Run>,
    /// The row of each value.
    pub(super) roots: Vec<usize>,
    /// Number of rows that it needs.
    pub(super) rows: usize,
}

/// Which row holds which input: first the cell's numbers, then states, then [`Outer`] values.
#[derive(Debug, Clone)]
pub(in crate::cell) struct Layout {
    /// The graph's values that do not change while a cell is integrated, with their rows.
    fixed: HashMap<Id, usize>,
    /// The same, row by row.
    pub(super) order: Vec<Id>,
    states: usize,
}

impl Layout {
    /// Rows for all fixed values that some roots need from moving operations, or are themselves.
    pub(super) fn new(graph: &Graph, states: usize, roots: &[Id]) -> Self {
        let mut needed = needed(graph, roots);
        let mut wanted = vec![false; graph.len()];
        for root in roots {
            wanted[root.index()] = true;
        }
        for id in graph.ids().filter(|id| graph.moves(*id)) {
            if std::mem::take(&mut needed[id.index()]) {
                for operand in graph.operation(id).operands() {
                    wanted[operand.index()] = true;
                }
            }
        }
        let order: Vec<Id> =
            graph.ids().filter(|id| wanted[id.index()] && !graph.moves(*id)).collect();
        let fixed = order.iter().enumerate().map(|(row, id)| (*id, row)).collect();
        Self { fixed, order, states }
    }

    pub(super) fn state(&self, index: usize) -> usize {
        self.order.len() + index
    }

    pub(super) fn outer(&self, outer: Outer) -> usize {
        self.order.len() + self.states + outer as usize
    }

    /// Number of rows of inputs.
    pub(super) fn inputs(&self) -> usize {
        self.order.len() + self.states + Outer::ALL.len()
    }

    fn input(&self, graph: &Graph, id: Id) -> Option<usize> {
        match graph.operation(id) {
            Operation::State(index) => Some(self.state(index as usize)),
            Operation::Outer(outer) => Some(self.outer(outer)),
            _ => self.fixed.get(&id).copied(),
        }
    }
}

/// Which operations some roots need.
fn needed(graph: &Graph, roots: &[Id]) -> Vec<bool> {
    let mut needed = vec![false; graph.len()];
    let mut open = roots.to_vec();
    while let Some(id) = open.pop() {
        if !std::mem::replace(&mut needed[id.index()], true) {
            open.extend(graph.operation(id).operands());
        }
    }
    needed
}

impl Tape {
    /// Instructions that compute the roots.
    pub(super) fn new(graph: &Graph, layout: &Layout, roots: &[Id]) -> Self {
        let order = Order::new(graph, roots).all(graph);
        let mut rows = Rows::new(graph, layout, roots, &order);
        let mut runs: Vec<Run> = Vec::new();
        for id in order {
            let operation = graph.operation(id);
            let Some(code) = code(operation) else { continue };
            let mut from = [0; 3];
            for (place, operand) in from.iter_mut().zip(operation.operands()) {
                *place = rows.of(operand) as u32;
            }
            for operand in operation.operands() {
                rows.used(operand);
            }
            let instruction = Instruction { to: rows.take(id) as u32, from };
            match runs.last_mut() {
                Some(run) if run.code == code => run.instructions.push(instruction),
                _ => runs.push(Run { code, instructions: vec![instruction] }),
            }
        }
        let roots = roots.iter().map(|root| rows.of(*root)).collect();
        Self { runs, roots, rows: rows.count }
    }
}

/// The kind of a moving operation; `None` for an input.
fn code(operation: Operation) -> Option<Code> {
    match operation {
        Operation::One(one, _) => Some(Code::One(one)),
        Operation::Two(two, _, _) => Some(Code::Two(two)),
        Operation::Select(..) => Some(Code::Select),
        _ => None,
    }
}

/// An order of operations: each after its operands, equal kinds together.
struct Order {
    /// Operands of each operation that are not computed yet.
    waits_for: Vec<u32>,
    /// The operations that need each operation.
    needed_by: Vec<Vec<Id>>,
    /// The kinds, in the order in which they occur, with their operations that can be computed.
    ready: Vec<(Code, Vec<Id>)>,
    kinds: HashMap<Code, usize>,
}

impl Order {
    fn new(graph: &Graph, roots: &[Id]) -> Self {
        let needed = needed(graph, roots);
        let mut order = Self {
            waits_for: vec![0; graph.len()],
            needed_by: vec![Vec::new(); graph.len()],
            ready: Vec::new(),
            kinds: HashMap::new(),
        };
        for id in graph.ids().filter(|id| needed[id.index()] && graph.moves(*id)) {
            let operation = graph.operation(id);
            if code(operation).is_none() {
                continue;
            }
            for operand in operation.operands() {
                if graph.moves(operand) && code(graph.operation(operand)).is_some() {
                    order.waits_for[id.index()] += 1;
                    order.needed_by[operand.index()].push(id);
                }
            }
            if order.waits_for[id.index()] == 0 {
                order.offer(graph, id);
            }
        }
        order
    }

    fn offer(&mut self, graph: &Graph, id: Id) {
        let Some(code) = code(graph.operation(id)) else { return };
        let kind = *self.kinds.entry(code).or_insert_with(|| {
            self.ready.push((code, Vec::new()));
            self.ready.len() - 1
        });
        self.ready[kind].1.push(id);
    }

    fn all(mut self, graph: &Graph) -> Vec<Id> {
        let mut order = Vec::new();
        loop {
            // The kind of which most can be computed; of equals the first.
            let most = (0..self.ready.len()).rev().max_by_key(|kind| self.ready[*kind].1.len());
            let Some(kind) = most.filter(|kind| !self.ready[*kind].1.is_empty()) else {
                return order;
            };
            // Those that become possible meanwhile follow in the same run.
            while !self.ready[kind].1.is_empty() {
                for id in std::mem::take(&mut self.ready[kind].1) {
                    order.push(id);
                    for later in std::mem::take(&mut self.needed_by[id.index()]) {
                        let waits = &mut self.waits_for[later.index()];
                        *waits -= 1;
                        if *waits == 0 {
                            self.offer(graph, later);
                        }
                    }
                }
            }
        }
    }
}

/// Rows of the values that are needed.
struct Rows<'a> {
    graph: &'a Graph,
    layout: &'a Layout,
    taken: HashMap<Id, usize>,
    /// How often each value is still needed.
    uses: Vec<u32>,
    free: Vec<usize>,
    count: usize,
}

impl<'a> Rows<'a> {
    fn new(graph: &'a Graph, layout: &'a Layout, roots: &[Id], order: &[Id]) -> Self {
        let mut uses = vec![0; graph.len()];
        for id in order {
            for operand in graph.operation(*id).operands() {
                uses[operand.index()] += 1;
            }
        }
        for root in roots {
            uses[root.index()] += 1;
        }
        let count = layout.inputs();
        Self { graph, layout, taken: HashMap::new(), uses, free: Vec::new(), count }
    }

    fn of(&self, id: Id) -> usize {
        let input = self.layout.input(self.graph, id);
        input.or_else(|| self.taken.get(&id).copied()).unwrap_or_default()
    }

    /// A value has been used once; its row is free after the last time.
    fn used(&mut self, id: Id) {
        self.uses[id.index()] -= 1;
        if self.uses[id.index()] == 0
            && let Some(row) = self.taken.remove(&id)
        {
            self.free.push(row);
        }
    }

    /// A row for a new value.
    fn take(&mut self, id: Id) -> usize {
        let row = self.free.pop().unwrap_or_else(|| {
            self.count += 1;
            self.count - 1
        });
        self.taken.insert(id, row);
        row
    }
}
