//! What was found in a picture, for machines and for people.

use myospring::mesh::Mesh;
use myospring::mesh::quality::MeshReport;
use myospring::microscopy::cells::{PictureCell, PictureCells};
use myospring::microscopy::fibres::FibreError;
use myospring::microscopy::report::ShapeReport;
use myospring::microscopy::segment::Confidence;
use myospring::run_file::{Shape, ShapeError};
use myospring::settings::{Fibre, FibreReport, Fibres};
use serde::Serialize;

/// Contrasts above this have no noise to be told of.
const NOISELESS: f64 = 1000.0;

/// What was found.
#[derive(Serialize)]
pub(crate) struct Report<'a> {
    pub(crate) picture: String,
    modality: &'static str,
    /// Why it was taken for that, where nobody said it.
    #[serde(skip_serializing_if = "Option::is_none")]
    modality_reason: Option<&'a str>,
    pixel_size_um: f64,
    pixel_size_source: &'static str,
    threshold: Option<f64>,
    /// Why none of the cells is taken.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) refused: Option<String>,
    cells: Vec<CellReport<'a>>,
    pub(crate) left_out: Vec<LeftOut>,
    notes: &'a [String],
}

#[derive(Serialize)]
struct CellReport<'a> {
    number: u32,
    name: &'a str,
    confidence: &'a Confidence,
    #[serde(flatten)]
    shape: &'a ShapeReport,
    lattice: Option<LatticeReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    fibres: Option<FibreReport>,
}

/// The lattice that `myospring run` would take, with the same --spacing.
#[derive(Serialize)]
struct LatticeReport {
    spacing_um: f64,
    masses: usize,
    springs: usize,
    triangles: usize,
}

/// A cell that was asked for with all others, but cannot be had.
#[derive(Serialize)]
pub(crate) struct LeftOut {
    pub(crate) number: u32,
    pub(crate) reason: String,
    /// Whether the frame cuts it.
    #[serde(skip)]
    pub(crate) cut: bool,
}

/// A cell with its lattice, where the pixels give one, and the fibres on it, where they were looked for.
pub(crate) struct Chosen {
    pub(crate) cell: PictureCell,
    pub(crate) lattice: Result<(Mesh, MeshReport), ShapeError>,
    pub(crate) fibres: Option<Fibres>,
}

impl Chosen {
    /// Cells with their lattices.
    pub(crate) fn of(shape: &Shape, cells: &PictureCells, chosen: Vec<PictureCell>) -> Vec<Self> {
        let meshed = |cell| Self { lattice: shape.lattice(cells, &cell), cell, fibres: None };
        chosen.into_iter().map(meshed).collect()
    }

    /// Looks for the fibres in the picture.
    pub(crate) fn look_for_fibres(
        &mut self,
        fibre: Fibre,
        cells: &PictureCells,
    ) -> Result<(), FibreError> {
        if let Ok((mesh, _)) = &self.lattice {
            self.fibres = Some(fibre.on(mesh, Some((cells, &self.cell)))?);
        }
        Ok(())
    }

    /// The lattice with its fibres, where there are both.
    pub(crate) fn mesh_and_fibres(&self) -> Option<(&Mesh, &Fibres)> {
        let (mesh, _) = self.lattice.as_ref().ok()?;
        Some((mesh, self.fibres.as_ref()?))
    }
}

impl<'a> Report<'a> {
    /// The report of the cells that were chosen.
    pub(crate) fn of(
        picture: String,
        cells: &'a PictureCells,
        chosen: &'a [Chosen],
        left_out: Vec<LeftOut>,
    ) -> Self {
        let threshold = cells.segmentation().map(|found| found.threshold);
        let cell = |Chosen { cell, lattice, fibres }: &'a Chosen| CellReport {
            number: cell.number,
            name: &cell.name,
            confidence: &cell.confidence,
            shape: &cell.shape,
            lattice: lattice.as_ref().ok().map(|(mesh, report)| LatticeReport {
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

    pub(crate) fn for_people(&self, cells: &PictureCells) -> String {
        let mut parts = vec![format!("{}: {}", self.picture, cells.method())];
        for cell in &self.cells {
            let contrast = match cell.confidence.contrast {
                None => String::new(),
                Some(contrast) if contrast > NOISELESS => {
                    format!(", contrast above {NOISELESS} times the noise")
                }
                Some(contrast) => format!(", contrast {contrast:.1} times the noise"),
            };
            parts.push(format!(
                "cell {}, confidence {:.2} of 1{contrast}",
                cell.name, cell.confidence.score
            ));
            // Warnings go to stderr.
            let shape = cell.shape.to_string();
            let lines: Vec<&str> =
                shape.lines().filter(|line| !line.starts_with("warning")).collect();
            parts.push(lines.join("\n"));
            if let Some(LatticeReport { spacing_um, masses, springs, triangles }) = &cell.lattice {
                parts.push(format!(
                    "{:<20} {masses} masses, {springs} springs, {triangles} triangles, spacing {spacing_um} um",
                    "lattice"
                ));
            }
            if let Some(fibres) = &cell.fibres {
                parts.push(format!("{:<20} {fibres}", "fibres"));
            }
            parts.push(String::new());
        }
        parts.join("\n")
    }
}

/// What a person should look at.
pub(crate) fn notes(
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
                "{} of {count} cells are cut by the frame and were left out ({}); --allow-cut takes them",
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
            "the picture has {count} cells{whole}; --cell all writes {words}, --cell N or --seed X,Y another"
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
