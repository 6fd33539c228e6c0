//! TOML from anyone. The parser would overflow its stack on text that is nested very deep, so such text is refused first.

use serde::de::{DeserializeOwned, Error as _};

/// Most brackets that are open at a time, and most parts of a key; no file of ours needs ten.
const DEEPEST: usize = 64;

/// Reads TOML.
///
/// # Errors
/// Text that is not TOML or not of this type, or with more than 64 open brackets or a key of more than 64 parts.
///
/// # Example
/// ```
/// use myospring::settings::read_toml;
/// let table: toml::Table = read_toml("[run]\nduration = \"600 ms\"")?;
/// assert_eq!(table["run"]["duration"].as_str(), Some("600 ms"));
/// let error = read_toml::<toml::Table>(&"a = [".repeat(100_000)).unwrap_err();
/// assert!(error.message().starts_with("line 1: more than 64 brackets are open"));
/// # Ok::<(), toml::de::Error>(())
/// ```
pub fn read_toml<T: DeserializeOwned>(text: &str) -> Result<T, toml::de::Error> {
    match too_deep(text) {
        Some((at, what)) => {
            let line = text[..at].matches('\n').count() + 1;
            Err(toml::de::Error::custom(format!("line {line}: {what}")))
        }
        None => toml::from_str(text),
    }
}

/// Where text is nested too deep, and how.
fn too_deep(text: &str) -> Option<(usize, &'static str)> {
    let bytes = text.as_bytes();
    let (mut open, mut dots) = (Vec::new(), 0);
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        let mut next = at + 1;
        match byte {
            b'#' => next = after(bytes, at, b"\n"),
            b'"' | b'\'' => next = end_of_string(bytes, at),
            b'[' | b'{' => open.push(byte),
            b']' if open.last() == Some(&b'[') => drop(open.pop()),
            b'}' if open.last() == Some(&b'{') => drop(open.pop()),
            _ => {}
        }
        match byte {
            b'.' => dots += 1,
            b'=' | b',' | b'\n' | b'[' | b']' | b'{' | b'}' => dots = 0,
            _ => {}
        }
        if open.len() > DEEPEST {
            return Some((at, "more than 64 brackets are open here; is one not closed?"));
        }
        if dots > DEEPEST {
            return Some((at, "a key of more than 64 parts"));
        }
        at = next;
    }
    None
}

/// Behind a string that begins here; one that is not closed ends with its line, or with the text.
fn end_of_string(bytes: &[u8], start: usize) -> usize {
    let quote = bytes[start];
    let whole = [quote; 3];
    let long = bytes[start..].starts_with(&whole);
    let close = if long { &whole[..] } else { &whole[..1] };
    let mut at = start + close.len();
    while at < bytes.len() {
        match bytes[at] {
            b'\\' if quote == b'"' => at += 1,
            b'\n' if !long => return at,
            _ if bytes[at..].starts_with(close) => return at + close.len(),
            _ => {}
        }
        at += 1;
    }
    bytes.len()
}

/// Behind the next of some bytes, or the end.
fn after(bytes: &[u8], start: usize, what: &[u8]) -> usize {
    let found = bytes[start..].windows(what.len()).position(|window| window == what);
    found.map_or(bytes.len(), |by| start + by)
}

#[cfg(test)]
mod tests {
    use super::*;
    use toml::Table;

    #[test]
    fn what_is_nested_deep_is_refused_with_its_line_and_not_parsed() {
        for deep in [
            "[",
            "{",
            "a = {",
            "a = [\n",
            "{]",
            "\"\"[",
            "a.",
            "# \"\n[",
            "[[",
            "x = '''a'''\ny = [{",
        ] {
            let error =
                read_toml::<Table>(&format!("x = 1\n{}", deep.repeat(200_000))).unwrap_err();
            let said = error.message();
            assert!(
                said.contains(": more than 64 brackets") || said.contains(": a key of"),
                "{deep}: {said}"
            );
        }
    }

    #[test]
    fn brackets_and_dots_in_strings_comments_and_long_lists_do_not_count() {
        let (many, dots) = ("[{".repeat(100), "a.b".repeat(100));
        let numbers = vec!["1.5"; 1000].join(", ");
        let text = format!(
            "# {many} \"\na = \"{many} \\\" {many}\"\nb = '{many} {dots}'\nc = \"\"\"\n\"{many}\"\n\\\"\"\"\"\nd = [{numbers}]\n\
             e = '''\n'{many}'\n'''\n[f.g]\nh = {{ i = [[1.0], [2.0]] }}\n"
        );
        let table: Table = read_toml(&text).unwrap();
        assert_eq!(table, toml::from_str(&text).unwrap());
        assert_eq!(table.len(), 6);
    }
}
