//! Studies: resumed where they were, failures in their place, the same rows whatever the threads.
#![allow(clippy::unwrap_used, clippy::float_cmp, reason = "tests")]

mod cell_file;
mod cells;
mod own_model;
mod pictures;

use myospring::output::files::{Manifest, Reads};
use myospring::output::table::{Column, Table};
use myospring::study::{
    self, Cause, Interrupted, Journal, Member, Row, Status, StudyError, StudyObserver, StudyReport,
    Threads, sha256,
};
use serde::{Deserialize, Serialize};
use std::num::NonZeroUsize;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A number that is to be squared.
struct Number {
    name: String,
    value: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Square {
    of: String,
    value: Option<f64>,
    reason: String,
}

impl Member for Number {
    const KIND: &'static str = "number";
    type Row = Square;

    fn name(&self) -> &str {
        &self.name
    }

    fn key(&self) -> Option<String> {
        Some(sha256(&self.value.to_le_bytes()))
    }
}

impl Row for Square {
    fn failed(member: &str, reason: String) -> Self {
        Self { of: member.to_owned(), value: None, reason }
    }

    fn status(&self) -> Status {
        if self.value.is_some() { Status::Ok } else { Status::Failed }
    }

    fn table(rows: &[Self]) -> Table {
        let values = rows.iter().map(|row| row.value).collect();
        Table { columns: vec![Column::Number { name: "square".to_owned(), values }] }
    }
}

fn numbers(count: u32) -> Vec<Number> {
    let number = |k| Number { name: format!("n{k}"), value: f64::from(k) + 0.1 };
    (0..count).map(number).collect()
}

/// Squares numbers; those of whole thirds cannot be squared.
fn square(number: &Number) -> Result<Vec<Square>, Cause> {
    if number.value.floor() % 3.0 == 2.0 {
        return Err(format!("{} is not to be squared", number.value).into());
    }
    let (of, value) = (number.name.clone(), Some(number.value * number.value));
    Ok(vec![Square { of, value, reason: String::new() }])
}

fn threads(count: usize) -> Threads {
    Threads::new(Some(count)).unwrap()
}

/// Counts what is done, and stops after so many.
struct StopAfter {
    members: usize,
    seen: AtomicUsize,
    tables: Mutex<Vec<usize>>,
}

impl StopAfter {
    fn new(members: usize) -> Self {
        Self { members, seen: AtomicUsize::new(0), tables: Mutex::default() }
    }
}

impl<M: Member> StudyObserver<M> for StopAfter {
    fn finished(&self, _: &M, _: &[M::Row]) -> bool {
        self.seen.fetch_add(1, Ordering::Relaxed) + 1 < self.members
    }

    fn table(&self, rows: &[M::Row]) -> Result<(), Cause> {
        self.tables.lock().unwrap().push(rows.len());
        Ok(())
    }
}

fn squares(
    numbers: &[Number],
    journal: &Journal<Number>,
    observer: &impl StudyObserver<Number>,
) -> StudyReport<Vec<Square>> {
    study::run(numbers, journal, &threads(1), observer, square).unwrap()
}

#[test]
fn a_study_that_was_interrupted_goes_on_and_gives_the_same_rows() {
    let folder = tempfile::tempdir().unwrap();
    let numbers = numbers(8);
    let whole = squares(&numbers, &Journal::in_memory(), &());
    assert_eq!((whole.resumed, whole.rows.len()), (0, 8));

    let stop = StopAfter::new(3);
    let journal = Journal::open(folder.path(), "a = 1").unwrap();
    let part = squares(&numbers, &journal, &stop);
    assert!(part.stopped && part.rows == whole.rows[..3]);
    assert_eq!(*stop.tables.lock().unwrap(), [3], "the table is written before it ends");
    drop(journal);

    // The last line is cut off, as by a machine without power.
    let path = folder.path().join("progress.jsonl");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, &text[..text.len() - 9]).unwrap();
    let seen = StopAfter::new(usize::MAX);
    let journal = Journal::open(folder.path(), "a = 1").unwrap();
    let rest = squares(&numbers, &journal, &seen);
    assert_eq!((rest.resumed, rest.stopped), (2, false));
    assert_eq!(seen.seen.into_inner(), 6);
    assert_eq!(rest.rows, whole.rows);
    drop(journal);
    let lines = std::fs::read_to_string(&path).unwrap();
    assert!(lines.lines().count() == 8 && lines.starts_with("{\"number\":\"n0\",\"sha256\":\""));
}

#[test]
fn a_member_whose_input_has_changed_is_done_anew() {
    let folder = tempfile::tempdir().unwrap();
    let mut numbers = numbers(5);
    squares(&numbers, &Journal::open(folder.path(), "").unwrap(), &());
    numbers[3].value = 7.5;
    let again = squares(&numbers, &Journal::open(folder.path(), "").unwrap(), &());
    assert_eq!((again.resumed, again.rows[3].value), (4, Some(56.25)));
    let unchanged = squares(&numbers, &Journal::open(folder.path(), "").unwrap(), &());
    assert_eq!((unchanged.resumed, unchanged.rows), (5, again.rows));
}

#[test]
fn results_of_other_settings_are_kept_unless_it_begins_anew() {
    let folder = tempfile::tempdir().unwrap();
    let numbers = numbers(2);
    squares(&numbers, &Journal::open(folder.path(), "a = 1").unwrap(), &());
    Manifest::of(folder.path()).write("drawings/a.svg", "ours").unwrap();
    let open = |settings| Journal::<Number>::open(folder.path(), settings);
    let other = open("a = 2").err().unwrap();
    assert!(matches!(&other, StudyError::OtherSettings { .. }), "{other}");
    assert!(other.to_string().contains("results of other settings; choose another"), "{other}");
    assert_eq!(squares(&numbers, &open("a = 1").unwrap(), &()).resumed, 2);

    let notes = folder.path().join("notes.txt");
    std::fs::write(&notes, "mine").unwrap();
    let begin = || Journal::begin_anew(folder.path(), "a = 2", &Reads::new());
    let refused = begin().err().unwrap().to_string();
    assert!(refused.contains("did not write") && refused.contains("notes.txt"), "{refused}");
    assert!(folder.path().join("drawings/a.svg").exists());
    std::fs::remove_file(notes).unwrap();
    assert_eq!(squares(&numbers, &begin().unwrap(), &()).resumed, 0);
    assert!(!folder.path().join("drawings").exists());
    assert!(matches!(open("a = 1"), Err(StudyError::OtherSettings { .. })));
}

#[test]
fn a_member_that_is_interrupted_is_not_done_and_ends_the_study() {
    let folder = tempfile::tempdir().unwrap();
    let numbers = numbers(4);
    let open = || Journal::open(folder.path(), "").unwrap();
    let report = study::run(&numbers, &open(), &threads(1), &(), |number| {
        if number.name == "n1" { Err(Interrupted.into()) } else { square(number) }
    });
    let report = report.unwrap();
    assert!(report.stopped && report.rows.len() == 1, "{report:?}");
    let rest = squares(&numbers, &open(), &());
    assert_eq!((rest.resumed, rest.stopped, rest.rows.len()), (1, false, 4));
}

#[test]
fn a_second_study_in_one_folder_is_refused_while_the_first_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let numbers = numbers(3);
    let first = Journal::open(folder.path(), "").unwrap();
    for second in [
        Journal::<Number>::open(folder.path(), ""),
        Journal::<Number>::begin_anew(folder.path(), "", &Reads::new()),
    ] {
        let refused = second.err().unwrap().to_string();
        assert!(refused.contains("another run is writing to"), "{refused}");
    }
    assert_eq!(squares(&numbers, &first, &()).rows.len(), 3);
    drop(first);
    assert_eq!(squares(&numbers, &Journal::open(folder.path(), "").unwrap(), &()).resumed, 3);
}

#[test]
fn a_study_that_died_before_its_settings_were_written_begins_again() {
    let folder = tempfile::tempdir().unwrap();
    let journal = Manifest::of(folder.path()).changing("progress.jsonl").unwrap();
    let part = folder.path().join(".myospring-0123456789abcdef.part");
    for left in [&journal, &part] {
        std::fs::write(left, "").unwrap();
    }
    assert_eq!(squares(&numbers(2), &Journal::open(folder.path(), "").unwrap(), &()).rows.len(), 2);
    assert!(!part.exists());
}

#[test]
fn a_folder_that_holds_something_else_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("thesis.txt"), "").unwrap();
    let refused = Journal::<Number>::open(folder.path(), "").err().unwrap();
    assert!(matches!(&refused, StudyError::Occupied { .. }), "{refused}");
    let blocked = Journal::<Number>::open(&folder.path().join("thesis.txt"), "").err().unwrap();
    assert!(blocked.to_string().contains("thesis.txt"), "{blocked}");
}

#[test]
fn rows_depend_neither_on_threads_nor_on_company() {
    let numbers = numbers(40);
    let expected = squares(&numbers, &Journal::in_memory(), &()).rows;
    for (count, together) in [(1, 3), (2, 1), (2, 7), (2, 64)] {
        let together = NonZeroUsize::new(together).unwrap();
        let work = |group: &[&Number]| group.iter().map(|number| square(number)).collect();
        let journal = Journal::in_memory();
        let report =
            study::run_together(&numbers, &journal, &threads(count), &(), together, work).unwrap();
        assert_eq!(report.rows, expected, "{count} threads, {together} together");
    }
}

#[test]
fn whatever_goes_wrong_with_a_member_is_a_row_in_its_place() {
    let numbers = numbers(7);
    let together = NonZeroUsize::new(4).unwrap();
    let work = |group: &[&Number]| {
        assert!(group.iter().all(|number| number.name != "n3"), "a mistake of ours");
        group.iter().filter(|number| number.name != "n6").map(|number| square(number)).collect()
    };
    let journal = Journal::in_memory();
    let report = study::run_together(&numbers, &journal, &threads(2), &(), together, work).unwrap();
    let reasons: Vec<&str> = report.rows.iter().map(|row| row.reason.as_str()).collect();
    let mistake = "this is an error of the program; please report it together with this number";
    let refused = ["2.1 is not to be squared", "5.1 is not to be squared"];
    assert_eq!(reasons, ["", "", refused[0], mistake, "", refused[1], mistake]);
    assert_eq!((report.count(Status::Ok), report.count(Status::Failed)), (3, 4));
}

#[test]
fn what_whoever_watches_says_ends_the_study() {
    struct NoTable;
    impl StudyObserver<Number> for NoTable {
        fn table(&self, _: &[Square]) -> Result<(), Cause> {
            Err("the disk is full".into())
        }
    }
    let ended = study::run(&numbers(2), &Journal::in_memory(), &threads(1), &NoTable, square);
    assert_eq!(ended.unwrap_err().to_string(), "the disk is full");
}

#[test]
fn two_members_of_one_name_are_refused() {
    let mut numbers = numbers(3);
    numbers[2].name = "n0".to_owned();
    let refused = study::run(&numbers, &Journal::in_memory(), &threads(1), &(), square);
    let refused = refused.unwrap_err().to_string();
    assert!(refused.starts_with("two members of the study are named `n0`"), "{refused}");
}
