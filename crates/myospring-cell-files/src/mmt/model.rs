//! The model section: meta data, initial values, components, variables.

use super::expression::{Expressions, Scope};
use super::lexer::{Placed, Token};
use crate::draft::{Draft, DraftVariable, Id, Kind, Problem};
use crate::unit::{Unit, milliseconds};
use myospring_core::cell::equations::Place;
use std::collections::HashMap;

pub(super) fn parse(tokens: Vec<Placed>) -> Result<Draft, Problem> {
    let mut parser = Parser {
        at: Expressions::new(tokens),
        draft: Draft { milliseconds: 1.0, ..Draft::default() },
        starts: Vec::new(),
        aliases: HashMap::new(),
        component: String::new(),
        is_state: Vec::new(),
    };
    parser.header()?;
    while parser.at.peek() != &Token::EndOfFile {
        parser.component()?;
    }
    parser.finish()
}

struct Parser {
    at: Expressions,
    draft: Draft,
    /// Initial values in order: name, value, line.
    starts: Vec<(String, Id, usize)>,
    /// Aliases by component and name.
    aliases: HashMap<(String, String), String>,
    component: String,
    is_state: Vec<bool>,
}

impl Parser {
    fn header(&mut self) -> Result<(), Problem> {
        loop {
            let line = self.at.line();
            match self.at.peek().clone() {
                Token::EndOfLine | Token::Indent | Token::Dedent => {
                    self.at.next();
                }
                Token::Name(name) => {
                    self.at.next();
                    match self.at.peek().clone() {
                        Token::Sign(":") => self.meta(&name)?,
                        Token::Sign("(") => self.at.function(&mut self.draft.terms, &name)?,
                        _ => {
                            self.at.expect(".")?;
                            let own = self.at.name()?;
                            self.at.expect("=")?;
                            let scope = Scope { component: name.clone(), parents: Vec::new() };
                            let value = self.at.expression(&mut self.draft.terms, &scope)?;
                            self.at.end_of_line()?;
                            let name = format!("{name}.{own}");
                            if self.starts.iter().any(|(other, ..)| *other == name) {
                                return Err(Problem::at(
                                    line,
                                    format!("{name} has two initial values"),
                                ));
                            }
                            self.starts.push((name, value, line));
                        }
                    }
                }
                _ => return Ok(()),
            }
        }
    }

    fn meta(&mut self, key: &str) -> Result<(), Problem> {
        self.at.expect(":")?;
        let text = self.at.text();
        self.at.end_of_line()?;
        match key {
            "display_name" => self.draft.title = text,
            "name" if self.draft.title.is_empty() => self.draft.title = text,
            "desc" => {
                self.draft.citation =
                    text.split_once("References:").map_or("", |(_, rest)| rest).trim().to_owned();
            }
            _ => {}
        }
        Ok(())
    }

    fn component(&mut self) -> Result<(), Problem> {
        while matches!(self.at.peek(), Token::EndOfLine) {
            self.at.next();
        }
        if self.at.peek() == &Token::EndOfFile {
            return Ok(());
        }
        self.at.expect("[")?;
        self.component = self.at.name()?;
        self.at.expect("]")?;
        let component = self.component.clone();
        self.fields().map_err(|problem| problem.within(&component))
    }

    fn fields(&mut self) -> Result<(), Problem> {
        loop {
            match self.at.peek().clone() {
                Token::EndOfLine => {
                    self.at.next();
                }
                Token::Name(word) if word == "use" && self.at.after_is_name() => self.aliases()?,
                Token::Name(_) if self.at.after_is(":") => {
                    self.at.next();
                    self.at.next();
                    self.at.text();
                    self.at.end_of_line()?;
                }
                Token::Name(_) => self.variable(&[])?,
                Token::Sign("[") | Token::EndOfFile => return Ok(()),
                _ => return Err(self.at.unexpected("a variable `name = expression`")),
            }
        }
    }

    fn aliases(&mut self) -> Result<(), Problem> {
        self.at.next();
        loop {
            let mut name = self.at.name()?;
            self.at.expect(".")?;
            let own = self.at.name()?;
            name = format!("{name}.{own}");
            let alias = if self.at.take_word("as") { self.at.name()? } else { own };
            self.aliases.insert((self.component.clone(), alias), name);
            if !self.at.take(",") {
                return self.at.end_of_line();
            }
        }
    }

    fn variable(&mut self, parents: &[String]) -> Result<(), Problem> {
        if parents.len() > 20 {
            return Err(Problem::at(self.at.line(), "variables are nested more than 20 deep"));
        }
        let line = self.at.line();
        let mut name = self.at.name()?;
        let is_state = name == "dot" && self.at.take("(");
        if is_state {
            name = self.at.name()?;
            self.at.expect(")")?;
        }
        let mut path = parents.to_vec();
        path.push(name);
        let scope = Scope { component: self.component.clone(), parents: path.clone() };
        let full = format!("{}.{}", self.component, path.join("."));
        self.at.expect("=")?;
        let value = self.at.expression(&mut self.draft.terms, &scope)?;
        if self.draft.variables.iter().any(|other| other.name == full) {
            return Err(Problem::at(line, format!("two variables are named {full}")));
        }
        let index = self.draft.variables.len();
        self.is_state.push(is_state);
        self.draft.variables.push(DraftVariable {
            name: full,
            unit: None,
            meaning: String::new(),
            place: Place { file: None, line },
            tags: Vec::new(),
            kind: Kind::Value(value),
        });
        self.details(index)?;
        self.at.end_of_line()?;
        if self.at.peek() == &Token::Indent {
            self.at.next();
            while self.at.peek() != &Token::Dedent && self.at.peek() != &Token::EndOfFile {
                let before = self.at.place();
                self.details(index)?;
                if self.at.place() == before {
                    match self.at.peek() {
                        Token::Name(_) => self.variable(&path)?,
                        Token::EndOfLine => {
                            self.at.next();
                        }
                        _ => return Err(self.at.unexpected("a property or a nested variable")),
                    }
                }
            }
            self.at.next();
        }
        Ok(())
    }

    /// Unit, binding, label and description, as many as follow on this line.
    fn details(&mut self, index: usize) -> Result<(), Problem> {
        loop {
            if self.at.after_is("=") {
                return Ok(());
            }
            if matches!(self.at.peek(), Token::Name(_)) && self.at.after_is(":") {
                let key = self.at.name()?;
                self.at.next();
                let text = self.at.text();
                if key == "desc" {
                    self.draft.variables[index].meaning = text;
                }
                return Ok(());
            }
            if self.at.take_word("in") {
                let unit: Unit = self.at.bracketed_unit()?;
                self.draft.variables[index].unit = Some(unit);
            } else if self.at.take_word("bind") {
                let name = self.at.name()?;
                self.draft.variables[index].tags.push(format!("bind {name}"));
            } else if self.at.take_word("label") {
                let name = self.at.name()?;
                self.draft.variables[index].tags.push(format!("label {name}"));
            } else if self.at.take(":") {
                self.draft.variables[index].meaning = self.at.text();
                return Ok(());
            } else {
                return Ok(());
            }
        }
    }

    fn finish(mut self) -> Result<Draft, Problem> {
        let names: HashMap<String, usize> = self
            .draft
            .variables
            .iter()
            .enumerate()
            .map(|(index, variable)| (variable.name.clone(), index))
            .collect();
        self.at.resolve(&mut self.draft.terms, &names, &self.aliases)?;
        for (name, start, line) in &self.starts {
            let state = names.get(name).copied().filter(|&index| self.is_state[index]);
            let Some(index) = state else {
                return Err(Problem::at(
                    *line,
                    format!("{name} has an initial value but no dot({name})"),
                ));
            };
            if let Kind::Value(rate) = self.draft.variables[index].kind {
                self.draft.variables[index].kind = Kind::State { start: *start, rate };
                self.draft.states.push(index);
            }
        }
        for (index, variable) in self.draft.variables.iter_mut().enumerate() {
            if self.is_state[index] && matches!(variable.kind, Kind::Value(_)) {
                return Err(Problem::of(
                    variable,
                    format!("the state {} has no initial value", variable.name),
                ));
            }
            if variable.tags.iter().any(|tag| tag == "bind time") {
                variable.kind = Kind::Time;
                match variable.unit.map(|unit| unit.in_units_of(Unit::SECOND)) {
                    Some(Some(seconds)) => {
                        self.draft.milliseconds = milliseconds(seconds);
                    }
                    None => self
                        .draft
                        .notes
                        .push("Time has no unit in the file; ms is assumed.".to_owned()),
                    Some(None) => {
                        return Err(Problem::of(variable, "the unit of time is not a time"));
                    }
                }
            }
        }
        Ok(self.draft)
    }
}
