//! The fibres of cells as a file.

use crate::failure::Failure;
use myospring::experiment::Folder;
use myospring::mesh::Mesh;
use myospring::output::fibres::{FibreRow, to_csv};
use myospring::settings::{Fibres, Seen};

/// Name of the file.
pub(crate) const FILE: &str = "fibres.csv";

/// Writes the fibres of cells that were read from their picture, each with its name; of none there is no file.
pub(crate) fn write<'a>(
    folder: &Folder,
    cells: impl IntoIterator<Item = (&'a str, &'a Mesh, &'a Fibres)>,
) -> Result<(), Failure> {
    let read = cells.into_iter().filter_map(|(name, mesh, fibres)| {
        let seen = fibres.seen.as_ref()?;
        Some((name, rows(mesh, seen)))
    });
    let read: Vec<(&str, Vec<FibreRow>)> = read.collect();
    if read.is_empty() { Ok(()) } else { folder.write(FILE, to_csv(&read)?) }
}

fn rows(mesh: &Mesh, seen: &Seen) -> Vec<FibreRow> {
    let triangles = mesh.simplices.iter().zip(&seen.triangles);
    let is_doubtful = seen.field.doubtful_lengths();
    triangles
        .map(|(triangle, place)| FibreRow {
            point_um: mesh.centre(triangle),
            direction_deg: place.from_picture.then(|| place.angle_deg()),
            sarcomere_um: place.sarcomere_um,
            sarcomere_doubtful: place.sarcomere_um.map(&is_doubtful),
            order: place.from_picture.then_some(place.order),
            coverage: place.from_picture.then_some(place.coverage),
        })
        .collect()
}
