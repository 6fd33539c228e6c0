//! The direction of the myofibrils in each slice, and how it turns from the lowest to the highest.

use super::error::StackError;
use super::options::{FirstSlice, StackOptions};
use super::reading::{Scale, Stack};
use crate::fibres::{FibreField, FibreSettings, fibres_interruptible};
use myospring_core::analysis::order::median;
use myospring_core::mesh::voxels::Voxels;
use serde::Serialize;

/// Least part of a slice's area in which the picture shows fibres.
const LEAST_SHARE: f64 = 0.2;
/// Distance of places over which directions are averaged, um.
const SPACING_UM: f64 = 1.0;
/// Fewest slices with a direction for a turn.
const FEWEST_SLICES: usize = 3;
/// Fewest pixels of a slice.
const FEWEST_PIXELS: usize = 100;
/// Slices nearer than this show the same section, um: about the thickness of an optical section.
const SECTION_UM: f64 = 1.0;

/// Fibres of one slice.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SliceFibre {
    /// Number of the slice in the file, from 0.
    pub slice: usize,
    /// Height of its middle above the lower face of the lowest slice, um.
    pub height_um: f64,
    /// Mean direction, degrees counter-clockwise from x, above -90 and up to 90; `None` if the picture
    /// shows none.
    pub angle_deg: Option<f64>,
    /// Standard error of the mean direction, degrees.
    pub error_deg: Option<f64>,
    /// Part of the cell's area in this slice in which the picture shows fibres, 0 to 1.
    pub share_from_picture: f64,
    /// Median length of the sarcomeres in this slice, um.
    pub sarcomere_um: Option<f64>,
}

/// How far the fibres turn through the thickness.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HelixAngle {
    /// Turn from the lowest to the highest slice with a direction, degrees counter-clockwise seen
    /// from above, from a straight line through the directions of all of them.
    pub turn_deg: f64,
    /// Its standard error, degrees, from the scatter around the line; slices within 1 um of each
    /// other count as one.
    pub error_deg: f64,
    /// Heights of these two slices, um.
    pub heights_um: [f64; 2],
    /// Number of slices with a direction.
    pub slices: usize,
}

/// Fibres of all slices through a cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StackFibres {
    /// The slices, from the lowest.
    pub slices: Vec<SliceFibre>,
    /// The turn; `None` if fewer than three slices show a direction.
    pub helix: Option<HelixAngle>,
    /// What is not known, one sentence each.
    pub warnings: Vec<String>,
    /// Heights of the slices with a direction, um, from the lowest, and the direction everywhere in them.
    #[serde(skip)]
    fields: Vec<(f64, FibreField)>,
}

impl StackFibres {
    /// Median length of the sarcomeres over the slices that show some, um.
    pub fn sarcomere_um(&self) -> Option<f64> {
        median(self.slices.iter().filter_map(|slice| slice.sarcomere_um))
    }

    /// Number of slices that show a direction.
    pub fn shown(&self) -> usize {
        self.slices.iter().filter(|slice| slice.angle_deg.is_some()).count()
    }

    /// Whether any slice shows a direction.
    pub fn is_shown(&self) -> bool {
        !self.fields.is_empty()
    }

    /// The field of the middle one of the slices that show a direction, and its height, um.
    pub fn middle(&self) -> Option<(f64, &FibreField)> {
        self.fields.get(self.fields.len() / 2).map(|(height, field)| (*height, field))
    }

    /// The direction at a point (um; y and z upward), a unit vector: between two slices with a direction it turns evenly from one to the other,
    /// below the lowest and above the highest it is theirs. `None` if no slice shows one.
    pub fn at(&self, [x, y, z]: [f64; 3]) -> Option<[f64; 2]> {
        let above = self.fields.partition_point(|(height, _)| *height <= z);
        let (low, low_field) = self.fields.get(above.saturating_sub(1))?;
        let (high, high_field) = self.fields.get(above).or(self.fields.last())?;
        let [low_angle, high_angle] =
            [low_field, high_field].map(|field| field.at([x, y]).angle_deg());
        let part = if high > low { (z - low) / (high - low) } else { 0.0 };
        // The shorter way round.
        let turn = high_angle - low_angle;
        let turn = turn - 180.0 * (turn / 180.0).round();
        let (sine, cosine) = (low_angle + part * turn).to_radians().sin_cos();
        Some([cosine, sine])
    }
}

/// What is read of a slice, and how.
struct Reader<'a> {
    stack: &'a Stack,
    voxels: &'a Voxels,
    long_axis: [f64; 2],
    settings: &'a FibreSettings,
    options: &'a StackOptions,
    scale: Scale,
}

impl Reader<'_> {
    /// The cell in a slice, counted from the lowest.
    fn inside(&self, level: usize) -> Vec<bool> {
        let parts = self.voxels.shape()[2] / self.stack.slices();
        slice_mask(self.voxels, level * parts + parts / 2)
    }

    /// The number of a slice in the file.
    fn slice(&self, level: usize) -> usize {
        match self.options.first_slice {
            FirstSlice::Bottom => level,
            FirstSlice::Top => self.stack.slices() - 1 - level,
        }
    }

    fn field(&self, level: usize, inside: &[bool]) -> Result<FibreField, StackError> {
        let plane = self.stack.slice(self.slice(level))?;
        let interruption = &self.options.segmentation.interruption;
        let (pixel_size, axis) = (self.scale.pixel_size, self.long_axis);
        Ok(fibres_interruptible(&plane, inside, pixel_size, axis, self.settings, interruption)?)
    }
}

impl Stack {
    /// The direction of the myofibrils in each slice of a cell from [`Stack::cell`].
    ///
    /// Each slice is read as a picture of its own ([`fibres`](crate::fibres::fibres)); the mean is
    /// over all places that show a direction. `long_axis` (of any length, y upward) is only the
    /// direction near which stripes are sought.
    ///
    /// # Errors
    /// Slices that cannot be read, pixels too coarse for myofibrils, voxels of another stack,
    /// settings out of range.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::{pixel_size::PixelSize, voxels::Voxels};
    /// use myospring::microscopy::fibres::{FibreSettings, Stain};
    /// use myospring::microscopy::stack::{Stack, StackOptions, StackSelection};
    /// # use tiff::encoder::{TiffEncoder, colortype::Gray8};
    /// # let mut file = std::io::Cursor::new(Vec::new());
    /// # let mut encoder = TiffEncoder::new(&mut file)?;
    /// # for slice in 0..4 {
    /// #     let (sine, cosine) = (10.0 * f64::from(slice)).to_radians().sin_cos();
    /// #     let wave = |at: usize| 0.25 * ((at % 120) as f64 * cosine - (at / 120) as f64 * sine) / 1.8;
    /// #     let grey = |at: usize| (120.0 + 90.0 * (std::f64::consts::TAU * wave(at)).sin()) as u8;
    /// #     let values: Vec<u8> = (0..120 * 100).map(grey).collect();
    /// #     encoder.write_image::<Gray8>(120, 100, &values)?;
    /// # }
    /// # let bytes = file.into_inner();
    /// // Z-discs 1.8 um apart in four slices; from slice to slice the fibres turn by 10 degrees.
    /// let stack = Stack::read(bytes, &StackSelection::default())?;
    /// let inside = (0..120 * 100 * 4).map(|at| at > 0).collect();
    /// let cell = Voxels::new([120, 100, 4], [0.25, 0.25, 2.0], inside)?;
    /// let options = StackOptions {
    ///     pixel_size: Some(PixelSize::new(0.25)?),
    ///     z_step_um: Some(2.0),
    ///     ..StackOptions::default()
    /// };
    /// let fibres = stack.fibres(&cell, [1.0, 0.0], &FibreSettings::of(Stain::ZDisc), &options)?;
    /// let helix = fibres.helix.unwrap();
    /// assert!((helix.turn_deg - 30.0).abs() < 2.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn fibres(
        &self,
        voxels: &Voxels,
        long_axis: [f64; 2],
        settings: &FibreSettings,
        options: &StackOptions,
    ) -> Result<StackFibres, StackError> {
        let reader = self.reader(voxels, long_axis, settings, options)?;
        let scale = reader.scale;
        let (mut slices, mut fields) = (Vec::new(), Vec::new());
        for level in 0..self.slices() {
            let inside = reader.inside(level);
            if inside.iter().filter(|&&inside| inside).count() < FEWEST_PIXELS {
                continue;
            }
            let field = reader.field(level, &inside)?;
            let height_um = (level as f64 + 0.5) * scale.z_step_um;
            let found = mean_direction(reader.slice(level), height_um, &field, settings);
            if found.angle_deg.is_some() {
                fields.push((height_um, field));
            }
            slices.push(found);
        }
        let helix = turn(&slices, scale.z_step_um);
        let mut warnings = warnings(&slices, helix);
        let middle = fields.get(fields.len() / 2);
        warnings.extend(middle.into_iter().flat_map(|(_, field)| field.doubts()));
        Ok(StackFibres { slices, helix, warnings, fields })
    }

    /// The fibres in the slice in which the cell from [`Stack::cell`] has its largest area; as [`Stack::fibres`], in the time of one slice.
    ///
    /// # Errors
    /// As of [`Stack::fibres`].
    pub fn fibres_of_widest(
        &self,
        voxels: &Voxels,
        long_axis: [f64; 2],
        settings: &FibreSettings,
        options: &StackOptions,
    ) -> Result<FibreField, StackError> {
        let reader = self.reader(voxels, long_axis, settings, options)?;
        let pixels = |inside: &[bool]| inside.iter().filter(|&&inside| inside).count();
        let widest = (0..self.slices()).max_by_key(|&level| pixels(&reader.inside(level)));
        let level = widest.unwrap_or(0);
        reader.field(level, &reader.inside(level))
    }

    fn reader<'a>(
        &'a self,
        voxels: &'a Voxels,
        long_axis: [f64; 2],
        settings: &'a FibreSettings,
        options: &'a StackOptions,
    ) -> Result<Reader<'a>, StackError> {
        let scale = self.scale(options)?;
        let [width, height, layers] = voxels.shape();
        if [width, height] != self.size() || layers == 0 || layers % self.slices() != 0 {
            return Err(StackError::OtherStack { voxels: voxels.shape(), stack: self.size() });
        }
        Ok(Reader { stack: self, voxels, long_axis, settings, options, scale })
    }
}

/// One layer of a cell, row by row from the top of the picture.
fn slice_mask(voxels: &Voxels, layer: usize) -> Vec<bool> {
    let [width, height, _] = voxels.shape();
    let block = voxels.block();
    let mut mask = vec![false; width * height];
    let Some(z) = layer.checked_sub(block.first[2]).filter(|&z| z < block.size[2]) else {
        return mask;
    };
    let [columns, rows, _] = block.size;
    let slice = &block.inside[z * columns * rows..][..columns * rows];
    for (y, line) in slice.chunks_exact(columns).enumerate() {
        let row = height - 1 - block.first[1] - y;
        mask[row * width + block.first[0]..][..columns].copy_from_slice(line);
    }
    mask
}

fn mean_direction(
    slice: usize,
    height_um: f64,
    field: &FibreField,
    settings: &FibreSettings,
) -> SliceFibre {
    let summary = field.summary();
    let share_from_picture = summary.share_from_picture;
    let places = field.on_grid(SPACING_UM);
    let shown = places.iter().map(|(_, fibre)| fibre).filter(|fibre| fibre.from_picture);
    // Directions are lines without sign, so doubled angles are averaged.
    let [mut x, mut y, mut count] = [0.0; 3];
    for fibre in shown {
        let (sine, cosine) = (2.0 * fibre.angle_deg().to_radians()).sin_cos();
        (x, y, count) = (x + cosine, y + sine, count + 1.0);
    }
    let order = x.hypot(y) / f64::max(count, 1.0);
    let is_shown = share_from_picture >= LEAST_SHARE && order > 0.0;
    // Directions are averaged over a Gaussian, within which they are one.
    let independent = count * SPACING_UM * SPACING_UM
        / (4.0 * std::f64::consts::PI * settings.smoothing_um.powi(2));
    let scatter = 0.5 * (-2.0 * order.min(1.0).ln()).max(0.0).sqrt().to_degrees();
    SliceFibre {
        slice,
        height_um,
        angle_deg: is_shown.then(|| 0.5 * y.atan2(x).to_degrees()),
        error_deg: is_shown.then(|| scatter / independent.max(1.0).sqrt()),
        share_from_picture,
        sarcomere_um: summary.median_sarcomere_um,
    }
}

/// The straight line through the directions over height.
fn turn(slices: &[SliceFibre], z_step_um: f64) -> Option<HelixAngle> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    for slice in slices {
        let Some(angle) = slice.angle_deg else { continue };
        // The nearest of all equal directions to that of the slice below.
        let angle = points
            .last()
            .map_or(angle, |&[_, below]| angle - 180.0 * ((angle - below) / 180.0).round());
        points.push([slice.height_um, angle]);
    }
    let ([first, ..], [.., last]) = (points.as_slice(), points.as_slice()) else { return None };
    if points.len() < FEWEST_SLICES {
        return None;
    }
    let count = points.len() as f64;
    let mean = [0, 1].map(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / count);
    let sum = |of: &dyn Fn(&[f64; 2]) -> f64| points.iter().map(of).sum::<f64>();
    let xx = sum(&|[x, _]| (x - mean[0]).powi(2));
    let slope = sum(&|[x, y]| (x - mean[0]) * (y - mean[1])) / xx;
    let squares = sum(&|[x, y]| (y - mean[1] - slope * (x - mean[0])).powi(2));
    let span = last[0] - first[0];
    let same = (SECTION_UM / z_step_um).max(1.0);
    Some(HelixAngle {
        turn_deg: slope * span,
        error_deg: (same * squares / (count - 2.0) / xx).sqrt() * span,
        heights_um: [first[0], last[0]],
        slices: points.len(),
    })
}

fn warnings(slices: &[SliceFibre], helix: Option<HelixAngle>) -> Vec<String> {
    let shown = slices.iter().filter(|slice| slice.angle_deg.is_some()).count();
    let mut warnings = Vec::new();
    if shown < slices.len() {
        warnings.push(format!(
            "{} of {} slices show no fibres in a fifth of the cell's area or more",
            slices.len() - shown,
            slices.len()
        ));
    }
    if helix.is_none() {
        warnings.push(format!(
            "the turn of the fibres through the thickness is not known: it needs {FEWEST_SLICES} slices with a direction"
        ));
    }
    warnings
}
