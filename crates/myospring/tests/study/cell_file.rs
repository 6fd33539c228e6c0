//! A cell model from a file stands wherever a model's name does: in run files, studies and batches, with its constants as
//! parameters and myofilaments on its calcium.

#[path = "../common/mod.rs"]
mod common;

use myospring::analysis::beats::Beats;
use myospring::cell::pacing::Stimulus;
use myospring::run_file::{PRESETS, RunFile};
use myospring::settings::{FromFile, Models, Run};
use myospring::study::parameters::{Answer, Common, ParameterStudy, Shard, run};
use myospring::study::{Journal, Threads};
use std::collections::BTreeMap;
use std::sync::Arc;

const FILE: &str = "tests/study/aliev_panfilov.mmt";
/// Calcium that only the user knows: its name is no usual one.
const CALCIUM: &str = "variables = \"calcium=calcium.level\"";

fn none(_: &str) -> std::io::Result<Vec<u8>> {
    Err(std::io::ErrorKind::NotFound.into())
}

fn file(cell: &str, rest: &str) -> Result<Run, String> {
    let text = format!(
        "[cell]\nmodel = \"{FILE}\"\n{cell}\n[shape]\nspacing = \"6 um\"\n\
         [numerics]\nintegrator = \"quasi-static\"\n{rest}"
    );
    let resolved = RunFile::from_text(&text).and_then(|file| file.resolve());
    resolved.map_err(|error| error.to_string())
}

fn beaten(run: &Run) -> Beats {
    let shaped = run.shape.mesh(&run.shape.bytes(none).unwrap()).unwrap();
    let outcome = run.make(shaped, none).unwrap().simulation.build().unwrap().run(|_| true);
    assert_eq!(outcome.stop, None);
    outcome.beats()
}

#[test]
fn its_calcium_is_named_by_the_user_and_drives_the_myofilaments_of_a_cell_that_beats() {
    // Without calcium it is a membrane alone.
    let membrane = file("", "").unwrap();
    assert!(membrane.cell.filaments().is_none() && membrane.assumed.is_empty());
    let run = file(CALCIUM, "").unwrap();
    assert!(run.assumed.join("").contains("the calcium of aliev_panfilov"), "{:?}", run.assumed);
    let beats = beaten(&run);
    assert!(beats[0].value("peak_shortening").unwrap() > 1.0);
    assert!(beats[0].value("action_potential_duration_90").unwrap() > 100.0);
    let weak = format!("{CALCIUM}\n[cell.parameters]\nT_ref = \"60 kPa\"\nmembrane_k = 8.5");
    let weak = file(&weak, "").unwrap();
    assert_eq!(weak.cell.parameters().get("membrane_k"), Some(8.5));
    assert!(beaten(&weak)[0].value("peak_tension") < beats[0].value("peak_tension"));
    // What repeats a run names the same file, variables and values.
    let again = weak.to_run_file();
    let again = RunFile::from_text(&again.to_toml()).unwrap().resolve().unwrap();
    assert_eq!(again.cell.parameters(), weak.cell.parameters());
    assert_eq!((again.from_file, again.protocol), (weak.from_file, weak.protocol));
}

#[test]
fn its_stimulus_is_a_current_in_the_unit_of_the_file() {
    let run = file("", "[stimulus]\namplitude = \"30 A/F\"\nduration = \"1.5 ms\"").unwrap();
    let pulse = Stimulus::Pulse { amplitude: 30.0, duration_ms: 1.5 };
    assert_eq!(run.protocol.stimulus, pulse);
    let again = RunFile::from_text(&run.to_run_file().to_toml()).unwrap().resolve().unwrap();
    assert_eq!(again.protocol.stimulus, pulse);
    let wrong = file("", "[stimulus]\namplitude = \"0.5 1/ms\"").err().unwrap();
    assert!(wrong.contains("`stimulus.amplitude`") && wrong.contains("A/F"), "{wrong}");
    // A model whose potential has no unit takes a rate.
    let listed = RunFile::from_text("[stimulus]\nkind = \"pulse\"\namplitude = \"30 A/F\"");
    assert!(listed.unwrap().resolve().is_err());
}

#[test]
fn what_cannot_be_is_refused_with_the_file_and_how_to_mend_it() {
    let absent = RunFile::from_text("[cell]\nmodel = \"absent.mmt\"").unwrap().resolve();
    let absent = absent.err().unwrap().to_string();
    assert!(absent.contains("absent.mmt: cannot be opened"), "{absent}");
    for (cell, words) in [
        ("myofilaments = \"land_2017\"", "calcium=component.variable"),
        ("variables = \"calcium=membrane.Cai\"", "no variable is named `membrane.Cai`"),
        ("variables = \"sodium=membrane.V\"", "has an unknown role"),
        ("variables = \"membrane.V\"", "names no role"),
        ("parameters = { membrane_kk = 8 }", "did you mean `membrane_k`"),
    ] {
        let refused = file(cell, "").err().unwrap();
        assert!(refused.contains(words), "{refused}");
    }
    for key in ["variables = \"calcium=a.b\"", "myofilaments = \"none\""] {
        let text = format!("[cell]\nmodel = \"land_2017\"\n{key}");
        let refused = RunFile::from_text(&text).unwrap().resolve().err().unwrap().to_string();
        assert!(refused.contains("only the model of a file has it"), "{refused}");
    }
}

#[test]
fn a_file_that_is_held_needs_no_disk_and_is_read_once() {
    let bytes = std::fs::read(FILE).unwrap();
    let held = BTreeMap::from([("dropped.mmt".to_owned(), bytes)]);
    let models = Models::default().holding(Arc::new(held));
    let how = FromFile::default();
    let first = models.model("dropped.mmt", &how).unwrap();
    assert_eq!(first.parameters().get("membrane_k"), Some(8.0));
    assert!(Arc::ptr_eq(&first, &models.clone().model("dropped.mmt", &how).unwrap()));
}

#[test]
fn names_are_relative_to_the_folder_of_a_description_and_come_back_as_written() {
    let models = Models::default().beside("tests/study".as_ref());
    let model = models.model("aliev_panfilov.mmt", &FromFile::default()).unwrap();
    assert_eq!(Models::name_of(&*model), "aliev_panfilov.mmt");
    assert!(Models::default().model("aliev_panfilov.mmt", &FromFile::default()).is_err());
}

#[test]
fn studies_vary_its_constants_and_find_how_much_each_counts() {
    for kind in ["cell", "beat"] {
        let text = format!(
            "kind = \"{kind}\"\nmetrics = [\"peak_tension\", \"action_potential_duration_90\"]\n\
             [run.cell]\nmodel = \"{FILE}\"\n{CALCIUM}\n[run.shape]\nspacing = \"6 um\"\n\
             [parameters]\n\
             membrane_k = {{ distribution = \"uniform\", low = 0.95, high = 1.05, relative = true }}\n\
             T_ref = {{ distribution = \"uniform\", low = 0.5, high = 2.0, relative = true }}\n\
             [sampling]\nsampler = \"saltelli\"\nsize = 8\n"
        );
        let study = ParameterStudy::from_toml(&text, none).unwrap();
        let common = Common::new(&study, none).unwrap();
        let (whole, journal) = (Shard::WHOLE, Journal::in_memory());
        let threads = Threads::new(None).unwrap();
        let rows = run(&study, &common, whole, &journal, &threads, &()).unwrap().rows;
        let answer = Answer::new(&study, &common.units, rows);
        let mut seen = BTreeMap::new();
        for row in answer.rows().iter() {
            let values = &study.members(whole)[row.member - 1].values;
            // The membrane does not know of the myofilaments; parameters are in alphabetical order.
            let apd = row.metric(1).unwrap();
            assert_eq!(*seen.entry(values[1].to_bits()).or_insert(apd), apd, "{kind}");
        }
        assert!(seen.len() > 8, "{kind}: {}", seen.len());
    }
}

#[test]
#[ignore = "slow"]
fn a_cell_from_stem_cells_with_its_own_action_potential_pulls_at_gels_as_measured() {
    if common::left_to_full() {
        return;
    }
    let Some(model) = common::shared_data("cell-models/mmt/paci-2020.mmt") else { return };
    let preset = PRESETS.iter().find(|preset| preset.name == "hipsc-paci-2020").unwrap();
    let force = |gel: &str| {
        let mut file = RunFile::from_text(preset.text).unwrap();
        file.set("cell.model", model.to_str().unwrap()).unwrap();
        file.set("mechanics.gel_modulus", gel).unwrap();
        let run = file.resolve().unwrap();
        let shaped = run.shape.mesh(&run.shape.bytes(none).unwrap()).unwrap();
        let made = run.make(shaped, none).unwrap();
        let outcome = made.simulation.build().unwrap().run(|_| true);
        assert!(outcome.stop.is_none(), "{:?}", outcome.stop);
        let beats = outcome.beats();
        (beats[0].value("peak_axial_force").unwrap(), beats)
    };
    // CONTRAX 2024, Table 1, with 95 % intervals: 13.9 [12.4, 15.5] and 23.3 [19.5, 27.9] nN; the first was fitted.
    let (stiff, beats) = force("35 kPa");
    assert!((19.5..=27.9).contains(&stiff), "{stiff} nN");
    let apd = beats[0].value("action_potential_duration_90").unwrap();
    assert!((480.0..490.0).contains(&apd), "{apd} ms");
    let (soft, _) = force("10 kPa");
    assert!((13.8..=14.0).contains(&soft), "{soft} nN");
}
