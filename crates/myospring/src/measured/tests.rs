use super::*;

fn read(text: &str, options: &Options) -> Table {
    read_named("cell.csv", text, options)
}

fn read_named(name: &str, text: &str, options: &Options) -> Table {
    read_bytes(name, text.as_bytes(), options).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn error(text: &str, options: &Options) -> String {
    let found = read_bytes("cell.csv", text.as_bytes(), options);
    found.map_or_else(|error| error.to_string(), |table| panic!("{text}: {table:?}"))
}

fn rate(frames_per_s: f64) -> Options {
    Options { frame_rate_per_s: Some(frames_per_s), ..Options::default() }
}

const NONE: fn() -> Options = Options::default;

#[test]
fn one_curve_is_read_the_same_from_any_form_of_table() {
    let wanted = (vec![0.0, 4.0, 8.0], vec![120.0, 118.5, 115.25]);
    for text in [
        "time_ms,length_um\n0,120\n4,118.5\n8,115.25\n",
        "Time (s);Length (µm)\r\n0;120\r\n0,004;118,5\r\n0,008;115,25\r\n",
        "Time [s]\tLength [um]\n0\t120\n0.004\t118.5\n0.008\t115.25\n",
        "Time (sec)   Cell length (microns)\n0.000   120.0\n0.004   118.5\n0.008   115.25\n",
        "Cell 7\nRecorded,2020-01-02\n\ntime,length\nms,um\n0,120\n4,118.5\n8,115.25\n",
        "# a comment\n,t_ms,length_um\n0,0,120\n1,4,118.5\n2,8,115.25\n",
        "t_ms,length_nm\n0,120000\n4,118500\n8,\"115,250\"\n",
        "length_um,time_ms,note\n120,0,rest\n118.5,4,\n115.25,8,\n,,\n",
        "time (s),length (um)\n0,120\n0.004,118.5\n0.008,115.25",
    ] {
        let Table { curves, .. } = read(text, &NONE());
        assert_eq!(curves.len(), 1, "{text}");
        let Curve { kind, unit, times_ms, values, .. } = &curves[0];
        assert_eq!((*kind, *unit), (Kind::Length, "um"), "{text}");
        assert_eq!((times_ms, values), (&wanted.0, &wanted.1), "{text}");
    }
}

#[test]
fn frames_become_times_by_the_frame_rate() {
    for text in [
        "length_um\n120\n118\n115\n",
        "frame,length_um\n0,120\n1,118\n2,115\n",
        "Frame #,length_um\n17,120\n18,118\n19,115\n",
        "1,120\n2,118\n3,115\n",
    ] {
        let table = read(text, &rate(50.0));
        assert_eq!(table.curves[0].times_ms, [0.0, 20.0, 40.0], "{text}");
    }
    let said = error("frame,length_um\n0,120\n1,118\n2,115\n", &NONE());
    assert!(said.contains("--frame-rate"), "{said}");
    let said = error("length_um\n120\n118\n115\n", &NONE());
    assert!(said.contains("no column of times") && said.contains("--frame-rate"), "{said}");
}

#[test]
fn times_without_a_unit_are_taken_as_what_a_camera_has_and_said() {
    for (text, last) in [
        ("time,length\n0,120\n0.004,118\n0.008,115\n", 8.0),
        ("time,length\n0,120\n4,118\n8,115\n", 8.0),
    ] {
        let table = read(text, &NONE());
        assert_eq!(table.curves[0].times_ms[2], last);
        assert!(table.notes.iter().any(|note| note.contains("has no unit")), "{:?}", table.notes);
    }
    // 0.1 may be 10 kHz in ms or ten frames a second.
    let text = "time,Vm (mV)\n0,-80\n0.1,-79\n0.2,-78\n";
    assert!(error(text, &NONE()).contains("--time-unit"));
    let options = Options { time_unit: Some("ms".to_owned()), ..NONE() };
    assert_eq!(read(text, &options).curves[0].times_ms, [0.0, 0.1, 0.2]);
    let said = error("time (ms),length (um)\n0,120\n4,118\n8,115\n", &rate(30.0));
    assert!(
        said.contains("250.0000 frames a second, and the frame rate given is 30.0000"),
        "{said}"
    );
}

#[test]
fn several_columns_are_several_cells_and_unknown_ones_among_known_are_passed_over() {
    let table = read("t_ms,cell 1,cell 2\n0,1,2\n4,1.5,2.5\n8,3,4\n", &NONE());
    let names: Vec<&str> = table.curves.iter().map(|curve| &*curve.name).collect();
    assert_eq!(names, ["cell 1", "cell 2"]);
    assert_eq!(table.curves[0].kind, Kind::Unknown);
    let table = read("t_ms,length_um,width_um\n0,1,2\n4,1.5,2.5\n8,3,4\n", &NONE());
    assert_eq!(table.curves.len(), 1);
    assert!(table.notes[0].contains("`width_um`"), "{:?}", table.notes);
    let chosen = Options {
        values: vec![Column::of("3"), Column::of("LENGTH")],
        kind: Some(Kind::Length),
        ..NONE()
    };
    let table = read("t_ms,length_um,width_um\n0,1,2\n4,1.5,2.5\n8,3,4\n", &chosen);
    assert_eq!(table.curves[0].values, [2.0, 2.5, 4.0]);
    assert_eq!(table.curves[1].name, "length_um");
    let unknown = Options { values: vec![Column::of("force")], ..NONE() };
    let said = error("t_ms,length_um\n0,1\n4,1.5\n", &unknown);
    assert!(said.contains("no column `force`; its columns are `t_ms`, `length_um`"), "{said}");
}

#[test]
fn cells_whose_columns_end_early_are_shorter_and_gaps_within_are_errors() {
    let text = "t_ms,length a_um,length b_um\n0,1,2\n4,1.5,2.5\n8,3,\n12,4,\n";
    let table = read(text, &NONE());
    assert_eq!(table.curves[1].times_ms, [0.0, 4.0]);
    let text = "t_ms,length_um\n0,1\n4,NaN\n8,3\n";
    let said = error(text, &NONE());
    assert!(said.contains("line 3, column `length_um`: \"NaN\" is no finite number"), "{said}");
    let table = read(text, &Options { skip_gaps: true, ..NONE() });
    assert_eq!(table.curves[0].times_ms, [0.0, 8.0]);
}

#[test]
fn tables_with_a_curve_in_each_row_are_read_by_their_frames() {
    let text = "frame0,frame1,frame2,frame3\n0.02,0.01,-0.03,0.0\n0.01,0.0,-0.02,0.01\n";
    let table = read_named("sarcomere_norm_length.csv", text, &rate(30.0));
    assert_eq!(table.curves.len(), 2);
    let curve = &table.curves[0];
    assert_eq!((curve.kind, &*curve.name), (Kind::NormalisedLength, "1"));
    assert!((curve.times_ms[3] - 100.0).abs() < 1e-12);
    assert_eq!(curve.values, [1.02, 1.01, 0.97, 1.0]);
    let table = read_named("a.csv", text, &Options { mean: true, ..rate(30.0) });
    assert_eq!((table.curves.len(), &*table.curves[0].name), (1, "mean of 2"));
    assert!((table.curves[0].values[2] + 0.025).abs() < 1e-12);
    assert!(error(text, &NONE()).contains("its rows are curves, without times"));
    let named = "sarcomere,frame0,frame1,frame2\nleft,1.8,1.7,1.6\nright,1.9,1.8,1.7\n";
    assert_eq!(read(named, &rate(30.0)).curves[1].name, "right");
}

#[test]
fn curves_one_after_the_other_are_told_apart_by_what_they_belong_to() {
    let text = ",frame,sarc_id,x,y,length,width\n\
                0,0,3,10,10,9.5,3\n1,0,4,20,10,9.7,3\n2,1,3,10,10,9.4,3\n3,1,4,20,10,9.6,3\n4,2,3,10,10,9.2,3\n";
    let options = Options { pixel_size_um: Some(0.2), unit: Some("px".to_owned()), ..rate(50.0) };
    let table = read(text, &options);
    assert_eq!(table.curves.len(), 2);
    assert_eq!(table.curves[0].name, "sarc_id 3");
    assert_eq!(table.curves[0].times_ms, [0.0, 20.0, 40.0]);
    assert!((table.curves[1].values[0] - 1.94).abs() < 1e-12);
}

#[test]
fn programs_own_files_are_read_directly() {
    let text = "0.0\t12.1\n13.3\t80.5\n26.7\t160.2\n40.0\t90.0\n";
    let table = read_named("contraction.txt", text, &NONE());
    let curve = &table.curves[0];
    assert_eq!((curve.kind, curve.unit), (Kind::Contraction, "a.u."));
    assert_eq!(curve.times_ms[1], 13.3);
    let text =
        "Time (s)\tSarc Length (µm)\tRatio\n0.000\t1.80\t0.9\n0.004\t1.79\t1.0\n0.008\t1.75\t1.2\n";
    let kinds: Vec<Kind> = read(text, &NONE()).curves.iter().map(|curve| curve.kind).collect();
    assert_eq!(kinds, [Kind::SarcomereLength, Kind::CalciumRatio]);
}

#[test]
fn what_is_wrong_with_a_table_is_said_with_its_place() {
    for (text, part) in [
        ("", "no line with numbers"),
        ("nothing here\n", "no line with numbers"),
        (
            "t_ms,length_um\n0,1\n4,much\n8,2\n",
            "line 3, column `length_um`: \"much\" is no finite number",
        ),
        (
            "t_ms,length_um\n0,1\n8,1\n4,2\n",
            "line 4, column `t_ms`: time 4 ms does not come after 8",
        ),
        ("t_ms\n0\n4\n8\n", "no column of values"),
        ("t_ms,length_um\n,1\n4,2\n8,3\n", "line 2, column `length_um`: 1 has no time"),
        ("t_ms,length_mV\n0,1\n4,2\n8,3\n", "`1 mV` is a potential, but a length is needed"),
    ] {
        let said = error(text, &NONE());
        assert!(said.contains(part), "{text}: {said}");
    }
    let said = error("length_um\n1\n2\n", &rate(0.0));
    assert!(said.contains("the frame rate is 0 /s"), "{said}");
    let said = read_bytes("a.xlsx", b"PK\x03\x04", &NONE()).unwrap_err().to_string();
    assert!(said.contains("`a.xlsx` is a workbook"), "{said}");
}
