//! Ctrl-C and other signals. Until there are results to lose they end the program at once. Later
//! the first signal asks it to end in good order, and the second ends it at once.

use crate::exit::ExitCode;
use crate::print;
use myospring::interruption::Interruption;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Once, OnceLock};
use std::thread;
use std::time::{Duration, Instant};

/// The signal that came, or 0.
static ASKED: AtomicUsize = AtomicUsize::new(0);
/// Whether the next signal ends the program.
static AGAIN: AtomicBool = AtomicBool::new(false);

/// Whether the work has ended and the results are being written.
static TIDIES: AtomicBool = AtomicBool::new(false);

/// When the signal came.
static SINCE: OnceLock<Instant> = OnceLock::new();

/// The message if writing has begun.
pub(crate) const WRITING: &str = "files that were begun are still written";

/// Interval at which signals are checked, so that people soon see a reaction.
const SOON: Duration = Duration::from_millis(50);
/// How long after a signal figures and pages are still started: enough for those of a usual cell.
const LATE: Duration = Duration::from_millis(400);
/// How long unfinished work has to end, if finished work is already stored.
const GIVEN_UP: Duration = Duration::from_millis(900);

/// From now on a signal asks for an end in good order; `doing` describes it in the message.
pub(crate) fn heed(doing: &'static str) {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // Without it, a signal ends the program at once, and the next run removes the remains.
        if signals().try_for_each(register).is_ok() {
            thread::spawn(move || {
                while !asked() {
                    thread::sleep(SOON);
                }
                SINCE.get_or_init(Instant::now);
                print::note(&format!("interrupted: {doing} (Ctrl-C again ends at once)"));
            });
        }
    });
}

/// As [`heed`], for commands that store finished work at once: work that does not end soon after
/// the signal, such as that on a huge picture, is ended with the program.
pub(crate) fn heed_soon(doing: &'static str) {
    static ONCE: Once = Once::new();
    heed(doing);
    ONCE.call_once(|| {
        thread::spawn(|| {
            while SINCE.get().is_none_or(|since| since.elapsed() < GIVEN_UP) {
                thread::sleep(SOON);
            }
            if !TIDIES.load(Ordering::SeqCst) {
                end(ExitCode::from(1));
                std::process::exit(1);
            }
        });
    });
}

/// The work has ended, by itself or early; the rest is completed.
pub(crate) fn tidies() {
    TIDIES.store(true, Ordering::SeqCst);
}

/// The signals that ask for an end: Ctrl-C, SIGTERM and, on Unix, SIGHUP, which a closed terminal sends.
fn signals() -> impl Iterator<Item = i32> {
    #[cfg(unix)]
    let closed = (!is_ignored(signal_hook::consts::SIGHUP)).then_some(signal_hook::consts::SIGHUP);
    #[cfg(not(unix))]
    let closed = None;
    [SIGINT, SIGTERM].into_iter().chain(closed)
}

/// Whether the program was started with this signal ignored, as `nohup` does for SIGHUP. True where the system does not tell (macOS).
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    ignored
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .is_none_or(|mask| mask >> (signal - 1) & 1 == 1)
}

fn register(signal: i32) -> io::Result<()> {
    // The order matters: the first signal arms the handler of the second.
    #[cfg(unix)]
    flag::register_conditional_default(signal, &AGAIN)?;
    #[cfg(not(unix))]
    flag::register_conditional_shutdown(signal, i32::from(code(signal as usize)), &AGAIN)?;
    flag::register(signal, &AGAIN)?;
    flag::register_usize(signal, &ASKED, signal as usize)?;
    Ok(())
}

/// Whether a signal asked the program to end.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::SeqCst) != 0
}

/// Whether a signal came some time ago, so that no further figures are drawn.
pub(crate) fn is_late() -> bool {
    SINCE.get().is_some_and(|since| since.elapsed() > LATE)
}

/// The interruption that ends work of the library after a signal.
pub(crate) fn interruption() -> Interruption {
    Interruption::when(asked)
}

/// Ends the program, by the signal if one came, so that a shell's loop over many runs ends, too.
pub(crate) fn end(code_otherwise: ExitCode) -> ExitCode {
    match ASKED.load(Ordering::SeqCst) {
        0 => code_otherwise,
        signal => {
            #[cfg(unix)]
            if let Ok(signal) = i32::try_from(signal) {
                signal_hook::low_level::emulate_default_handler(signal).ok();
            }
            ExitCode::from(code(signal))
        }
    }
}

/// The exit code in a shell of a program that a signal ended: 130 for Ctrl-C, 143 for SIGTERM, 129 for a terminal that was closed.
fn code(signal: usize) -> u8 {
    128_u8.saturating_add(signal as u8)
}

/// Makes a file above the shell's limit (`ulimit -f`) a write error; otherwise the system would end
/// the program without a message.
pub(crate) fn large_files_are_errors() {
    #[cfg(unix)]
    {
        static SEEN: AtomicBool = AtomicBool::new(false);
        flag::register(signal_hook::consts::SIGXFSZ, &SEEN).ok();
    }
}
