//! The cell seen from above: which columns of a stack may hold it, and which show the background.

use super::error::StackError;
use super::options::StackOptions;
use super::reading::{Scale, Stack};
use super::volume::Volume;
use crate::plane::Plane;
use crate::region::Region;
use crate::segment::{Confidence, Modality, Segmentation, SegmentationSettings, segment};
use myospring_core::mesh::pixel_size::PixelSize;

/// How far the cell may reach beyond its outline from above, um.
const BEYOND_UM: f64 = 2.0;
/// Distances from the cell between which the background is measured, um.
const AROUND_UM: [f64; 2] = [3.0, 25.0];

/// The cell seen from above, on the grid of the volume.
pub(super) struct Above {
    /// First column and row of the window around the cell, and those behind the last.
    pub(super) from: [usize; 2],
    pub(super) to: [usize; 2],
    /// Columns of the window that are the cell, and in which it may lie.
    pub(super) cell: Region,
    pub(super) allowed: Region,
    /// All columns around the cell that show the background.
    pub(super) around: Vec<bool>,
    pub(super) cells: usize,
    pub(super) confidence: Confidence,
    /// Whether the picture from above seems to be brightfield.
    pub(super) is_brightfield: bool,
}

impl Above {
    /// Finds the cells in the largest brightness over all slices, and takes the chosen one.
    pub(super) fn find(
        volume: &Volume<f32>,
        stack: &Stack,
        factor: usize,
        scale: Scale,
        options: &StackOptions,
    ) -> Result<Self, StackError> {
        let [width, height, _] = volume.size;
        let Some(plane) = Plane::new(width, height, volume.largest_down()) else {
            return Err(StackError::TooFew { slices: 0 });
        };
        let pixel = volume.pitch[0];
        let settings = SegmentationSettings {
            modality: Modality::Fluorescence,
            ..options.segmentation.clone()
        };
        let pixel_size = PixelSize::new(pixel).unwrap_or(scale.pixel_size);
        let found = segment(&plane, pixel_size, &settings)?;
        let is_auto = options.segmentation.modality == Modality::Auto;
        let seen = is_auto.then(|| segment(&plane, pixel_size, &options.segmentation));
        let is_brightfield =
            matches!(seen, Some(Ok(seen)) if seen.modality == Modality::Brightfield);
        // Places are chosen on the pixels of the file.
        let [columns, rows] = stack.size();
        let numbers = (0..columns * rows)
            .map(|at| found.numbers[at / columns / factor * width + at % columns / factor]);
        let numbers: Vec<u32> = numbers.collect();
        let whole = Segmentation {
            width: columns,
            height: rows,
            pixel_size: scale.pixel_size,
            numbers,
            ..found.clone()
        };
        let chosen = whole.choose(options.choice, options.allow_cut)?;
        let own = |number: &u32| *number == chosen.number;
        let cell = Region::new(width, height, found.numbers.iter().map(own));
        let others = found.numbers.iter().map(|number| *number != 0 && !own(number));
        let others = Region::new(width, height, others);
        let all = Region::new(width, height, found.numbers.iter().map(|&number| number != 0));
        let [near, far] = AROUND_UM.map(|um| um / pixel);
        let (near, far) = (all.grown(near), cell.grown(far));
        let mut around: Vec<bool> =
            near.inside().zip(far.inside()).map(|(near, far)| far && !near).collect();
        if around.iter().filter(|&&is| is).count() * 4 < cell.count() {
            around = near.inside().map(|near| !near).collect();
        }
        let window = cell.window((AROUND_UM[0] / pixel).ceil() as usize, 1);
        let reach = cell.grown(BEYOND_UM / pixel);
        let allowed =
            Region::new(width, height, reach.inside().zip(others.inside()).map(|(a, b)| a && !b));
        Ok(Self {
            from: [window.columns.start, window.rows.start],
            to: [window.columns.end, window.rows.end],
            cell: cell.cut(&window),
            allowed: allowed.cut(&window),
            around,
            cells: found.cells.len(),
            confidence: chosen.confidence.clone(),
            is_brightfield,
        })
    }
}
