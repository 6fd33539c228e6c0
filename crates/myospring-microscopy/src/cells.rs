//! From the bytes of a picture to its cells: reads the picture, determines the pixel size,
//! segments; then gives one cell with its outline, shape report and fibre directions.
//!
//! ```text
//! bytes ─▶ PictureCells::find ─▶ .cell(choice) ─▶ PictureCell {outline, mask, shape, confidence}
//!                                                      └─▶ .fibres(long axis) ─▶ one direction per triangle
//! ```

use std::sync::Arc;

use geo::Distance;

use super::burned_in;
use super::fibres::{FibreError, FibreField, FibreSettings, fibres_interruptible};
use super::hot_pixels;
use super::outlines::raster::rasterise;
use super::outlines::trace::{Edge, TraceError, trace_mask};
use super::outlines::{
    CoordinateUnit, FrameError, GivenOutlines, NamedOutline, OutlineFileError, PixelFrame,
    Placement, ReadOptions, read_outlines,
};
use super::picture::{PixelSizeSource, Selection};
use super::plane::Plane;
use super::read::{PictureError, read_picture};
use super::region::Window;
use super::report::{
    ShapeReport, USUAL_AREAS_UM2, impossible_size, pixels_on_frame, shape_report_of, unusual_area,
};
use super::segment::{
    self, Choice, Confidence, Modality, SegmentError, Segmentation, SegmentationSettings, counted,
    segment,
};
use myospring_core::interruption::{Interrupted, Interruption};
use myospring_core::mesh::lattice::FEWEST_PIXELS;
use myospring_core::mesh::mask::{Mask, MaskError};
use myospring_core::mesh::outline::Outline;
use myospring_core::mesh::pixel_size::PixelSize;

/// Relative difference between the given pixel size and the picture's own above which a note is
/// written.
const SAME_PIXEL_SIZE: f64 = 0.01;

/// What to look for in a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureOptions {
    /// Which plane of the picture.
    pub selection: Selection,
    /// Side of one pixel; `None` uses the picture's own.
    pub pixel_size: Option<PixelSize>,
    /// How to find cells.
    pub segmentation: SegmentationSettings,
    /// Smallest and largest expected area of a cell, um^2; cells outside are warned about, and
    /// studies leave them out.
    pub areas_um2: [f64; 2],
}

impl Default for PictureOptions {
    /// The picture's own pixel size, and the usual areas of single heart cells.
    fn default() -> Self {
        Self {
            selection: Selection::default(),
            pixel_size: None,
            segmentation: SegmentationSettings::default(),
            areas_um2: USUAL_AREAS_UM2,
        }
    }
}

/// Why a picture gives no cell.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CellError {
    /// The work was ended early.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// The picture cannot be read.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Neither the picture nor the caller states a pixel size.
    #[error(
        "the picture does not say how large its pixels are; give the side of one, like --pixel-size \"0.27 um\" \
         (the microscope's software shows it; it is the camera's pixel over the magnification)"
    )]
    NoPixelSize,
    /// Segmentation found no cell, or not the one that was asked for.
    #[error(transparent)]
    Segment(#[from] SegmentError),
    /// The cell is too small.
    #[error(
        "cell {number} has only {pixels} pixels ({area_um2:.3} um^2); at least {FEWEST_PIXELS} are needed: is this the \
         right picture, cell or label?"
    )]
    TooSmall {
        /// Its number.
        number: u32,
        /// How many pixels it has.
        pixels: usize,
        /// Their area, um^2.
        area_um2: f64,
    },
    /// The pixels of the cell have no valid outline.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// The file of outlines cannot be used.
    #[error(transparent)]
    Outlines(#[from] OutlineFileError),
    /// The picture's size is out of range.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The outline covers no pixel of the picture.
    #[error("the outline `{name}` cannot be laid over the picture: {cause}")]
    Rasterise {
        /// Its name.
        name: String,
        /// What is wrong.
        cause: MaskError,
    },
}

/// A picture with its cells.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureCells {
    /// The plane in which cells were searched.
    pub plane: Plane,
    /// Side of one pixel.
    pub pixel_size: PixelSize,
    /// Where the pixel size comes from, in words.
    pub pixel_size_source: &'static str,
    /// Warnings about the picture.
    pub notes: Vec<String>,
    /// What ends reading its fibres early.
    pub interruption: Interruption,
    areas_um2: [f64; 2],
    /// The pixels that were painted over because they belong to a burned-in mark.
    marks: Option<Arc<Vec<bool>>>,
    cells: Cells,
}

/// Where the cells come from.
#[derive(Debug, Clone, PartialEq)]
enum Cells {
    /// Shared between copies of the value, since masks are as large as the picture.
    Found {
        found: Arc<Segmentation>,
        /// Bounding window of each cell; cell numbers count from 1.
        windows: Vec<Window>,
    },
    /// Largest first.
    Given(GivenOutlines),
}

/// One cell of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureCell {
    /// Its number; 1 is the largest cell of the picture.
    pub number: u32,
    /// Its name: that of a given outline, of a label, else its number.
    pub name: String,
    /// Its outline, um from the lower left corner of the picture.
    pub outline: Outline,
    /// Its pixels.
    pub mask: Mask,
    /// Its size and shape, with warnings.
    pub shape: ShapeReport,
    /// How certain the outline is.
    pub confidence: Confidence,
}

impl PictureCell {
    /// Warnings about the outline, one sentence each.
    pub fn warnings(&self) -> impl Iterator<Item = String> + '_ {
        self.confidence.warning().into_iter().chain(self.shape.warnings.iter().cloned())
    }
}

impl PictureCells {
    /// Reads a picture and finds its cells.
    ///
    /// # Errors
    /// A picture that cannot be read, no pixel size, or no cell.
    ///
    /// # Example
    /// ```
    /// use myospring::microscopy::cells::{PictureOptions, PictureCells};
    /// let error = PictureCells::find(b"no picture", &PictureOptions::default()).unwrap_err();
    /// assert!(error.to_string().starts_with("this is not a picture"));
    /// ```
    pub fn find(bytes: &[u8], options: &PictureOptions) -> Result<Self, CellError> {
        let mut seen = Self::unsegmented(bytes, options)?;
        let [least, _] = options.areas_um2;
        let mut settings = options.segmentation.clone();
        settings.smallest_cell_um2 = settings.smallest_cell_um2.min(least);
        let found = segment(&seen.plane, seen.pixel_size, &settings)?;
        seen.notes.extend(found.notes.iter().cloned());
        settings.interruption.check()?;
        let windows = found.windows();
        seen.cells = Cells::Found { found: Arc::new(found), windows };
        Ok(seen)
    }

    /// Reads a picture and the outlines that a file of outlines has for it.
    ///
    /// # Errors
    /// A picture or outlines that cannot be read, no pixel size, or outlines outside the picture.
    pub fn with_outlines(
        bytes: &[u8],
        outlines: &[u8],
        file_name: &str,
        options: &PictureOptions,
    ) -> Result<Self, CellError> {
        let mut seen = Self::unsegmented(bytes, options)?;
        let placement = Placement::Picture(seen.frame()?);
        let reading = ReadOptions { placement, silent_unit: CoordinateUnit::default() };
        let mut given = read_outlines(outlines, file_name, &reading)?;
        given.sort_by_area();
        seen.notes.append(&mut given.notes);
        seen.cells = Cells::Given(given);
        Ok(seen)
    }

    /// A picture with a cell whose outline is known, um.
    ///
    /// # Errors
    /// An outline beside the picture.
    pub fn with_outline(
        plane: Plane,
        pixel_size: PixelSize,
        outline: Outline,
    ) -> Result<(Self, PictureCell), CellError> {
        let outlines = vec![NamedOutline { name: "1".to_owned(), outline }];
        let seen = Self {
            plane,
            pixel_size,
            pixel_size_source: "given",
            notes: Vec::new(),
            interruption: Interruption::default(),
            areas_um2: USUAL_AREAS_UM2,
            marks: None,
            cells: Cells::Given(GivenOutlines { outlines, notes: Vec::new() }),
        };
        let cell = seen.cell(Choice::Largest, true)?;
        Ok((seen, cell))
    }

    /// Reads a picture without segmenting it, so that it can be shown when no cell was found.
    ///
    /// # Errors
    /// A picture that cannot be read, or no pixel size.
    pub fn unsegmented(bytes: &[u8], options: &PictureOptions) -> Result<Self, CellError> {
        let interruption = &options.segmentation.interruption;
        let picture = read_picture(bytes, &options.selection)?;
        let (mut plane, mut notes) = (picture.plane, picture.notes);
        let mut marks = None;
        interruption.check()?;
        if !segment::is_taken_for_mask(&plane, &options.segmentation) {
            if let Some((cooled, note)) = hot_pixels::cooled(&plane) {
                plane = cooled;
                notes.push(note);
            }
            interruption.check()?;
            let channels = picture.coloured.then(|| channels(bytes, &options.selection)).flatten();
            let found = burned_in::found(&plane, channels.as_ref(), interruption)?;
            if let Some(found) = found {
                plane = found.plane;
                notes.push(found.note);
                marks = Some(Arc::new(found.marks));
            }
        }
        let (pixel_size, pixel_size_source) = match (options.pixel_size, picture.pixel_size) {
            (Some(given), own) => {
                if let Some(own) = own
                    && (own.size.um() / given.um() - 1.0).abs() > SAME_PIXEL_SIZE
                {
                    notes.push(format!(
                        "the picture says that its pixels are {:.4} um wide ({}), but {given} was given and is used",
                        own.size.um(),
                        words(own.source)
                    ));
                }
                (given, "given")
            }
            (None, Some(own)) => (own.size, words(own.source)),
            (None, None) => return Err(CellError::NoPixelSize),
        };
        let cells = Cells::Given(GivenOutlines { outlines: Vec::new(), notes: Vec::new() });
        let areas_um2 = options.areas_um2;
        let interruption = interruption.clone();
        Ok(Self {
            plane,
            pixel_size,
            pixel_size_source,
            notes,
            interruption,
            areas_um2,
            marks,
            cells,
        })
    }

    /// The picture's frame, which turns pixels into um.
    ///
    /// # Errors
    /// A picture of no pixels or too many.
    pub fn frame(&self) -> Result<PixelFrame, CellError> {
        Ok(PixelFrame::new(self.plane.width(), self.plane.height(), self.pixel_size)?)
    }

    /// How many cells there are.
    pub fn len(&self) -> usize {
        match &self.cells {
            Cells::Found { found, .. } => found.cells.len(),
            Cells::Given(given) => given.outlines.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How the cells were found, in words: `fluorescence picture, pixels of 0.27 um (given), threshold 120.5`.
    pub fn method(&self) -> String {
        let (size, source) = (self.pixel_size, self.pixel_size_source);
        let found = self.segmentation().filter(|found| found.threshold != 0.0);
        let threshold = found.map(|found| format!(", threshold {:.4}", found.threshold));
        let threshold = threshold.unwrap_or_default();
        let modality = self.modality();
        let reason = self.modality_reason();
        let reason = reason.map(|reason| format!("; treated as {modality} because {reason}"));
        let reason = reason.unwrap_or_default();
        format!("{modality} picture, pixels of {size} ({source}){threshold}{reason}")
    }

    /// Warns of a cell whose area lies outside [`PictureOptions::areas_um2`]; `None` for a usual one.
    pub fn unusual_area(&self, cell: &PictureCell) -> Option<String> {
        unusual_area(cell.shape.area_um2, self.areas_um2)
    }

    /// Why the cell's size is impossible for a heart cell, as the predicate of a sentence; `None`
    /// if it is possible. The area of a cell that the user pointed at is not checked.
    pub fn impossible_size(&self, cell: &PictureCell, pointed_at: bool) -> Option<String> {
        let ShapeReport { area_um2, dimensions, .. } = &cell.shape;
        let areas_um2 = if pointed_at { [0.0, f64::INFINITY] } else { self.areas_um2 };
        impossible_size(dimensions.length_um, *area_um2, areas_um2)
    }

    /// The segmentation; `None` where outlines were given.
    pub fn segmentation(&self) -> Option<&Segmentation> {
        match &self.cells {
            Cells::Found { found, .. } => Some(found),
            Cells::Given(_) => None,
        }
    }

    /// The modality in one word: that of the segmentation, or `outline` for given outlines.
    pub fn modality(&self) -> &'static str {
        self.segmentation().map_or("outline", |found| found.modality.seen_as())
    }

    /// Why the picture was treated as this modality, in words; `None` if the user stated it.
    pub fn modality_reason(&self) -> Option<&str> {
        self.segmentation()?.modality_reason.as_deref()
    }

    /// One cell.
    ///
    /// # Errors
    /// No such cell, one that the frame cuts while `allow_cut` is false, or pixels that make no outline.
    pub fn cell(&self, choice: Choice, allow_cut: bool) -> Result<PictureCell, CellError> {
        let frame = self.frame()?;
        match &self.cells {
            Cells::Found { found, windows } => {
                let cell = found.choose(choice, allow_cut)?;
                if cell.pixels < FEWEST_PIXELS {
                    let segment::SegmentedCell { number, pixels, area_um2, .. } = *cell;
                    return Err(CellError::TooSmall { number, pixels, area_um2 });
                }
                let mask = found.mask_within(cell.number, &windows[cell.number as usize - 1])?;
                let edge =
                    if found.modality == Modality::Mask { Edge::Exact } else { Edge::Smooth };
                let outline = trace_mask(&mask, edge)?;
                let name = found.name(cell);
                let confidence = cell.confidence.clone();
                let on_frame = cell.pixels_on_the_frame;
                let shape = shape_report_of(&outline, on_frame, self.areas_um2, &confidence);
                Ok(PictureCell { number: cell.number, name, outline, mask, shape, confidence })
            }
            Cells::Given(given) => {
                let at = self.given_at(given, choice, frame)?;
                let NamedOutline { name, outline } = given.outlines[at].clone();
                let mask = rasterise(&outline, &frame)
                    .map_err(|cause| CellError::Rasterise { name: name.clone(), cause })?;
                let number = at as u32 + 1;
                let confidence = Confidence::full();
                let on_frame = pixels_on_frame(&outline, &frame);
                let shape = shape_report_of(&outline, on_frame, self.areas_um2, &confidence);
                Ok(PictureCell { number, name, outline, mask, shape, confidence })
            }
        }
    }

    fn given_at(
        &self,
        given: &GivenOutlines,
        choice: Choice,
        frame: PixelFrame,
    ) -> Result<usize, SegmentError> {
        let count = given.outlines.len();
        let numbered = |number| {
            let none = SegmentError::NoSuchCell { number, cells: counted(count) };
            given.numbered(number).ok_or(none)
        };
        match choice {
            Choice::Largest => numbered(1),
            Choice::Number(number) => numbered(number),
            Choice::Label(label) => {
                let none = SegmentError::NoSuchLabel { label, labels: given.names() };
                given.labelled(label).ok_or(none)
            }
            Choice::At(place) => {
                let point = geo::Point::from(frame.to_um(place));
                // 0 within.
                let distance = |cell: &NamedOutline| {
                    let ring: geo::LineString = cell.outline.exterior().iter().copied().collect();
                    geo::Euclidean.distance(&point, &geo::Polygon::new(ring, Vec::new()))
                };
                let distances = given.outlines.iter().map(distance).enumerate();
                let nearest = distances.min_by(|a, b| a.1.total_cmp(&b.1));
                if let Some((at, 0.0)) = nearest {
                    return Ok(at);
                }
                let name = |(at, _): (usize, f64)| format!("`{}`", given.outlines[at].name);
                let nearest = nearest.map(name).unwrap_or_default();
                let (width, height) = (self.plane.width(), self.plane.height());
                let [x, y] = place;
                Err(SegmentError::NotThere { x, y, width, height, nearest })
            }
        }
    }

    /// The outlines of all cells with their names, largest first; cells without a valid outline are
    /// left out.
    pub fn outlines(&self) -> Vec<NamedOutline> {
        match &self.cells {
            Cells::Given(given) => given.outlines.clone(),
            Cells::Found { found, .. } => found
                .cells
                .iter()
                .filter_map(|cell| self.cell(Choice::Number(cell.number), true).ok())
                .map(|PictureCell { name, outline, .. }| NamedOutline { name, outline })
                .collect(),
        }
    }

    /// Warnings about the direction of the fibres, one sentence each.
    pub fn fibre_warnings(&self, field: &FibreField) -> Vec<String> {
        let mut warnings = field.warnings();
        let modality = self.segmentation().map(|found| found.modality);
        if modality == Some(Modality::Brightfield) {
            warnings.push(
                "the fibres were read from a brightfield picture, where rows of organelles and folds count as stripes \
                 too; compare them with the overlay, or take a stain of z-discs or filaments"
                    .to_owned(),
            );
        }
        warnings
    }

    /// The direction of the fibres in one cell, as the picture shows it; `long_axis` is used where
    /// it shows none.
    ///
    /// # Errors
    /// Pixels too coarse to show myofibrils, or settings out of range.
    pub fn fibres(
        &self,
        cell: &PictureCell,
        long_axis: [f64; 2],
        settings: &FibreSettings,
    ) -> Result<FibreField, FibreError> {
        let inside = cell.mask.inside();
        let (plane, interruption) = (&self.plane, &self.interruption);
        fibres_interruptible(plane, &inside, self.pixel_size, long_axis, settings, interruption)
    }

    /// The direction of the fibres in the whole picture, without the outline of a cell; the x axis
    /// is used where it shows none. Burned-in marks are left out.
    ///
    /// # Errors
    /// Pixels too coarse to show myofibrils, or settings out of range.
    pub fn fibres_of_frame(&self, settings: &FibreSettings) -> Result<FibreField, FibreError> {
        let pixels = self.plane.values().len();
        let inside: Vec<bool> = match &self.marks {
            Some(marks) => marks.iter().map(|mark| !mark).collect(),
            None => vec![true; pixels],
        };
        let (plane, interruption) = (&self.plane, &self.interruption);
        fibres_interruptible(plane, &inside, self.pixel_size, [1.0, 0.0], settings, interruption)
    }
}

/// Red, green and blue of a colour picture; `None` if a channel was selected.
fn channels(bytes: &[u8], selection: &Selection) -> Option<[Plane; 3]> {
    if selection.channel.is_some() {
        return None;
    }
    let of = |channel| {
        let selection = Selection { channel: Some(channel), ..*selection };
        Some(read_picture(bytes, &selection).ok()?.plane)
    };
    Some([of(0)?, of(1)?, of(2)?])
}

fn words(source: PixelSizeSource) -> &'static str {
    match source {
        PixelSizeSource::OmeXml => "OME-XML",
        PixelSizeSource::ImageJ => "ImageJ's description",
        PixelSizeSource::TiffResolution => "TIFF resolution",
        PixelSizeSource::PngResolution => "PNG resolution",
    }
}
