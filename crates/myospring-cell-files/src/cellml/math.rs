//! MathML of CellML: content markup to formulas.

use super::element::line;
use super::tree::{Equation, Formula, Step};
use super::units;
use crate::draft::{DEEPEST, Problem};
use crate::unit::Unit;
use myospring_core::cell::equations::{BinaryOperation as B, UnaryOperation as U};
use roxmltree::Node;
use std::collections::HashMap;

const MATHML: &str = "http://www.w3.org/1998/Math/MathML";

/// The most operations of one formula.
const LONGEST: usize = 100_000;

/// The equations of a `math` element.
pub(super) fn equations(
    math: Node<'_, '_>,
    known: &HashMap<String, Unit>,
) -> Result<Vec<Equation>, Problem> {
    math.children().filter(Node::is_element).map(|child| equation(child, known)).collect()
}

/// Whether an element is one of MathML.
pub(super) fn is_math(node: Node<'_, '_>) -> bool {
    node.is_element() && node.tag_name().namespace() == Some(MATHML)
}

fn equation(apply: Node<'_, '_>, known: &HashMap<String, Unit>) -> Result<Equation, Problem> {
    let at = line(apply);
    let mut parts = elements(apply);
    let is_equation = apply.tag_name().name() == "apply"
        && parts.first().is_some_and(|first| first.tag_name().name() == "eq");
    if !is_equation || parts.len() != 3 {
        return Err(Problem::at(at, "an equation must be <apply> with <eq/> and two sides"));
    }
    let right = parts.remove(2);
    let left = parts.remove(1);
    let (left, by) = match left.tag_name().name() {
        "ci" => (text(left), None),
        "apply"
            if elements(left).first().is_some_and(|first| first.tag_name().name() == "diff") =>
        {
            let (name, by) = derivative(left)?;
            (name, Some(by))
        }
        _ => {
            let reason = "the left side of an equation must be a variable or its derivative; \
                          equations that need a solver cannot be read";
            return Err(Problem::at(at, reason));
        }
    };
    let mut reader = Reader { formula: Formula::default(), known };
    reader.value(right, 0)?;
    Ok(Equation { left, by, right: reader.formula, line: at })
}

fn elements<'a, 'b>(node: Node<'a, 'b>) -> Vec<Node<'a, 'b>> {
    let is_content = |child: &Node<'a, 'b>| {
        child.is_element() && !matches!(child.tag_name().name(), "annotation" | "annotation-xml")
    };
    node.children().filter(is_content).collect()
}

fn text(node: Node<'_, '_>) -> String {
    node.text().unwrap_or("").trim().to_owned()
}

/// Variable and the one it is derived by, of `<apply><diff/><bvar/>...`.
fn derivative(apply: Node<'_, '_>) -> Result<(String, String), Problem> {
    let at = line(apply);
    let parts = elements(apply);
    let &[_, bvar, of] = parts.as_slice() else {
        return Err(Problem::at(at, "a derivative needs <bvar> and one variable"));
    };
    let inside = elements(bvar);
    let first_order = inside.iter().all(|part| {
        part.tag_name().name() == "ci"
            || elements(*part).first().is_some_and(|cn| text(*cn).parse() == Ok(1.0))
    });
    let by = inside.iter().find(|part| part.tag_name().name() == "ci");
    match by {
        Some(&by) if first_order && of.tag_name().name() == "ci" => Ok((text(of), text(by))),
        _ => Err(Problem::at(at, "only first derivatives of variables can be read")),
    }
}

struct Reader<'a> {
    formula: Formula,
    known: &'a HashMap<String, Unit>,
}

impl Reader<'_> {
    fn push(&mut self, step: Step) -> Result<usize, Problem> {
        if self.formula.steps.len() >= LONGEST {
            return Err(Problem::new(format!("an equation has more than {LONGEST} operations")));
        }
        self.formula.steps.push(step);
        Ok(self.formula.steps.len() - 1)
    }

    fn number(&mut self, number: f64) -> Result<usize, Problem> {
        self.push(Step::Number(number))
    }

    fn unary(&mut self, operation: U, a: usize) -> Result<usize, Problem> {
        match (operation, self.formula.steps[a]) {
            (U::Negative, Step::Number(number)) => self.number(-number),
            _ => self.push(Step::Unary(operation, a)),
        }
    }

    fn binary(&mut self, operation: B, a: usize, b: usize) -> Result<usize, Problem> {
        self.push(Step::Binary(operation, a, b))
    }

    fn name(&mut self, name: String) -> usize {
        let names = &mut self.formula.names;
        names.iter().position(|own| *own == name).unwrap_or_else(|| {
            names.push(name);
            names.len() - 1
        })
    }

    fn value(&mut self, node: Node<'_, '_>, depth: usize) -> Result<usize, Problem> {
        let at = |problem: Problem| Problem { line: problem.line.or(Some(line(node))), ..problem };
        if depth > DEEPEST {
            return Err(at(Problem::new(format!(
                "the equation is nested more than {DEEPEST} deep"
            ))));
        }
        self.any(node, depth).map_err(at)
    }

    fn any(&mut self, node: Node<'_, '_>, depth: usize) -> Result<usize, Problem> {
        match node.tag_name().name() {
            "ci" => {
                let place = self.name(text(node));
                self.push(Step::Variable(place))
            }
            "cn" => {
                let number = literal(node, self.known)?;
                self.number(number)
            }
            "apply" => self.apply(node, depth),
            "piecewise" => self.piecewise(node, depth),
            "pi" => self.number(std::f64::consts::PI),
            "exponentiale" => self.number(std::f64::consts::E),
            "infinity" => self.number(f64::INFINITY),
            "notanumber" => self.number(f64::NAN),
            "true" => self.number(1.0),
            "false" => self.number(0.0),
            "semantics" => match elements(node).first() {
                Some(&first) => self.value(first, depth + 1),
                None => Err(Problem::new("<semantics> is empty")),
            },
            other => Err(Problem::new(format!("<{other}> cannot be read in equations of CellML"))),
        }
    }

    fn piecewise(&mut self, node: Node<'_, '_>, depth: usize) -> Result<usize, Problem> {
        let parts = elements(node);
        let mut pieces = Vec::new();
        let mut otherwise = None;
        for part in parts {
            let inside = elements(part);
            match (part.tag_name().name(), inside.as_slice()) {
                ("piece", &[value, condition]) => {
                    let condition = self.value(condition, depth + 1)?;
                    pieces.push((condition, self.value(value, depth + 1)?));
                }
                ("otherwise", &[value]) if otherwise.is_none() => {
                    otherwise = Some(self.value(value, depth + 1)?);
                }
                _ => {
                    return Err(Problem::at(line(part), "a <piece> needs a value and a condition"));
                }
            }
        }
        let rest = match otherwise {
            Some(rest) => rest,
            None => self.number(f64::NAN)?,
        };
        pieces.into_iter().rev().try_fold(rest, |rest, (condition, value)| {
            self.push(Step::Select(condition, value, rest))
        })
    }

    fn apply(&mut self, node: Node<'_, '_>, depth: usize) -> Result<usize, Problem> {
        let mut parts = elements(node);
        if parts.is_empty() {
            return Err(Problem::new("<apply> is empty"));
        }
        let operator = parts.remove(0);
        let name = operator.tag_name().name();
        if name == "diff" {
            let (name, _) = derivative(node)?;
            let place = self.name(name);
            return self.push(Step::Rate(place));
        }
        let qualifier = matches!(name, "root" | "log")
            .then(|| {
                parts.iter().position(|part| matches!(part.tag_name().name(), "degree" | "logbase"))
            })
            .flatten()
            .map(|place| parts.remove(place));
        let qualifier = match qualifier {
            None => None,
            Some(outer) => match elements(outer).as_slice() {
                &[inner] => Some(self.value(inner, depth + 1)?),
                _ => return Err(Problem::new("<degree> and <logbase> hold one value")),
            },
        };
        let mut values = Vec::new();
        for part in parts {
            values.push(self.value(part, depth + 1)?);
        }
        self.operation(name, qualifier, &values)
    }

    fn operation(
        &mut self,
        name: &str,
        qualifier: Option<usize>,
        values: &[usize],
    ) -> Result<usize, Problem> {
        if let Some(value) = self.special(name, qualifier, values)? {
            return Ok(value);
        }
        if let (Some((operation, inverted)), &[value]) = (elementary(name), values) {
            return self.reciprocal(operation, inverted, value);
        }
        if let (Some(operation), &[first, ref rest @ ..]) = (chained(name), values) {
            return rest.iter().try_fold(first, |left, &right| self.binary(operation, left, right));
        }
        if let (Some(operation), &[_, _, ..]) = (relation(name), values) {
            let mut all = None;
            for pair in values.windows(2) {
                let own = self.binary(operation, pair[0], pair[1])?;
                all = Some(match all {
                    None => own,
                    Some(others) => self.binary(B::And, others, own)?,
                });
            }
            return all.ok_or_else(|| Problem::new("a comparison needs two values"));
        }
        let known =
            elementary(name).is_some() || chained(name).is_some() || relation(name).is_some();
        Err(Problem::new(
            if known || matches!(name, "minus" | "divide" | "power" | "rem" | "not" | "xor") {
                format!("<{name}/> cannot take {} values", values.len())
            } else {
                format!("<{name}/> cannot be read in equations of CellML")
            },
        ))
    }

    /// Operators that are neither functions of one value nor chains.
    fn special(
        &mut self,
        name: &str,
        qualifier: Option<usize>,
        values: &[usize],
    ) -> Result<Option<usize>, Problem> {
        Ok(Some(match (name, values) {
            ("minus", &[a]) => self.unary(U::Negative, a)?,
            ("minus", &[a, b]) => self.binary(B::Subtract, a, b)?,
            ("divide", &[a, b]) => self.binary(B::Divide, a, b)?,
            ("power", &[a, b]) => self.binary(B::Power, a, b)?,
            ("quotient", &[a, b]) => {
                let ratio = self.binary(B::Divide, a, b)?;
                self.truncated(ratio)?
            }
            ("rem", &[a, b]) => {
                let ratio = self.binary(B::Divide, a, b)?;
                let whole = self.truncated(ratio)?;
                let part = self.binary(B::Multiply, b, whole)?;
                self.binary(B::Subtract, a, part)?
            }
            ("root", &[a]) => match qualifier {
                None => self.unary(U::SquareRoot, a)?,
                Some(degree) if self.formula.steps[degree] == Step::Number(2.0) => {
                    self.unary(U::SquareRoot, a)?
                }
                Some(degree) => {
                    let one = self.number(1.0)?;
                    let exponent = self.binary(B::Divide, one, degree)?;
                    self.binary(B::Power, a, exponent)?
                }
            },
            ("log", &[a]) => match qualifier {
                None => self.unary(U::Logarithm10, a)?,
                Some(base) => {
                    let (a, base) = (self.unary(U::Logarithm, a)?, self.unary(U::Logarithm, base)?);
                    self.binary(B::Divide, a, base)?
                }
            },
            ("xor", &[a, b]) => {
                let (a, b) = (self.unary(U::Not, a)?, self.unary(U::Not, b)?);
                self.binary(B::NotEqual, a, b)?
            }
            ("plus", &[]) => self.number(0.0)?,
            ("times", &[]) => self.number(1.0)?,
            _ => return Ok(None),
        }))
    }

    /// The whole part, towards zero.
    fn truncated(&mut self, a: usize) -> Result<usize, Problem> {
        let zero = self.number(0.0)?;
        let below = self.binary(B::Less, a, zero)?;
        let (up, down) = (self.unary(U::Ceiling, a)?, self.unary(U::Floor, a)?);
        self.push(Step::Select(below, up, down))
    }

    /// `f(a)`, `1/f(a)` or `f(1/a)`.
    fn reciprocal(&mut self, operation: U, inverted: Inverted, a: usize) -> Result<usize, Problem> {
        let one = if inverted == Inverted::No { a } else { self.number(1.0)? };
        match inverted {
            Inverted::No => self.unary(operation, a),
            Inverted::Result => {
                let value = self.unary(operation, a)?;
                self.binary(B::Divide, one, value)
            }
            Inverted::Argument => {
                let inverse = self.binary(B::Divide, one, a)?;
                self.unary(operation, inverse)
            }
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Inverted {
    No,
    Result,
    Argument,
}

fn elementary(name: &str) -> Option<(U, Inverted)> {
    use Inverted::{Argument, No, Result};
    Some(match name {
        "exp" => (U::Exponential, No),
        "ln" => (U::Logarithm, No),
        "abs" => (U::Absolute, No),
        "floor" => (U::Floor, No),
        "ceiling" => (U::Ceiling, No),
        "not" => (U::Not, No),
        "sin" => (U::Sine, No),
        "cos" => (U::Cosine, No),
        "tan" => (U::Tangent, No),
        "sec" => (U::Cosine, Result),
        "csc" => (U::Sine, Result),
        "cot" => (U::Tangent, Result),
        "sinh" => (U::HyperbolicSine, No),
        "cosh" => (U::HyperbolicCosine, No),
        "tanh" => (U::HyperbolicTangent, No),
        "sech" => (U::HyperbolicCosine, Result),
        "csch" => (U::HyperbolicSine, Result),
        "coth" => (U::HyperbolicTangent, Result),
        "arcsin" => (U::ArcSine, No),
        "arccos" => (U::ArcCosine, No),
        "arctan" => (U::ArcTangent, No),
        "arcsec" => (U::ArcCosine, Argument),
        "arccsc" => (U::ArcSine, Argument),
        "arccot" => (U::ArcTangent, Argument),
        "arcsinh" => (U::AreaSine, No),
        "arccosh" => (U::AreaCosine, No),
        "arctanh" => (U::AreaTangent, No),
        "arcsech" => (U::AreaCosine, Argument),
        "arccsch" => (U::AreaSine, Argument),
        "arccoth" => (U::AreaTangent, Argument),
        _ => return None,
    })
}

fn chained(name: &str) -> Option<B> {
    Some(match name {
        "plus" => B::Add,
        "times" => B::Multiply,
        "min" => B::Minimum,
        "max" => B::Maximum,
        "and" => B::And,
        "or" => B::Or,
        _ => return None,
    })
}

fn relation(name: &str) -> Option<B> {
    Some(match name {
        "eq" => B::Equal,
        "neq" => B::NotEqual,
        "lt" => B::Less,
        "leq" => B::LessOrEqual,
        "gt" => B::Greater,
        "geq" => B::GreaterOrEqual,
        _ => return None,
    })
}

/// The number of a `cn`.
fn literal(node: Node<'_, '_>, known: &HashMap<String, Unit>) -> Result<f64, Problem> {
    let unit = node.attributes().find(|own| own.name() == "units").map(|own| own.value());
    if let Some(unit) = unit
        && units::find(unit, known).is_none()
    {
        return Err(Problem::new(format!("the unit `{unit}` is not defined")));
    }
    let pieces: Vec<&str> =
        node.children().filter_map(|child| child.text()).map(str::trim).collect();
    let separated = node.children().any(|child| child.tag_name().name() == "sep");
    let number = |text: &str| text.parse::<f64>().ok();
    let value = match (node.attribute("type").unwrap_or("real"), separated, pieces.as_slice()) {
        ("e-notation", true, &[mantissa, exponent]) => number(&format!("{mantissa}e{exponent}")),
        ("rational", true, &[above, below]) => number(above).zip(number(below)).map(|(a, b)| a / b),
        ("real" | "integer" | "e-notation", false, &[text]) => number(text),
        _ => None,
    };
    value.ok_or_else(|| Problem::new(format!("`{}` is not a number", pieces.join(" "))))
}
