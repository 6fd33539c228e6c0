//! Expressions of `.mmt` files, by binding powers, as Myokit reads them.

use super::lexer::{Placed, Token};
use crate::draft::{DEEPEST, Id, Problem, Term, Terms};
use crate::unit::Unit;
use myospring_core::cell::equations::{BinaryOperation as B, UnaryOperation as U};
use std::collections::HashMap;

/// Where an expression stands: its component, and the variables that it is nested in, itself last.
#[derive(Debug, Clone)]
pub(super) struct Scope {
    pub(super) component: String,
    pub(super) parents: Vec<String>,
}

/// A name that is resolved once all variables are known.
struct Pending {
    term: Id,
    name: String,
    scope: Scope,
    line: usize,
}

/// A function of the file: names of its arguments, and its expression as tokens.
#[derive(Clone)]
struct Function {
    name: String,
    arguments: Vec<String>,
    body: Vec<Placed>,
}

/// The tokens, and what reads expressions from them.
pub(super) struct Expressions {
    tokens: Vec<Placed>,
    next: usize,
    pending: Vec<Pending>,
    functions: Vec<Function>,
    /// Arguments of the functions being expanded, innermost last.
    bound: Vec<HashMap<String, Id>>,
    depth: usize,
}

const PREFIX: u8 = 50;

impl Expressions {
    pub(super) fn new(tokens: Vec<Placed>) -> Self {
        Self {
            tokens,
            next: 0,
            pending: Vec::new(),
            functions: Vec::new(),
            bound: Vec::new(),
            depth: 0,
        }
    }

    pub(super) fn peek(&self) -> &Token {
        self.tokens.get(self.next).map_or(&Token::EndOfFile, |(token, _)| token)
    }

    pub(super) fn line(&self) -> usize {
        let last = self.tokens.last().map_or(1, |&(_, line)| line);
        self.tokens.get(self.next).map_or(last, |&(_, line)| line)
    }

    pub(super) fn place(&self) -> usize {
        self.next
    }

    pub(super) fn next(&mut self) -> Token {
        let token = self.peek().clone();
        self.next += 1;
        token
    }

    pub(super) fn after_is(&self, sign: &str) -> bool {
        matches!(self.tokens.get(self.next + 1), Some((Token::Sign(own), _)) if *own == sign)
    }

    pub(super) fn after_is_name(&self) -> bool {
        matches!(self.tokens.get(self.next + 1), Some((Token::Name(_), _)))
    }

    pub(super) fn take(&mut self, sign: &str) -> bool {
        let found = matches!(self.peek(), Token::Sign(own) if *own == sign);
        self.next += usize::from(found);
        found
    }

    pub(super) fn take_word(&mut self, word: &str) -> bool {
        let found = matches!(self.peek(), Token::Name(own) if own == word);
        self.next += usize::from(found);
        found
    }

    pub(super) fn unexpected(&self, wanted: &str) -> Problem {
        let found = match self.peek() {
            Token::Name(name) => format!("`{name}`"),
            Token::Number(number) => format!("`{number}`"),
            Token::Sign(sign) => format!("`{sign}`"),
            Token::Text(_) => "a text".to_owned(),
            Token::Indent | Token::Dedent => "another indentation".to_owned(),
            Token::EndOfLine => "the end of the line".to_owned(),
            Token::EndOfFile => "the end of the model".to_owned(),
        };
        Problem::at(self.line(), format!("{wanted} is expected, not {found}"))
    }

    pub(super) fn expect(&mut self, sign: &str) -> Result<(), Problem> {
        if self.take(sign) { Ok(()) } else { Err(self.unexpected(&format!("`{sign}`"))) }
    }

    pub(super) fn name(&mut self) -> Result<String, Problem> {
        let Token::Name(name) = self.peek().clone() else { return Err(self.unexpected("a name")) };
        self.next += 1;
        Ok(name)
    }

    pub(super) fn text(&mut self) -> String {
        let Token::Text(text) = self.peek().clone() else { return String::new() };
        self.next += 1;
        text
    }

    pub(super) fn end_of_line(&mut self) -> Result<(), Problem> {
        match self.peek() {
            Token::EndOfLine => {
                self.next += 1;
                Ok(())
            }
            Token::Dedent | Token::EndOfFile => Ok(()),
            _ => Err(self.unexpected("the end of the line")),
        }
    }

    /// A function of the file, whose name has been read.
    pub(super) fn function(&mut self, _terms: &mut Terms, name: &str) -> Result<(), Problem> {
        self.expect("(")?;
        let mut arguments = Vec::new();
        while !self.take(")") {
            arguments.push(self.name()?);
            self.take(",");
        }
        self.expect("=")?;
        let first = self.next;
        while !matches!(self.peek(), Token::EndOfLine | Token::EndOfFile) {
            self.next += 1;
        }
        let mut body = self.tokens[first..self.next].to_vec();
        body.push((Token::EndOfFile, self.line()));
        self.functions.push(Function { name: name.to_owned(), arguments, body });
        self.end_of_line()
    }

    pub(super) fn expression(&mut self, terms: &mut Terms, scope: &Scope) -> Result<Id, Problem> {
        self.bounded(terms, scope, 0)
    }

    fn bounded(&mut self, terms: &mut Terms, scope: &Scope, power: u8) -> Result<Id, Problem> {
        if self.depth >= DEEPEST {
            return Err(Problem::at(
                self.line(),
                format!("the expression is nested more than {DEEPEST} deep"),
            ));
        }
        self.depth += 1;
        let line = self.line();
        let value = self.infix(terms, scope, power);
        self.depth -= 1;
        value.map_err(|problem| Problem { line: problem.line.or(Some(line)), ..problem })
    }

    fn infix(&mut self, terms: &mut Terms, scope: &Scope, power: u8) -> Result<Id, Problem> {
        let mut left = self.operand(terms, scope)?;
        loop {
            let (sign, own) = match self.peek() {
                Token::Sign(sign @ ("+" | "-")) => (*sign, 30),
                Token::Sign(sign @ ("*" | "/" | "//" | "%")) => (*sign, 40),
                Token::Sign("^") => ("^", 60),
                Token::Sign(sign @ ("==" | "!=" | "<" | ">" | "<=" | ">=")) => (*sign, 20),
                Token::Name(word) if word == "and" => ("and", 10),
                Token::Name(word) if word == "or" => ("or", 10),
                _ => return Ok(left),
            };
            if own <= power {
                return Ok(left);
            }
            self.next += 1;
            let right = self.bounded(terms, scope, own)?;
            left = match sign {
                "//" => {
                    let ratio = terms.binary(B::Divide, left, right)?;
                    terms.unary(U::Floor, ratio)?
                }
                _ => terms.binary(binary(sign), left, right)?,
            };
        }
    }

    fn operand(&mut self, terms: &mut Terms, scope: &Scope) -> Result<Id, Problem> {
        let line = self.line();
        match self.next() {
            Token::Number(value) => {
                if self.peek() == &Token::Sign("[") {
                    self.bracketed_unit()?;
                }
                terms.number(value)
            }
            Token::Sign("+") => self.bounded(terms, scope, PREFIX),
            Token::Sign("-") => {
                let value = self.bounded(terms, scope, PREFIX)?;
                terms.unary(U::Negative, value)
            }
            Token::Sign("(") => {
                let value = self.bounded(terms, scope, 0)?;
                self.expect(")")?;
                Ok(value)
            }
            Token::Name(word) if word == "not" => {
                let value = self.bounded(terms, scope, PREFIX)?;
                terms.unary(U::Not, value)
            }
            Token::Name(word) if self.peek() == &Token::Sign("(") => {
                self.call(terms, scope, &word, line)
            }
            Token::Name(mut name) => {
                if let Some(&id) = self.bound.last().and_then(|bound| bound.get(&name)) {
                    return Ok(id);
                }
                if self.take(".") {
                    name = format!("{name}.{}", self.name()?);
                }
                self.reference(terms, scope, name, line, Term::Variable(0))
            }
            _ => {
                self.next -= 1;
                Err(self.unexpected("a value"))
            }
        }
    }

    fn reference(
        &mut self,
        terms: &mut Terms,
        scope: &Scope,
        name: String,
        line: usize,
        term: Term,
    ) -> Result<Id, Problem> {
        let term = terms.push(term)?;
        self.pending.push(Pending { term, name, scope: scope.clone(), line });
        Ok(term)
    }

    fn call(
        &mut self,
        terms: &mut Terms,
        scope: &Scope,
        name: &str,
        line: usize,
    ) -> Result<Id, Problem> {
        self.expect("(")?;
        if name == "dot" {
            let mut state = self.name()?;
            if self.take(".") {
                state = format!("{state}.{}", self.name()?);
            }
            self.expect(")")?;
            return self.reference(terms, scope, state, line, Term::Rate(0));
        }
        let mut values = Vec::new();
        while !self.take(")") {
            values.push(self.bounded(terms, scope, 0)?);
            if !self.take(",") {
                self.expect(")")?;
                break;
            }
        }
        let wrong = |count: &str| {
            Problem::at(line, format!("{name}() takes {count}, not {}", values.len()))
        };
        if let Some(operation) = unary(name) {
            let &[value] = values.as_slice() else { return Err(wrong("1 value")) };
            return terms.unary(operation, value);
        }
        match (name, values.as_slice()) {
            ("log", &[value]) => terms.unary(U::Logarithm, value),
            ("log", &[value, base]) => {
                let (value, base) =
                    (terms.unary(U::Logarithm, value)?, terms.unary(U::Logarithm, base)?);
                terms.binary(B::Divide, value, base)
            }
            ("log", _) => Err(wrong("1 or 2 values")),
            ("if", &[condition, then, otherwise]) => {
                terms.push(Term::Select(condition, then, otherwise))
            }
            ("if", _) => Err(wrong("3 values")),
            ("piecewise", [pieces @ .., otherwise])
                if pieces.len() % 2 == 0 && !pieces.is_empty() =>
            {
                pieces.chunks_exact(2).rev().try_fold(*otherwise, |rest, piece| {
                    terms.push(Term::Select(piece[0], piece[1], rest))
                })
            }
            ("piecewise", _) => Err(wrong("an odd number of values, 3 or more")),
            _ => self.own_function(terms, scope, name, &values, line),
        }
    }

    fn own_function(
        &mut self,
        terms: &mut Terms,
        scope: &Scope,
        name: &str,
        values: &[Id],
        line: usize,
    ) -> Result<Id, Problem> {
        let same = |own: &&Function| own.name == name && own.arguments.len() == values.len();
        let Some(function) = self.functions.iter().find(same).cloned() else {
            let reason = format!("there is no function {name}() with {} values", values.len());
            return Err(Problem::at(line, reason));
        };
        let bound = function.arguments.iter().cloned().zip(values.iter().copied()).collect();
        self.bound.push(bound);
        let outside = (std::mem::replace(&mut self.tokens, function.body), self.next);
        self.next = 0;
        let value = self.bounded(terms, scope, 0);
        (self.tokens, self.next) = outside;
        self.bound.pop();
        value
    }

    /// A unit in brackets: `[mS/cm^2 (1000)]`.
    pub(super) fn bracketed_unit(&mut self) -> Result<Unit, Problem> {
        self.expect("[")?;
        let mut unit = Unit::ONE;
        let mut divide = false;
        loop {
            let line = self.line();
            let symbol = match self.next() {
                Token::Name(name) => name,
                Token::Number(1.0) => "1".to_owned(),
                _ => {
                    self.next -= 1;
                    return Err(self.unexpected("a unit"));
                }
            };
            let own = Unit::symbol(&symbol)
                .ok_or_else(|| Problem::at(line, format!("the unit `{symbol}` is not known")))?;
            let power = if self.take("^") { self.signed_number()? } else { 1.0 };
            unit = unit.times(own.power(if divide { -power } else { power }));
            if self.take("*") {
                divide = false;
            } else if self.take("/") {
                divide = true;
            } else {
                break;
            }
        }
        if self.take("(") {
            let mut factor = self.signed_number()?;
            while self.take("^") {
                factor = factor.powf(self.signed_number()?);
            }
            unit.factor *= factor;
            self.expect(")")?;
        }
        self.expect("]")?;
        Ok(unit)
    }

    fn signed_number(&mut self) -> Result<f64, Problem> {
        let sign = if self.take("-") { -1.0 } else { 1.0 };
        let Token::Number(number) = *self.peek() else { return Err(self.unexpected("a number")) };
        self.next += 1;
        Ok(sign * number)
    }

    /// Gives every name its variable.
    pub(super) fn resolve(
        &self,
        terms: &mut Terms,
        names: &HashMap<String, usize>,
        aliases: &HashMap<(String, String), String>,
    ) -> Result<(), Problem> {
        for pending in &self.pending {
            let Scope { component, parents } = &pending.scope;
            let found = if pending.name.contains('.') {
                names.get(&pending.name)
            } else {
                let nested = (0..=parents.len()).rev().find_map(|depth| {
                    let mut path = vec![component.as_str()];
                    path.extend(parents[..depth].iter().map(String::as_str));
                    path.push(&pending.name);
                    names.get(&path.join("."))
                });
                let alias = || aliases.get(&(component.clone(), pending.name.clone()));
                nested.or_else(|| alias().and_then(|name| names.get(name)))
            };
            let Some(&index) = found else {
                if let Some(number) = constant(&pending.name) {
                    terms.0[pending.term] = Term::Number(number);
                    continue;
                }
                let reason = format!("there is no variable `{}`", pending.name);
                return Err(Problem::at(pending.line, reason).within(component));
            };
            terms.0[pending.term] = match terms.0[pending.term] {
                Term::Rate(_) => Term::Rate(index),
                _ => Term::Variable(index),
            };
        }
        Ok(())
    }
}

/// `inf` and `nan`, where no variable has that name.
fn constant(name: &str) -> Option<f64> {
    match name {
        "inf" => Some(f64::INFINITY),
        "nan" => Some(f64::NAN),
        _ => None,
    }
}

fn binary(sign: &str) -> B {
    match sign {
        "-" => B::Subtract,
        "*" => B::Multiply,
        "/" => B::Divide,
        "%" => B::Remainder,
        "^" => B::Power,
        "==" => B::Equal,
        "!=" => B::NotEqual,
        "<" => B::Less,
        ">" => B::Greater,
        "<=" => B::LessOrEqual,
        ">=" => B::GreaterOrEqual,
        "and" => B::And,
        "or" => B::Or,
        _ => B::Add,
    }
}

fn unary(name: &str) -> Option<U> {
    Some(match name {
        "sqrt" => U::SquareRoot,
        "sin" => U::Sine,
        "cos" => U::Cosine,
        "tan" => U::Tangent,
        "asin" => U::ArcSine,
        "acos" => U::ArcCosine,
        "atan" => U::ArcTangent,
        "exp" => U::Exponential,
        "log10" => U::Logarithm10,
        "floor" => U::Floor,
        "ceil" => U::Ceiling,
        "abs" => U::Absolute,
        _ => return None,
    })
}
