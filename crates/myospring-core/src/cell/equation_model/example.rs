//! Small equations for examples and tests, made in code.

use crate::cell::equations::{
    BinaryOperation, Constant, DefaultStimulus, Equations, Expression, Found, Node, Nodes, Place,
    PotentialRole, Roles, Source, State, StimulusRole, UnaryOperation, Variable,
};

/// Makes equations step by step.
#[derive(Debug)]
pub struct Builder {
    equations: Equations,
}

/// Constants and variables have no file here.
fn place() -> Place {
    Place { file: None, line: 1 }
}

impl Builder {
    /// Equations without any state.
    pub fn new(name: &str) -> Self {
        let found = || Found::Reason("made in code".to_owned());
        let default =
            DefaultStimulus { amplitude: 1.0, duration_ms: 1.0, period_ms: None, found: found() };
        let stimulus =
            StimulusRole { name: None, unit: "mV/ms".to_owned(), default, found: found() };
        let potential =
            PotentialRole { state: 0, millivolts: Some((Variable::State(0), 1.0)), found: found() };
        let roles = Roles { potential, stimulus, calcium: None, tension: None };
        Self {
            equations: Equations {
                name: name.to_owned(),
                description: name.to_owned(),
                source: Source { file: name.to_owned(), ..Source::default() },
                constants: Vec::new(),
                states: Vec::new(),
                intermediates: Vec::new(),
                nodes: Nodes::default(),
                roles,
                notes: Vec::new(),
            },
        }
    }

    /// Adds a node.
    ///
    /// # Panics
    /// More nodes than a model may have.
    pub fn node(&mut self, node: Node) -> Expression {
        match self.equations.nodes.push(node) {
            Ok(place) => place,
            Err(error) => panic!("{error}"),
        }
    }

    /// A number.
    pub fn number(&mut self, number: f64) -> Expression {
        self.node(Node::Number(number))
    }

    /// An operation on two values.
    pub fn two(&mut self, operation: BinaryOperation, a: Expression, b: Expression) -> Expression {
        self.node(Node::Binary(operation, a, b))
    }

    /// An operation on one value.
    pub fn one(&mut self, operation: UnaryOperation, a: Expression) -> Expression {
        self.node(Node::Unary(operation, a))
    }

    /// Adds a constant and returns its value.
    pub fn constant(&mut self, name: &str, value: f64) -> Expression {
        let index = self.equations.constants.len() as u32;
        self.equations.constants.push(Constant {
            name: name.to_owned(),
            unit: String::new(),
            value,
            meaning: String::new(),
            place: place(),
        });
        self.node(Node::Constant(index))
    }

    /// Adds a state, whose rate follows by [`Self::rate`], and returns its value.
    pub fn state(&mut self, name: &str, unit: &str, start: f64) -> Expression {
        let index = self.equations.states.len() as u32;
        let value = self.node(Node::State(index));
        self.equations.states.push(State {
            name: name.to_owned(),
            unit: unit.to_owned(),
            start,
            rate: value,
            meaning: String::new(),
            place: place(),
        });
        value
    }

    /// Sets the rate of a state, by index.
    pub fn rate(&mut self, state: usize, rate: Expression) {
        self.equations.states[state].rate = rate;
    }

    /// Sets the stimulus of the equations.
    pub fn stimulus(&mut self, amplitude: f64, duration_ms: f64, unit: &str) {
        let role = &mut self.equations.roles.stimulus;
        (role.default.amplitude, role.default.duration_ms) = (amplitude, duration_ms);
        unit.clone_into(&mut role.unit);
    }

    /// The potential has no dimension.
    pub fn without_millivolts(&mut self) {
        self.equations.roles.potential.millivolts = None;
    }

    /// The equations.
    pub fn done(self) -> Equations {
        self.equations
    }
}

/// A membrane that relaxes to -80 mV within 10 ms: `dV/dt = (-80 - V)/10 + stimulus`.
pub fn decay() -> Equations {
    use BinaryOperation::{Add, Multiply, Subtract};
    let mut builder = Builder::new("decay");
    let v = builder.state("membrane.V", "mV", -80.0);
    let rest = builder.constant("membrane.rest", -80.0);
    let rate = builder.constant("membrane.rate", 0.1);
    let off = builder.two(Subtract, rest, v);
    let leak = builder.two(Multiply, rate, off);
    let stimulus = builder.node(Node::Stimulus);
    let sum = builder.two(Add, leak, stimulus);
    builder.rate(0, sum);
    builder.done()
}

/// The oscillator of `FitzHugh` and Nagumo (1961) with 10 ms per unit of its time:
/// `dv/dt = v - v^3/3 - w + z`, `dw/dt = (v + a - b w)/tau`; with `z` between 0.34 and 1.41 it beats
/// by itself.
pub fn fitzhugh(z: f64) -> Equations {
    use BinaryOperation::{Add, Divide, Multiply, Power, Subtract};
    let mut builder = Builder::new("fitzhugh");
    let v = builder.state("membrane.v", "", -1.2);
    let w = builder.state("membrane.w", "", -0.6);
    let [z, a, b, tau, unit] = [("z", z), ("a", 0.7), ("b", 0.8), ("tau", 12.5), ("time", 10.0)]
        .map(|(name, value)| builder.constant(&format!("membrane.{name}"), value));
    let three = builder.number(3.0);
    let cube = builder.two(Power, v, three);
    let third = builder.two(Divide, cube, three);
    let sum = builder.two(Subtract, v, third);
    let sum = builder.two(Subtract, sum, w);
    let sum = builder.two(Add, sum, z);
    let stimulus = builder.node(Node::Stimulus);
    let quick = builder.two(Divide, sum, unit);
    let quick = builder.two(Add, quick, stimulus);
    let drive = builder.two(Add, v, a);
    let back = builder.two(Multiply, b, w);
    let slow = builder.two(Subtract, drive, back);
    let slow = builder.two(Divide, slow, tau);
    let slow = builder.two(Divide, slow, unit);
    builder.rate(0, quick);
    builder.rate(1, slow);
    builder.stimulus(0.2, 5.0, "1/ms");
    builder.without_millivolts();
    builder.done()
}
