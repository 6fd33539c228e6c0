//! The tractions of a cell on its gel, and what they do to the gel around it, as tables and arrays.

use super::finished::Finished;
use crate::experiment::{ExperimentError, Folder};
use crate::mechanics::compliance::Compliance;
use crate::mechanics::gel::{Gel, GelBed, Surface};
use crate::mechanics::support::SupportKind;
use crate::output::json;
use crate::output::npz::{self, Array};
use crate::output::table::{Column, Table};
use crate::recording::Frame;
use serde::Serialize;

/// How far around the cell the gel is shown, as a part of the cell's extent.
const AROUND: f64 = 0.5;

/// What the arrays are of.
#[derive(Serialize)]
struct About {
    t_ms: f64,
    pixel_size_um: f64,
    /// Place of the pixel in the lower left corner, um.
    first_pixel_um: [f64; 2],
    gel: Gel,
    /// Where a file says which nodes adhere, within those that the gel names.
    #[serde(skip_serializing_if = "Option::is_none")]
    adhesion_of_nodes: Option<&'static str>,
    u: &'static str,
    v: &'static str,
}

/// Writes `gel/` of a cell on a gel, at the frame of its largest force; nothing of any other.
pub(super) fn write(folder: &Folder, finished: &Finished<'_>) -> Result<(), ExperimentError> {
    let Finished { simulation, outcome, .. } = finished;
    let SupportKind::Gel(gel) = simulation.support else { return Ok(()) };
    let size = |frame: &Frame| -> f64 {
        let forces = frame.on_gel_nn.iter();
        forces.flat_map(|[x, y]| x.iter().zip(y)).map(|(x, y)| x.hypot(*y)).sum()
    };
    let frames = outcome.recording.frames.iter().filter(|frame| size(frame).is_finite());
    let frame = frames.max_by(|a, b| size(a).total_cmp(&size(b)));
    let Some((frame, forces)) = frame.and_then(|frame| Some((frame, frame.on_gel_nn.as_ref()?)))
    else {
        return Ok(());
    };
    let mesh = &simulation.mesh;
    let moved = |axis: usize| {
        let both = frame.positions[axis].iter().zip(&mesh.points[axis]);
        both.map(|(now, rest)| now - rest).collect()
    };
    // 1 nN/um^2 is 1000 Pa.
    let traction = |axis: usize| {
        let both = forces[axis].iter().zip(&mesh.areas);
        both.map(|(force, area)| 1000.0 * force / area).collect()
    };
    // Of a thick cell, which also presses on the gel and lifts it: the sum over each column of its points.
    let in_space = outcome.recording.in_space.iter().find(|shape| shape.t_ms == frame.t_ms);
    let upward = simulation.thick.as_ref().zip(in_space).and_then(|(thick, shape)| {
        let [_, _, up] = shape.on_gel_nn.as_ref()?;
        let sum = |column: &Vec<u32>| column.iter().map(|&node| up[node as usize]).sum::<f64>();
        let both = thick.columns.iter().map(sum).zip(&mesh.areas);
        Some(("traction_z_Pa", both.map(|(force, area)| 1000.0 * force / area).collect()))
    });
    let column = |(name, values): (&str, Vec<f64>)| Column::Number {
        name: name.to_owned(),
        values: values.into_iter().map(Some).collect(),
    };
    let columns = [
        ("x_um", mesh.points[0].clone()),
        ("y_um", mesh.points[1].clone()),
        ("u_um", moved(0)),
        ("v_um", moved(1)),
        ("traction_x_Pa", traction(0)),
        ("traction_y_Pa", traction(1)),
        ("area_um2", mesh.areas.clone()),
    ];
    let adhesion = simulation.adhesion.clone().map(|values| ("adhesion", values));
    let table =
        Table { columns: columns.into_iter().chain(upward).chain(adhesion).map(column).collect() };
    folder.write("gel/tractions.csv", table.for_people().to_csv()?)?;

    let bed = GelBed::adhering(gel, mesh, simulation.long_axis, simulation.adhesion.as_deref())
        .map_err(ExperimentError::new)?;
    let attached = |axis: usize| bed.nodes().iter().map(|&node| forces[axis][node]).collect();
    let surface = bed.surface(&[attached(0), attached(1)], AROUND);
    let Surface { spacing, origin, shape: [columns, rows], displacements: [u, v] } = surface;
    // As pictures lie: the top row first, down is positive, and the pixel is the unit of length.
    let picture = |values: &[f64], unit: f64| {
        let lines = values.chunks_exact(columns).rev();
        let values = lines.flatten().map(|value| value / unit).collect::<Vec<f64>>();
        npz::to_npy(&Array::floats([rows, columns], values))
    };
    folder.write("gel/u.npy", picture(&u, spacing))?;
    folder.write("gel/v.npy", picture(&v, -spacing))?;
    let about = About {
        t_ms: frame.t_ms,
        pixel_size_um: spacing,
        first_pixel_um: origin,
        gel,
        adhesion_of_nodes: simulation
            .adhesion
            .as_ref()
            .map(|_| "column `adhesion` of tractions.csv"),
        u: "displacement of the gel to the right, pixels; rows from the top",
        v: "displacement of the gel downward, pixels; rows from the top",
    };
    folder.write("gel/gel.json", json::pretty(&about)?)
}
