//! All that the program prints goes through here.

use crate::failure::Failure;
use myospring::experiment::legible;
use std::io::{self, IsTerminal, Write};

/// Data, to stdout. A closed pipe, as with `head`, is not an error; a full disk is one.
pub(crate) fn out(text: &str) -> Result<(), Failure> {
    check(write(io::stdout().lock(), &legible::visible(text)))
}

/// A message, to stderr.
pub(crate) fn note(text: &str) {
    // A failure here cannot be reported.
    write(io::stderr().lock(), text).ok();
}

/// Whether what went to stdout has arrived.
pub(crate) fn check(written: io::Result<()>) -> Result<(), Failure> {
    match written {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::new(format!("cannot write to the standard output: {error}"))
                .advise("check that the disk has room, where it goes to a file"))
        }
        _ => Ok(()),
    }
}

fn write(mut stream: impl Write, text: &str) -> io::Result<()> {
    let newline = if text.ends_with('\n') { "" } else { "\n" };
    stream.write_all(format!("{text}{newline}").as_bytes())?;
    stream.flush()
}

/// A warning, to stderr.
pub(crate) fn warn(text: &str) {
    let colour = io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    let (start, end) = if colour { ("\u{1b}[33m", "\u{1b}[0m") } else { ("", "") };
    note(&format!("{start}warning:{end} {}", legible::message(text)));
}
