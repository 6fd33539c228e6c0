//! What a second thread gives on a quiet machine, and what it costs on a busy one.

use super::measured::{example, lines, number, rate};
use crate::tools::say;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Makes the program one of those that keep the machine busy.
pub(super) const SPIN: &str = "--spin";

/// Runs of each kind; the middle one counts.
const RUNS: usize = 3;

/// After so long a process that makes load ends by itself, whatever has become of this program.
const LOAD_ENDS: Duration = Duration::from_secs(250);

/// Beats that are timed: name, and milliseconds and spacing for `beat_time`.
const BEATS: [(&str, [&str; 2]); 2] =
    [("default cell, 600 ms", ["600", "default"]), ("spacing 0.375 um, 60 ms", ["60", "0.375"])];

/// Smallest, middle and largest of some runs.
struct Spread([f64; 3]);

impl Spread {
    fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        Self([values[0], values[values.len() / 2], values[values.len() - 1]])
    }

    fn middle(&self) -> f64 {
        self.0[1]
    }

    fn show(&self, scale: f64, digits: usize) -> String {
        let [least, middle, most] = self.0.map(|value| value * scale);
        format!("{middle:.digits$} ({least:.digits$} to {most:.digits$})")
    }
}

/// Both tables.
pub(super) fn tables(sizes: &[&str]) -> Result<String, String> {
    let quiet = springs(sizes)?;
    let beats = beats("otherwise idle")?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let load = Load::start(2 * cores)?;
    let busy = beats_rows(&format!("{} other processes", 2 * cores))?;
    drop(load);
    Ok(format!("{quiet}\n{beats}{busy}"))
}

/// Spring updates per second on one thread and on two, in turns.
#[allow(clippy::format_push_string, reason = "rows of a table")]
fn springs(sizes: &[&str]) -> Result<String, String> {
    let mut table = format!(
        "Millions of spring updates per second, f64; middle of {RUNS} runs, smallest and largest\n\n\
         | masses | forces | one thread | two threads | two to one |\n|---|---|---|---|---|\n"
    );
    for size in sizes {
        for forces in ["springs", "all"] {
            let mut rates = [Vec::new(), Vec::new()];
            for _ in 0..RUNS {
                for (threads, rates) in ["1", "2"].iter().zip(&mut rates) {
                    say(&format!("   {size}, {forces}, {threads} thread(s)\n"));
                    rates.push(rate(&mut example("throughput", &[size, threads, forces]), "sups")?);
                }
            }
            let [one, two] = rates.map(Spread::of);
            table.push_str(&format!(
                "| {size} | {forces} | {} | {} | {:.2} |\n",
                one.show(1e-6, 0),
                two.show(1e-6, 0),
                two.middle() / one.middle()
            ));
        }
    }
    Ok(table)
}

fn beats(load: &str) -> Result<String, String> {
    let head =
        "| beat | masses | beside it | one thread | two threads | default | default to one |";
    Ok(format!(
        "Seconds a beat; middle of {RUNS} runs, smallest and largest\n\n{head}\n\
         |---|---|---|---|---|---|---|\n{}",
        beats_rows(load)?
    ))
}

/// Seconds of each beat on one thread, on two and on as many as it takes by default, in turns.
#[allow(clippy::format_push_string, reason = "rows of a table")]
fn beats_rows(load: &str) -> Result<String, String> {
    let mut table = String::new();
    for (name, [duration, spacing]) in BEATS {
        let mut times = [Vec::new(), Vec::new(), Vec::new()];
        let (mut masses, mut length) = (0.0, None);
        for _ in 0..RUNS {
            for (threads, times) in ["1", "2", "default"].iter().zip(&mut times) {
                say(&format!("   {name}, {threads} thread(s), {load}\n"));
                let run = lines(&mut example("beat_time", &[duration, spacing, threads]))?;
                let run = run.last().ok_or("beat_time printed no numbers")?;
                times.push(number(run, "seconds")?);
                masses = number(run, "masses")?;
                let end = number(run, "length_um")?;
                if *length.get_or_insert(end) != end {
                    return Err(format!("{name}: the numbers depend on the threads"));
                }
            }
        }
        let [one, two, default] = times.map(Spread::of);
        table.push_str(&format!(
            "| {name} | {masses} | {load} | {} | {} | {} | {:.2} |\n",
            one.show(1.0, 2),
            two.show(1.0, 2),
            default.show(1.0, 2),
            default.middle() / one.middle()
        ));
    }
    Ok(table)
}

/// Processes that do nothing as busily as they can, until this is dropped.
struct Load(Vec<Child>);

impl Load {
    fn start(count: usize) -> Result<Self, String> {
        let program = std::env::current_exe().map_err(|error| error.to_string())?;
        let mut load = Self(Vec::new());
        for _ in 0..count {
            let mut command = Command::new(&program);
            command.args(["bench", SPIN]).stdin(Stdio::null());
            load.0.push(command.spawn().map_err(|error| format!("{command:?}: {error}"))?);
        }
        Ok(load)
    }
}

impl Drop for Load {
    fn drop(&mut self) {
        for child in &mut self.0 {
            // One that has ended by itself cannot be killed.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// The life of a process that makes load.
pub(super) fn spin() {
    let start = Instant::now();
    while start.elapsed() < LOAD_ENDS {
        std::hint::spin_loop();
    }
}
