//! The files of fits.

use super::calcium;
use super::cell::{Candidate, FittedCell};
use super::outcome::{Fits, Shared, Work};
use super::page;
use super::shapes::{self, Shapes};
use super::simulation::simulation;
use super::tables;
use crate::experiment::analyse::csv;
use crate::experiment::analyse::figures::loops;
use crate::experiment::run::{FILE, resolved};
use crate::experiment::tension_map::{self, FilmMap};
use crate::experiment::{ExperimentError, Folder, Inputs, Observer};
use crate::fit::{Fit, RecordedCourse, TENSION_FILE};
use crate::integrate::quasi_static::Tolerance;
use crate::output::figure::{self, Theme};
use crate::output::json;
use crate::settings::Run;
use serde::Serialize;

/// fit.json.
#[derive(Serialize)]
pub(super) struct Record<'a> {
    program: &'static str,
    version: &'static str,
    /// The curve.
    cell: &'a str,
    /// Whose shape it has.
    shape: &'a str,
    #[serde(flatten)]
    fit: Option<&'a Fit>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
    /// For a film: the measured and the fitted cell at their peak.
    #[serde(skip_serializing_if = "Option::is_none")]
    shapes: Option<shapes::Record<'a>>,
    /// For a film: where the cell pulls.
    #[serde(skip_serializing_if = "Option::is_none")]
    tension_map: Option<tension_map::TensionMapRecord<'a>>,
    notes: &'a [String],
}

pub(super) fn records<'a>(fits: &'a Fits) -> Vec<Record<'a>> {
    let record = |cell: &'a FittedCell| Record {
        program: "myospring",
        version: env!("CARGO_PKG_VERSION"),
        cell: &cell.name,
        shape: &fits.name,
        fit: cell.found.as_ref().ok(),
        reason: cell.found.as_ref().err().map(ToString::to_string),
        shapes: fits.shapes.as_ref().map(Shapes::record),
        tension_map: fits.map.as_ref().map(FilmMap::record),
        notes: &fits.notes,
    };
    fits.cells.iter().map(record).collect()
}

/// Writes the files of all cells.
pub(super) fn write(
    folder: &Folder,
    fits: &Fits,
    work: &Work,
    run: &Run,
    observer: &dyn Observer,
) -> Result<(), ExperimentError> {
    let first = work.cell.first().fitter.simulation();
    let path = first.shared_path(Tolerance::default()).ok().map(|path| (path, &first.material));
    let mut inputs = Inputs::default();
    inputs.keep(folder, run.to_run_file(), |file| work.files.bytes(file))?;
    let shared = Shared { fits, work, run, inputs, path };
    for (number, record) in records(fits).iter().enumerate() {
        if let Ok(fit) = &fits.cells[number].found {
            shared.write(folder, number, fit, record, observer)?;
        }
    }
    if let Some(shapes) = &fits.shapes {
        shapes.write(folder, observer)?;
    }
    if let Some(map) = &fits.map {
        map.write(folder, observer)?;
    }
    if fits.cells.len() > 1 {
        folder.write("fits.csv", tables::cells(&fits.cells).to_csv()?)?;
    }
    Ok(())
}

impl Shared<'_> {
    /// Writes the files of one cell; each of several cells has its own folder.
    fn write(
        &self,
        folder: &Folder,
        number: usize,
        fit: &Fit,
        record: &Record<'_>,
        observer: &dyn Observer,
    ) -> Result<(), ExperimentError> {
        let Self { fits, work, inputs, path, .. } = self;
        let several = fits.cells.len() > 1;
        let within = if several { format!("cells/{}/", number + 1) } else { String::new() };
        let up = if several { "../../" } else { "" };
        folder.write(&format!("{within}fit.json"), json::pretty(record)?)?;
        folder.write(&format!("{within}curve.csv"), tables::curves(fit).to_csv()?)?;
        if !fit.tried.is_empty() {
            folder.write(&format!("{within}models.csv"), tables::tried(fit).to_csv()?)?;
        }
        if let Some(own) = &fit.own_tension {
            folder.write(&format!("{within}{TENSION_FILE}"), tables::tension(own).to_csv()?)?;
            if let Some(beat) = &own.mean_beat {
                folder
                    .write(&format!("{within}mean_beat.csv"), tables::mean_beat(beat).to_csv()?)?;
            }
        }
        if let Some(calcium) = fit.calcium.as_ref().filter(|calcium| calcium.drives) {
            let table = tables::calcium(calcium);
            folder.write(&format!("{within}{}", RecordedCourse::FILE), table.to_csv()?)?;
        }
        let together = calcium::with_tension(fit);
        if let Some((curves, pair)) = &together {
            let pair = std::slice::from_ref(pair);
            folder.write(&format!("{within}pairs.csv"), csv::pairs(curves, pair)?)?;
            folder.write(&format!("{within}loops.csv"), csv::loops(curves, pair)?)?;
        }
        let Candidate { run, fitter, .. } = work.cell.of(fit);
        let run = Run { shape: self.run.shape.clone(), ..run.clone() };
        let run = fitter.fitted(run, fit)?;
        let simulation = simulation(fitter.simulation(), &run)?;
        let run_file = resolved(&run, (inputs, up), &simulation, work.cell.spacing_um(), None);
        folder.write(&format!("{within}run.toml"), &run_file)?;
        if observer.is_late() {
            return Ok(());
        }
        let draw = || figure::fit(&tables::drawn(fit), &tables::profiles(fit));
        let figure = if several { format!("fit_{}", number + 1) } else { "fit".to_owned() };
        folder.figures(Theme::Light, &[(&figure, &draw)], observer)?;
        if let Some(drawn) = tables::drawn_tension(fit) {
            let figure = figure.replacen("fit", "tension", 1);
            folder.figures(Theme::Light, &[(&figure, &|| figure::tension(&drawn))], observer)?;
        }
        if let Some((curves, pair)) = &together {
            let figure = figure.replacen("fit", "loop", 1);
            let draw = || loops(curves, pair);
            folder.figures(Theme::Light, &[(&figure, &draw)], observer)?;
        }
        // One path of equilibria serves all cells of the same material; that of a fitted stiffness is another.
        let path = path.as_ref().filter(|(_, material)| **material == simulation.material);
        let ready = path.and_then(|(path, _)| path.prepare(&simulation).ok());
        let beaten = match ready {
            Some(ready) => Ok(ready.run(|_progress| true)),
            None => simulation.build().map(|ready| ready.run(|_progress| true)),
        };
        let name = &fits.cells[number].name;
        match beaten {
            Ok(outcome) => {
                let page = page::html(name, fit, self, &run, &run_file, (&simulation, &outcome))?;
                folder.write(&format!("{within}{FILE}"), page)?;
            }
            Err(error) => observer.warn(&format!("{name}: {FILE} was not written: {error}")),
        }
        Ok(())
    }
}
