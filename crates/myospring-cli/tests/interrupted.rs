//! The program when it is interrupted, killed, short of room, or not alone.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test may stop here")]

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

const PROGRAM: &str = env!("CARGO_BIN_EXE_myospring");

/// A beat that takes minutes: whoever tests with it ends it.
const LONG: [&str; 7] = ["run", "--spacing", "1.5 um", "--beats", "200", "--engine", "plain"];
/// One that takes a moment.
const SHORT: [&str; 5] = ["run", "--spacing", "4 um", "--duration", "300 ms"];

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(PROGRAM);
    within(folder, command.args(arguments));
    command
}

fn within(folder: &Path, command: &mut Command) {
    command.current_dir(folder).stdout(Stdio::piped()).stderr(Stdio::piped());
}

/// The long run as a terminal starts it, also where the tests themselves ignore signals, as under `nohup`.
fn long(folder: &Path) -> Command {
    if !cfg!(target_os = "linux") {
        return command(folder, &LONG);
    }
    let mut command = Command::new("env");
    within(folder, command.args(["--default-signal", PROGRAM]).args(LONG));
    command
}

fn shell(folder: &Path, script: &str) -> Output {
    Command::new("sh").args(["-c", script, "sh", PROGRAM]).current_dir(folder).output().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// All names under a folder, hidden ones too, with `/` behind folders.
fn names(folder: &Path) -> Vec<String> {
    let mut names = Vec::new();
    let Ok(entries) = fs::read_dir(folder) else { return names };
    for entry in entries {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        if entry.file_type().unwrap().is_dir() {
            names.extend(self::names(&entry.path()).iter().map(|inner| format!("{name}/{inner}")));
            names.push(format!("{name}/"));
        } else {
            names.push(name);
        }
    }
    names.sort();
    names
}

fn parts(folder: &Path) -> Vec<String> {
    names(folder).into_iter().filter(|name| name.contains(".part")).collect()
}

/// Waits until something is so; fails after a minute, far more than a busy machine needs.
fn until(what: &str, is_so: impl Fn() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < Duration::from_secs(60), "waited in vain for: {what}");
        sleep(Duration::from_millis(10));
    }
}

/// A long run that has begun: its hidden folder is there.
fn begun(folder: &Path) -> Child {
    let child = long(folder).spawn().unwrap();
    let part = folder.join("results/.adult_ventricular.part/files");
    until("the folder under way", || part.exists());
    // Some of the beat is to be kept.
    sleep(Duration::from_millis(300));
    child
}

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args(["-s", name, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

#[test]
fn an_interrupted_run_keeps_what_it_has_computed_and_dies_of_the_signal() {
    let closed = cfg!(target_os = "linux").then_some(("HUP", 1));
    for (name, number) in [("INT", 2), ("TERM", 15)].into_iter().chain(closed) {
        let folder = tempfile::tempdir().unwrap();
        let child = begun(folder.path());
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.signal(), Some(number), "{}", stderr(&output));
        let text = stderr(&output);
        assert!(text.contains("stopped by the user at t = "), "{text}");
        assert!(text.contains("is in results/adult_ventricular"), "{text}");
        let results = folder.path().join("results/adult_ventricular");
        let record = fs::read_to_string(results.join("run.json")).unwrap();
        assert!(record.contains("\"reason\": \"interrupted\""), "{record}");
        let traces = fs::read_to_string(results.join("traces.csv")).unwrap();
        assert!(traces.lines().count() > 1, "{traces}");
        assert_eq!(parts(folder.path()), [""; 0]);
    }
}

#[test]
fn a_shell_sees_the_exit_codes_that_are_the_custom() {
    let folder = tempfile::tempdir().unwrap();
    // TERM, since a shell without job control lets what it starts in the background ignore Ctrl-C.
    let script = r#""$1" run --spacing "1.5 um" --beats 200 --engine plain 2>err.txt >out.txt &
        while [ ! -e results/.adult_ventricular.part/files ]; do sleep 0.05; done
        kill -s TERM $!; wait $!; echo $?"#;
    let output = shell(folder.path(), script);
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "143");
}

/// As `nohup` starts it.
#[test]
fn a_run_that_is_to_outlive_its_terminal_does() {
    let folder = tempfile::tempdir().unwrap();
    let script = r#"trap "" HUP; "$1" run --spacing "3 um" >out.txt 2>err.txt &
        while [ ! -e results/.adult_ventricular.part/files ]; do sleep 0.01; done
        kill -s HUP $!; wait $!; echo $?"#;
    let output = shell(folder.path(), script);
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "0");
}

#[test]
fn the_second_signal_ends_a_run_at_once_and_the_next_run_clears_what_it_left() {
    let ended_at_once = || {
        let folder = tempfile::tempdir().unwrap();
        let mut child = begun(folder.path());
        signal(&child, "STOP");
        // Both are there before the program can answer the first.
        signal(&child, "INT");
        signal(&child, "TERM");
        signal(&child, "CONT");
        let status = child.wait().unwrap();
        assert!(status.signal().is_some(), "{status}");
        let is_saved = folder.path().join("results/adult_ventricular").exists();
        (!is_saved).then_some(folder)
    };
    // Two threads may take a signal each at the same moment; then none is the second.
    let folder = (0..5).find_map(|_| ended_at_once()).unwrap();
    assert_ne!(parts(folder.path()), [""; 0]);
    let output = command(folder.path(), &SHORT).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(parts(folder.path()), [""; 0]);
}

#[test]
fn what_a_killed_run_left_is_cleared_by_the_next_one_of_any_name() {
    let folder = tempfile::tempdir().unwrap();
    let mut child = begun(folder.path());
    child.kill().unwrap();
    child.wait().unwrap();
    assert_ne!(parts(folder.path()), [""; 0]);
    let other = [&SHORT[..], &["--output", "results/other"]].concat();
    let output = command(folder.path(), &other).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(parts(folder.path()), [""; 0]);
}

#[test]
fn a_second_run_into_one_folder_is_refused_and_the_first_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let child = begun(folder.path());
    for force in [&[][..], &["--force"]] {
        let output = command(folder.path(), &[&SHORT[..], force].concat()).output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        let text = stderr(&output);
        assert!(text.contains("another run is writing to `results/adult_ventricular`"), "{text}");
    }
    signal(&child, "INT");
    let first = child.wait_with_output().unwrap();
    assert!(stderr(&first).contains("is in results/adult_ventricular"), "{}", stderr(&first));
    assert_eq!(parts(folder.path()), [""; 0]);
}

/// Pictures of the built-in cell's mask, enough of them to be interrupted.
fn pictures(folder: &Path, count: usize) -> PathBuf {
    let place = folder.join("pictures");
    fs::create_dir(&place).unwrap();
    for number in 0..count {
        let (width, height) = (160_u32, 60);
        let pixel = |at: u32| {
            let (x, y) = (f64::from(at % width) - 80.0, f64::from(at / width) - 30.0);
            // Another one each time, so that none is taken for another.
            let long = 70.0 - number as f64 * 0.1;
            u8::from((x / long).powi(2) + (y / 12.0).powi(2) < 1.0)
        };
        let mut bytes = Vec::new();
        png::Encoder::new(&mut bytes, width, height)
            .write_header()
            .unwrap()
            .write_image_data(&(0..width * height).map(pixel).collect::<Vec<u8>>())
            .unwrap();
        fs::write(place.join(format!("cell_{number:02}.png")), bytes).unwrap();
    }
    place
}

const BATCH: [&str; 10] = [
    "batch",
    "pictures",
    "--pixel-size",
    "1 um",
    "--spacing",
    "2 um",
    "--jobs",
    "1",
    "--output",
    "beats",
];

#[test]
#[ignore = "slow"]
fn an_interrupted_batch_keeps_its_journal_and_the_same_command_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    pictures(folder.path(), 8);
    let child = command(folder.path(), &BATCH).spawn().unwrap();
    let journal = folder.path().join("beats/progress.jsonl");
    let lines = || fs::read_to_string(&journal).unwrap_or_default().lines().count();
    until("two pictures", || lines() >= 2);
    // A second batch is refused as long as the first goes on.
    let second = command(folder.path(), &BATCH).output().unwrap();
    if lines() < 8 {
        assert_eq!(second.status.code(), Some(2));
        assert!(
            stderr(&second).contains("another run is writing to `beats`"),
            "{}",
            stderr(&second)
        );
    }
    signal(&child, "INT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.signal(), Some(2), "{}", stderr(&output));
    let done = lines();
    assert!((2..8).contains(&done), "{done} pictures");
    let kept = format!("{done} of 8 pictures are done and kept; the same command continues");
    assert!(stderr(&output).contains(&kept), "{}", stderr(&output));
    let rows = fs::read_to_string(folder.path().join("beats/cells.csv")).unwrap().lines().count();
    assert_eq!(rows, done + 1, "the table has what is done");

    let output = command(folder.path(), &BATCH).output().unwrap();
    assert!(stderr(&output).contains(&format!("continuing: {done} of 8")), "{}", stderr(&output));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let table = fs::read_to_string(folder.path().join("beats/cells.csv")).unwrap();
    assert_eq!(table.lines().count(), 9);
    assert_eq!(parts(folder.path()), [""; 0]);
}

#[test]
fn a_file_limit_is_an_error_that_names_the_file_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    // Blocks of 512 bytes: 4 KiB, less than the curves take.
    let script = r#"ulimit -f 8; exec "$1" run --spacing "4 um" --duration "300 ms""#;
    let output = shell(folder.path(), script);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    let text = stderr(&output);
    assert!(text.contains("traces.csv") && text.contains("too large"), "{text}");
    assert_eq!(parts(folder.path()), [""; 0]);
    assert!(!folder.path().join("results/adult_ventricular").exists());
}

#[test]
fn an_output_that_cannot_be_written_leaves_the_curves_and_numbers() {
    let folder = tempfile::tempdir().unwrap();
    // 48 KiB: more than the curves take, less than a figure.
    let script = r#"ulimit -f 96; exec "$1" run --spacing "4 um" --duration "120 ms""#;
    let output = shell(folder.path(), script);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    let text = stderr(&output);
    for part in ["error: figures was not written", "too large", "curves and numbers are in"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let results = folder.path().join("results/adult_ventricular");
    let kept = ["run.json", "run.toml", "summary.json", "traces.csv"];
    let found = names(&results).into_iter();
    let found = found.filter(|name| !name.ends_with('/') && name != "myospring.sha256");
    assert_eq!(found.collect::<Vec<_>>(), kept);
    let record = fs::read_to_string(results.join("run.json")).unwrap();
    assert!(record.contains("\"error\": \"cannot write"), "{record}");
    assert_eq!(parts(folder.path()), [""; 0]);
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_on_the_standard_output_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in
        ["models", "schema", "init", "--help", "--version", "--cite run", "run --dry-run"]
    {
        let output = shell(folder.path(), &format!(r#"exec "$1" {arguments} > /dev/full"#));
        assert_eq!(output.status.code(), Some(2), "{arguments}: {}", stderr(&output));
        let text = stderr(&output);
        assert!(text.contains("cannot write to the standard output"), "{arguments}: {text}");
    }
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let mut child = command(folder.path(), &["schema"]).spawn().unwrap();
    let mut reader = BufReader::new(child.stdout.take().unwrap());
    let mut line = String::new();
    reader.read_line(&mut line).unwrap();
    drop(reader);
    assert_eq!(line, "{\n");
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!((child.wait().unwrap().code(), said.as_str()), (Some(0), ""));
}
