//! The page as text.

use super::content::Page;
use super::error::PageError;
use super::payload;
use super::template::TEMPLATE;

/// A page as one self-contained HTML file.
///
/// # Errors
/// A beating cell without a cell, or a mesh, frames and fibres that do not belong together.
///
/// # Example
/// ```
/// use myospring::mesh::{built_in, lattice};
/// use myospring::output::field::Field;
/// use myospring::output::page::{self, Page, PageRun, Runs};
/// use myospring::analysis::summary::Summary;
/// use myospring::prelude::*;
///
/// let outline = built_in::adult_ventricular();
/// let (mesh, report) = lattice::from_outline(&outline, Some(4.0))?;
/// let mut simulation = Simulation::new(mesh);
/// simulation.numerics.method = Method::QuasiStatic;
/// let outcome = simulation.build()?.run(|_progress| true);
/// let summary = Summary::new(&outcome.recording, &outcome.stimulus_times_ms, None, report, Vec::new());
/// let run = PageRun {
///     label: "50 kPa",
///     summary: &summary,
///     recording: &outcome.recording,
///     mesh: &simulation.mesh,
///     fibres: &simulation.fibres,
///     myofibril_content: None,
///     outline: &outline,
///     stimulus_times_ms: &outcome.stimulus_times_ms,
///     parameters: Vec::new(),
///     run_file: "",
///     citations: "",
///     picture: None,
///     thick: None,
/// };
/// let runs = Runs { runs: vec![run], differences: &[] };
/// let mut sections = vec![runs.key_numbers(), runs.beat(Field::FibreStrain, Vec::new())];
/// sections.extend(runs.record());
/// let html = page::html(&Page {
///     kind: "A beat by Myospring",
///     title: "A <fast> cell",
///     facts: vec!["adult ventricular myocyte".to_owned()],
///     answer: None,
///     warnings: runs.warnings(),
///     sections,
/// })?;
/// assert!(html.contains("<title>A &lt;fast&gt; cell</title>"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn html(page: &Page<'_>) -> Result<String, PageError> {
    let data = for_script(&payload::data(page)?);
    let title = for_markup(page.title);
    let mut text = String::with_capacity(TEMPLATE.len() + data.len());
    // In one pass, since inserted text may contain placeholders.
    let mut rest = TEMPLATE.as_str();
    while let Some((before, after)) = rest.split_once("{{") {
        text.push_str(before);
        let filled = [("title}}", title.as_str()), ("data}}", data.as_str())]
            .into_iter()
            .find_map(|(place, value)| Some((value, after.strip_prefix(place)?)));
        if let Some((value, behind)) = filled {
            text.push_str(value);
            rest = behind;
        } else {
            text.push_str("{{");
            rest = after;
        }
    }
    text.push_str(rest);
    Ok(text)
}

/// The data of a page from its HTML, as [`data`](super::data) gives them; `None` of a text that is no such page.
pub fn data_of(html: &str) -> Option<&str> {
    let (before, after) = TEMPLATE.split_once("{{data}}")?;
    let opening = &before[before.rfind('<')?..];
    let closing = &after[..=after.find('>')?];
    let (_, data) = html.split_once(opening)?;
    let (data, _) = data.split_once(closing)?;
    data.starts_with('{').then_some(data)
}

/// Text in an element or an attribute.
fn for_markup(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            // Not valid in HTML.
            '\0' => safe.push('\u{fffd}'),
            other => safe.push(other),
        }
    }
    safe
}

/// JSON within a script element: it must not end the element or begin a comment.
fn for_script(json: &str) -> String {
    let mut safe = String::with_capacity(json.len());
    for character in json.chars() {
        match character {
            '<' => safe.push_str("\\u003c"),
            '>' => safe.push_str("\\u003e"),
            '&' => safe.push_str("\\u0026"),
            '\u{2028}' => safe.push_str("\\u2028"),
            '\u{2029}' => safe.push_str("\\u2029"),
            other => safe.push(other),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    const NASTY: &str = "</script><script>alert(1)</script><!-- {{data}} \"'&\u{2028}\\";

    #[test]
    fn what_is_written_into_a_script_cannot_end_it_and_reads_back() {
        let json = serde_json::to_string(NASTY).unwrap();
        let safe = for_script(&json);
        assert!(!safe.contains(['<', '>', '&', '\u{2028}']), "{safe}");
        assert_eq!(serde_json::from_str::<String>(&safe).unwrap(), NASTY);
    }

    #[test]
    fn a_title_is_text() {
        assert_eq!(
            for_markup("<b a=\"1\" c='2'>&"),
            "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp;"
        );
    }
}
