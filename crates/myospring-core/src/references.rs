//! The papers behind the models, as BibTeX.

/// All references that the documentation cites.
pub const REFERENCES: &str = include_str!("../references.bib");

/// One entry, from its `@` to its last brace.
///
/// # Example
/// ```
/// let entry = myospring::references::entry("coelho_2021").unwrap();
/// assert!(entry.starts_with("@inproceedings{coelho_2021,") && entry.ends_with('}'));
/// assert_eq!(myospring::references::entry("nobody_1900"), None);
/// ```
pub fn entry(key: &str) -> Option<&'static str> {
    let head = format!("{{{key},");
    let at = REFERENCES.find(&head)?;
    let start = REFERENCES[..at].rfind('@')?;
    let end = REFERENCES[start..].find("\n}")?;
    Some(&REFERENCES[start..start + end + 2])
}

#[cfg(test)]
mod tests {
    use super::entry;

    #[test]
    fn every_paper_that_a_model_cites_is_in_the_references() {
        for model in crate::cell::models() {
            for key in model.citations() {
                let entry = entry(key).unwrap_or_else(|| panic!("{key} is missing"));
                assert!(entry.starts_with('@') && entry.ends_with('}'), "{entry}");
            }
        }
    }
}
