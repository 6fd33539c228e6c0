//! What was found in a picture, for machines and for people.

use crate::mesh::Mesh;
use crate::microscopy::cells::{PictureCell, PictureCells};
use crate::microscopy::report::ShapeReport;
use crate::microscopy::segment::Confidence;
use crate::run_file::{Shape, ShapeError};
use crate::settings::{FibreDirection, FibreReport, Fibres, FibresError, Meshed, Shown};
use serde::Serialize;

/// What was found, as `report.json` has it.
#[derive(Serialize)]
pub struct SegmentReport<'a> {
    /// The picture, as it was named.
    pub picture: &'a str,
    modality: &'static str,
    /// Why the modality was chosen, if it was not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    modality_reason: Option<&'a str>,
    pixel_size_um: f64,
    pixel_size_source: &'static str,
    threshold: Option<f64>,
    /// Why none of the cells is accepted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(in crate::experiment) refused: Option<&'a str>,
    /// The cells that were chosen.
    pub cells: Vec<CellReport<'a>>,
    left_out: &'a [LeftOut],
    notes: &'a [String],
}

/// One of the cells.
#[derive(Serialize)]
pub struct CellReport<'a> {
    /// Its number by size, from 1.
    pub number: u32,
    /// Its name: its number, or the label or name that a file gives.
    pub name: &'a str,
    /// The confidence of its outline.
    pub confidence: &'a Confidence,
    /// Its size and shape.
    #[serde(flatten)]
    pub shape: &'a ShapeReport,
    /// Its lattice, if its pixels give one.
    pub lattice: Option<LatticeReport>,
    /// Its fibres, if they were searched.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fibres: Option<FibreReport>,
}

/// The lattice that `myospring run` would take, with the same --spacing.
#[derive(Serialize)]
pub struct LatticeReport {
    /// Distance of neighbouring masses, um.
    pub spacing_um: f64,
    /// How many masses it has.
    pub masses: usize,
    /// How many springs.
    pub springs: usize,
    /// How many triangles.
    pub triangles: usize,
}

/// A cell that was requested with all others but is not accepted.
#[derive(Serialize)]
pub struct LeftOut {
    /// Its number by size, from 1.
    pub number: u32,
    /// Why.
    pub reason: String,
    /// Whether the frame cuts it.
    #[serde(skip)]
    pub cut: bool,
}

/// A cell with its lattice, if its pixels give one, and the fibres on it, if they were searched.
pub struct Chosen {
    /// The cell.
    pub cell: PictureCell,
    /// Its lattice, or why there is none.
    pub lattice: Result<Meshed, ShapeError>,
    /// Its fibres, if they were searched.
    pub fibres: Option<Fibres>,
}

impl Chosen {
    /// Cells with their lattices.
    pub(in crate::experiment) fn of(
        shape: &Shape,
        cells: &PictureCells,
        chosen: Vec<PictureCell>,
    ) -> Vec<Self> {
        let meshed = |cell| Self { lattice: shape.lattice(cells, &cell), cell, fibres: None };
        chosen.into_iter().map(meshed).collect()
    }

    /// Searches the fibres in the picture.
    pub(super) fn look_for_fibres(
        &mut self,
        fibre: FibreDirection,
        cells: &PictureCells,
    ) -> Result<(), FibresError> {
        if let Ok(Meshed { mesh, .. }) = &self.lattice {
            self.fibres = Some(fibre.on(mesh, Some(Shown::Picture(cells, &self.cell)))?);
        }
        Ok(())
    }

    /// The lattice with its fibres, where there are both.
    pub(super) fn mesh_and_fibres(&self) -> Option<(&Mesh, &Fibres)> {
        let Meshed { mesh, .. } = self.lattice.as_ref().ok()?;
        Some((mesh, self.fibres.as_ref()?))
    }
}

impl<'a> SegmentReport<'a> {
    /// The report of the cells that were chosen.
    pub(in crate::experiment) fn of(
        picture: &'a str,
        cells: &'a PictureCells,
        chosen: &'a [Chosen],
        left_out: &'a [LeftOut],
    ) -> Self {
        let threshold = cells.segmentation().map(|found| found.threshold);
        let cell = |Chosen { cell, lattice, fibres }: &'a Chosen| CellReport {
            number: cell.number,
            name: &cell.name,
            confidence: &cell.confidence,
            shape: &cell.shape,
            lattice: lattice.as_ref().ok().map(|Meshed { mesh, report, .. }| LatticeReport {
                spacing_um: report.spacing_um,
                masses: mesh.len(),
                springs: mesh.springs.len(),
                triangles: mesh.simplices.len(),
            }),
            fibres: fibres.as_ref().map(Fibres::report),
        };
        Self {
            picture,
            modality: cells.modality(),
            modality_reason: cells.modality_reason(),
            pixel_size_um: cells.pixel_size.um(),
            pixel_size_source: cells.pixel_size_source,
            threshold: threshold.filter(|threshold| *threshold != 0.0),
            refused: None,
            cells: chosen.iter().map(cell).collect(),
            left_out,
            notes: &cells.notes,
        }
    }
}

/// Notes and warnings for people.
pub(super) fn notes(
    cells: &PictureCells,
    chosen: &[Chosen],
    left_out: &[LeftOut],
    all: bool,
) -> Vec<String> {
    let mut notes = cells.notes.clone();
    let count = cells.len();
    if all {
        let (cut, other): (Vec<_>, Vec<_>) = left_out.iter().partition(|cell| cell.cut);
        notes.extend(other.iter().map(|cell| format!("left out: {}", cell.reason)));
        if !cut.is_empty() {
            let numbers: Vec<String> = cut.iter().map(|cell| cell.number.to_string()).collect();
            notes.push(format!(
                "{} of {count} cells are cut by the frame and were left out ({}); --allow-cut includes them",
                cut.len(),
                numbers.join(", ")
            ));
        }
    } else if count > chosen.len() {
        let found = cells.segmentation().map(|found| &found.cells);
        let cut = found
            .map_or(0, |cells| cells.iter().filter(|cell| cell.pixels_on_the_frame > 0).count());
        let (whole, words) = match cut {
            0 => (String::new(), "all of them"),
            cut => (format!(", of which the frame cuts {cut}"), "all that are whole"),
        };
        notes.push(format!(
            "the picture has {count} cells{whole}; --cell all writes {words}, --cell N or --seed X,Y another one"
        ));
    }
    for Chosen { cell, lattice, fibres } in chosen {
        let who = if chosen.len() > 1 { format!("cell {}: ", cell.name) } else { String::new() };
        notes.extend(cell.warnings().map(|warning| format!("{who}{warning}")));
        notes.extend(lattice.as_ref().err().map(|error| format!("{who}no lattice: {error}")));
        let warnings = fibres.iter().flat_map(|fibres| &fibres.warnings);
        notes.extend(warnings.map(|warning| format!("{who}{warning}")));
    }
    notes
}
