//! The picture with what was made of it, drawn.

use myospring::mesh::Mesh;
use myospring::microscopy::cells::{PictureCell, PictureCells};
use myospring::microscopy::fibres::FibreField;
use myospring::microscopy::outlines::NamedOutline;
use myospring::output::figure::{self, Contour, Figure, FigureError, Overlay, Tick};

/// Distance of the fibre ticks handed to the figure, um; it draws as many as can be told apart.
const TICKS_UM: f64 = 1.0;

/// Draws a picture with its outlines, and of the chosen cell its lattice and fibres.
pub(crate) fn draw(
    title: &str,
    cells: &PictureCells,
    chosen: &[&PictureCell],
    mesh: Option<&Mesh>,
    fibres: Option<&FibreField>,
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
    let ticks: Vec<Tick> = fibres
        .map(|field| field.on_grid(TICKS_UM))
        .unwrap_or_default()
        .into_iter()
        .map(|(point_um, fibre)| Tick {
            point_um,
            direction: fibre.direction,
            coherency: fibre.coherency,
            from_picture: fibre.from_picture,
        })
        .collect();
    figure::overlay(&Overlay {
        title,
        width: cells.plane.width(),
        height: cells.plane.height(),
        values: cells.plane.values(),
        pixel_size_um: cells.pixel_size_um,
        cells: &contours,
        mesh,
        fibres: &ticks,
        warnings,
    })
}
