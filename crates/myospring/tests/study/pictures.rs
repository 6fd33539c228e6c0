//! Studies of pictures.

use super::threads;
use myospring::microscopy::cells::{PictureCell, PictureCells};
use myospring::run_file::Reader;
use myospring::study::pictures::{self, CellRow, ChosenCell, Picture, read_table};
use myospring::study::{self, Cause, Journal, Member, Status, StudyReport, sha256};
use std::path::Path;
use std::sync::Mutex;

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

fn beaten(
    folder: &Path,
    which: ChosenCell,
    journal: &Journal<Picture>,
) -> StudyReport<Vec<CellRow>> {
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
    // The options decide about empty fields. A seed contains a comma itself.
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
