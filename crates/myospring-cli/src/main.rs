//! The program `myospring`; all of it is in its library, so that the Python package has it, too.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(myospring_cli::main(std::env::args_os()).0)
}
