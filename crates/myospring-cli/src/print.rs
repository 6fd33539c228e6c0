//! All that the program prints goes through here.

use std::io::{self, IsTerminal, Write};

/// Data, to stdout. A reader that has gone away is no error.
pub(crate) fn out(text: &str) {
    write(io::stdout().lock(), text);
}

/// A message, to stderr.
pub(crate) fn note(text: &str) {
    write(io::stderr().lock(), text);
}

fn write(mut stream: impl Write, text: &str) {
    let newline = if text.ends_with('\n') { "" } else { "\n" };
    // Nobody is left to tell about a failure here.
    stream.write_all(format!("{text}{newline}").as_bytes()).and_then(|()| stream.flush()).ok();
}

/// A warning, to stderr.
pub(crate) fn warn(text: &str) {
    let colour = io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    let (start, end) = if colour { ("\u{1b}[33m", "\u{1b}[0m") } else { ("", "") };
    note(&format!("{start}warning:{end} {text}"));
}
