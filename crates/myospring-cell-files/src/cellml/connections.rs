//! Connections between components, and which component holds which.

use super::element::{attribute, line, named};
use super::tree::{Connection, Model};
use crate::draft::Problem;
use roxmltree::Node;

/// Adds the pairs of a `connection`, in the form of 1.x or 2.0.
pub(super) fn read(
    element: Node<'_, '_>,
    model: &mut Model,
    file: Option<&String>,
) -> Result<(), Problem> {
    let components =
        element.children().find(|child| named(*child, "map_components")).unwrap_or(element);
    let (first, second) =
        (attribute(components, "component_1")?, attribute(components, "component_2")?);
    for map in element.children().filter(|child| named(*child, "map_variables")) {
        let (one, two) = (attribute(map, "variable_1")?, attribute(map, "variable_2")?);
        let ends = [(first.to_owned(), one.to_owned()), (second.to_owned(), two.to_owned())];
        model.connections.push(Connection { ends, line: line(map), file: file.cloned() });
    }
    Ok(())
}

/// Notes the parents of encapsulated components.
pub(super) fn encapsulation(element: Node<'_, '_>, model: &mut Model) -> Result<(), Problem> {
    let is_reference = |node: Node<'_, '_>| named(node, "component_ref");
    let relation = element.children().find(|child| named(*child, "relationship_ref"));
    if relation.is_some_and(|own| own.attribute("relationship") != Some("encapsulation")) {
        return Ok(());
    }
    for child in element.descendants().filter(|node| is_reference(*node)) {
        if let Some(parent) = child.parent().filter(|parent| is_reference(*parent)) {
            let (own, outer) = (attribute(child, "component")?, attribute(parent, "component")?);
            model.parents.insert(own.to_owned(), outer.to_owned());
        }
    }
    Ok(())
}
