//! JSON for machines.

use serde::Serialize;

/// Why a value did not become JSON.
#[derive(Debug, thiserror::Error)]
#[error("the value cannot be written as JSON: {source}; map keys must be text or numbers")]
pub struct JsonError {
    /// What the serialiser says.
    #[from]
    source: serde_json::Error,
}

/// Any serialisable value as indented JSON with a final newline.
///
/// Numbers that JSON cannot hold (NaN, infinities) become `null`.
///
/// # Errors
/// A value whose serialiser refuses, or a map with keys that are neither text nor numbers.
///
/// # Example
/// ```
/// let text = myospring::output::json::pretty(&[1.5, 2.0])?;
/// assert_eq!(text, "[\n  1.5,\n  2.0\n]\n");
/// # Ok::<(), myospring::output::json::JsonError>(())
/// ```
pub fn pretty<T: Serialize + ?Sized>(value: &T) -> Result<String, JsonError> {
    let mut text = serde_json::to_string_pretty(value)?;
    text.push('\n');
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn written_json_reads_back() {
        let value = serde_json::json!({"shortening_pct": 12.0, "peaks": [171.5], "name": "cell"});
        let text = pretty(&value).unwrap();
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), value);
        assert!(text.ends_with("}\n"));
    }

    #[test]
    fn keys_that_json_cannot_hold_are_an_error() {
        let map = std::collections::BTreeMap::from([(vec![1], 2)]);
        assert!(pretty(&map).unwrap_err().to_string().contains("cannot be written as JSON"));
    }
}
