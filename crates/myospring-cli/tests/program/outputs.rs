//! What a run leaves beside curves and numbers: chosen by words, and films where they can be made.

use super::{QUICK, myospring, names, stderr, stdout};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

#[test]
fn outputs_are_chosen_by_their_words_and_curves_and_numbers_are_always_there() {
    let folder = tempfile::tempdir().unwrap();
    let run = |words: &str| {
        let quick = ["--integrator", "quasi-static", "--force", "-o", "mine", "--outputs", words];
        myospring(folder.path(), &[&QUICK[..], &quick].concat())
    };
    assert_eq!(run("figures").status.code(), Some(0));
    let output = run("frames,vtu,figures");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let mine = folder.path().join("mine");
    let all = [
        "cell.pvd",
        "figures",
        "frames.npz",
        "run.json",
        "run.toml",
        "summary.json",
        "traces.csv",
        "vtu",
    ];
    assert_eq!(names(&mine), all);
    let collection = fs::read_to_string(mine.join("cell.pvd")).unwrap();
    assert_eq!(collection.matches("<DataSet ").count(), names(&mine.join("vtu")).len());
    // What the run before has left goes, its folders, too.
    let output = run("none");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let always = ["run.json", "run.toml", "summary.json", "traces.csv"];
    assert_eq!(names(&folder.path().join("mine")), always);
    assert!(!stdout(&output).contains("open "), "{}", stdout(&output));
    for (words, said) in
        [("figurs", "a similar value exists: 'figures'"), ("none,figures", "stands alone")]
    {
        let output = run(words);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(said), "{}", stderr(&output));
    }
    assert_eq!(names(&folder.path().join("mine")), always, "the results before stay");
    let plan = myospring(folder.path(), &["run", "--dry-run", "--outputs", "figures"]);
    assert!(stdout(&plan).contains("curves and numbers, figures"), "{}", stdout(&plan));
}

#[test]
fn films_are_written_where_they_are_asked_for_in_any_colour_and_theme() {
    let folder = tempfile::tempdir().unwrap();
    let quick = ["--integrator", "quasi-static", "-o", "mine", "--outputs", "gif"];
    let look = ["--colour", "displacement", "--theme", "dark"];
    let output = myospring(folder.path(), &[&QUICK[..], &quick, &look].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for name in ["mine/beat.gif", "mine/beat_real_time.gif"] {
        let bytes = fs::read(folder.path().join(name)).unwrap();
        assert!(bytes.starts_with(b"GIF89a") && bytes.len() < 1_500_000, "{}", bytes.len());
    }
    let output = myospring(folder.path(), &["run", "--colour", "fiber-strain"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("fibre-strain"), "{}", stderr(&output));
}

/// A run that asks for a video, with the folder `tools` as the only place of programs.
fn video(folder: &Path, tools: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_myospring"))
        .current_dir(folder)
        .env("PATH", folder.join(tools))
        .args(QUICK)
        .args(["--integrator", "quasi-static", "--force", "-o", "mine", "--outputs", "mp4"])
        .output()
        .unwrap()
}

#[test]
fn without_ffmpeg_a_video_is_left_out_with_a_word() {
    let folder = tempfile::tempdir().unwrap();
    let output = video(folder.path(), "nothing");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("mp4 is left out: there is no program `ffmpeg`"));
    assert!(!folder.path().join("mine/beat.mp4").exists());
}

#[cfg(unix)]
#[test]
fn what_ffmpeg_says_last_is_the_reason_that_there_is_no_video() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("tools")).unwrap();
    let program = folder.path().join("tools/ffmpeg");
    let script = "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\necho first >&2\necho no such codec >&2\nexit 1\n";
    fs::write(&program, script).unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    let output = video(folder.path(), "tools");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("ffmpeg made no film: no such codec"), "{}", stderr(&output));
    assert!(folder.path().join("mine/traces.csv").exists());
    assert!(!folder.path().join("mine/beat.mp4").exists());
}
