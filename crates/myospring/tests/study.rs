//! Studies: resumed where they were, failures in their place, the same rows whatever the threads.
#![allow(clippy::unwrap_used, clippy::float_cmp, reason = "tests")]

#[path = "study/own_model.rs"]
mod own_model;

use myospring::cell::adaptive::{self, beats};
use myospring::cell::batch::CellBeat;
use myospring::cell::bueno_orovio_2008::{self, Variant};
use myospring::cell::minimal::MinimalModel;
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::{CellMethod, SolverSettings};
use myospring::cell::{CellModel, coelho_2021};
use myospring::microscopy::cells::{PictureCell, PictureCells};
use myospring::output::files::{Manifest, Reads};
use myospring::output::table::{Column, Table};
use myospring::run_file::Reader;
use myospring::study::cells::{self, BeatRow, PacedCell};
use myospring::study::pictures::{self, CellRow, ChosenCell, Picture, read_table};
use myospring::study::{
    self, Cause, Interrupted, Journal, Member, Row, Status, StudyError, StudyObserver, StudyReport,
    Threads, sha256,
};
use serde::{Deserialize, Serialize};
use std::any::Any;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

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
) -> StudyReport<Square> {
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

/// Cells of two papers, each paced in its own way.
fn paced_cells(count: u32) -> Vec<PacedCell> {
    let models = [coelho_2021::model(), bueno_orovio_2008::model(Variant::M)];
    let cell = |k: u32| {
        let model = models[k as usize % 2].clone();
        let percent = 90.0 + f64::from(k);
        let mut parameters = model.parameters().clone();
        let published = parameters.get("tau_si").unwrap();
        parameters.set("tau_si", published * percent / 100.0).unwrap();
        let identity =
            [coelho_2021::IDENTITY, bueno_orovio_2008::identity(Variant::M)][k as usize % 2];
        let protocol = Protocol {
            start_ms: 3.7 * f64::from(k),
            cycle_length_ms: 400.0 + 7.0 * f64::from(k),
            beats: k % 4,
            ..Protocol::once(identity.stimulus)
        };
        let model = MinimalModel::new(identity, parameters).unwrap();
        PacedCell {
            name: format!("cell {k}"),
            model: Arc::new(model),
            protocol,
            duration_ms: 1600.0,
        }
    };
    (0..count).map(cell).collect()
}

#[test]
fn cells_side_by_side_have_the_bits_of_each_alone_also_from_the_journal() {
    let folder = tempfile::tempdir().unwrap();
    let (paced, method) = (paced_cells(37), SolverSettings::of(CellMethod::Adaptive));
    let run = |cells: &[PacedCell], observer: &StopAfter| {
        let journal = Journal::open(folder.path(), &cells::settings(method)).unwrap();
        cells::run(cells, method, &journal, &threads(2), observer).unwrap()
    };
    let begun = run(&paced[..5], &StopAfter::new(usize::MAX));
    assert_eq!(begun.resumed, 0);
    let report = run(&paced, &StopAfter::new(usize::MAX));
    assert_eq!(report.resumed, 5);
    let mut rows = report.rows.iter();
    for cell in &paced {
        let own = adaptive::AdaptiveSettings { tolerance: method.tolerance };
        let model: &dyn Any = &*cell.model;
        let model: &MinimalModel = model.downcast_ref().unwrap();
        let alone = beats(model, cell.protocol, own, cell.duration_ms).unwrap();
        assert_eq!(alone.len(), cell.protocol.beats as usize);
        for (number, beat) in alone.iter().enumerate() {
            let row = rows.next().unwrap();
            assert_eq!(
                (row.cell.as_str(), row.number),
                (cell.name.as_str(), Some(number as u32 + 1))
            );
            assert_eq!(bits(&row.beat.unwrap()), bits(beat), "{}", cell.name);
        }
        if alone.is_empty() {
            let row = rows.next().unwrap();
            assert_eq!((row.status, row.number, row.beat), (Status::Ok, None, None));
        }
    }
    assert_eq!(rows.next(), None);
    assert_eq!(run(&paced, &StopAfter::new(usize::MAX)).resumed, 37);
}

fn bits(beat: &CellBeat) -> [Option<u64>; 6] {
    let CellBeat {
        stimulus_ms,
        resting_potential,
        peak_potential,
        peak_tension,
        peak_tension_ms,
        ..
    } = *beat;
    let numbers = [stimulus_ms, resting_potential, peak_potential, peak_tension, peak_tension_ms];
    let [a, b, c, d, e] = numbers.map(|number| Some(number.to_bits()));
    [a, b, c, d, e, beat.apd90_ms.map(f64::to_bits)]
}

#[test]
fn a_cell_that_cannot_be_followed_fails_in_its_place_and_a_changed_one_has_another_key() {
    let (mut paced, method) = (paced_cells(4), SolverSettings::of(CellMethod::Adaptive));
    let keys: Vec<String> = paced.iter().filter_map(Member::key).collect();
    paced[1].duration_ms = f64::NAN;
    paced[3].protocol.start_ms += 1e-9;
    for (k, cell) in paced.iter().enumerate() {
        assert_eq!(cell.key().unwrap() == keys[k], k % 2 == 0);
    }
    let journal = Journal::in_memory();
    let report = cells::run(&paced, method, &journal, &threads(1), &()).unwrap();
    let failed: Vec<&BeatRow> =
        report.rows.iter().filter(|row| row.status == Status::Failed).collect();
    assert_eq!((failed.len(), failed[0].cell.as_str()), (1, "cell 1"));
    assert!(failed[0].reason.contains("duration"), "{}", failed[0].reason);
    let table = String::from_utf8(BeatRow::table(&report.rows).to_csv().unwrap()).unwrap();
    assert!(table.starts_with("cell,status,reason,beat,stimulus_ms,"), "{table}");
    assert_eq!(table.lines().count(), 1 + report.rows.len());

    let impossible = SolverSettings { tolerance: 1.0, ..method };
    let refused = cells::run(&paced, impossible, &journal, &threads(1), &());
    assert!(matches!(refused, Err(StudyError::Cells(_))));
}

/// A bright ellipse with stripes, 240 x 120 pixels, its middle at this column.
fn picture(file: &Path, middle: f64) {
    let value = |x: u32, y: u32| {
        let (u, v) = ((f64::from(x) - middle) / 80.0, (f64::from(y) - 60.0) / 24.0);
        let stripes = 0.6 + 0.4 * (f64::from(x) * 0.5 * std::f64::consts::TAU / 1.9).cos();
        let light = if u * u + v * v < 1.0 { 200.0 * stripes } else { 0.0 };
        (20.0 + light) as u8 + ((x * 7 + y * 13) % 5) as u8
    };
    let pixels: Vec<u8> = (0..240 * 120).map(|at| value(at % 240, at / 240)).collect();
    let file = std::fs::File::create(file).unwrap();
    png::Encoder::new(file, 240, 120).write_header().unwrap().write_image_data(&pixels).unwrap();
}

fn beaten(folder: &Path, which: ChosenCell, journal: &Journal<Picture>) -> StudyReport<CellRow> {
    let names = ["whole.png", "cut.png", "missing.png"];
    let members =
        names.map(|name| Picture::new(name.to_owned(), folder.join("pictures").join(name)));
    let run = |picture: &Picture| {
        let text = "numerics.integrator = \"quasi-static\"\nshape.pixel_size = \"0.5 um\"\n\
                    shape.spacing = \"3 um\"";
        let path = picture.path.to_str().unwrap();
        let run = Reader::new().text("study", text)?.option("picture", "shape.picture", path);
        pictures::rows(picture, &run.resolve()?, which, &())
    };
    study::run(&members, journal, &threads(2), &(), run).unwrap()
}

#[test]
fn each_picture_gives_its_cell_or_the_reason_why_not() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("pictures")).unwrap();
    picture(&folder.path().join("pictures/whole.png"), 120.0);
    picture(&folder.path().join("pictures/cut.png"), 10.0);
    let open = || Journal::open(&folder.path().join("results"), "").unwrap();
    let report = beaten(folder.path(), ChosenCell::Every, &open());
    let statuses: Vec<Status> = report.rows.iter().map(|row| row.status).collect();
    assert_eq!(statuses, [Status::Ok, Status::LeftOut, Status::Failed, Status::Failed]);
    let [whole, cut, none_left, missing] = report.rows.as_slice() else { panic!("four rows") };
    let number = |row: &CellRow, wanted: &str| {
        row.numbers.iter().find(|(name, _)| name == wanted).and_then(|(_, value)| *value)
    };
    // 12 % at 50 kPa, the number to which the material is fitted; a coarse mesh is off by less than 0.3.
    assert!((number(whole, "peak_shortening_pct").unwrap() - 12.0).abs() < 0.3);
    assert!(cut.reason.starts_with("the frame cuts it"), "{}", cut.reason);
    assert!(none_left.reason.contains("cell 1: the frame cuts it"), "{}", none_left.reason);
    assert!(missing.reason.contains("missing.png") && missing.cell.is_none());

    // A picture that is there at last and one that has changed are done, the other is not touched.
    picture(&folder.path().join("pictures/missing.png"), 120.0);
    picture(&folder.path().join("pictures/cut.png"), 121.0);
    let again = beaten(folder.path(), ChosenCell::Every, &open());
    assert_eq!((again.resumed, again.count(Status::Ok)), (1, 3));
    assert_eq!(again.rows[0], *whole);

    // Asked for by itself, a cell is not left out; that the frame cuts it is an error of the picture.
    picture(&folder.path().join("pictures/cut.png"), 10.0);
    let chosen = beaten(folder.path(), ChosenCell::Chosen, &Journal::in_memory());
    assert_eq!((chosen.count(Status::Ok), chosen.count(Status::Failed)), (2, 1));
}

#[test]
fn a_table_gives_each_picture_its_settings_however_a_spreadsheet_writes_it() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.png", "b.png", "b.roi"] {
        std::fs::write(folder.path().join(name), name).unwrap();
    }
    let pictures = |table: &str| read_table(table.as_bytes(), "t.csv", folder.path()).unwrap();
    let given = |table: &str| -> Vec<(&'static str, String)> {
        let given = pictures(table).remove(0).given;
        given.into_iter().map(|given| (given.key, given.value.to_string())).collect()
    };
    let wanted = [("shape.pixel_size", "\"0.27 um\""), ("segmentation.channel", "1")]
        .map(|(key, value)| (key, value.to_owned()));
    for table in [
        "file,pixel_size,channel\na.png,0.27,1\n",
        "File,--pixel-size,Channel\r\na.png,0.27 um,1.0\r\n\r\n,,\r\n",
        "\u{feff}picture;pixel_size_um;segmentation.channel\na.png;0,27;1;;\n",
        "# of Tuesday\nfile\tshape.pixel_size\tchannel\na.png\t0.27\t1\n",
    ] {
        assert_eq!(given(table), wanted, "{table}");
    }
    // An option's short name is a column, too.
    let content = pictures("file,pixel_size,content\na.png,0.27,picture\n").remove(0).given;
    assert_eq!(content[1].key, "mechanics.myofibril_content");
    // What is left empty is left to the options; a seed has a comma of its own.
    let seeds = "file,pixel_size,seed,group\nb.png,,\"12,30\",x\nb.png,,\"40,60\",\n";
    let seeds = pictures(seeds);
    let names: Vec<&str> = seeds.iter().map(Member::name).collect();
    assert_eq!(names, ["b.png", "b.png-2"]);
    assert_eq!((seeds[1].file.as_str(), seeds[0].group.as_deref()), ("b.png", Some("x")));
    assert_eq!((seeds[1].given.len(), &seeds[1].group), (1, &None));
}

#[test]
fn what_is_wrong_with_a_table_is_said_with_its_line_and_column() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.png"), "a").unwrap();
    let latin: &[u8] = b"file,pixel_size\na.png,0.27 \xb5m\n";
    assert!(read_table(latin, "t.csv", folder.path()).is_ok());
    let cases: [(&[u8], &[&str]); 10] = [
        (b"file,pixelsize\na.png,1\n", &["line 1, column 2", "`pixelsize`", "mean `pixel_size`?"]),
        (b"file,parameters\na.png,1\n", &["line 1, column 2", "no setting `parameters`"]),
        (b"file,seed,--seed\na.png,1,2\n", &["columns 2 and 3", "segmentation.seed"]),
        (b"name,seed\na.png,1\n", &["line 1, column 1", "`name`"]),
        (b"seed,stain\n\"1,2\",z-disc\n", &["no column is named `file`", "`seed`, `stain`"]),
        (b"file,seed\na.png,12,30\n", &["line 2 has 3 values", "2 columns", "quotes"]),
        (
            b"file,outline\na.png,a.roi\nb.png,\n,\n,x.roi\n",
            &[
                "line 2, column `outline`",
                "a.roi",
                "line 3, column `file`",
                "b.png",
                "line 5 names",
            ],
        ),
        (b"file,group\na.png,x\n\na.png,y\n", &["line 4 repeats line 2", "twice"]),
        (b"file,group\n", &["lists no picture"]),
        (b"PK\x03\x04", &["workbook", "save the sheet as CSV"]),
    ];
    for (table, expected) in cases {
        let error = read_table(table, "t.csv", folder.path()).unwrap_err().to_string();
        for part in expected {
            assert!(error.contains(part) && error.contains("`t.csv`"), "lacks {part}: {error}");
        }
    }
}

#[test]
fn a_picture_is_done_anew_when_a_setting_of_its_own_has_changed() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.png", "a.roi"] {
        std::fs::write(folder.path().join(name), name).unwrap();
    }
    let key = |table: &str| {
        read_table(table.as_bytes(), "t.csv", folder.path()).unwrap()[0].key().unwrap()
    };
    let table = "file,outline,group\na.png,a.roi,x\n";
    let before = key(table);
    assert_eq!(key("group,file,outline\nx,a.png,a.roi\n"), before);
    assert_ne!(key("file,outline,group\na.png,a.roi,y\n"), before);
    assert_ne!(
        key("file,threshold,group\na.png,12,x\n"),
        key("file,threshold,group\na.png,13,x\n")
    );
    std::fs::write(folder.path().join("a.roi"), "mended").unwrap();
    assert_ne!(key(table), before);
    let alone = Picture::new("a.png".to_owned(), folder.path().join("a.png"));
    assert_eq!(alone.key(), Some(sha256(b"a.png")));
}

/// What a study showed of each picture: its name, how many cells were beaten, and the notes.
struct Shown(Mutex<Vec<(String, usize, String)>>);
impl pictures::Keeper for Shown {
    fn found(
        &self,
        picture: &Picture,
        _: &PictureCells,
        to_beat: &[&PictureCell],
        notes: &[String],
    ) -> Result<(), Cause> {
        self.0.lock().unwrap().push((picture.name.clone(), to_beat.len(), notes.join("; ")));
        Ok(())
    }
}
#[test]
fn debris_is_left_out_of_a_table_unless_it_is_pointed_at_and_every_picture_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    // A mask of a cell of 1500 um^2, a speck of 200 um^2 and a sheet of 24 000 um^2; and one of nothing.
    let save = |name: &str, value: &dyn Fn(u32, u32) -> u8| {
        let file = std::fs::File::create(folder.path().join(name)).unwrap();
        let pixels: Vec<u8> = (0..240 * 200).map(|at| value(at % 240, at / 240)).collect();
        let mut writer = png::Encoder::new(file, 240, 200).write_header().unwrap();
        writer.write_image_data(&pixels).unwrap();
    };
    save("dish.png", &|x, y| match (x, y) {
        (5..80, 5..25) => 1,
        (100..120, 10..20) => 2,
        (5..235, 40..145) => 3,
        _ => 0,
    });
    let grain = |x: u32, y: u32| (x * 240 + y).wrapping_mul(2_654_435_761) >> 27;
    save("grains.png", &|x, y| grain(x, y) as u8 + grain(y + 7, x) as u8);

    let shown = Shown(Mutex::default());
    let rows = |name: &str, which, more: &str| {
        let picture = Picture::new(name.to_owned(), folder.path().join(name));
        let text = format!(
            "numerics.integrator = \"quasi-static\"\nshape.pixel_size = \"1 um\"\nshape.spacing = \"2 um\"\n{more}"
        );
        let path = picture.path.to_str().unwrap();
        let reader = Reader::new().text("study", &text).unwrap();
        let run = reader.option("picture", "shape.picture", path).resolve().unwrap();
        pictures::rows(&picture, &run, which, &shown).unwrap()
    };
    let reasons = |rows: &[CellRow]| -> Vec<(Status, String)> {
        rows.iter().map(|row| (row.status, row.reason.clone())).collect()
    };
    let all = reasons(&rows("dish.png", ChosenCell::Every, ""));
    assert_eq!(all.len(), 3);
    assert!(all[0].0 == Status::LeftOut && all[0].1.contains("24150 um^2 is above 20000 um^2"));
    assert_eq!(all[1], (Status::Ok, String::new()));
    assert!(all[2].0 == Status::LeftOut && all[2].1.contains("200 um^2 is below 500 um^2"));

    // The largest is nobody's choice; the bounds are the user's, and so is a label.
    let largest = reasons(&rows("dish.png", ChosenCell::Chosen, ""));
    assert_eq!((largest[0].0, largest[1].0), (Status::LeftOut, Status::Failed), "{largest:?}");
    let lower = rows("dish.png", ChosenCell::Every, "segmentation.min_area = \"150 um^2\"");
    assert_eq!((lower[1].status, lower[2].status), (Status::Ok, Status::Ok));
    let speck = rows("dish.png", ChosenCell::Chosen, "shape.label = 2");
    assert_eq!((speck.len(), speck[0].status), (1, Status::Ok));
    assert!(speck[0].warnings.contains("200 um^2 is below 500 um^2"), "{}", speck[0].warnings);

    let nothing = rows("grains.png", ChosenCell::Every, "segmentation.modality = \"fluorescence\"");
    assert_eq!((nothing.len(), nothing[0].status), (1, Status::Failed));
    let shown = shown.0.into_inner().unwrap();
    assert_eq!(shown.len(), 5);
    assert!(
        shown[0].2.contains(
            "because of their size (--min-area, --max-area): 3 (24150 um^2), 2 (200 um^2)"
        ),
        "{}",
        shown[0].2
    );
    let (name, beaten, notes) = &shown[4];
    assert_eq!((name.as_str(), *beaten), ("grains.png", 0));
    assert!(notes.contains("no cell was found"), "{notes}");
}
