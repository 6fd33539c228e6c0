//! Damaged and mistaken commands, as a table: what a person has must be there afterwards, byte for byte.

use super::damaged::mask;
use super::{myospring, stderr};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// A command that would lose something.
struct Trial {
    /// Commands before it, which succeed.
    before: &'static [&'static str],
    /// What happens to the files then.
    meanwhile: fn(&Path),
    /// The command, with arguments parted by spaces.
    command: &'static str,
    code: i32,
    /// What its message names.
    names: &'static [&'static str],
}

const RESULTS: &str = "analyse A/curve.csv -o res --quiet";
const NOTHING: fn(&Path) = |_| ();
const READS: &str = "its results would replace or remove";
const FOREIGN: &str = "that myospring did not write, or that were changed since";

const fn refused(command: &'static str, names: &'static [&'static str]) -> Trial {
    Trial { before: &[], meanwhile: NOTHING, command, code: 2, names }
}

const fn after(
    before: &'static [&'static str],
    command: &'static str,
    names: &'static [&'static str],
) -> Trial {
    Trial { before, meanwhile: NOTHING, command, code: 2, names }
}

const fn meanwhile(meanwhile: fn(&Path), names: &'static [&'static str]) -> Trial {
    let command = "analyse A/curve.csv -o res --force";
    Trial { before: &[RESULTS], meanwhile, command, code: 2, names }
}

/// Nothing that a command reads is replaced or removed, and nothing that no command wrote.
const TRIALS: &[Trial] = &[
    // The folder of the input.
    refused(
        "run C/mask.png --pixel-size 0.5um -o C --force --outputs none",
        &["C/mask.png", READS],
    ),
    refused("run C/mask.png --pixel-size 0.5um -o C", &["C/mask.png", READS]),
    refused("mesh C/mask.png --pixel-size 0.5um -o C --force", &["C/mask.png", READS]),
    refused("segment C/mask.png --pixel-size 0.5um -o C --force", &["C/mask.png", READS]),
    refused(
        "segment C/mask.png --pixel-size 0.5um -o C --force --whole-frame",
        &["C/mask.png", READS],
    ),
    refused("fit --to A/curve.csv -o A --force", &["A/curve.csv", READS]),
    refused("analyse A/curve.csv -o A --force", &["A/curve.csv", READS]),
    refused("analyse A -o A --force", &["A/curve.csv", READS]),
    refused("track F/film.y4m -o F --force", &["F/film.y4m", READS]),
    refused("track P -o P --force", &["P/1.png", READS]),
    refused("run D/run.toml -o D --force", &["D/run.toml", READS]),
    refused("run D/run.toml -o T --force", &["T/calcium.csv", READS]),
    refused("compare D/run.toml --scale k_ws=0.5 -o D --force", &["D/run.toml", READS]),
    refused("study run S/study.toml -o S --force", &["S/study.toml", READS]),
    refused("study run S/study.toml -o S", &["S/study.toml", READS]),
    refused("batch P --pixel-size 0.5um -o P --force", &["P/1.png", READS]),
    refused("batch --table P/pictures.csv -o P --force", &["P/", READS]),
    // The same file under other names.
    refused("segment C/mask.png --pixel-size 0.5um -o C/mask.png --force", &["C/mask.png", READS]),
    refused(
        "segment C/mask.png --pixel-size 0.5um -o linked/mask.png --force",
        &["C/mask.png", READS],
    ),
    refused("run linked/mask.png --pixel-size 0.5um -o C --force", &["linked/mask.png", READS]),
    refused("run C/../C/mask.png --pixel-size 0.5um -o link_to_C --force", &["mask.png", READS]),
    refused("segment twin.png --pixel-size 0.5um -o C/mask.png --force", &["twin.png", READS]),
    // Earlier results that are read.
    after(&[RESULTS], "analyse res/metrics.csv -o res --force", &["res/metrics.csv", READS]),
    after(&[RESULTS], "fit --to res/metrics.csv -o res --force", &["res/metrics.csv", READS]),
    // What no command wrote, or what was changed since.
    refused("analyse A/curve.csv -o C --force", &["`C`", "mask.png", "myospring.sha256"]),
    refused("analyse A/curve.csv -o C", &["`C` already holds files"]),
    meanwhile(|at| fs::write(at.join("res/notes.txt"), "mine").unwrap(), &[FOREIGN, "notes.txt"]),
    meanwhile(
        |at| fs::write(at.join("res/metrics.csv"), "mine").unwrap(),
        &[FOREIGN, "metrics.csv"],
    ),
    meanwhile(
        |at| fs::write(at.join("res/figures/mine.svg"), "mine").unwrap(),
        &[FOREIGN, "figures/mine.svg"],
    ),
    meanwhile(
        |at| {
            for number in 0..9 {
                fs::write(at.join(format!("res/{number}.txt")), "mine").unwrap();
            }
        },
        &[FOREIGN, "0.txt, 1.txt, 2.txt, ..."],
    ),
    meanwhile(
        |at| fs::remove_file(at.join("res/myospring.sha256")).unwrap(),
        &["no list of those that myospring wrote", "earlier versions"],
    ),
    // Names that are no files.
    refused("analyse A/curve.csv -o A/curve.csv --force", &["A/curve.csv", READS]),
    refused("analyse A/curve.csv -o D/run.toml --force", &["`D/run.toml`: it is not a folder"]),
    refused("init C --force", &["`C` is a folder, which is never replaced"]),
];

/// A workplace with one of everything that commands read; small, since nothing of it is to be computed.
fn workplace(at: &Path) {
    for folder in ["A", "C", "D", "F", "P", "S", "T", "linked"] {
        fs::create_dir(at.join(folder)).unwrap();
    }
    let png = mask();
    let beat = |t: f64| 100.0 - 8.0 * (-((t % 1000.0 - 300.0) / 80.0).powi(2)).exp();
    let rows = (0..150).map(|row| format!("{},{}\n", 20 * row, beat(20.0 * f64::from(row))));
    let curve = std::iter::once("time_ms,length_um\n".to_owned()).chain(rows).collect::<String>();
    let files: [(&str, &[u8]); 9] = [
        ("A/curve.csv", curve.as_bytes()),
        ("C/mask.png", &png),
        ("P/1.png", &png),
        ("P/pictures.csv", b"file,pixel_size\n1.png,0.5 um\n"),
        ("D/run.toml", b"[cell]\nmodel = \"land_2017\"\ncalcium = \"../T/calcium.csv\"\n"),
        ("T/calcium.csv", b"time (ms),calcium (uM)\n0,0.1\n500,0.1\n"),
        ("F/film.y4m", b"YUV4MPEG2 W2 H2 F30:1 Cmono\nFRAME\n0000FRAME\n0000"),
        (
            "S/study.toml",
            b"kind = \"cell\"\n[parameters]\ntau_si = { distribution = \"uniform\", low = 1.0, high = 2.0 }\n\
              [sampling]\nsampler = \"latin-hypercube\"\nsize = 2\n",
        ),
        ("x.toml.part", b"mine"),
    ];
    for (name, content) in files {
        fs::write(at.join(name), content).unwrap();
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::symlink;
        symlink("../C/mask.png", at.join("linked/mask.png")).unwrap();
        symlink("C", at.join("link_to_C")).unwrap();
    }
    fs::hard_link(at.join("C/mask.png"), at.join("twin.png")).unwrap();
}

/// Every file under a folder with its bytes.
fn all(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(inner) = folders.pop() {
        for entry in fs::read_dir(inner).unwrap() {
            let entry = entry.unwrap();
            if entry.file_type().unwrap().is_dir() {
                folders.push(entry.path());
            } else {
                let name = entry.path().strip_prefix(folder).unwrap().display().to_string();
                files.insert(name, fs::read(entry.path()).unwrap_or_default());
            }
        }
    }
    files
}

fn run(at: &Path, command: &str) -> std::process::Output {
    myospring(at, &command.split(' ').collect::<Vec<_>>())
}

#[test]
fn no_command_loses_a_file_that_it_reads_or_that_no_command_wrote() {
    for Trial { before, meanwhile, command, code, names } in TRIALS {
        if cfg!(not(unix)) && command.contains("link") {
            continue;
        }
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path();
        workplace(at);
        for command in *before {
            let output = run(at, command);
            assert!(output.status.success(), "{command}: {}", stderr(&output));
        }
        meanwhile(at);
        let there = all(at);
        let output = run(at, command);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(*code), "{command}: {said}");
        for name in *names {
            assert!(said.contains(name), "{command}: `{name}` is not in: {said}");
        }
        let now = all(at);
        let changed: Vec<_> =
            there.iter().filter(|(name, old)| now.get(*name) != Some(old)).collect();
        assert!(changed.is_empty() && now.len() == there.len(), "{command}: {changed:?}");
    }
}

#[test]
fn force_replaces_what_a_command_wrote_and_hidden_files_stay() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    workplace(at);
    assert!(run(at, RESULTS).status.success());
    fs::write(at.join("res/.DS_Store"), "of the system").unwrap();
    // As an interrupted command leaves it: the new files are listed, and some are there.
    let list = fs::read_to_string(at.join("res/myospring.sha256")).unwrap();
    let half = list.replace("summary.csv", "fits.csv") + &list;
    fs::rename(at.join("res/summary.csv"), at.join("res/fits.csv")).unwrap();
    fs::write(at.join("res/myospring.sha256"), &half[..half.len() - 20]).unwrap();
    let first = all(&at.join("res"));
    let output = run(at, &format!("{RESULTS} --force"));
    assert!(output.status.success(), "{}", stderr(&output));
    let second = all(&at.join("res"));
    assert_eq!(second["myospring.sha256"], list.into_bytes());
    assert_eq!(first["metrics.csv"], second["metrics.csv"]);
    assert!(second.contains_key(".DS_Store") && second.contains_key("summary.csv"));
    assert!(!second.contains_key("fits.csv"));
    assert!(run(at, "init x.toml").status.success());
    assert_eq!(fs::read_to_string(at.join("x.toml.part")).unwrap(), "mine");
}

#[cfg(unix)]
#[test]
fn links_and_devices_are_never_replaced() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    workplace(at);
    symlink("/dev/null", at.join("null.toml")).unwrap();
    symlink("nowhere.toml", at.join("lost.toml")).unwrap();
    symlink("D/run.toml", at.join("mine.toml")).unwrap();
    for (name, what) in [("null.toml", "a device"), ("lost.toml", "a link that leads nowhere")] {
        let output = run(at, &format!("init {name} --force"));
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(what), "{}", stderr(&output));
    }
    assert!(run(at, "init mine.toml --force").status.success());
    assert!(fs::symlink_metadata(at.join("mine.toml")).unwrap().is_symlink());
    assert!(fs::read_to_string(at.join("D/run.toml")).unwrap().contains("#:schema"));

    assert!(run(at, RESULTS).status.success());
    fs::remove_file(at.join("res/metrics.csv")).unwrap();
    symlink("../A/curve.csv", at.join("res/metrics.csv")).unwrap();
    let output = run(at, &format!("{RESULTS} --force"));
    assert_eq!(output.status.code(), Some(2));
    // It leads to what is read.
    assert!(stderr(&output).contains("metrics.csv"), "{}", stderr(&output));
    assert!(fs::symlink_metadata(at.join("res/metrics.csv")).unwrap().is_symlink());
}
