//! Arguments that the shell split: values and paths without quotes; and units in an old encoding.

use crate::args::Cli;
use crate::failure::Failure;
use crate::kinds;
use clap::CommandFactory;
use myospring::parameter::nearest;
use myospring::{cell, units};
use std::ffi::{OsStr, OsString};
use std::path::Path;

/// The arguments of a command line, its units in UTF-8.
///
/// # Errors
/// A quantity or the path of a file that the shell split at a space.
pub(crate) fn arguments(
    given: impl IntoIterator<Item = OsString>,
) -> Result<Vec<OsString>, Failure> {
    let mut all: Vec<OsString> = given.into_iter().map(of_old_encoding).collect();
    if let Some(first) = all.get_mut(1)
        && let Some(known) = command_of(first)?
    {
        *first = known;
    }
    // `myospring run help`
    if let [_, _, help] = &mut *all
        && help == "help"
        && !Path::new(help).exists()
    {
        *help = "--help".into();
    }
    let words: Vec<&str> = all.iter().skip(1).map(|word| word.to_str().unwrap_or("-")).collect();
    match parted_quantity(&words).or_else(|| parted_path(&words)) {
        Some(failure) => Err(failure),
        None => Ok(all),
    }
}

/// The command that a first word in upper case means.
///
/// # Errors
/// A file or folder without a command, an option of a command, anything else: what to write instead.
fn command_of(word: &OsStr) -> Result<Option<OsString>, Failure> {
    let text = word.to_string_lossy().to_lowercase();
    let all = Cli::command();
    let is_known = all.get_subcommands().any(|command| {
        command.get_name() == text || command.get_all_aliases().any(|alias| alias == text)
    });
    if is_known {
        return Ok(Some(text.into()));
    }
    if let Some(option) = text.strip_prefix("--") {
        let name = option.split('=').next().unwrap_or_default();
        let of_program = all.get_arguments().any(|own| own.get_long() == Some(name));
        return if of_program { Ok(None) } else { option_of(&all, name).map_or(Ok(None), Err) };
    }
    if text.starts_with('-') || text == "help" || text.is_empty() {
        return Ok(None);
    }
    Err(kinds::without_command(Path::new(word)).unwrap_or_else(|| no_command(&all, word)))
}

/// The advice for an option without a command: the first command that has it.
fn option_of(all: &clap::Command, name: &str) -> Option<Failure> {
    let has =
        |command: &&clap::Command| command.get_arguments().any(|own| own.get_long() == Some(name));
    let command = all.get_subcommands().find(has)?.get_name();
    let message = format!("--{name} is an option of a command, and none was given");
    Some(Failure::new(message).advise(format!("write myospring {command} --{name} ...")))
}

fn no_command(all: &clap::Command, word: &OsStr) -> Failure {
    let text = word.to_string_lossy();
    let file = Path::new(word);
    if cell::model(&text).is_ok() {
        return Failure::new(format!("`{text}` is a cell model, not a command")).advise(format!(
            "`myospring run --model {text}` simulates a cell with it, `myospring models {text}` lists its parameters"
        ));
    }
    if file.extension().is_some() || file.components().count() > 1 {
        let message =
            format!("`{text}` is not a command, and there is no file or folder of this name");
        return Failure::new(message)
            .advise("check the path and its spelling; `myospring --help` lists the commands");
    }
    let known: Vec<&str> = all.get_subcommands().map(clap::Command::get_name).collect();
    let near =
        nearest(&text, known.iter().copied()).map(|near| format!("; did you mean `{near}`?"));
    Failure::new(format!("there is no command `{text}`{}", near.unwrap_or_default()))
        .advise(format!("there are: {}; myospring --help says what each does", known.join(", ")))
}

/// A quantity whose bytes are Latin-1, as some terminals send `µ` and `°`; all else is unchanged,
/// since paths may be any bytes.
fn of_old_encoding(argument: OsString) -> OsString {
    if argument.to_str().is_some() || Path::new(&argument).exists() {
        return argument;
    }
    let text: String = argument.as_encoded_bytes().iter().copied().map(char::from).collect();
    let value = text.split_once('=').map_or(&*text, |(_, value)| value);
    let unit = value.trim_start_matches(|letter: char| "+-.0123456789eE ".contains(letter));
    if unit.len() < value.len() && units::is_unit(unit) { text.into() } else { argument }
}

/// `--pixel-size 0.27 um`: an option with a number, then a word that is a unit and not a file.
fn parted_quantity(words: &[&str]) -> Option<Failure> {
    let is_number = |text: &str| text.replace(',', ".").parse::<f64>().is_ok();
    (0..words.len()).find_map(|at| {
        let (option, number, rest) = match words[at].split_once('=') {
            Some((option, number)) => (option, number, &words[at + 1..]),
            None => (words[at], *words.get(at + 1)?, &words[at + 2..]),
        };
        if !option.starts_with('-') || is_number(option) || !is_number(number) {
            return None;
        }
        // `nN ms/um` contains a space.
        let mut endings = (1..=rest.len().min(2)).rev().map(|count| rest[..count].join(" "));
        let unit = endings.find(|unit| units::is_unit(unit))?;
        if Path::new(&unit).exists() {
            return None;
        }
        let message = format!("{option} {number} {unit}: a value with a space needs quotes");
        Some(Failure::new(message).advise(format!("write {option} \"{number} {unit}\"")))
    })
}

/// `my cell.tif`: words that are not all files, but together name a file.
fn parted_path(words: &[&str]) -> Option<Failure> {
    let exists = |path: &str| Path::new(path).exists();
    for from in 0..words.len() {
        let run = words[from..].iter().take_while(|word| !word.starts_with('-')).count();
        for to in (from + 2..=from + run).rev() {
            let (parts, whole) = (&words[from..to], words[from..to].join(" "));
            if exists(&whole) && parts.iter().any(|part| !exists(part)) {
                let message = format!("`{whole}`: a path with a space needs quotes");
                return Some(Failure::new(message).advise(format!("write \"{whole}\"")));
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(words: &[&str]) -> Option<String> {
        let given = ["myospring"].iter().chain(words).map(OsString::from);
        arguments(given).err().map(|failure| failure.in_words())
    }

    #[test]
    fn a_quantity_without_quotes_is_named_with_them() {
        for (words, answer) in [
            (&["run", "--pixel-size", "0.27", "um"][..], "write --pixel-size \"0.27 um\""),
            (&["run", "a.tif", "--pixel-size=0.27", "µm"], "write --pixel-size \"0.27 µm\""),
            (&["run", "--pixel-size", "0,27", "microns"], "write --pixel-size \"0,27 microns\""),
            (&["run", "--bed-stiffness", "1", "kPa/um"], "write --bed-stiffness \"1 kPa/um\""),
            (&["track", "a.avi", "--frame-rate", "30", "fps"], "write --frame-rate \"30 fps\""),
            (&["run", "--drag", "2", "nN", "ms/um"], "write --drag \"2 nN ms/um\""),
            (&["run", "--threshold", "20", "%"], "write --threshold \"20 %\""),
        ] {
            let refused = refusal(words).unwrap_or_default();
            assert!(refused.ends_with(answer), "{words:?}: {refused}");
        }
        for words in [
            &["run", "--pixel-size", "0.27 um", "um"][..],
            &["run", "--beats", "3", "cell.tif"],
            &["run", "--angle", "-30 deg", "cell.tif"],
            &["compare", "a", "b"],
            &["run", "3", "s"],
            &[],
        ] {
            assert_eq!(refusal(words), None, "{words:?}");
        }
    }

    #[test]
    fn a_path_without_quotes_is_named_with_them() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("my best cell.tif");
        std::fs::write(&path, "").unwrap();
        let whole = path.display().to_string();
        let [first, second, third] = whole.split(' ').collect::<Vec<_>>()[..] else { panic!() };
        let refused = refusal(&["run", first, second, third, "--force"]).unwrap_or_default();
        assert!(refused.ends_with(&format!("write \"{whole}\"")), "{refused}");
        assert_eq!(refusal(&["run", first, second]), None);
        assert_eq!(refusal(&["run", &whole]), None);
    }

    #[test]
    fn a_command_is_known_in_any_letters_and_a_file_is_told_its_command() {
        let given = ["myospring", "Run", "Cell.tif"].map(OsString::from);
        assert_eq!(arguments(given).ok().unwrap()[1..], ["run", "Cell.tif"]);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film.avi");
        std::fs::write(&path, "").unwrap();
        let refused = refusal(&[path.to_str().unwrap()]).unwrap_or_default();
        assert!(refused.contains("`myospring track "), "{refused}");
    }

    #[test]
    fn what_is_no_command_is_told_what_to_write() {
        for (words, answer) in [
            (&["xyz"][..], "there are: run, paper, segment"),
            (&["fitt"], "did you mean `fit`?"),
            (&["--model", "land_2017"], "write myospring run --model"),
            (&["--frame-rate=30", "a.avi"], "write myospring track --frame-rate"),
            (&["land_2017"], "`myospring run --model land_2017` simulates"),
            (&["nowhere.tif"], "no file or folder of this name"),
        ] {
            let refused = refusal(words).unwrap_or_default();
            assert!(refused.contains(answer), "{words:?}: {refused}");
        }
        for words in
            [&["--cite"][..], &["--help"], &["help", "fit"], &["-V"], &["run", "--model=x"]]
        {
            assert_eq!(refusal(words), None, "{words:?}");
        }
        let given = ["myospring", "run", "help"].map(OsString::from);
        assert_eq!(arguments(given).ok().unwrap()[2], "--help");
    }

    #[cfg(unix)]
    #[test]
    fn a_unit_in_latin_1_is_read_and_a_path_stays() {
        use std::os::unix::ffi::OsStringExt;
        let of = |bytes: &[u8]| of_old_encoding(OsString::from_vec(bytes.to_vec()));
        assert_eq!(of(b"0.27 \xb5m"), "0.27 µm");
        assert_eq!(of(b"--pixel-size=0.27 \xb5m"), "--pixel-size=0.27 µm");
        assert_eq!(of(b"30\xb0"), "30°");
        assert_eq!(of(b"\xb5m.tif").to_str(), None);
    }
}
