//! `verification CHECK FOLDER [--quick]`: makes one check and writes its rows to `FOLDER/CHECK.json`.
//!
//! `cargo xtask verify` calls it; so can you. `MYOSPRING_SHARED_DATA` names the folder with published data.

use myospring_verification::{Failure, Setting, checks, published_data};
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            #[allow(clippy::print_stderr, reason = "this is the program's way to talk")]
            {
                eprintln!("verification: {error}");
            }
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &[String]) -> Result<(), Failure> {
    let quick = arguments.iter().any(|argument| argument == "--quick");
    let plain: Vec<&String> =
        arguments.iter().filter(|argument| !argument.starts_with("--")).collect();
    let names = || checks().iter().map(|check| check.name).collect::<Vec<_>>().join(", ");
    let &[name, folder] = plain.as_slice() else {
        let usage = "usage: verification CHECK FOLDER [--quick]";
        return Err(format!("{usage}; the checks are: {}", names()).into());
    };
    let folder = Path::new(folder);
    let Some(check) = checks().into_iter().find(|check| check.name == name) else {
        return Err(format!("there is no check `{name}`; the checks are: {}", names()).into());
    };
    std::fs::create_dir_all(folder)
        .map_err(|error| format!("the folder {} cannot be made: {error}", folder.display()))?;
    let data = published_data();
    let rows = (check.run)(&Setting { quick, folder, data: &data })?;
    let file = folder.join(format!("{name}.json"));
    let text = serde_json::to_string_pretty(&rows)?;
    std::fs::write(&file, text)
        .map_err(|error| format!("{} cannot be written: {error}", file.display()))?;
    Ok(())
}
