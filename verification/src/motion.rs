//! The motion of a cell in a published film, ours beside scikit-image's optical flow.
//!
//! The flow (iterative Lucas-Kanade, Le Besnerais and Champagnat 2005) stands in `reference/optical_flow.csv`, made by
//! `python/optical_flow_reference.py`: it minimises differences of grey values over windows, with neither gradients of
//! the motion nor a check by neighbours. Ours is made here; both from the same frame at rest, compared at a grid of
//! places. The film is published data, which may be missing.

use crate::check::{Failure, Setting};
use crate::row::Row;
use myospring::analysis::order;
use myospring::mesh::carried::Carried;
use myospring::mesh::lattice;
use myospring::mesh::pixel_size::PixelSize;
use myospring::microscopy::cells::{PictureCells, PictureOptions};
use myospring::microscopy::film::Film;
use myospring::microscopy::motion::{self, CellAtRest, CellMotion, Rest, TrackingSettings};
use myospring::microscopy::picture::Selection;
use myospring::microscopy::segment::Choice;
use serde::Deserialize;
use std::path::Path;

const AGAINST: &str = "scikit-image 0.26.0";
const FILM: &str = "sarcgraph_sample_2.avi";
const PIXEL_UM: f64 = 0.18;
/// The frame at rest of the flow.
const REST: usize = 45;

/// The flow at a place.
#[derive(Debug, Clone, Copy, Deserialize)]
struct Flow {
    frame: usize,
    column: f64,
    row: f64,
    right_px: f64,
    down_px: f64,
}

/// Ours at the same place, pixels, y downward, with the motion of the stage; `None` beside the cell and where it was
/// interpolated.
struct Pair {
    flow: [f64; 2],
    ours: [f64; 2],
}

fn followed(film: &Film) -> Result<CellMotion, Failure> {
    let rest = Rest::at(film, REST)?;
    let pixel_size = PixelSize::new(PIXEL_UM)?;
    let options = PictureOptions { pixel_size: Some(pixel_size), ..PictureOptions::default() };
    let cells = PictureCells::find(&film.picture(REST)?, &options)?;
    let cell = cells.cell(Choice::Largest, true)?;
    let (mesh, _) = lattice::from_mask(&cell.mask, Some(2.0))?;
    let inside = cell.mask.inside();
    let seen =
        CellAtRest { mesh: &mesh, inside: &inside, any_cell: &inside, pixel_size, fibres: None };
    Ok(motion::follow(film, rest, &seen, TrackingSettings::at(30.0), |_| true)?)
}

/// Both at all places that lie within the lattice and were found in that frame.
fn pairs(motion: &CellMotion, height: usize, flows: &[Flow]) -> Vec<Pair> {
    let um =
        |flow: &Flow| [(flow.column + 0.5) * PIXEL_UM, (height as f64 - flow.row - 0.5) * PIXEL_UM];
    let carried = Carried::new(&motion.mesh, flows.iter().map(um));
    let pair = |(place, flow): (usize, &Flow)| {
        // Of a frame that repeats another, the other was followed.
        let at = motion.frames.partition_point(|frame| *frame <= flow.frame) - 1;
        let weights = carried.weights(place);
        let seen = |&(node, weight): &(u32, f64)| {
            (-1e-6..=1.0 + 1e-6).contains(&weight) && !motion.interpolated[at][node as usize]
        };
        if !weights.iter().all(seen) {
            return None;
        }
        let along = |axis: usize| {
            let moved = &motion.displacements_um[at][axis];
            let sum: f64 =
                weights.iter().map(|(node, weight)| weight * moved[*node as usize]).sum();
            (sum + motion.stage_um[at][axis]) / PIXEL_UM
        };
        Some(Pair { flow: [flow.right_px, flow.down_px], ours: [along(0), -along(1)] })
    };
    flows.iter().enumerate().filter_map(pair).collect()
}

fn median(values: Vec<f64>) -> f64 {
    order::median(values).unwrap_or(f64::NAN)
}

/// Makes the rows; skipped without the film.
///
/// # Errors
/// A film or the reference that cannot be read.
pub fn rows(setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let file = setting.data.join("films").join(FILM);
    let what = format!("motion of the cell of {FILM}");
    if !file.exists() {
        let missing = format!("published data: {} is not there", file.display());
        return Ok(vec![Row::skipped(what, AGAINST, &missing)]);
    }
    let reference = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/optical_flow.csv");
    let flows: Vec<Flow> =
        csv::Reader::from_path(reference)?.deserialize().collect::<Result<_, _>>()?;
    let film = Film::read(std::fs::read(file)?, &Selection::default())?;
    let motion = followed(&film)?;
    let pairs = pairs(&motion, film.size()[1], &flows);
    let apart =
        pairs.iter().map(|Pair { flow, ours }| (flow[0] - ours[0]).hypot(flow[1] - ours[1]));
    let moved = |pair: &Pair| pair.ours[0].hypot(pair.ours[1]);
    let typical = median(pairs.iter().map(moved).collect());
    // By the mean squares, to which the errors of both add alike; a slope would have those of the flow alone.
    let squares = |of: &dyn Fn(&Pair) -> [f64; 2]| {
        pairs.iter().map(of).map(|[right, down]| right * right + down * down).sum::<f64>()
    };
    let ratio = (squares(&|pair| pair.ours) / squares(&|pair| pair.flow)).sqrt();
    Ok(vec![
        Row::difference(
            format!(
                "{what}: median distance of both at {} places, which move by {typical:.2} px",
                pairs.len()
            ),
            AGAINST,
            median(apart.collect()),
            0.4,
            "px",
            "the flow differs from itself by 0.6 px at the top of a beat with windows of 15 and of 31 pixels, by 0.3 \
             to 0.4 px with 23 and either: it has no gradients and wanders along stripes",
        ),
        Row::about(
            format!("{what}: root mean square of our displacements over that of the flow"),
            AGAINST,
            ratio,
            1.0,
            0.1,
            "",
            "the flow averages over its windows, and where they hold both cell and ground",
        ),
    ])
}
