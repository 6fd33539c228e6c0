//! The figures of a run.

use super::finished::Finished;
use crate::analysis::bands::{Band, band};
use crate::experiment::overlay::{self, Lattice};
use crate::experiment::{Draw, ExperimentError, Folder};
use crate::output::figure::{self, ContractionOptions, FigureError};

/// Writes the figures of a run.
pub(in crate::experiment) fn write(
    folder: &Folder,
    finished: &Finished<'_>,
) -> Result<(), ExperimentError> {
    let Finished {
        name,
        run,
        simulation,
        fibres,
        picture,
        outcome,
        numbers,
        stimuli,
        observer,
        ..
    } = finished;
    let recording = &outcome.recording;
    let mesh = &simulation.mesh;
    let cell = finished.cell();
    let cell = || cell.as_ref().map_err(Clone::clone);
    let reference = band("peak_shortening")
        .map(|Band { low, high, .. }| ([*low, *high], "adult ventricular myocytes, unloaded"));
    let held = simulation.support.holds_both_ends();
    let options = ContractionOptions {
        stimulus_times_ms: stimuli.to_vec(),
        reference_band: reference.filter(|_| !held),
    };
    let label = run.strength();
    let overlay = || {
        let (cells, cell) = picture.as_ref().ok_or(FigureError::Nothing { what: "pictures" })?;
        let lattice = Some(Lattice { mesh, fibres });
        overlay::draw(name, cells, &[cell], lattice, &numbers.summary.warnings)
    };
    let figures: [(&str, Draw<'_>); 7] = [
        ("overlay", &overlay),
        ("overview", &|| figure::overview(cell()?, recording, stimuli)),
        ("cell", &|| figure::cell_shapes(cell()?, &figure::key_shapes(recording, stimuli))),
        ("mesh", &|| figure::mesh(mesh)),
        ("action_potential_and_tension", &|| {
            figure::action_potential_and_tension(recording, stimuli)
        }),
        ("contraction", &|| figure::contraction(&[(&label, recording)], &options)),
        ("work_loop", &|| figure::work_loop(recording, stimuli)),
    ];
    // Only of a picture, and only of a cell whose ends are held.
    let from = usize::from(picture.is_none());
    let to = figures.len() - usize::from(!held);
    folder.figures(finished.style.theme, &figures[from..to], *observer)
}
