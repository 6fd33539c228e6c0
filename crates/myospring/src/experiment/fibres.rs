//! The fibres of cells as a file.

use super::error::ExperimentError;
use super::folder::Folder;
use crate::mesh::Mesh;
use crate::microscopy::fibres::Fibre;
use crate::output::fibres::{FibreRow, to_csv};
use crate::settings::{Fibres, PictureFibres};

/// Name of the file.
pub(super) const FILE: &str = "fibres.csv";

/// Writes the fibres of cells that were read from their picture, each with its name; of none there is no file.
pub(super) fn write<'a>(
    folder: &Folder,
    cells: impl IntoIterator<Item = (&'a str, &'a Mesh, &'a Fibres)>,
) -> Result<(), ExperimentError> {
    let read = cells.into_iter().filter_map(|(name, mesh, fibres)| {
        let seen = fibres.seen.as_ref()?;
        Some((name, rows(mesh, seen)))
    });
    let read: Vec<(&str, Vec<FibreRow>)> = read.collect();
    if read.is_empty() { Ok(()) } else { folder.write(FILE, to_csv(&read)?) }
}

fn rows(mesh: &Mesh, seen: &PictureFibres) -> Vec<FibreRow> {
    let triangles = mesh.simplices.iter().zip(&seen.triangles);
    let is_doubtful = seen.field.doubtful_lengths();
    triangles.map(|(triangle, place)| row(mesh.centre(triangle), place, &is_doubtful)).collect()
}

/// The row of a place; what was not read there is missing.
pub(super) fn row(
    point_um: [f64; 2],
    place: &Fibre,
    is_doubtful: impl Fn(f64) -> bool,
) -> FibreRow {
    FibreRow {
        point_um,
        direction_deg: place.from_picture.then(|| place.angle_deg()),
        sarcomere_um: place.sarcomere_um,
        sarcomere_doubtful: place.sarcomere_um.map(is_doubtful),
        order: place.from_picture.then_some(place.order),
        coverage: place.from_picture.then_some(place.coverage),
    }
}
