//! Studies of cells side by side.

use super::{StopAfter, threads};
use myospring::cell::adaptive::{self, beats};
use myospring::cell::batch::CellBeat;
use myospring::cell::bueno_orovio_2008::{self, Variant};
use myospring::cell::minimal::MinimalModel;
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::{CellMethod, SolverSettings};
use myospring::cell::{CellModel, coelho_2021};
use myospring::study::cells::{self, BeatRow, PacedCell};
use myospring::study::{Journal, Member, Row, Status, StudyError};
use std::any::Any;
use std::sync::Arc;

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
