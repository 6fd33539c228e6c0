//! A model to a draft: connected variables become one, with conversion of units between them.

use super::tree::{Component, Equation, Formula, Model, ModelVariable, Step};
use crate::draft::{Draft, DraftVariable, Id, Kind, Problem, Term};
use crate::unit::{Unit, milliseconds};
use myospring_core::cell::equations::{BinaryOperation as B, Place};
use std::collections::HashMap;

/// A variable of the model: component and place in it.
type Place2 = (usize, usize);

pub(super) fn draft(model: &Model) -> Result<Draft, Problem> {
    let mut finish = Finish::new(model)?;
    finish.sources()?;
    finish.variables();
    finish.times()?;
    finish.values()?;
    Ok(finish.draft)
}

struct Finish<'a> {
    model: &'a Model,
    /// Variables in one list, with component and name.
    all: Vec<Place2>,
    by_name: HashMap<(usize, &'a str), usize>,
    /// The group of connected variables of each, by its first member.
    group: Vec<usize>,
    /// The member that has the value, of each group.
    source: HashMap<usize, usize>,
    /// The equation of each variable that has one.
    equation: HashMap<usize, (usize, &'a Equation)>,
    /// The place in the draft of each group.
    place: HashMap<usize, usize>,
    draft: Draft,
}

impl<'a> Finish<'a> {
    fn new(model: &'a Model) -> Result<Self, Problem> {
        let mut all = Vec::new();
        let mut by_name = HashMap::new();
        let mut components = HashMap::new();
        for (index, component) in model.components.iter().enumerate() {
            components.insert(component.name.as_str(), index);
            for (place, variable) in component.variables.iter().enumerate() {
                by_name.insert((index, variable.name.as_str()), all.len());
                all.push((index, place));
            }
        }
        let group = (0..all.len()).collect();
        let draft = Draft {
            format: model.format.clone(),
            title: model.title.clone(),
            citation: model.citation.clone(),
            notes: model.notes.clone(),
            milliseconds: 1.0,
            ..Draft::default()
        };
        let mut own = Self {
            model,
            all,
            by_name,
            group,
            source: HashMap::new(),
            equation: HashMap::new(),
            place: HashMap::new(),
            draft,
        };
        own.connect(&components)?;
        Ok(own)
    }

    fn connect(&mut self, components: &HashMap<&str, usize>) -> Result<(), Problem> {
        for connection in &self.model.connections {
            let at = |reason: String| Problem {
                file: connection.file.clone(),
                ..Problem::at(connection.line, reason)
            };
            let mut ends = [0; 2];
            for (end, (component, variable)) in ends.iter_mut().zip(&connection.ends) {
                let Some(&index) = components.get(component.as_str()) else {
                    return Err(at(format!("there is no component `{component}`")));
                };
                let found = self.by_name.get(&(index, variable.as_str()));
                *end = *found.ok_or_else(|| {
                    at(format!("there is no variable `{variable}` in {component}"))
                })?;
            }
            let [a, b] = ends;
            let (unit_a, unit_b) = (self.variable(a).1.unit, self.variable(b).1.unit);
            if !unit_a.same_dimension(unit_b) {
                self.draft.notes.push(format!(
                    "Line {}: {} ({}) and {} ({}) are connected, but their units cannot be converted; \
                     their values are taken as equal.",
                    connection.line,
                    self.name(a),
                    unit_a.text(),
                    self.name(b),
                    unit_b.text()
                ));
            }
            let (root_a, root_b) = (self.root(a), self.root(b));
            self.group[root_b] = root_a;
        }
        for index in 0..self.group.len() {
            self.group[index] = self.root(index);
        }
        Ok(())
    }

    fn root(&mut self, mut index: usize) -> usize {
        while self.group[index] != index {
            self.group[index] = self.group[self.group[index]];
            index = self.group[index];
        }
        index
    }

    fn variable(&self, index: usize) -> (&'a Component, &'a ModelVariable) {
        let (component, place) = self.all[index];
        let component = &self.model.components[component];
        (component, &component.variables[place])
    }

    fn name(&self, index: usize) -> String {
        let (component, variable) = self.variable(index);
        format!("{}.{}", component.name, variable.name)
    }

    fn problem(&self, index: usize, reason: String) -> Problem {
        let (component, variable) = self.variable(index);
        Problem {
            file: component.file.clone(),
            ..Problem::at(variable.line, reason).within(&component.name)
        }
    }

    /// Which member of each group has the value: that with an equation, else an initial value.
    fn sources(&mut self) -> Result<(), Problem> {
        for (index, component) in self.model.components.iter().enumerate() {
            for equation in &component.equations {
                let at = |reason: String| Problem {
                    file: component.file.clone(),
                    ..Problem::at(equation.line, reason).within(&component.name)
                };
                let Some(&own) = self.by_name.get(&(index, equation.left.as_str())) else {
                    return Err(at(format!("there is no variable `{}`", equation.left)));
                };
                let group = self.group[own];
                if let Some(other) = self.source.insert(group, own) {
                    let (_, other) = self.equation[&other];
                    return Err(at(format!(
                        "{} has two equations, the other in line {}; systems that need a solver cannot be read",
                        self.name(own),
                        other.line
                    )));
                }
                self.equation.insert(own, (index, equation));
            }
        }
        for index in 0..self.all.len() {
            if self.variable(index).1.initial.is_some() {
                self.source.entry(self.group[index]).or_insert(index);
            }
        }
        Ok(())
    }

    /// Makes the variables of the draft, one for each group, without values.
    fn variables(&mut self) {
        let mut tags: HashMap<usize, Vec<String>> = HashMap::new();
        let mut owner: HashMap<usize, usize> = HashMap::new();
        for index in 0..self.all.len() {
            let group = self.group[index];
            tags.entry(group).or_default().extend(self.variable(index).1.tags.iter().cloned());
            let entry = owner.entry(group).or_insert(index);
            if self.variable(*entry).1.comes_in && !self.variable(index).1.comes_in {
                *entry = index;
            }
        }
        for index in 0..self.all.len() {
            let group = self.group[index];
            let own = *self.source.get(&group).unwrap_or(&owner[&group]);
            if own != index {
                continue;
            }
            let (component, variable) = self.variable(own);
            self.place.insert(group, self.draft.variables.len());
            self.source.entry(group).or_insert(own);
            self.draft.variables.push(DraftVariable {
                name: format!("{}.{}", component.name, variable.name),
                unit: Some(variable.unit),
                meaning: String::new(),
                place: Place { file: component.file.clone(), line: variable.line },
                tags: tags.remove(&group).unwrap_or_default(),
                kind: Kind::Value(usize::MAX),
            });
        }
    }

    /// Finds the independent variable.
    fn times(&mut self) -> Result<(), Problem> {
        let mut time: Option<usize> = None;
        let equations: Vec<(usize, usize, &Equation)> = self
            .equation
            .iter()
            .map(|(&own, &(component, equation))| (own, component, equation))
            .collect();
        for (own, component, equation) in equations {
            let Some(by) = &equation.by else { continue };
            let Some(&by) = self.by_name.get(&(component, by.as_str())) else {
                return Err(self.problem(own, format!("there is no variable `{by}`")));
            };
            let group = self.group[by];
            if time.is_some_and(|time| time != group) {
                let reason = "rates by two different variables: only one can be time".to_owned();
                return Err(self.problem(own, reason));
            }
            time = Some(group);
        }
        let Some(group) = time else { return Ok(()) };
        let source = self.source[&group];
        if self.equation.contains_key(&source) || self.variable(source).1.initial.is_some() {
            let reason =
                format!("{} is time, so it can have neither equation nor value", self.name(source));
            return Err(self.problem(source, reason));
        }
        let unit = self.variable(source).1.unit;
        match unit.in_units_of(Unit::SECOND) {
            Some(seconds) => self.draft.milliseconds = milliseconds(seconds),
            None if unit.same_dimension(Unit::ONE) => {
                self.draft.notes.push("Time has no unit in the file; ms is assumed.".to_owned());
            }
            None => return Err(self.problem(source, "the unit of time is not a time".to_owned())),
        }
        let place = self.place[&group];
        self.draft.variables[place].kind = Kind::Time;
        Ok(())
    }

    fn values(&mut self) -> Result<(), Problem> {
        for index in 0..self.all.len() {
            let group = self.group[index];
            if self.source[&group] != index
                || self.draft.variables[self.place[&group]].kind == Kind::Time
            {
                continue;
            }
            let place = self.place[&group];
            let kind = match self.equation.get(&index).copied() {
                Some((component, equation)) => {
                    let value = self.formula(component, &equation.right, equation.line)?;
                    if equation.by.is_some() {
                        let rate = self.per_time(component, equation, value)?;
                        self.draft.states.push(place);
                        Kind::State { start: self.initial(group, index)?, rate }
                    } else {
                        Kind::Value(value)
                    }
                }
                None if self.variable(index).1.initial.is_some() => {
                    Kind::Value(self.initial(group, index)?)
                }
                None => {
                    let reason = format!(
                        "{} has no value: no equation, no initial value, no connection to a variable with one",
                        self.name(index)
                    );
                    return Err(self.problem(index, reason));
                }
            };
            self.draft.variables[place].kind = kind;
        }
        Ok(())
    }

    /// A rate per unit of the time variable's source.
    fn per_time(&mut self, component: usize, equation: &Equation, rate: Id) -> Result<Id, Problem> {
        let by = equation.by.as_deref().unwrap_or("");
        let Some(&own) = self.by_name.get(&(component, by)) else { return Ok(rate) };
        let source = self.source[&self.group[own]];
        let (own, source) = (self.variable(own).1.unit, self.variable(source).1.unit);
        self.draft.terms.scaled(rate, source.in_units_of(own).unwrap_or(1.0))
    }

    /// The initial value of a group, in the unit of its source.
    fn initial(&mut self, group: usize, source: usize) -> Result<Id, Problem> {
        let holder = (0..self.all.len())
            .filter(|&index| self.group[index] == group)
            .find(|&index| self.variable(index).1.initial.is_some());
        let Some(holder) = holder else {
            let reason = format!("the state {} has no initial value", self.name(source));
            return Err(self.problem(source, reason));
        };
        let (component, variable) = self.variable(holder);
        let text = variable.initial.as_deref().unwrap_or("");
        let value = if let Ok(number) = text.parse::<f64>() {
            self.draft.terms.number(number)?
        } else {
            let index = self.all[holder].0;
            let Some(&other) = self.by_name.get(&(index, text)) else {
                let reason = format!(
                    "the initial value `{text}` of {} is neither a number nor a variable of {}",
                    variable.name, component.name
                );
                return Err(self.problem(holder, reason));
            };
            self.reference(other)?
        };
        self.converted(value, variable.unit, self.variable(source).1.unit)
    }

    /// The value of a variable, in its own unit.
    fn reference(&mut self, index: usize) -> Result<Id, Problem> {
        let group = self.group[index];
        let value = self.draft.terms.push(Term::Variable(self.place[&group]))?;
        let (from, to) = (self.variable(self.source[&group]).1.unit, self.variable(index).1.unit);
        self.converted(value, from, to)
    }

    fn converted(&mut self, value: Id, from: Unit, to: Unit) -> Result<Id, Problem> {
        if !from.same_dimension(to) {
            return Ok(value);
        }
        let factor = from.in_units_of(to).unwrap_or(1.0);
        let shift = from.offset * factor - to.offset;
        let scaled = self
            .draft
            .terms
            .scaled(value, if (factor - 1.0).abs() < 1e-12 { 1.0 } else { factor })?;
        if from.offset == to.offset {
            return Ok(scaled);
        }
        let shift = self.draft.terms.number(shift)?;
        self.draft.terms.binary(B::Add, scaled, shift)
    }

    fn formula(&mut self, component: usize, formula: &Formula, line: usize) -> Result<Id, Problem> {
        let mut places: Vec<Id> = Vec::with_capacity(formula.steps.len());
        for &step in &formula.steps {
            let term = match step {
                Step::Number(number) => Term::Number(number),
                Step::Unary(operation, a) => Term::Unary(operation, places[a]),
                Step::Binary(operation, a, b) => Term::Binary(operation, places[a], places[b]),
                Step::Select(a, b, c) => Term::Select(places[a], places[b], places[c]),
                Step::Variable(name) | Step::Rate(name) => {
                    let name = formula.names[name].as_str();
                    let own = &self.model.components[component];
                    let Some(&index) = self.by_name.get(&(component, name)) else {
                        return Err(Problem {
                            file: own.file.clone(),
                            ..Problem::at(line, format!("there is no variable `{name}` here"))
                                .within(&own.name)
                        });
                    };
                    places.push(if let Step::Variable(_) = step {
                        self.reference(index)?
                    } else {
                        let group = self.group[index];
                        let rate = self.draft.terms.push(Term::Rate(self.place[&group]))?;
                        let (from, to) = (
                            self.variable(self.source[&group]).1.unit,
                            self.variable(index).1.unit,
                        );
                        self.draft.terms.scaled(rate, from.in_units_of(to).unwrap_or(1.0))?
                    });
                    continue;
                }
            };
            places.push(self.draft.terms.push(term)?);
        }
        places.last().copied().ok_or_else(|| Problem::at(line, "the equation is empty"))
    }
}
