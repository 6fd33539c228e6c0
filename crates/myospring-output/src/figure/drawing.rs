//! A figure as a file: SVG and PNG.

use super::sheet::Figure;
use super::{FigureError, raster, svg};

impl Figure {
    /// The figure as SVG, with its printed size in mm.
    pub fn to_svg(&self) -> String {
        svg::svg(self)
    }

    /// Draws the figure as PNG with `dpi` pixels per inch of printed size; the file also states
    /// this resolution.
    ///
    /// # Errors
    /// A resolution outside 10 to 2400 dpi; more pixels than memory allows.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::lattice;
    /// use myospring::output::figure;
    /// let figure = figure::mesh(&lattice::rectangle(40, 10, 2.0)?)?;
    /// assert!(figure.to_svg().contains("width=\"178mm\""));
    /// let png = figure.to_png(300.0)?;
    /// assert_eq!(png[16..20], 2102u32.to_be_bytes()); // pixels across, 178 mm at 300 dpi
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn to_png(&self, dpi: f64) -> Result<Vec<u8>, FigureError> {
        raster::png(self, dpi)
    }
}
