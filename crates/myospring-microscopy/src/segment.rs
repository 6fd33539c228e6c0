//! Finds the cells in a plane: their pixels, with a confidence and its reasons.
//!
//! [`segment`] smooths, thresholds and cleans up; lengths are in micrometres, so that settings do
//! not depend on the magnification. [`Segmentation`] keeps the cells apart, largest first, each
//! with a [`Confidence`].
//!
//! - **Fluorescence** ([`Modality::Fluorescence`]): the slowly varying background is fitted and
//!   subtracted, and brightness is measured in units of noise, logarithmically above it. Each cell
//!   has its own threshold level: the one at which its outline agrees best with the picture.
//! - **Brightfield** ([`Modality::Brightfield`]): a cell is as grey as what surrounds it, but it
//!   has edges. Crests of the gradient (Canny 1986) that are connected over some um are kept, which
//!   excludes beads and debris; gaps between them are closed by the smallest radius beyond which
//!   the area no longer grows, and the inside is filled.
//! - **Auto** ([`Modality::Auto`]): as fluorescence if objects differ from the background mainly in
//!   brightness, as brightfield if mainly in texture.
//! - **Mask** ([`Modality::Mask`]): every value that is not zero; labels are kept apart.
//!
//! Touching cells in pictures are separated at necks, at dark lines, and where a branch has stripes
//! of its own direction; a cell that may be two has a reason in its [`Confidence`]. The confidence
//! measures how clear the outline is, and whether the object is a heart cell (`tissue`).

mod brightfield;
mod by_modality;
mod companion;
mod confidence;
mod evidence;
mod figure;
mod fluorescence;
mod found;
mod grain;
mod ground;
mod labels;
mod ladder;
mod modality;
mod parting;
mod sheet;
mod tissue;

use serde::Serialize;

pub use by_modality::segment;
pub(crate) use by_modality::{check_settings, is_taken_for_mask};
pub use confidence::Confidence;
pub(crate) use modality::has_flat_labels;

use super::region::Window;
use myospring_core::interruption::{Interrupted, Interruption};
use myospring_core::mesh::mask::{Mask, MaskError, Part};
use myospring_core::mesh::pixel_size::PixelSize;

/// How the picture was taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Modality {
    /// Determined from the grey values.
    #[default]
    Auto,
    /// A bright cell on a dark ground.
    Fluorescence,
    /// A cell visible by its edges and texture; also phase contrast.
    Brightfield,
    /// Not a picture but its segmentation: background 0.
    Mask,
}

impl Modality {
    /// In a word, how a picture was taken that was found to be so.
    pub fn seen_as(self) -> &'static str {
        match self {
            Self::Mask => "mask",
            Self::Brightfield => "brightfield",
            Self::Fluorescence | Self::Auto => "fluorescence",
        }
    }
}

/// Largest label of a mask: pixels are `f32`, which cannot distinguish larger whole numbers.
pub const LARGEST_LABEL: u32 = (1 << f32::MANTISSA_DIGITS) - 1;

/// Default area below which an island is not a cell, um^2: a tenth of a small myocyte.
pub const SMALLEST_CELL_UM2: f64 = 100.0;

/// Options of segmentation.
#[derive(Debug, Clone, PartialEq)]
pub struct SegmentationSettings {
    /// How the picture was taken.
    pub modality: Modality,
    /// Fluorescence: grey value above which a pixel is cell, background included. Brightfield:
    /// least gradient of an edge, relative change of brightness per um. `None` determines it from
    /// the picture.
    pub threshold: Option<f64>,
    /// Scale of smoothing, um. `None` takes 0.5 um for fluorescence and 0.8 um for brightfield:
    /// finer than the features of an outline, coarser than noise and, for brightfield, than grains.
    pub smooth_um: Option<f64>,
    /// Islands smaller than this are not cells, um^2.
    pub smallest_cell_um2: f64,
    /// What ends the work early, with [`SegmentError::Interrupted`].
    pub interruption: Interruption,
}

impl Default for SegmentationSettings {
    /// Everything is determined from the picture.
    fn default() -> Self {
        Self {
            modality: Modality::Auto,
            threshold: None,
            smooth_um: None,
            smallest_cell_um2: SMALLEST_CELL_UM2,
            interruption: Interruption::default(),
        }
    }
}

/// Which cell of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Choice {
    /// The largest that the frame does not cut (or the largest of all, if cut cells are allowed).
    #[default]
    Largest,
    /// By its number; 1 is the largest.
    Number(u32),
    /// By its value in a label image.
    Label(u32),
    /// The one at this place: column and row in pixels, from the top left.
    At([f64; 2]),
}

/// One cell of a picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SegmentedCell {
    /// Its number, counted from 1 in the order of decreasing area.
    pub number: u32,
    /// Its value, if the picture is a label image.
    pub label: Option<u32>,
    /// Its pixels.
    pub pixels: usize,
    /// Its area, um^2.
    pub area_um2: f64,
    /// Number of its pixels on the frame of the picture; if there are any, the cell may be cut.
    pub pixels_on_the_frame: usize,
    /// How certain it is.
    pub confidence: Confidence,
}

/// The cells of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Segmentation {
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// Side of one pixel.
    pub pixel_size: PixelSize,
    /// Number of the cell of each pixel, row by row from the top left; 0 is background.
    pub numbers: Vec<u32>,
    /// The cells; number n has index n - 1.
    pub cells: Vec<SegmentedCell>,
    /// How the picture was taken, as stated or as determined.
    pub modality: Modality,
    /// Why it was treated as this modality, in words; `None` if it was stated, and for masks.
    pub modality_reason: Option<String>,
    /// The threshold that was used, in the unit of [`SegmentationSettings::threshold`]; 0 for a mask.
    pub threshold: f64,
    /// Warnings.
    pub notes: Vec<String>,
}

/// Why no cell is found in a plane.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SegmentError {
    /// The work was ended early.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// The pixels of a cell are not a valid mask.
    #[error(transparent)]
    Mask(#[from] MaskError),
    /// A setting out of range.
    #[error("{what} is {value} {unit}; give a number from {low} to {high} {unit}, or leave it out")]
    Setting {
        /// Which one.
        what: &'static str,
        /// Its value.
        value: f64,
        /// Its unit.
        unit: &'static str,
        /// Least value.
        low: f64,
        /// Largest value.
        high: f64,
    },
    /// All pixels have the same value.
    #[error(
        "all {width} x {height} pixels have the same value, {value}: no cell is visible; is this the right \
         channel, frame or slice?"
    )]
    Blank {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// The value.
        value: f32,
    },
    /// A value that is not finite.
    #[error("the pixel in column {column}, row {row} is {value}; pixels must be finite")]
    NotFinite {
        /// Column.
        column: usize,
        /// Row.
        row: usize,
        /// The value.
        value: f32,
    },
    /// Nothing that could be a cell.
    #[error(
        "no cell was found ({modality} picture, threshold {threshold}): {why}; try another --threshold, --smooth or \
         --modality, check the pixel size of {pixel_size}, or draw the outline by hand"
    )]
    NoCell {
        /// The modality of the segmentation.
        modality: &'static str,
        /// The threshold, with its unit.
        threshold: String,
        /// What was seen instead.
        why: String,
        /// Side of one pixel.
        pixel_size: PixelSize,
    },
    /// Nothing that could be a cell, by any modality.
    #[error(
        "no cell was found: nothing as large as {smallest_um2} um^2 differs from the background in brightness, texture or \
         edges; is this the right channel, frame or slice, and is a pixel {pixel_size}? Otherwise give \
         --modality and a --threshold, or draw the outline by hand"
    )]
    NothingStandsOut {
        /// Area below which an island is not a cell, um^2.
        smallest_um2: f64,
        /// Side of one pixel.
        pixel_size: PixelSize,
    },
    /// There is no cell of this number.
    #[error("cell {number} was asked for, but the picture has {cells}; 1 is the largest")]
    NoSuchCell {
        /// The number.
        number: u32,
        /// How many there are, in words.
        cells: String,
    },
    /// A value that is not a label.
    #[error(
        "the pixel in column {column}, row {row} is {value}, but a mask contains values from 0 to {LARGEST_LABEL}; is this \
         the picture itself, not its mask?"
    )]
    NoLabel {
        /// Column.
        column: usize,
        /// Row.
        row: usize,
        /// The value.
        value: f32,
    },
    /// There is no such label.
    #[error("label {label} is not in the picture, which holds {labels}; 0 is the background")]
    NoSuchLabel {
        /// The requested label.
        label: u32,
        /// The existing labels.
        labels: String,
    },
    /// A label was asked for, but the picture is not a label image.
    #[error(
        "label {label} was asked for, but the picture is not a label image; choose a cell with --cell or --seed, or \
         say --modality mask if it is one"
    )]
    NotAMask {
        /// The label.
        label: u32,
    },
    /// No cell lies there.
    #[error(
        "no cell was found at {x}, {y} (column and row in pixels from the top left, picture {width} x {height}); \
         the nearest is {nearest}"
    )]
    NotThere {
        /// Column.
        x: f64,
        /// Row.
        y: f64,
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// The nearest cell and its position.
        nearest: String,
    },
    /// The cell reaches the frame.
    #[error(
        "cell {name} is cut by the frame of the picture ({pixels} of its pixels lie on it), so its true shape is \
         not known; take a picture with the whole cell, choose another cell, or allow it with --allow-cut"
    )]
    Cut {
        /// Its name: its label, or its number.
        name: String,
        /// How many of its pixels lie on the frame.
        pixels: usize,
    },
}

impl Segmentation {
    /// The cell that was chosen.
    ///
    /// # Errors
    /// No such cell, none at that place, or one that the frame cuts while `allow_cut` is false.
    pub fn choose(&self, choice: Choice, allow_cut: bool) -> Result<&SegmentedCell, SegmentError> {
        let cell = match choice {
            Choice::Largest => {
                let whole =
                    self.cells.iter().find(|cell| allow_cut || cell.pixels_on_the_frame == 0);
                whole.or(self.cells.first())
            }
            Choice::Number(number) => self.cells.iter().find(|cell| cell.number == number),
            Choice::Label(label) => Some(self.labelled(label)?),
            Choice::At(place) => Some(self.at(place)?),
        };
        let Some(cell) = cell else {
            let number = if let Choice::Number(number) = choice { number } else { 1 };
            return Err(SegmentError::NoSuchCell { number, cells: counted(self.cells.len()) });
        };
        if cell.pixels_on_the_frame > 0 && !allow_cut {
            let (name, pixels) = (self.name(cell), cell.pixels_on_the_frame);
            return Err(SegmentError::Cut { name, pixels });
        }
        Ok(cell)
    }

    /// The name of a cell: its label if the labels distinguish cells, else its number.
    pub fn name(&self, cell: &SegmentedCell) -> String {
        // A single mask value marks all cells alike.
        let labelled = self.cells.iter().any(|other| other.label != cell.label);
        cell.label.filter(|_| labelled).unwrap_or(cell.number).to_string()
    }

    fn labelled(&self, label: u32) -> Result<&SegmentedCell, SegmentError> {
        if self.modality != Modality::Mask {
            return Err(SegmentError::NotAMask { label });
        }
        let cell = self.cells.iter().find(|cell| cell.label == Some(label));
        cell.ok_or_else(|| {
            let mut labels: Vec<u32> = self.cells.iter().filter_map(|cell| cell.label).collect();
            labels.sort_unstable();
            labels.dedup();
            let more = if labels.len() > 12 { ", ..." } else { "" };
            let labels: Vec<String> = labels.iter().take(12).map(u32::to_string).collect();
            let labels = if labels.is_empty() { "no label".to_owned() } else { labels.join(", ") };
            SegmentError::NoSuchLabel { label, labels: format!("{labels}{more}") }
        })
    }

    fn at(&self, [x, y]: [f64; 2]) -> Result<&SegmentedCell, SegmentError> {
        let inside = x >= 0.0 && y >= 0.0 && x < self.width as f64 && y < self.height as f64;
        let number = if inside { self.numbers[y as usize * self.width + x as usize] } else { 0 };
        if let Some(cell) = self.cells.iter().find(|cell| cell.number == number) {
            return Ok(cell);
        }
        let mut nearest: Option<(f64, usize)> = None;
        for (at, _) in self.numbers.iter().enumerate().filter(|(_, number)| **number != 0) {
            let (column, row) = ((at % self.width) as f64 + 0.5, (at / self.width) as f64 + 0.5);
            let distance = (column - x).hypot(row - y);
            if nearest.is_none_or(|(least, _)| distance < least) {
                nearest = Some((distance, at));
            }
        }
        let mut nearest = nearest.map_or_else(
            || "nowhere: there is none".to_owned(),
            |(distance, at)| {
                let (column, row) = (at % self.width, at / self.width);
                let number = self.numbers[at];
                format!("cell {number} at {column}, {row}, {distance:.0} pixels away")
            },
        );
        if !inside {
            nearest += "; the place lies outside the picture: is it in pixels, column first?";
        } else if self.modality != Modality::Mask {
            let threshold = self.threshold;
            nearest = format!(
                "{nearest}; if you see a cell there, try a --threshold below {threshold:.4}, which includes dimmer pixels, or draw it and \
                 give --outline"
            );
        }
        let (width, height) = (self.width, self.height);
        Err(SegmentError::NotThere { x, y, width, height, nearest })
    }

    /// The pixels of one cell.
    ///
    /// # Errors
    /// No cell of that number.
    pub fn mask(&self, number: u32) -> Result<Mask, SegmentError> {
        self.mask_within(number, &Window { columns: 0..self.width, rows: 0..self.height })
    }

    /// [`Segmentation::mask`] of a cell whose pixels all lie in a window.
    pub(super) fn mask_within(&self, number: u32, window: &Window) -> Result<Mask, SegmentError> {
        let numbers = window.cut(&self.numbers, self.width);
        let inside: Vec<bool> =
            numbers.into_iter().map(|other| number != 0 && other == number).collect();
        if !inside.contains(&true) {
            let cells = counted(self.cells.len());
            return Err(SegmentError::NoSuchCell { number, cells });
        }
        let (left, top, width) = (window.columns.start, window.rows.start, window.width());
        let part = Part { left, top, width, inside };
        Ok(Mask::of_part(self.width, self.height, self.pixel_size, part)?)
    }

    /// The bounding window of each cell, in the order of their numbers.
    pub(super) fn windows(&self) -> Vec<Window> {
        let most = self.cells.iter().map(|cell| cell.number as usize).max().unwrap_or(0);
        let mut windows = vec![Window { columns: 0..0, rows: 0..0 }; most];
        for (row, numbers) in self.numbers.chunks_exact(self.width).enumerate() {
            for (column, &number) in numbers.iter().enumerate().filter(|(_, number)| **number != 0)
            {
                if let Some(Window { columns, rows }) = windows.get_mut(number as usize - 1) {
                    if rows.start == rows.end {
                        (*columns, *rows) = (column..column + 1, row..row + 1);
                    }
                    *columns = columns.start.min(column)..columns.end.max(column + 1);
                    rows.end = row + 1;
                }
            }
        }
        windows
    }
}

pub(super) fn counted(cells: usize) -> String {
    match cells {
        1 => "1 cell".to_owned(),
        count => format!("{count} cells"),
    }
}
