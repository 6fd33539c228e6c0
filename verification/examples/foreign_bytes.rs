//! Damaged files of every kind that is read, many of them: each is read or refused, without panic, in little time and memory.
//!
//! ```text
//! cargo run --release -p myospring-verification --example foreign_bytes -- [READER] [--for SECONDS] [--inputs NUMBER] [--seed NUMBER] [--only NUMBER]
//! ```
//!
//! Without a reader each is tried for so long; 10 s unless a time or a number of inputs is stated. An input is made of a small file by one to four changes that the seed and
//! its number determine: bits, bytes and numbers, pieces that are gone, twice there or of another file. `--only` makes one input, by its
//! number, saves and reads it. An input of at most 1 MB that takes more than 2 s (`--limit SECONDS` for a build that is not
//! optimised) or 500 MB, or makes the reader panic, is a fault, and is kept in `target/foreign_bytes`. A process that ends early has left the
//! number of its input there, in `READER.number`.
#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a program of its own")]
#![allow(
    clippy::expect_used,
    reason = "what must hold for outlines is said by the tests that share it"
)]
#![allow(dead_code, reason = "the tests use more of what they share")]

#[path = "../../crates/myospring/tests/common/film_bytes.rs"]
mod film_bytes;
#[path = "../../crates/myospring/tests/common/outline_bytes.rs"]
mod outline_bytes;
#[path = "../../crates/myospring/tests/common/picture_bytes.rs"]
mod picture_bytes;
#[path = "../../crates/myospring/tests/common/workbook_bytes.rs"]
mod workbook_bytes;

use myospring::cell_files::{self, Choices};
use myospring::compare::dose;
use myospring::measured::{TableOptions, read_bytes};
use myospring::output::npz::{self, Array};
use myospring::run_file::RunFile;
use myospring::study::parameters::ParameterStudy;
use std::fs::File;
use std::io::{Seek, Write};
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Most of one input.
const LARGEST: usize = 1_000_000;
const TOO_LONG_S: u64 = 2;
const TOO_MUCH_KB: u64 = 500_000;
/// Inputs that are read before the memory they took is asked for, which takes longer than to read most of them.
const TOGETHER: u64 = 64;

/// A reader, the files from which its inputs are made, and what is done with one.
struct Reader {
    name: &'static str,
    seeds: Vec<Vec<u8>>,
    read: fn(&[u8]),
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let option = |name: &str| {
        let at = arguments.iter().position(|argument| argument == name)?;
        Some(arguments[at + 1].parse::<u64>().unwrap())
    };
    let seed = option("--seed").unwrap_or(1);
    let inputs = option("--inputs").unwrap_or(u64::MAX);
    let time = option("--for").unwrap_or(if inputs == u64::MAX { 10 } else { u64::MAX });
    let named = arguments.first().filter(|first| !first.starts_with("--"));
    let folder = root().join("target/foreign_bytes");
    std::fs::create_dir_all(&folder).unwrap();
    let mut faults = 0;
    println!(
        "seed {seed}\n\n| reader | inputs | slowest, s | memory, MB | faults |\n|---|---|---|---|---|"
    );
    for reader in readers().iter().filter(|one| named.is_none_or(|name| name == one.name)) {
        if let Some(number) = option("--only") {
            let path = folder.join(format!("{}_{number}", reader.name));
            std::fs::write(&path, input(reader, seed, number)).unwrap();
            println!("{}", path.display());
            (reader.read)(&input(reader, seed, number));
            continue;
        }
        let limit = Duration::from_secs(option("--limit").unwrap_or(TOO_LONG_S));
        let mut campaign = Campaign {
            reader,
            seed,
            limit,
            folder: &folder,
            slowest: Duration::ZERO,
            most: 0,
            faults: 0,
        };
        campaign.run(inputs, Duration::from_secs(time));
        faults += campaign.faults;
    }
    std::process::exit(i32::from(faults > 0));
}

/// Inputs of one reader, and what came of them.
struct Campaign<'a> {
    reader: &'a Reader,
    seed: u64,
    /// What one input may take.
    limit: Duration,
    folder: &'a Path,
    slowest: Duration,
    /// Largest memory, kB.
    most: u64,
    faults: usize,
}

impl Campaign<'_> {
    /// Reads inputs until it has read this number or the time is over.
    fn run(&mut self, inputs: u64, time: Duration) {
        let start = Instant::now();
        let marker = self.folder.join(format!("{}.number", self.reader.name));
        let mut marked = File::create(&marker).unwrap();
        let mut number = 0;
        while number < inputs && start.elapsed() < time {
            let some = number..inputs.min(number + TOGETHER);
            number = some.end;
            forget_peak();
            for one in some.clone() {
                self.read(one, &mut marked);
            }
            let held = peak_kb();
            self.most = self.most.max(held);
            if held > TOO_MUCH_KB {
                some.for_each(|one| self.weigh(one));
            }
        }
        std::fs::remove_file(&marker).unwrap();
        let Self { reader: Reader { name, .. }, slowest, most, faults, .. } = self;
        println!(
            "| {name} | {number} | {:.2} | {} | {faults} |",
            slowest.as_secs_f64(),
            *most / 1000
        );
    }

    /// Reads an input.
    fn read(&mut self, number: u64, marked: &mut File) {
        let bytes = input(self.reader, self.seed, number);
        // As many digits each, so that one number takes the place of the last.
        marked.rewind().unwrap();
        write!(marked, "{number:020}").unwrap();
        let before = Instant::now();
        let read = self.reader.read;
        let outcome = catch_unwind(|| read(&bytes));
        let mut took = before.elapsed();
        if took > self.limit {
            // The machine may have been busy: what counts is the processor's time.
            let (before, start) = (processor_time(), Instant::now());
            catch_unwind(|| read(&bytes)).ok();
            let again =
                processor_time().zip(before).map(|(after, before)| after.saturating_sub(before));
            took = again.unwrap_or_else(|| start.elapsed());
        }
        self.slowest = self.slowest.max(took);
        if outcome.is_err() {
            self.keep(number, &bytes, "a panic");
        } else if took > self.limit {
            self.keep(number, &bytes, &format!("{:.2} s", took.as_secs_f64()));
        }
    }

    /// Reads an input once more, and keeps it if it takes too much memory.
    fn weigh(&mut self, number: u64) {
        let bytes = input(self.reader, self.seed, number);
        forget_peak();
        let read = self.reader.read;
        catch_unwind(|| read(&bytes)).ok();
        let held = peak_kb();
        if held > TOO_MUCH_KB {
            self.keep(number, &bytes, &format!("{} MB", held / 1000));
        }
    }

    fn keep(&mut self, number: u64, bytes: &[u8], why: &str) {
        self.faults += 1;
        let kept = self.folder.join(format!("{}_{number}", self.reader.name));
        std::fs::write(&kept, bytes).unwrap();
        println!("{}: {why}", kept.display());
    }
}

/// Lets the largest memory of this process count from now on (Linux).
fn forget_peak() {
    std::fs::write("/proc/self/clear_refs", "5").ok();
}

/// The largest memory of this process that was in use since then, kB; 0 where the system does not tell.
fn peak_kb() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|rest| rest.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}

/// The time that processors spent on this process, also on threads that have ended; `None` where the system does not tell (other than Linux).
fn processor_time() -> Option<Duration> {
    // Hundredths of a second, the twelfth and thirteenth numbers behind the name in brackets.
    let status = std::fs::read_to_string("/proc/self/stat").ok()?;
    let (_, behind) = status.rsplit_once(')')?;
    let both = behind.split_whitespace().skip(11).take(2);
    let hundredths = both.map(|number| number.parse::<u64>().ok()).sum::<Option<u64>>()?;
    Some(Duration::from_millis(10 * hundredths))
}

fn readers() -> Vec<Reader> {
    let corpus = |name: &str| files(&root().join("fuzz/corpus").join(name), "");
    let examples = root().join("examples");
    let mut models = vec![cell_files_example().into_bytes()];
    models.extend(files(&root().join("../shared/data/cell-models"), ".cellml"));
    models.extend(files(&root().join("../shared/data/cell-models"), ".mmt"));
    models.retain(|model| model.len() < 60_000);
    let array = Array::floats(vec![4, 6], (0..24).map(f64::from));
    let archive = npz::to_bytes(&[("u", array.clone()), ("v", array.clone())]).unwrap();
    vec![
        Reader {
            name: "picture",
            seeds: corpus("picture"),
            read: |bytes| assert!(picture_bytes::exercise(bytes) < 4),
        },
        Reader {
            name: "film",
            seeds: corpus("film"),
            read: |bytes| {
                film_bytes::exercise(bytes);
                film_bytes::exercise_stack(bytes);
            },
        },
        Reader { name: "outlines", seeds: corpus("outlines"), read: outline_bytes::exercise },
        Reader {
            name: "workbook",
            seeds: corpus("workbook"),
            read: |bytes| assert!(workbook_bytes::exercise(bytes) < LARGEST),
        },
        Reader {
            name: "curve",
            seeds: beginnings(&files(&examples.join("tutorial"), ".csv")),
            read: |bytes| {
                // The name counts where columns have none.
                let name = ["curve.csv", "sarcomere_length.txt"][bytes.len() % 2];
                drop(read_bytes(name, bytes, &TableOptions::default()));
            },
        },
        Reader {
            name: "cell_file",
            seeds: models,
            read: |bytes| {
                let text = String::from_utf8_lossy(bytes);
                drop(cell_files::read("it", &text, &Choices::default(), &|_| {
                    Some(text.to_string())
                }));
            },
        },
        Reader {
            name: "run_file",
            seeds: files(&examples, ".toml"),
            read: |bytes| {
                if let Ok(file) = RunFile::from_text(&String::from_utf8_lossy(bytes)) {
                    drop(file.resolve());
                }
            },
        },
        Reader {
            name: "study",
            seeds: files(&examples.join("studies"), ".toml"),
            read: |bytes| {
                let none = |_: &str| Err(std::io::ErrorKind::NotFound.into());
                drop(ParameterStudy::from_toml(&String::from_utf8_lossy(bytes), none));
            },
        },
        Reader {
            name: "doses",
            seeds: vec![dose::EXAMPLE.into()],
            read: |bytes| drop(dose::read(&String::from_utf8_lossy(bytes))),
        },
        Reader {
            name: "arrays",
            seeds: vec![npz::to_npy(&array), archive],
            read: |bytes| {
                drop(npz::from_npy(bytes));
                drop(npz::read(bytes));
            },
        },
    ]
}

/// A small model in Myokit's format.
fn cell_files_example() -> String {
    "[[model]]\nname: small\nmembrane.V = -80\n\n[engine]\ntime = 0 [ms] bind time\npace = 0 bind pace\n\n[membrane]\n\
     dot(V) = -(leak.i + pace * 20) in [mV]\n\n[leak]\ni = g * (membrane.V + 80)\ng = 0.1\n"
        .to_owned()
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The files of a folder whose names end so, in order of their names.
fn files(folder: &Path, end: &str) -> Vec<Vec<u8>> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.retain(|path| path.to_string_lossy().ends_with(end) && path.is_file());
    paths.sort();
    paths.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

/// Whole files, and the first lines of each: most inputs are to be short.
fn beginnings(files: &[Vec<u8>]) -> Vec<Vec<u8>> {
    let first = |file: &[u8], lines: usize| -> Vec<u8> {
        file.split_inclusive(|&byte| byte == b'\n').take(lines).flatten().copied().collect()
    };
    let short = files.iter().flat_map(|file| [5, 20, 60].map(|lines| first(file, lines)));
    short.chain(files.iter().cloned()).collect()
}

/// Random numbers (splitmix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Below a number; 0 for none.
    fn below(&mut self, end: usize) -> usize {
        if end == 0 { 0 } else { (self.next() % end as u64) as usize }
    }

    fn one_of<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }
}

/// The input of a number.
fn input(reader: &Reader, seed: u64, number: u64) -> Vec<u8> {
    let mut random =
        Random(seed.wrapping_mul(0x1000_0000_01b3) ^ number.wrapping_mul(0x5851_f42d_4c95_7f2d));
    let from = random.below(reader.seeds.len());
    let mut bytes = reader.seeds[from].clone();
    for _ in 0..=random.below(4) {
        change(&mut bytes, &mut random, &reader.seeds);
    }
    bytes.truncate(LARGEST);
    bytes
}

/// Words that stand for numbers, at which readers fail.
const WORDS: [&str; 14] = [
    "nan",
    "-1",
    "0",
    "1e999",
    "-1e-999",
    "99999999999999999999",
    "4294967296",
    "1000000000",
    "",
    "1,5",
    "inf",
    "[]",
    "\"\"",
    "0x10",
];
const WHOLE: [u64; 12] =
    [0, 1, 2, 0x7f, 0xff, 0x7fff, 0xffff, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff, u64::MAX, 1 << 40];

fn change(bytes: &mut Vec<u8>, random: &mut Random, seeds: &[Vec<u8>]) {
    let at = random.below(bytes.len());
    let length = 1 + random.below(64);
    let end = bytes.len().min(at + length);
    match random.below(9) {
        0 if !bytes.is_empty() => bytes[at] ^= 1 << random.below(8),
        1 if !bytes.is_empty() => {
            bytes[at] = random.one_of(&[0, 1, 0x7f, 0x80, 0xff, b' ', b'\n', b',', b'"']);
        }
        2 => {
            // A whole number of two, four or eight bytes, in either order.
            let (width, value) = (random.one_of(&[2, 4, 8]), random.one_of(&WHOLE));
            let mut as_bytes = value.to_le_bytes()[..width].to_vec();
            if random.below(2) == 0 {
                as_bytes.reverse();
            }
            let end = bytes.len().min(at + width);
            bytes[at..end].copy_from_slice(&as_bytes[..end - at]);
        }
        3 => bytes.truncate(at),
        4 => drop(bytes.drain(at..end)),
        5 => {
            let piece = bytes[at..end].to_vec();
            let times = random.one_of(&[1, 2, 100, 5000]);
            bytes.splice(at..at, piece.repeat(times));
        }
        6 => {
            let other = &seeds[random.below(seeds.len())];
            let from = random.below(other.len());
            bytes.truncate(at);
            bytes.extend_from_slice(&other[from..]);
        }
        7 => {
            // A number of a text is another word.
            let is_part = |byte: &u8| byte.is_ascii_digit() || b".+-".contains(byte);
            if let Some(first) = bytes[at..].iter().position(u8::is_ascii_digit) {
                let first = at + first;
                let last = bytes[first..].iter().position(|byte| !is_part(byte)).unwrap_or(0);
                bytes.splice(first..first + last, random.one_of(&WORDS).bytes());
            }
        }
        _ => {
            // A line moves.
            let line = |from: usize| {
                bytes[from..].iter().position(|&byte| byte == b'\n').map(|end| from + end + 1)
            };
            if let Some(first) = line(at)
                && let Some(last) = line(first)
            {
                let moved: Vec<u8> = bytes.drain(first..last).collect();
                let to = random.below(bytes.len() + 1);
                bytes.splice(to..to, moved);
            }
        }
    }
}
