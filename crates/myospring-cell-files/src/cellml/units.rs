//! Units of a model: each from others, base units of its own, with prefix, exponent and multiplier.

use super::element::{attribute, line, named};
use crate::draft::Problem;
use crate::unit::Unit;
use roxmltree::Node;
use std::collections::HashMap;

/// How deep units may be built on each other.
const DEEPEST: usize = 50;

/// Adds the units that are children of an element to those known.
pub(super) fn read(
    parent: Node<'_, '_>,
    known: &HashMap<String, Unit>,
) -> Result<HashMap<String, Unit>, Problem> {
    let mut elements = HashMap::new();
    for element in parent.children().filter(|child| named(*child, "units")) {
        let name = attribute(element, "name")?;
        if elements.insert(name, element).is_some() {
            return Err(Problem::at(line(element), format!("two units are named `{name}`")));
        }
    }
    let mut units = known.clone();
    units.retain(|name, _| !elements.contains_key(name.as_str()));
    for name in elements.keys() {
        resolve(name, &elements, &mut units, 0)?;
    }
    Ok(units)
}

/// The unit of a name: of the model or of the standard.
pub(super) fn find(name: &str, known: &HashMap<String, Unit>) -> Option<Unit> {
    known.get(name).copied().or_else(|| Unit::named(name))
}

fn resolve(
    name: &str,
    elements: &HashMap<&str, Node<'_, '_>>,
    units: &mut HashMap<String, Unit>,
    depth: usize,
) -> Result<Unit, Problem> {
    if let Some(unit) = find(name, units) {
        return Ok(unit);
    }
    let Some(&element) = elements.get(name) else {
        return Err(Problem::new(format!("the unit `{name}` is not defined")));
    };
    if depth > DEEPEST {
        let reason = format!(
            "the unit `{name}` is defined by itself, or by more than {DEEPEST} others in turn"
        );
        return Err(Problem::at(line(element), reason));
    }
    let mut unit = Unit::ONE;
    let parts: Vec<Node<'_, '_>> =
        element.children().filter(|child| named(*child, "unit")).collect();
    for &part in &parts {
        let base = attribute(part, "units")?;
        let own = resolve(base, elements, units, depth + 1)
            .map_err(|problem| Problem { line: problem.line.or(Some(line(part))), ..problem })?;
        unit = combined(unit, own, part, parts.len())?;
    }
    // A base unit of the model's own has no relation to others: a power that no other unit has.
    if parts.is_empty() {
        unit.powers[6] = 0.5 + units.len() as f64 * 0.013;
    }
    units.insert(name.to_owned(), unit);
    Ok(unit)
}

fn combined(unit: Unit, own: Unit, part: Node<'_, '_>, count: usize) -> Result<Unit, Problem> {
    let number = |key: &str, usual: f64| match part.attribute(key) {
        None => Ok(usual),
        Some(text) => text
            .trim()
            .parse::<f64>()
            .ok()
            .filter(|number| number.is_finite())
            .ok_or_else(|| Problem::at(line(part), format!("{key}=\"{text}\" is not a number"))),
    };
    let prefix = match part.attribute("prefix") {
        None => 1.0,
        Some(text) => Unit::prefix(text.trim()).ok_or_else(|| {
            Problem::at(line(part), format!("the prefix \"{text}\" is not known"))
        })?,
    };
    let (exponent, multiplier, offset) =
        (number("exponent", 1.0)?, number("multiplier", 1.0)?, number("offset", 0.0)?);
    let scaled = Unit { factor: own.factor * prefix, ..own };
    let mut result = unit.times(scaled.power(exponent));
    result.factor *= multiplier;
    if count == 1 && exponent == 1.0 {
        result.offset = own.offset + offset;
    }
    Ok(result)
}
