//! A thick cell that turns: its surface, reduced to the accuracy that is visible.

use super::cell::UNSEEN;
use super::error::PageError;
use super::fields::{self, FieldData};
use super::frames::{self, Candidate, Fitted, packed};
use crate::digits::rounded;
use crate::field::{Field, Fields};
use crate::figure::{FigureError, check_frame, check_mesh};
use crate::surface::{SmoothSurface, extents, unit};
use myospring_core::mesh::Mesh;
use myospring_core::recording::Frame;
use serde::Serialize;

/// Bytes of the frames of all thick cells of a page together, before base64 makes them a third larger.
const BUDGET: usize = 1_000_000;
/// Nodes of a surface that is drawn with all of them; those of larger ones are drawn in groups.
const FINE: usize = 2500;

/// A thick cell on a page, which shows it in space.
#[derive(Debug, Clone, Copy)]
pub struct ThickCell<'a> {
    /// Its mesh at rest; its surface is that of its lattice.
    pub mesh: &'a Mesh<3, 4>,
    /// Its shapes; their times may differ from those of the cell seen from above.
    pub frames: &'a [Frame<3>],
    /// Vector along the fibre in each tetrahedron, of any length.
    pub fibres: &'a [[f64; 3]],
    /// Content of myofibrils of each tetrahedron; `None` is 1 everywhere.
    pub myofibril_content: Option<&'a [f64]>,
    /// Direction of the long axis seen from above, of any length.
    pub long_axis: [f64; 2],
}

#[derive(Debug, Serialize)]
pub(super) struct ThickData {
    rest_um: String,
    corners: String,
    long_axis: f64,
    frames: ThickFrames,
    spacing_um: f64,
    accuracy_um: f64,
    fields: Vec<ThickField>,
}

#[derive(Debug, Serialize)]
struct ThickFrames {
    t_ms: Vec<f64>,
    displacement: String,
    step_um: f64,
    size_um: Vec<[f64; 3]>,
}

#[derive(Debug, Serialize)]
struct ThickField {
    #[serde(flatten)]
    field: FieldData,
    values: String,
}

/// A thick cell on a page of `share` cells.
pub(super) fn of(
    cell: &ThickCell<'_>,
    has_tension: bool,
    share: usize,
) -> Result<ThickData, PageError> {
    let mesh = cell.mesh;
    check_mesh(mesh)?;
    let fields = Fields::new(mesh, cell.fibres, cell.myofibril_content)?;
    let at_rest = Frame {
        t_ms: 0.0,
        ta_kpa: 0.0,
        ta_by_triangle_kpa: None,
        on_gel_nn: None,
        positions: mesh.points.clone(),
    };
    // The last frames of a run that failed may be invalid.
    let is_finite = |frame: &&Frame<3>| frame.positions.iter().flatten().all(|x| x.is_finite());
    let mut all: Vec<&Frame<3>> = cell.frames.iter().filter(is_finite).collect();
    if all.is_empty() {
        all.push(&at_rest);
    }
    for frame in &all {
        check_frame(mesh, frame)?;
    }
    let known: Vec<Field> =
        Field::THICK.into_iter().filter(|field| field.is_known(&all, has_tension)).collect();
    let small = small(cell, &all, known.len(), BUDGET / share)?;
    let (displacement, step) = frames::quantised(&small);
    let Fitted { drawn: surface, kept, tolerance, .. } = small;
    let shown = || kept.iter().map(|&at| all[at]);
    let field = |field| {
        let values: Vec<Vec<f64>> =
            shown().map(|frame| surface.means(&fields.on_nodes(field, frame))).collect();
        let field = fields::data(field, values.iter().cloned());
        let part = |value: &f64| (value - field.low) / (field.high - field.low);
        let bytes = values.iter().flatten().map(|value| [(255.0 * part(value)).round() as u8]);
        ThickField { values: packed(bytes), field }
    };
    let [x, y] = unit(cell.long_axis);
    let rest = surface.positions(&mesh.points);
    Ok(ThickData {
        rest_um: packed(rest.iter().flatten().map(|&x| (x as f32).to_le_bytes())),
        corners: packed(surface.quads().iter().flatten().map(|corner| corner.to_le_bytes())),
        long_axis: rounded(y.atan2(x)),
        frames: ThickFrames {
            t_ms: shown().map(|frame| rounded(frame.t_ms)).collect(),
            displacement,
            step_um: step,
            size_um: shown()
                .map(|frame| extents(&frame.positions, cell.long_axis).map(rounded))
                .collect(),
        },
        spacing_um: rounded(surface.spacing()),
        accuracy_um: rounded(tolerance + step),
        fields: known.into_iter().map(field).collect(),
    })
}

/// A surface and frames that fit into some bytes.
fn small(
    cell: &ThickCell<'_>,
    all: &[&Frame<3>],
    fields: usize,
    budget: usize,
) -> Result<Fitted<SmoothSurface>, FigureError> {
    let finest = SmoothSurface::new(cell.mesh).ok_or(FigureError::NoCubes)?;
    let times: Vec<f64> = all.iter().map(|frame| frame.t_ms).collect();
    let size = extents(&cell.mesh.points, cell.long_axis);
    let tolerance = UNSEEN * size.into_iter().fold(0.0, f64::max);
    let coarser = (finest.len() as f64 / FINE as f64).sqrt().ceil().max(1.0) as u32;
    let candidate = |coarser| {
        let surface = finest.coarser(coarser);
        let rest = surface.positions(&cell.mesh.points);
        let moved = |frame: &&Frame<3>| {
            let now = surface.positions(&frame.positions);
            let pairs = now.iter().flatten().zip(rest.iter().flatten());
            pairs.map(|(now, rest)| (now - rest) as f32).collect()
        };
        let displacements = all.iter().map(moved).collect();
        let bytes = (6 + fields) * rest.len();
        Candidate { points: rest.len(), bytes, displacements, drawn: surface }
    };
    Ok(frames::fitted(&times, coarser, tolerance, budget, candidate))
}
