//! JSON, exact for programs and rounded for people.

use crate::digits::rounded;
use serde::Serialize;
use serde_json::ser::{Formatter, PrettyFormatter, Serializer};
use std::io::{self, Write};

/// Why a value cannot be written as JSON.
#[derive(Debug, thiserror::Error)]
#[error("the value cannot be written as JSON: {source}; map keys must be text or numbers")]
pub struct JsonError {
    /// What the serialiser says.
    #[from]
    source: serde_json::Error,
}

/// Any serialisable value as indented JSON with a final newline.
///
/// Numbers that JSON cannot represent (NaN, infinities) become `null`.
///
/// # Errors
/// A value whose serialiser fails, or a map with keys that are neither text nor numbers.
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

/// Like [`pretty`], with rounded numbers: [`DIGITS`](crate::digits::DIGITS) significant digits.
///
/// # Errors
/// Those of [`pretty`].
///
/// # Example
/// ```
/// let text = myospring::output::json::for_people(&[49.999999999998, 1e-97])?;
/// assert_eq!(text, "[\n  50.0,\n  1e-97\n]\n");
/// # Ok::<(), myospring::output::json::JsonError>(())
/// ```
pub fn for_people<T: Serialize + ?Sized>(value: &T) -> Result<String, JsonError> {
    let mut bytes = Vec::new();
    value
        .serialize(&mut Serializer::with_formatter(&mut bytes, Rounded(PrettyFormatter::new())))?;
    bytes.push(b'\n');
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Formatter with indentation and rounded numbers.
struct Rounded(PrettyFormatter<'static>);

impl Formatter for Rounded {
    fn write_f64<W: ?Sized + Write>(&mut self, writer: &mut W, value: f64) -> io::Result<()> {
        self.0.write_f64(writer, rounded(value))
    }

    fn begin_array<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.begin_array(writer)
    }

    fn end_array<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.end_array(writer)
    }

    fn begin_array_value<W: ?Sized + Write>(
        &mut self,
        writer: &mut W,
        first: bool,
    ) -> io::Result<()> {
        self.0.begin_array_value(writer, first)
    }

    fn end_array_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.end_array_value(writer)
    }

    fn begin_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.begin_object(writer)
    }

    fn end_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.end_object(writer)
    }

    fn begin_object_key<W: ?Sized + Write>(
        &mut self,
        writer: &mut W,
        first: bool,
    ) -> io::Result<()> {
        self.0.begin_object_key(writer, first)
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.begin_object_value(writer)
    }

    fn end_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.end_object_value(writer)
    }
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
