//! The figures of a run.

use super::activation;
use super::finished::Finished;
use crate::analysis::bands::{Band, band};
use crate::experiment::overlay::{self, Lattice};
use crate::experiment::{Draw, ExperimentError, Folder};
use crate::microscopy::stack::StackFibres;
use crate::output::field::Fields;
use crate::output::figure::{self, ContractionOptions, DrawnThickCell, FigureError};
use std::sync::OnceLock;

/// The figure of the mesh at rest, which needs no beat.
const MESH: &str = "mesh";

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
        mesh_figure,
        ..
    } = finished;
    let recording = &outcome.recording;
    let mesh = &simulation.mesh;
    // Made by the first figure that needs it, so that the others begin at once. `Finished::cell` must not use rayon: its thread could
    // take up another figure meanwhile, which would wait here for ever.
    let cell = OnceLock::new();
    let cell = || cell.get_or_init(|| finished.cell()).as_ref().map_err(Clone::clone);
    let reference = band("peak_shortening")
        .map(|Band { low, high, .. }| ([*low, *high], "adult ventricular myocytes, unloaded"));
    let held = simulation.support.holds_both_ends();
    let on_gel = recording.frames.iter().any(|frame| frame.on_gel_nn.is_some());
    let options = ContractionOptions {
        stimulus_times_ms: stimuli.to_vec(),
        reference_band: reference.filter(|_| !held && !on_gel && recording.wave.is_none()),
    };
    let label = run.strength();
    let overlay = || {
        let (cells, cell) = picture.as_ref().ok_or(FigureError::Nothing { what: "pictures" })?;
        let lattice = Some(Lattice { mesh, fibres });
        let middle = fibres.slices.as_ref().and_then(StackFibres::middle);
        let of_slice = middle.map(|(height, _)| {
            format!("the picture shows the brightest value of all slices at each place; the fibres are those of the slice at {height:.1} um")
        });
        let notes: Vec<String> =
            of_slice.into_iter().chain(numbers.summary.warnings.iter().cloned()).collect();
        overlay::draw(name, cells, &[cell], lattice, &notes)
    };
    let in_space = || {
        let (thick, cell) = simulation
            .thick
            .as_ref()
            .zip(simulation.in_space())
            .ok_or(FigureError::Nothing { what: "thick cells" })?;
        let content = cell.myofibril_content.as_deref();
        let fields = Fields::new(&thick.mesh, &cell.fibres, content)?;
        let drawn = DrawnThickCell::new(fields, simulation.long_axis)?
            .coloured_by(finished.colour().in_space());
        figure::thick_cell(&drawn, &figure::key_shapes_in_space(recording, stimuli))
    };
    let all: [(bool, (&str, Draw<'_>)); 10] = [
        (picture.is_some(), ("overlay", &overlay)),
        (true, ("overview", &|| figure::overview(cell()?, recording, stimuli))),
        (true, ("cell", &|| figure::cell_shapes(cell()?, &figure::key_shapes(recording, stimuli)))),
        (simulation.thick.is_some(), ("in_space", &in_space)),
        (mesh_figure.is_none(), (MESH, &|| figure::mesh(mesh))),
        (
            true,
            ("action_potential_and_tension", &|| {
                figure::action_potential_and_tension(recording, stimuli)
            }),
        ),
        (true, ("contraction", &|| figure::contraction(&[(&label, recording)], &options))),
        (recording.wave.is_some(), ("activation", &|| activation::draw(finished))),
        (held, ("work_loop", &|| figure::work_loop(recording, stimuli))),
        (on_gel, ("traction", &|| figure::traction(cell()?, recording, stimuli))),
    ];
    let figures: Vec<(&str, Draw<'_>)> =
        all.into_iter().filter(|(applies, _)| *applies).map(|(_, figure)| figure).collect();
    let drawn = mesh_figure.map(|files| folder.figure(MESH, files.as_ref(), *observer));
    folder.figures(finished.style.theme, &figures, *observer).and(drawn.unwrap_or(Ok(())))
}
