//! From a stack to one cell in it.

use super::error::StackError;
use super::options::StackOptions;
use super::reading::Stack;
use super::report::StackReport;
use super::{bright, labels, load};
use crate::segment::Modality;
use myospring_core::mesh::pixel_size::PixelSize;
use myospring_core::mesh::voxels::Voxels;

/// Largest relative difference between a given length and that of the file that is not noted.
const SAME: f64 = 0.01;

impl Stack {
    /// The voxels of one cell, with a report.
    ///
    /// Voxels from a mask have the sides of the file's. Those from fluorescence are as wide as its
    /// pixels, and finer in z than its slices by a whole number.
    ///
    /// # Errors
    /// A pixel size or z step that nobody states, slices that cannot be read, settings out of
    /// range, no cell, not the one that was asked for, or one that the sides of the picture cut
    /// while [`StackOptions::allow_cut`] is false; brightfield.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::pixel_size::PixelSize;
    /// use myospring::microscopy::stack::{Stack, StackOptions, StackSelection};
    /// # use tiff::encoder::{TiffEncoder, colortype::Gray8};
    /// # let mut file = std::io::Cursor::new(Vec::new());
    /// # let mut encoder = TiffEncoder::new(&mut file)?;
    /// # for slice in 0..6 {
    /// #     let inside = |at: usize| (2..5).contains(&slice) && (3..7).contains(&(at % 10)) && (1..9).contains(&(at / 10));
    /// #     let values: Vec<u8> = (0..100).map(|at| if inside(at) { 255 } else { 0 }).collect();
    /// #     encoder.write_image::<Gray8>(10, 10, &values)?;
    /// # }
    /// # let bytes = file.into_inner();
    /// // A mask of 4 x 8 pixels in three of six slices.
    /// let stack = Stack::read(bytes, &StackSelection::default())?;
    /// let options = StackOptions {
    ///     pixel_size: Some(PixelSize::new(0.5)?),
    ///     z_step_um: Some(2.0),
    ///     ..StackOptions::default()
    /// };
    /// let (voxels, report) = stack.cell(&options)?;
    /// assert_eq!(voxels.volume_um3(), 2.0 * 4.0 * 6.0);
    /// assert_eq!(report.thickness_um, 6.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn cell(&self, options: &StackOptions) -> Result<(Voxels, StackReport), StackError> {
        let scale = self.scale(options)?;
        options.segmentation.interruption.check()?;
        let of_mask = match options.segmentation.modality {
            Modality::Mask => true,
            Modality::Auto => load::is_mask(self)?,
            Modality::Fluorescence => false,
            Modality::Brightfield => return Err(StackError::Brightfield),
        };
        let (voxels, mut report) = if of_mask {
            labels::cell(self, scale, options)?
        } else {
            bright::cell(self, scale, options)?
        };
        report.notes.splice(0..0, self.scale_notes(options));
        report.finish(&voxels, self.slices(), options);
        Ok((voxels, report))
    }

    /// Notes of the file, and on lengths that differ from the file's.
    fn scale_notes(&self, options: &StackOptions) -> Vec<String> {
        let mut notes = self.notes.clone();
        let own = self.pixel_size.map(|stated| stated.size.um());
        let given = options.pixel_size.map(PixelSize::um);
        let pairs = [("pixel size", own, given), ("z step", self.z_step_um, options.z_step_um)];
        for (what, own, given) in pairs {
            if let (Some(own), Some(given)) = (own, given)
                && (own - given).abs() > SAME * own
            {
                notes.push(format!(
                    "the {what} is {given} um as given, but {own:.4} um in the file"
                ));
            }
        }
        notes
    }
}
