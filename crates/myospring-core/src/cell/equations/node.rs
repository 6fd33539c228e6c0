//! Nodes of expressions: one list for all equations, children before parents.

use std::fmt;

/// The most nodes that one model may have.
pub const MOST_NODES: usize = 1 << 20;

/// A place in a list of nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Expression(u32);

impl Expression {
    /// Its index in the list.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// One operation or value. Conditions are numbers: 0 is false, every other number is true, and an
/// operation that is true gives 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Node {
    /// A number.
    Number(f64),
    /// Time since the start, ms.
    Time,
    /// The stimulus, as [`StimulusRole`](super::StimulusRole) describes it: 0 without one.
    Stimulus,
    /// The value of a constant, by index.
    Constant(u32),
    /// The value of a state, by index.
    State(u32),
    /// The value of an intermediate, by index; its expression lies before this node.
    Intermediate(u32),
    /// An operation on one value.
    Unary(UnaryOperation, Expression),
    /// An operation on two values.
    Binary(BinaryOperation, Expression, Expression),
    /// The second value if the first is true, else the third. The one that is not chosen may be
    /// NaN or infinite and does not change the result.
    Select(Expression, Expression, Expression),
}

/// An operation on one value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum UnaryOperation {
    /// `-x`
    Negative,
    /// 1 where x is 0, else 0.
    Not,
    /// `|x|`
    Absolute,
    /// `e^x`
    Exponential,
    /// Natural logarithm.
    Logarithm,
    /// Logarithm to base 10.
    Logarithm10,
    /// Square root.
    SquareRoot,
    /// The largest whole number not above x.
    Floor,
    /// The smallest whole number not below x.
    Ceiling,
    /// Sine of an angle in radians.
    Sine,
    /// Cosine of an angle in radians.
    Cosine,
    /// Tangent of an angle in radians.
    Tangent,
    /// Inverse of the sine, radians.
    ArcSine,
    /// Inverse of the cosine, radians.
    ArcCosine,
    /// Inverse of the tangent, radians.
    ArcTangent,
    /// Hyperbolic sine.
    HyperbolicSine,
    /// Hyperbolic cosine.
    HyperbolicCosine,
    /// Hyperbolic tangent.
    HyperbolicTangent,
    /// Inverse of the hyperbolic sine.
    AreaSine,
    /// Inverse of the hyperbolic cosine.
    AreaCosine,
    /// Inverse of the hyperbolic tangent.
    AreaTangent,
}

/// An operation on two values, `a` and `b`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BinaryOperation {
    /// `a + b`
    Add,
    /// `a - b`
    Subtract,
    /// `a b`
    Multiply,
    /// `a / b`
    Divide,
    /// `a^b`
    Power,
    /// The smaller one.
    Minimum,
    /// The larger one.
    Maximum,
    /// `a - b floor(a / b)`: the remainder has the sign of `b`.
    Remainder,
    /// `a < b`
    Less,
    /// `a <= b`
    LessOrEqual,
    /// `a > b`
    Greater,
    /// `a >= b`
    GreaterOrEqual,
    /// `a == b`
    Equal,
    /// `a != b`
    NotEqual,
    /// Both are true.
    And,
    /// At least one is true.
    Or,
}

impl UnaryOperation {
    /// Its value at `x`.
    pub fn of(self, x: f64) -> f64 {
        match self {
            Self::Negative => -x,
            Self::Not => f64::from(u8::from(x == 0.0)),
            Self::Absolute => x.abs(),
            Self::Exponential => x.exp(),
            Self::Logarithm => x.ln(),
            Self::Logarithm10 => x.log10(),
            Self::SquareRoot => x.sqrt(),
            Self::Floor => x.floor(),
            Self::Ceiling => x.ceil(),
            Self::Sine => x.sin(),
            Self::Cosine => x.cos(),
            Self::Tangent => x.tan(),
            Self::ArcSine => x.asin(),
            Self::ArcCosine => x.acos(),
            Self::ArcTangent => x.atan(),
            Self::HyperbolicSine => x.sinh(),
            Self::HyperbolicCosine => x.cosh(),
            Self::HyperbolicTangent => x.tanh(),
            Self::AreaSine => x.asinh(),
            Self::AreaCosine => x.acosh(),
            Self::AreaTangent => x.atanh(),
        }
    }
}

impl BinaryOperation {
    /// Its value at `a` and `b`.
    pub fn of(self, a: f64, b: f64) -> f64 {
        let truth = |condition: bool| f64::from(u8::from(condition));
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Multiply => a * b,
            Self::Divide => a / b,
            Self::Power => a.powf(b),
            Self::Minimum => a.min(b),
            Self::Maximum => a.max(b),
            Self::Remainder => a - b * (a / b).floor(),
            Self::Less => truth(a < b),
            Self::LessOrEqual => truth(a <= b),
            Self::Greater => truth(a > b),
            Self::GreaterOrEqual => truth(a >= b),
            Self::Equal => truth(a == b),
            Self::NotEqual => truth(a != b),
            Self::And => truth(a != 0.0 && b != 0.0),
            Self::Or => truth(a != 0.0 || b != 0.0),
        }
    }
}

impl Node {
    /// The nodes that it needs.
    pub fn operands(self) -> impl Iterator<Item = Expression> {
        let operands = match self {
            Self::Unary(_, a) => [Some(a), None, None],
            Self::Binary(_, a, b) => [Some(a), Some(b), None],
            Self::Select(condition, then, otherwise) => {
                [Some(condition), Some(then), Some(otherwise)]
            }
            _ => [None; 3],
        };
        operands.into_iter().flatten()
    }
}

/// A model has more than [`MOST_NODES`] nodes, or a node refers to one after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the equations have more than {MOST_NODES} operations")]
pub struct TooManyNodes;

/// A list of nodes in which each node refers only to earlier ones.
#[derive(Clone, Default, PartialEq)]
pub struct Nodes(Vec<Node>);

impl fmt::Debug for Nodes {
    fn fmt(&self, form: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(form, "Nodes({})", self.0.len())
    }
}

impl Nodes {
    /// Adds a node and returns its place.
    ///
    /// # Errors
    /// More than [`MOST_NODES`].
    ///
    /// # Panics
    /// If the node refers to a place that this list does not have yet: an error of the program.
    pub fn push(&mut self, node: Node) -> Result<Expression, TooManyNodes> {
        let next = self.0.len();
        if next >= MOST_NODES {
            return Err(TooManyNodes);
        }
        assert!(node.operands().all(|operand| operand.index() < next), "operands come first");
        self.0.push(node);
        Ok(Expression(next as u32))
    }

    /// The node at a place.
    pub fn node(&self, expression: Expression) -> Node {
        self.0[expression.index()]
    }

    /// All nodes in order, with their places.
    pub fn iter(&self) -> impl Iterator<Item = (Expression, Node)> {
        self.0.iter().enumerate().map(|(index, &node)| (Expression(index as u32), node))
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Evaluates all nodes in order into `values`; `intermediates` are the places of the
    /// intermediates' expressions.
    pub fn evaluate(
        &self,
        constants: &[f64],
        states: &[f64],
        time_ms: f64,
        stimulus: f64,
        intermediates: &[Expression],
        values: &mut Vec<f64>,
    ) {
        values.clear();
        values.reserve(self.0.len());
        for &node in &self.0 {
            let of = |place: Expression| values[place.index()];
            let value = match node {
                Node::Number(number) => number,
                Node::Time => time_ms,
                Node::Stimulus => stimulus,
                Node::Constant(index) => constants[index as usize],
                Node::State(index) => states[index as usize],
                Node::Intermediate(index) => of(intermediates[index as usize]),
                Node::Unary(operation, a) => operation.of(of(a)),
                Node::Binary(operation, a, b) => operation.of(of(a), of(b)),
                Node::Select(condition, then, otherwise) => {
                    of(if of(condition) == 0.0 { otherwise } else { then })
                }
            };
            values.push(value);
        }
    }
}
