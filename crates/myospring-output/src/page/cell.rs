//! The beating cell, reduced to the accuracy that is visible.

use super::chart::Chart;
use super::display::Display;
use super::error::PageError;
use super::fields::{self, FieldData};
use super::frames::{self, Candidate, Fitted, UNSEEN, packed};
use super::photograph::{self, Photograph, PictureData};
use super::thick::{self, ThickCell, ThickData};
use crate::digits::rounded;
use crate::field::{Field, Fields};
use crate::figure::{check_frame, check_mesh};
use myospring_core::mesh::Mesh;
use myospring_core::mesh::outline::Outline;
use myospring_core::recording::Frame;
use serde::Serialize;

/// Bytes of the frames of all runs of a page together, before base64 makes them a third larger.
const BUDGET: usize = 1_400_000;
/// Masses of a lattice that is drawn square by square; of larger ones several squares are drawn as one.
const FINE: usize = 4000;

/// Cells that beat, with the curves that go with them.
#[derive(Debug, Clone)]
pub struct BeatingCells<'a> {
    /// Default colouring of the cells.
    pub colour: Field,
    /// One cell, or several that are compared with the first.
    pub cells: Vec<MovingCell<'a>>,
    /// Charts shown with the cells.
    pub charts: Vec<Chart>,
    /// Further charts, which unfold, with their title: `12 more curves of the cell model`.
    pub folded: (String, Vec<Chart>),
    /// A sentence about the cells, or an empty text.
    pub words: String,
}

/// A cell that moves: simulated, or tracked in a film.
#[derive(Debug, Clone)]
pub struct MovingCell<'a> {
    /// Its name among others: `50 kPa`.
    pub label: &'a str,
    /// Its mesh at rest.
    pub mesh: &'a Mesh,
    /// Its shapes; at least those are shown that the eye can distinguish.
    pub frames: &'a [Frame],
    /// Unit vector along the fibre in each triangle.
    pub fibres: &'a [[f64; 2]],
    /// Content of myofibrils of each triangle; `None` is 1 everywhere.
    pub myofibril_content: Option<&'a [f64]>,
    /// Whether the frames have an active tension.
    pub has_tension: bool,
    /// The outline that was meshed, um.
    pub outline: &'a Outline,
    /// The picture that the cell was found in.
    pub picture: Option<Photograph<'a>>,
    /// When it contracts most, ms: the shape that is printed.
    pub peak_ms: f64,
    /// The same cell in space, if it is thick.
    pub thick: Option<ThickCell<'a>>,
}

#[derive(Debug, Serialize)]
pub(super) struct CellData<'a> {
    label: &'a str,
    peak_ms: f64,
    picture: Option<PictureData>,
    rest_um: String,
    corners: String,
    within: usize,
    fibre: String,
    rings: Vec<usize>,
    frames: Frames,
    spacing_um: f64,
    accuracy_um: f64,
    fields: Vec<FieldData>,
    thick: Option<ThickData>,
}

#[derive(Debug, Serialize)]
struct Frames {
    t_ms: Vec<f64>,
    displacement: String,
    step_um: f64,
    ta_kpa: Vec<f64>,
    stress: Option<String>,
    stress_step_kpa: f64,
    traction: Option<String>,
    traction_step_pa: f64,
    potential: Option<String>,
    potential_step_mv: f64,
}

/// A cell on a page of `share` cells.
pub(super) fn of<'a>(cell: &MovingCell<'a>, share: usize) -> Result<CellData<'a>, PageError> {
    check_mesh(cell.mesh)?;
    let fields = Fields::new(cell.mesh, cell.fibres, cell.myofibril_content)?;
    let at_rest = Frame::new(0.0, 0.0, cell.mesh.points.clone());
    // The last frames of a run that failed may be invalid.
    let is_finite = |frame: &&Frame| frame.positions.iter().flatten().all(|x| x.is_finite());
    let mut all: Vec<&Frame> = cell.frames.iter().filter(is_finite).collect();
    if all.is_empty() {
        all.push(&at_rest);
    }
    for frame in &all {
        check_frame(cell.mesh, frame)?;
    }

    let small = small(cell, &all, BUDGET / share);
    let (displacement, step) = frames::quantised(&small);
    let Fitted { drawn: display, kept, tolerance, .. } = small;
    let shown: Vec<&Frame> = kept.iter().map(|&at| all[at]).collect();

    let in_squares = |field: Field| {
        let of = |frame: &&Frame| display.means(&fields.on_triangles(field, frame));
        shown.iter().flat_map(of).collect::<Vec<f64>>()
    };
    let stress = differs(cell).then(|| in_squares(Field::ActiveStress));
    let strongest = stress.iter().flatten().copied().fold(0.0, f64::max);
    let stress_step = (strongest / f64::from(u16::MAX)).max(1e-9);
    let stress = stress.map(|values| {
        packed(values.iter().map(|value| ((value / stress_step).round() as u16).to_le_bytes()))
    });

    // x and y of each square in turn.
    let tractions = shown.iter().map(|frame| fields.tractions(frame)).collect::<Option<Vec<_>>>();
    let tractions = tractions.map(|frames| {
        let pairs = frames.iter().flat_map(|axes| {
            let [x, y] = axes.each_ref().map(|values| display.means(values));
            x.into_iter().zip(y).flat_map(|(x, y)| [x, y])
        });
        pairs.collect::<Vec<f64>>()
    });
    let (traction, traction_step) = signed(tractions);
    let potentials = Field::Potential.is_known(&shown, cell.has_tension);
    let (potential, potential_step) = signed(potentials.then(|| in_squares(Field::Potential)));

    let thick = cell.thick.as_ref().map(|thick| thick::of(thick, cell.has_tension, share));
    let picture = cell.picture.as_ref().map(|picture| photograph::of(picture, cell.outline));
    Ok(CellData {
        label: cell.label,
        peak_ms: rounded(cell.peak_ms),
        picture: picture.transpose()?.flatten(),
        rest_um: packed(display.rest.iter().flatten().map(|&x| (x as f32).to_le_bytes())),
        corners: packed(display.corners.iter().flatten().map(|corner| corner.to_le_bytes())),
        within: display.within,
        fibre: packed(directions(cell, &display).iter().map(|&angle| (angle as f32).to_le_bytes())),
        rings: display.rings.clone(),
        frames: Frames {
            t_ms: shown.iter().map(|frame| rounded(frame.t_ms)).collect(),
            displacement,
            step_um: step,
            ta_kpa: shown.iter().map(|frame| rounded(frame.ta_kpa)).collect(),
            stress,
            stress_step_kpa: stress_step,
            traction,
            traction_step_pa: traction_step,
            potential,
            potential_step_mv: potential_step,
        },
        spacing_um: rounded(display.spacing),
        accuracy_um: rounded(tolerance + step),
        fields: fields::of(&fields, &display, &shown, cell.has_tension),
        thick: thick.transpose()?,
    })
}

/// Values of either sign, packed in 16 bits each, and their step.
fn signed(values: Option<Vec<f64>>) -> (Option<String>, f64) {
    let largest = values.iter().flatten().fold(0.0_f64, |most, value| most.max(value.abs()));
    let step = (largest / f64::from(i16::MAX)).max(1e-9);
    let bytes = |value: &f64| ((value / step).round() as i16).to_le_bytes();
    (values.map(|values| packed(values.iter().map(bytes))), step)
}

/// Squares and frames that fit into some bytes.
fn small(cell: &MovingCell<'_>, all: &[&Frame], budget: usize) -> Fitted<Display> {
    let times: Vec<f64> = all.iter().map(|frame| frame.t_ms).collect();
    let [low, high] = cell.outline.bounds();
    let tolerance = UNSEEN * (high[0] - low[0]).max(high[1] - low[1]);
    let coarser = (cell.mesh.len() as f64 / FINE as f64).sqrt().ceil().max(1.0) as u32;
    frames::fitted(&times, coarser, tolerance, budget, |coarser| {
        let display = Display::new(cell.mesh, cell.outline, coarser);
        let displacements =
            all.iter().map(|frame| display.displacements(&frame.positions)).collect();
        let on_gel = all.iter().all(|frame| frame.on_gel_nn.is_some());
        let bytes = 4 * display.rest.len()
            + if differs(cell) { 2 * display.corners.len() } else { 0 }
            + if on_gel { 4 * display.corners.len() } else { 0 }
            + if Field::Potential.is_known(all, false) { 2 * display.corners.len() } else { 0 };
        Candidate { points: display.rest.len(), bytes, displacements, drawn: display }
    })
}

/// Whether the active stress differs from place to place.
fn differs(cell: &MovingCell<'_>) -> bool {
    let by_place = |frame: &Frame| frame.ta_by_triangle_kpa.is_some();
    cell.myofibril_content.is_some() || cell.frames.iter().any(by_place)
}

/// Direction of the fibre in each square, radians: half the angle of the mean vector at twice the angle, since
/// fibres have no sense.
fn directions(cell: &MovingCell<'_>, display: &Display) -> Vec<f64> {
    let mean =
        |of: fn(&[f64; 2]) -> f64| display.means(&cell.fibres.iter().map(of).collect::<Vec<f64>>());
    let (along, across) = (mean(|[x, y]| x * x - y * y), mean(|[x, y]| 2.0 * x * y));
    along.iter().zip(&across).map(|(x, y)| 0.5 * y.atan2(*x)).collect()
}
