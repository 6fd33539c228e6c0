//! Meaning of a file's pages, from OME-XML, ImageJ's description, or neither.

use super::directory::{Directory, File, Tag};
use super::imagej::{self, ImageJ};
use super::ome::{self, Ome};
use super::page::{self, Page};
use super::planes::{Axis, Planes};
use crate::picture::{PixelSizeSource, Selection};
use crate::read::PictureError;
use crate::read::error::damaged_tiff;
use crate::read::pixel_size::Stated;

/// Meaning of a file's pages, and its statements of the pixel size.
pub(super) struct Stack {
    pub(super) planes: Planes,
    /// The page of each number in `planes`.
    pages: Vec<usize>,
    /// Statements of the size of a pixel, the most trustworthy first.
    pub(super) sizes: Vec<Stated>,
    /// Distance of two slices, um, if the file states it, and where.
    pub(super) z_step: Option<(f64, PixelSizeSource)>,
    /// Time between two frames, s, if the file states it.
    pub(super) frame_interval_s: Option<f64>,
}

impl Stack {
    pub(super) fn new(
        file: &File,
        directories: &[Directory],
        first: &Page,
        selection: &Selection,
        notes: &mut Vec<String>,
    ) -> Result<Self, PictureError> {
        let description = file.text(&directories[0], Tag::Description).unwrap_or_default();
        let per_unit =
            [Tag::XResolution, Tag::YResolution].map(|tag| file.fraction(&directories[0], tag));
        let mut sizes = Vec::new();
        let mut pages: Vec<usize> = (0..directories.len()).collect();
        note_other_stacks(file, &directories[0], notes);
        if ome::is_ome(&description) {
            let ome = Ome::read(&description)?;
            sizes.extend(ome.pixel_size());
            sizes.extend(resolution(file, &directories[0], per_unit));
            if ome.images > 1 {
                notes.push(format!("the first of {} images in the file was taken", ome.images));
            }
            let planes = ome.planes(pages.len() as u64, u64::from(first.channels()));
            if let Some(planes) = planes.filter(|_| ome.images > 0) {
                let frame_interval_s = ome.frame_interval_s();
                let z_step = ome.z_step_um().map(|um| (um, PixelSizeSource::OmeXml));
                return Ok(Self { planes, pages, sizes, z_step, frame_interval_s });
            }
        }
        pages.retain(|&page| {
            page::size(file, &directories[page])
                .is_ok_and(|size| size == (first.width, first.height))
        });
        let left_out = directories.len() - pages.len();
        if left_out > 0 {
            notes.push(format!("{left_out} pages of another size than the first were left out"));
        }
        let count = pages.len() as u64;
        let imagej = ImageJ::read(&description);
        let mut planes = None;
        if let Some(imagej) = &imagej {
            sizes.extend(imagej.pixel_size(per_unit));
            let stated = imagej.planes(count)?;
            if stated.is_none() && imagej.says_axes() {
                let words = imagej.words();
                notes.push(format!(
                    "ImageJ's description says {words}, but the file has {count} pages"
                ));
            }
            planes = stated.filter(|_| imagej.says_axes());
        }
        sizes.extend(resolution(file, &directories[0], per_unit));
        if planes.is_none() && count > 1 {
            let meaning = if selection.depth.is_some() { "slices" } else { "frames" };
            notes.push(format!(
                "the file does not say what its {count} pages are; they were taken as {meaning}"
            ));
        }
        let axis = if selection.depth.is_some() { Axis::Slice } else { Axis::Frame };
        let planes = planes.or_else(|| imagej::series(axis, count));
        let planes = planes.ok_or_else(|| damaged_tiff(format!("it has {count} pages")))?;
        let frame_interval_s = imagej.as_ref().and_then(ImageJ::frame_interval_s);
        let z_step = imagej.as_ref().and_then(ImageJ::z_step_um);
        let z_step = z_step.map(|um| (um, PixelSizeSource::ImageJ));
        Ok(Self { planes, pages, sizes, z_step, frame_interval_s })
    }

    /// The page of the file that contains a plane.
    pub(super) fn page(
        &self,
        channel: usize,
        slice: usize,
        frame: usize,
    ) -> Result<usize, PictureError> {
        let page = self.planes.page(channel, slice, frame, self.pages.len())?;
        Ok(self.pages[page])
    }
}

/// Notes stacks that other programs store outside the list of pages.
fn note_other_stacks(file: &File, directory: &Directory, notes: &mut Vec<String>) {
    let planes = directory.count(Tag::MetaMorphPlanes);
    if planes > 1 {
        notes.push(format!(
            "a MetaMorph stack of {planes} planes: only the first is read; export it as OME-TIFF for the \
             others"
        ));
    }
    if file.integer(directory, Tag::ZeissLsm, 0).is_some() {
        notes.push(
            "a Zeiss LSM file: its pages count as frames, its pixel size is not read; export it as \
             OME-TIFF for both"
                .to_owned(),
        );
    }
}

/// Size of a pixel from the resolution tags, where their unit is a length (TIFF 6.0, section 8).
fn resolution(file: &File, directory: &Directory, per_unit: [Option<f64>; 2]) -> Option<Stated> {
    let unit_um = match file.integer(directory, Tag::ResolutionUnit, 0).unwrap_or(2) {
        2 => 25_400.0,
        3 => 10_000.0,
        _ => return None,
    };
    let [x_um, y_um] =
        per_unit.map(|count| count.filter(|&count| count > 0.0).map(|count| unit_um / count));
    let source = PixelSizeSource::TiffResolution;
    Some(Stated { x_um: x_um?, y_um: y_um.or(x_um)?, source })
}
