//! Myokit's `.mmt` files: the model section, and the protocol where it is one train of pulses.
//!
//! Syntax: <https://myokit.readthedocs.io/en/stable/syntax/model.html>.

mod expression;
mod lexer;
mod model;
mod protocol;

use crate::draft::{Draft, Problem};

/// Reads the text of a file to a draft.
pub(crate) fn parse(text: &str) -> Result<Draft, Problem> {
    let mut sections: Vec<(usize, &str, Vec<&str>)> = Vec::new();
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let bare = line.trim();
        if let Some(name) = bare.strip_prefix("[[").and_then(|rest| rest.split_once("]]")) {
            sections.push((index + 2, name.0, Vec::new()));
        } else if let Some((_, _, lines)) = sections.last_mut() {
            lines.push(line);
        } else if !bare.is_empty() && !bare.starts_with('#') {
            let reason =
                "no model: a .mmt file starts with [[model]], a CellML file with <?xml or <model";
            return Err(Problem::at(index + 1, reason));
        }
    }
    let Some((first, _, lines)) = sections.iter().find(|(_, name, _)| *name == "model") else {
        return Err(Problem::new("the file has no [[model]] section"));
    };
    let mut draft = model::parse(lexer::tokens(lines, *first)?)?;
    "Myokit".clone_into(&mut draft.format);
    for (first, name, lines) in &sections {
        match *name {
            "model" => {}
            "protocol" => match protocol::parse(lines) {
                Some(pulse) => draft.protocol = Some(pulse),
                None => draft.notes.push(format!(
                    "The protocol (line {first}) is not one train of equal pulses, so it is ignored."
                )),
            },
            other => draft.notes.push(format!("The section [[{other}]] is ignored.")),
        }
    }
    Ok(draft)
}
