//! The grid on which a method works, and the way from the cells on it to those of the picture.

use super::confidence::{Candidate, Confidence};
use super::parting::{Doubt, Parting, Seen};
use super::{Modality, Segmentation, SegmentationSettings, SegmentedCell, figure, sheet};
use crate::filter;
use crate::plane::Plane;
use crate::region::{Connectivity, Islands, Region};
use myospring_core::interruption::{Interrupted, Interruption};
use myospring_core::mesh::pixel_size::PixelSize;

/// Largest number of pixels on which a method works.
const MOST_WORKING_PIXELS: f64 = 12e6;

/// The plane at the resolution on which a method works.
pub(super) struct Working {
    pub(super) plane: Plane,
    /// Pixels of the picture along the side of one working pixel.
    pub(super) factor: usize,
    /// Side of a working pixel, um.
    pub(super) pixel_um: f64,
    /// Ends the work on them early.
    pub(super) interruption: Interruption,
}

impl Working {
    /// Averages pixels up to a side of `coarsest_um`, or more for a very large picture, so that
    /// several planes fit into memory.
    pub(super) fn of(
        plane: &Plane,
        pixel_size: PixelSize,
        coarsest_um: f64,
        interruption: &Interruption,
    ) -> Result<Self, Interrupted> {
        interruption.check()?;
        let pixels = (plane.width() * plane.height()) as f64;
        let affordable = (pixels / MOST_WORKING_PIXELS).sqrt().ceil() as usize;
        let factor = ((coarsest_um / pixel_size.um()) as usize).max(affordable).max(1);
        let pixel_um = pixel_size.um() * factor as f64;
        let plane = filter::coarse(plane, factor);
        Ok(Self { plane, factor, pixel_um, interruption: interruption.clone() })
    }
}

/// Result of a segmentation method: the cells on a grid coarser than the picture by `factor`.
pub(super) struct Found<'a> {
    pub(super) region: Region,
    /// The data in which the region was found; used to separate touching cells.
    pub(super) seen: Seen<'a>,
    pub(super) factor: usize,
    pub(super) modality: Modality,
    pub(super) threshold: f64,
}

impl Found<'_> {
    /// Maps the cells to the picture's own pixels and numbers them, largest first.
    pub(super) fn finish(
        self,
        plane: &Plane,
        pixel_size: PixelSize,
        settings: &SegmentationSettings,
        judge: impl Fn(&Candidate<'_>) -> Confidence,
    ) -> Result<Segmentation, Interrupted> {
        let interruption = &settings.interruption;
        let (width, height) = (plane.width(), plane.height());
        let parting = Parting::of(&self.region, &self.seen, interruption)?;
        interruption.check()?;
        let islands = self.islands(&parting, width, height);
        interruption.check()?;
        let smallest = settings.smallest_cell_um2 / pixel_size.um().powi(2);
        let mut order: Vec<usize> = (0..islands.list.len())
            .filter(|&island| islands.list[island].pixels as f64 >= smallest)
            .collect();
        order.sort_by_key(|&island| std::cmp::Reverse(islands.list[island].pixels));
        let mut renumbered = vec![0_u32; islands.list.len() + 1];
        for (number, &island) in (1..).zip(&order) {
            renumbered[island + 1] = number;
        }
        let mut numbers = islands.numbers;
        for number in &mut numbers {
            *number = renumbered[*number as usize];
        }
        let mut pixels = vec![Vec::new(); order.len()];
        for (at, &number) in (0..).zip(&numbers) {
            if number > 0 {
                pixels[number as usize - 1].push(at);
            }
        }
        let cell = |(number, pixels): (u32, &Vec<u32>)| {
            interruption.check()?;
            let (rim, on_frame) = rim(&numbers, width, height, pixels);
            let concerns = |doubt: &&Doubt| doubt.concerns(number, &numbers, width, self.factor);
            let doubts = parting.doubts.iter().filter(concerns);
            let doubt = doubts.min_by(|a, b| a.factor().total_cmp(&b.factor()));
            let doubt = doubt.map(|doubt| (doubt.factor(), doubt.reason(self.factor)));
            Ok(SegmentedCell {
                number,
                label: None,
                pixels: pixels.len(),
                area_um2: pixels.len() as f64 * pixel_size.um().powi(2),
                pixels_on_the_frame: on_frame,
                confidence: judge(&Candidate {
                    number,
                    numbers: &numbers,
                    width,
                    pixels,
                    rim: &rim,
                    on_frame,
                    doubt,
                }),
            })
        };
        let mut cells: Vec<SegmentedCell> =
            (1..).zip(&pixels).map(cell).collect::<Result<_, _>>()?;
        interruption.check()?;
        let Self { modality, threshold, .. } = self;
        let rim_of_frame = (2 * (width + height)).saturating_sub(4);
        let mut parts: Vec<sheet::Part<'_>> = cells
            .iter_mut()
            .map(|SegmentedCell { pixels, pixels_on_the_frame: on_frame, confidence, .. }| {
                sheet::Part { pixels: *pixels, on_frame: *on_frame, confidence }
            })
            .collect();
        let notes = figure::note(plane).inspect(|_| {
            for part in &mut parts {
                part.confidence.score *= figure::FACTOR;
                part.confidence.reasons.push(figure::REASON.to_owned());
            }
        });
        let notes = notes.or_else(|| sheet::weigh(&mut parts, rim_of_frame)).into_iter().collect();
        Ok(Segmentation {
            width,
            height,
            pixel_size,
            numbers,
            cells,
            modality,
            modality_reason: None,
            threshold,
            notes,
        })
    }

    /// The cells on the picture's own pixels, with touching cells separated.
    fn islands(&self, parting: &Parting, width: usize, height: usize) -> Islands {
        let region = self.on_plane(width, height);
        match parting.marks(&region, self.factor) {
            Some(marks) => region.islands_of_marks(Connectivity::Four, &marks),
            None => region.islands(Connectivity::Four),
        }
    }

    /// The cells on the picture's own pixels; the steps of a coarser grid are smoothed away.
    fn on_plane(&self, width: usize, height: usize) -> Region {
        if self.factor == 1 {
            return self.region.clone();
        }
        self.region.spread(self.factor, width, height).smoothed(self.factor as f64)
    }
}

/// The pixels of a cell with a neighbour outside it, except those on the frame; and the number of
/// pixels on the frame.
fn rim(numbers: &[u32], width: usize, height: usize, pixels: &[u32]) -> (Vec<u32>, usize) {
    let (mut rim, mut on_frame) = (Vec::new(), 0);
    for &pixel in pixels {
        let at = pixel as usize;
        let (column, row) = (at % width, at / width);
        if column == 0 || row == 0 || column + 1 == width || row + 1 == height {
            on_frame += 1;
        } else if [at - 1, at + 1, at - width, at + width]
            .iter()
            .any(|&n| numbers[n] != numbers[at])
        {
            rim.push(pixel);
        }
    }
    (rim, on_frame)
}
