//! Ctrl-C and its like. Until there is something to lose they end the program as they end any other; from then
//! on the first asks it to end in good order, and the second ends it at once.

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

/// Which signal came, 0 as long as none did.
static ASKED: AtomicUsize = AtomicUsize::new(0);
/// Whether the next one ends the program.
static AGAIN: AtomicBool = AtomicBool::new(false);

/// Whether the work is over, and what it came to is put in order.
static TIDIES: AtomicBool = AtomicBool::new(false);

/// When it was heard.
static SINCE: OnceLock<Instant> = OnceLock::new();

/// What is done where writing has begun.
pub(crate) const WRITING: &str = "files that were begun are still written";

/// How soon people hear that they were heard.
const SOON: Duration = Duration::from_millis(50);
/// How long figures and pages are still begun after a signal: those of an ordinary cell are there by then.
const LATE: Duration = Duration::from_millis(400);
/// How long work under way has to end, where all that is done is kept already.
const GIVEN_UP: Duration = Duration::from_millis(900);

/// From now on a signal asks for an end in good order; `doing` says what that is, once it is asked for.
pub(crate) fn heed(doing: &'static str) {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // Without it, a signal ends the program as it does any other, and the next run clears what was left.
        if [SIGINT, SIGTERM].into_iter().try_for_each(register).is_ok() {
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

/// As [`heed`], where all that is done is kept as soon as it is done: work that does not heed the signal soon, such as that
/// on a huge picture, is ended with the program.
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

/// The work has ended, by itself or early: what follows is done to its end.
pub(crate) fn tidies() {
    TIDIES.store(true, Ordering::SeqCst);
}

fn register(signal: i32) -> io::Result<()> {
    // The order matters: the first signal arms what only the second one meets.
    #[cfg(unix)]
    flag::register_conditional_default(signal, &AGAIN)?;
    #[cfg(not(unix))]
    flag::register_conditional_shutdown(signal, i32::from(code(signal as usize)), &AGAIN)?;
    flag::register(signal, &AGAIN)?;
    flag::register_usize(signal, &ASKED, signal as usize)?;
    Ok(())
}

/// Whether the program is to end.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::SeqCst) != 0
}

/// Whether the program was to end some time ago, so that pictures of its results are not drawn any more.
pub(crate) fn is_late() -> bool {
    SINCE.get().is_some_and(|since| since.elapsed() > LATE)
}

/// Ends work of the library once the program is to end.
pub(crate) fn interruption() -> Interruption {
    Interruption::when(asked)
}

/// Ends the program: of the signal, if one came, so that a shell's loop over many runs ends as well.
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

/// What a shell makes of a program that died of a signal: 130 for Ctrl-C, 143 for SIGTERM.
fn code(signal: usize) -> u8 {
    128_u8.saturating_add(signal as u8)
}

/// Makes a file that outgrows the limit of the shell (`ulimit -f`) an error of its writing, where the system would
/// end the program without a word.
pub(crate) fn large_files_are_errors() {
    #[cfg(unix)]
    {
        static SEEN: AtomicBool = AtomicBool::new(false);
        flag::register(signal_hook::consts::SIGXFSZ, &SEEN).ok();
    }
}
