//! A picture with the cells that it shows, to look at and to choose from.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use myospring::experiment::{ExperimentError, Files};
use myospring::mesh::pixel_size::PixelSize;
use myospring::microscopy::cells::PictureCells;
use myospring::microscopy::plane::Plane;
use myospring::microscopy::read::read_picture;
use myospring::microscopy::segment::Choice;
use myospring::settings::{Run, Source};
use serde::Serialize;

/// Longest side of the picture as it is shown, pixels.
const LONGEST: usize = 1200;
/// Part of the pixels that may be darker or brighter than what is shown.
const CLIPPED: f64 = 0.002;

/// A picture with its cells.
#[derive(Serialize)]
pub(crate) struct ShownCells {
    /// Columns and rows of the picture.
    size: [usize; 2],
    /// `None` where nothing says it; then no cell was sought.
    pixel_size_um: Option<f64>,
    /// Grey values of the picture as it is shown, one of each `every` columns and rows.
    grey: String,
    every: usize,
    cells: Vec<ShownCell>,
    /// Number of the cell that is taken, and why none is.
    taken: Option<u32>,
    refused: Option<String>,
    notes: Vec<String>,
}

/// One of the cells.
#[derive(Serialize)]
struct ShownCell {
    number: u32,
    name: String,
    area_um2: f64,
    /// From 0 to 1, and reasons for doubt.
    confidence: f64,
    reasons: Vec<String>,
    /// Column and row of each corner; of holes, too.
    rings: Vec<Vec<[f64; 2]>>,
}

impl ShownCells {
    pub(crate) fn of(run: &Run, files: &Files) -> Result<Self, ExperimentError> {
        let shape = &run.shape;
        let Source::Picture(source) = &shape.source else {
            return Err(ExperimentError::new("there is no picture"));
        };
        let bytes = shape.bytes(|file| files.bytes(file))?;
        // As it is: with its scale bar, which is no part of a cell.
        let picture = read_picture(&bytes.shape, &source.options.selection);
        let (all, why) = match source.cells(&bytes) {
            Ok(all) => (Some(all), None),
            Err(why) => (None, Some(why)),
        };
        let plane = match (picture, &why) {
            (Ok(picture), _) => picture.plane,
            (Err(_), Some(why)) => return Err(ExperimentError::new(why)),
            (Err(why), None) => return Err(ExperimentError::new(why)),
        };
        let taken = all.as_ref().map(|all| (all, all.cell(source.choice, source.allow_cut)));
        let (taken, refused) = match taken {
            Some((all, Ok(cell))) => (Some(cell.number), all.impossible_size(&cell, false)),
            Some((_, Err(why))) => (None, Some(source.failed(why).to_string())),
            None => (None, why.map(|why| why.to_string())),
        };
        let every = plane.width().max(plane.height()).div_ceil(LONGEST).max(1);
        let scale = all.as_ref().map(|all| all.pixel_size).or(source.options.pixel_size);
        Ok(Self {
            size: [plane.width(), plane.height()],
            pixel_size_um: scale.map(PixelSize::um),
            grey: STANDARD.encode(grey(&plane, every)),
            every,
            cells: all.as_ref().map_or_else(|| Ok(Vec::new()), cells)?,
            taken,
            refused,
            notes: all.map(|all| all.notes).unwrap_or_default(),
        })
    }
}

fn cells(all: &PictureCells) -> Result<Vec<ShownCell>, ExperimentError> {
    let frame = all.frame().map_err(ExperimentError::new)?;
    let found =
        (1..=all.len() as u32).filter_map(|number| all.cell(Choice::Number(number), true).ok());
    let shown = found.map(|cell| {
        let in_pixels =
            |ring: &[[f64; 2]]| ring.iter().map(|point| frame.to_pixels(*point)).collect();
        ShownCell {
            number: cell.number,
            area_um2: cell.outline.area(),
            confidence: cell.confidence.score,
            reasons: cell.warnings().collect(),
            rings: cell.outline.rings().map(in_pixels).collect(),
            name: cell.name,
        }
    });
    Ok(shown.collect())
}

/// Grey values from 0 to 255, of which a few are clipped.
fn grey(plane: &Plane, every: usize) -> Vec<u8> {
    let rows = (0..plane.height()).step_by(every);
    let values = rows
        .flat_map(|row| (0..plane.width()).step_by(every).map(move |column| plane.at(column, row)));
    let values: Vec<f32> = values.collect();
    let mut sorted: Vec<f32> = values.iter().copied().filter(|value| value.is_finite()).collect();
    sorted.sort_by(f32::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else { return vec![0; values.len()] };
    let at = |part: f64| sorted[(part * last as f64) as usize];
    let (low, high) = (at(CLIPPED), at(1.0 - CLIPPED));
    let scale = if high > low { 255.0 / (high - low) } else { 0.0 };
    values.iter().map(|value| ((value - low) * scale).clamp(0.0, 255.0) as u8).collect()
}
