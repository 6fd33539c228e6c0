//! The beating cell in as few bytes as the eye needs.

use super::curves::rounded;
use super::display::Display;
use super::fields::{self, FieldData};
use super::frames;
use super::given::{PageError, PageRun};
use crate::field::{Field, Fields};
use crate::figure::{check_frame, check_mesh};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use myospring_core::recording::Frame;
use serde::Serialize;

/// Bytes of the frames of all runs of a page together, before base64 makes them a third larger.
const BUDGET: usize = 1_400_000;
/// Masses of a lattice that is drawn square by square; of larger ones several squares are drawn as one.
const FINE: usize = 4000;
/// Points below which squares are not made coarser still: frames are left out instead.
const COARSE: usize = 900;
/// What is too little to be seen, of the longer side of the cell: a quarter of a pixel on a thousand.
const UNSEEN: f64 = 1.0 / 4000.0;

#[derive(Debug, Serialize)]
pub(super) struct CellData {
    rest_um: String,
    corners: String,
    within: usize,
    fibre: String,
    rings: Vec<usize>,
    frames: Frames,
    spacing_um: f64,
    accuracy_um: f64,
    fields: Vec<FieldData>,
}

#[derive(Debug, Serialize)]
struct Frames {
    t_ms: Vec<f64>,
    displacement: String,
    step_um: f64,
    ta_kpa: Vec<f64>,
    stress: Option<String>,
    stress_step_kpa: f64,
}

/// The cell of a run on a page of `share` runs.
pub(super) fn of(run: &PageRun<'_>, share: usize) -> Result<CellData, PageError> {
    check_mesh(run.mesh)?;
    let fields = Fields::new(run.mesh, run.fibres, run.myofibril_content)?;
    let at_rest = Frame {
        t_ms: 0.0,
        ta_kpa: 0.0,
        ta_by_triangle_kpa: None,
        positions: run.mesh.points.clone(),
    };
    // The last frames of a run that broke may not be shapes any more.
    let is_finite = |frame: &&Frame| frame.positions.iter().flatten().all(|x| x.is_finite());
    let mut all: Vec<&Frame> = run.recording.frames.iter().filter(is_finite).collect();
    if all.is_empty() {
        all.push(&at_rest);
    }
    for frame in &all {
        check_frame(run.mesh, frame)?;
    }

    let Small { display, kept, displacements, tolerance } = small(run, &all, BUDGET / share);
    let shown: Vec<&Frame> = kept.iter().map(|&at| all[at]).collect();
    let moved = || kept.iter().flat_map(|&at| &displacements[at]);
    let furthest = moved().fold(0.0_f32, |most, value| most.max(value.abs()));
    let step = (f64::from(furthest) / f64::from(i16::MAX)).max(1e-9);
    let quantised = moved().map(|&value| (f64::from(value) / step).round() as i16);

    let stress = differs(run).then(|| {
        let of = |frame: &&Frame| display.means(&fields.on_triangles(Field::ActiveStress, frame));
        shown.iter().flat_map(of).collect::<Vec<f64>>()
    });
    let strongest = stress.iter().flatten().copied().fold(0.0, f64::max);
    let stress_step = (strongest / f64::from(u16::MAX)).max(1e-9);
    let stress = stress.map(|values| {
        packed(values.iter().map(|value| ((value / stress_step).round() as u16).to_le_bytes()))
    });

    Ok(CellData {
        rest_um: packed(display.rest.iter().flatten().map(|&x| (x as f32).to_le_bytes())),
        corners: packed(display.corners.iter().flatten().map(|corner| corner.to_le_bytes())),
        within: display.within,
        fibre: packed(directions(run, &display).iter().map(|&angle| (angle as f32).to_le_bytes())),
        rings: display.rings.clone(),
        frames: Frames {
            t_ms: shown.iter().map(|frame| rounded(frame.t_ms)).collect(),
            displacement: packed(quantised.map(i16::to_le_bytes)),
            step_um: step,
            ta_kpa: shown.iter().map(|frame| rounded(frame.ta_kpa)).collect(),
            stress,
            stress_step_kpa: stress_step,
        },
        spacing_um: rounded(display.spacing),
        accuracy_um: rounded(tolerance + step),
        fields: fields::of(&fields, &display, &shown),
    })
}

/// A cell that is small enough.
struct Small {
    display: Display,
    kept: Vec<usize>,
    displacements: Vec<Vec<f32>>,
    /// By how much what lies between frames may be off, um.
    tolerance: f64,
}

/// Squares and frames that fit into some bytes: first squares are made coarser, then frames are left out.
fn small(run: &PageRun<'_>, all: &[&Frame], budget: usize) -> Small {
    let times: Vec<f64> = all.iter().map(|frame| frame.t_ms).collect();
    let [low, high] = run.outline.bounds();
    let mut tolerance = UNSEEN * (high[0] - low[0]).max(high[1] - low[1]);
    let mut longest = frames::LONGEST;
    let mut coarser = (run.mesh.len() as f64 / FINE as f64).sqrt().ceil().max(1.0) as u32;
    loop {
        let display = Display::new(run.mesh, run.outline, coarser);
        let displacements: Vec<Vec<f32>> =
            all.iter().map(|frame| display.displacements(&frame.positions)).collect();
        let per_frame =
            4 * display.rest.len() + if differs(run) { 2 * display.corners.len() } else { 0 };
        loop {
            let kept = frames::kept(&times, &displacements, tolerance, longest);
            if kept.len() * per_frame <= budget || kept.len() <= 2 {
                return Small { display, kept, displacements, tolerance };
            }
            if display.rest.len() > COARSE {
                break;
            }
            // Sooner or later two frames are left.
            tolerance *= 1.5;
            longest = longest * 3 / 2;
        }
        coarser += 1;
    }
}

/// Whether the active stress differs from place to place.
fn differs(run: &PageRun<'_>) -> bool {
    let by_place = |frame: &Frame| frame.ta_by_triangle_kpa.is_some();
    run.myofibril_content.is_some() || run.recording.frames.iter().any(by_place)
}

/// Direction of the fibre in each square, radians: half the angle of the mean vector at twice the angle, since
/// fibres have no sense.
fn directions(run: &PageRun<'_>, display: &Display) -> Vec<f64> {
    let mean =
        |of: fn(&[f64; 2]) -> f64| display.means(&run.fibres.iter().map(of).collect::<Vec<f64>>());
    let (along, across) = (mean(|[x, y]| x * x - y * y), mean(|[x, y]| 2.0 * x * y));
    along.iter().zip(&across).map(|(x, y)| 0.5 * y.atan2(*x)).collect()
}

/// Bytes as text.
fn packed<const N: usize>(numbers: impl Iterator<Item = [u8; N]>) -> String {
    STANDARD.encode(numbers.flatten().collect::<Vec<u8>>())
}
