//! Elements of a CellML file.

use crate::draft::Problem;
use roxmltree::Node;

pub(super) const VERSIONS: [(&str, &str); 3] = [
    ("http://www.cellml.org/cellml/1.0#", "CellML 1.0"),
    ("http://www.cellml.org/cellml/1.1#", "CellML 1.1"),
    ("http://www.cellml.org/cellml/2.0#", "CellML 2.0"),
];

pub(super) fn line(node: Node<'_, '_>) -> usize {
    node.document().text_pos_at(node.range().start).row as usize
}

pub(super) fn named(node: Node<'_, '_>, name: &str) -> bool {
    node.is_element()
        && node.tag_name().name() == name
        && VERSIONS.iter().any(|(own, _)| node.tag_name().namespace() == Some(own))
}

pub(super) fn attribute<'a>(node: Node<'a, '_>, name: &str) -> Result<&'a str, Problem> {
    node.attribute(name).map(str::trim).ok_or_else(|| {
        Problem::at(line(node), format!("<{}> has no {name}", node.tag_name().name()))
    })
}
