//! The overlay of a picture: its outlines, lattice and fibres.

use crate::mesh::Mesh;
use crate::microscopy::cells::{PictureCell, PictureCells};
use crate::microscopy::fibres::Fibre;
use crate::microscopy::outlines::NamedOutline;
use crate::microscopy::stack::StackFibres;
use crate::output::figure::{self, Contour, Figure, FigureError, Overlay, Sarcomeres, Tick};
use crate::settings::Fibres;

/// Distance of the fibre ticks given to the figure, um; it draws only as many as can be
/// distinguished.
const TICKS_UM: f64 = 0.5;

/// Most warnings below a picture; those of a field of many cells would leave it no space.
const MOST_WARNINGS: usize = 14;

/// The first warnings, and how many there are more.
fn first_of(warnings: &[String]) -> Vec<String> {
    let mut first: Vec<String> = warnings.iter().take(MOST_WARNINGS).cloned().collect();
    if warnings.len() > MOST_WARNINGS {
        let more = warnings.len() - MOST_WARNINGS;
        first.push(format!("{more} more warnings are printed and listed in the report"));
    }
    first
}

/// The lattice of a cell, with its fibres.
#[derive(Clone, Copy)]
pub(super) struct Lattice<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) fibres: &'a Fibres,
}

impl Lattice<'_> {
    fn ticks(&self) -> Vec<Tick> {
        if let Some((_, field)) = self.fibres.slices.as_ref().and_then(StackFibres::middle) {
            return field.on_grid(TICKS_UM).iter().map(tick).collect();
        }
        let Some(seen) = &self.fibres.seen else {
            let triangles = self.mesh.simplices.iter().zip(&self.fibres.directions);
            return triangles
                .map(|(triangle, &direction)| Tick {
                    point_um: self.mesh.centre(triangle),
                    direction,
                    coherency: 0.0,
                    from_picture: false,
                })
                .collect();
        };
        seen.field.on_grid(TICKS_UM).iter().map(tick).collect()
    }
}

/// A fibre at a place of the picture.
pub(super) fn tick(&(point_um, fibre): &([f64; 2], Fibre)) -> Tick {
    Tick {
        point_um,
        direction: fibre.direction,
        coherency: fibre.order,
        from_picture: fibre.from_picture,
    }
}

/// Draws a picture with the fibres that it shows, without any cell.
pub(super) fn of_frame(
    title: &str,
    cells: &PictureCells,
    ticks: &[Tick],
    sarcomeres: Option<Sarcomeres<'_>>,
    warnings: &[String],
) -> Result<Figure, FigureError> {
    figure::overlay(&Overlay {
        title,
        width: cells.plane.width(),
        height: cells.plane.height(),
        values: cells.plane.values(),
        pixel_size: cells.pixel_size,
        cells: &[],
        chosen: figure::CELL,
        mesh: None,
        fibres: ticks,
        sarcomeres,
        warnings: &first_of(warnings),
    })
}

/// Draws a picture with its outlines, and of the chosen cell its lattice and fibres.
pub(super) fn draw(
    title: &str,
    cells: &PictureCells,
    chosen: &[&PictureCell],
    lattice: Option<Lattice<'_>>,
    warnings: &[String],
) -> Result<Figure, FigureError> {
    let others: Vec<NamedOutline> = cells
        .outlines()
        .into_iter()
        .filter(|cell| chosen.iter().all(|chosen| chosen.name != cell.name))
        .collect();
    let contours: Vec<Contour> = chosen
        .iter()
        .map(|cell| (cell.name.as_str(), &cell.outline, true))
        .chain(others.iter().map(|cell| (cell.name.as_str(), &cell.outline, false)))
        .map(|(name, outline, chosen)| Contour { name, rings: outline.rings().collect(), chosen })
        .collect();
    let lengths: Vec<f64> = lattice
        .and_then(|lattice| lattice.fibres.seen.as_ref())
        .map(|seen| seen.lengths().collect())
        .unwrap_or_default();
    let report = lattice.and_then(|lattice| lattice.fibres.report().seen);
    let sarcomeres = report.and_then(|report| {
        Some(Sarcomeres {
            lengths_um: &lengths,
            median_um: report.sarcomere_um?,
            read_pct: report.read_pct,
        })
    });
    let ticks = lattice.map(|lattice| lattice.ticks()).unwrap_or_default();
    figure::overlay(&Overlay {
        title,
        width: cells.plane.width(),
        height: cells.plane.height(),
        values: cells.plane.values(),
        pixel_size: cells.pixel_size,
        cells: &contours,
        chosen: figure::CELL,
        mesh: lattice.map(|lattice| lattice.mesh),
        fibres: &ticks,
        sarcomeres,
        warnings: &first_of(warnings),
    })
}

#[cfg(test)]
mod tests {
    use super::{MOST_WARNINGS, first_of};

    #[test]
    fn below_a_picture_of_many_cells_are_the_first_warnings_and_the_number_of_the_others() {
        let warnings: Vec<String> = (0..60).map(|number| format!("cell {number}")).collect();
        let shown = first_of(&warnings);
        assert_eq!(shown.len(), MOST_WARNINGS + 1);
        assert!(shown.last().unwrap().starts_with("46 more warnings"), "{shown:?}");
        assert_eq!(first_of(&warnings[..14]), warnings[..14]);
    }
}
