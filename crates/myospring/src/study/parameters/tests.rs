//! Small studies whose answers are known.

use super::super::{Journal, Member as _, Row as _, Status, StudyObserver, Threads};
use super::{
    Answer, Common, ParameterStudy, Ranked, Shard, TRACES, Values, Variation, VariationRow, run,
    run_members,
};
use crate::cell::solve::{SolverSettings, solve};
use crate::interruption::Interruption;
use crate::output::npy::Records;
use crate::run_file::RunFile;
use crate::settings::NumericSetting;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

fn no_file(_file: &str) -> io::Result<Vec<u8>> {
    Err(io::ErrorKind::NotFound.into())
}

fn study(text: &str) -> ParameterStudy {
    ParameterStudy::from_toml(text, no_file).unwrap()
}

fn rows(study: &ParameterStudy, part: Shard, threads: usize) -> Vec<VariationRow> {
    let common = Common::new(study, no_file).unwrap();
    let threads = Threads::new(Some(threads)).unwrap();
    run(study, &common, part, &Journal::in_memory(), &threads, &()).unwrap().rows
}

const TENSIONS: &str = "
    metrics = [\"peak_shortening\", \"peak_tension\"]
    [run.shape]
    spacing = \"4 um\"
    [parameters]
    peak_tension = { distribution = \"uniform\", low = \"20 kPa\", high = 60 }
    tau_si = { distribution = \"uniform\", low = 0.99, high = 1.01, relative = true }
    [sampling]
    sampler = \"latin-hypercube\"
    size = 24
";

#[test]
fn a_member_gives_what_a_run_with_its_values_gives() {
    let study = study(TENSIONS);
    let rows = rows(&study, Shard::WHOLE, 2);
    assert_eq!(rows.len(), 24);
    for row in [&rows[0], &rows[17]] {
        let file = study.run_of(&study.values.of(row.member).unwrap()).unwrap();
        let run = file.resolve().unwrap();
        let shaped = run.shape.mesh(&run.shape.bytes(no_file).unwrap()).unwrap();
        let outcome = run.make(shaped, no_file).unwrap().simulation.build().unwrap().run(|_| true);
        // To the last bit, though others have shared its equilibria.
        let beats = outcome.beats();
        assert_eq!(row.metrics, ["peak_shortening", "peak_tension"].map(|it| beats[0].value(it)));
    }
}

const TOR_ORD: &str = "
    kind = \"cell\"
    [run.cell]
    model = \"tor_ord_land\"
    [run.run]
    duration = \"500 ms\"
    [parameters]
    G_Kr = { distribution = \"uniform\", low = 0.8, high = 1.2, relative = true }
    P_Ca = { distribution = \"uniform\", low = 0.8, high = 1.2, relative = true }
    [sampling]
    sampler = \"latin-hypercube\"
    size = 11
";

#[test]
fn cells_of_tor_ord_beat_side_by_side_as_each_does_alone() {
    let study = study(TOR_ORD);
    let whole = rows(&study, Shard::WHOLE, 1);
    assert_eq!(rows(&study, Shard::WHOLE, 2), whole);
    let part = rows(&study, Shard { part: 3, of: 4 }, 1);
    assert!(part.iter().all(|row| row == &whole[row.member - 1]));
    let common = Common::new(&study, no_file).unwrap();
    let named = |row: &VariationRow, name: &str| {
        let at = study.metrics.iter().position(|metric| metric == name).unwrap();
        row.metrics[at].unwrap()
    };
    assert_eq!(common.axes.as_ref().unwrap().quantities.len(), 3);
    for row in [&whole[0], &whole[7]] {
        let run = study.run_of(&study.values.of(row.member).unwrap()).unwrap().resolve().unwrap();
        let settings = SolverSettings { tolerance: 1e-6, ..run.cell_settings() };
        let trace = solve(&*run.cell, run.protocol, settings, 500.0, 0.5).unwrap();
        let near = |name, expected: f64, by: f64| {
            let found = named(row, name);
            assert!((found / expected - 1.0).abs() < by, "{name}: {found} {expected}");
        };
        // What the tolerance 1e-4 and samples each 0.5 ms leave.
        near("peak_tension", trace.peak_tension().unwrap().value, 1e-3);
        let calcium = trace.variable("Ca_i").unwrap();
        near("systolic_level", calcium.iter().copied().fold(0.0, f64::max), 1e-3);
        near("diastolic_level", calcium[0], 1e-2);
        near("peak_potential", trace.potential.iter().copied().fold(0.0, f64::max), 1e-2);
        let apd90 = named(row, "action_potential_duration_90");
        assert!((200.0..350.0).contains(&apd90), "{apd90} ms");
    }
    // Another method moves each cell alone: the run without any change by both.
    let gates = TOR_ORD.replace("[run.cell]", "[run.cell]\nintegrator = \"rush-larsen\"");
    let usual = |text: &str| Common::new(&self::study(text), no_file).unwrap().usual;
    for ((name, stiff), other) in study.metrics.iter().zip(&common.usual).zip(usual(&gates)) {
        let (stiff, other) = (stiff.unwrap(), other.unwrap());
        // Rush and Larsen's steps of 0.005 ms are of the first order: their peak is 0.5 mV higher.
        assert!((other / stiff - 1.0).abs() < 0.02, "{name}: {stiff} and {other}");
    }
}

#[test]
fn rows_are_the_same_whatever_the_threads_the_shards_and_the_interruptions() {
    let study = study(TENSIONS);
    let whole = rows(&study, Shard::WHOLE, 1);
    assert_eq!(rows(&study, Shard::WHOLE, 2), whole);
    let mut parts: Vec<VariationRow> =
        (1..=3).flat_map(|part| rows(&study, Shard { part, of: 3 }, 1)).collect();
    parts.sort_by_key(|row| row.member);
    assert_eq!(parts, whole);
    // A journal that was torn in the middle of a line goes on.
    let folder = tempfile::tempdir().unwrap();
    let common = Common::new(&study, no_file).unwrap();
    let threads = Threads::new(Some(1)).unwrap();
    let open = || Journal::open(folder.path(), &study.settings(&common)).unwrap();
    let part = Shard { part: 1, of: 3 };
    run::<Vec<_>>(&study, &common, part, &open(), &threads, &()).unwrap();
    let path = folder.path().join("progress.jsonl");
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() - 30]).unwrap();
    let report = run(&study, &common, Shard::WHOLE, &open(), &threads, &()).unwrap();
    assert_eq!((report.resumed, report.rows), (7, whole));
}

#[test]
fn what_causes_the_variance_is_ranked_first() {
    // Peak tension is in proportion to the setting alone; APD hangs on tau_so2, not on it.
    let study = study(
        "kind = \"cell\"
        [parameters]
        peak_tension = { distribution = \"uniform\", low = 20, high = 60 }
        tau_so2 = { distribution = \"uniform\", low = 0.9, high = 1.1, relative = true }
        [sampling]
        sampler = \"saltelli\"
        size = 128
        pairs = true",
    );
    let common = Common::new(&study, no_file).unwrap();
    let answer =
        Answer::new(&study, &common.units, rows(&study, Shard::WHOLE, 2).into_iter().collect());
    let found = answer.sensitivity().unwrap();
    let of = |metric: &str| found.iter().find(|one| one.metric == metric).unwrap();
    let duration = of("action_potential_duration_90");
    let [Ranked::Sobol { parameter, total, .. }, Ranked::Sobol { total: none, .. }] =
        &duration.parameters[..]
    else {
        panic!("{duration:?}")
    };
    assert_eq!(parameter, "cell.parameters.tau_so2");
    assert!((total.value - 1.0).abs() < 0.05 && none.value == 0.0, "{duration:?}");
    assert_eq!(duration.pairs.len(), 1);
    assert_eq!(of("peak_tension").unit, "kPa");
}

#[test]
fn members_outside_the_bands_are_not_kept_and_those_that_fail_are_rows() {
    let study = study(
        "metrics = [\"peak_shortening\"]
        [run.shape]
        spacing = \"5 um\"
        [parameters]
        peak_tension = { distribution = \"uniform\", low = 10, high = 600 }
        [sampling]
        sampler = \"grid\"
        levels = 5
        [keep]
        peak_shortening = [5, 30]",
    );
    let common = Common::new(&study, no_file).unwrap();
    let answer =
        Answer::new(&study, &common.units, rows(&study, Shard::WHOLE, 2).into_iter().collect());
    let last = answer.rows().get(4).unwrap();
    assert_eq!(last.status, Status::Failed);
    assert!(last.reason.contains("600 kPa") && last.reason.contains("500 kPa"), "{}", last.reason);
    let counted = answer.acceptance();
    assert_eq!((counted.beat, counted.failed), (4, 1));
    assert!(counted.kept > 0 && counted.kept < 4);
    let table = String::from_utf8(answer.table().to_csv().unwrap()).unwrap();
    assert!(table.starts_with("member,peak_tension_kPa,peak_shortening_pct,kept,status,reason\n"));
    assert_eq!(table.lines().count(), 6);
}

#[test]
fn a_description_that_cannot_be_says_where_and_why() {
    let sampling = "\n[sampling]\nsampler = \"latin-hypercube\"\nsize = 4\n";
    let one = "[parameters]\ntau_si = { distribution = \"uniform\", low = 1, high = 2 }\n";
    for (text, expected) in [
        (one.to_owned(), "[sampling] is missing"),
        (format!("{one}{sampling}sise = 3"), "sise"),
        (format!("seed = 3\n{one}{sampling}"), "unknown field `seed`"),
        (one.replace("tau_si", "tau_sj") + sampling, "the nearest are tau_s1, tau_s2, tau_si"),
        (one.replace("low = 1", "low = \"1 kPa\"") + sampling, "[parameters.tau_si] low"),
        (one.replace("high = 2", "high = 0") + sampling, "needs high above low, but high is 0"),
        (one.replace("uniform", "unifrom") + sampling, "unifrom"),
        (one.replace("low = 1, ", "") + sampling, "missing field `low`"),
        (format!("[parameters]\ntau_si = 3\n{sampling}"), "write a distribution"),
        (format!("[parameters]\n{sampling}"), "no parameter varies"),
        (format!("run = \"none.toml\"\n{one}{sampling}"), "cannot read `none.toml`"),
        (format!("[run.cell]\nmodle = \"x\"\n{one}{sampling}"), "modle"),
        (
            one.replace(" }", ", relative = \"true\" }") + sampling,
            "relative is true or false, not \"true\"",
        ),
        (one.replace(" }", ", relative = 1 }") + sampling, "relative is true or false, not 1"),
        (
            one.replace("low = 1", "low = \"0.9 kPa\"").replace(" }", ", relative = true }")
                + sampling,
            "[parameters.tau_si]: low = \"0.9 kPa\": with relative = true it is a factor",
        ),
        (
            format!("{one}{sampling}[keep]\npeak_shortening = [nan, 3]\n"),
            "[keep] peak_shortening = [NaN, 3]",
        ),
        (
            format!("{one}{sampling}[keep]\npeak_shortening = [3, 1]\n"),
            "write the least and the largest value",
        ),
    ] {
        let error = ParameterStudy::from_toml(&text, no_file).unwrap_err().to_string();
        assert!(error.contains(expected), "{expected}: {error}");
    }
    for (text, expected) in [
        (
            format!("metrics = [\"peak_shortning\"]\n{one}{sampling}"),
            "did you mean `peak_shortening`?",
        ),
        (format!("kind = \"cell\"\nmetrics = [\"peak_shortening\"]\n{one}{sampling}"), "no metric"),
        (
            format!(
                "kind = \"cell\"\n{one}thickness = {{ distribution = \"uniform\", low = 8, high = 9 }}\n{sampling}"
            ),
            "`material.thickness` belongs to the mesh",
        ),
    ] {
        let study = study(&text);
        let error = Common::new(&study, no_file).err().unwrap().to_string();
        assert!(error.contains(expected), "{expected}: {error}");
    }
}

#[test]
fn a_table_of_rows_is_taken_as_it_stands() {
    let text = "kind = \"cell\"\n[sampling]\nsampler = \"table\"\nfile = \"rows.csv\"\n";
    let read = |table: &'static str| {
        ParameterStudy::from_toml(text, move |_| Ok(table.as_bytes().to_vec()))
    };
    let study = read("tau_si,cell.peak_tension\n1.7,50\n1.8,30 kPa\n").unwrap();
    assert_eq!(study.values, Values::Table(vec![vec![1.7, 50.0], vec![1.8, 30.0]]));
    assert_eq!(rows(&study, Shard::WHOLE, 1).len(), 2);
    for (table, expected) in [
        ("tau_si\n1.7\nmany\n", "line 3, column tau_si"),
        ("tau_si,cell.parameters.tau_si\n1,2\n", "given twice"),
        ("tau_si\n", "no rows"),
    ] {
        let error = read(table).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    let beside = |keys: &str| {
        let text = format!("{text}{keys}");
        ParameterStudy::from_toml(&text, |_| Ok(b"tau_si\n1.7\n".to_vec())).unwrap_err().to_string()
    };
    for (keys, expected) in [
        ("size = 3\n", "unknown field `size`"),
        ("seed = 3\n", "unknown field `seed`"),
        (
            "[parameters]\ntau_si = { distribution = \"fixed\", value = 2 }\n",
            "[parameters] would not be used: leave it out",
        ),
    ] {
        let error = beside(keys);
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn rows_of_somebody_elses_have_any_metric_of_the_run_as_the_mean_over_its_beats() {
    let file = RunFile::from_text(
        "shape.spacing = \"5 um\"\nnumerics.integrator = \"quasi-static\"\nstimulus.beats = 2\n\
         stimulus.cycle_length = \"500 ms\"",
    );
    let file = file.unwrap();
    let tension = NumericSetting::named(&file.resolve().unwrap(), "peak_tension").unwrap();
    let metrics = ["peak_shortening", "active_work"];
    let of_rows = |values: Vec<Vec<f64>>| {
        let metrics = metrics.map(str::to_owned).to_vec();
        ParameterStudy::of_rows(file.clone(), vec![tension.clone()], metrics, values)
    };
    let study = of_rows(vec![vec![50.0], vec![f64::NAN]]).unwrap();
    let rows = rows(&study, Shard::WHOLE, 1);
    let run = file.resolve().unwrap();
    let shaped = run.shape.mesh(&run.shape.bytes(no_file).unwrap()).unwrap();
    let alone = run.make(shaped, no_file).unwrap().simulation.build().unwrap().run(|_| true);
    assert_eq!(alone.beats().len(), 2);
    assert_eq!(rows[0].metrics, metrics.map(|name| alone.beats().mean(name)));
    assert!(rows[0].metrics.iter().all(Option::is_some));
    assert!(rows[1].reason.contains("`cell.peak_tension` = NaN is not a finite"), "{rows:?}");
    let error = of_rows(vec![vec![50.0], vec![]]).unwrap_err().to_string();
    assert_eq!(error, "row 2 has 0 values, but 1 numbers vary");
}

#[test]
fn a_study_goes_on_only_with_the_files_it_began_with() {
    let settings = |corner: &'static str| {
        let read = move |_file: &str| Ok(format!("0,0\n100,0\n{corner}\n0,20\n").into_bytes());
        let text = TENSIONS.replace("spacing", "outline = \"cell.csv\"\n    spacing");
        let study = ParameterStudy::from_toml(&text, read).unwrap();
        study.settings(&Common::still(&study, read, None).unwrap())
    };
    assert_eq!(settings("100,20"), settings("100,20"));
    assert_ne!(settings("100,20"), settings("101,20"));
}

#[test]
fn rows_from_elsewhere_are_those_of_the_study_itself() {
    let study = study(TENSIONS);
    let whole = rows(&study, Shard::WHOLE, 2);
    let folder = tempfile::tempdir().unwrap();
    let common = Common::new(&study, no_file).unwrap();
    let open = || Journal::open(folder.path(), &study.settings(&common)).unwrap();
    let part = Shard { part: 2, of: 3 };
    let journal = open();
    assert_eq!(study.left(part, &journal).unwrap(), [2, 5, 8, 11, 14, 17, 20, 23]);
    study.note(&journal, vec![whole[4].clone(), whole[1].clone()]).unwrap();
    drop(journal);
    let journal = open();
    assert_eq!(study.left(part, &journal).unwrap(), [8, 11, 14, 17, 20, 23]);
    let mut noted = Vec::new();
    study.add_noted(part, &journal, &mut noted).unwrap();
    assert_eq!(noted, [whole[1].clone(), whole[4].clone()]);
    let report = run(&study, &common, Shard::WHOLE, &journal, &Threads::new(None).unwrap(), &());
    let report = report.unwrap();
    assert_eq!((report.resumed, report.rows), (2, whole));
}

/// Stops the study once it has been asked this many times whether to go on.
struct For(Arc<AtomicUsize>);

impl StudyObserver<Variation> for For {
    fn interruption(&self) -> Interruption {
        let left = Arc::clone(&self.0);
        let less = |left: usize| left.checked_sub(1);
        Interruption::when(move || {
            left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less).is_err()
        })
    }
}

#[test]
fn a_member_under_way_when_a_study_stops_has_no_row() {
    let of_cells = TENSIONS.replace("[run.shape]\n    spacing = \"4 um\"", "");
    let of_cells =
        of_cells.replace("metrics = [\"peak_shortening\", \"peak_tension\"]", "kind = \"cell\"");
    for text in [TENSIONS, &format!("{of_cells}\n[run.stimulus]\nbeats = 200\n")] {
        let study = study(text);
        let common = Common::new(&study, no_file).unwrap();
        let members = study.members(Shard::WHOLE);
        let threads = Threads::new(Some(1)).unwrap();
        let stops = For(Arc::new(AtomicUsize::new(3)));
        let report =
            run_members(&common, &members, &Journal::in_memory(), &threads, &stops).unwrap();
        assert!(report.stopped && report.rows.is_empty(), "{:?}", report.rows);
    }
}

#[test]
fn a_part_of_a_study_is_written_as_i_of_n() {
    assert_eq!("2/8".parse::<Shard>().unwrap(), Shard { part: 2, of: 8 });
    for text in ["0/8", "9/8", "2", "a/b", "2/8/1"] {
        assert!(text.parse::<Shard>().unwrap_err().to_string().contains("like 2/8"), "{text}");
    }
}

#[test]
fn curves_are_those_of_the_members_and_change_no_row() {
    for kind in ["cell", "beat"] {
        let text = format!(
            "kind = \"{kind}\"
            metrics = [\"peak_tension\"]
            [run.shape]
            spacing = \"5 um\"
            [parameters]
            tau_si = {{ distribution = \"uniform\", low = 0.98, high = 1.02, relative = true }}
            [sampling]
            sampler = \"latin-hypercube\"
            size = 9"
        );
        let with = study(&text);
        let without = study(&format!("traces = false\n{text}"));
        assert!(with.traces && !without.traces);
        let folder = tempfile::tempdir().unwrap();
        let threads = Threads::new(Some(2)).unwrap();
        let common = Common::new(&with, no_file).unwrap();
        let part = Shard { part: 2, of: 2 };
        let common = common.keeping_traces(folder.path(), part).unwrap();
        let rows_with: Vec<VariationRow> =
            run(&with, &common, part, &Journal::in_memory(), &threads, &()).unwrap().rows;
        let numbers = |row: &VariationRow| VariationRow { curves: String::new(), ..row.clone() };
        let numbers: Vec<VariationRow> = rows_with.iter().map(numbers).collect();
        assert_eq!(numbers, rows(&without, part, 1));
        let axes = common.axes.as_ref().unwrap();
        let file = folder.path().join(TRACES);
        let mut records = Records::open(&file, &[4, axes.quantities.len(), axes.times]).unwrap();
        for (record, row) in rows_with.iter().enumerate() {
            let curves = records.read(record).unwrap();
            let tension = &curves[axes.times..2 * axes.times];
            let peak = tension.iter().copied().fold(f32::MIN, f32::max);
            // Half of 2.5 ms beside the peak, tension is less by a thousandth at most.
            let off = f64::from(peak) / row.metrics[0].unwrap() - 1.0;
            assert!((-1e-3..1e-6).contains(&off), "{kind}, member {}: {off}", row.member);
        }
    }
}

#[test]
fn missed_stimuli_count_in_no_mean_with_a_mesh_and_without() {
    let text = |kind: &str| {
        format!(
            "kind = \"{kind}\"\nbeat = \"mean\"\n\
             metrics = [\"action_potential_duration_90\", \"peak_tension\", \"time_to_peak_tension\"]\n\
             [run.shape]\nspacing = \"7 um\"\n[run.numerics]\nintegrator = \"quasi-static\"\n\
             [run.stimulus]\nbeats = 6\ncycle_length = \"600 ms\"\n\
             [parameters]\ncycle_length = {{ distribution = \"uniform\", low = \"300 ms\", high = \"600 ms\" }}\n\
             [sampling]\nsampler = \"grid\"\nlevels = 2\n"
        )
    };
    let [cells, beats] = ["cell", "beat"].map(|kind| rows(&study(&text(kind)), Shard::WHOLE, 1));
    let missed = "no capture: 3 of 6 stimuli raised no action potential: numbers 2, 4 and 6";
    for rows in [&cells, &beats] {
        assert_eq!(rows[0].reason, missed);
        assert_eq!(rows[1].reason, "");
        // All beats that count are alike: the mean is near the duration at 600 ms.
        let [fast, slow] = [&rows[0], &rows[1]].map(|row| row.metrics[0].unwrap());
        assert!((fast / slow - 1.0).abs() < 0.1, "{fast} {slow}");
    }
    for (cell, beat) in cells.iter().zip(&beats) {
        for (cell, beat) in cell.metrics.iter().zip(&beat.metrics) {
            // Adaptive steps and fixed ones.
            assert!((cell.unwrap() / beat.unwrap() - 1.0).abs() < 5e-3, "{cell:?} {beat:?}");
        }
    }
}

#[test]
fn an_extra_stimulus_has_the_same_numbers_with_a_mesh_and_without_and_a_missed_one_says_so() {
    let text = |kind: &str| {
        format!(
            "kind = \"{kind}\"\n\
             metrics = [\"action_potential_duration_90\", \"relative_peak_tension\", \"diastolic_interval\"]\n\
             [run.shape]\nspacing = \"7 um\"\n[run.cell]\nmodel = \"bueno_orovio_2008_endo\"\n\
             [run.stimulus]\nbeats = 2\ncycle_length = \"600 ms\"\ns2_interval = \"400 ms\"\n\
             [parameters]\ns2_interval = {{ distribution = \"uniform\", low = \"250 ms\", high = \"450 ms\" }}\n\
             [sampling]\nsampler = \"grid\"\nlevels = 2\n"
        )
    };
    let [cells, beats] = ["cell", "beat"].map(|kind| rows(&study(&text(kind)), Shard::WHOLE, 1));
    for rows in [&cells, &beats] {
        assert!(rows.iter().all(|row| row.status() == Status::Ok));
        assert!(rows[0].reason.contains("no capture") && rows[1].reason.is_empty(), "{rows:?}");
        assert_eq!(rows[0].metrics[..2], [None; 2]);
    }
    for (cell, beat) in cells[1].metrics.iter().zip(&beats[1].metrics) {
        let (cell, beat) = (cell.unwrap(), beat.unwrap());
        // Adaptive steps both, sampled alike; peaks between samples.
        assert!((cell / beat - 1.0).abs() < 1e-4, "{cell} {beat}");
    }
    let without = text("cell").replace("s2_interval = \"400 ms\"\n", "");
    let error = ParameterStudy::from_toml(&without, no_file).unwrap_err().to_string();
    assert!(error.contains("give it one in [run]: stimulus.s2_interval"), "{error}");
}

/// What may happen to a file on a disk; `at` and `to` are any numbers.
type Damage = fn(bytes: Vec<u8>, at: usize, to: usize) -> Vec<u8>;

const DAMAGES: [(&str, Damage); 8] = [
    ("truncated", |mut bytes, at, _| {
        bytes.truncate(at % bytes.len());
        bytes
    }),
    ("missing", |_, _, _| Vec::new()),
    ("zeroed", |mut bytes, at, to| {
        let (at, to) = (at % bytes.len(), to % bytes.len());
        bytes[at.min(to)..=at.max(to)].fill(0);
        bytes
    }),
    ("a bit flipped", |mut bytes, at, to| {
        let at = at % bytes.len();
        bytes[at] ^= 1 << (to % 8);
        bytes
    }),
    ("a digit changed", |mut bytes, at, to| {
        let length = bytes.len();
        let digit =
            (0..length).map(|step| (at + step) % length).find(|it| bytes[*it].is_ascii_digit());
        if let Some(digit) = digit {
            bytes[digit] = b'0' + (bytes[digit] - b'0' + 1 + (to % 9) as u8) % 10;
        }
        bytes
    }),
    ("a line missing", |bytes, at, _| {
        let mut lines: Vec<&[u8]> = bytes.split_inclusive(|byte| *byte == b'\n').collect();
        lines.remove(at % lines.len());
        lines.concat()
    }),
    ("lines swapped", |bytes, at, to| {
        let mut lines: Vec<&[u8]> = bytes.split_inclusive(|byte| *byte == b'\n').collect();
        let count = lines.len();
        lines.swap(at % count, to % count);
        lines.concat()
    }),
    ("blocks swapped", |mut bytes, at, to| {
        let (at, to) = (at % (bytes.len() / 64), to % (bytes.len() / 64));
        for byte in 0..64 {
            bytes.swap(64 * at + byte, 64 * to + byte);
        }
        bytes
    }),
];

#[test]
fn a_study_whose_files_were_damaged_gives_the_results_of_an_undisturbed_one_or_an_error() {
    let study = study(
        "kind = \"cell\"
        traces = true
        metrics = [\"peak_tension\"]
        [run.run]
        duration = \"400 ms\"
        [parameters]
        tau_si = { distribution = \"uniform\", low = 0.98, high = 1.02, relative = true }
        [sampling]
        sampler = \"latin-hypercube\"
        size = 6",
    );
    let threads = Threads::new(Some(1)).unwrap();
    let settings = study.settings(&Common::new(&study, no_file).unwrap());
    let go_on = |folder: &std::path::Path| {
        let common = Common::new(&study, no_file).unwrap();
        let journal = Journal::open(folder, &settings)?;
        let common = common.keeping_traces(folder, Shard::WHOLE)?;
        let report = run::<Vec<_>>(&study, &common, Shard::WHOLE, &journal, &threads, &())?;
        Ok::<_, crate::study::StudyError>((report, journal.damaged()))
    };
    let undisturbed = tempfile::tempdir().unwrap();
    let at = |folder: &tempfile::TempDir, name: &str| folder.path().join(name);
    let (whole, damaged) = go_on(undisturbed.path()).unwrap();
    assert_eq!((whole.resumed, damaged), (0, 0));
    let names = ["progress.jsonl", TRACES, "settings.toml", "myospring.sha256"];
    let files = names.map(|name| std::fs::read(at(&undisturbed, name)).unwrap());
    // Splitmix, so that the trials are the same each time.
    let mut seed = 7_u64;
    let mut random = || {
        seed = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (seed ^ (seed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        (mixed >> 20) as usize
    };
    let (mut anew, mut errors) = (0, 0);
    for (which, name) in names.iter().enumerate() {
        for (what, damage) in DAMAGES.iter().flat_map(|damage| [damage; 4]) {
            let folder = tempfile::tempdir().unwrap();
            for (name, bytes) in names.iter().zip(&files) {
                std::fs::write(at(&folder, name), bytes).unwrap();
            }
            let bytes = damage(files[which].clone(), random(), random());
            std::fs::write(at(&folder, name), bytes).unwrap();
            if *what == "missing" {
                std::fs::remove_file(at(&folder, name)).unwrap();
            }
            match go_on(folder.path()) {
                Ok((report, damaged)) => {
                    assert_eq!(report.rows, whole.rows, "{name}: {what}");
                    let traces = std::fs::read(at(&folder, TRACES)).unwrap();
                    assert!(traces == files[1], "{name}: {what}");
                    // Said, unless all that is wrong is that a line is not there.
                    let is_short = *name == "progress.jsonl"
                        && ["truncated", "missing", "a line missing", "zeroed"].contains(what);
                    assert!(report.resumed == 6 || damaged > 0 || is_short, "{name}: {what}");
                    anew += 6 - report.resumed;
                }
                Err(error) => {
                    assert!(!["progress.jsonl", TRACES].contains(name), "{name}: {what}: {error}");
                    errors += 1;
                }
            }
        }
    }
    assert!(anew > 60 && errors > 20, "{anew} members anew, {errors} errors");
}

#[cfg(unix)]
#[test]
fn a_journal_whose_lines_were_exchanged_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let journal: Journal<Variation> = Journal::open(folder.path(), "").unwrap();
    let members = [1, 2].map(|number| Variation::new(number, vec![number as f64]));
    let row = |member: &Variation| vec![VariationRow::done(member.number, vec![Some(0.5)])];
    journal.add(members.iter().map(|member| (member, member.key(), row(member)))).unwrap();
    assert_eq!(journal.rows(&members).unwrap().len(), 2);
    let path = folder.path().join("progress.jsonl");
    let text = std::fs::read_to_string(&path).unwrap();
    let (first, second) = text.split_at(text.len() / 2);
    std::fs::write(&path, format!("{second}{first}")).unwrap();
    let error = journal.rows(&members).unwrap_err().to_string();
    assert!(error.contains("the line of `1` is no longer where it was written"), "{error}");
}
