//! XML to a model, with the files that it imports.

use super::element::{VERSIONS, attribute, line, named};
use super::math;
use super::tree::{Component, Connection, Model, ModelVariable};
use super::units;
use crate::draft::Problem;
use crate::unit::Unit;
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::HashMap;

/// How deep imports may import.
const DEEPEST_IMPORT: usize = 8;

/// The most imports of one model.
const MOST_IMPORTS: usize = 200;

/// The most elements of a file.
const MOST_ELEMENTS: u32 = 500_000;

/// The files that imports are read from.
pub(super) struct Sources<'a> {
    beside: &'a dyn Fn(&str) -> Option<String>,
    count: usize,
}

impl<'a> Sources<'a> {
    pub(super) fn new(beside: &'a dyn Fn(&str) -> Option<String>) -> Self {
        Self { beside, count: 0 }
    }

    /// Reads a model; `folder` is that of the file, relative to the first file's.
    pub(super) fn model(
        &mut self,
        file: &str,
        text: &str,
        folder: &str,
        depth: usize,
    ) -> Result<Model, Problem> {
        let in_file = |problem: Problem| Problem {
            file: problem.file.or_else(|| (depth > 0).then(|| file.to_owned())),
            ..problem
        };
        let options = ParsingOptions {
            allow_dtd: false,
            nodes_limit: MOST_ELEMENTS,
            ..ParsingOptions::default()
        };
        let document = Document::parse_with_options(text, options).map_err(|error| {
            in_file(Problem::at(
                error.pos().row as usize,
                format!("this is not valid XML: {error}"),
            ))
        })?;
        let root = document.root_element();
        let version = VERSIONS.iter().find(|(own, _)| root.tag_name().namespace() == Some(own));
        let Some((_, format)) = version.filter(|_| root.tag_name().name() == "model") else {
            let reason = "this XML is no CellML model: the first element must be <model> of CellML 1.0, 1.1 or 2.0";
            return Err(in_file(Problem::at(line(root), reason)));
        };
        let mut model = Model { format: (*format).to_owned(), ..Model::default() };
        model.title = title(root).unwrap_or_default();
        let own_file = (depth > 0).then(|| file.to_owned());
        self.imports(root, &mut model, folder, depth)?;
        body(root, &mut model, own_file.as_ref()).map_err(in_file)?;
        Ok(model)
    }

    fn imports(
        &mut self,
        root: Node<'_, '_>,
        model: &mut Model,
        folder: &str,
        depth: usize,
    ) -> Result<(), Problem> {
        for import in root.children().filter(|child| named(*child, "import")) {
            let at = line(import);
            let href =
                import.attributes().find(|own| own.name() == "href").map_or("", |own| own.value());
            self.count += 1;
            if depth >= DEEPEST_IMPORT || self.count > MOST_IMPORTS {
                let reason = format!(
                    "imports are more than {DEEPEST_IMPORT} deep, or more than {MOST_IMPORTS}"
                );
                return Err(Problem::at(at, reason));
            }
            let Some(path) = joined(folder, href) else {
                let reason = format!(
                    "the import \"{href}\" is not a file in the folder of the model; put it there"
                );
                return Err(Problem::at(at, reason));
            };
            let Some(text) = (self.beside)(&path) else {
                let reason =
                    format!("the imported file \"{path}\" cannot be read; put it beside the model");
                return Err(Problem::at(at, reason));
            };
            if text.len() > crate::reading::LONGEST_FILE {
                return Err(Problem::at(at, format!("the imported file \"{path}\" is too long")));
            }
            let inner = path.rsplit_once('/').map_or("", |(folder, _)| folder);
            let imported = self.model(&path, &text, inner, depth + 1)?;
            merge(import, &imported, model)?;
        }
        Ok(())
    }
}

/// A relative path within the folder of the first file; `None` if it leaves it.
fn joined(folder: &str, href: &str) -> Option<String> {
    if href.is_empty() || href.contains(':') || href.starts_with('/') || href.contains('\\') {
        return None;
    }
    let href = href.split('#').next().unwrap_or(href);
    let mut parts: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
    for part in href.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop()?;
            }
            other => parts.push(other),
        }
    }
    Some(parts.join("/"))
}

/// Adds what an import names: units, and components with those that they hold.
fn merge(import: Node<'_, '_>, imported: &Model, model: &mut Model) -> Result<(), Problem> {
    for element in import.children().filter(Node::is_element) {
        let at = line(element);
        if named(element, "units") {
            let (name, other) = (attribute(element, "name")?, attribute(element, "units_ref")?);
            let Some(unit) = units::find(other, &imported.units) else {
                return Err(Problem::at(at, format!("the imported file has no units `{other}`")));
            };
            model.units.insert(name.to_owned(), unit);
        } else if named(element, "component") {
            let (name, other) = (attribute(element, "name")?, attribute(element, "component_ref")?);
            if !imported.components.iter().any(|own| own.name == other) {
                return Err(Problem::at(
                    at,
                    format!("the imported file has no component `{other}`"),
                ));
            }
            component(name, other, imported, model);
        }
    }
    Ok(())
}

fn component(name: &str, other: &str, imported: &Model, model: &mut Model) {
    let is_inside = |own: &str| {
        let mut at = own;
        for _ in 0..=imported.parents.len() {
            if at == other {
                return true;
            }
            match imported.parents.get(at) {
                Some(parent) => at = parent,
                None => return false,
            }
        }
        false
    };
    let mut names = HashMap::new();
    for own in imported.components.iter().filter(|own| is_inside(&own.name)) {
        let mut new = if own.name == other { name.to_owned() } else { own.name.clone() };
        while model.components.iter().any(|taken| taken.name == new) {
            new = format!("{name}_{new}");
        }
        names.insert(own.name.clone(), new.clone());
        model.components.push(Component { name: new, ..own.clone() });
    }
    for (child, parent) in &imported.parents {
        if let (Some(child), Some(parent)) = (names.get(child), names.get(parent)) {
            model.parents.insert(child.clone(), parent.clone());
        }
    }
    for connection in &imported.connections {
        let [(a, x), (b, y)] = &connection.ends;
        if let (Some(a), Some(b)) = (names.get(a), names.get(b)) {
            let ends = [(a.clone(), x.clone()), (b.clone(), y.clone())];
            model.connections.push(Connection { ends, ..connection.clone() });
        }
    }
}

fn body(root: Node<'_, '_>, model: &mut Model, file: Option<&String>) -> Result<(), Problem> {
    model.units = units::read(root, &model.units)?;
    let tags = annotations(root);
    for element in root.children().filter(Node::is_element) {
        if named(element, "component") {
            let name = attribute(element, "name")?;
            if model.components.iter().any(|own| own.name == name) {
                return Err(Problem::at(
                    line(element),
                    format!("two components are named `{name}`"),
                ));
            }
            let component = read_component(element, name, &model.units, &tags)
                .map_err(|problem| problem.within(name))?;
            model.components.push(Component { file: file.cloned(), ..component });
        } else if named(element, "connection") {
            super::connections::read(element, model, file)?;
        } else if named(element, "group") || named(element, "encapsulation") {
            super::connections::encapsulation(element, model)?;
        }
    }
    Ok(())
}

fn read_component(
    element: Node<'_, '_>,
    name: &str,
    known: &HashMap<String, Unit>,
    tags: &HashMap<String, Vec<String>>,
) -> Result<Component, Problem> {
    let known = &units::read(element, known)?;
    let mut component = Component { name: name.to_owned(), ..Component::default() };
    for child in element.children().filter(Node::is_element) {
        if named(child, "variable") {
            let own = variable(child, known, tags)?;
            if component.variables.iter().any(|other| other.name == own.name) {
                return Err(Problem::at(
                    line(child),
                    format!("two variables are named `{}`", own.name),
                ));
            }
            component.variables.push(own);
        } else if math::is_math(child) {
            component.equations.extend(math::equations(child, known)?);
        } else if named(child, "reset") {
            let reason = "resets change a state at an instant; models with them cannot be read";
            return Err(Problem::at(line(child), reason));
        } else if named(child, "reaction") {
            return Err(Problem::at(
                line(child),
                "reactions cannot be read; write their rates as equations",
            ));
        }
    }
    Ok(component)
}

fn variable(
    element: Node<'_, '_>,
    known: &HashMap<String, Unit>,
    tags: &HashMap<String, Vec<String>>,
) -> Result<ModelVariable, Problem> {
    let (name, unit) = (attribute(element, "name")?, attribute(element, "units")?);
    let Some(found) = units::find(unit, known) else {
        return Err(Problem::at(
            line(element),
            format!("the unit `{unit}` of {name} is not defined"),
        ));
    };
    let id = element.attributes().find(|own| own.name() == "id").map(|own| own.value());
    let is_in = |key: &str| element.attribute(key) == Some("in");
    Ok(ModelVariable {
        name: name.to_owned(),
        unit: found,
        initial: element.attribute("initial_value").map(|text| text.trim().to_owned()),
        line: line(element),
        tags: id.and_then(|id| tags.get(id)).cloned().unwrap_or_default(),
        comes_in: is_in("public_interface") || is_in("private_interface"),
    })
}

/// The oxmeta names of each annotated identifier, from all RDF of the file.
fn annotations(root: Node<'_, '_>) -> HashMap<String, Vec<String>> {
    let mut tags: HashMap<String, Vec<String>> = HashMap::new();
    for element in root.descendants().filter(|own| own.tag_name().name() == "Description") {
        let about =
            element.attributes().find(|own| own.name() == "about").map_or("", |own| own.value());
        let Some((_, id)) = about.rsplit_once('#') else { continue };
        for is in element.children().filter(|own| own.tag_name().name() == "is") {
            let resource =
                is.attributes().find(|own| own.name() == "resource").map_or("", |own| own.value());
            if let Some((_, name)) = resource.rsplit_once("oxford-metadata#") {
                tags.entry(id.to_owned()).or_default().push(format!("oxmeta {name}"));
            }
        }
    }
    tags
}

/// The title of the file's documentation, or the model's name.
fn title(root: Node<'_, '_>) -> Option<String> {
    let of_document = root
        .descendants()
        .find(|own| own.tag_name().name() == "title")
        .and_then(|own| own.text())
        .map(|text| text.split_whitespace().collect::<Vec<_>>().join(" "))
        .filter(|text| !text.is_empty() && text.len() < 200);
    of_document.or_else(|| root.attribute("name").map(|name| name.replace('_', " ")))
}
