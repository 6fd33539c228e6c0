use super::*;

fn read(text: &str, options: &TableOptions) -> Table {
    read_named("cell.csv", text, options)
}

fn read_named(name: &str, text: &str, options: &TableOptions) -> Table {
    read_bytes(name, text.as_bytes(), options).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn error(text: &str, options: &TableOptions) -> String {
    let found = read_bytes("cell.csv", text.as_bytes(), options);
    found.map_or_else(|error| error.to_string(), |table| panic!("{text}: {table:?}"))
}

fn rate(frames_per_s: f64) -> TableOptions {
    TableOptions { frame_rate_per_s: Some(frames_per_s), ..TableOptions::default() }
}

const NONE: fn() -> TableOptions = TableOptions::default;

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
    let options = TableOptions { time_unit: Some("ms".to_owned()), ..NONE() };
    assert_eq!(read(text, &options).curves[0].times_ms, [0.0, 0.1, 0.2]);
    let said = error("time (ms),length (um)\n0,120\n4,118\n8,115\n", &rate(30.0));
    assert!(
        said.contains("250.0000 frames a second, but the given frame rate is 30.0000"),
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
    let chosen = TableOptions {
        values: vec![Column::of("3"), Column::of("LENGTH")],
        kind: Some(Kind::Length),
        ..NONE()
    };
    let table = read("t_ms,length_um,width_um\n0,1,2\n4,1.5,2.5\n8,3,4\n", &chosen);
    assert_eq!(table.curves[0].values, [2.0, 2.5, 4.0]);
    assert_eq!(table.curves[1].name, "length_um");
    let unknown = TableOptions { values: vec![Column::of("force")], ..NONE() };
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
    assert!(said.contains("line 3, column `length_um`: \"NaN\" is not a finite number"), "{said}");
    let table = read(text, &TableOptions { skip_gaps: true, ..NONE() });
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
    let table = read_named("a.csv", text, &TableOptions { mean: true, ..rate(30.0) });
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
    let options =
        TableOptions { pixel_size_um: Some(0.2), unit: Some("px".to_owned()), ..rate(50.0) };
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
            "line 3, column `length_um`: \"much\" is not a finite number",
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
    assert!(said.contains("`a.xlsx`: it is an archive that cannot be read"), "{said}");
    let columns: Vec<String> = (0..200).map(|at| format!("c{at}")).collect();
    let wide = format!("{}\n{}\n", columns.join(","), vec!["1"; 200].join(","));
    let said = error(&wide, &NONE());
    assert!(said.contains("`c0`, `c1`, `c2`, `c3`, `c4` and 195 others"), "{said}");
}

/// Rows of a table: beats of 300 ms each second, up to 1, at these times in ms.
fn beating(times_ms: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
    let height = |t: f64| (1.0 - ((t.rem_euclid(1000.0) - 400.0) / 150.0).abs()).max(0.0);
    times_ms.map(|t| (t, height(t))).collect()
}

#[test]
fn times_in_the_first_row_are_times() {
    let beats = beating((0..200).map(|i| 50.0 * f64::from(i)));
    let row = |name: &str, of: &dyn Fn(&(f64, f64)) -> f64| {
        let fields: Vec<String> = beats.iter().map(|pair| of(pair).to_string()).collect();
        format!("{name},{}\n", fields.join(","))
    };
    let text = row("", &|(t, _)| t / 1e3)
        + &row("bf tissue 20fps", &|(_, v)| 100.0 + v)
        + &row("ca tissue", &|(_, v)| 2.0 * v);
    let table = read(&text, &NONE());
    assert_eq!(table.curves.len(), 2, "{:?}", table.notes);
    let [first, second] = &table.curves[..] else { unreachable!() };
    assert_eq!((&*first.name, &*second.name), ("bf tissue 20fps", "ca tissue"));
    assert_eq!((first.kind, second.kind), (Kind::Unknown, Kind::Fluorescence));
    assert_eq!((first.times_ms[1], first.values[8], first.lines[8]), (50.0, 101.0, 2));
    assert!(table.notes.iter().any(|note| note.contains("first row")), "{:?}", table.notes);
    let chosen = read(&text, &TableOptions { values: vec![Column::of("2")], ..NONE() });
    assert_eq!(chosen.curves[0].name, "ca tissue");
    let labelled = "Time (ms),0,10,20,30,40\ncell a length,5,4,3,4,5\n";
    let table = read(labelled, &NONE());
    assert_eq!((table.curves.len(), table.curves[0].kind), (1, Kind::Length));
    assert_eq!(table.curves[0].times_ms, [0.0, 10.0, 20.0, 30.0, 40.0]);
    let bad = "Time (ms),0,10,20,30,40\ncell a length,5,4,x,4,5\n";
    assert!(error(bad, &NONE()).contains("line 2, column `4`: \"x\""), "{}", error(bad, &NONE()));
}

#[test]
fn a_column_that_is_meant_twice_is_one_curve() {
    let text = "t_ms,length_um,length_um\n0,5,6\n10,4,5\n20,3,5\n30,4,6\n";
    let names = |values: &[&str]| -> Vec<String> {
        let values = values.iter().map(|value| Column::of(value)).collect();
        let table = read(text, &TableOptions { values, ..NONE() });
        table.curves.into_iter().map(|curve| curve.name).collect()
    };
    let both = ["length_um (column 2)", "length_um (column 3)"];
    assert_eq!(names(&[]), both);
    assert_eq!(names(&["length_um", "2"]), both);
    assert_eq!(names(&["3", "length_um", "3"]), [both[1], both[0]]);
}

#[test]
fn frames_beside_an_index_are_frames() {
    let frames: Vec<String> = (0..30).map(|frame| frame.to_string()).collect();
    let values: Vec<String> = (0..30).map(|frame| format!("0.0{}", frame % 7)).collect();
    for corner in ["", "index"] {
        let text = format!(
            "{corner},{}\n0,{}\n1,{}\n",
            frames.join(","),
            values.join(","),
            values.join(",")
        );
        let table = read_named("norm_length.csv", &text, &rate(50.0));
        let names: Vec<&str> = table.curves.iter().map(|curve| &*curve.name).collect();
        assert_eq!(names, ["0", "1"], "{text}");
        assert_eq!((table.curves[0].times_ms.len(), table.curves[0].times_ms[1]), (30, 20.0));
    }
}

#[test]
fn two_lines_of_names_belong_together() {
    let text = ",Cell1 ,,,,Cell 2 ,,\n,Ratio ,Numerator,Denominator,,Ratio ,Numerator,Denominator\n\
                0.0,0.9,7,8,,0.8,5,6\n0.001,0.91,7,8,,0.81,5,6\n0.002,0.92,7,8,,0.82,5,6\n";
    let table = read(text, &NONE());
    let names: Vec<&str> = table.curves.iter().map(|curve| &*curve.name).collect();
    assert_eq!(names, ["Cell1 Ratio", "Cell 2 Ratio"], "{:?}", table.notes);
    assert!(table.curves.iter().all(|curve| curve.kind == Kind::CalciumRatio));
    assert_eq!(table.curves[1].times_ms, [0.0, 1.0, 2.0]);
    let options = TableOptions { values: vec![Column::of("Cell 2 Numerator")], ..NONE() };
    assert_eq!(read(text, &options).curves[0].values, [5.0; 3]);
    let options = TableOptions { values: vec![Column::of("denominator")], ..NONE() };
    assert_eq!(read(text, &options).curves.len(), 2);
}

#[test]
fn each_channel_may_have_its_own_times_and_marks_of_a_pacer_are_stimuli() {
    let text = "Time 0\tsarc.Sarc Const\tTime 1\tRatio\tMark Time\tMarks\t\n\
                0.0001\t1.63\t0.0\t0.9\t0.0020\tPacer[TTL]\t\n\
                0.0041\t1.62\t0.001\t0.91\t0.0030\tPacer[TTL]\t\n\
                0.0081\t1.61\t0.002\t0.92\t1.0020\tPacer[TTL]\t\n\
                0.0121\t1.60\t0.003\t0.93\t1.5\tnote\t\n\
                0.0161\t1.61\t0.004\t0.94\t\t\t\n0.0201\t1.62\t\t\t\t\t\n";
    let table = read(text, &NONE());
    let [length, ratio] = &table.curves[..] else { panic!("{table:?}") };
    assert_eq!((length.kind, ratio.kind), (Kind::SarcomereLength, Kind::CalciumRatio));
    assert_eq!((length.times_ms.len(), ratio.times_ms.len()), (6, 5));
    assert!((length.times_ms[1] - 4.1).abs() < 1e-9 && (ratio.times_ms[1] - 1.0).abs() < 1e-9);
    assert_eq!(length.stimuli_ms, [2.0, 1002.0]);
    assert!(
        table.notes.iter().any(|note| note.contains("2 marks of a pacer")),
        "{:?}",
        table.notes
    );
    let without = read(text, &TableOptions { ignore_marks: true, ..NONE() });
    assert!(without.curves[0].stimuli_ms.is_empty());
}

#[test]
fn text_of_amplifiers_is_read() {
    let atf = "ATF\t1.0\n7\t3\n\"AcquisitionMode=Gap Free\"\n\"Comment=\"\n\"YTop=200,10\"\n\
               \"SweepStartTimesMS=0.000\"\n\"Signals=\"\t\"Vm\"\t\"Im\"\n\
               \"Time (s)\"\t\"Trace #1 (mV)\"\t\"Trace #1 (pA)\"\n\
               0\t-80\t1\n0.0001\t-79\t1\n0.0002\t-78\t1\n";
    let table = read(atf, &NONE());
    let curve = &table.curves[0];
    assert_eq!((table.curves.len(), curve.kind, curve.unit), (1, Kind::Potential, "mV"));
    assert_eq!((curve.values[0], curve.times_ms[2]), (-80.0, 0.2));
    let chart = "Interval=\t0.001 s\nExcelDateTime=\t4.1e+004\t1/1/2012\nTimeFormat=\tStartOfBlock\n\
                 ChannelTitle=\tForce\tCell length\nRange=\t10.000 V\t1.0 V\nUnitName=\tmN\tum\n\
                 0\t0.5\t120\n0.001\t0.6\t119\n0.002\t0.7\t118\n";
    let table = read(chart, &NONE());
    let kinds: Vec<Kind> = table.curves.iter().map(|curve| curve.kind).collect();
    assert_eq!(kinds, [Kind::Force, Kind::Length], "{:?}", table.notes);
    assert_eq!((table.curves[0].unit, table.curves[0].values[0]), ("nN", 0.5e6));
    assert_eq!(table.curves[1].times_ms, [0.0, 1.0, 2.0]);
}

#[test]
fn numbers_that_only_count_are_no_curve() {
    let text = "Name,Time [s],ND.T,ND.Z,ND.M,#1 (  FITC    )\na.nd2,-0.03,1,-1,-1,1506.94\n\
                a.nd2,-0.016,2,-1,-1,1495.56\na.nd2,-0.002,3,-1,-1,1483.82\n";
    let table = read(text, &NONE());
    assert_eq!((table.curves.len(), table.curves[0].kind), (1, Kind::Fluorescence));
    assert_eq!(table.curves[0].times_ms[0], -30.0);
    let text = "time (ms),number,plane,signal\n0,1,7,3.5\n4,2,7,3.6\n8,3,7,3.9\n12,4,7,3.8\n";
    let table = read(text, &NONE());
    assert_eq!(table.curves[0].values, [3.5, 3.6, 3.9, 3.8]);
    assert!(table.notes[0].contains("`number`, `plane`"), "{:?}", table.notes);
}

#[test]
fn times_that_may_be_of_two_units_are_refused_with_the_option_that_says_it() {
    let potential = |count: u32| -> String {
        let rows =
            (0..count).map(|i| format!("{},{}\n", 0.04 * f64::from(i), -80 + i64::from(i) % 7));
        rows.fold("t,V\n".to_owned(), |text, row| text + &row)
    };
    let said = error(&potential(10_000), &NONE());
    let wanted = "25 frames a second if they are s, 25000 frames a second if they are ms; say which: --time-unit s or \
                  --time-unit ms";
    assert!(said.contains(wanted), "{said}");
    let options = TableOptions { time_unit: Some("ms".to_owned()), ..NONE() };
    assert_eq!(read(&potential(100), &options).curves[0].times_ms[25], 1.0);
    // What is seen through a lens has no 25000 frames a second.
    let length = potential(10_000).replace("t,V", "t,length");
    assert_eq!(read(&length, &NONE()).curves[0].times_ms[25], 1000.0);
}

#[test]
fn ticks_of_a_clock_are_what_gives_beats_the_time_that_they_take() {
    // Beats that are 150 ms wide at half of their height, and `slower` ones.
    let of = |slower: f64, tick: f64| {
        let rows = beating((0..1000).map(|i| 10.0 * f64::from(i)));
        let line = |(t, v): &(f64, f64)| {
            format!("{}\t{}\n", (slower * t / tick).round(), (-1e5 * v).round())
        };
        rows.iter().map(line).collect::<String>()
    };
    let table = read(&of(1.0, 0.01), &NONE());
    assert_eq!(table.curves[0].times_ms[3], 30.0);
    assert!(table.notes[0].contains("read as 0.01 ms"), "{:?}", table.notes);
    // 600 ms, or 60: cells have both.
    let said = error(&of(4.0, 0.01), &NONE());
    assert!(said.contains("--time-unit us or --time-unit \"0.01 ms\""), "{said}");
    let said = TableOptions { time_unit: Some("0.01 ms".to_owned()), ..NONE() };
    assert_eq!(read(&of(4.0, 0.01), &said).curves[0].times_ms[3], 120.0);
}

#[test]
fn units_that_contradict_each_other_are_refused() {
    let text = "time (ms),length (um)\n0,120\n4,118\n8,115\n";
    let with = |unit: &str| TableOptions { unit: Some(unit.to_owned()), ..NONE() };
    let said = error(text, &with("nm"));
    assert!(said.contains("its unit is um, and --unit says nm"), "{said}");
    assert_eq!(read(text, &with("micron")).curves[0].values[0], 120.0);
    let options = TableOptions { time_unit: Some("s".to_owned()), ..NONE() };
    let said = error(text, &options);
    assert!(said.contains("its times are in ms, and --time-unit says s"), "{said}");
    assert_eq!(read("t_ms,Vm (a.u.)\n0,1\n4,2\n8,3\n", &with("mV")).curves[0].unit, "mV");
}

#[test]
fn a_part_of_the_recording_keeps_its_clock() {
    let text = "time (ms),length (um)\n0,120\n4,118\n8,115\n12,116\n";
    let options = TableOptions { from_ms: Some(4.0), until_ms: Some(8.0), ..NONE() };
    let curve = &read(text, &options).curves[0];
    assert_eq!((&curve.times_ms[..], &curve.values[..]), (&[4.0, 8.0][..], &[118.0, 115.0][..]));
    assert_eq!(curve.lines, [3, 4]);
    let said = error(text, &TableOptions { from_ms: Some(20.0), ..NONE() });
    assert!(said.contains("the recording runs from 0 to 12 ms"), "{said}");
    let said = error(text, &TableOptions { from_ms: Some(8.0), until_ms: Some(4.0), ..NONE() });
    assert!(said.contains("its end must come after its start"), "{said}");
}

#[test]
fn another_block_of_numbers_above_the_names_is_said() {
    let text = "time (ms),length (um)\n0,1\n4,2\n8,3\ntime (ms),length (um)\n0,120\n4,118\n8,115\n12,116\n";
    let table = read(text, &NONE());
    assert_eq!(table.curves[0].values, [120.0, 118.0, 115.0, 116.0]);
    assert!(table.notes[0].contains("3 lines of numbers above"), "{:?}", table.notes);
}

#[test]
fn a_number_beyond_the_last_column_is_refused_with_its_line() {
    for (text, part) in [
        (
            "t_ms,length_um\n0,120\n4,118\n8,117,5\n12,116\n",
            "line 4, column `3`: \"5\" is one field too many: the line of names has 2",
        ),
        (
            "t_ms,length_um\n0,0,120\n1,4,118\n2,8,117\n",
            "line 2, column `3`: \"120\" is one field too many: the line of names has 2",
        ),
        (
            "0,120\n4,118\n8,117,5\n12,116\n",
            "line 3, column `3`: \"5\" is one field too many: most rows have 2 fields",
        ),
    ] {
        let error = error(text, &NONE());
        assert!(error.contains(part), "{text}: {error}");
    }
    // What follows is no number: a last delimiter, a remark.
    let text = "t_ms,length_um\n0,120,\n4,118,,\n8,117,moved\n12,116\n";
    assert_eq!(read(text, &NONE()).curves[0].values, [120.0, 118.0, 117.0, 116.0]);
}

#[test]
fn columns_of_one_name_are_told_apart_and_said() {
    let text = "t_ms,length_um,length_um\n0,120,90\n4,118,91\n8,117,92\n";
    let Table { curves, notes } = read(text, &NONE());
    let names: Vec<&str> = curves.iter().map(|curve| &*curve.name).collect();
    assert_eq!(names, ["length_um (column 2)", "length_um (column 3)"]);
    assert!(notes.iter().any(|note| note.contains("several columns share a name")), "{notes:?}");
    assert_eq!(curves[0].unit, "um");
    let named = |name: &str| {
        let options = TableOptions { values: vec![Column::of(name)], ..NONE() };
        read(text, &options).curves.len()
    };
    assert_eq!([named("length_um"), named("length_um (column 3)"), named("3")], [2, 1, 1]);
    let twice = "t_ms,t_ms,length_um\n0,0,120\n4,8,118\n8,16,117\n";
    let Table { notes, .. } = read(twice, &NONE());
    let said = "column `t_ms (column 1)` has times but no curve";
    assert!(notes.iter().any(|note| note.contains(said)), "{notes:?}");
}

#[test]
fn a_line_that_is_much_longer_than_thousands_of_others_is_refused() {
    let long = |name: &str| (0..5000).map(|at| format!("{name}{at}")).collect::<Vec<_>>().join(",");
    let short = "1,2\n".repeat(5000);
    for (text, said) in [
        // As a table whose rows are curves it would have 25 million fields.
        (
            format!("{}\n{short}", long("f")),
            "the line of names has 5000 fields, the 5000 rows have 2.0 on average; correct that line, or use --layout columns",
        ),
        (
            format!("time (ms),length (um)\n{}\n{short}", "0,".repeat(5000)),
            "line 2, column `3`: \"0\" is one field too many",
        ),
        // As a table of columns it would take minutes.
        (
            format!("t_ms,{}\n{}", "length_um,".repeat(30_000), "1,2\n".repeat(20_000)),
            "the line of names has 30002 fields, the 20000 rows have 2.0 on average; correct that line, or delete",
        ),
    ] {
        let error = error(&text, &NONE());
        assert!(error.contains(said), "{error}");
    }
    // Columns may end early.
    let names: Vec<String> = (1..=40).map(|cell| format!("length {cell} (um)")).collect();
    let row = |frame: usize| {
        let cells = if frame < 2000 { 40 } else { 1 };
        format!("{}{}\n", 4 * frame, ",100".repeat(cells))
    };
    let text: String = (0..100_000).map(row).collect();
    let table = read(&format!("t_ms,{}\n{text}", names.join(",")), &NONE());
    assert_eq!((table.curves.len(), table.curves[1].values.len()), (40, 2000));
}

/// Twice the columns take twice the time; a machine that does other work may need four times as long.
#[test]
fn the_time_to_read_a_table_grows_with_its_columns() {
    let table = |columns: usize| {
        let name = |at: usize| format!(",length {at} (um)");
        let header: String = (0..columns).map(name).collect();
        let row = ",120".repeat(columns);
        let rows: Vec<String> = (0..8).map(|at| format!("{}{row}", 4 * at)).collect();
        format!("t_ms{header}\n{}\n", rows.join("\n"))
    };
    let time = |columns: usize| {
        let text = table(columns);
        let best = (0..3).map(|_| {
            let start = std::time::Instant::now();
            assert_eq!(read(&text, &NONE()).curves.len(), columns);
            start.elapsed()
        });
        best.min().unwrap_or_default().as_secs_f64()
    };
    let (few, many) = (time(1000), time(8000));
    assert!(many < 4.0 * 8.0 * few, "{few} s, then {many} s");
}

#[test]
fn a_gate_of_a_model_is_no_column_of_times() {
    let text = "t_ms,length_um,s,f_Ca_s,h_L,j_Ca\n0,120,1,1,1,1\n4,118,0.9,0.5,0.8,1\n8,117,0.7,0.4,0.8,2\n";
    let Table { curves, notes } = read(text, &NONE());
    assert_eq!((curves.len(), &*curves[0].name), (1, "length_um"), "{notes:?}");
    assert_eq!(curves[0].times_ms, [0.0, 4.0, 8.0]);
    assert!(notes.iter().any(|note| note.contains("`s`, `f_Ca_s`, `h_L`, `j_Ca`")), "{notes:?}");
}
