//! What was found in a stack, in numbers and in words.

use super::options::{FirstSlice, StackOptions, Stain};
use super::reading::Scale;
use crate::segment::{Choice, Confidence, Modality};
use myospring_core::mesh::voxels::{DroppedParts, Touched, Voxels};
use serde::Serialize;

/// Fewest slices through a cell, and fewest steps across its thickness, without a warning.
const FEW_SLICES: usize = 5;
/// Thicknesses of heart cells, um: flat hiPSC cardiomyocytes have 2 to 5, adult cells 8 to 25.
const USUAL_THICKNESSES_UM: [f64; 2] = [1.5, 40.0];
/// Largest z step at which no slice misses a membrane, um: about the thickness of an optical section.
const MEMBRANE_STEP_UM: f64 = 1.0;
/// Blur along z over the thickness: of a cell without clear edges, and of a clear one.
const BLURRED: [f64; 2] = [1.2, 0.4];
/// Factor of a cell that reaches the lowest or highest slice.
const CUT_IN_DEPTH: f64 = 0.7;
/// Part of the area that is thinner than what counts as the thickness.
const THICKEST: f64 = 0.98;
/// Dropped voxels over those of the cell above which the report warns.
const MUCH_DROPPED: f64 = 0.05;

/// Full width at half maximum, um, of what blurs the edges of a cell; of a sharp picture about 0.3
/// in the plane and 0.8 in depth.
///
/// The edges themselves may be soft, so the microscope's own blur is at most this.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Blur {
    /// In the plane of a slice; `None` if it cannot be measured.
    pub plane_um: Option<f64>,
    /// Along z; `None` if it cannot be measured.
    pub depth_um: Option<f64>,
}

/// What is known of a cell in a stack.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StackReport {
    /// Side of a pixel of the file, um.
    pub pixel_um: f64,
    /// Distance of two slices of the file, um.
    pub z_step_um: f64,
    /// As what the stack was treated.
    pub modality: Modality,
    /// What of the cell is bright; `None` for a mask.
    pub stain: Option<Stain>,
    /// Grey value of the surface at the brightest depth, background included, or the given threshold;
    /// `None` for a mask.
    pub threshold: Option<f64>,
    /// Number of cells among which this one was chosen.
    pub cells: usize,
    /// Volume of the cell, um^3.
    pub volume_um3: f64,
    /// Area seen from above, um^2.
    pub area_um2: f64,
    /// Thickness along z, um, that 2 % of the area exceed: the largest, without the grains of noise.
    pub thickness_um: f64,
    /// Volume over area, um.
    pub mean_thickness_um: f64,
    /// Number of slices of the file through the cell.
    pub slices_in_cell: usize,
    /// Faces of the stack that the cell reaches.
    #[serde(skip)]
    pub touched: Touched,
    /// Parts that are not connected with the cell.
    #[serde(skip)]
    pub dropped: DroppedParts,
    /// Widths of the edges; `None` for a mask, whose edges are not known.
    pub blur: Option<Blur>,
    /// Depth over which brightness falls to 1/e, um, if it falls steadily; it was divided out.
    pub attenuation_um: Option<f64>,
    /// How far the surface was moved inward to the brightest layer of a membrane, um: at the sides,
    /// and at top and bottom.
    pub moved_inward_um: Option<[f64; 2]>,
    /// How certain the outline from above is.
    pub confidence: Confidence,
    /// Notes of the file and on what was assumed, one sentence each.
    pub notes: Vec<String>,
    /// Warnings, one sentence each.
    pub warnings: Vec<String>,
}

impl StackReport {
    pub(super) fn new(scale: Scale, modality: Modality) -> Self {
        Self {
            pixel_um: scale.pixel_size.um(),
            z_step_um: scale.z_step_um,
            modality,
            stain: None,
            threshold: None,
            cells: 0,
            volume_um3: 0.0,
            area_um2: 0.0,
            thickness_um: 0.0,
            mean_thickness_um: 0.0,
            slices_in_cell: 0,
            touched: Touched::default(),
            dropped: DroppedParts::default(),
            blur: None,
            attenuation_um: None,
            moved_inward_um: None,
            confidence: Confidence::full(),
            notes: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// Measures the voxels, and adds notes and warnings.
    pub(super) fn finish(&mut self, voxels: &Voxels, slices: usize, options: &StackOptions) {
        let pitch = voxels.pitch();
        let block = voxels.block();
        let layer = block.size[0] * block.size[1];
        let mut columns = vec![0_usize; layer];
        for slice in block.inside.chunks_exact(layer) {
            for (column, &inside) in columns.iter_mut().zip(slice) {
                *column += usize::from(inside);
            }
        }
        columns.retain(|&column| column > 0);
        columns.sort_unstable();
        let seen = columns.len();
        let thick = (THICKEST * seen.saturating_sub(1) as f64).round() as usize;
        let most = columns.get(thick).copied().unwrap_or(0);
        self.volume_um3 = voxels.volume_um3();
        self.area_um2 = seen as f64 * pitch[0] * pitch[1];
        self.thickness_um = most as f64 * pitch[2];
        self.mean_thickness_um = self.volume_um3 / self.area_um2;
        self.touched = voxels.touches_frame();
        let [[.., low], [.., high]] = voxels.bounds_um();
        let [first, last] = [low / self.z_step_um, high / self.z_step_um];
        // Slices whose middles lie in the cell.
        self.slices_in_cell = ((last + 0.5 - 1e-9).floor() - (first + 0.5 - 1e-9).floor()) as usize;
        self.slices_in_cell = self.slices_in_cell.min(slices);
        if options.first_slice == FirstSlice::Bottom {
            self.notes.push(
                "the first slice of the file was taken as the lowest, next to the support; if it is the highest, \
                 give --first-slice top"
                    .to_owned(),
            );
        }
        if self.cells > 1 && options.choice == Choice::Largest {
            let whole = if options.allow_cut { "" } else { " that the frame does not cut" };
            self.warnings.push(format!(
                "{} cells were found, and the largest{whole} is taken; for the second largest state `segmentation.cell = 2`",
                self.cells
            ));
        }
        self.judge();
        self.warn();
    }

    /// Weighs what may make the cell's extent along z wrong.
    fn judge(&mut self) {
        let thickness = self.thickness_um;
        if let Some(Blur { depth_um: Some(depth), .. }) = self.blur {
            let [much, little] = BLURRED;
            self.confidence.weigh(-depth / thickness, -much, -little, || {
                format!(
                    "its upper and lower edges are blurred over {depth:.1} um, its thickness is {thickness:.1} um"
                )
            });
        }
        if self.touched.lowest_slice || self.touched.highest_slice {
            self.confidence.score *= CUT_IN_DEPTH;
            self.confidence.reasons.push("the lowest or highest slice cuts it".to_owned());
        }
    }

    fn warn(&mut self) {
        let mut warnings = Vec::new();
        let Self { z_step_um, thickness_um, slices_in_cell, touched, dropped, .. } = *self;
        if touched.sides {
            warnings.push(
                "the sides of the picture cut the cell: its length, width, volume and shortening are not those of \
                 a whole cell"
                    .to_owned(),
            );
        }
        let cut = match (touched.lowest_slice, touched.highest_slice) {
            (true, true) => Some("the lowest and the highest slice"),
            (true, false) => Some("the lowest slice"),
            (false, true) => Some("the highest slice"),
            (false, false) => None,
        };
        if let Some(cut) = cut {
            warnings.push(format!(
                "the cell reaches {cut} and may be cut there: if so, it is thicker than {thickness_um:.1} um; take a \
                 stack that begins below the cell and ends above it"
            ));
        }
        if slices_in_cell < FEW_SLICES {
            warnings.push(format!(
                "only {slices_in_cell} slice(s) show the cell, fewer than {FEW_SLICES}: its thickness is known to about \
                 {z_step_um} um, and its shape in depth is coarse"
            ));
        } else if z_step_um > thickness_um / FEW_SLICES as f64 {
            warnings.push(format!(
                "the z step of {z_step_um} um is more than a fifth of the thickness of {thickness_um:.1} um: the thickness is \
                 known to about half a step"
            ));
        }
        if self.stain == Some(Stain::Membrane) && z_step_um > MEMBRANE_STEP_UM {
            warnings.push(format!(
                "only the membrane is bright, and the z step of {z_step_um} um can miss it at top and bottom: the thickness is \
                 known to about one step; take slices at most {MEMBRANE_STEP_UM} um apart, or stain the inside"
            ));
        }
        let [least, most] = USUAL_THICKNESSES_UM;
        if !(least..=most).contains(&thickness_um) {
            warnings.push(format!(
                "the thickness of {thickness_um:.1} um is outside {least} to {most} um, in which heart cells lie: is the z \
                 step of {z_step_um} um right?"
            ));
        }
        let volume = self.volume_um3.max(f64::MIN_POSITIVE);
        if self.modality == Modality::Mask
            && dropped.voxels as f64 * self.pixel_um * self.pixel_um * z_step_um
                > MUCH_DROPPED * volume
        {
            warnings.push(format!(
                "{} part(s) with {} voxels that are not connected with the cell by faces were dropped: is it one cell?",
                dropped.parts, dropped.voxels
            ));
        }
        warnings.extend(self.blur_warning());
        warnings.extend(self.confidence.warning());
        self.warnings.append(&mut warnings);
    }

    /// What the blur in z means for the thickness.
    fn blur_warning(&self) -> Option<String> {
        let Blur { plane_um, depth_um } = self.blur?;
        let thickness = self.thickness_um;
        let Some(depth) = depth_um else {
            return Some(
                "how much the optical section lengthens the cell along z is not known: no clear upper or lower edge \
                 was found"
                    .to_owned(),
            );
        };
        let plane = plane_um.map_or_else(String::new, |um| format!(" ({um:.1} um in the plane)"));
        let step = self.z_step_um;
        if depth < 1.5 * step {
            return Some(format!(
                "how much the optical section lengthens the cell along z is not known: its upper and lower edges are at \
                 most {:.1} um wide{plane}, which the z step of {step} um does not resolve",
                depth.max(step)
            ));
        }
        let advice = if depth > 0.5 * thickness {
            "more than half of the thickness, so the cell is probably thinner than it seems"
        } else if depth > 0.25 * thickness {
            "thin parts of the cell, such as its rim, seem thicker than they are"
        } else {
            return None;
        };
        Some(format!(
            "upper and lower edges of the cell are blurred over {depth:.1} um along z{plane}: {advice}"
        ))
    }
}
